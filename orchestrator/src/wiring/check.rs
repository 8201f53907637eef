//! Whether values and signals fit variables, and how one unit of measurement becomes another.

use super::names::{Names, Variable, Wrong};
use crate::fmu::{self, BaseUnit};
use crate::link::Conversion;
use crate::scenario::{ConnectionEntry, Transform};
use crate::value::{Kind, Value};

/// A TOML value as one of a variable's type: an integer also serves as a Real, a name as an item of an enumeration.
pub(super) fn from_toml(variable: &fmu::Variable, value: &toml::Value) -> Option<Value> {
    Some(match (variable.kind, value) {
        (Kind::Integer, toml::Value::String(name)) => return item(variable, name),
        (Kind::Real, toml::Value::Float(value)) => Value::Real(*value),
        (Kind::Real, toml::Value::Integer(value)) => Value::Real(*value as f64),
        (Kind::Integer, toml::Value::Integer(value)) => Value::Integer(i32::try_from(*value).ok()?),
        (Kind::Boolean, toml::Value::Boolean(value)) => Value::Boolean(*value),
        (Kind::String, toml::Value::String(value)) => Value::String(value.clone()),
        _ => return None,
    })
}

/// A value as a person types it.
pub(super) fn from_text(variable: &fmu::Variable, text: &str) -> Option<Value> {
    Value::parse(variable.kind, text).or_else(|| item(variable, text.trim()))
}

/// The value of an enumeration's item by its name.
pub(crate) fn item(variable: &fmu::Variable, name: &str) -> Option<Value> {
    let items = variable.items.as_deref()?;
    items.iter().find(|(known, _)| known == name).map(|(_, value)| Value::Integer(*value))
}

/// What would have been of a variable's type.
pub(crate) fn expected(variable: &fmu::Variable) -> String {
    match (variable.items.as_deref(), variable.kind) {
        (Some(items), _) => one_of(items),
        (None, Kind::Boolean) => "it is of type Boolean: true or false".into(),
        (None, Kind::Integer) => {
            let within =
                (variable.min.or(Some(f64::from(i32::MIN))), variable.max.or(Some(f64::from(i32::MAX))));
            format!("it is of type Integer: a whole number{}", range(within, ""))
        }
        (None, Kind::Real) => {
            format!("it is of type Real: a number{}", range((variable.min, variable.max), &measure(variable)))
        }
        (None, Kind::String) => "it is of type String: a text".into(),
    }
}

/// The end of what is expected of a number, such as ` from 0 to 1 s`.
fn range((min, max): (Option<f64>, Option<f64>), unit: &str) -> String {
    match (min, max) {
        (Some(min), Some(max)) => format!(" from {min} to {max}{unit}"),
        (Some(min), None) => format!(" of {min}{unit} or more"),
        (None, Some(max)) => format!(" of {max}{unit} or less"),
        (None, None) if unit.is_empty() => String::new(),
        (None, None) => format!(" in{unit}"),
    }
}

/// The unit of measurement behind a number; none of a bare number.
fn measure(variable: &fmu::Variable) -> String {
    let measure = variable.unit.as_deref().filter(|unit| *unit != "1");
    measure.map_or_else(String::new, |unit| format!(" {unit}"))
}

fn one_of(items: &[(String, i32)]) -> String {
    let items: Vec<String> = items.iter().map(|(name, value)| format!("{name} ({value})")).collect();
    format!("one of {}", items.join(", "))
}

/// Whether a start value lies where the description allows it; an error is what would be right.
pub(crate) fn start_value(variable: &fmu::Variable, value: &Value) -> Result<(), String> {
    if matches!(value, Value::String(text) if text.contains('\0')) {
        return Err("a text without a zero byte: FMI's texts end at one".into());
    }
    let Some(number) = value.as_f64() else { return Ok(()) };
    if let (Some(items), Value::Integer(value)) = (variable.items.as_deref(), value)
        && !items.iter().any(|(_, known)| known == value)
    {
        return Err(one_of(items));
    }
    let inside = variable.min.is_none_or(|min| number >= min) && variable.max.is_none_or(|max| number <= max);
    if number.is_finite() && inside {
        return Ok(());
    }
    let kind = if variable.min.or(variable.max).is_some() { "a number" } else { "a finite number" };
    Err(format!("{kind}{}", range((variable.min, variable.max), &measure(variable))))
}

/// How the value of an output becomes that of an input.
pub(super) fn conversion(
    names: &Names,
    from: Variable,
    to: Variable,
    transform: Transform,
    notices: &mut Vec<String>,
) -> Result<Conversion, Wrong> {
    let Transform { gain, bias, convert_units } = transform;
    let is_plain = gain == 1.0 && bias == 0.0;
    let (output, input) = (names.variable(from), names.variable(to));
    if !is_plain && (input.kind != Kind::Real || output.kind == Kind::String) {
        let what = format!(
            "gain = {gain}, bias = {bias} from {} ({}) to {} ({})",
            names.full(from),
            output.kind,
            names.full(to),
            input.kind
        );
        return Err((what, "only numbers for a Real input are scaled".into()));
    }
    let both_real = (output.kind, input.kind) == (Kind::Real, Kind::Real);
    let by_units = match convert_units || !both_real {
        true => by_descriptions(names, from, to, notices)?,
        false => Conversion::Same,
    };
    Ok(match by_units {
        unchanged @ Conversion::Table(_) => unchanged,
        unchanged if is_plain => unchanged,
        Conversion::Same | Conversion::Type => Conversion::Affine { gain, bias },
        Conversion::Affine { gain: first, bias: offset } => {
            Conversion::Affine { gain: gain * first, bias: gain * offset + bias }
        }
    })
}

