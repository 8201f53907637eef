//! When the rows of a log were written: which column is its clock, and in what it counts.

use super::Time;
use super::heads::Header;
use super::policy::IMPORT;
use super::sheet::Sheet;
use crate::error::Error;
use crate::observe::{EPOCH, SINCE_1970, measure, units_to_seconds};
use crate::statistics::median::usual_step;
use orchestrator::fmu::Description;

/// What a column of time is called.
const TIME: &str = "time";
pub(super) const TIME_NAMES: [&str; 8] =
    ["time", "t", "timestamp", "stamp", "zeit", "elapsed", "clock", "times"];

/// What a column is called that counts rows.
const COUNTS: [&str; 14] = [
    "", "#", "index", "idx", "row", "rows", "sample", "samples", "n", "no", "nr", "number", "count",
    "counter",
];

impl Sheet {
    /// With a column of time, for rows that were written at a rate.
    pub(super) fn timed(&mut self, rate: f64, start: f64) -> Result<(), Error> {
        let is_time = |column: &&Header| column.text.eq_ignore_ascii_case(TIME);
        if let Some(column) = self.columns.iter().find(is_time) {
            let problem = format!("there is a column {:?}: without --rate its times are taken", column.text);
            return Err(Error::Manifest { path: self.path.clone(), line: self.lines.0, problem });
        }
        self.columns.insert(0, Header { text: TIME.into(), name: TIME.into(), unit: Some("s".into()) });
        for (count, row) in self.rows.iter_mut().enumerate() {
            row.insert(0, start + count as f64 / rate);
        }
        Ok(())
    }

    /// The column of time, with its unit and why it is thought to be that.
    pub(super) fn time_column(&self, description: &Description) -> Result<(Time, String), Error> {
        let rises = |place: &usize| {
            let rising = self.rows.windows(2).filter(|pair| pair[1][*place] > pair[0][*place]).count();
            rising as f64 > 0.9 * (self.rows.len() - 1) as f64
        };
        let places = || (0..self.columns.len()).filter(rises);
        let called = |place: &usize| TIME_NAMES.contains(&self.columns[*place].name.to_lowercase().as_str());
        let of_time = |place: &usize| {
            self.columns[*place].unit.as_deref().is_some_and(|unit| measure::seconds(unit).is_ok())
        };
        let clock = || self.clock.as_ref().and_then(|text| self.place(text)).filter(rises);
        let found = places().find(called).map(|place| (place, "by its name"));
        let found = found.or_else(|| clock().map(|place| (place, "by what it holds")));
        let found = found.or_else(|| places().find(of_time).map(|place| (place, "by its unit")));
        let first = || places().find(|place| !self.counts_rows(*place));
        let Some((place, why)) =
            found.or_else(|| first().map(|place| (place, "the first column that rises from row to row")))
        else {
            return Err(self.no_time());
        };
        let head = &self.columns[place];
        let (unit, reason) = match head.unit.as_deref().filter(|unit| measure::seconds(unit).is_ok()) {
            Some(unit) if self.clock.as_ref() == Some(&head.text) => {
                (unit.to_owned(), "its dates and times are read as seconds since the first row".to_owned())
            }
            Some(unit) => (unit.to_owned(), "unit from the header".to_owned()),
            None => self.time_unit(place, description),
        };
        let seconds = measure::seconds(&unit).unwrap_or(1.0);
        let told = format!("time is {:?}, {why}; {reason}", head.text);
        Ok((Time { place, name: head.text.clone(), unit, seconds }, told))
    }

    /// Whether a column counts rows, by its name and its numbers: 0, 1, 2, ... are no seconds.
    fn counts_rows(&self, place: usize) -> bool {
        let Header { name, unit, .. } = &self.columns[place];
        let is_next = |pair: &[Vec<f64>]| pair[1][place] - pair[0][place] == 1.0;
        let is_called = COUNTS.contains(&name.to_lowercase().as_str());
        is_called && unit.is_none() && self.rows.windows(2).all(is_next)
    }

    /// No column can be the time.
    fn no_time(&self) -> Error {
        let counts = (0..self.columns.len()).find(|place| self.counts_rows(*place));
        let wanted = match counts.map(|place| &self.columns[place].text) {
            Some(text) => format!(
                "column {text:?} counts rows and is no clock, and no other column rises from row to row"
            ),
            None => "no column rises from row to row".into(),
        };
        let wanted =
            format!("{wanted}: wanted is one with the time as a number, or --rate HZ for rows at a rate");
        let problem = [wanted].into_iter().chain(self.told.clone()).collect::<Vec<_>>().join("; ");
        Error::Manifest { path: self.path.clone(), line: self.lines.0, problem }
    }

