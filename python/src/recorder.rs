//! Records a run in memory, each column in its own type, as Arrow keeps it.

use arrow_array::{ArrayRef, BooleanArray, Float64Array, Int32Array, RecordBatch, StringArray};
use arrow_schema::{ArrowError, DataType, Field, Schema};
use orchestrator::{Cell, Column, Error, Kind, Recorder, Row};
use std::collections::HashMap;
use std::sync::Arc;

/// A field of the table. Its unit is in the metadata, under `unit`.
pub fn field(name: &str, kind: DataType, unit: Option<String>) -> Field {
    let metadata = unit.map(|unit| ("unit".to_owned(), unit));
    Field::new(name, kind, false).with_metadata(HashMap::from_iter(metadata))
}

/// The values of one variable.
enum Values {
    Real(Vec<f64>),
    Integer(Vec<i32>),
    Boolean(Vec<bool>),
    Text(Vec<String>),
}

/// A table that grows by a row at each communication point.
#[derive(Default)]
pub struct Columns {
    columns: Vec<Column>,
    times: Vec<f64>,
    values: Vec<Values>,
}

impl Recorder for Columns {
    fn begin(&mut self, columns: &[Column]) -> Result<(), Error> {
        self.columns = columns.to_vec();
        self.times.clear();
        let empty = |column: &Column| match column.kind {
            Kind::Real => Values::Real(Vec::new()),
            Kind::Integer => Values::Integer(Vec::new()),
            Kind::Boolean => Values::Boolean(Vec::new()),
            Kind::String => Values::Text(Vec::new()),
        };
        self.values = columns.iter().map(empty).collect();
        Ok(())
    }

    fn row(&mut self, time: f64, row: Row<'_>) -> Result<(), Error> {
        self.times.push(time);
        for (values, cell) in self.values.iter_mut().zip(row.cells()) {
            match (values, cell) {
                (Values::Real(all), Cell::Real(value)) => all.push(value),
                (Values::Integer(all), Cell::Integer(value)) => all.push(value),
                (Values::Boolean(all), Cell::Boolean(value)) => all.push(value),
                (Values::Text(all), Cell::String(value)) => all.push(value.to_owned()),
                // A column's cells are of the column's kind.
                _ => unreachable!("a cell of another type than its column"),
            }
        }
        Ok(())
    }
}

impl Columns {
    /// The table, `time` first.
    pub fn into_batch(self) -> Result<RecordBatch, ArrowError> {
        let mut fields = vec![field("time", DataType::Float64, Some("s".to_owned()))];
        let mut arrays: Vec<ArrayRef> = vec![Arc::new(Float64Array::from(self.times))];
        for (column, values) in self.columns.into_iter().zip(self.values) {
            let array: ArrayRef = match values {
                Values::Real(all) => Arc::new(Float64Array::from(all)),
                Values::Integer(all) => Arc::new(Int32Array::from(all)),
                Values::Boolean(all) => Arc::new(BooleanArray::from(all)),
                Values::Text(all) => Arc::new(StringArray::from(all)),
            };
            fields.push(field(&column.name, array.data_type().clone(), column.unit));
            arrays.push(array);
        }
        RecordBatch::try_new(Arc::new(Schema::new(fields)), arrays)
    }
}
