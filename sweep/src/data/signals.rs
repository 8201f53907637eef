//! `signals/part-*.parquet`: the kept rows of each case's run.

use super::Counts;
use super::file::{self, Data, PartFile, Stamp};
use crate::error::Error;
use crate::plan::Plan;
use crate::record::{Kept, Values};
use std::path::Path;

/// Rows of a group.
const GROUP: usize = 1 << 18;

/// A part of the signals, under way.
pub(crate) struct SignalFile {
    file: PartFile,
}

impl SignalFile {
    pub(crate) fn begin(path: &Path, stamp: &Stamp<'_>, plan: &Plan) -> Result<Self, Error> {
        let time = Data::Values(Values::Real(Vec::new()));
        let mut heads = vec![
            ("case".to_owned(), None, Data::Long(Vec::new())),
            ("time".to_owned(), Some("s".to_owned()), time),
        ];
        heads.extend(plan.signals.iter().map(file::head));
        Ok(Self { file: PartFile::begin(path, stamp, heads, GROUP)? })
    }

    pub(crate) fn add(&mut self, case: u64, kept: &mut Kept) -> Result<(), Error> {
        let rows = kept.times.len();
        let mut values = kept.columns.iter_mut();
        for (at, data) in self.file.columns.iter_mut().enumerate() {
            match data {
                Data::Long(cases) => cases.resize(cases.len() + rows, case as i64),
                Data::Values(Values::Real(times)) if at == 1 => times.extend_from_slice(&kept.times),
                Data::Values(column) => {
                    if let Some(values) = values.next() {
                        column.append(values);
                    }
                }
                Data::MaybeReal(..) | Data::MaybeText(..) => {}
            }
        }
        self.file.added(rows)
    }

    pub(crate) fn finish(self, counts: &Counts) -> Result<(), Error> {
        self.file.finish(counts)
    }
}
