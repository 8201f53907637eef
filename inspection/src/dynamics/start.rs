//! The start values of the description are those of the unit (FMI 2.0.4 section 2.2.7).

use super::bench::{Bench, Halt, Subject};
use super::steps::{is_start, started_exactly};
use crate::Severity;
use crate::finding::Found;

pub(super) fn values(bench: &Bench, found: &mut Found) -> Result<(), Halt> {
    let mut unit = bench.initialising("unit")?;
    compare(bench, &mut unit, "", found)?;
    Ok(())
}

/// Says which start values are not in force; `when` is put behind.
pub(super) fn compare(
    bench: &Bench,
    unit: &mut Subject<'_>,
    when: &str,
    found: &mut Found,
) -> Result<(), Halt> {
    let variables = started_exactly(bench);
    let values = unit.read(&variables)?;
    for (variable, value) in
        variables.iter().zip(&values).filter(|(variable, value)| !is_start(variable, value))
    {
        let start = variable.start.as_ref().map(ToString::to_string).unwrap_or_default();
        let text = format!("its start value is {start} in the description and {value} in the unit{when}");
        found.say(Severity::Error, Some(&variable.name), text);
    }
    Ok(())
}
