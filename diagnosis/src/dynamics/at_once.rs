//! Outputs that don't hang on the states alone: some follow an input at once, so that it matters whether a row was read before or after its
//! inputs acted; and some units compute them within a step only and show old values where they are begun anew.

use super::linearise::Engine;
use super::machine::Machine;
use super::policy::DYNAMICS;
use super::schedule::Schedule;
use super::worker::Job;
use crate::error::Error;
use crate::observe::Hold;
use crate::statistics::levels::{SMALL, STEP};

/// Rows that are tried, of so many.
pub(super) fn tried_rows(rows: usize) -> impl Iterator<Item = usize> {
    (0..DYNAMICS.tried_rows).map(move |tried| tried * rows / DYNAMICS.tried_rows)
}

/// Whether a sensor with this noise would see what an input does, if so large a share of its size does so much.
fn is_seen(by: f64, noise: f64, share: f64) -> bool {
    by > share * DYNAMICS.follows * noise
}

impl Engine {
    /// The first output that shows something else where the unit is begun than after the step that ends in the same states.
    ///
    /// # Errors
    /// A unit failed.
    pub fn computed_late(&self) -> Result<Option<String>, Error> {
        let (machine, n) = (&self.machine, self.machine.order());
        if machine.whole || !machine.any_step || machine.states.iter().any(|state| state.shows.is_none()) {
            return Ok(None);
        }
        let grid = &self.grids[0];
        let schedule = Schedule::new(machine, grid, &machine.neutral());
        let (channels, width) = (machine.channels.len(), machine.inputs.len());
        let ahead = Machine { first_step: machine.short_step(&grid.time), ..machine.clone() };
        self.with_worker(|worker| {
            let (mut step, mut begun) = (Vec::new(), Vec::new());
            for row in tried_rows(grid.time.len().saturating_sub(2)) {
                let states = self.nominal_states(grid, row);
                let job = schedule.job(grid.time[row], row, 1, &states);
                worker.interval(machine, &Job { each_row: true, ..job }, &mut step)?;
                let next = schedule.job(grid.time[row + 1], row + 1, 1, &step[..n]);
                worker.interval(machine, &next, &mut begun)?;
                let ends = &step[step.len() - channels..];
                let off = |begun: &[f64], place: usize| (ends[place] - begun[n + place]).abs();
                let late =
                    (0..channels).find(|place| is_seen(off(&begun, *place), self.sensors[*place], 1.0));
                let Some(place) = late else { continue };
                // what the unit remembers beyond its states shows, too, and no step brings that back; some make a whole step of their own
                let before = off(&begun, place);
                let held = [&job.at_row[..width], &job.at_row[..width]].concat();
                let goes = worker.interval(&ahead, &Job { at_row: &held, ..next }, &mut begun).is_ok();
                let mends = goes && off(&begun, place) < SMALL * before;
                return Ok(mends.then(|| machine.channels[place].name.clone()));
            }
            Ok(None)
        })
    }

    /// Where a unit says that none of its outputs follows an input, and one does, any may.
    ///
    /// # Errors
    /// A unit failed.
    pub(super) fn doubt_dependencies(&mut self) -> Result<(), Error> {
        let says_none = self.machine.channels.iter().all(|output| !output.jumps);
        if says_none && self.at_once()?.is_some() {
            self.machine.channels.iter_mut().for_each(|output| output.jumps = true);
        }
        Ok(())
    }

    /// The first output that follows a held input at once: names of output and input.
    ///
    /// # Errors
    /// A unit failed.
    pub fn at_once(&self) -> Result<Option<(String, String)>, Error> {
        let (machine, n) = (&self.machine, self.machine.order());
        let grid = &self.grids[0];
        let schedule = Schedule::new(machine, grid, &machine.neutral());
        let held: Vec<usize> = (0..machine.inputs.len())
            .filter(|input| {
                machine.inputs[*input].hold == Hold::Zero && machine.inputs[*input].channel.is_some()
            })
            .collect();
        self.with_worker(|worker| {
            let (mut base, mut out) = (Vec::new(), Vec::new());
            for row in tried_rows(grid.time.len() - 1) {
                let states = self.nominal_states(grid, row);
                let job = self.job(grid, &schedule, row, &states);
                worker.interval(machine, &job, &mut base)?;
                for input in &held {
                    let mut at_row = job.at_row.to_vec();
                    at_row[*input] += STEP * self.input_scales[*input];
                    worker.interval(machine, &Job { at_row: &at_row, ..job }, &mut out)?;
                    let follows = (0..machine.channels.len()).find(|channel| {
                        is_seen((out[n + channel] - base[n + channel]).abs(), self.sensors[*channel], STEP)
                    });
                    if let Some(channel) = follows {
                        let names = (&machine.channels[channel].name, &machine.inputs[*input].name);
                        return Ok(Some((names.0.clone(), names.1.clone())));
                    }
                }
            }
            Ok(None)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::{is_seen, tried_rows};
    use crate::dynamics::tests::{built, pendulum};
    use crate::observe::VariableId;

    #[test]
    fn law_a_unit_is_believed_that_no_output_follows_an_input_unless_one_does() {
        let mut problem = pendulum("dependencies", 60);
        let jumps = |problem: &crate::observe::Problem| {
            let mut engine = built(problem).engine;
            let said: Vec<bool> = engine.machine.channels.iter().map(|output| output.jumps).collect();
            engine.machine.channels.iter_mut().for_each(|output| output.jumps = false);
            engine.doubt_dependencies().expect("it runs");
            (said, engine.machine.channels[0].jumps)
        };
        assert_eq!(jumps(&problem), (vec![false, false], false));
        let shown = problem.channels.iter().position(|channel| channel.name.ends_with(".q1")).expect("shown");
        let place = problem.model.description(0).place("tau_applied").expect("an output");
        problem.channels[shown].variable = VariableId { instance: 0, place };
        problem.states.iter_mut().for_each(|state| state.channel = None);
        assert_eq!(jumps(&problem), (vec![true, false], true));
    }

    #[test]
    fn value_what_a_sensor_sees_of_an_input_at_once() {
        // a tenth of its noise: in a hundred rows as much as a deviation of their mean
        assert!(is_seen(0.011, 0.1, 1.0) && !is_seen(0.009, 0.1, 1.0));
        assert!(
            is_seen(0.00011, 0.1, 0.01) && !is_seen(0.00009, 0.1, 0.01),
            "a hundredth of the input does as much less"
        );
    }

    #[test]
    fn value_rows_that_are_tried_meet_what_acts_for_a_tenth_of_a_log() {
        let rows: Vec<usize> = tried_rows(1000).collect();
        for begin in (0..=900).step_by(10) {
            assert!(rows.iter().any(|row| (begin..begin + 100).contains(row)), "{begin}: {rows:?}");
        }
        // each is a step of the unit for each parameter
        assert!(rows.len() < 20);
        assert!(tried_rows(3).all(|row| row < 3), "a log that is shorter");
    }
}
