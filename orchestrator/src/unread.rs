//! Outputs that go nowhere and that nobody records: looked at once, when a run is over, so that it is told where one is no number. During the
//! run they cost nothing.

use crate::fmu::Causality;
use crate::simulation::Simulation;
use crate::system::Unit;
use crate::value::Kind;
use std::collections::HashSet;

impl Simulation {
    /// Reads the real outputs that the run had no use for, as they are at its end; [`Simulation::notices`] tell of those that are not finite.
    /// A unit that was ended, or can't be read any more, is passed over.
    pub fn look_over(&mut self) {
        let time = self.now.time;
        for unit in &mut self.wiring.system.units {
            let references = unread(unit);
            let mut values = vec![0.0; references.len()];
            if references.is_empty()
                || !unit.instance.is_stepping()
                || unit.instance.get_real(&references, &mut values).is_err()
            {
                continue;
            }
            for (reference, value) in
                references.into_iter().zip(values).filter(|(_, value)| !value.is_finite())
            {
                let name = unit.named(Kind::Real, reference);
                unit.not_finite.push((
                    reference,
                    format!("{name} is {value} at t = {time} s, at the end; nothing reads it"),
                ));
            }
        }
    }
}

/// Their references, less those of which something was told.
fn unread(unit: &Unit) -> Vec<u32> {
    let blocks = [&unit.outputs, &unit.inputs, &unit.fixed];
    let read = blocks.into_iter().flat_map(|blocks| &blocks.reals.references);
    let known: HashSet<u32> = read.chain(unit.not_finite.iter().map(|(known, _)| known)).copied().collect();
    let outputs = unit.instance.fmu().description().variables.iter();
    let outputs = outputs.filter(|one| one.causality == Causality::Output && one.kind == Kind::Real);
    let mut references: Vec<u32> =
        outputs.map(|one| one.reference).filter(|one| !known.contains(one)).collect();
    references.sort_unstable();
    references.dedup();
    references
}
