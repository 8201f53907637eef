//! Real time: values come when they are due, for hardware or people beside the simulation, and how late they came is told.
//!
//! A point at the simulated time t is due (t - start)/factor after the run began. A run that is behind goes on as fast as
//! it can until it has caught up: the due times stay.

use std::fmt;
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

/// The system wakes a sleeper some 60 µs late; the rest is waited for.
const WAKING: Duration = Duration::from_micros(150);

/// Sleeps are cut to this, so that whoever wants to end the run is heard.
const LONGEST: Duration = Duration::from_millis(50);

/// How late values came, in real seconds.
#[derive(Debug, Clone, PartialEq)]
pub struct Lateness {
    /// Simulated seconds a second that were asked for.
    pub factor: f64,
    /// Points after the start.
    pub points: u64,
    /// Mean of all points.
    pub mean: f64,
    /// Their standard deviation: the jitter.
    pub deviation: f64,
    /// Of the latest point.
    pub most: f64,
    /// When the latest point was due, in simulated seconds.
    pub at: f64,
    /// Points that came when the next one was due already.
    pub missed: u64,
    /// Sum of squares of the distances from the mean.
    squares: f64,
}

impl Lateness {
    fn new(factor: f64) -> Self {
        let (points, missed) = (0, 0);
        Self { factor, points, mean: 0.0, deviation: 0.0, most: 0.0, at: 0.0, missed, squares: 0.0 }
    }

    /// Welford's sums.
    fn add(&mut self, time: f64, late: f64) {
        self.points += 1;
        let off = late - self.mean;
        self.mean += off / self.points as f64;
        self.squares += off * (late - self.mean);
        self.deviation = (self.squares / self.points as f64).sqrt();
        if late > self.most {
            (self.most, self.at) = (late, time);
        }
    }

    /// For programs.
    pub fn to_json(&self) -> String {
        let Self { factor, points, mean, deviation, most, at, missed, .. } = self;
        format!(
            "{{\n  \"format\": 1,\n  \"factor\": {factor},\n  \"points\": {points},\n  \"late_mean\": {mean},\n  \
             \"late_deviation\": {deviation},\n  \"late_most\": {most},\n  \"late_most_at\": {at},\n  \
             \"missed\": {missed}\n}}\n"
        )
    }
}

/// `real time x 1: 600 points, 0.06 ms late on average (jitter 0.02 ms), 0.3 ms at most (t = 2.5 s), none missed`
impl fmt::Display for Lateness {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ms = |seconds: f64| (seconds * 1e6).round() / 1e3;
        let missed = match self.missed {
            0 => "none missed".to_owned(),
            1 => "1 missed: it came when the next one was due already".into(),
            more => format!("{more} missed: they came when the next ones were due already"),
        };
        write!(
            f,
            "real time x {}: {} points, {} ms late on average (jitter {} ms), {} ms at most (t = {} s), {missed}",
            self.factor,
            self.points,
            ms(self.mean),
            ms(self.deviation),
            ms(self.most),
            self.at
        )
    }
}

/// A run that keeps to the real clock.
pub(crate) struct Keeping {
    began: Instant,
    start: f64,
    /// When the point before came, in real seconds since the begin.
    before: Option<f64>,
    pub(crate) lateness: Lateness,
}

impl Keeping {
    /// From a simulated time on that is now.
    pub(crate) fn new(factor: f64, start: f64) -> Self {
        Self { began: Instant::now(), start, before: None, lateness: Lateness::new(factor) }
    }

