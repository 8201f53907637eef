//! The data set for good. It is written beside and read there as a diagnosis reads it; only then it stands where it belongs. So an import
//! that fails leaves nothing, and its error names a log of the user's and not a file of ours.

use super::sheet::Sheet;
use super::slow::Pace;
use super::write::{self, Found};
use super::{Import, Match, instance};
use crate::check::{Runs, along_lines, may_be_lines};
use crate::error::Error;
use crate::general::likelier_lines;
use crate::observe::{self, Hold, Problem};
use orchestrator::Fmu;
use orchestrator::fmu::Bench;
use std::path::Path;
use std::time::Instant;

/// Writes the data set and gives a line for each guess, and what a diagnosis will note of it.
pub(super) fn settle(
    asked: &Import<'_>,
    out: &Path,
    unit: &Fmu,
    found: &Found<'_>,
    pace: Option<&Pace>,
) -> Result<(Vec<String>, Vec<String>), Error> {
    let draft = Bench::new().map_err(|source| Error::Io { path: std::env::temp_dir(), source })?;
    write::folder(draft.path(), asked.fmu, unit, found)?;
    let isolation = asked.isolated.then_some(asked.limits);
    let problem = observe::load(draft.path(), asked.units, isolation)
        .map_err(|error| of_logs(error, draft.path(), found.sheets))?;
    let matches =
        pace.map_or_else(|| found.matches.to_vec(), |pace| held(&problem, unit, found.matches, pace));
    let found = &Found { matches: &matches, ..*found };
    let is_new = !out.exists();
    let guesses = write::folder(out, asked.fmu, unit, found).inspect_err(|_| {
        if is_new {
            // what is left is told by the error itself
            let _ = std::fs::remove_dir_all(out);
        }
    })?;
    Ok((guesses, problem.notices.iter().map(ToString::to_string).collect()))
}

/// Why an input runs along lines, or is held.
const FOLLOWS: &str =
    "along lines between rows: it runs smoothly, and held from row to row the model follows the logs worse";
const LINES: &str = "along lines between rows: it runs smoothly, and held from row to row the logs are less likely, whatever the model lacks";
const HELD: &str = "held from row to row: it runs smoothly, and along lines the logs are less likely, whatever the model lacks";
const LATE: &str = "held from row to row, and perhaps logged a row late: it runs smoothly, and with this column one row earlier the logs are followed better \
                    than along lines. Move the column up by 1 row against the others if it was written after what it did";
const OPEN: &str =
    "held from row to row; it runs smoothly: write hold = \"linear\" if it did not jump at each row";

/// The matches with how inputs run between rows, where the logs and the model tell. What is guessed wrong, and what they don't tell, a diagnosis
/// finds beside what the model lacks.
fn held(problem: &Problem, unit: &Fmu, matches: &[Match], pace: &Pace) -> Vec<Match> {
    let problem = Problem { deadline: Some(Instant::now() + pace.patience()), ..problem.clone() };
    let told: Vec<(String, Runs)> = along_lines(&problem.as_it_is())
        .into_iter()
        .map(|smooth| (problem.channels[smooth.place].name.clone(), smooth.runs))
        .collect();
    let smooth = may_be_lines(&problem);
    let searched = Problem { deadline: Some(Instant::now() + Pace::patience_of_search()), ..problem };
    let likelier = if told.is_empty() { likelier_lines(&searched) } else { None };
    let mut matches = matches.to_vec();
    for matched in &mut matches {
        let name = format!("{}.{}", instance(unit), unit.description().variables[matched.variable].name);
        let own = told.iter().find(|(known, _)| *known == name).map(|(_, runs)| *runs);
        let (hold, why) = match (own, smooth.contains(&name), likelier) {
            (Some(Runs::Lines), ..) => (Some(Hold::Linear), FOLLOWS),
            (_, true, Some(true)) => (Some(Hold::Linear), LINES),
            (_, true, Some(false)) => (Some(Hold::Zero), HELD),
            (Some(Runs::Late), ..) => (Some(Hold::Zero), LATE),
            (_, true, None) => (None, OPEN),
            _ => continue,
        };
        matched.hold = hold;
        matched.evidence.push(why.into());
    }
    matches
}

/// An error of a data set in a temporary folder, as one of the logs that it was made of.
fn of_logs(error: Error, folder: &Path, sheets: &[Sheet]) -> Error {
    let runs: Vec<_> = (sheets.iter().enumerate()).map(|(at, sheet)| (write::run(at), sheet)).collect();
    let in_logs = |text: &str| {
        // marks first: a log of the user's may be called like a run of ours
        let mark = |at: usize| format!("\0{at}\0");
        let marked = runs.iter().enumerate().fold(text.to_owned(), |text, (at, (run, _))| {
            text.replace(&folder.join(run).display().to_string(), &mark(at)).replace(run, &mark(at))
        });
        let named = runs.iter().enumerate().fold(marked, |text, (at, (_, sheet))| {
            text.replace(&mark(at), &sheet.path.display().to_string())
        });
        named.replace(&folder.display().to_string(), "the data set")
    };
    match error {
        Error::Manifest { path, line, problem } => {
            let problem = in_logs(&problem);
            match runs.iter().find(|(run, _)| folder.join(run) == path) {
                Some((_, sheet)) => {
                    Error::Manifest { path: sheet.path.clone(), line: sheet.line_of(line), problem }
                }
                None => Error::Nominal(format!("no data set can be made of these logs: {problem}")),
            }
        }
        Error::NothingUsable { mut notices, .. } => {
            for notice in &mut notices {
                if let Some((_, sheet)) = runs.iter().find(|(run, _)| *run == notice.file) {
                    (notice.file, notice.line) =
                        (sheet.path.display().to_string(), sheet.line_of(notice.line));
                }
            }
            let path = sheets.first().map(|sheet| sheet.path.clone()).unwrap_or_default();
            Error::NothingUsable { path, notices }
        }
        Error::Nominal(problem) => Error::Nominal(in_logs(&problem)),
        Error::Model(problem) => Error::Model(in_logs(&problem)),
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::import::heads::header;

    #[test]
    fn value_an_error_names_the_users_logs_whatever_they_are_called() {
        let sheet = |path: &str| Sheet {
            path: path.into(),
            columns: vec![header("time")],
            rows: vec![],
            lines: (1, vec![]),
            dialect: None,
            clock: None,
            told: vec![],
        };
        let sheets = [sheet("rig/run-02.csv"), sheet("rig/b.csv")];
        let told =
            |problem: &str| of_logs(Error::Nominal(problem.into()), Path::new("/tmp/d"), &sheets).to_string();
        assert!(
            told("a of run-01.csv, b of /tmp/d/run-02.csv").ends_with("a of rig/run-02.csv, b of rig/b.csv")
        );
        assert!(told("all of /tmp/d are bad").ends_with("all of the data set are bad"));
    }
}
