//! Thins a long line to what a screen can show, without losing a peak.

use std::collections::HashSet;

/// Keeps at most about `4 * columns` points: of each column of the picture the first, lowest, highest and last.
/// Points must be ordered by x; a line that is short already comes back as it is.
pub fn thin(points: &[(f64, f64)], columns: usize) -> Vec<(f64, f64)> {
    if points.len() <= 4 * columns || columns == 0 {
        return points.to_vec();
    }
    let (first, last) = (points[0].0, points[points.len() - 1].0);
    let width = (last - first) / columns as f64;
    if width.is_nan() || width <= 0.0 {
        return points.to_vec();
    }
    let column = |x: f64| (((x - first) / width) as usize).min(columns - 1);
    points.chunk_by(|a, b| column(a.0) == column(b.0)).flat_map(extremes).collect()
}

/// Leaves out of points what nobody could see: those that would lie on the same pixel of a picture of this size as one before.
pub(crate) fn apart(
    points: &[(f64, f64)],
    (x, y): ((f64, f64), (f64, f64)),
    (wide, high): (u32, u32),
) -> Vec<(f64, f64)> {
    let place = |value: f64, (from, to): (f64, f64), pixels: u32| {
        ((value - from) / (to - from) * f64::from(pixels)).round() as i64
    };
    let mut taken = HashSet::new();
    let is_free = |at: &&(f64, f64)| taken.insert((place(at.0, x, wide), place(at.1, y, high)));
    points.iter().filter(is_free).copied().collect()
}

/// The corners of a line whose values are held until the next point.
pub(crate) fn steps(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let corners = points.windows(2).flat_map(|pair| [pair[0], (pair[1].0, pair[0].1)]);
    corners.chain(points.last().copied()).collect()
}

/// First, lowest, highest and last point of a run, in their order, each once; all four of four.
fn extremes(run: &[(f64, f64)]) -> Vec<(f64, f64)> {
    if run.len() <= 4 {
        return run.to_vec();
    }
    let by_y = |a: &usize, b: &usize| run[*a].1.total_cmp(&run[*b].1);
    let lowest = (0..run.len()).min_by(by_y).unwrap_or(0);
    let highest = (0..run.len()).max_by(by_y).unwrap_or(0);
    let mut keep = [0, lowest, highest, run.len() - 1];
    keep.sort_unstable();
    let mut kept: Vec<usize> = keep.to_vec();
    kept.dedup();
    kept.into_iter().map(|index| run[index]).collect()
}

/// The same for a line that comes point by point and may be longer than memory: it keeps buckets of equally many
/// points, and when there are too many buckets it joins them two by two.
#[derive(Debug, Clone)]
pub struct Thinner {
    buckets: Vec<Vec<(f64, f64)>>,
    /// Points that a bucket stands for, and how many the last one has taken.
    per_bucket: usize,
    taken: usize,
}

/// Buckets of a [`Thinner`], at most: up to four times as many points all stay.
const BUCKETS: usize = 32_768;

impl Default for Thinner {
    fn default() -> Self {
        Self { buckets: Vec::new(), per_bucket: 1, taken: 0 }
    }
}

impl Thinner {
    /// Adds the next point.
    pub fn push(&mut self, x: f64, y: f64) {
        if self.taken == 0 {
            if self.buckets.len() == BUCKETS {
                self.halve();
            }
            self.buckets.push(Vec::with_capacity(5));
        }
        if let Some(bucket) = self.buckets.last_mut() {
            bucket.push((x, y));
            if bucket.len() > 4 {
                *bucket = extremes(bucket);
            }
        }
        self.taken = (self.taken + 1) % self.per_bucket;
    }

    fn halve(&mut self) {
        self.buckets = self.buckets.chunks(2).map(|pair| extremes(&pair.concat())).collect();
        self.per_bucket *= 2;
    }

    /// The thinned line.
    pub fn finish(self) -> Vec<(f64, f64)> {
        self.buckets.concat()
    }
}

#[cfg(test)]
mod tests {
    use super::{BUCKETS, Thinner, apart, steps, thin};

    #[test]
    fn law_peaks_survive() {
        let mut points: Vec<(f64, f64)> = (0..100_000).map(|i| (i as f64, (i as f64 * 1e-3).sin())).collect();
        points[54_321].1 = 7.0;
        points[54_322].1 = -7.0;
        let thinned = thin(&points, 600);
        assert!(thinned.len() <= 2400, "{} points left", thinned.len());
        assert!(thinned.contains(&(54_321.0, 7.0)) && thinned.contains(&(54_322.0, -7.0)));
        assert_eq!((thinned[0], thinned[thinned.len() - 1]), (points[0], points[99_999]));
        assert!(thinned.windows(2).all(|pair| pair[0].0 < pair[1].0), "order is kept, no point twice");
    }

    #[test]
    fn law_a_stream_keeps_its_peaks_in_bounded_memory() {
        let mut thinner = Thinner::default();
        for i in 0..400_000 {
            thinner.push(i as f64, if i == 123_457 { 9.0 } else { (i as f64 * 1e-3).sin() });
        }
        let thinned = thinner.finish();
        assert!(thinned.len() <= 4 * BUCKETS, "{} points left", thinned.len());
        assert!(thinned.contains(&(123_457.0, 9.0)));
        assert_eq!((thinned[0].0, thinned[thinned.len() - 1].0), (0.0, 399_999.0));
        assert!(thinned.windows(2).all(|pair| pair[0].0 < pair[1].0), "order is kept, no point twice");
        let mut thinner = Thinner::default();
        (0..100_000).for_each(|i| thinner.push(f64::from(i), f64::from(i * 7919 % 100_003)));
        assert_eq!(thinner.finish().len(), 100_000, "as many as that all stay");
    }

    #[test]
    fn law_points_go_only_where_another_one_lies() {
        // Seven columns, as of an Integer, each full: the extremes of a column say nothing of the rest.
        let points: Vec<(f64, f64)> = (0..20_000).map(|i| (f64::from(i % 7), f64::from(i))).collect();
        let kept = apart(&points, ((0.0, 6.0), (0.0, 20_000.0)), (640, 380));
        assert_eq!(kept.len(), 7 * 381, "one a pixel");
        assert_eq!(apart(&points[..50], ((0.0, 6.0), (0.0, 50.0)), (640, 380)), points[..50]);
    }

    #[test]
    fn value_held_values_have_corners() {
        let corners = steps(&[(0.0, 0.0), (1.0, 1.0), (2.0, 0.0)]);
        assert_eq!(corners, [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (2.0, 1.0), (2.0, 0.0)]);
        assert_eq!((steps(&[]), steps(&[(1.0, 2.0)])), (vec![], vec![(1.0, 2.0)]));
    }

    #[test]
    fn law_short_lines_are_untouched() {
        let points = [(0.0, 1.0), (1.0, f64::NAN), (2.0, 3.0)];
        assert_eq!(thin(&points, 600).len(), 3);
    }
}
