//! Lost frames: a camera's rows come in whole intervals, so that a gap tells how many are missing.
//!
//! `frame` counts delivered frames. What it counts on by over a gap was delivered, and is missing in the log alone; unless a maker of logs
//! counts exposures.

use crate::error::Notice;
use crate::rigs::acrobot::dataset::{DataSet, Run, Table};

/// What the timestamps say.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Losses {
    /// Frames that should be there.
    pub expected: f64,
    /// Frames that are missing between others.
    pub lost: f64,
    /// Those of them over which `frame` counts on.
    pub counted: f64,
}

/// Counts over all runs, `interval` being the time between frames, s.
pub fn count_losses(data: &DataSet, interval: f64) -> Option<Losses> {
    let mut sum = Losses { expected: 0.0, lost: 0.0, counted: 0.0 };
    for camera in data.runs.iter().filter_map(|run| run.camera.as_ref()) {
        let own = losses_of(camera, interval);
        sum.expected += own.expected;
        sum.lost += own.lost;
        sum.counted += own.counted;
    }
    (sum.expected > 0.0).then_some(sum)
}

/// Those of one log.
fn losses_of(camera: &Table, interval: f64) -> Losses {
    let (mut lost, mut counted) = (0.0, 0.0);
    for (_, missing, delivered) in gaps(camera, interval) {
        lost += missing;
        counted += delivered;
    }
    Losses { expected: camera.len() as f64 + lost, lost, counted }
}

/// After which rows frames are missing, how many, and how many of these were delivered: `frame` may start anywhere, and begin again.
fn gaps(camera: &Table, interval: f64) -> Vec<(usize, f64, f64)> {
    // where rows of the file were excluded, frames are not lost
    let broken: Vec<(f64, f64)> = camera.broken().collect();
    let count = camera.column("frame");
    let gap = |row: usize| {
        let (from, to) = (camera.time[row], camera.time[row + 1]);
        let missing = ((to - from) / interval).round() - 1.0;
        let counted = count.map_or(1.0, |count| count[row + 1] - count[row]) - 1.0;
        let delivered = if counted > 0.0 { counted.min(missing) } else { 0.0 };
        (missing > 0.0 && !broken.contains(&(from, to))).then_some((row, missing, delivered))
    };
    (1..camera.len()).filter_map(|next| gap(next - 1)).collect()
}

/// Says of each run how many frames were delivered whose rows are missing.
pub fn tell_unlogged(data: &DataSet, interval: f64) -> Vec<Notice> {
    let notice = |run: &Run| {
        let camera = run.camera.as_ref()?;
        let gaps: Vec<_> = gaps(camera, interval).into_iter().filter(|gap| gap.2 > 0.0).collect();
        let rows: f64 = gaps.iter().map(|gap| gap.2).sum();
        let message = format!(
            "rows are missing after this one, and `frame` counts on over them ({rows} such frames in all): if it counts delivered frames, as it \
             should, the log alone lost them"
        );
        Some(Notice { file: format!("{}/camera.csv", run.name), line: camera.line[gaps.first()?.0], message })
    };
    data.runs.iter().filter_map(notice).collect()
}

impl Losses {
    /// Those alone that the count doesn't go on over, which no log lost.
    pub fn by_count(self) -> Self {
        Self { lost: self.lost - self.counted, ..self }
    }

    /// Share of frames lost.
    pub fn share(&self) -> f64 {
        self.lost / self.expected
    }

    /// Its interval of `z` standard errors (Wilson, J. Am. Stat. Assoc. 22 (1927) 209).
    pub fn interval(&self, z: f64) -> [f64; 2] {
        let (n, p) = (self.expected, self.share());
        let middle = (p + z * z / (2.0 * n)) / (1.0 + z * z / n);
        let half = z / (1.0 + z * z / n) * (p * (1.0 - p) / n + z * z / (4.0 * n * n)).sqrt();
        [(middle - half).max(0.0), middle + half]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn value_a_share_is_as_wilson_s_interval_has_it() {
        // 10 of 100: 0.0552 to 0.1744 (scipy.stats.binomtest(10, 100).proportion_ci(method="wilson"))
        let [low, high] = Losses { expected: 100.0, lost: 10.0, counted: 0.0 }.interval(1.959_964);
        assert!((low - 0.055_229).abs() < 1e-5 && (high - 0.174_366).abs() < 1e-5, "{low} {high}");
        assert_eq!(Losses { expected: 100.0, lost: 0.0, counted: 0.0 }.interval(3.0)[0], 0.0);
    }

    /// Frames 1/30 s apart, without some rows, counted so from row to row.
    fn camera(without: &[usize], frame: &dyn Fn(usize, usize) -> f64) -> Table {
        let rows: Vec<usize> = (0..100).filter(|row| !without.contains(row)).collect();
        let count = rows.iter().enumerate().map(|(delivered, row)| frame(delivered, *row)).collect();
        let time = rows.iter().map(|row| *row as f64 / 30.0).collect();
        Table::new(time, vec![("frame".into(), count)])
    }

    #[test]
    fn every_frame_that_the_count_goes_on_over_was_delivered() {
        let lost = |camera: &Table| {
            let losses = losses_of(camera, 1.0 / 30.0);
            assert_eq!(losses.lost, 3.0, "all that are missing");
            (losses.expected, losses.by_count().lost)
        };
        let gone = [20, 50, 51];
        // it counts delivered frames, from anywhere
        assert_eq!(lost(&camera(&gone, &|delivered, _| 700.0 + delivered as f64)), (100.0, 3.0));
        let unlogged = camera(&gone, &|_, row| 700.0 + row as f64);
        assert_eq!(lost(&unlogged), (100.0, 0.0));
        assert_eq!(gaps(&unlogged, 1.0 / 30.0), [(19, 1.0, 1.0), (48, 2.0, 2.0)]);
        // of two that are missing one was delivered; a count that begins anew, or that nobody wrote, says nothing
        assert_eq!(
            lost(&camera(&gone, &|_, row| if row > 51 { row as f64 - 1.0 } else { row as f64 })),
            (100.0, 1.0)
        );
        assert_eq!(
            lost(&camera(&gone, &|_, row| if row > 51 { row as f64 - 52.0 } else { row as f64 })),
            (100.0, 2.0)
        );
        assert_eq!(lost(&camera(&gone, &|_, _| f64::NAN)), (100.0, 3.0));
        // nor are there more than had the time
        assert_eq!(lost(&camera(&gone, &|_, row| 3.0 * row as f64)), (100.0, 0.0));
    }
}
