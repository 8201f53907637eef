//! One thread's units, and the runs that are made with them.

use crate::error::Error;
use crate::plan::Plan;
use crate::record::{CaseRecorder, Kept};
use crate::sweep::Watch;
use orchestrator::{Ended, Progress, Simulation, UnitPath, Value};
use std::ops::ControlFlow;

/// What came of a case.
pub(crate) struct CaseRow {
    pub(crate) case: u64,
    pub(crate) parameters: Vec<Value>,
    pub(crate) outcome: Result<Vec<Option<f64>>, String>,
    /// A signal that a scalar reads was not finite in some row.
    pub(crate) not_finite: bool,
    pub(crate) signals: Kept,
}

/// One thread's units.
pub(crate) struct Worker<'a> {
    plan: &'a Plan,
    units: UnitPath,
    watch: &'a dyn Watch,
    /// Whether units may be used again after a run that ended well.
    reuse: bool,
    simulation: Option<Simulation>,
    recorder: CaseRecorder,
}

impl<'a> Worker<'a> {
    pub(crate) fn new(plan: &'a Plan, reuse: bool, watch: &'a dyn Watch) -> Self {
        let recorder = CaseRecorder::new(plan);
        Self { plan, units: plan.units(), watch, reuse, simulation: None, recorder }
    }

    /// Runs a case; `None` if somebody asked for the end.
    pub(crate) fn run(&mut self, case: u64) -> Option<CaseRow> {
        if !self.reuse {
            self.simulation = None;
        }
        let ran = self.ran(case);
        if ran.is_err() {
            // Whatever state the units are in, the next case begins with fresh ones.
            self.simulation = None;
        }
        let outcome = match ran {
            Ok(Ended::Interrupted { .. }) => return None,
            Ok(_) => Ok(self.recorder.scalars()),
            Err(error) => Err(error.to_string()),
        };
        let parameters = (0..self.plan.parameters.len()).map(|at| self.plan.sampler.value(case, at));
        Some(CaseRow {
            case,
            parameters: parameters.collect(),
            outcome,
            not_finite: self.recorder.not_finite(),
            signals: self.recorder.take(),
        })
    }

    fn ran(&mut self, case: u64) -> Result<Ended, Error> {
        let simulation = match &mut self.simulation {
            Some(simulation) => simulation,
            none => none.insert(self.plan.simulation(&self.units)?),
        };
        self.plan.set(simulation, case)?;
        Ok(simulation.run(&mut self.recorder, &mut Look(self.watch))?)
    }
}

/// Looks some ten times a second whether the end is asked for.
struct Look<'a>(&'a dyn Watch);

impl Progress for Look<'_> {
    fn at(&mut self, _: f64, _: f64) -> ControlFlow<()> {
        if self.0.ends() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}
