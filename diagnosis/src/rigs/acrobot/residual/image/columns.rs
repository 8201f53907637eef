//! What moving a candidate, or the arm, does to the image: secants over steps of some pixels, smooth over poses.

use super::frame_cache::MadeFrames;
use super::laws::{Law, powers};
use super::surface::{Surface, Terms};
use super::{Column, ImageCut};
use crate::error::Error;
use crate::rigs::acrobot::bench::Setting;
use crate::rigs::acrobot::residual::Perturbation;
use crate::rigs::acrobot::residual::image::policy::IMAGES;
use crate::rigs::acrobot::residual::studio::{AREAS, COLUMNS, Seen, Shot};
use crate::rigs::acrobot::residual::trajectory::State;
use crate::statistics::random::Random;
use nalgebra::{Matrix3, Vector3};
use std::sync::Arc;

/// How far a pose is moved (rad) before a candidate's column is taken there: half a pixel at circle 1 and more at the
/// others, twice, to either side. At the pose itself, residual and column would share the lattice's error of the very
/// frame that both are differences from, and whatever blurs or dims would seem to be there (regression dilution,
/// upside down: Fuller, *Measurement Error Models*, Wiley 1987, section 1.1).
const DITHER: [f64; 2] = [2.0 * IMAGES.turn, IMAGES.turn];
const DITHER_SEED: u64 = 0x0ac0_d17e;
/// How far the image is moved for each of them, px: circle 1 stays in its row of the lattice whatever the pose, and the error
/// that a secant has there would not average out.
const PHASES: [(f64, f64); 4] = [(0.125, 0.125), (-0.125, 0.375), (-0.375, -0.125), (0.375, -0.375)];

impl ImageCut {
    /// Change of the image with each angle.
    pub(super) fn turned(
        &self,
        settings: &[Setting],
        shots: &[Shot],
    ) -> Result<Vec<[Option<Seen>; 2]>, Error> {
        let [first, second] = [self.turned_by(settings, shots, 0)?, self.turned_by(settings, shots, 1)?];
        Ok(first.into_iter().zip(second).map(|(a, b)| [a, b]).collect())
    }

    /// Change of the image with an angle: a surface over the sampled frames, or frame by frame where there are too few for one.
    fn turned_by(
        &self,
        settings: &[Setting],
        shots: &[Shot],
        angle: usize,
    ) -> Result<Vec<Option<Seen>>, Error> {
        let raw = |shots: &[Shot]| -> Result<Vec<Option<Seen>>, Error> {
            let moved = |by: f64| -> Vec<Shot> {
                let turn = |state: &State| {
                    let mut turned = *state;
                    turned[angle] += by;
                    turned
                };
                shots.iter().map(|shot| shot.moved(turn)).collect()
            };
            let (up, down) = (moved(IMAGES.turn), moved(-IMAGES.turn));
            let (up, down) = (self.studio.take(settings, &up)?, self.studio.take(settings, &down)?);
            Ok(slopes(&up, &down, 2.0 * IMAGES.turn))
        };
        let sampled: Vec<Shot> = self.sampled().map(|place| shots[place]).collect();
        let found = raw(&sampled)?;
        let samples: Vec<(State, Seen)> =
            sampled.iter().zip(&found).filter_map(|(shot, seen)| Some((shot.end, (*seen)?))).collect();
        let surface = Surface::fit(&samples, Terms::Poses);
        match surface.is_none() {
            true if found.len() == shots.len() => Ok(found),
            true => raw(shots),
            false => Ok(shots.iter().map(|shot| surface.at(&shot.end)).collect()),
        }
    }

    /// What an exposure that is longer by one interval would do by its earlier middle alone.
    pub(super) fn late(&self, place: usize) -> Option<Seen> {
        let frame = &self.frames[place];
        let (one, two) = match self.turns.as_deref()?.get(place)? {
            [Some(one), Some(two)] => (one, two),
            _ => return None,
        };
        let earlier = 0.5 * self.interval();
        let [.., dq1, dq2] = frame.shot.end;
        Some(std::array::from_fn(|s| -earlier * (one[s] * dq1 + two[s] * dq2)))
    }

    /// Frames at which columns are taken: enough for a surface, which then holds for all.
    fn sampled(&self) -> impl Iterator<Item = usize> + use<> {
        let count = self.frames.len();
        (0..count).step_by(count.div_ceil(IMAGES.sampled).max(1))
    }

