//! From logs and a unit to a data set (`acroscope import`): columns are matched to variables by name and unit of
//! measurement, and tried against the model; every guess is written beside its evidence.
//!
//! - `text.rs`: a log's encoding, comments and separators
//! - `table.rs`: where its table begins and ends
//! - `cells.rs`: numbers and words for what is missing
//! - `timestamps.rs`: dates and times of day
//! - `joined.rs`: rows of one time
//! - `times.rs`: which column is the time
//! - `sheet.rs`: its columns, with names, units and numbers
//! - `heads.rs`: a column's name and unit
//! - `matching.rs`: which column is which variable
//! - `starts.rs`: which parameter is where a state starts
//! - `draft.rs`: signs by stretches of the logs, states that no variable shows
//! - `unshown.rs`: which parameters start such states
//! - `trial.rs`: runs the model and compares: signs, units, offsets
//! - `slow.rs`: a model that takes too long, and times in another unit
//! - `straight_line.rs`: the straight line between measured and simulated
//! - `idle_parameters.rs`: parameters that change nothing
//! - `write.rs`: the folder
//! - `settle.rs`: where it is written once it reads
//! - `policy.rs`: the numbers that decide, with their reasons

mod cells;
mod draft;
mod heads;
mod idle_parameters;
mod joined;
mod matching;
mod policy;
mod settle;
mod sheet;
mod slow;
mod starts;
mod straight_line;
mod table;
mod text;
mod times;
mod timestamps;
mod trial;
mod unshown;
mod write;

use crate::error::Error;
use crate::observe::{Affine, Hold};
use orchestrator::{Fmu, Isolation, UnitPath};
use sheet::Sheet;
use std::path::{Path, PathBuf};
use trial::Known;

/// What was made.
#[derive(Debug, Clone, PartialEq)]
pub struct Imported {
    /// A line for each guess, in the order of the file.
    pub guesses: Vec<String>,
    /// What a user should look at: columns without a variable, gaps, signs that were turned.
    pub notices: Vec<String>,
}

/// A column with the variable that it measures, as far as known.
#[derive(Debug, Clone, PartialEq)]
struct Match {
    /// Place of the variable in the description.
    variable: usize,
    /// The column's name in the logs.
    column: String,
    /// Unit of measurement, if the header or the model tells it.
    unit: Option<String>,
    /// Sign and offset, where they are not what the unit says.
    affine: Option<Affine>,
    /// Why this column, why this unit, what the model said.
    evidence: Vec<String>,
    /// An input.
    fed: bool,
    /// How an input runs between rows, where the logs tell.
    hold: Option<Hold>,
}

/// When the rows of logs without a column of time were written: from a time on, in s, at a rate, in Hz.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clock {
    /// Rows a second, above 0.
    pub rate: f64,
    /// Time of the first row, s.
    pub start: f64,
}

impl Clock {
    fn check(self) -> Result<(), Error> {
        let wrong = |option, given: f64, wanted: &str| {
            Err(Error::Option { option, given: given.to_string(), problem: format!("expected {wanted}") })
        };
        if !(self.rate > 0.0 && self.rate.is_finite() && self.rate.recip().is_finite()) {
            return wrong("--rate", self.rate, "rows a second, above 0");
        }
        if !self.start.is_finite() {
            return wrong("--start", self.start, "the time of the first row in s");
        }
        Ok(())
    }
}

/// What a data set is to be made of, and how.
#[derive(Debug, Clone, Copy)]
pub struct Import<'a> {
    /// One file a run, each once.
    pub logs: &'a [PathBuf],
    /// The unit that models what was measured.
    pub fmu: &'a Path,
    /// Where units lie.
    pub units: &'a UnitPath,
    /// For logs without a column of time.
    pub clock: Option<Clock>,
    /// Those of the first run of the unit, which is made in a process of its own where there can be one.
    pub limits: &'a Isolation,
    /// Every run of the unit is made in such a process.
    pub isolated: bool,
}

