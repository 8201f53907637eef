//! `cases/part-*.parquet`: a row for each case.

use super::Counts;
use super::file::{self, Data, PartFile, Stamp};
use crate::error::Error;
use crate::plan::Plan;
use crate::record::Values;
use crate::worker::CaseRow;
use orchestrator::Value;
use parquet::data_type::ByteArray;
use std::path::Path;

/// Rows of a group.
const GROUP: usize = 1 << 14;

/// A part of the cases, under way.
pub(crate) struct CaseFile {
    file: PartFile,
    counts: Counts,
    parameters: usize,
}

impl CaseFile {
    pub(crate) fn begin(path: &Path, stamp: &Stamp<'_>, plan: &Plan) -> Result<Self, Error> {
        let mut heads = vec![("case".to_owned(), None, Data::Long(Vec::new()))];
        heads.extend(plan.parameters.iter().map(file::head));
        let scalars = plan.scalars.iter().zip(&plan.scalar_units);
        heads.extend(scalars.map(|(scalar, unit)| {
            (scalar.name.clone(), unit.clone(), Data::MaybeReal(Vec::new(), Vec::new()))
        }));
        heads.push(file::text("status"));
        heads.push(("error".to_owned(), None, Data::MaybeText(Vec::new(), Vec::new())));
        let file = PartFile::begin(path, stamp, heads, GROUP)?;
        Ok(Self { file, counts: Counts::default(), parameters: plan.parameters.len() })
    }

    pub(crate) fn add(&mut self, row: &CaseRow) -> Result<(), Error> {
        let error = row.outcome.as_ref().err();
        self.counts.failed += u64::from(error.is_some());
        if error.is_none() && row.not_finite {
            self.counts.add_not_finite(row.case);
        }
        let scalars = row.outcome.as_deref().unwrap_or_default();
        let count = self.file.columns.len();
        for (at, data) in self.file.columns.iter_mut().enumerate() {
            match data {
                Data::Long(cases) => cases.push(row.case as i64),
                Data::MaybeReal(values, there) => {
                    let value = scalars.get(at - 1 - self.parameters).copied().flatten();
                    values.extend(value);
                    there.push(i16::from(value.is_some()));
                }
                Data::MaybeText(values, there) => {
                    values.extend(error.map(|error| ByteArray::from(error.as_str())));
                    there.push(i16::from(error.is_some()));
                }
                Data::Values(Values::Text(words)) if at == count - 2 => {
                    words.push(if error.is_some() { "failed" } else { "ok" }.to_owned());
                }
                Data::Values(values) => push(values, &row.parameters[at - 1]),
            }
        }
        self.file.added(1)
    }

    /// How many cases failed, and so on.
    pub(crate) fn counts(&self) -> Counts {
        self.counts
    }

    pub(crate) fn finish(self) -> Result<(), Error> {
        self.file.finish(&self.counts)
    }
}

fn push(values: &mut Values, value: &Value) {
    match (values, value) {
        (Values::Real(values), value) => values.push(value.as_f64().unwrap_or(f64::NAN)),
        (Values::Integer(values), Value::Integer(value)) => values.push(*value),
        (Values::Boolean(values), Value::Boolean(value)) => values.push(*value),
        (Values::Text(values), Value::String(value)) => values.push(value.clone()),
        (values, value) => debug_assert!(false, "{value} among {values:?}"),
    }
}