    /// Shots a little beside the sampled frames' poses.
    fn beside(&self, round: u64, side: f64) -> Vec<Shot> {
        let moved = |state: &State, by: &[f64; 2]| {
            [state[0] + side * by[0], state[1] + side * by[1], state[2], state[3]]
        };
        let mut random = Random::new(DITHER_SEED + round);
        self.sampled()
            .map(|place| {
                let by = DITHER.map(|most| most * (2.0 * random.uniform() - 1.0));
                self.frames[place].shot.moved(|state| moved(state, &by))
            })
            .collect()
    }

    /// Change of the image per unit of a candidate.
    pub(super) fn column(&mut self, point: &[f64], perturbation: Perturbation) -> Result<Column, Error> {
        let key = (perturbation.candidate, perturbation.by.to_bits());
        if let Some(kept) = self.kept.get(&key) {
            return Ok(kept.clone());
        }
        let (name, by) = (self.candidates[perturbation.candidate].name, perturbation.by);
        let column = match self.laws.get(name, by) {
            Some(law) => self.along(&law),
            None => self.taken(point, perturbation)?,
        };
        self.kept.insert(key, column.clone());
        Ok(column)
    }

    /// A candidate's column, taken anew; what it is at all poses is kept.
    fn taken(&mut self, point: &[f64], perturbation: Perturbation) -> Result<Column, Error> {
        let (name, by) = (self.candidates[perturbation.candidate].name, perturbation.by);
        let blurs = Some(perturbation.candidate) == self.exposure;
        let longest = point[perturbation.candidate].max(point[perturbation.candidate] + by);
        if blurs && longest * self.way() < IMAGES.blurring {
            let law = self.short_blur(point, perturbation)?;
            return Ok(self.along(&law));
        }
        let late =
            |cut: &Self, place: usize| if blurs { cut.late(place) } else { Some([0.0; COLUMNS.len()]) };
        let (moved, still) = (self.settings(point, Some(perturbation))?, self.settings(point, None)?);
        let mut samples: Vec<(State, Seen)> = Vec::new();
        let mut first = Vec::new();
        let little = blurs && by.abs() * self.way() < IMAGES.blurring;
        let rounds = if little { IMAGES.more_rounds } else { IMAGES.rounds };
        for (round, side, phase) in sides(rounds) {
            let shots = self.beside(round, side);
            let there = self.studio.take(&self.shifted(&moved, phase)?, &shots)?;
            let here = self.here(&still, phase, shots, None)?;
            let column = slopes(&there, &here.seen, by);
            for (place, (shot, seen)) in self.sampled().zip(here.shots.iter().zip(&column)) {
                if let (Some(seen), Some(late)) = (seen, late(self, place)) {
                    samples.push((shot.end, std::array::from_fn(|s| seen[s] - late[s])));
                }
            }
            if first.is_empty() {
                first = column;
            }
        }
        let surface = Surface::fit(&samples, if blurs { Terms::Motions } else { Terms::Poses });
        // few frames have no surface, and are all sampled
        if surface.is_none() && first.len() == self.frames.len() {
            return Ok(Arc::new(first));
        }
        let law = self.laws.insert(name, by, Law::Smooth { surface, blurs });
        Ok(self.along(&law))
    }

    /// Change of the image per unit of a short exposure. Beyond the earlier middle, which a delay does as well, it changes
    /// areas alone, and by how far a circle moves while the shutter is open: a polynomial of the square of that, the same for
    /// all circles. Frame by frame, or by a surface over all states, it would drown in the lattice's error.
    fn short_blur(&mut self, point: &[f64], perturbation: Perturbation) -> Result<Arc<Law>, Error> {
        let Perturbation { candidate, by } = perturbation;
        let (name, from) = (self.candidates[candidate].name, point[candidate]);
        let far = self.farthest(candidate, from, by);
        let weights = match self.laws.get(name, far).as_deref() {
            Some(Law::Blurred { weights, from: known, .. }) if *known == from => *weights,
            _ => self.blurred(point, Perturbation { by: far, ..perturbation })?,
        };
        self.laws.insert(name, far, Law::Blurred { weights, from, by: far });
        Ok(self.laws.insert(name, by, Law::Blurred { weights, from, by }))
    }

    /// The step over which the polynomial is taken: the farthest that is tried and still short, since a small one shows next to
    /// nothing; all within it share the polynomial. Beyond it that knows nothing.
    fn farthest(&self, candidate: usize, from: f64, by: f64) -> f64 {
        if by < -IMAGES.blur_step {
            return by;
        }
        let candidate = &self.candidates[candidate];
        let short =
            |far: &f64| from + far <= candidate.range.1 && (from + far) * self.way() < IMAGES.blurring;
        candidate.steps.iter().copied().filter(short).fold(by.max(IMAGES.blur_step), f64::max)
    }

