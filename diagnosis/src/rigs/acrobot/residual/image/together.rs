//! Circles that scatter together from frame to frame. The noise of a sensor is another at each pixel, so that circles far apart share none of
//! it: what they share is a light that flickers, a mount that shakes, or a time stamp that is off.

use super::ImageCut;
use super::policy::IMAGES;
use crate::rigs::acrobot::residual::studio::{AREAS, CENTROIDS, Seen};
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
            let expected: Vec<f64> = made.iter().filter_map(|set| correlation(set, &runs, pair)).collect();
            let expected = expected.iter().sum::<f64>() / expected.len().max(1) as f64;
            correlation(measured, &runs, pair).map(|seen| (seen, seen - expected, pair))
        };
        let places = pairs(CENTROIDS).filter(|_| told);
        let most =
            pairs(AREAS).chain(places).filter_map(of).max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
        is_shared(most.1).then_some(Together { signals: most.2, correlation: most.0 })
    }
}

/// Whether a correlation is more than noise leaves.
fn is_shared(more: f64) -> bool {
    more.abs() > IMAGES.together
}

/// Correlation of what two signals change by from one frame to the next; nothing where too few neighbours tell.
fn correlation(frames: &[Option<Seen>], runs: &[usize], (one, other): Pair) -> Option<f64> {
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
    (count >= IMAGES.enough && xx > 0.0 && yy > 0.0).then(|| xy / (xx * yy).sqrt())
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
            correlation(&frames(light), &runs, (AREAS.start, AREAS.start + 1)).expect("400 frames")
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
    fn value_circles_scatter_together_from_three_tenths_on() {
        assert_eq!([0.28, 0.32, -0.32].map(is_shared), [false, true, true]);
    }
}
