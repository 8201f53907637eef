//! What is recorded.

use super::Connection;
use super::names::{self, Names, Variable};
use crate::error::Error;
use crate::fmu::Causality;
use crate::recorder::Column;
use crate::scenario::Scenario;
use crate::suggest::nearest;
use crate::value::Kind;
use std::collections::HashSet;

/// Ends the name of an age; before it stands that of the input.
const AGE: &str = ":age";
/// Likewise of an estimated error, after the output.
const ERROR: &str = ":error";

/// Something that is recorded.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Recorded {
    /// A variable of a unit.
    Variable(Variable),
    /// How old the value is that an input has of a connection, by its number.
    Age(usize),
    /// How far an output is off, as the algorithm estimates it.
    Error(Variable),
}

impl Recorded {
    pub(super) fn variable(&self) -> Option<Variable> {
        if let Self::Variable(variable) = self { Some(*variable) } else { None }
    }

    /// The variable that is recorded or estimated, so that it is read.
    pub(super) fn shown(&self) -> Option<Variable> {
        self.variable().or(self.error())
    }

    pub(super) fn error(&self) -> Option<Variable> {
        if let Self::Error(output) = self { Some(*output) } else { None }
    }

    pub(super) fn age(&self) -> Option<usize> {
        if let Self::Age(connection) = self { Some(*connection) } else { None }
    }

    pub(super) fn column(&self, names: &Names, connections: &[Connection]) -> Column {
        match self {
            Self::Variable(variable) => names.column(*variable),
            Self::Error(output) => Column { name: names.error(*output), ..names.column(*output) },
            Self::Age(connection) => Column {
                name: names.age(&connections[*connection]),
                kind: Kind::Real,
                unit: Some("s".into()),
            },
        }
    }
}

/// What is recorded, in the order of the columns; an error where a variable can't be told from another by its name.
pub(super) fn chosen(
    scenario: &Scenario,
    names: &Names,
    connections: &[Connection],
) -> Result<Vec<Recorded>, Error> {
    let chosen = matching(scenario, names, connections)?;
    for (unit, place) in chosen.iter().filter_map(Recorded::variable) {
        let (name, fmu) = &names.units[unit];
        let variable = &fmu.description().variables[place].name;
        if fmu.description().is_ambiguous(variable) {
            let (what, expected) = names::ambiguous(name, variable);
            return Err(Error::Scenario { place: scenario.units[unit].place.clone(), what, expected });
        }
    }
    Ok(chosen)
}

/// As the patterns come, each in the order of units and descriptions.
fn matching(scenario: &Scenario, names: &Names, connections: &[Connection]) -> Result<Vec<Recorded>, Error> {
    let all = || {
        let count = |unit: usize| names.units[unit].1.description().variables.len();
        (0..names.units.len()).flat_map(move |unit| (0..count(unit)).map(move |place| (unit, place)))
    };
    let causality = |variable: Variable| names.variable(variable).causality;
    let Some(patterns) = &scenario.record else {
        let shown = all().filter(|&v| matches!(causality(v), Causality::Input | Causality::Output));
        return Ok(shown.map(Recorded::Variable).collect());
    };
    let mut chosen: Vec<Recorded> = Vec::new();
    let mut known: HashSet<Recorded> = HashSet::new();
    let mut choose = |one: Recorded| {
        if known.insert(one) {
            chosen.push(one);
        }
    };
    for pattern in patterns {
        let wrong = |(what, expected)| Error::Scenario { place: pattern.place.clone(), what, expected };
        let pattern = pattern.value.as_str();
        if !pattern.contains('*') {
            choose(named(pattern, names, connections, &scenario.algorithm.value).map_err(wrong)?);
            continue;
        }
        let signals = all()
            .filter(|&v| matches!(causality(v), Causality::Input | Causality::Output | Causality::Local));
        let signals = signals.filter(|&v| matches(pattern, &names.full(v))).map(Recorded::Variable);
        // A pattern for signals means no ages: it would have other columns than it had before there were any.
        let ages = (0..connections.len()).filter(|_| pattern.ends_with(AGE));
        let ages = ages.filter(|&age| matches(pattern, &names.age(&connections[age]))).map(Recorded::Age);
        // Likewise.
        let estimates = pattern.ends_with(ERROR) && crate::algorithm::estimates(&scenario.algorithm.value);
        let outputs = all().filter(|&v| estimates && causality(v) == Causality::Output);
        let errors =
            outputs.filter(|&v| names.variable(v).kind == Kind::Real && matches(pattern, &names.error(v)));
        let mut found = signals.chain(ages).chain(errors.map(Recorded::Error)).peekable();
        if found.peek().is_none() {
            return Err(wrong((format!("nothing matches {pattern:?}"), matchable(pattern, names))));
        }
        found.for_each(&mut choose);
    }
    Ok(chosen)
}