    /// The polynomial's weights, by frames with an exposure that is longer by a step beside frames without.
    fn blurred(&mut self, point: &[f64], perturbation: Perturbation) -> Result<Vector3<f64>, Error> {
        let (from, far) = (point[perturbation.candidate], perturbation.by);
        let moved = self.settings(point, Some(perturbation))?;
        let still = self.settings(point, None)?;
        let mut normal: Matrix3<f64> = Matrix3::zeros();
        let mut right = Vector3::zeros();
        for (round, side, phase) in sides(IMAGES.blur_rounds) {
            let (shots, seed) = (self.beside(round, side), 2 * round as i32 + i32::from(side > 0.0));
            let there = self.studio.noisy(&self.shifted(&moved, phase)?, &shots, seed)?;
            let here = self.here(&still, phase, shots, Some(seed))?;
            for (place, (here, there)) in self.sampled().zip(here.seen.iter().zip(&there)) {
                let (Some(here), Some(there), Some(ways)) = (here, there, self.ways(place)) else {
                    continue;
                };
                for (circle, way) in ways.into_iter().enumerate() {
                    let x = powers(way, from, from + far);
                    normal += x * x.transpose();
                    let area = AREAS.start + circle;
                    right += x * (there[area] - here[area]);
                }
            }
        }
        Ok(normal.cholesky().map_or_else(Vector3::zeros, |normal| normal.solve(&right)))
    }

    /// How far a circle usually moves in a frame's interval, at most, px.
    fn way(&self) -> f64 {
        let mut squares: Vec<f64> =
            (0..self.frames.len()).filter_map(|place| self.ways(place)).flatten().collect();
        squares.sort_by(f64::total_cmp);
        let place = (squares.len() as f64 * IMAGES.usual) as usize;
        squares.get(place.min(squares.len().saturating_sub(1))).map_or(0.0, |square| square.sqrt())
    }

    /// Squares of the ways of the circles in a frame's interval, px².
    pub(super) fn ways(&self, place: usize) -> Option<[f64; 3]> {
        let late = self.late(place)?;
        Some(std::array::from_fn(|circle| 4.0 * (late[2 * circle].powi(2) + late[2 * circle + 1].powi(2))))
    }

    /// Frames without a candidate moved, made once for all columns, with the sensor's noise if there is a seed.
    fn here(
        &mut self,
        still: &[Setting],
        phase: (f64, f64),
        shots: Vec<Shot>,
        seed: Option<i32>,
    ) -> Result<Arc<MadeFrames>, Error> {
        let camera = self.studio.exposed(&self.shifted(still, phase)?, seed)?;
        let studio = &self.studio;
        self.still.frames(camera, shots, |camera, shots| studio.shoot(camera, shots))
    }

    /// Settings of a camera whose image is moved along u and v, px.
    pub(super) fn shifted(&self, settings: &[Setting], by: (f64, f64)) -> Result<Vec<Setting>, Error> {
        let (bench, half) = (self.studio.bench(), self.studio.half_width());
        let mut all = settings.to_vec();
        for (name, by) in [("u0", by.0), ("v0", by.1)] {
            let (reference, _) = bench.setting(name, 0.0)?;
            let there = all.iter().rev().find(|(known, _)| *known == reference);
            let now = there.and_then(|(_, value)| value.as_f64()).unwrap_or(bench.nominal(reference));
            all.push(bench.setting(name, now + by / half)?);
        }
        Ok(all)
    }
}

/// Rounds of poses beside the frames', to either side, each with the image moved elsewhere on the lattice.
fn sides(rounds: u64) -> impl Iterator<Item = (u64, f64, (f64, f64))> {
    let sides = (0..rounds).flat_map(|round| [(round, 1.0), (round, -1.0)]);
    sides.zip(PHASES.into_iter().cycle()).map(|((round, side), phase)| (round, side, phase))
}

/// Change per unit of each frame between two sides that lie `by` apart; `None` where either shows nothing.
fn slopes(moved: &[Option<Seen>], base: &[Option<Seen>], by: f64) -> Vec<Option<Seen>> {
    moved
        .iter()
        .zip(base)
        .map(|(moved, base)| {
            let (moved, base) = (moved.as_ref()?, base.as_ref()?);
            Some(std::array::from_fn(|s| (moved[s] - base[s]) / by))
        })
        .collect()
}
