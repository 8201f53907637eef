//! What a study varies, checked: columns of the parameters, and their values by the types of the variables.

use super::{placed, variable};
use crate::design::{Design, Range};
use crate::error::Error;
use crate::study::{Parameter, Study};
use orchestrator::{Column, Kind, Simulation, Value};

/// The columns of the parameters; an error if one can't be set.
pub(super) fn parameters(study: &Study, simulation: &mut Simulation) -> Result<Vec<Column>, Error> {
    let mut columns = Vec::new();
    for Parameter { name, place, .. } in &study.parameters {
        let found = variable(simulation, name, place)?;
        columns.push(Column { name: name.clone(), kind: found.kind, unit: found.unit.clone() });
        if let Some(why) = simulation.overwritten(name) {
            let expected = format!("{why}: sweep a parameter");
            return Err(Error::Study { place: place.clone(), what: format!("{name} is driven"), expected });
        }
    }
    Ok(columns)
}

/// The design with values of the variables' types, each of which was tried.
pub(super) fn typed(
    study: &Study,
    parameters: &[Column],
    simulation: &mut Simulation,
) -> Result<Design, Error> {
    let mut design = study.design.clone();
    if let Design::Sampled(sampled) = &mut design {
        for ((column, parameter), range) in parameters.iter().zip(&study.parameters).zip(&mut sampled.ranges)
        {
            range.whole |= is_whole(range, column.kind).map_err(|(what, expected)| Error::Study {
                place: parameter.place.clone(),
                what: format!("{}: {what}", column.name),
                expected: expected.to_owned(),
            })?;
        }
    }
    for (at, parameter) in study.parameters.iter().enumerate() {
        for value in design.values(at) {
            simulation.set(&parameter.name, value).map_err(placed(&parameter.place))?;
        }
    }
    let cast = |at: usize, value: &Value| cast(simulation, &study.parameters[at], parameters[at].kind, value);
    Ok(match design {
        Design::Grid(axes) => {
            let axes =
                axes.iter().enumerate().map(|(at, axis)| axis.iter().map(|value| cast(at, value)).collect());
            Design::Grid(axes.collect::<Result<_, _>>()?)
        }
        Design::List(rows) => {
            let row = |row: Vec<Value>| row.iter().enumerate().map(|(at, value)| cast(at, value)).collect();
            Design::List(rows.into_iter().map(row).collect::<Result<_, _>>()?)
        }
        sampled => sampled,
    })
}

/// Whether samples of a range are whole numbers, by the variable's type; an error is what is wrong, and what was expected.
fn is_whole(range: &Range, kind: Kind) -> Result<bool, (String, &'static str)> {
    let limits = f64::from(i32::MIN)..=f64::from(i32::MAX);
    let fits = |end: f64| end.fract() == 0.0 && limits.contains(&end);
    match kind {
        Kind::Real => Ok(false),
        Kind::Integer if range.log => Err(("it is an Integer".to_owned(), "no scale = \"log\"")),
        Kind::Integer if fits(range.from) && fits(range.to) => Ok(true),
        Kind::Integer => Err((format!("from {} to {}", range.from, range.to), "whole numbers")),
        kind => Err((format!("it is a {kind}"), "a [grid] or [list], which have any values")),
    }
}

/// A value as one of the variable's type, an enumeration's name as its number.
fn cast(simulation: &Simulation, parameter: &Parameter, kind: Kind, value: &Value) -> Result<Value, Error> {
    let found = variable(simulation, &parameter.name, &parameter.place)?;
    let named = |name: &str| found.items.as_deref()?.iter().find(|(known, _)| known == name);
    let item = match value {
        Value::String(name) => named(name).map(|(_, number)| Value::Integer(*number)),
        _ => None,
    };
    item.or_else(|| value.cast(kind)).ok_or_else(|| Error::Study {
        place: parameter.place.clone(),
        what: format!("{} = {value}", parameter.name),
        expected: format!("a value of type {kind}"),
    })
}
