//! Variables of a unit that move in one call a type, and those calls. Laid out by `wiring/layout.rs`, used by each step
//! of `system.rs`.

use crate::error::Error;
use crate::fmu::Instance;
use crate::system::Values;
use std::ops::Range;

/// Variables of one type that are set or read in one call: their references, and where their values lie.
#[derive(Debug, Clone, Default)]
pub(crate) struct Block {
    pub(crate) references: Vec<u32>,
    pub(crate) at: Range<usize>,
}

/// A block for each type.
#[derive(Debug, Clone, Default)]
pub(crate) struct Blocks {
    pub(crate) reals: Block,
    pub(crate) integers: Block,
    pub(crate) booleans: Block,
    pub(crate) strings: Block,
    /// There is something besides reals.
    pub(crate) mixed: bool,
}

impl Blocks {
    /// Sets what is no real. Never inlined, so that a step of reals alone keeps its values in registers; the error is
    /// boxed, so that it comes back in one.
    #[inline(never)]
    pub(crate) fn set_rest(&self, instance: &mut Instance, values: &Values) -> Result<(), Box<Error>> {
        let Self { integers, booleans, strings, .. } = self;
        if !integers.references.is_empty() {
            instance.set_integer(&integers.references, &values.integers[integers.at.clone()])?;
        }
        if !booleans.references.is_empty() {
            instance.set_boolean(&booleans.references, &values.integers[booleans.at.clone()])?;
        }
        if !strings.references.is_empty() {
            instance.set_string(&strings.references, &values.strings[strings.at.clone()])?;
        }
        Ok(())
    }

    /// Reads what is no real.
    #[inline(never)]
    pub(crate) fn get_rest(&self, instance: &mut Instance, values: &mut Values) -> Result<(), Box<Error>> {
        let Self { integers, booleans, strings, .. } = self;
        if !integers.references.is_empty() {
            instance.get_integer(&integers.references, &mut values.integers[integers.at.clone()])?;
        }
        if !booleans.references.is_empty() {
            instance.get_boolean(&booleans.references, &mut values.integers[booleans.at.clone()])?;
        }
        if !strings.references.is_empty() {
            instance.get_string(&strings.references, &mut values.strings[strings.at.clone()])?;
        }
        Ok(())
    }

    /// Reads all of them.
    pub(crate) fn get_all(&self, instance: &mut Instance, values: &mut Values) -> Result<(), Error> {
        let reals = &self.reals;
        if !reals.references.is_empty() {
            instance.get_real(&reals.references, &mut values.reals[reals.at.clone()])?;
        }
        if self.mixed { self.get_rest(instance, values).map_err(|error| *error) } else { Ok(()) }
    }
}
