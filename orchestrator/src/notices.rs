//! What a person should know of a run but what stops nothing.

use crate::fmu::Status;
use crate::simulation::Simulation;
use crate::system::Unit;

impl Simulation {
    /// What a person should know but what stops nothing: loops, conversions that could not be made, warnings of
    /// units.
    pub fn notices(&self) -> Vec<String> {
        let units = &self.wiring.system.units;
        let strange = units.iter().flat_map(|unit| &unit.not_finite).map(|(_, told)| told);
        let before = self.wiring.notices.iter().chain(&self.wiring.last_points).chain(&self.notices);
        let mut all: Vec<String> = before.chain(strange).cloned().collect();
        for notice in [warnings, errors, retried, rounding] {
            all.extend(units.iter().filter_map(notice));
        }
        all
    }

    /// Adds what the program that runs it has found; until the next run.
    pub fn notice(&mut self, word: String) {
        self.notices.push(word);
    }
}

fn warnings(unit: &Unit) -> Option<String> {
    let count = unit.instance.warnings();
    let last =
        || unit.instance.log().last().map_or_else(String::new, |line| format!("; last log line: {line}"));
    (count > 0).then(|| format!("unit {} answered {count} calls with a warning{}", unit.name, last()))
}

/// Errors that a unit only logged: what its calls answer is what counts, but its maker meant somebody to read them.
fn errors(unit: &Unit) -> Option<String> {
    let log = unit.instance.log();
    let mut errors = log.iter().filter(|line| matches!(line.status, Status::Error | Status::Fatal));
    let first = errors.next()?;
    let more = match errors.count() {
        0 => String::new(),
        more => format!(", and {more} more among its last lines"),
    };
    Some(format!("unit {} logged an error: {first}{more}", unit.name))
}

fn retried(unit: &Unit) -> Option<String> {
    let (count, first) = (unit.rollback.retried, unit.rollback.first);
    (count > 0).then(|| {
        format!(
            "unit {} discarded {count} steps, the first at t = {first} s; shorter ones were made instead",
            unit.name
        )
    })
}

fn rounding(unit: &Unit) -> Option<String> {
    unit.instance.label().rounds().then(|| {
        format!(
            "unit {} changes how the processor rounds reals, or flushes small ones to zero: put back after its calls",
            unit.name
        )
    })
}
