//! A data set loaded: read, stopped where its logs count otherwise than the model does, and checked.

use crate::error::Error;
use crate::rigs::acrobot::dataset::{DataSet, Reading};
use crate::rigs::acrobot::plausibility::{self, Facts};
use std::path::Path;

impl DataSet {
    /// Reads and checks a folder.
    ///
    /// # Errors
    /// The manifest can't be read, the logs count otherwise than the model does, or no run is usable.
    pub fn load(path: &Path) -> Result<Self, Error> {
        let read = Reading::new(path)?;
        let facts = Facts { runs: &read.runs, nominal: read.nominal, gaps_stated: read.gaps_stated() };
        if let Some(finding) = plausibility::first(&facts) {
            let finding = Box::new(finding.beside(read.stated_lines()));
            return Err(Error::Implausible { path: path.to_owned(), finding });
        }
        read.checked()
    }
}
