//! What is odd in a description but stops nothing.

use crate::fmu::Description;
use std::collections::BTreeSet;

/// As many are told; more of them say no more.
const TOLD: usize = 5;

/// One sentence each.
pub(super) fn of(description: &Description) -> Vec<String> {
    let mut all = Vec::new();
    for variable in &description.variables {
        let name = &variable.name;
        let start = variable.start.as_ref().and_then(|start| start.as_f64());
        match (variable.min, variable.max) {
            (Some(min), Some(max)) if min > max => all.push(format!("{name}: min {min} is above max {max}")),
            (min, max) => {
                let outside =
                    |start: f64| min.is_some_and(|min| start < min) || max.is_some_and(|max| start > max);
                if let Some(start) = start.filter(|start| outside(*start)) {
                    all.push(format!("{name}: its start value {start} lies outside its own limits"));
                }
            }
        }
    }
    let units: BTreeSet<&str> =
        description.variables.iter().filter_map(|variable| variable.unit.as_deref()).collect();
    let unknown: Vec<&str> = units.into_iter().filter(|unit| description.unit(unit).is_none()).collect();
    if !unknown.is_empty() {
        let units = unknown.join(", ");
        all.insert(0, format!("its UnitDefinitions lack {units}: values in these are not converted"));
    }
    let more = all.len().saturating_sub(TOLD);
    all.truncate(TOLD);
    if more > 0 {
        all.push(format!("and {more} more like these"));
    }
    all
}
