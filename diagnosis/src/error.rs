//! What can stop a diagnosis. Everything milder becomes a [`Notice`] and the diagnosis goes on with the rest.

use crate::statistics::levels::SEVERAL;
use std::path::PathBuf;

/// Why there is no diagnosis.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A file or folder can't be read or written.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// `dataset.toml` or a log of it says something that can't be read, or what is to be recorded isn't there.
    #[error("{}:{line}: {problem}", path.display())]
    Manifest {
        /// The file.
        path: PathBuf,
        /// Line, counted from 1.
        line: usize,
        /// What is wrong and what would be right.
        problem: String,
    },
    /// The logs count otherwise than the model does, beyond doubt.
    #[error("{}: {finding}", path.display())]
    Implausible {
        /// The data set.
        path: PathBuf,
        /// What was found, and the line that is missing.
        finding: Box<Finding>,
    },
    /// An option that can't be.
    #[error("{option} {given}: {problem}")]
    Option {
        /// As the command line has it.
        option: &'static str,
        /// As typed.
        given: String,
        /// What is wrong and what would be right.
        problem: String,
    },
    /// No run holds anything that can be compared with the model.
    #[error("{}: no usable run:{}", path.display(), listed(notices))]
    NothingUsable {
        /// The data set.
        path: PathBuf,
        /// Why each file was excluded.
        notices: Vec<Notice>,
    },
    /// An earlier diagnosis can't be read.
    #[error("{}: {problem}; wanted is what `acroscope diagnose` wrote", path.display())]
    Earlier {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        problem: String,
    },
    /// A unit of the nominal model failed, or something of ours did.
    #[error("nominal model: {0}")]
    Model(String),
    /// The model is so slow that the budget was over several times before an answer stood.
    #[error(
        "no answer within {SEVERAL} times the budget, or a minute: the model takes too long. Give it more time (--budget), strike out candidates with \
         which its solver slows down (settings of the solver above all), or give it fewer rows"
    )]
    TooSlow,
    /// The nominal model can't be loaded as the user gave it.
    #[error("nominal model: {0}")]
    Nominal(String),
}

impl Error {
    /// The user's input is wrong, as opposed to a failure of ours (exit status 2 against 1).
    pub fn is_input(&self) -> bool {
        !matches!(self, Error::Model(_))
    }
}

/// Something in logs that can't be.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// File, relative to the data set.
    pub file: String,
    /// Line, counted from 1; 0 when the file as a whole is meant.
    pub line: usize,
    /// One sentence: what was found.
    pub sentence: String,
    /// What `[log]` of `dataset.toml` needs; empty where no line of it would help.
    pub add: String,
}

impl Finding {
    /// The same where `[log]` says something of that already: the logs are read so, and to add the line would change nothing.
    #[must_use]
    pub fn beside(self, given: &[(&str, String)]) -> Self {
        let key = |line: &str| line.split(" = ").next().map(str::to_owned);
        let keys: Vec<String> = self.add.lines().filter_map(key).collect();
        let Some((key, value)) = given.iter().find(|(key, _)| keys.iter().any(|own| own == key)) else {
            return self;
        };
        let sentence = format!(
            "{}. But `{key} = {value}` stands under [log] already, and the logs are read so: change that line or take it out",
            self.sentence
        );
        Self { sentence, add: String::new(), ..self }
    }
}

impl std::fmt::Display for Finding {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let place = if self.line == 0 { self.file.clone() } else { format!("{}:{}", self.file, self.line) };
        write!(f, "{place}: {}", self.sentence)?;
        if self.add.is_empty() { Ok(()) } else { write!(f, ". Add to dataset.toml:\n[log]\n{}", self.add) }
    }
}

/// Something in the data that was excluded or corrected, with its place.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Notice {
    /// File, relative to the data set.
    pub file: String,
    /// Line, counted from 1; 0 when the file as a whole is meant.
    pub line: usize,
    /// What was found and what was done about it.
    pub message: String,
}

impl std::fmt::Display for Notice {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if self.line == 0 {
            write!(f, "{}: {}", self.file, self.message)
        } else {
            write!(f, "{}:{}: {}", self.file, self.line, self.message)
        }
    }
}

fn listed(notices: &[Notice]) -> String {
    notices.iter().map(|notice| format!("\n  {notice}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_line_that_stands_there_is_not_advised_again() {
        let finding = Finding {
            file: "run-01/plant.csv".into(),
            line: 0,
            sentence: "q1 turns".into(),
            add: "angles_sign = -1\nq2 = \"relative\"".into(),
        };
        let told =
            |key: &'static str| finding.clone().beside(&[("time", "\"s\"".into()), (key, "-1".into())]);
        assert_eq!(told("q1_sign"), finding);
        let told = told("angles_sign");
        assert!(told.add.is_empty() && told.sentence.contains("`angles_sign = -1` stands"), "{told}");
    }
}
