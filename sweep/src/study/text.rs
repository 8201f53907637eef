//! A study's text as a tree whose every key and value knows its line.

use crate::error::Error;
use orchestrator::{Place, Value, suggest::nearest};
use std::borrow::Cow;
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// What a study was written in: a file, or words of a command line, one a line.
#[derive(Debug, Clone)]
pub(crate) enum Origin {
    File(String),
    Words(Vec<String>),
}

/// A text and where it comes from.
pub(super) struct Text<'a> {
    pub(super) text: &'a str,
    pub(super) origin: &'a Origin,
}

/// A key's value and where it stands.
pub(super) type Entry<'a> = (Cow<'a, str>, &'a DeValue<'a>, Range<usize>);

impl Text<'_> {
    fn line(&self, at: usize) -> usize {
        1 + self.text.as_bytes()[..at.min(self.text.len())].iter().filter(|byte| **byte == b'\n').count()
    }

    /// Where something stands, in words.
    pub(super) fn place(&self, span: &Range<usize>) -> String {
        let line = self.line(span.start);
        match self.origin {
            Origin::File(name) => format!("{name}:{line}"),
            Origin::Words(words) => words.get(line - 1).cloned().unwrap_or_default(),
        }
    }

    /// The same for the orchestrator.
    pub(super) fn scenario_place(&self, span: &Range<usize>) -> Place {
        match self.origin {
            Origin::File(name) => Place::Line { file: name.as_str().into(), line: self.line(span.start) },
            Origin::Words(_) => Place::Override(self.place(span)),
        }
    }

    pub(super) fn wrong(
        &self,
        span: &Range<usize>,
        what: impl Into<String>,
        expected: impl Into<String>,
    ) -> Error {
        Error::Study { place: self.place(span), what: what.into(), expected: expected.into() }
    }

    /// The whole text as a table.
    pub(super) fn parse(&self) -> Result<Spanned<DeTable<'_>>, Error> {
        DeTable::parse(self.text).map_err(|error| {
            let span = error.span().unwrap_or(0..0);
            self.wrong(&span, "not a study", error.message().replace('\n', " "))
        })
    }

    /// An entry as it was typed.
    pub(super) fn shown(&self, span: &Range<usize>) -> String {
        self.text.get(span.clone()).unwrap_or_default().split_whitespace().collect::<Vec<_>>().join(" ")
    }
}

/// The entries of a table in the order of the text.
pub(super) fn entries<'a>(table: &'a DeTable<'a>) -> Vec<Entry<'a>> {
    let entry = |(key, value): (&'a Spanned<Cow<'a, str>>, &'a Spanned<DeValue<'a>>)| {
        let name = Cow::Borrowed(key.get_ref().as_ref());
        (key.span().start, (name, value.get_ref(), key.span().start..value.span().end))
    };
    let mut entries: Vec<(usize, Entry<'a>)> = table.iter().map(entry).collect();
    entries.sort_by_key(|(start, _)| *start);
    entries.into_iter().map(|(_, entry)| entry).collect()
}

/// The entries of a table that may have certain keys only.
pub(super) fn known<'a>(
    at: &Text<'_>,
    table: &'a DeTable<'a>,
    what: &str,
    keys: &[&str],
) -> Result<Vec<Entry<'a>>, Error> {
    let entries = entries(table);
    match entries.iter().find(|(key, ..)| !keys.contains(&key.as_ref())) {
        None => Ok(entries),
        Some((key, _, span)) => {
            Err(at.wrong(span, format!("{what} has no key {key:?}"), nearest(key, keys.iter().copied())))
        }
    }
}

/// A table, or an error.
pub(super) fn table<'a>(
    at: &Text<'_>,
    (_, value, span): &Entry<'a>,
    expected: &str,
) -> Result<&'a DeTable<'a>, Error> {
    value.as_table().ok_or_else(|| at.wrong(span, at.shown(span), expected))
}

/// A text, or an error.
pub(super) fn string(at: &Text<'_>, (_, value, span): &Entry<'_>, expected: &str) -> Result<String, Error> {
    let text = value.as_str().map(str::to_owned);
    text.ok_or_else(|| at.wrong(span, at.shown(span), expected))
}

/// The digits of a number as they were typed.
pub(super) fn digits(value: &DeValue<'_>) -> Option<String> {
    match value {
        DeValue::Integer(number) if number.radix() == 10 => Some(number.as_str().to_owned()),
        DeValue::Float(number) => Some(number.as_str().to_owned()),
        _ => None,
    }
}

/// A finite number, or an error.
pub(super) fn number(at: &Text<'_>, (_, value, span): &Entry<'_>) -> Result<f64, Error> {
    let number =
        digits(value).and_then(|digits| digits.parse::<f64>().ok()).filter(|number| number.is_finite());
    number.ok_or_else(|| at.wrong(span, at.shown(span), "a finite number"))
}

/// A whole number, 0 or more.
pub(super) fn whole(at: &Text<'_>, (_, value, span): &Entry<'_>) -> Result<u64, Error> {
    let number = digits(value).and_then(|digits| digits.parse().ok());
    number.ok_or_else(|| at.wrong(span, at.shown(span), "a whole number, 0 or more"))
}

/// A value for a parameter.
pub(super) fn value(at: &Text<'_>, (_, value, span): &Entry<'_>) -> Result<Value, Error> {
    let wrong = || at.wrong(span, at.shown(span), "a number, true, false or a text");
    match value {
        DeValue::Boolean(value) => Ok(Value::Boolean(*value)),
        DeValue::String(text) => Ok(Value::String(text.to_string())),
        _ => {
            let digits = digits(value).ok_or_else(wrong)?;
            if let Ok(number) = digits.parse() {
                return Ok(Value::Integer(number));
            }
            let number = digits.parse().ok().filter(|number: &f64| number.is_finite());
            number.map(Value::Real).ok_or_else(wrong)
        }
    }
}
