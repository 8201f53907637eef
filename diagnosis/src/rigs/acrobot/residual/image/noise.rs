//! The sensor's noise, from the scatter of circle 1.
//!
//! Circle 1 rolls along a line and hardly moves with the angles, so that its centroid and area scatter by the sensor's
//! noise and not by what is not known of the pose. How much they scatter isn't proportional to the noise: it depends on how
//! many pixels of the rim lie near the threshold. So the frames are made again with noise, and the noise is sought that
//! scatters them as much as the measured ones. Neighbouring frames are subtracted: what changes slowly is no noise.

use super::together::Together;
use super::{ImageCut, Nuisances};
use crate::error::Error;
use crate::rigs::acrobot::bench::Setting;
use crate::rigs::acrobot::candidates::Side;
use crate::rigs::acrobot::channels::{AREAS_APART, CENTROIDS_APART};
use crate::rigs::acrobot::policy::POLICY;
use crate::rigs::acrobot::residual::image::policy::IMAGES;
use crate::rigs::acrobot::residual::studio::{AREAS, CENTROIDS};
use crate::rigs::acrobot::residual::studio::{Seen, Shot};
use crate::rigs::acrobot::residual::trajectory::State;
use crate::statistics::levels::{FINE, HALF, WITHIN};
use crate::statistics::random::Random;

/// Signals of circle 1, and the scatter (px) below which two right renderers may differ.
const CHANNELS: [(usize, f64); 3] = [
    (CENTROIDS.start, HALF * CENTROIDS_APART),
    (CENTROIDS.start + 1, HALF * CENTROIDS_APART),
    (AREAS.start, AREAS_APART),
];

/// What the scatter says of the sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// Nominal standard deviation, grey levels.
    pub nominal: f64,
    /// The one that scatters circle 1 as measured.
    pub value: f64,
    /// Its standard error.
    pub error: f64,
    /// Smallest change that would have been named.
    pub detectable: f64,
    /// It differs from the nominal one beyond doubt.
    pub clear: bool,
    /// By how much circles are larger than the camera with this noise has them, px: by another light or threshold.
    pub larger: f64,
    /// Circles that scatter together, as by no noise of a sensor.
    pub together: Option<Together>,
}

impl Noise {
    /// Whether the light is the nominal one, against which noise is told.
    pub fn is_lit(&self) -> bool {
        self.larger.abs() < IMAGES.unlit
    }
}

/// Variance of each channel, and the relative error of its estimate.
type Scatter = [(f64, f64); 3];

impl ImageCut {
    /// Compares the scatter of circle 1 with what the camera at `point` gives, poses being `at` where a step left them; `None` where
    /// too few frames are measured.
    ///
    /// # Errors
    /// The camera unit failed.
    pub fn noise(&mut self, point: &[f64], at: &Nuisances) -> Result<Option<Noise>, Error> {
        self.begin_from(at);
        let Some(index) = self.candidates.iter().position(|candidate| candidate.side == Side::SensorNoise)
        else {
            return Ok(None);
        };
        let shots: Vec<_> = self.frames.iter().map(|frame| frame.shot).collect();
        let clean = self.studio.take(&self.settings(point, None)?, &shots)?;
        let made = stretches(shots.len());
        let rendered = Rendered { cut: self, point, index, clean, made };
        let residual = |place: usize| {
            let (here, seen) = (rendered.clean[place]?, &self.frames[place].seen);
            self.placed(place).then(|| std::array::from_fn(|s| seen[s] - here[s]))
        };
        let measured: Vec<Option<Seen>> = (0..shots.len()).map(residual).collect();
        let Some(mut seen) = self.scatter(std::slice::from_ref(&measured)) else { return Ok(None) };
        let nominal = self.candidates[index].off;
        let from = nominal.max(IMAGES.least);
        let usual = rendered.residuals(nominal, IMAGES.made)?;
        // the same seeds in both
        let (Some(mut here), Some(one), Some(more)) = (
            self.scatter(&usual),
            self.scatter(&usual[..1]),
            self.scatter(&rendered.residuals(1.5 * from, 1)?),
        ) else {
            return Ok(None);
        };
        rendered.unsure_lattice(nominal, &mut here)?;
        let mut apart = compare(&seen, &here);
        let slope = compare(&more, &one).mean / if nominal > 0.0 { libm::log(1.5) } else { 1.0 };
        let detectable = match (nominal > 0.0, slope > 0.0) {
            (true, true) => nominal * (libm::exp(POLICY.clear * apart.error / slope) - 1.0),
            _ => from,
        };
        let clear = |apart: &Ratio| apart.mean.abs() > POLICY.clear * apart.error;
        if nominal > 0.0 && apart.mean < 0.0 && clear(&apart) {
            let Some(quiet) = rendered.scatter(from / IMAGES.most)? else { return Ok(None) };
            poses_alone(&mut seen, &quiet);
            apart = compare(&seen, &here);
        }
        // a sensor without noise can't have less: poses are known better than they need be
        let none = nominal == 0.0 && apart.mean < 0.0;
        if none || !clear(&apart) {
            let error = detectable / POLICY.clear;
            let (value, larger) = (nominal, 0.0);
            return Ok(Some(Noise {
                nominal,
                value,
                error,
                detectable,
                clear: false,
                larger,
                together: None,
            }));
        }
        let Some(value) = rendered.noise_that_scatters_as(&seen, from, apart.mean > 0.0)? else {
            return Ok(None);
        };
        let Some(error) = rendered.error_of(&seen, value)? else { return Ok(None) };
        let made = rendered.residuals(value, IMAGES.made)?;
        let larger = made.first().map_or(0.0, |made| larger(&measured, made));
        let together = self.together(&measured, &made);
        Ok(Some(Noise { nominal, value, error, detectable, clear: true, larger, together }))
    }

