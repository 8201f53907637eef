//! From a study's text to the design: `[grid]`, `[list]`, `[random]`, `[latin-hypercube]` or `[sobol]`.

use super::Parameter;
use super::text::{self, Entry, Text};
use crate::design::{Design, MOST, Method, Range, Sampled};
use crate::error::Error;
use orchestrator::Value;
use orchestrator::time::Rational;
use std::borrow::Cow;
use toml::de::{DeTable, DeValue};

const DESIGNS: [&str; 5] = ["grid", "list", "random", "latin-hypercube", "sobol"];
const AXIS: &str =
    "a list of values, or { from = 0.0, to = 0.06, step = 0.02 }, or with count instead of step";
const RANGE: &str = "a range { from = 0.0, to = 0.06 }, with scale = \"log\" if its logarithm is to be even";
const ROWS: &str =
    "rows = [{ \"camera.k1\" = 0.1, \"camera.seed\" = 1 }, ...], or a list of values for each parameter";

/// What varies, and how.
pub(super) fn design(at: &Text<'_>, top: &[Entry<'_>]) -> Result<(Vec<Parameter>, Design), Error> {
    let mut given = top.iter().filter(|(key, ..)| DESIGNS.contains(&key.as_ref()));
    let Some(entry) = given.next() else {
        let expected = "[grid], [list], [random], [latin-hypercube] or [sobol]";
        return Err(at.wrong(&(0..0), "nothing varies", expected));
    };
    if let Some((second, _, span)) = given.next() {
        let expected = format!("one of both: [{}] is at {}", entry.0, at.place(&entry.2));
        return Err(at.wrong(span, format!("a second design, [{second}]"), expected));
    }
    let table = text::table(at, entry, "a table, with a line for each parameter")?;
    let (parameters, design) = match entry.0.as_ref() {
        "grid" => grid(at, table)?,
        "list" => list(at, table)?,
        "random" => sampled(at, entry, table, Method::Random)?,
        "latin-hypercube" => sampled(at, entry, table, Method::LatinHypercube)?,
        _ => sampled(at, entry, table, Method::Sobol)?,
    };
    if parameters.is_empty() {
        return Err(at.wrong(
            &entry.2,
            format!("[{}] names no parameter", entry.0),
            "a line for each parameter",
        ));
    }
    match design.cases() {
        Some(cases) if cases <= MOST => Ok((parameters, design)),
        _ => Err(at.wrong(&entry.2, "more cases than can be counted", format!("{MOST} at most"))),
    }
}

/// The name of a parameter: `unit.variable`.
pub(super) fn parameter(at: &Text<'_>, (name, _, span): &Entry<'_>) -> Result<String, Error> {
    match name.split_once('.') {
        Some((unit, variable)) if !unit.is_empty() && !variable.is_empty() => Ok(name.to_string()),
        _ => Err(at.wrong(
            span,
            format!("{name:?} is no parameter"),
            "its full name, as in \"camera.T_delay\" = ...",
        )),
    }
}

/// The entries that name parameters. Without quotes TOML reads `camera.k1 = 1` as a table `camera`: the same is meant.
fn flat<'a>(table: &'a DeTable<'a>) -> Vec<Entry<'a>> {
    let mut all = Vec::new();
    for entry in text::entries(table) {
        match entry.1.as_table().filter(|_| !entry.0.contains('.')) {
            None => all.push(entry),
            Some(inner) => {
                let name = |key: &str| Cow::Owned(format!("{}.{key}", entry.0));
                all.extend(
                    text::entries(inner).into_iter().map(|(key, value, span)| (name(&key), value, span)),
                );
            }
        }
    }
    all
}

fn declared(at: &Text<'_>, entry: &Entry<'_>) -> Result<Parameter, Error> {
    Ok(Parameter { name: parameter(at, entry)?, place: at.place(&entry.2), value: None })
}

