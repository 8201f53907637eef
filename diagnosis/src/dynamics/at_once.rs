//! Outputs that follow an input at once, without a state between them.

use super::linearise::Engine;
use super::schedule::Schedule;
use super::worker::Job;
use crate::error::Error;
use crate::observe::Hold;
use crate::statistics::levels::{ROWS, SMALL, STEP};

/// Rows that are tried.
const PROBES: usize = ROWS;
/// An input moves by this share of its size.
const MOVE: f64 = STEP;
/// An output follows where it moves by more than this share of its noise for the input's whole size.
const TELLS: f64 = SMALL;

impl Engine {
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
            for row in (0..PROBES).map(|probe| probe * (grid.time.len() - 1) / PROBES) {
                let states = self.nominal_states(grid, row);
                let job = self.job(grid, &schedule, row, &states);
                worker.interval(machine, &job, &mut base)?;
                for input in &held {
                    let mut at_row = job.at_row.to_vec();
                    at_row[*input] += MOVE * self.input_scales[*input];
                    worker.interval(machine, &Job { at_row: &at_row, ..job }, &mut out)?;
                    let follows = (0..machine.channels.len()).find(|channel| {
                        (out[n + channel] - base[n + channel]).abs() > MOVE * TELLS * self.sensors[*channel]
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