    /// The shots at poses as far beside as those may be that were measured.
    fn unsure(&self, seed: i32) -> Vec<Shot> {
        let sigma = if let super::Pose::Logged(_, sigma) = &self.pose { *sigma } else { IMAGES.read };
        let mut random = Random::new(seed.unsigned_abs().into());
        let moved = |shot: &Shot| {
            let by: [f64; 2] = std::array::from_fn(|_| sigma * random.normal());
            let moved = |state: &State| [state[0] + by[0], state[1] + by[1], state[2], state[3]];
            shot.moved(moved)
        };
        self.frames.iter().map(|frame| &frame.shot).map(moved).collect()
    }

    /// What a camera finds as the log has it.
    fn as_logged(&self, found: f64, signal: usize) -> f64 {
        if CENTROIDS.contains(&signal) { rounded(found, self.quantum) } else { found }
    }

    /// Whether a frame has a pose.
    fn placed(&self, place: usize) -> bool {
        !matches!(self.pose, super::Pose::Logged(..)) || self.frames[place].known
    }

    /// Half the mean square of neighbours' differences.
    fn scatter(&self, sets: &[Vec<Option<Seen>>]) -> Option<Scatter> {
        let mut found = [(0.0, 0.0); 3];
        for (channel, (signal, floor)) in CHANNELS.iter().enumerate() {
            let mut squares = Vec::new();
            for set in sets {
                for place in 1..set.len() {
                    let (Some(one), Some(two)) = (set[place - 1], set[place]) else { continue };
                    let by = one[*signal] - two[*signal];
                    if self.frames[place - 1].run == self.frames[place].run && by.is_finite() {
                        squares.push(0.5 * by * by);
                    }
                }
            }
            if squares.len() < IMAGES.enough {
                return None;
            }
            let blocks: Vec<f64> = squares
                .chunks(IMAGES.noise_block)
                .map(|block| block.iter().sum::<f64>() / block.len() as f64)
                .collect();
            let n = blocks.len() as f64;
            let mean = blocks.iter().sum::<f64>() / n;
            let spread =
                blocks.iter().map(|block| (block - mean) * (block - mean)).sum::<f64>() / (n - 1.0).max(1.0);
            let variance = mean + floor * floor;
            found[channel] = (variance, (spread / n).sqrt() / variance);
        }
        Some(found)
    }
}

/// The frames of a cut as the camera makes them with some noise.
struct Rendered<'a> {
    cut: &'a ImageCut,
    point: &'a [f64],
    /// Place of the noise in the list of candidates.
    index: usize,
    /// What the camera makes without noise, frame by frame.
    clean: Vec<Option<Seen>>,
    /// Frames that are made with noise.
    made: Vec<usize>,
}

/// A value as a log has it that rounds to a quantum, if there is one.
fn rounded(value: f64, quantum: f64) -> f64 {
    if quantum > 0.0 { (value / quantum).round() * quantum } else { value }
}

/// Stretches of neighbouring frames, evenly through all: enough to tell what scatter a noise makes.
fn stretches(frames: usize) -> Vec<usize> {
    let every = frames.div_ceil(IMAGES.sampled).max(1);
    (0..frames).filter(|place| (place / IMAGES.noise_block).is_multiple_of(every)).collect()
}

