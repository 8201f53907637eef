//! The loop of a run: step, record, look at the stop conditions, tell how far it is.

use crate::checkpoint::{Checkpoint, Checkpoints};
use crate::error::Error;
use crate::guard::{Rescue, Rescued};
use crate::pacing::Keeping;
use crate::progress::Progress;
use crate::recorder::{Recorder, Slot};
use crate::simulation::{Phase, Simulation};
use crate::system::Values;
use std::time::{Duration, Instant};

/// Why a run ended.
#[derive(Debug, Clone, PartialEq)]
pub enum Ended {
    /// The stop time was reached.
    AtStop,
    /// A stop condition held.
    When {
        /// The condition, e.g. `plant.contact > 0.5`.
        condition: String,
        /// Simulated time in s.
        time: f64,
    },
    /// A unit ended it: it discarded a step and said `fmi2Terminated`. What it reached is the last row.
    ByUnit {
        /// Name in the scenario.
        unit: String,
        /// Simulated time in s.
        time: f64,
    },
    /// The progress asked for it.
    Interrupted {
        /// Simulated time in s.
        time: f64,
    },
}

/// How a value is compared by a stop condition.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Comparison {
    /// The run ends when the value is greater.
    Above,
    /// The run ends when the value is less.
    Below,
    /// The run ends when its absolute value is greater.
    AbsoluteAbove,
}

/// A stop condition.
#[derive(Debug, Clone)]
pub(crate) struct Stop {
    name: String,
    slot: Slot,
    comparison: Comparison,
    limit: f64,
}

impl Stop {
    fn holds(&self, values: &Values) -> bool {
        let value = match self.slot {
            Slot::Real(at) => values.reals[at as usize],
            Slot::Integer(at) | Slot::Boolean(at) => f64::from(values.integers[at as usize]),
            Slot::String(_) => return false,
        };
        match self.comparison {
            Comparison::Above => value > self.limit,
            Comparison::Below => value < self.limit,
            Comparison::AbsoluteAbove => value.abs() > self.limit,
        }
    }

    fn text(&self) -> String {
        let Self { name, limit, .. } = self;
        match self.comparison {
            Comparison::Above => format!("{name} > {limit}"),
            Comparison::Below => format!("{name} < {limit}"),
            Comparison::AbsoluteAbove => format!("|{name}| > {limit}"),
        }
    }
}

impl Simulation {
    /// Ends runs when a recorded or connected variable passes a limit; looked at in every communication point, the
    /// start included. The row at which it holds is recorded.
    ///
    /// # Errors
    /// If there is no such variable, it is a String, or it is neither recorded nor connected.
    pub fn stop_when(&mut self, name: &str, comparison: Comparison, limit: f64) -> Result<(), Error> {
        let derived = self.wiring.derived.get(name);
        let slot = match derived {
            Some(slot) => Some(slot),
            None => self.wiring.slots.get(&self.wiring.names.named(name)?),
        };
        match slot {
            Some(&slot) if !matches!(slot, Slot::String(_)) => {
                self.stops.push(Stop { name: name.into(), slot, comparison, limit });
                Ok(())
            }
            _ => Err(Error::Value {
                name: name.into(),
                value: limit.to_string(),
                expected: "a stop condition needs a number that is recorded or connected".into(),
            }),
        }
    }

    fn stopped(&self) -> Option<Ended> {
        let stop = self.stops.iter().find(|stop| stop.holds(&self.wiring.system.values))?;
        Some(Ended::When { condition: stop.text(), time: self.now.time })
    }

    /// Where units have processes of their own that are called one after the other, these and this thread may share a
    /// processor as long as this lives.
    #[cfg(isolation)]
    fn stepping_of_processes(&self) -> Option<crate::isolation::Stepping> {
        let any = self.wiring.names.units.iter().any(|(_, fmu)| fmu.isolation().is_some());
        (any && !self.algorithm.side_by_side()).then(crate::isolation::Stepping::begin)
    }

    /// There are no such units here.
    #[cfg(not(isolation))]
    fn stepping_of_processes(&self) {}
}