    /// Waits until a point is due; asks now and then whether the run goes on.
    pub(crate) fn wait(
        &mut self,
        time: f64,
        mut goes_on: impl FnMut() -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let due = (time - self.start) / self.lateness.factor;
        if self.before.is_some_and(|came| came > due) {
            self.lateness.missed += 1;
        }
        let due_after = Duration::try_from_secs_f64(due.max(0.0)).unwrap_or(Duration::MAX);
        loop {
            let left = due_after.saturating_sub(self.began.elapsed());
            if left.is_zero() {
                break;
            }
            match nap(left) {
                Some(nap) => {
                    std::thread::sleep(nap);
                    goes_on()?;
                }
                None => std::hint::spin_loop(),
            }
        }
        let came = self.began.elapsed().as_secs_f64();
        self.before = Some(came);
        self.lateness.add(time, (came - due).max(0.0));
        ControlFlow::Continue(())
    }
}

/// How long to sleep where so much is left, if it pays.
fn nap(left: Duration) -> Option<Duration> {
    (left > WAKING).then(|| (left - WAKING).min(LONGEST))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn value_a_nap_ends_before_the_point_is_due() {
        let more = Duration::from_micros(10);
        for (left, expected) in [
            (Duration::ZERO, None),
            (WAKING, None),
            (WAKING + more, Some(more)),
            (WAKING + LONGEST, Some(LONGEST)),
            (WAKING + LONGEST + more, Some(LONGEST)),
            (Duration::MAX, Some(LONGEST)),
        ] {
            assert_eq!(nap(left), expected, "{left:?}");
        }
    }

    #[test]
    fn value_mean_jitter_and_the_latest() {
        let mut lateness = Lateness::new(2.0);
        // numpy: mean 2.5e-3, std 1.118033988749895e-3
        for (time, late) in [(0.5, 1e-3), (1.0, 4e-3), (1.5, 2e-3), (2.0, 3e-3)] {
            lateness.add(time, late);
        }
        assert!(
            (lateness.mean - 2.5e-3).abs() < 1e-17
                && (lateness.deviation - 1.118033988749895e-3).abs() < 1e-17
        );
        lateness.missed = 1;
        let told = "real time x 2: 4 points, 2.5 ms late on average (jitter 1.118 ms), 4 ms at most (t = 1 s), 1 missed: it \
                    came when the next one was due already";
        assert_eq!(lateness.to_string(), told);
        assert!(lateness.to_json().contains("\"late_most_at\": 1,\n  \"missed\": 1\n}"));
    }

    #[test]
    fn law_no_point_comes_before_it_is_due_and_late_ones_are_counted() {
        let mut keeping = Keeping::new(10.0, 1.0);
        let came = |keeping: &Keeping| keeping.began.elapsed();
        assert!(keeping.wait(1.2, || ControlFlow::Continue(())).is_continue());
        assert!(came(&keeping) >= Duration::from_millis(20));
        // What comes late does not move what is due later.
        std::thread::sleep(Duration::from_millis(30));
        for time in [1.3, 1.4, 1.5] {
            assert!(keeping.wait(time, || ControlFlow::Continue(())).is_continue());
        }
        assert!(keeping.lateness.missed >= 1 && keeping.lateness.points == 4, "{}", keeping.lateness);
        assert!(keeping.lateness.most >= 0.019, "due after 30 ms, came after 50");
        // Counted from when it was due.
        let due = (keeping.lateness.at - 1.0) / 10.0;
        assert!(keeping.lateness.most <= came(&keeping).as_secs_f64() - due, "{}", keeping.lateness);
        // Whoever wants to end the run is heard while it waits.
        assert!(keeping.wait(1e9, || ControlFlow::Break(())).is_break());
    }

    #[test]
    fn law_a_point_is_missed_that_is_due_before_the_last_one_came() {
        // All are due before the clock began, so that none is waited for.
        for (came, missed) in [(-0.5, 1), (-0.999, 1), (-1.001, 0), (-2.0, 0)] {
            let mut keeping = Keeping::new(2.0, 10.0);
            keeping.before = Some(came);
            assert!(keeping.wait(8.0, || ControlFlow::Continue(())).is_continue());
            assert_eq!(keeping.lateness.missed, missed, "due at -1 s, the last one came at {came} s");
        }
    }
}
