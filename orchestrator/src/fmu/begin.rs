//! From a new instance into initialization mode, with values set. FMI 2.0 lets a master set start values before that mode and in it, and
//! tools have made units that heed only one of the two: those of 20-sim forget what came before `fmi2SetupExperiment`, those that were
//! made for libcosim read their parameters in the mode only. So values are set at both places, as FMPy does and as libcosim does.
//!
//! A unit that refuses the second one, which the standard doesn't allow, gets a fresh instance and the first alone.

use super::description::{Causality, Initial};
use super::{Fmu, Instance};
use crate::error::Error;
use crate::value::{Kind, Value};
use std::collections::BTreeSet;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

/// What is known of a unit's way with values in initialization mode.
#[derive(Debug, Default)]
pub(super) struct Late {
    /// Variables that can be set there: parameters, inputs, and those of initial "exact".
    may: OnceLock<BTreeSet<(Kind, u32)>>,
    /// The unit refused one.
    refused: AtomicBool,
}

/// Values to start from: any, and real ones with their references in one call.
#[derive(Debug, Clone, Copy, Default)]
pub struct Begin<'a> {
    /// By reference.
    pub settings: &'a [(u32, Value)],
    /// References of real ones.
    pub reals: &'a [u32],
    /// Their values, as many.
    pub values: &'a [f64],
}

impl Fmu {
    fn may_set_late(&self, kind: Kind, reference: u32) -> bool {
        let may = self.inner.late.may.get_or_init(|| {
            let exact = self.description().variables.iter().filter(|variable| {
                matches!(variable.causality, Causality::Parameter | Causality::Input)
                    || variable.initial == Some(Initial::Exact)
            });
            exact.map(|variable| (variable.kind, variable.reference)).collect()
        });
        may.contains(&(kind, reference))
    }
}

impl Instance {
    /// `fmi2SetupExperiment`, values, `fmi2EnterInitializationMode`, and the values again. The instance is new or was reset.
    ///
    /// # Errors
    /// A call failed; the unit refused a value.
    pub fn begin(&mut self, start: f64, stop: Option<f64>, begin: Begin<'_>) -> Result<(), Error> {
        self.enter_with(start, stop, begin)?;
        if self.fmu().inner.late.refused.load(Ordering::Relaxed) || self.again(begin).is_ok() {
            return Ok(());
        }
        self.fmu().inner.late.refused.store(true, Ordering::Relaxed);
        *self = self.fmu().instantiate(self.name())?;
        self.enter_with(start, stop, begin)
    }

    fn enter_with(&mut self, start: f64, stop: Option<f64>, begin: Begin<'_>) -> Result<(), Error> {
        self.setup_experiment(start, stop)?;
        for (reference, value) in begin.settings {
            self.set(*reference, value)?;
        }
        if !begin.reals.is_empty() {
            self.set_real(begin.reals, begin.values)?;
        }
        self.enter_initialization()
    }

    fn again(&mut self, begin: Begin<'_>) -> Result<(), Error> {
        let fmu = self.fmu().clone();
        for (reference, value) in begin.settings {
            if fmu.may_set_late(value.kind(), *reference) {
                self.set(*reference, value)?;
            }
        }
        let may = |reference: &u32| fmu.may_set_late(Kind::Real, *reference);
        if self.late.0 != begin.reals {
            // the same ones are set each time that an instance begins
            self.late = (begin.reals.to_vec(), begin.reals.iter().all(may));
        }
        if self.late.1 {
            return if begin.reals.is_empty() { Ok(()) } else { self.set_real(begin.reals, begin.values) };
        }
        let both = begin.reals.iter().zip(begin.values).filter(|(reference, _)| may(reference));
        let (references, values): (Vec<u32>, Vec<f64>) = both.unzip();
        if references.is_empty() { Ok(()) } else { self.set_real(&references, &values) }
    }
}