pub(crate) fn run(
    simulation: &mut Simulation,
    recorder: &mut dyn Recorder,
    progress: &mut dyn Progress,
) -> Result<Ended, Error> {
    run_on(simulation, None, None, recorder, progress)
}

pub(crate) fn run_on(
    simulation: &mut Simulation,
    from: Option<&Checkpoint>,
    checkpoints: Option<&Checkpoints>,
    recorder: &mut dyn Recorder,
    progress: &mut dyn Progress,
) -> Result<Ended, Error> {
    if checkpoints.is_some() {
        simulation.can_checkpoint()?;
    }
    simulation.reset();
    simulation.initialize()?;
    match from {
        Some(checkpoint) => {
            simulation.restore(checkpoint)?;
            recorder.go_on()?;
        }
        None => recorder.begin(simulation.columns())?,
    }
    let (start, stop) = simulation.span();
    progress.begin(start, stop);
    let mut pace = Pace::new(simulation.now.time);
    let mut keeping = simulation.pace.map(|factor| Keeping::new(factor, simulation.now.time));
    let mut saving = Saving::new(checkpoints, start, simulation.now.time);
    let rescued = Rescued::new(Rescue { rows: recorder.rescue(), time: &raw const simulation.now.time });
    let result = {
        let _stepping = simulation.stepping_of_processes();
        let first = from.is_none().then(|| recorder.row(simulation.now.time, simulation.row()));
        match first {
            Some(Err(error)) => Err(error),
            _ => {
                let (pace, saving, keeping) = (&mut pace, &mut saving, keeping.as_mut());
                Going { simulation, recorder, progress, pace, saving, keeping }.go()
            }
        }
    };
    simulation.lateness = keeping.map(|keeping| keeping.lateness);
    drop(rescued);
    simulation.phase = Phase::Over;
    // What was recorded before a failure is handed over too; the failure is what counts.
    let ended = recorder.end();
    progress.end(simulation.now.time, pace.factor(simulation.now.time));
    let result = result?;
    ended.map(|()| result)
}

/// A run that goes on from point to point.
struct Going<'a, 'c> {
    simulation: &'a mut Simulation,
    recorder: &'a mut dyn Recorder,
    progress: &'a mut dyn Progress,
    pace: &'a mut Pace,
    saving: &'a mut Saving<'c>,
    /// Keeps to the real clock, if that was asked for.
    keeping: Option<&'a mut Keeping>,
}

impl Going<'_, '_> {
    fn go(mut self) -> Result<Ended, Error> {
        // Where nobody looks at the values, the points up to the next look at the clock are made in one go.
        let unseen = self.simulation.stops.is_empty()
            && !self.recorder.records()
            && self.saving.to.is_none()
            && self.keeping.is_none();
        loop {
            let ended = if unseen { self.unseen_points()? } else { self.point()? };
            if let Some(ended) = ended {
                return Ok(ended);
            }
            if self.pace.left == 0 {
                let time = self.simulation.now.time;
                if self.progress.at(time, self.pace.look(time)).is_break() {
                    return Ok(Ended::Interrupted { time });
                }
            }
        }
    }

    /// All points up to the next look at the clock; how the run ended, if it did.
    #[inline]
    fn unseen_points(&mut self) -> Result<Option<Ended>, Error> {
        match self.simulation.advance_by(self.pace.left) {
            Err(Error::Terminated { unit, time }) => Ok(Some(Ended::ByUnit { unit, time })),
            Err(error) => Err(error),
            Ok(made) if made < self.pace.left => Ok(Some(Ended::AtStop)),
            Ok(_) => {
                self.pace.left = 0;
                Ok(None)
            }
        }
    }