impl Rendered<'_> {
    /// The point, with a noise of `sigma` grey levels.
    fn with_noise(&self, sigma: f64) -> Vec<f64> {
        let mut there = self.point.to_vec();
        there[self.index] = sigma;
        there
    }

    /// What noise of `sigma` grey levels adds to the frames that are made, one set of all frames for each seed.
    fn residuals(&self, sigma: f64, seeds: i32) -> Result<Vec<Vec<Option<Seen>>>, Error> {
        let settings = self.cut.settings(&self.with_noise(sigma), None)?;
        (0..seeds).map(|seed| self.residual(&settings, seed)).collect()
    }

    /// What the noise of a camera with these settings adds to the frames that are made.
    fn residual(&self, settings: &[Setting], seed: i32) -> Result<Vec<Option<Seen>>, Error> {
        let shots = self.cut.unsure(seed);
        let shots: Vec<Shot> = self.made.iter().map(|place| shots[*place]).collect();
        let mut all = vec![None; self.clean.len()];
        for (place, made) in self.made.iter().zip(self.cut.studio.noisy(settings, &shots, seed)?) {
            let (Some(here), Some(made)) = (self.clean[*place], made) else { continue };
            all[*place] = self
                .cut
                .placed(*place)
                .then(|| std::array::from_fn(|s| self.cut.as_logged(made[s], s) - here[s]));
        }
        Ok(all)
    }

    /// How noise of `sigma` grey levels scatters circle 1.
    fn scatter(&self, sigma: f64) -> Result<Option<Scatter>, Error> {
        Ok(self.cut.scatter(&self.residuals(sigma, IMAGES.made)?))
    }

    /// Adds to the errors of a prediction how much it changes when the image moves by what isn't known of its place on the
    /// lattice: in a machine that hardly moves, the same few pixels of the rim lie near the threshold all the time.
    fn unsure_lattice(&self, sigma: f64, into: &mut Scatter) -> Result<(), Error> {
        let settings = self.cut.settings(&self.with_noise(sigma), None)?;
        let mut logs: [Vec<f64>; 3] = Default::default();
        for (seed, (u, v)) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)].into_iter().enumerate() {
            let moved = self.cut.shifted(&settings, (u * IMAGES.noise_beside, v * IMAGES.noise_beside))?;
            if let Some(scatter) = self.cut.scatter(&[self.residual(&moved, seed as i32)?]) {
                logs.iter_mut().zip(scatter).for_each(|(logs, (variance, _))| logs.push(libm::log(variance)));
            }
        }
        for ((_, error), logs) in into.iter_mut().zip(&logs) {
            let n = logs.len() as f64;
            let mean = logs.iter().sum::<f64>() / n;
            let spread = logs.iter().map(|log| (log - mean) * (log - mean)).sum::<f64>() / (n - 1.0).max(1.0);
            *error = error.hypot(if n > 1.0 { spread.sqrt() } else { 0.0 });
        }
        Ok(())
    }

    /// The noise that scatters circle 1 as seen, grey levels: by bisection, above or below `from`.
    fn noise_that_scatters_as(&self, seen: &Scatter, from: f64, above: bool) -> Result<Option<f64>, Error> {
        // as far as the unit goes, and what is compared above it
        let ends = self.cut.candidates[self.index].range;
        let most = (from * IMAGES.most).min(ends.1 / IMAGES.beside).max(from);
        let (mut low, mut high) = if above { (from, most) } else { (from / IMAGES.most, from) };
        while high > (1.0 + FINE) * low {
            let middle = (low * high).sqrt();
            let Some(there) = self.scatter(middle)? else { return Ok(None) };
            if compare(seen, &there).mean > 0.0 { low = middle } else { high = middle }
        }
        Ok(Some((low * high).sqrt()))
    }

    /// The standard error of a noise that scatters circle 1 as seen, grey levels.
    fn error_of(&self, seen: &Scatter, value: f64) -> Result<Option<f64>, Error> {
        let (Some(mut there), Some(below), Some(above)) = (
            self.scatter(value)?,
            self.scatter(value / IMAGES.beside)?,
            self.scatter(value * IMAGES.beside)?,
        ) else {
            return Ok(None);
        };
        self.unsure_lattice(value, &mut there)?;
        let slope = compare(&above, &below).mean / (2.0 * libm::log(IMAGES.beside));
        Ok(Some(value * compare(seen, &there).error / slope.max(0.1)))
    }
}

/// By how much circles are larger in one set than in another, px: the mean over all areas that both have.
fn larger(one: &[Option<Seen>], other: &[Option<Seen>]) -> f64 {
    let both = one.iter().zip(other).filter_map(|(one, other)| one.zip(*other));
    let by = both.flat_map(|(one, other)| AREAS.map(move |area| one[area] - other[area]));
    let (sum, count) =
        by.filter(|by| by.is_finite()).fold((0.0, 0.0), |(sum, count), by| (sum + by, count + 1.0));
    sum / f64::max(count, 1.0)
}

