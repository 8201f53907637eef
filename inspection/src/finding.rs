//! What a rule found, and how a rule says it.

use serde::{Deserialize, Serialize};
use std::fmt;

/// How bad a finding is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// The unit breaks the standard, or does not do what it says of itself.
    Error,
    /// Some masters will stumble, or results may differ from what is meant.
    Warning,
    /// Worth knowing.
    Note,
}

impl fmt::Display for Severity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Error => "error",
            Self::Warning => "warning",
            Self::Note => "note",
        })
    }
}

/// One finding.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Finding {
    /// Name of the rule; `docs/check.md` has a section of that name.
    pub rule: String,
    /// How bad it is.
    pub severity: Severity,
    /// The variable that it is about, if it is about one.
    pub variable: Option<String>,
    /// What was found and what would be right.
    pub text: String,
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { rule, severity, variable, text } = self;
        write!(f, "{severity}[{rule}] ")?;
        match variable {
            Some(variable) => write!(f, "{variable}: {text}"),
            None => f.write_str(text),
        }
    }
}

/// Collects what one rule finds.
#[derive(Debug)]
pub(crate) struct Found {
    rule: &'static str,
    pub(crate) findings: Vec<Finding>,
}

impl Found {
    pub(crate) fn new(rule: &'static str) -> Self {
        Self { rule, findings: Vec::new() }
    }

    pub(crate) fn say(&mut self, severity: Severity, variable: Option<&str>, text: impl Into<String>) {
        let (rule, variable) = (self.rule.to_owned(), variable.map(str::to_owned));
        let finding = Finding { rule, severity, variable, text: text.into() };
        // Said of both kinds of a unit, it is still one finding.
        if self.findings.last() != Some(&finding) {
            self.findings.push(finding);
        }
    }

    /// An error about the unit as a whole.
    pub(crate) fn error(&mut self, text: impl Into<String>) {
        self.say(Severity::Error, None, text);
    }

    /// A warning about the unit as a whole.
    pub(crate) fn warning(&mut self, text: impl Into<String>) {
        self.say(Severity::Warning, None, text);
    }

    /// A note about the unit as a whole.
    pub(crate) fn note(&mut self, text: impl Into<String>) {
        self.say(Severity::Note, None, text);
    }

    /// An error at a line of the description.
    pub(crate) fn error_at(&mut self, line: usize, text: impl fmt::Display) {
        self.say(Severity::Error, None, at(line, text));
    }

    /// A warning at a line of the description.
    pub(crate) fn warning_at(&mut self, line: usize, text: impl fmt::Display) {
        self.say(Severity::Warning, None, at(line, text));
    }
}

/// A text with its place in the description.
pub(crate) fn at(line: usize, text: impl fmt::Display) -> String {
    format!("modelDescription.xml:{line}: {text}")
}
