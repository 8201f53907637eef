//! A study from words of a command line: `--grid camera.T_delay=0:0.06:0.005 --until plant.contact`. They become the text of
//! a study, a line for each word, so that there is one way only to read one.

use crate::error::Error;
use orchestrator::Value;

/// What was typed.
#[derive(Debug, Clone, Default)]
pub struct Words {
    /// The scenario.
    pub scenario: String,
    /// `NAME=FROM:TO:STEP`, or `NAME=VALUE,VALUE,...`.
    pub grid: Vec<String>,
    /// `plant.contact`, or `plant.q2 > 2`.
    pub until: Option<String>,
    /// `NAME=SIGNAL:REDUCE`, or `NAME=SIGNAL-OTHER:REDUCE`.
    pub scalars: Vec<String>,
}

impl Words {
    /// The study's text, and for each line what it comes from.
    pub(super) fn text(&self) -> Result<(String, Vec<String>), Error> {
        let mut lines = Lines::default();
        lines.add("format = 1".into(), "--grid".into());
        lines.add(format!("scenario = {}", quoted(&self.scenario)), self.scenario.clone());
        if let Some(until) = &self.until {
            lines.add(format!("until = {}", quoted(until)), format!("--until {until:?}"));
        }
        lines.add("[grid]".into(), "--grid".into());
        for typed in &self.grid {
            lines.add(axis(typed)?, format!("--grid {typed}"));
        }
        lines.add("[scalars]".into(), "--scalar".into());
        for typed in &self.scalars {
            lines.add(scalar(typed)?, format!("--scalar {typed}"));
        }
        match (&self.until, self.scalars.is_empty()) {
            (Some(until), true) => lines.add(first_time(until), format!("--until {until:?}")),
            (None, true) => {
                let expected = "--until plant.contact, or --scalar NAME=SIGNAL:REDUCE";
                return Err(wrong("--grid", "nothing of a run would be kept", expected));
            }
            _ => {}
        }
        Ok((lines.text, lines.places))
    }
}

#[derive(Default)]
struct Lines {
    text: String,
    places: Vec<String>,
}

impl Lines {
    fn add(&mut self, line: String, place: String) {
        self.text.push_str(&line);
        self.text.push('\n');
        self.places.push(place);
    }
}

fn wrong(place: &str, what: &str, expected: &str) -> Error {
    Error::Study { place: place.into(), what: what.into(), expected: expected.into() }
}

/// A text as TOML has it, on one line.
fn quoted(text: &str) -> String {
    let mut quoted = String::from("\"");
    for c in text.chars() {
        match c {
            '"' => quoted.push_str("\\\""),
            '\\' => quoted.push_str("\\\\"),
            c if c.is_control() => quoted.push_str(&format!("\\u{:04X}", u32::from(c))),
            c => quoted.push(c),
        }
    }
    quoted.push('"');
    quoted
}

fn axis(typed: &str) -> Result<String, Error> {
    let place = format!("--grid {typed}");
    let expected =
        "NAME=FROM:TO:STEP or NAME=VALUE,VALUE, e.g. camera.T_delay=0:0.06:0.005 or camera.omega_cam=30,60";
    let (name, values) = typed.split_once('=').ok_or_else(|| wrong(&place, "it has no =", expected))?;
    let name = quoted(name.trim());
    match values.split(':').map(str::trim).collect::<Vec<_>>().as_slice() {
        [from, to, step] => {
            let (from, to, step) = (quoted(from), quoted(to), quoted(step));
            Ok(format!("{name} = {{ from = {from}, to = {to}, step = {step} }}"))
        }
        [list] => {
            let values: Vec<String> = list.split(',').map(|value| plain(value.trim())).collect();
            Ok(format!("{name} = [{}]", values.join(", ")))
        }
        _ => Err(wrong(&place, "wrong values", expected)),
    }
}

/// A value as TOML has it: a number, a truth, or else a text.
fn plain(typed: &str) -> String {
    match (typed.parse::<i32>(), typed.parse::<f64>()) {
        (Ok(number), _) => number.to_string(),
        (_, Ok(number)) if number.is_finite() => format!("{}", Value::Real(number)),
        _ if typed == "true" || typed == "false" => typed.to_owned(),
        _ => quoted(typed),
    }
}

fn scalar(typed: &str) -> Result<String, Error> {
    let expected =
        "NAME=SIGNAL:REDUCE, e.g. peak=plant.tau_applied:peak or rms=controller.z_desired-plant.z:rms";
    let refused = |what: &str| wrong(&format!("--scalar {typed}"), what, expected);
    let (name, rest) = typed.split_once('=').ok_or_else(|| refused("it has no ="))?;
    let (signal, reduce) = rest.rsplit_once(':').ok_or_else(|| refused("it has no :"))?;
    let (signal, minus) = match signal.split_once('-') {
        Some((signal, minus)) => (signal, format!(", minus = {}", quoted(minus.trim()))),
        None => (signal, String::new()),
    };
    let (signal, reduce) = (quoted(signal.trim()), quoted(reduce.trim()));
    Ok(format!("{} = {{ signal = {signal}{minus}, reduce = {reduce} }}", quoted(name.trim())))
}

/// When the runs end, as a column.
fn first_time(until: &str) -> String {
    let (signal, limit) = match until.find(['<', '>']) {
        Some(at) => (&until[..at], until[at..].split_at(1)),
        None => (until, ("", "")),
    };
    let limit = match limit {
        (">", limit) => format!(", above = {}", limit.trim()),
        ("<", limit) => format!(", below = {}", limit.trim()),
        _ => String::new(),
    };
    let signal = quoted(signal.trim());
    format!("{signal} = {{ signal = {signal}, reduce = \"first_true\"{limit} }}")
}
