//! Variables that share a value reference: they are one value under several names (FMI 2.0.4 section 2.2.7).

use crate::finding::Found;
use crate::model::{Model, Variable};
use orchestrator::Kind;
use orchestrator::fmu::Variability;
use std::collections::BTreeMap;

pub(super) fn aliases(model: &Model<'_>, found: &mut Found) {
    let mut sets: BTreeMap<(u8, u32), Vec<&Variable<'_>>> = BTreeMap::new();
    for variable in &model.variables {
        let kind = match variable.kind {
            Kind::Real => 0,
            Kind::Integer => 1,
            Kind::Boolean => 2,
            Kind::String => 3,
        };
        if let Some(reference) = variable.reference {
            sets.entry((kind, reference)).or_default().push(variable);
        }
    }
    for set in sets.values().filter(|set| set.len() > 1) {
        one_setter(set, found);
        one_start(set, found);
        for pair in set.windows(2) {
            agree(pair[0], pair[1], found);
        }
    }
}

fn one_setter(set: &[&Variable<'_>], found: &mut Found) {
    let mut setters = set.iter().filter(|variable| variable.is_set_from_outside());
    if let Some(first) = setters.next() {
        for other in setters {
            let what = format!(
                "it shares its value reference with {}: one set of aliases has one input or parameter",
                first.name
            );
            found.error_of(other, what);
        }
    }
}

fn one_start(set: &[&Variable<'_>], found: &mut Found) {
    let mut started = set.iter().filter_map(|variable| Some((variable, variable.start()?)));
    let Some((first, value)) = started.next() else { return };
    for (other, start) in started {
        let same = start.trim() == value.trim()
            || crate::model::number(start).is_some_and(|start| crate::model::number(value) == Some(start));
        match (same, other.variability == Variability::Constant) {
            (false, _) => found.error_of(
                other,
                format!("its start value is {start}, that of its alias {} is {value}", first.name),
            ),
            (true, false) => found.warning_of(
                other,
                format!("its alias {} has the start value, too: one of a set of aliases has it", first.name),
            ),
            (true, true) => {}
        }
    }
}

fn agree(first: &Variable<'_>, other: &Variable<'_>, found: &mut Found) {
    let constants = [first, other].map(|variable| variable.variability == Variability::Constant);
    if constants[0] != constants[1] {
        found.error_of(other, format!("of it and its alias {}, one is constant and one is not", first.name));
    }
    let units = [first, other].map(|variable| variable.attribute("unit"));
    if units[0] != units[1] {
        let [a, b] = units.map(|unit| unit.unwrap_or("none"));
        found.error_of(
            other,
            format!("its unit is {b}, that of its alias {} is {a}: one value has one unit", first.name),
        );
    }
}
