//! The sensor's noise, as circle 1 scatters by it: it shows in no mean, but moves what a threshold sees, so that lens effects may
//! pass for it.

use super::compare::{Part, add_classes, search_cut};
use super::policy::PIPELINE;
use crate::error::Error;
use crate::rigs::acrobot::candidates::{Candidate, Side};
use crate::rigs::acrobot::gap::chained;
use crate::rigs::acrobot::residual::image::{ImageCut, Noise};
use crate::rigs::acrobot::residual::{Cut, Tracked};
use crate::rigs::acrobot::selection::{lacking, study_until};
use crate::watch::Watch;

/// The part, with the sensor's noise as the scatter tells it. Where the scatter isn't the nominal sensor's, it is put right
/// and all is linearised anew, since noise moves the mean of what a threshold sees and may have been taken for a blur.
pub(super) fn search_with_noise<C: Cut + Clone + 'static>(
    cut: &mut Tracked<C>,
    image: fn(&mut C) -> &mut ImageCut,
    list: &[Candidate],
    point: &[f64],
    watch: &mut Watch<'_>,
) -> Result<Part, Error> {
    match list.iter().position(|candidate| candidate.side == Side::SensorNoise) {
        // a repeated search begins with the noise that the first one found
        Some(sensor) if watch.known().is_none() => Sensor { cut, image, list, point, sensor }.search(watch),
        _ => search_cut(cut, list, point, &[], false, watch),
    }
}

/// A search of an image whose sensor may have another noise than the nominal one.
struct Sensor<'a, C: Cut> {
    cut: &'a mut Tracked<C>,
    image: fn(&mut C) -> &mut ImageCut,
    list: &'a [Candidate],
    /// Where everything begins.
    point: &'a [f64],
    /// Place of the noise in the list.
    sensor: usize,
}

impl<C: Cut + Clone + 'static> Sensor<'_, C> {
    /// What is found with the noise as the scatter tells it.
    fn search(mut self, watch: &mut Watch<'_>) -> Result<Part, Error> {
        let Self { image, list, point, sensor, .. } = self;
        // asked at most once, of frames that no fit has led elsewhere
        let mut untouched = Some(self.cut.clone());
        let mut first = None;
        let plain = study_until(self.cut, list, point, &[], watch, &mut |active, watch| {
            if active.len() > PIPELINE.sensor_alone
                && let Some(mut cut) = untouched.take()
            {
                first = Sensor { cut: &mut cut, image, list, point, sensor }.noise_first(watch)?;
            }
            Ok(first.is_some())
        })?;
        if let Some(first) = first {
            return Ok(first);
        }
        let mut plain = add_classes(self.cut, list, plain, false, watch)?;
        if lacks(&plain) {
            return Ok(plain);
        }
        plain.noise = self.scatter(&plain.study.last.point)?;
        // what circles share is no noise, and no other noise is to be taken for it
        if !clear(&plain.noise) || plain.noise.is_some_and(|noise| noise.together.is_some()) {
            return Ok(plain);
        }
        // a blur scatters too, and would hide a part of the noise that it imitates
        let mut sharp = plain.study.last.point.clone();
        let blurs: Vec<usize> =
            plain.study.active.iter().copied().filter(|index| list[*index].is_discrete()).collect();
        blurs.iter().for_each(|index| sharp[*index] = list[*index].off);
        let guess = if blurs.is_empty() { plain.noise } else { self.scatter(&sharp)? };
        let Some(guess) = guess else { return Ok(plain) };
        let Some(noisy) = self.search_noisy(guess.value, usize::MAX, watch)? else { return Ok(plain) };
        if clear(&noisy.noise) {
            return Ok(noisy);
        }
        // a scatter that one story needs and the other doesn't is no proof
        plain.noise = plain.noise.map(|noise| Noise { clear: false, ..noise });
        Ok(plain)
    }

    /// What is found with the noise put right before all else, where the scatter about the nominal model says that it is wrong, and no
    /// more than one effect stands beside it: a sensor three times as noisy came after a minute of seven lens effects.
    fn noise_first(mut self, watch: &mut Watch<'_>) -> Result<Option<Part>, Error> {
        self.cut.linearise(self.point, &[])?;
        let Some(early) = self.scatter(self.point)?.filter(|noise| noise.clear && noise.together.is_none())
        else {
            return Ok(None);
        };
        let first = self.search_noisy(early.value, PIPELINE.sensor_few, watch)?;
        Ok(first.filter(|first| clear(&first.noise) && !lacks(first)))
    }

    /// What is found with so much noise, and the noise as it is seen to be then; `None` if that is `most` or more. A blur that is found
    /// beside it makes the same scatter one of less noise: all is found again with that, since the noise moves the mean, too.
    fn search_noisy(
        &mut self,
        guess: f64,
        most: usize,
        watch: &mut Watch<'_>,
    ) -> Result<Option<Part>, Error> {
        let Some(noisy) = self.search_at_noise(guess, most, watch)? else { return Ok(None) };
        match noisy.noise.filter(|noise| is_other(noise.value, noise.error, guess)) {
            Some(other) => self.search_at_noise(other.value, most, watch),
            None => Ok(Some(noisy)),
        }
    }

    /// What is found with exactly so much noise; `None` if that is `most` or more.
    fn search_at_noise(
        &mut self,
        guess: f64,
        most: usize,
        watch: &mut Watch<'_>,
    ) -> Result<Option<Part>, Error> {
        let mut start = self.point.to_vec();
        start[self.sensor] = guess;
        self.cut.reset();
        let enough = &mut |active: &[usize], _: &mut Watch<'_>| Ok(active.len() >= most);
        let study = study_until(self.cut, self.list, &start, &[], watch, enough)?;
        if study.active.len() >= most {
            return Ok(None);
        }
        let mut noisy = add_classes(self.cut, self.list, study, false, watch)?;
        let mut then = noisy.study.last.point.clone();
        then[self.sensor] = self.list[self.sensor].off;
        noisy.noise = self.scatter(&then)?;
        noisy.study.last.point[self.sensor] = noisy.noise.map_or(guess, |noise| noise.value);
        Ok(Some(noisy))
    }

    /// The noise by which circle 1 scatters about a model.
    fn scatter(&mut self, point: &[f64]) -> Result<Option<Noise>, Error> {
        // fits of alternatives have left the frames elsewhere
        self.cut.restore_linearised();
        self.cut.chord(point, &[])?;
        let at = self.cut.nuisances.clone();
        (self.image)(self.cut).noise(point, &at)
    }
}

/// Whether a noise, known to a standard error, is another than all was rendered with.
fn is_other(value: f64, error: f64, rendered: f64) -> bool {
    (value - rendered).abs() > error
}

fn clear(noise: &Option<Noise>) -> bool {
    noise.is_some_and(|noise| noise.clear)
}

/// A torque that lacks is no sensor's, and where more than noise is left a sensor's isn't named.
fn lacks(part: &Part) -> bool {
    let study = &part.study;
    chained(&part.signals) && lacking(&study.last, &study.folds, study.explained, true)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn value_a_noise_is_another_from_one_standard_error_on() {
        // known to 0.7, as of three runs of 20 s
        assert_eq!([9.6, 9.8, 8.2].map(|rendered| is_other(9.0, 0.7, rendered)), [false, true, true]);
    }
}
