//! Start values of driven inputs that nothing ever sees: given beside the scenario they are refused. One that stands in the scenario's
//! own file is no mistake: another tool may have written it there.

use super::{Variable, Wiring};
use crate::error::{Error, Place};
use crate::scenario::Scenario;

impl Wiring {
    /// Why the start value of an input would count for nothing: its signal is there before any unit reads the input. A latency leaves
    /// the start value until the first value arrives, and a loop is solved from it.
    pub(crate) fn overwritten(&self, variable: Variable) -> Option<String> {
        let place = self.driven.get(&variable)?;
        let counts = self.late.contains(&variable) || self.plan.begins_with(variable);
        (!counts).then(|| overwriting(place))
    }
}

/// The words for it.
pub(crate) fn overwriting(place: &Place) -> String {
    format!("its signal at {place} would overwrite it")
}

/// Refuses what was given beside the scenario and would count for nothing.
pub(super) fn refuse(scenario: &Scenario, wiring: &Wiring) -> Result<(), Error> {
    for (unit, entry) in scenario.units.iter().enumerate() {
        for (name, given) in &entry.set {
            if let (Place::Override(_), Ok(variable)) = (&given.place, wiring.names.settable(unit, name))
                && let Some(expected) = wiring.overwritten((unit, variable))
            {
                let what = format!("{}.{name} is driven", entry.name);
                return Err(Error::Scenario { place: given.place.clone(), what, expected });
            }
        }
    }
    Ok(())
}
