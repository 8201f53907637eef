//! Circles that scatter together from frame to frame. The noise of a sensor is another at each pixel, so that circles far apart share none of
//! it: what they share is a light that flickers, a mount that shakes, or a timestamp that is off.

use super::ImageCut;
use super::policy::IMAGES;
use crate::rigs::acrobot::residual::studio::{AREAS, CENTROIDS, Seen};
use crate::statistics::levels::CERTAIN;
use std::ops::Range;

/// A value of circle 1 beside the same one of another circle.
type Pair = (usize, usize);

/// Signals of circle 1 with those of the others, of as many for each circle.
fn pairs(signals: Range<usize>) -> impl Iterator<Item = Pair> {
    let each = signals.len() / AREAS.len();
    let Range { start, end } = signals;
    (start + each..end).map(move |other| (start + (other - start) % each, other))
}

/// What two circles share.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Together {
    /// Places of their signals.
    pub signals: Pair,
    /// Correlation of what changes from frame to frame.
    pub correlation: f64,
}

impl ImageCut {
    /// The two circles that scatter together most, by more than in frames that were `made` with noise and with poses as unsure; nothing
    /// where noise alone may do it. Places that a pose was read off follow it together.
    pub(super) fn together(&self, measured: &[Option<Seen>], made: &[Vec<Option<Seen>>]) -> Option<Together> {
        let runs: Vec<usize> = self.frames.iter().map(|frame| frame.run).collect();
        let told = matches!(self.pose, super::Pose::Logged(..));
        let of = |pair: Pair| {
            let expected: Vec<f64> =
                made.iter().filter_map(|set| Some(correlation(set, &runs, pair)?.0)).collect();
            let (seen, count) = correlation(measured, &runs, pair)?;
            let sets = expected.len().max(1) as f64;
            let more = seen - expected.iter().sum::<f64>() / sets;
            Some((
                Together { signals: pair, correlation: seen },
                more,
                error(count) * (1.0 + 1.0 / sets).sqrt(),
            ))
        };
        let places = pairs(CENTROIDS).filter(|_| told);
        let shared =
            pairs(AREAS).chain(places).filter_map(of).filter(|(_, more, error)| is_shared(*more, *error));
        shared.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs())).map(|(together, ..)| together)
    }
}

/// Standard error of the correlation of so many changes from frame to frame, of values that share nothing: each change shares a value
/// with the next one, so that two changes in three count.
fn error(count: usize) -> f64 {
    (1.5 / count as f64).sqrt()
}

/// Whether a correlation is more than noise leaves: clear of its error, and no small one.
fn is_shared(more: f64, error: f64) -> bool {
    more.abs() > IMAGES.together.max(CERTAIN * error)
}

/// Correlation of what two signals change by from one frame to the next, and of how many changes; nothing where too few neighbours tell.
fn correlation(frames: &[Option<Seen>], runs: &[usize], (one, other): Pair) -> Option<(f64, usize)> {
    let (mut xx, mut yy, mut xy, mut count) = (0.0, 0.0, 0.0, 0);
    for place in 1..frames.len() {
        let (Some(before), Some(after)) = (frames[place - 1], frames[place]) else { continue };
        let (x, y) = (after[one] - before[one], after[other] - before[other]);
        if runs[place - 1] == runs[place] && x.is_finite() && y.is_finite() {
            xx += x * x;
            yy += y * y;
            xy += x * y;
            count += 1;
        }
    }
    (count >= IMAGES.enough && xx > 0.0 && yy > 0.0).then(|| (xy / (xx * yy).sqrt(), count))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rigs::acrobot::residual::studio::COLUMNS;
    use crate::statistics::random::Random;

    /// 400 frames in which a light makes so much of the areas' scatter.
    fn frames(light: f64) -> Vec<Option<Seen>> {
        let mut random = Random::new(3);
        let mut frame = || {
            let shared = light * random.normal();
            let mut seen = [f64::NAN; COLUMNS.len()];
            AREAS.for_each(|area| seen[area] = shared + random.normal());
            Some(seen)
        };
        (0..400).map(|_| frame()).collect()
    }

    #[test]
    fn law_circles_share_a_light_and_no_noise() {
        let runs = vec![0; 400];
        let of = |light: f64| {
            correlation(&frames(light), &runs, (AREAS.start, AREAS.start + 1)).expect("400 frames").0
        };
        // half of each scatter is shared; 400 frames tell to 0.05, their differences to a little less
        assert!((of(1.0) - 0.5).abs() < 0.2 && of(0.0).abs() < 0.2, "{} {}", of(1.0), of(0.0));
        assert_eq!(
            correlation(&frames(0.0), &runs, (CENTROIDS.start, CENTROIDS.start + 2)),
            None,
            "places were not logged"
        );
        assert_eq!(
            correlation(&frames(0.0), &(0..400).collect::<Vec<_>>(), (AREAS.start, AREAS.start + 1)),
            None,
            "no neighbours"
        );
    }

    #[test]
    fn every_other_circle_stands_beside_circle_1() {
        assert_eq!(pairs(AREAS).collect::<Vec<_>>(), [(6, 7), (6, 8)]);
        assert_eq!(pairs(CENTROIDS).collect::<Vec<_>>(), [(0, 2), (1, 3), (0, 4), (1, 5)]);
    }

    #[test]
    fn law_changes_of_independent_values_correlate_within_their_error() {
        let squared = |seed: u64| {
            let mut random = Random::new(seed);
            let frames: Vec<_> = (0..200)
                .map(|_| {
                    let mut seen = [f64::NAN; COLUMNS.len()];
                    AREAS.for_each(|area| seen[area] = random.normal());
                    Some(seen)
                })
                .collect();
            let (seen, count) = correlation(&frames, &[0; 200], (AREAS.start, AREAS.start + 1)).unwrap();
            (seen / error(count)).powi(2)
        };
        // 400 squares of a standard normal have a mean of 1 to 0.07
        let mean = (0..400).map(squared).sum::<f64>() / 400.0;
        assert!((mean - 1.0).abs() < 4.0 * 0.07, "{mean}");
    }

    #[test]
    fn value_circles_scatter_together_from_a_tenth_on_that_is_clear_of_its_error() {
        let of = |more: f64| is_shared(more, 0.001);
        assert_eq!([0.09, 0.11, -0.11].map(of), [false, true, true]);
        assert_eq!([0.05, 0.04, 0.0].map(|error| is_shared(0.2, error)), [false, true, true]);
    }
}
