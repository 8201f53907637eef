//! `[[sources]]`: signals that drive inputs from outside the units.

use super::raw::{Number, Text};
use super::{Shape, SignalEntry, SourceEntry};
use crate::error::Error;
use serde::Deserialize;
use std::ops::Range;
use toml::Spanned;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Source {
    to: String,
    kind: Spanned<String>,
    value: Option<Spanned<toml::Value>>,
    points: Option<Spanned<Vec<Point>>>,
    file: Option<Spanned<String>>,
    column: Option<Spanned<String>>,
    interpolation: Option<Spanned<String>>,
}

/// A time and a value. Not a tuple: of those a third number would be dropped without a word.
#[derive(Deserialize, Clone, Copy)]
#[serde(try_from = "Vec<Number>")]
struct Point([Number; 2]);

impl TryFrom<Vec<Number>> for Point {
    type Error = String;

    fn try_from(numbers: Vec<Number>) -> Result<Self, String> {
        let count = numbers.len();
        numbers
            .try_into()
            .map(Self)
            .map_err(|_| format!("a point of {count} numbers: expected [time, value]"))
    }
}

pub(super) fn read(at: &Text, entry: Spanned<Source>) -> Result<SourceEntry, Error> {
    let span = entry.span();
    let mut source = entry.into_inner();
    check_keys(at, span.clone(), &source)?;
    let kind = source.kind.get_ref().as_str();
    let missing =
        |key: &str| at.wrong(span.clone(), format!("a source of kind {kind:?}"), format!("it needs {key}"));
    let signal = match kind {
        "constant" => {
            SignalEntry::Constant(source.value.take().ok_or_else(|| missing("value"))?.into_inner())
        }
        "csv" => SignalEntry::Csv {
            file: source.file.take().ok_or_else(|| missing("file"))?.into_inner(),
            column: source.column.take().ok_or_else(|| missing("column"))?.into_inner(),
            shape: interpolation(at, source.interpolation.as_ref())?,
        },
        _ => {
            let points = source.points.take().ok_or_else(|| missing("points"))?;
            let shape = match kind {
                "hold" => Shape::Hold,
                "linear" => Shape::Linear,
                _ => Shape::Smooth,
            };
            SignalEntry::Table { shape, points: table(at, &points)? }
        }
    };
    Ok(SourceEntry { to: source.to, signal, place: at.place(span) })
}

/// The kind must be known, and each key one of that kind.
fn check_keys(at: &Text, span: Range<usize>, source: &Source) -> Result<(), Error> {
    let kind = source.kind.get_ref().as_str();
    let keys = [
        ("value", source.value.is_some(), &["constant"][..]),
        ("points", source.points.is_some(), &["hold", "linear", "smooth"]),
        ("file", source.file.is_some(), &["csv"]),
        ("column", source.column.is_some(), &["csv"]),
        ("interpolation", source.interpolation.is_some(), &["csv"]),
    ];
    if !keys.iter().any(|(.., kinds)| kinds.contains(&kind)) {
        let expected = "constant, hold, linear, smooth or csv";
        return Err(at.wrong(source.kind.span(), format!("kind = {kind:?}"), expected));
    }
    match keys.iter().find(|(_, given, kinds)| *given && !kinds.contains(&kind)) {
        Some((key, ..)) => {
            Err(at.wrong(span, format!("a source of kind {kind:?}"), format!("it has no key {key}")))
        }
        None => Ok(()),
    }
}

/// What a file's values are between its rows.
fn interpolation(at: &Text, name: Option<&Spanned<String>>) -> Result<Shape, Error> {
    let Some(name) = name else { return Ok(Shape::Linear) };
    match name.get_ref().as_str() {
        "linear" => Ok(Shape::Linear),
        "hold" => Ok(Shape::Hold),
        other => Err(at.wrong(name.span(), format!("interpolation = {other:?}"), "linear or hold")),
    }
}

/// Times in rising order, with their values.
fn table(at: &Text, points: &Spanned<Vec<Point>>) -> Result<Vec<(f64, f64)>, Error> {
    let pair = |Point([time, value]): &Point| ((*time).into(), (*value).into());
    let table: Vec<(f64, f64)> = points.get_ref().iter().map(pair).collect();
    if table.is_empty() || !table.iter().all(|(time, value)| time.is_finite() && value.is_finite()) {
        return Err(at.wrong(points.span(), "points", "one or more [time, value], all finite"));
    }
    if let Some(pair) = table.windows(2).find(|pair| pair[1].0 < pair[0].0) {
        let what = format!("time {} comes after {}", pair[1].0, pair[0].0);
        return Err(at.wrong(points.span(), what, "times in rising order"));
    }
    Ok(table)
}