/// What is expected where a pattern matches nothing.
fn matchable(pattern: &str, names: &Names) -> String {
    let unit = pattern.split('.').next().unwrap_or_default();
    match names.unit(unit) {
        Err((what, expected)) if !unit.contains('*') => format!("{what}: {expected}"),
        _ if pattern.ends_with(ERROR) => {
            "errors of Real outputs, by algorithm = \"step-halving\", which estimates them".into()
        }
        _ => "inputs, outputs or locals by unit.variable, with * for any text".into(),
    }
}

/// A variable, or the age of an input's value, by its full name.
fn named(
    full: &str,
    names: &Names,
    connections: &[Connection],
    algorithm: &str,
) -> Result<Recorded, names::Wrong> {
    let found = names.find(full);
    if let (Err(_), Some(output)) = (&found, full.strip_suffix(ERROR)) {
        let output = names.output(output)?;
        return match (crate::algorithm::estimates(algorithm), names.variable(output).kind) {
            (true, Kind::Real) => Ok(Recorded::Error(output)),
            (true, kind) => {
                Err((format!("{full}: the output is of type {kind}"), "the error of a Real".into()))
            }
            (false, _) => {
                let expected = "algorithm = \"step-halving\", which estimates errors";
                Err((format!("{full} with algorithm {algorithm:?}"), expected.into()))
            }
        };
    }
    let (Err(_), Some(input)) = (&found, full.strip_suffix(AGE)) else {
        return found.map(Recorded::Variable);
    };
    let input = names.find(input)?;
    let connection = connections.iter().position(|connection| connection.to == input);
    connection.map(Recorded::Age).ok_or_else(|| {
        let aged: Vec<String> = connections.iter().map(|connection| names.age(connection)).collect();
        let likely = nearest(full, aged.iter().map(String::as_str));
        (
            format!("{full}: no connection leads to {}", names.full(input)),
            format!("an age is that of a value that came through one ({likely})"),
        )
    })
}

/// Whether a name fits a pattern, in which `*` stands for any text.
fn matches(pattern: &str, name: &str) -> bool {
    let mut parts = pattern.split('*');
    let first = parts.next().unwrap_or_default();
    let Some(mut rest) = name.strip_prefix(first) else { return false };
    let mut parts = parts.peekable();
    while let Some(part) = parts.next() {
        if parts.peek().is_none() {
            return rest.ends_with(part);
        }
        match rest.find(part) {
            Some(at) => rest = &rest[at + part.len()..],
            None => return false,
        }
    }
    rest.is_empty()
}

#[cfg(test)]
mod tests {
    use super::matches;

    #[test]
    fn value_stars_stand_for_any_text() {
        for (pattern, name, fits) in [
            ("plant.*", "plant.q1", true),
            ("plant.*", "plants.q1", false),
            ("*.q1", "plant.q1", true),
            ("*.q1", "plant.dq11", false),
            ("*q*", "plant.q1", true),
            ("*q*q*", "plant.q1", false),
            ("*q*q*", "plant.dq_q1", true),
            ("p*.q*1", "plant.q1", true),
            ("p*.q*1", "plant.q2", false),
            ("*", "x.y", true),
            ("a*a", "a", false),
        ] {
            assert_eq!(matches(pattern, name), fits, "{pattern} {name}");
        }
    }
}
