//! Rows of one time: where several loggers write to one file, each has a row of its own for what it measured.

use super::sheet::Sheet;
use super::times::TIME_NAMES;
use crate::observe::measure;

impl Sheet {
    /// Joins rows that follow each other at one time, each of which holds what the others don't.
    pub(super) fn join_rows(&mut self) {
        let Some(clock) = (0..self.columns.len()).find(|place| self.may_be_time(*place)) else { return };
        let before = self.rows.len();
        let (mut rows, mut lines): (Vec<Vec<f64>>, Vec<usize>) = (Vec::new(), Vec::new());
        for (row, line) in self.rows.drain(..).zip(&self.lines.1) {
            match rows.last_mut().filter(|last| completes(last, &row, clock)) {
                Some(last) => {
                    let missing = last.iter_mut().zip(&row).filter(|(value, _)| value.is_nan());
                    missing.for_each(|(value, own)| *value = *own);
                }
                None => {
                    rows.push(row);
                    lines.push(*line);
                }
            }
        }
        if rows.len() < before {
            let text = &self.columns[clock].text;
            let after = rows.len();
            self.told.push(format!(
                "rows with the same {text:?} hold different columns and are joined: {before} rows are {after}"
            ));
        }
        (self.rows, self.lines.1) = (rows, lines);
    }

    /// Whether a column is called time, or measured in a unit of it, and never falls.
    fn may_be_time(&self, place: usize) -> bool {
        let head = &self.columns[place];
        let is_called = TIME_NAMES.contains(&head.name.to_lowercase().as_str())
            || self.clock.as_ref() == Some(&head.text)
            || head.unit.as_deref().is_some_and(|unit| measure::seconds(unit).is_ok());
        is_called && self.rows.windows(2).all(|pair| pair[1][place] >= pair[0][place])
    }
}

/// Whether a row is of the same time as the one before, and holds something, and nothing that that one holds.
fn completes(last: &[f64], row: &[f64], clock: usize) -> bool {
    let others = || (0..row.len()).filter(|place| *place != clock);
    let own = |place: &usize| !row[*place].is_nan();
    row[clock] == last[clock]
        && others().any(|place| own(&place))
        && others().filter(own).all(|place| last[place].is_nan())
}

#[cfg(test)]
mod tests {
    use super::super::heads::header;
    use super::*;

    fn joined(rows: &[[f64; 3]]) -> (Vec<Vec<f64>>, Vec<usize>, Vec<String>) {
        let mut sheet = Sheet {
            path: "log.csv".into(),
            columns: ["time", "u", "x"].map(header).into(),
            rows: rows.iter().map(|row| row.to_vec()).collect(),
            lines: (1, (2..).take(rows.len()).collect()),
            dialect: None,
            clock: None,
            told: vec![],
        };
        sheet.join_rows();
        (sheet.rows, sheet.lines.1, sheet.told)
    }

    #[test]
    fn every_row_of_one_time_is_joined_that_holds_other_columns() {
        let none = f64::NAN;
        let (rows, lines, told) = joined(&[
            [0.0, 1.0, none],
            [0.0, none, 2.0],
            [0.1, none, 3.0],
            [0.1, 4.0, none],
            [0.2, 5.0, 6.0],
        ]);
        assert_eq!(rows, [[0.0, 1.0, 2.0], [0.1, 4.0, 3.0], [0.2, 5.0, 6.0]]);
        assert_eq!(lines, [2, 4, 6]);
        assert!(told[0].contains("5 rows are 3"), "{told:?}");
    }

    #[test]
    fn law_what_is_measured_twice_at_one_time_stays() {
        let none = f64::NAN;
        let twice = [[0.0, 1.0, 2.0], [0.0, none, 3.0], [0.1, 1.0, none], [0.1, none, none]];
        assert_eq!(joined(&twice).0.len(), 4);
        // what falls is no clock
        assert_eq!(joined(&[[0.1, 1.0, none], [0.0, 2.0, none], [0.0, none, 1.0]]).0.len(), 3);
        assert!(joined(&twice).2.is_empty());
    }
}
