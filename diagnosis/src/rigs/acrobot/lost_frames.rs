//! Lost frames: a camera's rows come in whole intervals, so that a gap tells how many are missing.

use crate::rigs::acrobot::dataset::{DataSet, Table};

/// What the timestamps say.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Losses {
    /// Frames that should be there.
    pub expected: f64,
    /// Frames that are missing between others.
    pub lost: f64,
}

/// Counts over all runs, `interval` being the time between frames, s.
pub fn count_losses(data: &DataSet, interval: f64) -> Option<Losses> {
    let mut sum = Losses { expected: 0.0, lost: 0.0 };
    for camera in data.runs.iter().filter_map(|run| run.camera.as_ref()) {
        let (expected, lost) = losses_of(camera, interval);
        sum.expected += expected;
        sum.lost += lost;
    }
    (sum.expected > 0.0).then_some(sum)
}

/// Frames that should be there, and those that are missing.
fn losses_of(camera: &Table, interval: f64) -> (f64, f64) {
    // where rows of the file were excluded, frames are not lost
    let broken: Vec<(f64, f64)> = camera.broken().collect();
    let whole = camera.time.windows(2).filter(|pair| !broken.contains(&(pair[0], pair[1])));
    let lost: f64 = whole.map(|pair| ((pair[1] - pair[0]) / interval).round().max(1.0) - 1.0).sum();
    (camera.len() as f64 + lost, lost)
}

impl Losses {
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
        let [low, high] = Losses { expected: 100.0, lost: 10.0 }.interval(1.959_964);
        assert!((low - 0.055_229).abs() < 1e-5 && (high - 0.174_366).abs() < 1e-5, "{low} {high}");
        assert_eq!(Losses { expected: 100.0, lost: 0.0 }.interval(3.0)[0], 0.0);
    }
}
