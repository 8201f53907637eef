//! One Parquet file: rows are gathered column by column and written in groups; the file gets its name when it is whole.

use super::{Counts, FAILED, NOT_FINITE, PART, STUDY};
use crate::error::Error;
use crate::record::Values;
use orchestrator::{Column, Kind};
use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DoubleType, Int32Type, Int64Type};
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::types::{Type, TypePtr};
use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tempfile::NamedTempFile;

/// A column's values of the group under way.
pub(super) enum Data {
    Long(Vec<i64>),
    Values(Values),
    /// Values that are there, and for each row whether one is.
    MaybeReal(Vec<f64>, Vec<i16>),
    MaybeText(Vec<ByteArray>, Vec<i16>),
}

impl Data {
    fn clear(&mut self) {
        match self {
            Self::Long(values) => values.clear(),
            Self::Values(Values::Real(values)) => values.clear(),
            Self::Values(Values::Integer(values)) => values.clear(),
            Self::Values(Values::Boolean(values)) => values.clear(),
            Self::Values(Values::Text(values)) => values.clear(),
            Self::MaybeReal(values, there) => (values.clear(), there.clear()).1,
            Self::MaybeText(values, there) => (values.clear(), there.clear()).1,
        }
    }

    fn write(&self, to: &mut SerializedColumnWriter<'_>) -> parquet::errors::Result<usize> {
        let bytes = |text: &String| ByteArray::from(text.as_str());
        match self {
            Self::Long(values) => to.typed::<Int64Type>().write_batch(values, None, None),
            Self::Values(Values::Real(values)) => to.typed::<DoubleType>().write_batch(values, None, None),
            Self::Values(Values::Integer(values)) => to.typed::<Int32Type>().write_batch(values, None, None),
            Self::Values(Values::Boolean(values)) => to.typed::<BoolType>().write_batch(values, None, None),
            Self::Values(Values::Text(values)) => {
                let values: Vec<ByteArray> = values.iter().map(bytes).collect();
                to.typed::<ByteArrayType>().write_batch(&values, None, None)
            }
            Self::MaybeReal(values, there) => to.typed::<DoubleType>().write_batch(values, Some(there), None),
            Self::MaybeText(values, there) => {
                to.typed::<ByteArrayType>().write_batch(values, Some(there), None)
            }
        }
    }

    /// Its type in the file.
    fn kind(&self) -> (Physical, Repetition, bool) {
        match self {
            Self::Long(_) => (Physical::INT64, Repetition::REQUIRED, false),
            Self::Values(Values::Real(_)) => (Physical::DOUBLE, Repetition::REQUIRED, false),
            Self::Values(Values::Integer(_)) => (Physical::INT32, Repetition::REQUIRED, false),
            Self::Values(Values::Boolean(_)) => (Physical::BOOLEAN, Repetition::REQUIRED, false),
            Self::Values(Values::Text(_)) => (Physical::BYTE_ARRAY, Repetition::REQUIRED, true),
            Self::MaybeReal(..) => (Physical::DOUBLE, Repetition::OPTIONAL, false),
            Self::MaybeText(..) => (Physical::BYTE_ARRAY, Repetition::OPTIONAL, true),
        }
    }
}

/// Which part of which study a file holds.
#[derive(Debug, Clone)]
pub(crate) struct Stamp<'a> {
    pub(crate) fingerprint: &'a str,
    pub(crate) part: u64,
    pub(crate) of: u64,
}

/// A file under way, in the folder that it will stand in. Dropped before it is whole, it leaves nothing.
pub(super) struct PartFile {
    path: PathBuf,
    writer: SerializedFileWriter<File>,
    temporary: NamedTempFile,
    pub(super) columns: Vec<Data>,
    rows: usize,
    group: usize,
}

/// A column of a file: its name, its physical unit, its values.
pub(super) type Head = (String, Option<String>, Data);

