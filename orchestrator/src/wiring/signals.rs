//! Signals for inputs: a constant, a table, a column of a CSV file.

use super::check::{expected, start_value};
use super::names::Wrong;
use crate::fmu;
use crate::scenario::{Shape, SignalEntry};
use crate::source::Signal;
use crate::value::{Kind, Value};
use std::path::Path;

/// A signal for an input; `constant` is its value, if it has but one.
pub(super) fn signal(
    entry: &SignalEntry,
    variable: &fmu::Variable,
    constant: Option<&Value>,
    folder: &Path,
) -> Result<Signal, Wrong> {
    let kind = variable.kind;
    let (shape, points) = match entry {
        SignalEntry::Constant(_) => {
            let number = constant.and_then(Value::as_f64).unwrap_or(f64::NAN);
            (Shape::Hold, vec![(f64::NEG_INFINITY, number)])
        }
        SignalEntry::Table { shape, points } => (*shape, points.clone()),
        SignalEntry::Csv { file, column, shape } => (*shape, read_csv(&folder.join(file), column)?),
    };
    let whole = |(_, value): &(f64, f64)| match (kind, variable.items.as_deref()) {
        (Kind::Boolean, _) => *value == 0.0 || *value == 1.0,
        (_, Some(items)) => items.iter().any(|(_, known)| f64::from(*known) == *value),
        _ => value.fract() == 0.0 && (f64::from(i32::MIN)..=f64::from(i32::MAX)).contains(value),
    };
    match kind {
        Kind::Real => {}
        Kind::String => {
            return Err(("a table for a String input".into(), "only a constant can be a text".into()));
        }
        _ if shape != Shape::Hold => {
            return Err((
                format!("a continuous signal for an input of type {kind}"),
                "kind = \"hold\"".into(),
            ));
        }
        _ => {
            if let Some((time, value)) = points.iter().find(|point| !whole(point)) {
                let expected = match variable.items {
                    Some(_) => expected(variable),
                    None => format!("the input is of type {kind}"),
                };
                return Err((format!("the value {value} at {time} s"), expected));
            }
        }
    }
    Ok(Signal::new(shape, points))
}

fn read_csv(path: &Path, column: &str) -> Result<Vec<(f64, f64)>, Wrong> {
    let shown = path.display();
    let text = crate::plain::read_text(path)
        .map_err(|error| (format!("file {shown}: {error}"), "a CSV file beside the scenario".to_owned()))?;
    table(&text, &shown.to_string(), column)
}

/// Units of time but the second, as heads of columns tell them.
const OTHER_TIMES: [&str; 9] = ["ms", "us", "µs", "μs", "ns", "min", "h", "d", "msec"];

/// The unit that the head of a column of times says, where that isn't the second: `time [ms]`, `t (ms)`, `time / ms`, `t_ms`.
fn other_time(head: &str) -> Option<&'static str> {
    let words = head.split(|letter: char| !letter.is_alphabetic());
    let last = words.filter(|word| !word.is_empty()).skip(1).last()?;
    OTHER_TIMES.into_iter().find(|unit| *unit == last)
}

/// What a person should know of a table whose values leave the range of its input. Logs of sensors may, by their noise.
pub(super) fn beyond(signal: &Signal, to: &str, variable: &fmu::Variable) -> Option<String> {
    let outside =
        |point: &(f64, f64)| start_value(variable, &Value::Real(point.1)).err().map(|range| (*point, range));
    let ((at, value), range) = signal.points().iter().find_map(outside)?;
    Some(format!("{to}: the signal is {value} at {at} s, and its description says {range}"))
}

/// The first column, which is the time, and another one of a text of comma-separated values; rows with an empty cell are
/// passed over. An error is what is wrong, naming the text as `shown`, and what would be right.
///
/// # Errors
/// If there is no such column, or a cell holds no finite number.
pub fn table(text: &str, shown: &str, column: &str) -> Result<Vec<(f64, f64)>, Wrong> {
    let mut reader =
        csv::ReaderBuilder::new().flexible(true).trim(csv::Trim::All).from_reader(text.as_bytes());
    let unreadable = |error: csv::Error| (format!("{shown}: {error}"), "comma-separated values".to_owned());
    let header = reader.headers().map_err(unreadable)?.clone();
    if header.len() == 1 && header[0].contains([';', '\t']) {
        let what = format!("file {shown}: its head is one column, {:?}", &header[0]);
        return Err((what, "commas between columns, and a point in decimal numbers".into()));
    }
    if let Some(unit) = header.get(0).and_then(other_time) {
        let what = format!("file {shown}: its first column, {:?}, is in {unit}", &header[0]);
        return Err((what, "times in s, and a head that says no other unit".into()));
    }
    let mut places = header.iter().enumerate().skip(1).filter(|(_, name)| *name == column);
    let (place, _) = places.next().ok_or_else(|| {
        let known = crate::suggest::nearest(column, header.iter().skip(1));
        (format!("file {shown} has no column {column:?} after the time"), known)
    })?;
    if places.next().is_some() {
        return Err((format!("file {shown} has two columns {column:?}"), "one of that name".into()));
    }
    let mut points: Vec<(f64, f64)> = Vec::new();
    for row in reader.records() {
        let row = row.map_err(unreadable)?;
        let line = row.position().map_or(0, csv::Position::line);
        if row.len() > header.len() {
            let expected = format!("{}, as many as columns", header.len());
            return Err((format!("{shown}:{line}: {} cells", row.len()), expected));
        }
        let cell = |place: usize| row.get(place).unwrap_or_default();
        if cell(0).is_empty() || cell(place).is_empty() {
            continue;
        }
        let wrong = |cell: &str, expected: &str| (format!("{shown}:{line}: {cell:?}"), expected.to_owned());
        let read = |cell: &str| match cell.parse::<f64>() {
            Ok(number) if number.is_finite() => Ok(number),
            _ => Err(wrong(cell, "a finite number")),
        };
        let (at, value) = (read(cell(0))?, read(cell(place))?);
        if points.last().is_some_and(|(before, _)| at < *before) {
            return Err(wrong(cell(0), "times in rising order"));
        }
        points.push((at, value));
    }
    if points.is_empty() {
        return Err((format!("file {shown} holds no values of {column:?}"), "one row at least".into()));
    }
    Ok(points)
}
