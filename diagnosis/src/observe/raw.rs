//! The keys of a `dataset.toml` of format 2, with their lines.

use crate::error::Error;
use orchestrator::nearest;
use serde::Deserialize;
use std::ops::Range;
use std::path::{Path, PathBuf};
use toml::{Spanned, Value};

/// The whole file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Raw {
    pub(super) format: Spanned<i64>,
    #[serde(default)]
    #[expect(dead_code, reason = "for people")]
    description: String,
    pub(super) scenario: Option<Spanned<String>>,
    pub(super) fmu: Option<Spanned<String>>,
    #[serde(default)]
    pub(super) set: toml::map::Map<String, Value>,
    #[serde(default)]
    pub(super) channel: Vec<Spanned<Channel>>,
    #[serde(default)]
    pub(super) state: Vec<Spanned<State>>,
    /// An empty list says that there is none.
    pub(super) candidate: Option<Vec<Spanned<Candidate>>>,
    #[serde(default)]
    pub(super) ports: Ports,
    #[serde(default)]
    pub(super) run: Vec<Spanned<Run>>,
}

/// `[[channel]]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Channel {
    pub(super) variable: Spanned<String>,
    pub(super) column: Option<Spanned<String>>,
    pub(super) unit: Option<Spanned<String>>,
    pub(super) scale: Option<Spanned<f64>>,
    pub(super) offset: Option<Spanned<f64>>,
    pub(super) noise: Option<Spanned<f64>>,
    pub(super) hold: Option<Spanned<String>>,
}

/// `[[state]]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct State {
    pub(super) start: Spanned<String>,
    pub(super) shows: Option<Spanned<String>>,
}

/// `[[candidate]]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Candidate {
    pub(super) variable: Spanned<String>,
    pub(super) neutral: Option<Spanned<Value>>,
    pub(super) range: Option<Spanned<(f64, f64)>>,
    pub(super) phrase: Option<String>,
    pub(super) scale: Option<Spanned<String>>,
}

/// `[ports]`
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Ports {
    pub(super) inputs: Option<Vec<Spanned<String>>>,
    pub(super) outputs: Option<Vec<Spanned<String>>>,
    pub(super) unknown_inputs: Option<bool>,
}

/// `[[run]]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Run {
    pub(super) file: Spanned<String>,
    pub(super) time: Option<Time>,
}

/// `time = { column = "t", unit = "ms" }`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Time {
    pub(super) column: Option<Spanned<String>>,
    pub(super) unit: Option<Spanned<String>>,
}

/// The file as text and as keys.
#[derive(Debug)]
pub(super) struct File {
    pub(super) path: PathBuf,
    text: String,
    pub(super) raw: Raw,
}

impl File {
    /// Reads `dataset.toml`.
    pub(super) fn read(path: &Path) -> Result<Self, Error> {
        let text = orchestrator::plain::read_text(path)
            .map_err(|source| Error::Io { path: path.to_owned(), source })?;
        let raw: Raw = toml::from_str(&text).map_err(|error: toml::de::Error| {
            let line = line(&text, &error.span().unwrap_or(0..0));
            Error::Manifest { path: path.to_owned(), line, problem: advised(error.message()) }
        })?;
        let file = Self { path: path.to_owned(), text, raw };
        match file.raw.format.get_ref() {
            2 => Ok(file),
            other => {
                Err(file
                    .wrong(&file.raw.format.span(), format!("format = {other}: this is read as format = 2")))
            }
        }
    }

    /// Line of a span, from 1.
    pub(super) fn line(&self, span: &Range<usize>) -> usize {
        line(&self.text, span)
    }

    /// An error at a place of the file.
    pub(super) fn wrong(&self, span: &Range<usize>, problem: impl Into<String>) -> Error {
        Error::Manifest { path: self.path.clone(), line: self.line(span), problem: problem.into() }
    }

    /// Line of a key of `[set]`, which keeps none of its own.
    pub(super) fn line_of_set(&self, name: &str) -> usize {
        let bare = name.rsplit('.').next().unwrap_or(name);
        let inside =
            self.text.lines().enumerate().skip_while(|(_, line)| !line.trim_start().starts_with("[set"));
        let mut rest = inside.filter(|(_, line)| {
            let key = line.split('=').next().unwrap_or("").trim().trim_matches(['"', '\'']);
            key == name || key == bare
        });
        rest.next().map_or(1, |(number, _)| number + 1)
    }
}

fn line(text: &str, span: &Range<usize>) -> usize {
    let before = &text.as_bytes()[..span.start.min(text.len())];
    1 + before.iter().filter(|byte| **byte == b'\n').count()
}

/// The reader's message, with the nearest key where one is unknown: ``unknown field `colum`, expected one of `a`, `b```.
fn advised(message: &str) -> String {
    let message = message.replace('\n', " ");
    // the only one is `range`
    if message.contains("a tuple of size 2") {
        return "range: two numbers are wanted, the smallest value and the largest: [0.0, 1.0]".into();
    }
    if !message.starts_with("unknown field") {
        return message;
    }
    let mut quoted = message.split('`').skip(1).step_by(2);
    let Some(wrong) = quoted.next() else { return message };
    format!("there is no key `{wrong}` here: {}", nearest(wrong, quoted))
}