impl PartFile {
    /// Begins it; `group` rows go into a group at most.
    pub(super) fn begin(
        path: &Path,
        stamp: &Stamp<'_>,
        heads: Vec<Head>,
        group: usize,
    ) -> Result<Self, Error> {
        let failed = Error::parquet(path);
        let fields = heads.iter().map(|(name, _, data)| field(name, data)).collect::<Result<Vec<_>, _>>();
        let schema = Type::group_type_builder("schema").with_fields(fields.map_err(&failed)?).build();
        let mut marks = vec![
            KeyValue::new(STUDY.to_owned(), stamp.fingerprint.to_owned()),
            KeyValue::new(PART.to_owned(), format!("{}/{}", stamp.part, stamp.of)),
        ];
        let unit = |(name, unit, _): &Head| Some(KeyValue::new(format!("unit:{name}"), unit.clone()?));
        marks.extend(heads.iter().filter_map(unit));
        let properties = WriterProperties::builder()
            .set_compression(Compression::SNAPPY)
            .set_created_by(format!("acroscope {}", env!("CARGO_PKG_VERSION")))
            .set_key_value_metadata(Some(marks))
            .build();
        let temporary = temporary(path)?;
        let file = temporary.as_file().try_clone().map_err(Error::file(path))?;
        let schema = Arc::new(schema.map_err(&failed)?);
        let writer = SerializedFileWriter::new(file, schema, Arc::new(properties)).map_err(&failed)?;
        let columns = heads.into_iter().map(|(.., data)| data).collect();
        Ok(Self { path: path.to_owned(), writer, temporary, columns, rows: 0, group })
    }

    /// So many rows were added to the columns.
    pub(super) fn added(&mut self, rows: usize) -> Result<(), Error> {
        self.rows += rows;
        if self.rows >= self.group { self.flush() } else { Ok(()) }
    }

    fn flush(&mut self) -> Result<(), Error> {
        if self.rows == 0 {
            return Ok(());
        }
        let failed = Error::parquet(&self.path);
        let mut group = self.writer.next_row_group().map_err(&failed)?;
        for data in &mut self.columns {
            if let Some(mut column) = group.next_column().map_err(&failed)? {
                data.write(&mut column).map_err(&failed)?;
                column.close().map_err(&failed)?;
            }
            data.clear();
        }
        group.close().map_err(&failed)?;
        self.rows = 0;
        Ok(())
    }

    /// Writes what is left and gives the file its name.
    pub(super) fn finish(mut self, counts: &Counts) -> Result<(), Error> {
        self.flush()?;
        self.writer.append_key_value_metadata(KeyValue::new(FAILED.to_owned(), counts.failed.to_string()));
        if let Some(text) = counts.not_finite_text() {
            self.writer.append_key_value_metadata(KeyValue::new(NOT_FINITE.to_owned(), text));
        }
        self.writer.close().map_err(Error::parquet(&self.path))?;
        self.temporary.persist(&self.path).map_err(|why| Error::file(&self.path)(why.error))?;
        Ok(())
    }
}

/// A hidden file beside the one that it becomes, with the rights that a new file has here.
pub(crate) fn temporary(path: &Path) -> Result<NamedTempFile, Error> {
    let folder = path.parent().unwrap_or(Path::new("."));
    std::fs::create_dir_all(folder).map_err(Error::file(folder))?;
    let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let prefix = format!(".{stem}-");
    let mut builder = tempfile::Builder::new();
    builder.prefix(&prefix).suffix(".tmp");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    let file = builder.tempfile_in(folder).map_err(Error::file(path))?;
    // Held until it has its name or is gone: whoever sweeps up leaves a file alone that somebody writes. Where files can't be locked,
    // nobody takes one away.
    let _ = file.as_file().lock();
    Ok(file)
}

fn field(name: &str, data: &Data) -> parquet::errors::Result<TypePtr> {
    let (physical, repetition, text) = data.kind();
    let builder = Type::primitive_type_builder(name, physical).with_repetition(repetition);
    Ok(Arc::new(builder.with_logical_type(text.then_some(LogicalType::String)).build()?))
}

/// A column for values of a variable.
pub(super) fn head(column: &Column) -> Head {
    (column.name.clone(), column.unit.clone(), Data::Values(Values::of(column.kind)))
}

/// A column of texts.
pub(super) fn text(name: &str) -> Head {
    (name.to_owned(), None, Data::Values(Values::of(Kind::String)))
}
