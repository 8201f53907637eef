//! `results.parquet`: the table of results for every tool that reads Parquet, a column a signal. The file's metadata has the
//! physical units (`unit:unit.variable`, as in a sweep's data set) and whatever the caller says of where it comes from.

use crate::error::{Error, file};
use crate::rows::Rows;
use crate::{Column, Kind};
use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DoubleType, Int32Type};
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::types::{Type, TypePtr};
use std::fs::File;
use std::path::Path;
use std::sync::Arc;

/// Values that wait for their group to be full: 8 MiB of numbers.
const WAITING: usize = 1 << 20;

/// The values of a column in the group under way.
enum Data {
    Real(Vec<f64>),
    Integer(Vec<i32>),
    Boolean(Vec<bool>),
    Text(Vec<ByteArray>),
}

impl Data {
    fn of(kind: Kind) -> Self {
        match kind {
            Kind::Real => Self::Real(Vec::new()),
            Kind::Integer => Self::Integer(Vec::new()),
            Kind::Boolean => Self::Boolean(Vec::new()),
            Kind::Text => Self::Text(Vec::new()),
        }
    }

    /// Its type in the file, and that of texts.
    fn kind(&self) -> (Physical, Option<LogicalType>) {
        match self {
            Self::Real(_) => (Physical::DOUBLE, None),
            Self::Integer(_) => (Physical::INT32, None),
            Self::Boolean(_) => (Physical::BOOLEAN, None),
            Self::Text(_) => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
        }
    }

    fn push(&mut self, rows: &Rows, column: usize) -> Result<(), Error> {
        match self {
            Self::Real(values) => values.push(rows.number(column)?),
            Self::Integer(values) => values.push(rows.number(column)? as i32),
            Self::Boolean(values) => values.push(rows.number(column)? != 0.0),
            Self::Text(values) => values.push(ByteArray::from(rows.text(column))),
        }
        Ok(())
    }

    /// Writes the values and forgets them.
    fn write(&mut self, to: &mut SerializedColumnWriter<'_>) -> parquet::errors::Result<usize> {
        match self {
            Self::Real(values) => to.typed::<DoubleType>().write_batch(&std::mem::take(values), None, None),
            Self::Integer(values) => to.typed::<Int32Type>().write_batch(&std::mem::take(values), None, None),
            Self::Boolean(values) => to.typed::<BoolType>().write_batch(&std::mem::take(values), None, None),
            Self::Text(values) => {
                to.typed::<ByteArrayType>().write_batch(&std::mem::take(values), None, None)
            }
        }
    }
}

/// Writes the rows of `results.csv`; `columns` are those after the time, `metadata` are names and texts for the file's own.
pub fn write_parquet(
    path: &Path,
    results: &Path,
    columns: &[Column],
    metadata: &[(&str, String)],
) -> Result<(), Error> {
    let written = write(path, results, columns, metadata);
    if written.is_err() {
        // Half a table is worse than none; what stood in the way of writing it may stand in the way of this, too.
        let _ = std::fs::remove_file(path);
    }
    written
}

fn write(path: &Path, results: &Path, columns: &[Column], metadata: &[(&str, String)]) -> Result<(), Error> {
    let mut rows = Rows::open(results)?;
    let time = Column { name: "time".into(), unit: Some("s".into()), kind: Kind::Real };
    let columns: Vec<&Column> = std::iter::once(&time).chain(columns).collect();
    let mut data: Vec<Data> = columns.iter().map(|column| Data::of(column.kind)).collect();
    let fields = columns.iter().zip(&data).map(|(column, data)| field(&column.name, data));
    let fields = fields.collect::<Result<Vec<_>, _>>().map_err(file(path))?;
    let schema = Type::group_type_builder("schema").with_fields(fields).build().map_err(file(path))?;
    let units =
        columns.iter().filter_map(|column| Some((format!("unit:{}", column.name), column.unit.clone()?)));
    let more = metadata.iter().map(|(name, text)| ((*name).to_owned(), text.clone()));
    let properties = WriterProperties::builder()
        .set_compression(Compression::SNAPPY)
        .set_created_by(format!("acroscope {}", env!("CARGO_PKG_VERSION")))
        .set_key_value_metadata(Some(
            units.chain(more).map(|(name, text)| KeyValue::new(name, text)).collect(),
        ))
        .build();
    let target = File::create(path).map_err(file(path))?;
    let mut writer =
        SerializedFileWriter::new(target, Arc::new(schema), Arc::new(properties)).map_err(file(path))?;
    let most = (WAITING / columns.len()).max(1);
    let mut waiting = 0;
    loop {
        let more = rows.advance()?;
        if more {
            for (column, data) in data.iter_mut().enumerate() {
                data.push(&rows, column)?;
            }
            waiting += 1;
        }
        if waiting == most || !more && waiting > 0 {
            let mut group = writer.next_row_group().map_err(file(path))?;
            for data in &mut data {
                if let Some(mut column) = group.next_column().map_err(file(path))? {
                    data.write(&mut column).map_err(file(path))?;
                    column.close().map_err(file(path))?;
                }
            }
            group.close().map_err(file(path))?;
            waiting = 0;
        }
        if !more {
            writer.close().map_err(file(path))?;
            return Ok(());
        }
    }
}

fn field(name: &str, data: &Data) -> parquet::errors::Result<TypePtr> {
    let (physical, logical) = data.kind();
    let builder = Type::primitive_type_builder(name, physical).with_repetition(Repetition::REQUIRED);
    Ok(Arc::new(builder.with_logical_type(logical).build()?))
}
