//! What the units can do, tried on the first run: their clocks, resets, memory, and whether they show their states.

use super::build::{Span, nominal_states, prior};
use super::grid::Grid;
use super::linearise::Engine;
use super::schedule::Schedule;
use super::worker::{Job, Worker};
use crate::error::{Error, Notice};
use crate::observe::{Problem, Reading, Run};
use crate::statistics::levels::STEP;
use std::collections::BTreeMap;

/// What a user should know of a data set's model.
fn notice(message: String) -> Notice {
    Notice { file: "dataset.toml".into(), line: 0, message }
}

/// Whether a state is what was set, but for rounding.
fn is_same(set: f64, shown: f64) -> bool {
    (set - shown).abs() <= 1e-6 * (set.abs() + shown.abs() + 1e-6)
}

impl Engine {
    /// The engine as its units can be driven, with sizes of what no log tells, and what a user should know. `sizes`: how far each channel
    /// moves, in its own unit.
    ///
    /// # Errors
    /// A unit failed, or a run that is simulated whole has too many states.
    pub(super) fn probed(
        mut self,
        problem: &Problem,
        runs: &[(&Run, Span)],
        sizes: &[f64],
    ) -> Result<(Self, Vec<Notice>), Error> {
        let clock = self.try_clock()?;
        let mut notices: Vec<Notice> = clock.notices(&self.machine).map(notice).collect();
        self.machine.own_clock = clock.ticks(&self.machine);
        self.machine.any_step &= !clock.own_steps;
        self.resets = self.can_reset()?;
        if !self.resets {
            let message = "fmi2Reset doesn't bring the unit back to where it began: a fresh instance for each interval instead";
            notices.push(notice(message.into()));
        }
        if problem.whole {
            self.scales = self.unmeasured_scales(sizes)?;
            self.follow_whole(runs, sizes);
        } else {
            notices.extend(self.unbind_states()?.into_iter().map(notice));
        }
        if !problem.whole && self.machine.states.is_empty() && self.remembers(sizes)? {
            self.follow_whole(runs, sizes);
            let message = "no state of the model can be set (no start parameter, no output of initial \"exact\"): each run is \
                           simulated whole from the model's own start, and no window begins anew";
            notices.push(notice(message.into()));
        }
        if self.machine.whole {
            self.whole_states()?;
        } else {
            self.scales = self.unmeasured_scales(sizes)?;
        }
        self.input_scales = self.unlogged_scales(sizes)?;
        notices.extend(self.read_through_outputs()?);
        if problem.reading == Reading::Before {
            self.doubt_dependencies()?;
        }
        self.starts = self.grids.iter().map(|grid| prior(&self.machine, grid, &self.scales)).collect();
        Ok((self, notices))
    }

    /// Chooses over how many rows outputs are read where no variable shows a state again.
    fn read_through_outputs(&mut self) -> Result<Option<Notice>, Error> {
        let unshown = if self.machine.whole { None } else { self.unshown_state()? };
        let Some(state) = unshown else { return Ok(None) };
        let rows = self.choose_horizon()?;
        Ok(Some(notice(format!(
            "no variable shows the state {state} where it is begun: states are read through the outputs of {}",
            if rows == 1 { "a row".into() } else { format!("{rows} rows") }
        ))))
    }

    /// Starts free what a variable shows only while every parameter is as it is: a capacitor's voltage is that of its terminals without a
    /// resistance in series. Taken for the state beside one, what is measured there would have to be somebody else's fault.
    fn unbind_states(&mut self) -> Result<Vec<String>, Error> {
        let grid = &self.grids[0];
        let row = grid.time.len() / 2;
        let schedule = Schedule::new(&self.machine, grid, &self.machine.neutral());
        let states = self.nominal_states(grid, row);
        let shown = |parameter: Option<usize>| {
            let neutral = self.machine.neutral();
            let there = parameter.map_or_else(|| neutral.clone(), |moved| self.stepped(&neutral, moved));
            let set = self.set(&there);
            let job = Job { parameters: &set, ..self.job(grid, &schedule, row, &states) };
            self.with_worker(|worker| worker.shown_states(&self.machine, &job))
        };
        let (as_is, mut broken) = (shown(None)?, BTreeMap::new());
        for parameter in self.calibrated() {
            // a unit that can't be run so, or gives no numbers, tells nothing
            let Ok(there) = shown(Some(parameter)) else { continue };
            for (state, (there, here)) in there.iter().zip(&as_is).enumerate() {
                if there.is_finite() && here.is_finite() && !is_same(*there, *here) {
                    broken.entry(state).or_insert(parameter);
                }
            }
        }
        let told = |(state, parameter): (&usize, &usize)| {
            let name = &self.machine.states[*state].name;
            format!(
                "{name} shows a state only while {} is as it is: the state is started free",
                self.machine.parameters[*parameter].name
            )
        };
        let told = broken.iter().map(told).collect();
        for state in broken.keys() {
            let state = &mut self.machine.states[*state];
            (state.shows, state.channel) = (None, None);
        }
        Ok(told)
    }

    /// States as far as a row measures them, else nominal.
    pub(super) fn nominal_states(&self, grid: &Grid, row: usize) -> Vec<f64> {
        nominal_states(&self.machine, grid, row)
    }

    /// Whether the same interval gives the same on a fresh instance and again after another one.
    fn can_reset(&self) -> Result<bool, Error> {
        let grid = &self.grids[0];
        let schedule = Schedule::new(&self.machine, grid, &self.machine.neutral());
        let (here, there) = (self.nominal_states(grid, 0), self.nominal_states(grid, grid.time.len() / 2));
        let job = |row, states| Job { each_row: true, ..self.job(grid, &schedule, row, states) };
        let (mut fresh, mut again, mut other) = (Vec::new(), Vec::new(), Vec::new());
        let mut worker = Worker::new(&self.machine)?;
        worker.interval(&self.machine, &job(0, &here), &mut fresh)?;
        let turned = worker
            .interval(&self.machine, &job(grid.time.len() / 2, &there), &mut other)
            .and_then(|()| worker.interval(&self.machine, &job(0, &here), &mut again));
        let restores = self.machine.units.iter().all(|unit| unit.fmu.restores());
        Ok(restores && turned.is_ok() && fresh == again)
    }

    /// Name of the first state that is set and not shown after initialisation, if there is one.
    fn unshown_state(&self) -> Result<Option<String>, Error> {
        let grid = &self.grids[0];
        let schedule = Schedule::new(&self.machine, grid, &self.machine.neutral());
        let here: Vec<f64> = (self.nominal_states(grid, 0).iter().zip(&self.scales))
            .map(|(at, scale)| at + STEP * scale)
            .collect();
        let shown = self
            .with_worker(|worker| worker.shown_states(&self.machine, &self.job(grid, &schedule, 0, &here)))?;
        let pairs = self.machine.states.iter().zip(here.iter().zip(&shown));
        let mut other = pairs.filter(|(_, (set, shown))| shown.is_nan() || !is_same(**set, **shown));
        Ok(other.next().map(|(state, _)| state.name.clone()))
    }
}
