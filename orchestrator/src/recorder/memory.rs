//! Results in memory, for studies that look at them at once.

use super::{Cell, Column, Recorder, Row};
use crate::error::Error;
use crate::suggest::nearest;

/// Keeps every row. A recorder can be used for one run after the other; each begins empty.
#[derive(Debug, Clone, Default)]
pub struct MemoryRecorder {
    columns: Vec<Column>,
    times: Vec<f64>,
    /// One after the other, column by column; texts are NaN here.
    numbers: Vec<Vec<f64>>,
    /// As `numbers`, empty where the column is no text.
    texts: Vec<Vec<String>>,
}

impl MemoryRecorder {
    /// Empty.
    pub fn new() -> Self {
        Self::default()
    }

    /// The columns, without the time.
    pub fn columns(&self) -> &[Column] {
        &self.columns
    }

    /// Simulated times in s.
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// The values of `unit.variable`; Integers as numbers, Booleans as 0 and 1.
    ///
    /// # Errors
    /// If it was not recorded.
    pub fn series(&self, name: &str) -> Result<&[f64], Error> {
        self.place(name).map(|at| self.numbers[at].as_slice())
    }

    /// The values of a String variable.
    ///
    /// # Errors
    /// If it was not recorded.
    pub fn texts(&self, name: &str) -> Result<&[String], Error> {
        self.place(name).map(|at| self.texts[at].as_slice())
    }

    fn place(&self, name: &str) -> Result<usize, Error> {
        self.columns.iter().position(|column| column.name == name).ok_or_else(|| Error::Name {
            what: "recorded variable",
            name: name.into(),
            expected: nearest(name, self.columns.iter().map(|column| column.name.as_str())),
        })
    }
}

impl Recorder for MemoryRecorder {
    fn begin(&mut self, columns: &[Column]) -> Result<(), Error> {
        if self.columns != columns {
            self.columns = columns.to_vec();
            self.numbers = vec![Vec::new(); columns.len()];
            self.texts = vec![Vec::new(); columns.len()];
        }
        // The memory is kept for the next run.
        self.times.clear();
        self.numbers.iter_mut().for_each(Vec::clear);
        self.texts.iter_mut().for_each(Vec::clear);
        Ok(())
    }

    fn row(&mut self, time: f64, row: Row<'_>) -> Result<(), Error> {
        self.times.push(time);
        for (at, cell) in row.cells().enumerate() {
            self.numbers[at].push(match cell {
                Cell::Real(value) => value,
                Cell::Integer(value) => f64::from(value),
                Cell::Boolean(value) => f64::from(u8::from(value)),
                Cell::String(text) => {
                    self.texts[at].push(text.to_owned());
                    f64::NAN
                }
            });
        }
        Ok(())
    }
}
