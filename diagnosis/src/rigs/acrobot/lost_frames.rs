//! Lost frames: a camera's rows come in whole intervals, so that a gap tells how many are missing.
//!
//! `frame` counts delivered frames. What it counts on by over a gap was delivered, and is missing in the log alone; unless a maker of logs
//! counts exposures. Where nobody wrote it, a controller that is driven by frames tells: it commands a new torque for each that it got.

use crate::error::Notice;
use crate::rigs::acrobot::dataset::{DataSet, Run, Table};
use crate::statistics::levels::{HALF, MORE, SMALL};

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
    for run in &data.runs {
        let Some(camera) = &run.camera else { continue };
        let own = losses_of(camera, run.controller.as_ref(), interval);
        sum.expected += own.expected;
        sum.lost += own.lost;
        sum.counted += own.counted;
    }
    (sum.expected > 0.0).then_some(sum)
}

/// Those of one log.
fn losses_of(camera: &Table, controller: Option<&Table>, interval: f64) -> Losses {
    let (mut missing, mut counted, mut unlogged) = (0.0, 0.0, 0.0);
    for gap in gaps(camera, controller, interval) {
        missing += gap.missing;
        counted += gap.counted;
        unlogged += gap.answered;
    }
    Losses { expected: camera.len() as f64 + missing, lost: missing - unlogged, counted }
}

/// Frames that are missing after a row.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Gap {
    row: usize,
    missing: f64,
    /// Those of them over which `frame` counts on.
    counted: f64,
    /// Those of them, where nobody wrote `frame`, for which there is a new torque.
    answered: f64,
}

/// Where frames are missing: `frame` may start anywhere, and begin again.
fn gaps(camera: &Table, controller: Option<&Table>, interval: f64) -> Vec<Gap> {
    // where rows of the file were excluded, frames are not lost
    let broken: Vec<(f64, f64)> = camera.broken().collect();
    let count = camera.column("frame");
    let torques = controller.filter(|_| count.is_none()).map(|log| answers(camera, &changes(log), interval));
    let torques = torques.filter(|at| follows_frames(camera, at, interval));
    let gap = |row: usize| {
        let (from, to) = (camera.time[row], camera.time[row + 1]);
        let missing = ((to - from) / interval).round() - 1.0;
        let counted = count.map_or(1.0, |count| count[row + 1] - count[row]) - 1.0;
        let answered = torques.as_ref().map_or(0, |at| between(at, from, to).saturating_sub(1)) as f64;
        let part = |frames: f64| if frames > 0.0 { frames.min(missing) } else { 0.0 };
        let gap = Gap { row, missing, counted: part(counted), answered: part(answered) };
        (missing > 0.0 && !broken.contains(&(from, to))).then_some(gap)
    };
    (1..camera.len()).filter_map(|next| gap(next - 1)).collect()
}

/// When a new torque is commanded, s; a cell that is empty commands none.
pub fn changes(controller: &Table) -> Vec<f64> {
    let Some(torque) = controller.column("tau") else { return Vec::new() };
    let known: Vec<usize> = (0..torque.len()).filter(|row| torque[*row].is_finite()).collect();
    let new = known.windows(2).filter(|pair| torque[pair[1]] != torque[pair[0]]);
    new.map(|pair| controller.time[pair[1]]).collect()
}

/// When torques are commanded, each half an interval after the frame that it answers, however long it takes: computers read their clocks late, and a
/// torque that comes at once may be stamped before its frame. The typical phase is the mean of a circle's (Mardia, Jupp, Directional Statistics, section 2.2).
fn answers(camera: &Table, torques: &[f64], interval: f64) -> Vec<f64> {
    let phase = |time: &f64| {
        let next = camera.time.partition_point(|frame| frame <= time);
        let since = time - camera.time.get(next.checked_sub(1)?)?;
        (since < MORE * interval).then_some(std::f64::consts::TAU * since / interval)
    };
    let on_circle = torques.iter().filter_map(phase).map(|phase| (libm::sin(phase), libm::cos(phase)));
    let (sin, cos) = on_circle.fold((0.0, 0.0), |sum, one| (sum.0 + one.0, sum.1 + one.1));
    let typical = libm::atan2(sin, cos).rem_euclid(std::f64::consts::TAU) / std::f64::consts::TAU;
    torques.iter().map(|time| time + (HALF - typical) * interval).collect()
}

/// How many of these times lie between two.
fn between(times: &[f64], from: f64, to: f64) -> usize {
    times.partition_point(|time| *time < to).saturating_sub(times.partition_point(|time| *time < from))
}