    /// A unit of time by size: what makes rows as far apart as the unit's own step suggests.
    fn time_unit(&self, place: usize, description: &Description) -> (String, String) {
        let gap = self.usual_gap(place);
        let last = self.rows.last().map_or(0.0, |row| row[place]);
        for (unit, seconds) in units_to_seconds() {
            if (EPOCH..SINCE_1970.end).contains(&(last * seconds)) {
                return (unit.into(), format!("taken as {unit} since 1970, by its size"));
            }
        }
        if self.columns[place].name == TIME {
            return ("s".into(), "taken as s, as everywhere where a column is called time".into());
        }
        let own = description.default_experiment.step_size.filter(|step| *step > 0.0);
        let whole = self.rows.iter().all(|row| row[place].fract() == 0.0);
        match own {
            Some(own) if whole && gap / own > IMPORT.rows_apart && gap / own < IMPORT.rows_too_far => {
                ("ms".into(), format!("rows are {gap} apart, the unit's own step is {own} s: taken as ms"))
            }
            None if whole && (5.0..1e3).contains(&gap) => {
                ("ms".into(), format!("whole numbers {gap} apart: taken as ms, look at this"))
            }
            _ => ("s".into(), format!("rows are {gap:.6} apart: taken as s")),
        }
    }

    /// The median distance of rows in the log's own unit.
    pub(super) fn usual_gap(&self, place: usize) -> f64 {
        usual_step(&self.column(place)).unwrap_or(0.0)
    }

    /// Tells where rows are missing, and how uneven they are.
    pub(super) fn gaps(&self, time: &Time, notices: &mut Vec<String>) -> Result<(), Error> {
        let Some(place) = self.place(&time.name) else {
            let problem = format!("there is no column {:?} of time", time.name);
            return Err(Error::Manifest { path: self.path.clone(), line: self.lines.0, problem });
        };
        let usual = self.usual_gap(place);
        let far = self.rows.windows(2).filter(|pair| pair[1][place] - pair[0][place] > IMPORT.gap * usual);
        let far: Vec<(f64, f64)> = far.map(|pair| (pair[0][place], pair[1][place])).collect();
        if let Some((from, to)) = far.first() {
            notices.push(format!(
                "{}: {} gap(s) in time, the first from {from} to {to} {}; nothing is filled in, rows are used at their own times",
                self.path.display(),
                far.len(),
                time.unit
            ));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::heads::header;
    use super::*;

    fn sheet(heads: &[&str], rows: &[&[f64]]) -> Sheet {
        Sheet {
            path: "log.csv".into(),
            columns: heads.iter().map(|text| header(text)).collect(),
            rows: rows.iter().map(|row| row.to_vec()).collect(),
            lines: (1, vec![]),
            dialect: None,
            clock: None,
            told: vec![],
        }
    }

    #[test]
    fn value_a_column_that_counts_rows_is_no_clock() {
        let text = r#"<fmiModelDescription fmiVersion="2.0" modelName="m" guid="g"><CoSimulation modelIdentifier="m"/>
            <ModelVariables/><ModelStructure/></fmiModelDescription>"#;
        let description = Description::parse(text).expect("a description");
        let rows: [&[f64]; 4] = [&[0.0, 0.5, 2.0], &[1.0, 0.6, 1.0], &[2.0, 0.7, 3.0], &[3.0, 0.8, 0.0]];
        let time = |heads: &[&str], rows: &[&[f64]]| {
            sheet(heads, rows)
                .time_column(&description)
                .map(|(time, _)| time.name)
                .map_err(|error| error.to_string())
        };
        for name in ["index", "Row", "sample", "n", "#", ""] {
            assert_eq!(time(&[name, "when", "x"], &rows), Ok("when".into()), "{name}");
            let told = time(&[name, "x"], &rows.map(|row| [row[0], row[2]]).each_ref().map(|row| &row[..]))
                .unwrap_err();
            assert!(told.contains("counts rows and is no clock") && told.contains("--rate HZ"), "{told}");
        }
        assert_eq!(time(&["t", "when", "x"], &rows), Ok("t".into()));
        assert_eq!(time(&["n [s]", "when", "x"], &rows), Ok("n [s]".into()));
    }
}