/// Makes a data set of logs and a unit in the folder `out`.
///
/// # Errors
/// A log or the unit can't be read, no column is an output of the unit, the unit can't be run, or the folder can't be written.
pub fn import(asked: &Import<'_>, out: &Path) -> Result<Imported, Error> {
    let Import { logs, fmu, units, clock, limits, isolated } = *asked;
    let isolation = isolated.then_some(limits);
    clock.map_or(Ok(()), Clock::check)?;
    let unit = units.open(fmu).map_err(crate::opened::model)?;
    let unit = isolation.map_or_else(|| unit.clone(), |isolation| unit.isolated(isolation.clone()));
    let sheets = read_sheets(logs, &unit, clock)?;
    let Some(first) = sheets.first() else {
        return Err(Error::Nominal("no log was given".into()));
    };
    let mut notices: Vec<String> = other_columns(first, &sheets[1..]).collect();
    let (time, told) = first.time_column(unit.description())?;
    let told = clock.map_or(told, |clock| format!("{} rows a second, as asked for", clock.rate));
    let mut matches = matching::match_columns(&unit, first, time.place, &mut notices)?;
    let longest = sheets.iter().max_by_key(|sheet| sheet.rows.len()).unwrap_or(first);
    let known = Known { fmu: &unit, units, sheet: longest, time: &time, starts: &[], signs: None, isolation };
    let pace = slow::Pace::of(longest, &time, unit.description());
    let too_slow = known.trial(&matches).rehearse(limits, &pace)?;
    let measured: Vec<usize> = matches.iter().map(|known| known.variable).collect();
    let (mut starts, maybe) = starts::find_starts(&unit, &measured, limits);
    let first = Known { starts: &starts, ..known };
    let candidates = write::parameters(&unit, &starts);
    let found = write::Found::new(&sheets, &first, &told, &matches, &candidates);
    let draft::Tried { too_long, signs, shown, unshown } = match too_slow {
        Some(told) => draft::Tried { too_long: Some(told), ..draft::Tried::default() },
        None => draft::try_draft(
            &draft::Draft { file: fmu, units, isolation, pace: &pace },
            &unit,
            &found,
            &maybe,
        ),
    };
    starts.extend(shown);
    let mut candidates = write::parameters(&unit, &starts);
    candidates.retain(|place| !unshown.contains(place));
    let known = Known { starts: &starts, signs: signs.as_ref(), ..known };
    let numbers = (&candidates[..], &unshown[..]);
    let tried = try_model(&known, too_long.as_deref(), &mut matches, numbers, &mut notices);
    for sheet in &sheets {
        sheet.gaps(&time, &mut notices)?;
    }
    let found = write::Found {
        unshown: &unshown,
        tried: Some(&tried),
        ..write::Found::new(&sheets, &known, &told, &matches, &candidates)
    };
    let (guesses, noted) = settle::settle(asked, out, &unit, &found, too_long.is_none().then_some(&pace))?;
    notices.extend(noted);
    Ok(Imported { guesses, notices })
}

/// Tries every match against the model, and which of the candidates change nothing; none of it where the times are another unit's, in which the
/// model follows nothing and takes a thousand times as long.
fn try_model(
    known: &Known<'_>,
    too_long: Option<&str>,
    matches: &mut [Match],
    (candidates, unshown): (&[usize], &[usize]),
    notices: &mut Vec<String>,
) -> idle_parameters::Found {
    if let Some(told) = too_long {
        notices.push(format!("{told}. Nothing else was tried against the model"));
        return idle_parameters::Found::default();
    }
    trial::against_model(known, unshown, matches, notices);
    idle_parameters::find_idle(&known.trial(matches), candidates, unshown)
}

/// The logs, with a column of time for those that a clock is given for. Columns that have a variable's name have it to the letter.
fn read_sheets(logs: &[PathBuf], unit: &Fmu, clock: Option<Clock>) -> Result<Vec<Sheet>, Error> {
    let mut sheets = Vec::new();
    for log in logs {
        let mut sheet = Sheet::read(log)?;
        if let Some(Clock { rate, start }) = clock {
            sheet.timed(rate, start)?;
        }
        let own = |text: &str| {
            let rest = text.strip_prefix(&instance(unit)).and_then(|rest| rest.strip_prefix('.'));
            rest.unwrap_or(text).to_owned()
        };
        let known = |text: &str| unit.description().place(&own(text)).is_some();
        let is_name = |text: &str| matching::is_measurable(unit.description(), &own(text));
        sheet.with_names(&known, &is_name);
        again(&sheets, &sheet).map_or(Ok(()), Err)?;
        sheets.push(sheet);
    }
    Ok(sheets)
}

/// What is wrong with a log that holds the same rows as one before.
fn again(known: &[Sheet], sheet: &Sheet) -> Option<Error> {
    let bits = |row: &Vec<f64>| row.iter().map(|cell| cell.to_bits()).collect::<Vec<_>>();
    let is_same = |other: &&Sheet| {
        other.names() == sheet.names() && other.rows.iter().map(bits).eq(sheet.rows.iter().map(bits))
    };
    let first = known.iter().find(is_same)?;
    let problem = format!(
        "the same rows as in {}: counted twice they would tell more than they do. Give one of both",
        first.path.display()
    );
    Some(Error::Manifest { path: sheet.path.clone(), line: sheet.lines.0, problem })
}

/// Which logs have other columns than the first.
fn other_columns<'a>(first: &'a Sheet, others: &'a [Sheet]) -> impl Iterator<Item = String> + 'a {
    others.iter().filter(|other| other.names() != first.names()).map(|other| {
        format!(
            "{} has other columns than {}; its columns are taken by the same names",
            other.path.display(),
            first.path.display()
        )
    })
}

/// Where the time stands, and in what.
#[derive(Debug, Clone, PartialEq)]
struct Time {
    place: usize,
    name: String,
    /// `s`, `ms`, ...
    unit: String,
    seconds: f64,
}

/// Name of the instance in the data set.
fn instance(fmu: &Fmu) -> String {
    orchestrator::scenario::name_of_file(fmu.path())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bad_data_a_log_that_is_given_twice_is_told_by_its_name() {
        let sheet = |path: &str, row: [f64; 2]| Sheet {
            path: path.into(),
            columns: ["t", "u"].map(heads::header).to_vec(),
            rows: vec![vec![0.0, f64::NAN], row.to_vec()],
            lines: (3, vec![4, 5]),
            dialect: None,
            clock: None,
            told: vec![],
        };
        let known = [sheet("a.csv", [1.0, 2.0])];
        let told = again(&known, &sheet("b.csv", [1.0, 2.0])).expect("the same").to_string();
        assert!(told.contains("b.csv:3: the same rows as in a.csv"), "{told}");
        assert!(again(&known, &sheet("b.csv", [1.0, 2.5])).is_none());
    }
}