    /// The next point and its row; how the run ended, if it did.
    #[inline]
    fn point(&mut self) -> Result<Option<Ended>, Error> {
        let Self { simulation, recorder, progress, pace, saving, keeping } = self;
        if let Some(ended) = simulation.stopped() {
            return Ok(Some(ended));
        }
        let before = simulation.now.time;
        match simulation.advance_by(1) {
            Err(Error::Terminated { unit, time }) => {
                if time > before {
                    recorder.row(time, simulation.row())?;
                }
                return Ok(Some(Ended::ByUnit { unit, time }));
            }
            Err(error) => return Err(error),
            Ok(0) => return Ok(Some(Ended::AtStop)),
            Ok(_) => {}
        }
        if let Some(keeping) = keeping {
            let time = simulation.now.time;
            if keeping.wait(time, || progress.at(time, pace.factor(time))).is_break() {
                recorder.row(time, simulation.row())?;
                return Ok(Some(Ended::Interrupted { time }));
            }
        }
        recorder.row(simulation.now.time, simulation.row())?;
        if simulation.now.time >= saving.next {
            saving.save(simulation, *recorder)?;
        }
        pace.left -= 1;
        Ok(None)
    }
}

/// When the next checkpoint is due, and where it goes.
struct Saving<'a> {
    to: Option<&'a Checkpoints>,
    start: f64,
    next: f64,
}

impl<'a> Saving<'a> {
    fn new(to: Option<&'a Checkpoints>, start: f64, now: f64) -> Self {
        let mut saving = Self { to, start, next: f64::INFINITY };
        saving.plan(now);
        saving
    }

    fn plan(&mut self, now: f64) {
        if let Some(to) = self.to {
            self.next = self.start + (((now - self.start) / to.every).floor() + 1.0) * to.every;
        }
    }

    #[cold]
    fn save(&mut self, simulation: &mut Simulation, recorder: &mut dyn Recorder) -> Result<(), Error> {
        if let Some(to) = self.to {
            let position = recorder.position()?;
            simulation.checkpoint(position)?.save(&to.file)?;
        }
        self.plan(simulation.now.time);
        Ok(())
    }
}

/// Looks at the real clock only so often that looking costs nothing: a look takes as long as a cheap step.
struct Pace {
    began: Instant,
    start: f64,
    looked: Instant,
    every: u32,
    left: u32,
}

impl Pace {
    fn new(start: f64) -> Self {
        let now = Instant::now();
        Self { began: now, start, looked: now, every: 1, left: 1 }
    }

    fn look(&mut self, time: f64) -> f64 {
        let now = Instant::now();
        let since = now - self.looked;
        self.looked = now;
        if since < Duration::from_millis(10) {
            self.every = self.every.saturating_mul(2);
        } else if since > Duration::from_millis(50) {
            self.every = (self.every / 2).max(1);
        }
        self.left = self.every;
        self.factor(time)
    }

    fn factor(&self, time: f64) -> f64 {
        (time - self.start) / self.began.elapsed().as_secs_f64().max(1e-9)
    }
}

#[cfg(test)]
mod tests {
    use super::{Duration, Pace};

    #[test]
    fn law_the_clock_is_looked_at_less_often_the_quicker_the_steps_are() {
        let mut pace = Pace::new(0.0);
        pace.every = 8;
        // So long ago was the last look: longer than the bound, whatever this takes beside; and no machine runs shorter than that.
        let mut after = |seconds: u64| {
            pace.looked -= Duration::from_secs(seconds);
            pace.look(1.0);
            assert_eq!(pace.left, pace.every);
            pace.every
        };
        assert_eq!([1, 1, 1, 1].map(&mut after), [4, 2, 1, 1]);
        pace.every = u32::MAX - 1;
        pace.looked = std::time::Instant::now() + Duration::from_secs(3600);
        pace.look(1.0);
        assert_eq!(pace.every, u32::MAX, "a look that came at once");
    }

    #[test]
    fn value_the_speed_is_simulated_seconds_a_second_since_the_start() {
        let mut pace = Pace::new(10.0);
        pace.began -= Duration::from_secs(10);
        // A run of ten seconds, and what this test takes: far less than another ten.
        let factor = pace.factor(40.0);
        assert!(factor <= 3.0 && factor > 1.5, "{factor}");
    }
}
