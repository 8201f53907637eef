//! Jacobi with the steps of one point on several threads. Units see nothing of each other within a step, so that the bits
//! are those of Jacobi, whatever the number of threads; it pays where a step takes longer than some ten microseconds.
//!
//! Each unit has a desk: a copy of its inputs and outputs, and of nothing else, so that no thread writes where another one
//! reads. The desks are laid out and cleared away in the order of the scenario.

use super::options::Known;
use super::{Algorithm, Options, Sees};
use crate::blocks::{Blocks, Desk};
use crate::error::Error;
use crate::guard;
use crate::system::{Point, System, Unit};
use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

pub(super) const OPTIONS: &[Known] =
    // 0: as many as the machine has cores.
    &[Known { name: "threads", default: 0.0, least: 0.0, most: 1024.0, whole: true }];

pub(super) struct ParallelJacobi {
    threads: usize,
    /// None where the system gives no threads: then one after the other, which gives the same bits.
    pool: Option<ThreadPool>,
    desks: Vec<Work>,
}

/// What a thread has of a unit.
struct Work {
    inputs: Blocks,
    outputs: Blocks,
    /// Nothing: what is read at the start only is not brought here.
    fixed: Blocks,
    desk: Desk,
    /// Where the unit's step began.
    begin: f64,
    answer: Result<(), Box<Error>>,
}

impl Work {
    /// Has the unit work at the desk, and the second time not any more.
    fn exchange_blocks(&mut self, unit: &mut Unit) {
        std::mem::swap(&mut unit.inputs, &mut self.inputs);
        std::mem::swap(&mut unit.outputs, &mut self.outputs);
        std::mem::swap(&mut unit.fixed, &mut self.fixed);
    }
}

impl ParallelJacobi {
    pub(super) fn new(options: &Options<'_>) -> Self {
        Self { threads: options.get("threads") as usize, pool: None, desks: Vec::new() }
    }

    /// The steps of all units that are due, each at its own desk.
    fn all(&mut self, system: &mut System, point: Point) {
        let System { units, ends, values, .. } = system;
        let due = |unit: usize| ends[unit] == point.ticks;
        let rescue = guard::rescue();
        let busy = units.iter().zip(&mut self.desks).enumerate().filter(|(unit, _)| due(*unit));
        for (_, (unit, work)) in busy {
            work.begin = unit.begin;
            work.desk.bring(&work.inputs, &unit.inputs, values);
        }
        let step = |(number, (unit, work)): (usize, (&mut Unit, &mut Work))| {
            if !due(number) {
                return;
            }
            rescue.adopt(|| {
                // While the step lasts the unit's values are those at the desk, whatever goes wrong.
                work.exchange_blocks(unit);
                work.answer = unit.exchange::<false, true>(&mut work.desk.values, point.time);
                work.exchange_blocks(unit);
            });
        };
        let desks = &mut self.desks;
        match &self.pool {
            Some(pool) => pool.install(|| units.par_iter_mut().zip(desks).enumerate().for_each(step)),
            None => units.iter_mut().zip(desks).enumerate().for_each(step),
        }
    }
}

impl Algorithm for ParallelJacobi {
    fn sees(&self) -> Sees {
        Sees::Begin
    }

    #[cfg(isolation)]
    fn side_by_side(&self) -> bool {
        true
    }

    fn start(&mut self, system: &mut System) {
        if self.pool.is_none() && system.units.len() > 1 {
            self.pool = ThreadPoolBuilder::new().num_threads(self.threads).build().ok();
        }
        let work = |unit: &Unit| {
            let (desk, [inputs, outputs]) = Desk::of([&unit.inputs, &unit.outputs]);
            Work { inputs, outputs, fixed: Blocks::default(), desk, begin: 0.0, answer: Ok(()) }
        };
        self.desks = system.units.iter().map(work).collect();
    }

    fn begin(&mut self, system: &mut System, point: Point) {
        system.gather_beginning(point);
    }

    fn step(&mut self, system: &mut System, point: Point) -> Result<(), Box<Error>> {
        let due = system.due(point);
        if let [only] = due.as_slice() {
            system.units[*only].exchange::<false, true>(&mut system.values, point.time)?;
        } else {
            self.all(system, point);
        }
        for (at, &unit) in due.iter().enumerate() {
            if due.len() > 1 {
                let work = &mut self.desks[unit];
                work.desk.take(&work.outputs, &system.units[unit].outputs, &mut system.values);
                if let Err(error) = std::mem::replace(&mut work.answer, Ok(())) {
                    // One after the other, those behind it would not have stepped.
                    for &later in &due[at + 1..] {
                        system.units[later].begin = self.desks[later].begin;
                    }
                    return Err(error);
                }
            }
            system.stepped(unit, point);
            system.send(unit, point);
        }
        system.find_next();
        Ok(())
    }
}