fn values(
    at: &Text<'_>,
    entry: &Entry<'_>,
    list: &[toml::Spanned<DeValue<'_>>],
) -> Result<Vec<Value>, Error> {
    if list.is_empty() {
        return Err(at.wrong(&entry.2, at.shown(&entry.2), "one value at least"));
    }
    let value =
        |one: &toml::Spanned<DeValue<'_>>| text::value(at, &(Cow::Borrowed(""), one.get_ref(), one.span()));
    list.iter().map(value).collect()
}

fn grid(at: &Text<'_>, table: &DeTable<'_>) -> Result<(Vec<Parameter>, Design), Error> {
    let entries = flat(table);
    let axis = |entry: &Entry<'_>| match entry.1 {
        DeValue::Array(list) => values(at, entry, list),
        DeValue::Table(range) => axis(at, entry, range),
        _ => Ok(vec![text::value(at, entry)?]),
    };
    let parameters = entries.iter().map(|entry| declared(at, entry)).collect::<Result<_, _>>()?;
    Ok((parameters, Design::Grid(entries.iter().map(axis).collect::<Result<_, _>>()?)))
}

/// Values from one end to the other, both of which belong to it. Computed with the decimals that were typed.
fn axis(at: &Text<'_>, entry: &Entry<'_>, range: &DeTable<'_>) -> Result<Vec<Value>, Error> {
    let (name, _, span) = entry;
    let keys = text::known(at, range, name, &["from", "to", "step", "count", "scale"])?;
    let find = |key: &str| keys.iter().find(|(known, ..)| *known == key);
    let exact = |key: &str| {
        let Some((_, value, span)) = find(key) else { return Ok(None) };
        let typed = text::digits(value).or_else(|| value.as_str().map(str::to_owned));
        let number = typed.and_then(|typed| Rational::parse(&typed));
        let expected = "a number such as 0.06, 5e-3 or \"1/30\"";
        number.map(Some).ok_or_else(|| at.wrong(span, format!("{name}: {}", at.shown(span)), expected))
    };
    let (Some(from), Some(to)) = (exact("from")?, exact("to")?) else {
        return Err(at.wrong(span, format!("{name} lacks from or to"), AXIS));
    };
    let (step, count) = (exact("step")?, find("count").map(|entry| text::whole(at, entry)).transpose()?);
    let log = logarithmic(at, find("scale"), name, from.to_f64(), to.to_f64())?;
    let off = |what: String, expected: String| at.wrong(span, format!("{name}: {what}"), expected);
    let count = match (step, count) {
        (Some(step), None) if !log => {
            steps(from, to, step).map_err(|(what, expected)| off(what, expected))?
        }
        (None, Some(count @ 1..)) if count > 1 || from == to => count,
        (None, Some(count)) => {
            return Err(off(format!("count = {count}"), "2 or more, since both ends belong to it".into()));
        }
        _ => {
            return Err(off(
                match (step, count) {
                    (Some(_), Some(_)) => "both step and count".into(),
                    (Some(_), None) => "step with scale = \"log\"".into(),
                    _ => "neither step nor count".into(),
                },
                format!("one of them (with scale = \"log\": count): {AXIS}"),
            ));
        }
    };
    if count > 10_000_000 {
        return Err(off(
            format!("{count} values"),
            "ten million at most; a [list] or [random] has no such bound".into(),
        ));
    }
    (0..count).map(|place| Ok(between(from, to, place, count, log))).collect()
}

