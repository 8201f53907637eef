//! Clocks of their own: units that begin at 0 whatever start time they are told, so that their first step goes the whole way from there, and
//! units that make steps of one size and as many as it takes to come by the end. Both are common among generated code.

use super::linearise::Engine;
use super::machine::Machine;
use super::policy::DYNAMICS;
use super::schedule::{Piece, Schedule};
use super::worker::{Job, Worker};
use crate::error::Error;
use crate::statistics::levels::{FAR, FEW, HALF, ROUNDING};
use std::cmp::Ordering;
use std::time::Instant;

/// What is shown where a stretch begins and where it ends.
type Shown = (Vec<f64>, Vec<f64>);

/// The first step of a log, tried at different times and lengths; never far from 0, for a unit that begins there steps all the way.
struct Trial<'a> {
    engine: &'a Engine,
    schedule: Schedule,
    states: Vec<f64>,
}

impl<'a> Trial<'a> {
    fn new(engine: &'a Engine) -> Self {
        let grid = &engine.grids[0];
        let schedule = Schedule::new(&engine.machine, grid, &engine.machine.neutral());
        Self { engine, schedule, states: engine.nominal_states(grid, 0) }
    }

    fn job(&self) -> Job<'_> {
        self.schedule.job(0.0, 0, 1, &self.states)
    }

    /// Length of the step.
    fn span(&self) -> f64 {
        self.job().pieces.first().map_or(0.0, |piece| piece.span)
    }

    /// Started at a time and stepped so far; nothing where a unit refuses that.
    fn stepped(&self, worker: &mut Worker, time: f64, span: f64) -> Option<Shown> {
        let machine = &self.engine.machine;
        let (pieces, whole) = ([Piece { from: time, span, reads: 0 }], self.job());
        let fed = &whole.fed[..machine.inputs.len()];
        let one = Job { time, first: &[0, 1], pieces: &pieces, fed, reads: &[], each_row: true, ..whole };
        let mut out = Vec::new();
        worker.interval(machine, &one, &mut out).ok()?;
        let end = out.split_off(machine.order() + machine.channels.len());
        let begin = out.split_off(machine.order());
        Some((begin, [out, end].concat()))
    }

    /// Told a start and stepped, the model goes where one step from 0 leads to the same end, and not where a step of the same length from 0
    /// leads. A unit that follows the time itself shows it as soon as it is initialised.
    fn begins_at_zero(&self, worker: &mut Worker) -> Option<bool> {
        let span = self.span();
        let told = self.stepped(worker, span, span)?;
        let (short, long) = (self.stepped(worker, 0.0, span)?, self.stepped(worker, 0.0, span + span)?);
        Some(told.0 == short.0 && told.1 == long.1 && told.1 != short.1)
    }

    /// Time that a step takes; nothing where a unit refuses it. The shortest of a few: whatever else a computer does only adds to it.
    fn takes(&self, worker: &mut Worker, span: f64) -> Option<f64> {
        let mut one = || {
            let began = Instant::now();
            self.stepped(worker, 0.0, span).map(|_| began.elapsed().as_secs_f64())
        };
        (0..FEW).map(|_| one()).min_by(|a, b| a.partial_cmp(b).unwrap_or(Ordering::Equal)).flatten()
    }

    /// Steps of different lengths lead to the same bits, though the model moves.
    fn makes_own_steps(&self, worker: &mut Worker) -> Option<bool> {
        let lengths = lengths(self.span());
        let (short, long) = (self.stepped(worker, 0.0, lengths.0)?, self.stepped(worker, 0.0, lengths.1)?);
        let states = self.engine.machine.order();
        let moved = short.1[states..] != short.0[..] || short.1[..states] != self.states[..];
        Some(moved && short.1 == long.1)
    }
}

/// Lengths of a step whose ends a unit with steps of its own can't tell apart.
fn lengths(span: f64) -> (f64, f64) {
    (DYNAMICS.lengths.0 * span, DYNAMICS.lengths.1 * span)
}

impl Engine {
    /// Whether units step so many times as far as a row is long, at less than so many times the cost: their own steps are not much shorter than
    /// that. The way there is in leaps of ten; where a leap costs in proportion to its length the rest is known.
    pub(crate) fn steps_as_far(&self, factor: f64, most: f64) -> bool {
        let trial = Trial::new(self);
        let span = trial.span();
        let far = |worker: &mut Worker| {
            let Some(usual) = trial.takes(worker, span) else { return Ok(false) };
            let leaps = (1..).map(|leap| FAR.powi(leap)).take_while(|by| *by < factor).chain([factor]);
            let can = |by: f64| {
                let takes = trial.takes(worker, by * span).map_or(f64::INFINITY, |takes| takes / usual);
                takes < if takes < HALF * by { most } else { most * by / factor }
            };
            Ok(leaps.into_iter().all(can))
        };
        self.with_worker(far).unwrap_or(false)
    }

    /// Tries both at the first step of the first run.
    ///
    /// # Errors
    /// A unit can't be instantiated.
    pub(super) fn try_clock(&self) -> Result<OwnClock, Error> {
        let trial = Trial::new(self);
        self.with_worker(|worker| {
            let at_zero = trial.begins_at_zero(worker).unwrap_or(false);
            Ok(OwnClock { at_zero, own_steps: trial.makes_own_steps(worker).unwrap_or(false) })
        })
    }
}

/// What units do otherwise than their master says.
pub(super) struct OwnClock {
    /// They begin at 0 whatever start time they are told.
    pub at_zero: bool,
    /// They make steps of one size and as many as it takes.
    pub own_steps: bool,
}

impl OwnClock {
    /// Ticks a second of the clock that a unit which begins at 0 gets: a power of ten, so that decimal times of a log come out as they would
    /// be written.
    pub fn ticks(&self, machine: &Machine) -> Option<f64> {
        let ticks = 10f64.powf(-(ROUNDING * machine.longest).log10().floor()).max(1.0);
        self.at_zero.then_some(ticks)
    }

    /// What a user should know.
    pub fn notices(&self, machine: &Machine) -> impl Iterator<Item = String> {
        let at_zero = "the model begins at 0 whatever start time it is told: it gets a clock that begins at 0 wherever it is started";
        let own_steps = "the model makes steps of one size, however long it is asked to: what acts within a row acts as its mean";
        let all = [(self.at_zero, at_zero), (self.own_steps && machine.any_step, own_steps)];
        all.into_iter().filter(|(is_so, _)| *is_so).map(|(_, message)| message.to_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::lengths;

    #[test]
    fn value_a_unit_that_makes_less_than_ten_steps_of_its_own_is_told() {
        let ends_at_the_same = |steps: f64| {
            let end = |length: f64| (steps * length).ceil();
            let (short, long) = lengths(1.0);
            end(short) == end(long)
        };
        assert!((1..10).all(|steps| ends_at_the_same(f64::from(steps))));
        // of one with many, what acts within a row acts nearly when it does
        assert!([15.0, 25.0, 40.0].into_iter().all(|steps| !ends_at_the_same(steps)));
    }
}
