//! A scenario with every value that was used, as TOML that loads again and gives the same run.

use super::{Channel, ConnectionEntry, Hold, Scenario, Shape, SignalEntry, Transform, UnitEntry};
use crate::value::Value;
use std::fmt::Write;
use toml::Value as Toml;

/// What became of a unit: where its file is looked for, and all values it was given.
pub(crate) struct ResolvedUnit {
    pub(crate) fmu: String,
    pub(crate) values: Vec<(String, Value)>,
}

/// The text of the resolved scenario; `units` in the scenario's order. Files are named by their full paths.
pub(crate) fn resolved(scenario: &Scenario, units: &[ResolvedUnit]) -> String {
    text(scenario, units, |file| {
        let path = scenario.folder().join(file);
        path.canonicalize().unwrap_or(path).to_string_lossy().into_owned()
    })
}

/// As [`resolved`], with files as the scenario names them.
pub(crate) fn files_as_named(scenario: &Scenario, units: &[ResolvedUnit]) -> String {
    text(scenario, units, str::to_owned)
}

fn text(scenario: &Scenario, units: &[ResolvedUnit], path: impl Fn(&str) -> String) -> String {
    let mut out = String::from("# Written by the run: every value that was used.\nformat = 1\n");
    line(&mut out, "description", &scenario.description);
    experiment(&mut out, scenario);
    for (entry, resolved) in scenario.units.iter().zip(units) {
        unit(&mut out, entry, resolved);
    }
    for connection in &scenario.connections {
        out.push_str("\n[[connections]]\n");
        line(&mut out, "from", &connection.from);
        line(&mut out, "to", &connection.to);
        way(&mut out, connection);
    }
    for source in &scenario.sources {
        out.push_str("\n[[sources]]\n");
        line(&mut out, "to", &source.to);
        signal(&mut out, &source.signal, &path);
    }
    if let Some(patterns) = &scenario.record {
        out.push_str("\n[record]\n");
        let patterns = patterns.iter().map(|pattern| Toml::String(pattern.value.clone())).collect();
        put(&mut out, "variables", &Toml::Array(patterns));
    }
    if !scenario.report.is_empty() {
        let report = toml::Table::from_iter([("report".to_owned(), Toml::Table(scenario.report.clone()))]);
        out.push('\n');
        out.push_str(&report.to_string());
    }
    out
}

fn experiment(out: &mut String, scenario: &Scenario) {
    out.push_str("\n[experiment]\n");
    line(out, "start", &scenario.start.to_string());
    line(out, "stop", &scenario.stop.to_string());
    line(out, "algorithm", &scenario.algorithm.value);
    if scenario.seed > 0 {
        put(out, "seed", &Toml::Integer(scenario.seed.cast_signed()));
    }
    if !scenario.options.is_empty() {
        out.push_str("[experiment.options]\n");
        for (name, value) in &scenario.options {
            put(out, name, &Toml::Float(value.value));
        }
    }
}

fn unit(out: &mut String, entry: &UnitEntry, resolved: &ResolvedUnit) {
    out.push_str("\n[[units]]\n");
    line(out, "name", &entry.name);
    line(out, "fmu", &resolved.fmu);
    line(out, "interval", &entry.interval.to_string());
    if let Some(offset) = &entry.offset {
        line(out, "offset", &offset.value.to_string());
    }
    if entry.retry {
        put(out, "retry", &Toml::Boolean(true));
    }
    if let Some(isolation) = &entry.isolation {
        put(out, "isolate", &Toml::Boolean(true));
        put(out, "step_limit", &Toml::Float(isolation.step_limit.as_secs_f64()));
        if let Some(limit) = isolation.memory_limit {
            put(out, "memory_limit", &Toml::Integer((limit >> 20).cast_signed()));
        }
    }
    out.push_str("[units.set]\n");
    for (name, value) in &resolved.values {
        put(out, name, &toml_of(value));
    }
}