/// How many values a step makes; an error is what is wrong, and what would be right.
fn steps(from: Rational, to: Rational, step: Rational) -> Result<u64, (String, String)> {
    let over = |a: Rational, b: Rational| {
        let above = i128::from(a.numerator()).checked_mul(i128::from(b.denominator()))?;
        let below = i128::from(a.denominator()).checked_mul(i128::from(b.numerator()))?;
        Some((above, below))
    };
    let minus = |a: Rational, b: Rational| {
        let (above, below) = over(a, Rational::new(1, 1)?)?;
        let (other, under) = (i128::from(b.numerator()), i128::from(b.denominator()));
        Rational::new(
            above.checked_mul(under)?.checked_sub(other.checked_mul(below)?)?,
            below.checked_mul(under)?,
        )
    };
    let shown = format!("from {} to {} by {}", from.to_f64(), to.to_f64(), step.to_f64());
    if step == Rational::ZERO {
        return Err((shown, "a step that is not 0".into()));
    }
    let long = || (shown.clone(), "rounder numbers, which 64-bit fractions hold".to_owned());
    let (above, below) = minus(to, from).and_then(|span| over(span, step)).ok_or_else(long)?;
    let (above, below) = if below < 0 { (-above, -below) } else { (above, below) };
    if above < 0 {
        return Err((shown, "a step that leads from the one to the other".into()));
    }
    if above % below != 0 {
        let whole = (above / below) as f64;
        let near = |steps: f64| report::head::short(from.to_f64() + steps * step.to_f64());
        let expected = format!(
            "whole steps, since both ends belong to it: to = {} or {}",
            near(whole),
            near(whole + 1.0)
        );
        return Err((shown, expected));
    }
    u64::try_from(above / below + 1).map_err(|_| long())
}

/// A value of an axis: exact where fractions hold it; whole where it is.
fn between(from: Rational, to: Rational, place: u64, count: u64, log: bool) -> Value {
    let last = count.saturating_sub(1).max(1);
    let exact = || {
        let (a, b) = (i128::from(from.numerator()), i128::from(from.denominator()));
        let (c, d) = (i128::from(to.numerator()), i128::from(to.denominator()));
        let (k, n) = (i128::from(place), i128::from(last));
        let above = a.checked_mul(d)?.checked_mul(n - k)?.checked_add(c.checked_mul(b)?.checked_mul(k)?)?;
        Rational::new(above, b.checked_mul(d)?.checked_mul(n)?)
    };
    let share = place as f64 / last as f64;
    let (low, high) = (from.to_f64(), to.to_f64());
    if log && place > 0 && place < last {
        return Value::Real(Range { from: low, to: high, log, whole: false }.at(share));
    }
    match exact() {
        Some(number) if number.denominator() == 1 && i32::try_from(number.numerator()).is_ok() => {
            Value::Integer(number.numerator() as i32)
        }
        Some(number) => Value::Real(number.to_f64()),
        None => Value::Real(low + share * (high - low)),
    }
}

fn logarithmic(
    at: &Text<'_>,
    scale: Option<&Entry<'_>>,
    name: &str,
    from: f64,
    to: f64,
) -> Result<bool, Error> {
    let Some(entry) = scale else { return Ok(false) };
    match entry.1.as_str() {
        Some("linear") => Ok(false),
        Some("log") if from > 0.0 && to > 0.0 => Ok(true),
        Some("log") => Err(at.wrong(&entry.2, format!("{name}: scale = \"log\""), "both ends above 0")),
        _ => Err(at.wrong(&entry.2, format!("{name}: {}", at.shown(&entry.2)), "\"linear\" or \"log\"")),
    }
}

fn list(at: &Text<'_>, table: &DeTable<'_>) -> Result<(Vec<Parameter>, Design), Error> {
    if let Some((_, rows, span)) = text::entries(table).into_iter().find(|(key, ..)| key == "rows") {
        if table.len() > 1 {
            return Err(at.wrong(&span, "rows, and other keys beside it", ROWS));
        }
        let rows = rows.as_array().ok_or_else(|| at.wrong(&span, at.shown(&span), ROWS))?;
        return by_row(at, rows);
    }
    let entries = flat(table);
    let column = |entry: &Entry<'_>| match entry.1 {
        DeValue::Array(list) => values(at, entry, list),
        _ => Err(at.wrong(&entry.2, at.shown(&entry.2), ROWS)),
    };
    let columns = entries.iter().map(column).collect::<Result<Vec<_>, _>>()?;
    let lengths = columns.iter().map(Vec::len);
    if let (Some(first), Some(other)) =
        (columns.first(), lengths.clone().position(|other| other != columns[0].len()))
    {
        let what = format!("{} has {} values", entries[other].0, columns[other].len());
        return Err(at.wrong(
            &entries[other].2,
            what,
            format!("{}, as many as {}", first.len(), entries[0].0),
        ));
    }
    let parameters = entries.iter().map(|entry| declared(at, entry)).collect::<Result<Vec<_>, _>>()?;
    let rows =
        (0..columns.first().map_or(0, Vec::len)).map(|row| columns.iter().map(|c| c[row].clone()).collect());
    Ok((parameters, Design::List(rows.collect())))
}

