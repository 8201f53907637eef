//! Where results go. A new one is a file with an implementation of [`Recorder`].

mod csv;
#[cfg(unix)]
mod lasting;
mod memory;

pub use csv::CsvRecorder;
pub use memory::MemoryRecorder;

use crate::error::Error;
use crate::text::Text;
use crate::value::{Kind, Value};

/// A recorded variable.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// `unit.variable`
    pub name: String,
    /// Type.
    pub kind: Kind,
    /// Physical unit, if the description names one.
    pub unit: Option<String>,
}

/// Where a column's value lies among the values of the system.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Slot {
    Real(u32),
    Integer(u32),
    Boolean(u32),
    String(u32),
}

/// The values at one communication point, in place: nothing is copied to record them.
#[derive(Clone, Copy)]
pub struct Row<'a> {
    pub(crate) slots: &'a [Slot],
    pub(crate) reals: &'a [f64],
    pub(crate) integers: &'a [i32],
    pub(crate) strings: &'a [Text],
}

/// One value of a row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Cell<'a> {
    /// `fmi2Real`
    Real(f64),
    /// `fmi2Integer`
    Integer(i32),
    /// `fmi2Boolean`
    Boolean(bool),
    /// `fmi2String`
    String(&'a str),
}

impl<'a> Row<'a> {
    /// The values in the order of the columns.
    #[inline]
    pub fn cells(self) -> impl ExactSizeIterator<Item = Cell<'a>> {
        self.slots.iter().map(move |slot| match *slot {
            Slot::Real(at) => Cell::Real(self.reals[at as usize]),
            Slot::Integer(at) => Cell::Integer(self.integers[at as usize]),
            Slot::Boolean(at) => Cell::Boolean(self.integers[at as usize] != 0),
            Slot::String(at) => Cell::String(self.strings[at as usize].as_str()),
        })
    }
}

impl From<Cell<'_>> for Value {
    fn from(cell: Cell<'_>) -> Self {
        match cell {
            Cell::Real(value) => Self::Real(value),
            Cell::Integer(value) => Self::Integer(value),
            Cell::Boolean(value) => Self::Boolean(value),
            Cell::String(value) => Self::String(value.to_owned()),
        }
    }
}

/// How far results were written.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
pub struct Position {
    /// Bytes of the file.
    pub(crate) bytes: u64,
    /// Simulated time in s at which rows are handed over next.
    pub(crate) next_second: f64,
}

/// Rows that wait to be written: a function that a signal handler may call, and its argument.
#[derive(Clone, Copy)]
pub struct Waiting {
    pub(crate) write: unsafe fn(*const ()),
    pub(crate) recorder: *const (),
}

/// Takes results as they come: one row per communication point of any unit, the start included.
pub trait Recorder {
    /// Before the first row.
    fn begin(&mut self, columns: &[Column]) -> Result<(), Error>;

    /// Instead, where a run goes on from a checkpoint that is its own.
    fn go_on(&mut self) -> Result<(), Error> {
        Ok(())
    }

    /// Whether rows are wanted at all.
    fn records(&self) -> bool {
        true
    }

    /// The values at a simulated time in s.
    fn row(&mut self, time: f64, row: Row<'_>) -> Result<(), Error>;

    /// Has everything written for good, and tells how far it came.
    fn position(&mut self) -> Result<Position, Error> {
        Ok(Position::default())
    }

    /// What to do with rows that wait, should a unit end the process.
    #[doc(hidden)]
    fn rescue(&self) -> Option<Waiting> {
        None
    }

    /// After the last row, also when the run ended early.
    fn end(&mut self) -> Result<(), Error> {
        Ok(())
    }
}

/// Records nothing.
#[derive(Debug, Clone, Copy, Default)]
pub struct NoRecorder;

impl Recorder for NoRecorder {
    fn begin(&mut self, _: &[Column]) -> Result<(), Error> {
        Ok(())
    }

    fn records(&self) -> bool {
        false
    }

    fn row(&mut self, _: f64, _: Row<'_>) -> Result<(), Error> {
        Ok(())
    }
}

/// Two recorders that get the same rows. The first one says where it is.
pub struct Twice<'a>(pub &'a mut dyn Recorder, pub &'a mut dyn Recorder);

impl Recorder for Twice<'_> {
    fn begin(&mut self, columns: &[Column]) -> Result<(), Error> {
        self.0.begin(columns)?;
        self.1.begin(columns)
    }

    fn go_on(&mut self) -> Result<(), Error> {
        self.0.go_on()?;
        self.1.go_on()
    }

    fn records(&self) -> bool {
        self.0.records() || self.1.records()
    }

    fn row(&mut self, time: f64, row: Row<'_>) -> Result<(), Error> {
        self.0.row(time, row)?;
        self.1.row(time, row)
    }

    fn position(&mut self) -> Result<Position, Error> {
        self.0.position()
    }

    fn rescue(&self) -> Option<Waiting> {
        self.0.rescue()
    }

    fn end(&mut self) -> Result<(), Error> {
        let first = self.0.end();
        self.1.end().and(first)
    }
}