/// What happens to values on their way.
fn way(out: &mut String, connection: &ConnectionEntry) {
    let Channel { jitter, drop, hold, seed } = connection.channel;
    for (key, time) in [("latency", connection.delay), ("jitter", jitter)] {
        if time.is_positive() {
            line(out, key, &time.to_string());
        }
    }
    if drop > 0.0 {
        put(out, "drop", &Toml::Float(drop));
    }
    if hold != Hold::Zero {
        line(out, "hold", hold.name());
    }
    if let Some(seed) = seed {
        put(out, "seed", &Toml::Integer(seed.cast_signed()));
    }
    let Transform { gain, bias, convert_units } = connection.transform;
    if gain != 1.0 {
        put(out, "gain", &Toml::Float(gain));
    }
    if bias != 0.0 {
        put(out, "bias", &Toml::Float(bias));
    }
    if !convert_units {
        put(out, "convert_units", &Toml::Boolean(false));
    }
    if !connection.map.is_empty() {
        let pair = |(from, to): &(Toml, Toml)| Toml::Array(vec![from.clone(), to.clone()]);
        put(out, "map", &Toml::Array(connection.map.iter().map(pair).collect()));
    }
}

fn signal(out: &mut String, signal: &SignalEntry, path: impl Fn(&str) -> String) {
    match signal {
        SignalEntry::Constant(value) => {
            line(out, "kind", "constant");
            put(out, "value", value);
        }
        SignalEntry::Table { shape, points } => {
            line(out, "kind", name(*shape));
            let pair = |&(time, value): &(f64, f64)| Toml::Array(vec![Toml::Float(time), Toml::Float(value)]);
            put(out, "points", &Toml::Array(points.iter().map(pair).collect()));
        }
        SignalEntry::Csv { file, column, shape } => {
            line(out, "kind", "csv");
            line(out, "file", &path(file));
            line(out, "column", column);
            line(out, "interpolation", name(*shape));
        }
    }
}

fn name(shape: Shape) -> &'static str {
    match shape {
        Shape::Hold => "hold",
        Shape::Linear => "linear",
        Shape::Smooth => "smooth",
    }
}

fn toml_of(value: &Value) -> Toml {
    match value {
        Value::Real(value) => Toml::Float(*value),
        Value::Integer(value) => Toml::Integer(i64::from(*value)),
        Value::Boolean(value) => Toml::Boolean(*value),
        Value::String(value) => Toml::String(value.clone()),
    }
}

fn line(out: &mut String, key: &str, text: &str) {
    put(out, key, &Toml::String(text.to_owned()));
}

/// The shortest digits that read back to the same bits; TOML's own writer spells 1e300 out.
fn text_of(value: &Toml) -> String {
    match value {
        Toml::Float(number) if number.is_finite() => zmij::Buffer::new().format(*number).to_owned(),
        Toml::Array(values) => format!("[{}]", values.iter().map(text_of).collect::<Vec<_>>().join(", ")),
        other => other.to_string(),
    }
}

/// A basic string of TOML: what stands in a key has to stay on its line.
fn basic(text: &str) -> String {
    let mut out = String::from("\"");
    for c in text.chars() {
        match c {
            '"' | '\\' => out.extend(['\\', c]),
            c if c.is_control() => out.push_str(&format!("\\u{:04X}", u32::from(c))),
            c => out.push(c),
        }
    }
    out.push('"');
    out
}

fn put(out: &mut String, key: &str, value: &Toml) {
    let value = text_of(value);
    let bare = !key.is_empty() && key.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_' || b == b'-');
    // Writing to a String can't fail.
    let _ = match bare {
        true => writeln!(out, "{key} = {value}"),
        false => writeln!(out, "{} = {value}", basic(key)),
    };
}

#[cfg(test)]
mod tests {
    use super::{Toml, put};

    #[test]
    fn value_keys_are_quoted_where_toml_asks_for_it() {
        let mut out = String::new();
        for key in ["a_1", "a-b", "a.b", "a b", "", "ä", "a\nb", "a\"\\'"] {
            put(&mut out, key, &Toml::Float(1e300));
        }
        let keys = ["a_1", "a-b", "\"a.b\"", "\"a b\"", "\"\"", "\"ä\"", "\"a\\u000Ab\"", "\"a\\\"\\\\'\""];
        assert_eq!(out, keys.map(|key| format!("{key} = 1e+300\n")).concat());
        let read = out.parse::<toml::Table>().expect("TOML");
        assert!(read.len() == 8 && read.contains_key("a\nb") && read.contains_key("a\"\\'"));
    }
}