/// How two scatters compare over the channels.
struct Ratio {
    /// Mean of the logarithms of the variances' ratios.
    mean: f64,
    /// Its standard error.
    error: f64,
}

/// Takes out of what was seen each channel that scatters less than a sensor without noise would have it: its poses are known
/// better than was reckoned, and it says nothing of the sensor.
fn poses_alone(seen: &mut Scatter, quiet: &Scatter) {
    for (own, quiet) in seen.iter_mut().zip(quiet) {
        let below = libm::log(own.0 / quiet.0);
        if below < -WITHIN * own.1.hypot(quiet.1).hypot(IMAGES.known) {
            own.1 = f64::INFINITY;
        }
    }
}

/// How much more what was seen scatters than what was predicted, over the channels weighted by what is known of each.
fn compare(seen: &Scatter, predicted: &Scatter) -> Ratio {
    let each: Vec<(f64, f64)> = seen
        .iter()
        .zip(predicted)
        .map(|((a, da), (b, db))| {
            (libm::log(a / b), (da * da + db * db + IMAGES.known * IMAGES.known).sqrt())
        })
        .collect();
    let weights: f64 = each.iter().map(|(_, error)| error.powi(-2)).sum();
    let mean = each.iter().map(|(ratio, error)| ratio / (error * error)).sum::<f64>() / weights;
    Ratio { mean, error: weights.sqrt().recip() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rigs::acrobot::residual::studio::COLUMNS;

    #[test]
    fn value_another_light_is_one_from_half_a_pixel_on() {
        let of = |larger: f64| {
            let (value, together) = (6.0, None);
            Noise { nominal: 4.0, value, error: 0.1, detectable: 0.2, clear: true, larger, together }.is_lit()
        };
        assert_eq!([-0.55, -0.45, 0.45, 0.55].map(of), [false, true, true, false]);
    }

    #[test]
    fn law_areas_are_compared_where_both_are_known() {
        let seen = |areas: [f64; 3]| {
            let mut all = [0.0; COLUMNS.len()];
            all[AREAS].copy_from_slice(&areas);
            Some(all)
        };
        // a log of the first area only, beside a frame that was lost
        let one = [seen([-2.0, f64::NAN, f64::NAN]), None];
        assert_eq!(larger(&one, &[seen([1.0, 50.0, 50.0]), seen([9.0; 3])]), -3.0);
        assert_eq!(larger(&[None], &[seen([9.0; 3])]), 0.0);
    }

    #[test]
    fn law_a_value_is_rounded_as_the_log_is() {
        assert_eq!(rounded(3.1771, 0.25), 3.25);
        assert_eq!(rounded(3.1771, 0.0), 3.1771);
    }

    #[test]
    fn law_noise_is_made_in_stretches_of_neighbours_evenly_through_the_frames() {
        assert_eq!(stretches(500), (0..500).collect::<Vec<_>>());
        let some = stretches(2000);
        // no more than what a column is taken at, and a stretch more
        assert!(some.len() <= IMAGES.sampled + IMAGES.noise_block && some.len() > IMAGES.sampled / 2);
        let apart = some.windows(2).filter(|pair| pair[1] > pair[0] + 1).count();
        assert!(apart + 1 == some.len().div_ceil(IMAGES.noise_block), "{apart} gaps");
        assert!(some[some.len() - 1] > 1800, "{some:?}");
    }

    #[test]
    fn law_a_channel_that_poses_alone_scatter_more_says_nothing_of_the_sensor() {
        // as seen with encoders of 1000 counts: the first channel scatters less than without any noise
        let (here, quiet) =
            ([(1.4e-3, 0.04), (8.7e-4, 0.04), (0.46, 0.07)], [(1.2e-3, 0.03), (5.1e-4, 0.03), (0.32, 0.02)]);
        let mut seen = [(7.3e-4, 0.06), (7.1e-4, 0.08), (0.35, 0.06)];
        let before = compare(&seen, &here);
        assert!(before.mean < -POLICY.clear * before.error);
        poses_alone(&mut seen, &quiet);
        assert_eq!(seen.map(|(_, error)| error.is_finite()), [false, true, true]);
        let after = compare(&seen, &here);
        assert!(after.mean < 0.0 && after.mean > -POLICY.clear * after.error);
        // without any that speaks nothing is clear
        let none = compare(&seen.map(|(own, _)| (own, f64::INFINITY)), &here);
        assert!(none.mean.is_nan());
    }
}
