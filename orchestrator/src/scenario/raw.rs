//! From TOML text to a [`Scenario`]: the keys, their types and their lines.

use super::connection::{self, Connection};
use super::source::{self, Source};
use super::{Given, Placed, Scenario, UnitEntry};
use crate::error::{Error, Place};
use crate::isolation::{Isolation, limit_of};
use crate::time::Rational;
use serde::Deserialize;
use std::cell::RefCell;
use std::collections::{BTreeMap, HashMap};
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;
use toml::Spanned;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Raw {
    format: Spanned<i64>,
    #[serde(default)]
    description: String,
    experiment: Experiment,
    units: Vec<Spanned<Unit>>,
    #[serde(default)]
    connections: Vec<Spanned<Connection>>,
    #[serde(default)]
    sources: Vec<Spanned<Source>>,
    record: Option<Record>,
    #[serde(default)]
    report: toml::Table,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Experiment {
    start: Option<Spanned<toml::Value>>,
    stop: Spanned<toml::Value>,
    algorithm: Option<Spanned<String>>,
    seed: Option<Spanned<i64>>,
    #[serde(default)]
    options: BTreeMap<String, Spanned<Number>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Unit {
    name: Spanned<String>,
    fmu: Spanned<String>,
    interval: Spanned<toml::Value>,
    offset: Option<Spanned<toml::Value>>,
    #[serde(default)]
    retry: bool,
    #[serde(default)]
    isolate: bool,
    step_limit: Option<Spanned<f64>>,
    memory_limit: Option<Spanned<u64>>,
    #[serde(default)]
    set: BTreeMap<String, Spanned<toml::Value>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Record {
    variables: Vec<Spanned<String>>,
}

/// 1, 1.0 or true.
#[derive(Deserialize, Clone, Copy)]
#[serde(untagged, expecting = "expected a number, true or false")]
pub(super) enum Number {
    Real(f64),
    Integer(i64),
    Boolean(bool),
}

impl From<Number> for f64 {
    fn from(number: Number) -> Self {
        match number {
            Number::Real(value) => value,
            Number::Integer(value) => value as f64,
            Number::Boolean(value) => f64::from(u8::from(value)),
        }
    }
}

/// Turns byte positions into lines.
pub(super) struct Text {
    /// Where its lines end.
    ends: Vec<usize>,
    file: Arc<str>,
    /// What was read otherwise than it was written.
    notes: RefCell<Vec<String>>,
}

impl Text {
    fn new(text: &str, origin: &Path) -> Self {
        let ends = text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n').map(|(at, _)| at).collect();
        Self { ends, file: origin.to_string_lossy().into(), notes: RefCell::default() }
    }

    pub(super) fn place(&self, span: Range<usize>) -> Place {
        let line = 1 + self.ends.partition_point(|end| *end < span.start);
        Place::Line { file: self.file.clone(), line }
    }

    pub(super) fn wrong(
        &self,
        span: Range<usize>,
        what: impl Into<String>,
        expected: impl Into<String>,
    ) -> Error {
        Error::Scenario { place: self.place(span), what: what.into(), expected: expected.into() }
    }

    fn time(&self, key: &str, value: &Spanned<toml::Value>) -> Result<Rational, Error> {
        let time = match value.get_ref() {
            toml::Value::Integer(number) => Rational::new(i128::from(*number), 1).map(|time| (time, false)),
            toml::Value::Float(number) => Rational::recover(zmij::Buffer::new().format(*number)),
            toml::Value::String(text) => Rational::recover(text),
            _ => None,
        };
        let (time, recovered) = time.ok_or_else(|| {
            let expected = "a time in s that fits 64-bit fractions, such as 0.001, 5e-3 or \"1/30\"";
            self.wrong(value.span(), format!("{key} = {}", value.get_ref()), expected)
        })?;
        if recovered {
            let place = self.place(value.span());
            self.notes.borrow_mut().push(format!("{place}: {key} = {} is read as {time}", value.get_ref()));
        }
        Ok(time)
    }

    pub(super) fn positive(
        &self,
        key: &str,
        value: &Spanned<toml::Value>,
        or_zero: bool,
    ) -> Result<Rational, Error> {
        let time = self.time(key, value)?;
        if time.is_positive() || or_zero && time == Rational::ZERO {
            return Ok(time);
        }
        let expected = if or_zero { "not less than zero" } else { "greater than zero" };
        Err(self.wrong(value.span(), format!("{key} = {time}"), expected))
    }

    /// A seed of random numbers.
    pub(super) fn seed(&self, value: &Spanned<i64>) -> Result<u64, Error> {
        let wrong = |_| {
            let expected = "an integer, not less than zero";
            self.wrong(value.span(), format!("seed = {}", value.get_ref()), expected)
        };
        u64::try_from(*value.get_ref()).map_err(wrong)
    }
}

pub(super) fn parse(text: &str, origin: &Path) -> Result<Scenario, Error> {
    let at = Text::new(text, origin);
    let raw: Raw = toml::from_str(text).map_err(|error| {
        let span = error.span().unwrap_or(0..0);
        at.wrong(span, "not a scenario", error.message().replace('\n', " "))
    })?;
    if *raw.format.get_ref() != 1 {
        let what = format!("format = {}", raw.format.get_ref());
        return Err(at.wrong(raw.format.span(), what, "this program reads format = 1"));
    }
    let start = raw.experiment.start.as_ref().map_or(Ok(Rational::ZERO), |value| at.time("start", value))?;
    let stop = at.time("stop", &raw.experiment.stop)?;
    if stop < start {
        let what = format!("stop = {stop}");
        return Err(at.wrong(raw.experiment.stop.span(), what, format!("not before start = {start}")));
    }
    let algorithm = match raw.experiment.algorithm {
        Some(name) => Placed { place: at.place(name.span()), value: name.into_inner() },
        None => Placed { place: at.place(0..0), value: "gauss-seidel".into() },
    };
    let placed = |text: Spanned<String>| Placed { place: at.place(text.span()), value: text.into_inner() };
    let mut scenario = Scenario {
        origin: origin.into(),
        description: raw.description,
        start,
        stop,
        algorithm,
        options: (raw.experiment.options.into_iter())
            .map(|(name, value)| {
                (name, Placed { place: at.place(value.span()), value: value.into_inner().into() })
            })
            .collect(),
        seed: raw.experiment.seed.as_ref().map_or(Ok(0), |seed| at.seed(seed))?,
        units: units(&at, raw.units)?,
        connections: raw
            .connections
            .into_iter()
            .map(|entry| connection::read(&at, entry))
            .collect::<Result<_, _>>()?,
        sources: raw.sources.into_iter().map(|entry| source::read(&at, entry)).collect::<Result<_, _>>()?,
        record: raw.record.map(|record| record.variables.into_iter().map(placed).collect()),
        report: raw.report,
        place: at.place(0..0),
        notes: Vec::new(),
    };
    scenario.notes = at.notes.take();
    Ok(scenario)
}

/// What the name of a unit can't hold: parts of `unit.variable`, of patterns and of `--set`.
fn never_in_a_name(letter: char) -> bool {
    letter.is_whitespace() || matches!(letter, '.' | '*' | '=')
}

/// The name of a unit from that of its file: the stem, with `_` for what no name can hold. Modelica's tools write `Package.Model.fmu`.
pub fn name_of_file(file: &std::path::Path) -> String {
    let stem = file.file_stem().unwrap_or_default().to_string_lossy();
    stem.replace(never_in_a_name, "_")
}

fn units(at: &Text, raw: Vec<Spanned<Unit>>) -> Result<Vec<UnitEntry>, Error> {
    let mut units: Vec<UnitEntry> = Vec::with_capacity(raw.len());
    let mut known: HashMap<String, Place> = HashMap::with_capacity(raw.len());
    for entry in raw {
        let place = at.place(entry.span());
        let unit = entry.into_inner();
        let name = unit.name.get_ref();
        if name.is_empty() || name.contains(never_in_a_name) {
            let expected = "a name without dots, stars, equal signs and spaces";
            return Err(at.wrong(unit.name.span(), format!("unit name {name:?}"), expected));
        }
        if let Some(first) = known.insert(name.clone(), place.clone()) {
            let expected = format!("the first one is at {first}");
            return Err(at.wrong(unit.name.span(), format!("a second unit {name:?}"), expected));
        }
        let isolation = isolation(at, &unit)?;
        let set = (unit.set.into_iter())
            .map(|(name, value)| {
                let place = at.place(value.span());
                (name, Placed { value: Given::Toml(value.into_inner()), place })
            })
            .collect();
        let interval = at.positive("interval", &unit.interval, false)?;
        units.push(UnitEntry {
            interval,
            retry: unit.retry,
            offset: offset(at, unit.offset.as_ref(), interval)?,
            fmu: Placed { place: at.place(unit.fmu.span()), value: unit.fmu.into_inner() },
            name: unit.name.into_inner(),
            isolation,
            set,
            place,
        });
    }
    Ok(units)
}

/// How much later than the start the points of a unit begin.
fn offset(
    at: &Text,
    offset: Option<&Spanned<toml::Value>>,
    interval: Rational,
) -> Result<Option<Placed<Rational>>, Error> {
    let Some(given) = offset else { return Ok(None) };
    let offset = at.positive("offset", given, true)?;
    if offset >= interval {
        let expected = format!("less than the interval of {interval} s");
        return Err(at.wrong(given.span(), format!("offset = {offset}"), expected));
    }
    Ok(offset.is_positive().then(|| Placed { value: offset, place: at.place(given.span()) }))
}

/// Whether a unit has a process of its own.
fn isolation(at: &Text, unit: &Unit) -> Result<Option<Isolation>, Error> {
    let mut isolation = Isolation::default();
    let keys = [
        ("step_limit", unit.step_limit.as_ref().map(Spanned::span)),
        ("memory_limit", unit.memory_limit.as_ref().map(Spanned::span)),
    ];
    if let (false, Some((key, Some(span)))) =
        (unit.isolate, keys.into_iter().find(|(_, span)| span.is_some()))
    {
        return Err(at.wrong(span, key, "it goes with isolate = true"));
    }
    if let Some(limit) = &unit.step_limit {
        let wrong = || {
            at.wrong(
                limit.span(),
                format!("step_limit = {}", limit.get_ref()),
                "seconds, above zero and below 1e9",
            )
        };
        isolation.step_limit = limit_of(*limit.get_ref()).ok_or_else(wrong)?;
    }
    if let Some(limit) = &unit.memory_limit {
        let wrong =
            || at.wrong(limit.span(), format!("memory_limit = {}", limit.get_ref()), "MiB, above zero");
        let bytes = limit.get_ref().checked_mul(1 << 20).filter(|limit| *limit > 0);
        isolation.memory_limit = Some(bytes.ok_or_else(wrong)?);
    }
    Ok(unit.isolate.then_some(isolation))
}
