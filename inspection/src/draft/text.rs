//! Writes the drafted scenario, with a comment for each guess.

use super::experiment::Guess;
use super::matching::{Choice, choose};
use super::{Unit, experiment};
use orchestrator::fmu::{Causality, Variable};
use orchestrator::{Kind, Value};
use std::fmt::Write as _;

/// A text as TOML writes it.
fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

/// The scenario; `wait`: what goes back to an earlier unit comes one of its intervals later.
pub(super) fn scenario(units: &[Unit], wait: bool) -> String {
    let mut text = String::new();
    let (start, stop) = experiment::span(units);
    head(&mut text, units, &start, &stop);
    let lasts = stop.value - start.value;
    for unit in units {
        let interval = experiment::interval(unit, lasts);
        let (name, file) = (quoted(&unit.name), quoted(&unit.file));
        let _ = write!(
            text,
            "\n[[units]]\nname = {name}\nfmu = {file}\ninterval = {} # {}\n",
            interval.text, interval.comment
        );
    }
    let mut sources = String::new();
    for (to, unit) in units.iter().enumerate() {
        for input in unit.variables(Causality::Input) {
            let place = format!("{}.{}", unit.name, input.name);
            match choose(units, to, input) {
                Choice::Connect { from: (from, output), comment, others } => {
                    let output = format!("{}.{}", units[from].name, output.name);
                    let comment = format!("{comment}{}", listed(units, "; these fit, too", &others));
                    let _ = write!(text, "\n[[connections]] # {}\n", one_line(&comment));
                    let _ = writeln!(text, "from = {}\nto = {}", quoted(&output), quoted(&place));
                    if wait && from > to {
                        delay(&mut text, &units[from], lasts);
                    }
                }
                Choice::Free { comment, others } => {
                    let comment = format!("{comment}{}", listed(units, "", &others));
                    source(&mut sources, input, &place, &comment);
                }
            }
        }
    }
    text.push_str(&sources);
    record(&mut text, units);
    text
}

fn head(text: &mut String, units: &[Unit], start: &Guess, stop: &Guess) {
    let names: Vec<&str> = units.iter().map(|unit| unit.name.as_str()).collect();
    let _ = write!(
        text,
        "# Drafted by `acroscope new` from the units' descriptions. What is a guess says so.\n\
         format = 1\ndescription = {}\n\n[experiment]\nstart = {} # {}\nstop = {} # {}\n",
        quoted(&names.join(", ")),
        start.text,
        start.comment,
        stop.text,
        stop.comment
    );
    let _ = writeln!(
        text,
        "algorithm = \"gauss-seidel\" # units are stepped in the order in which they stand here"
    );
}

/// What comes from a later unit waits for one of its intervals.
fn delay(text: &mut String, from: &Unit, lasts: f64) {
    let _ = writeln!(
        text,
        "delay = {} # guess: without it units wait for each other at the start; an interval of {}",
        experiment::interval(from, lasts).text,
        from.name
    );
}

/// A constant for an input that nothing was found for.
fn source(text: &mut String, input: &Variable, place: &str, comment: &str) {
    let _ = write!(text, "\n[[sources]] # {}\n", one_line(comment));
    let (value, comment) = constant(input);
    let _ = writeln!(text, "to = {}\nkind = \"constant\"\nvalue = {value} # {comment}", quoted(place));
}

fn record(text: &mut String, units: &[Unit]) {
    text.push_str("\n[record] # the outputs of all units\nvariables = [\n");
    for unit in units {
        for output in unit.variables(Causality::Output) {
            let _ = writeln!(text, "    {},", quoted(&format!("{}.{}", unit.name, output.name)));
        }
    }
    text.push_str("]\n");
}

/// Names of outputs, for a comment.
fn listed(units: &[Unit], words: &str, outputs: &[(usize, &Variable)]) -> String {
    if outputs.is_empty() {
        return String::new();
    }
    let names = outputs.iter().map(|(unit, output)| format!("{}.{}", units[*unit].name, output.name));
    format!("{words}: {}", names.collect::<Vec<_>>().join(", "))
}

/// A comment ends with its line.
fn one_line(text: &str) -> String {
    text.replace(char::is_control, " ")
}

/// The start value of an input, for a comment.
fn start(input: &Variable) -> String {
    input.start.as_ref().map_or_else(String::new, ToString::to_string)
}

/// The value of a source and where it comes from.
fn constant(input: &Variable) -> (String, String) {
    let unit = input
        .unit
        .as_deref()
        .filter(|unit| *unit != "1")
        .map_or_else(String::new, |unit| format!("{unit}, "));
    let infinite = format!("guess: its start value is {}, with which nothing can be run", start(input));
    let (value, comment) = match (&input.start, input.kind) {
        (Some(Value::Real(value)), _) if value.is_finite() => (format!("{value:?}"), "its start value"),
        (Some(Value::Real(_)), _) => ("0.0".to_owned(), infinite.as_str()),
        (Some(Value::Integer(value)), _) => (value.to_string(), "its start value"),
        (Some(Value::Boolean(value)), _) => (value.to_string(), "its start value"),
        (Some(Value::String(value)), _) => (quoted(value), "its start value"),
        (_, Kind::Real) => ("0.0".to_owned(), "guess: it has no start value"),
        (_, Kind::Integer) => ("0".to_owned(), "guess: it has no start value"),
        (_, Kind::Boolean) => ("false".to_owned(), "guess: it has no start value"),
        (_, Kind::String) => ("\"\"".to_owned(), "guess: it has no start value"),
    };
    (value, one_line(&format!("{unit}{comment}")))
}
