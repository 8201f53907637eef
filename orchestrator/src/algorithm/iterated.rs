//! Fixed-point iteration: each unit gets the values that all units due at a point have at that point, its own answer
//! included. Implicit in the coupling: it damps where Jacobi's explicit values make grow.
//!
//! The units that are due step in the order of the scenario, as with Gauss-Seidel; then they are taken back and step again
//! with the outputs that came of it, until no connected input changes by more than `tolerance`, relative to the larger of
//! it and one. Units that are not due keep the values of their last point.

use super::options::Known;
use super::{Algorithm, Needs, Options, Sees};
use crate::error::Error;
use crate::rollback::By;
use crate::system::{Point, System};
use crate::value::Value;

pub(super) const OPTIONS: &[Known] = &[
    // Some thousand roundings, so that the order of the iteration leaves no trace in what a person reads.
    Known { name: "tolerance", default: 1e-10, least: 1e-15, most: 1.0, whole: false },
    Known { name: "iterations", default: 100.0, least: 2.0, most: 1e6, whole: true },
];

pub(super) struct Iterated {
    tolerance: f64,
    iterations: u32,
}

impl Iterated {
    pub(super) fn new(options: &Options<'_>) -> Self {
        Self { tolerance: options.get("tolerance"), iterations: options.get("iterations") as u32 }
    }
}

/// The largest change of an input against the value that its unit used, with the unit and the place among its inputs. The
/// inputs are then what the units used.
fn largest_change(
    system: &mut System,
    due: &[usize],
    used: &[Vec<Value>],
    point: Point,
) -> (f64, usize, usize) {
    let mut worst = (0.0, 0, 0);
    for (&unit, used) in due.iter().zip(used) {
        system.gather(unit, point);
        for (place, now) in system.units[unit].inputs.all(&system.values).iter().enumerate() {
            let change = now.change(&used[place]);
            if change > worst.0 {
                worst = (change, unit, place);
            }
        }
        system.units[unit].inputs.put_all(used, &mut system.values);
    }
    worst
}

impl Algorithm for Iterated {
    fn sees(&self) -> Sees {
        Sees::End
    }

    fn needs(&self) -> Needs {
        Needs { states: true, settles: true, ..Needs::default() }
    }

    fn step(&mut self, system: &mut System, point: Point) -> Result<(), Box<Error>> {
        let due = system.due(point);
        for &unit in &due {
            system.units[unit].keep(By::Algorithm)?;
        }
        let lines = system.lines_of(&due);
        let mut used = vec![Vec::new(); due.len()];
        for iteration in 1..=self.iterations {
            if iteration > 1 {
                system.send_anew(&lines, &due, point);
            }
            for (&unit, used) in due.iter().zip(&mut used) {
                if iteration > 1 {
                    system.units[unit].take_back(By::Algorithm)?;
                }
                system.gather(unit, point);
                *used = system.units[unit].inputs.all(&system.values);
                system.exchange(unit, point.time)?;
            }
            system.send_anew(&lines, &due, point);
            let worst = largest_change(system, &due, &used, point);
            if worst.0 <= self.tolerance {
                due.iter().for_each(|&unit| system.stepped(unit, point));
                system.find_next();
                return Ok(());
            }
            if iteration == self.iterations {
                return Err(Box::new(Error::Coupling {
                    variable: system.units[worst.1].input_name(worst.2),
                    time: point.time,
                    change: worst.0,
                    tolerance: self.tolerance,
                    tried: format!("{iteration} iterations"),
                    advice: "a smaller interval or a larger tolerance may help, and where values go straight through all units of a loop, a \
                             delay on one of its connections",
                }));
            }
        }
        Ok(())
    }
}