/// What becomes of single values.
pub(super) fn table_of(
    names: &Names,
    from: Variable,
    to: Variable,
    entry: &ConnectionEntry,
) -> Result<Conversion, Wrong> {
    let whole = |variable: Variable| matches!(names.variable(variable).kind, Kind::Integer | Kind::Boolean);
    if !(whole(from) && whole(to)) || entry.transform != Transform::default() {
        let (output, input) = (names.variable(from), names.variable(to));
        let what =
            format!("map from {} ({}) to {} ({})", names.full(from), output.kind, names.full(to), input.kind);
        return Err((
            what,
            "between Integers, Booleans and enumerations, without gain, bias and convert_units".into(),
        ));
    }
    let code = |variable: Variable, given: &toml::Value| -> Result<i32, Wrong> {
        let described = names.variable(variable);
        let wrong = |expected: String| (format!("map: {given} of {}", names.full(variable)), expected);
        let value = match (described.kind, given) {
            // A table of numbers, as SSP has it between types.
            (Kind::Boolean, toml::Value::Integer(number @ (0 | 1))) => Some(Value::Boolean(*number == 1)),
            _ => from_toml(described, given),
        };
        let value = value.ok_or_else(|| wrong(expected(described)))?;
        if let (Some(items), Value::Integer(value)) = (described.items.as_deref(), &value)
            && !items.iter().any(|(_, known)| known == value)
        {
            return Err(wrong(one_of(items)));
        }
        Ok(match value {
            Value::Boolean(value) => i32::from(value),
            Value::Integer(value) => value,
            _ => return Err(wrong(expected(described))),
        })
    };
    let mut table: Vec<(i32, i32)> = Vec::with_capacity(entry.map.len());
    for (given, becomes) in &entry.map {
        let pair = (code(from, given)?, code(to, becomes)?);
        if table.iter().any(|(known, _)| *known == pair.0) {
            return Err((format!("map: {given} a second time"), "each value once".into()));
        }
        table.push(pair);
    }
    Ok(Conversion::Table(table.into()))
}

/// As the types and physical units of both ends ask for.
fn by_descriptions(
    names: &Names,
    from: Variable,
    to: Variable,
    notices: &mut Vec<String>,
) -> Result<Conversion, Wrong> {
    let (output, input) = (names.variable(from), names.variable(to));
    match (output.kind, input.kind) {
        (Kind::Real, Kind::Real) => {}
        (a, b) if a == b => return Ok(Conversion::Same),
        (Kind::Integer | Kind::Boolean, Kind::Real)
        | (Kind::Boolean, Kind::Integer)
        | (Kind::Integer, Kind::Boolean) => return Ok(Conversion::Type),
        (a, b) => {
            let what = format!("{} is of type {a}, {} of type {b}", names.full(from), names.full(to));
            let expected = match (a, b) {
                (Kind::String, _) | (_, Kind::String) => "a String goes only to a String",
                _ => "a Real would lose digits; connect it to a Real",
            };
            return Err((what, expected.into()));
        }
    }
    let (Some(unit_from), Some(unit_to)) = (&output.unit, &input.unit) else { return Ok(Conversion::Same) };
    let base = |variable: Variable, unit: &str| names.units[variable.0].1.description().unit(unit)?.base;
    let (base_from, base_to) = (base(from, unit_from), base(to, unit_to));
    let (Some(base_from), Some(base_to)) = (base_from, base_to) else {
        if unit_from != unit_to {
            notices.push(format!(
                "{} ({unit_from}) -> {} ({unit_to}): not both units have a BaseUnit, so values pass unchanged",
                names.full(from),
                names.full(to)
            ));
        }
        return Ok(Conversion::Same);
    };
    if base_from.exponents != base_to.exponents {
        let what = format!("{} is in {unit_from}, {} in {unit_to}", names.full(from), names.full(to));
        let shown = (exponents(&base_from), exponents(&base_to));
        return Err((
            what,
            format!("these units don't measure the same quantity ({} and {})", shown.0, shown.1),
        ));
    }
    let difference = output.relative_quantity && input.relative_quantity;
    let gain = base_from.factor / base_to.factor;
    let bias = if difference { 0.0 } else { (base_from.offset - base_to.offset) / base_to.factor };
    Ok(if gain == 1.0 && bias == 0.0 { Conversion::Same } else { Conversion::Affine { gain, bias } })
}

fn exponents(unit: &BaseUnit) -> String {
    let names = ["kg", "m", "s", "A", "K", "mol", "cd", "rad"];
    let powers: Vec<String> = (names.iter().zip(unit.exponents))
        .filter(|(_, exponent)| *exponent != 0)
        .map(|(name, exponent)| if exponent == 1 { (*name).to_owned() } else { format!("{name}^{exponent}") })
        .collect();
    if powers.is_empty() { "1".into() } else { powers.join(".") }
}
