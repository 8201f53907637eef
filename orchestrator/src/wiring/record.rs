//! What is recorded.

use super::names::{self, Names, Variable};
use crate::error::Error;
use crate::fmu::Causality;
use crate::scenario::Scenario;

/// The recorded variables; an error where one can't be told from another by its name.
pub(super) fn variables(scenario: &Scenario, names: &Names) -> Result<Vec<Variable>, Error> {
    let chosen = chosen(scenario, names)?;
    for &(unit, place) in &chosen {
        let (name, fmu) = &names.units[unit];
        let variable = &fmu.description().variables[place].name;
        if fmu.description().is_ambiguous(variable) {
            let (what, expected) = names::ambiguous(name, variable);
            return Err(Error::Scenario { place: scenario.units[unit].place.clone(), what, expected });
        }
    }
    Ok(chosen)
}

/// The recorded variables in the order of the columns: as the patterns come, each in the order of units and
/// descriptions.
fn chosen(scenario: &Scenario, names: &Names) -> Result<Vec<Variable>, Error> {
    let all = || {
        let count = |unit: usize| names.units[unit].1.description().variables.len();
        (0..names.units.len()).flat_map(move |unit| (0..count(unit)).map(move |place| (unit, place)))
    };
    let causality = |variable: Variable| names.variable(variable).causality;
    let Some(patterns) = &scenario.record else {
        return Ok(all().filter(|&v| matches!(causality(v), Causality::Input | Causality::Output)).collect());
    };
    let mut chosen: Vec<Variable> = Vec::new();
    for pattern in patterns {
        let wrong = |(what, expected)| Error::Scenario { place: pattern.place.clone(), what, expected };
        if !pattern.value.contains('*') {
            let variable = names.find(&pattern.value).map_err(wrong)?;
            if !chosen.contains(&variable) {
                chosen.push(variable);
            }
            continue;
        }
        let signals = all()
            .filter(|&v| matches!(causality(v), Causality::Input | Causality::Output | Causality::Local));
        let matching: Vec<Variable> = signals.filter(|&v| matches(&pattern.value, &names.full(v))).collect();
        if matching.is_empty() {
            let unit = pattern.value.split('.').next().unwrap_or_default();
            let expected = match names.unit(unit) {
                Err((what, expected)) if !unit.contains('*') => format!("{what}: {expected}"),
                _ => "inputs, outputs or locals by unit.variable, with * for any text".into(),
            };
            return Err(wrong((format!("nothing matches {:?}", pattern.value), expected)));
        }
        chosen.extend(matching.into_iter().filter(|v| !chosen.contains(v)).collect::<Vec<_>>());
    }
    Ok(chosen)
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
            ("p*.q*1", "plant.q1", true),
            ("p*.q*1", "plant.q2", false),
            ("*", "x.y", true),
            ("a*a", "a", false),
        ] {
            assert_eq!(matches(pattern, name), fits, "{pattern} {name}");
        }
    }
}