/// Whether nearly every frame that has a next one has one new torque, and no more.
fn follows_frames(camera: &Table, torques: &[f64], interval: f64) -> bool {
    let next = camera.time.windows(2).filter(|pair| pair[1] - pair[0] < MORE * interval);
    let each: Vec<usize> = next.map(|pair| between(torques, pair[0], pair[1])).collect();
    let one = each.iter().filter(|count| **count == 1).count();
    one as f64 > (1.0 - SMALL) * each.len() as f64
}

/// Says of each run how many frames were delivered whose rows are missing.
pub fn tell_unlogged(data: &DataSet, interval: f64) -> Vec<Notice> {
    let notice = |run: &Run| {
        let camera = run.camera.as_ref()?;
        let gaps = gaps(camera, run.controller.as_ref(), interval);
        let delivered: Vec<Gap> = gaps.into_iter().filter(|gap| gap.counted + gap.answered > 0.0).collect();
        let rows: f64 = delivered.iter().map(|gap| gap.counted + gap.answered).sum();
        let first = delivered.first()?;
        let message = if first.counted > 0.0 {
            format!(
                "rows are missing after this one, and `frame` counts on over them ({rows} such frames in all): if it counts delivered frames, as \
                 it should, the log alone lost them"
            )
        } else {
            format!(
                "rows are missing after this one, and controller.csv has a new torque for each ({rows} such frames in all): the camera delivered \
                 them, and the log alone lost them"
            )
        };
        Some(Notice { file: format!("{}/camera.csv", run.name), line: camera.line[first.row], message })
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
            let losses = losses_of(camera, None, 1.0 / 30.0);
            assert_eq!(losses.lost, 3.0, "all that are missing");
            (losses.expected, losses.by_count().lost)
        };
        let gone = [20, 50, 51];
        // it counts delivered frames, from anywhere
        assert_eq!(lost(&camera(&gone, &|delivered, _| 700.0 + delivered as f64)), (100.0, 3.0));
        let unlogged = camera(&gone, &|_, row| 700.0 + row as f64);
        assert_eq!(lost(&unlogged), (100.0, 0.0));
        let found = gaps(&unlogged, None, 1.0 / 30.0);
        let found: Vec<_> = found.iter().map(|gap| (gap.row, gap.missing, gap.counted)).collect();
        assert_eq!(found, [(19, 1.0, 1.0), (48, 2.0, 2.0)]);
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

    #[test]
    fn every_frame_for_which_there_is_a_new_torque_was_delivered() {
        let gone = [20, 50, 51];
        let rows: Vec<f64> =
            (0..100).filter(|row| !gone.contains(row)).map(|row| row as f64 / 30.0).collect();
        let camera = Table::new(rows, Vec::new());
        // 7 ms after each frame, but for those that were lost
        let torque = |lost: &[usize], each: usize| {
            let rows = (0..100 * each).filter(|row| !lost.contains(&(row / each)));
            let (time, tau) = rows.map(|row| (row as f64 / (30.0 * each as f64) + 0.007, row as f64)).unzip();
            Table::new(time, vec![("tau".into(), tau)])
        };
        let lost = |controller: &Table| losses_of(&camera, Some(controller), 1.0 / 30.0).lost;
        assert_eq!(
            [lost(&torque(&gone, 1)), lost(&torque(&[50], 1)), lost(&torque(&[], 1))],
            [3.0, 1.0, 0.0]
        );
        // one that comes at once, and both logs read their clocks up to 2 ms late
        let late = |row: usize, of: usize| (row as f64 / 30.0) + 2e-3 * ((row * of) % 7) as f64 / 7.0;
        let frames = (0..100).filter(|row| !gone.contains(row)).map(|row| late(row, 3)).collect();
        let at_once = (0..100).map(|row| (late(row, 5), row as f64)).unzip();
        let controller = Table::new(at_once.0, vec![("tau".into(), at_once.1)]);
        assert_eq!(losses_of(&Table::new(frames, Vec::new()), Some(&controller), 1.0 / 30.0).lost, 0.0);
        // cells that are empty where frames were lost are no answer
        let time = (0..100).map(|row| row as f64 / 30.0 + 0.007).collect();
        let tau = (0..100).map(|row| if gone.contains(&row) { f64::NAN } else { row as f64 }).collect();
        let empty = Table::new(time, vec![("tau".into(), tau)]);
        assert_eq!(lost(&empty), 3.0);
        // a loop by encoders says nothing of frames
        assert_eq!(lost(&torque(&[], 4)), 3.0);
    }
}