fn by_row(at: &Text<'_>, rows: &[toml::Spanned<DeValue<'_>>]) -> Result<(Vec<Parameter>, Design), Error> {
    let mut parameters: Vec<Parameter> = Vec::new();
    let mut all = Vec::new();
    for row in rows {
        let span = row.span();
        let table = row.get_ref().as_table().ok_or_else(|| at.wrong(&span, at.shown(&span), ROWS))?;
        let entries = flat(table);
        if parameters.is_empty() {
            parameters = entries.iter().map(|entry| declared(at, entry)).collect::<Result<_, _>>()?;
        }
        if let Some((name, ..)) =
            entries.iter().find(|(name, ..)| parameters.iter().all(|one| *name != one.name))
        {
            let names = parameters.iter().map(|parameter| parameter.name.as_str());
            let expected = orchestrator::nearest(name, names);
            return Err(at.wrong(&span, format!("{name} is not in the first row"), expected));
        }
        let value = |parameter: &Parameter| match entries.iter().find(|(name, ..)| *name == parameter.name) {
            Some(entry) => text::value(at, entry),
            None => {
                Err(at.wrong(&span, format!("this row has no {}", parameter.name), "a value in every row"))
            }
        };
        all.push(parameters.iter().map(value).collect::<Result<Vec<_>, _>>()?);
    }
    Ok((parameters, Design::List(all)))
}

fn sampled(
    at: &Text<'_>,
    whole: &Entry<'_>,
    table: &DeTable<'_>,
    method: Method,
) -> Result<(Vec<Parameter>, Design), Error> {
    let (mut parameters, mut ranges, mut count, mut seed) = (Vec::new(), Vec::new(), None, None);
    for entry in flat(table) {
        match entry.0.as_ref() {
            "count" => count = Some(text::whole(at, &entry)?),
            "seed" => seed = Some(text::whole(at, &entry)?),
            _ => {
                parameters.push(declared(at, &entry)?);
                ranges.push(range(at, &entry)?);
            }
        }
    }
    let name = &whole.0;
    let what =
        if count == Some(0) { format!("[{name}] count = 0") } else { format!("[{name}] has no count") };
    let count = count
        .filter(|count| *count > 0)
        .ok_or_else(|| at.wrong(&whole.2, what, "count = 1000, the cases"))?;
    if method != Method::Sobol && seed.is_none() {
        let expected = "seed = 1, or any other whole number: the same seed gives the same cases";
        return Err(at.wrong(&whole.2, format!("[{name}] has no seed"), expected));
    }
    let sampled = Sampled { method, count, seed, ranges };
    match sampled.refused() {
        Some((what, expected)) => Err(at.wrong(&whole.2, format!("[{name}]: {what}"), expected)),
        None => Ok((parameters, Design::Sampled(sampled))),
    }
}

fn range(at: &Text<'_>, entry: &Entry<'_>) -> Result<Range, Error> {
    let (name, value, span) = entry;
    let table = value.as_table().ok_or_else(|| at.wrong(span, at.shown(span), RANGE))?;
    let keys = text::known(at, table, name, &["from", "to", "scale"])?;
    let find = |key: &str| keys.iter().find(|(known, ..)| *known == key);
    let end = |key: &str| match find(key) {
        Some(entry) => text::number(at, entry),
        None => Err(at.wrong(span, format!("{name} has no {key}"), RANGE)),
    };
    let (from, to) = (end("from")?, end("to")?);
    if from > to {
        return Err(at.wrong(span, format!("{name}: from {from} to {to}"), "from the smaller to the larger"));
    }
    Ok(Range { from, to, log: logarithmic(at, find("scale"), name, from, to)?, whole: false })
}
