//! What a study asks for of each run: a number, as a column of the data set.

use report::tally::Reduce;

/// A column of the data set with a number of each run.
#[derive(Debug, Clone, PartialEq)]
pub struct Scalar {
    /// Its name.
    pub name: String,
    /// `unit.variable`
    pub signal: String,
    /// What is taken off it.
    pub minus: Option<String>,
    /// What is made of the rows.
    pub reduce: Reduce,
    /// Where it was written.
    pub(crate) place: String,
}
