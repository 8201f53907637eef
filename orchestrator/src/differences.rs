//! Whether one signal can be taken off another: figures and graphs of differences are refused where units are unlike.

use crate::fmu::BaseUnit;
use crate::simulation::Simulation;

impl Simulation {
    /// Why the values of one variable can't be taken off those of another, in words: their units are unlike. A unit that is not declared,
    /// or not in base units, says nothing.
    pub fn unlike(&self, signal: &str, minus: &str) -> Option<String> {
        let (one, other) = (self.measured_in(signal)?, self.measured_in(minus)?);
        let differ = match (one.1, other.1) {
            (Some(a), Some(b)) => !alike(&a, &b),
            _ => false,
        };
        let (one, other) = (one.0, other.0);
        (differ && one != other).then(|| format!("{signal} is in {one}, {minus} in {other}"))
    }

    /// The unit of a variable, and what it is in base units.
    fn measured_in(&self, full: &str) -> Option<(&str, Option<BaseUnit>)> {
        self.units().find_map(|(unit, description)| {
            let name = full.strip_prefix(unit)?.strip_prefix('.')?;
            let unit = description.variable(name)?.unit.as_deref()?;
            Some((unit, description.unit(unit).and_then(|known| known.base)))
        })
    }
}

/// The same quantity by the same measure; an angle is a number, too.
fn alike(one: &BaseUnit, other: &BaseUnit) -> bool {
    one.exponents[..7] == other.exponents[..7] && one.factor == other.factor && one.offset == other.offset
}
