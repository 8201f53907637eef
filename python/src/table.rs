//! What a run recorded, as a table for Arrow's consumers; and frames.

use crate::errors::other;
use crate::recorder::{Columns, field};
use arrow_array::cast::AsArray as _;
use arrow_array::ffi_stream::FFI_ArrowArrayStream;
use arrow_array::types::{Float64Type, Int32Type};
use arrow_array::{Array as _, ArrayRef, RecordBatch, RecordBatchIterator};
use arrow_array::{BooleanArray, Float64Array, Int32Array, StringArray};
use arrow_schema::{DataType, Schema};
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyCapsule, PyList, PyType};
use std::error::Error;
use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A column for pickle: name, unit, type and values.
type Pickled<'py> = (String, Option<String>, &'static str, Bound<'py, PyAny>);

/// A row at each communication point.
#[pyclass(frozen, module = "acroscope._acroscope")]
pub struct Table {
    batch: RecordBatch,
}

impl Table {
    /// From what was recorded.
    pub fn new(columns: Columns) -> PyResult<Self> {
        Ok(Self { batch: columns.into_batch().map_err(other)? })
    }

    fn place(&self, name: &str) -> PyResult<usize> {
        let schema = self.batch.schema();
        schema.index_of(name).map_err(|_| {
            let names = schema.fields().iter().map(|field| field.name().as_str());
            PyKeyError::new_err(format!(
                "no recorded variable {name:?}: {}",
                orchestrator::nearest(name, names)
            ))
        })
    }
}

#[pymethods]
impl Table {
    /// Names of the columns, `time` first.
    #[getter]
    fn columns(&self) -> Vec<String> {
        self.batch.schema().fields().iter().map(|field| field.name().clone()).collect()
    }

    /// The unit of a column, if its description names one.
    fn unit(&self, name: &str) -> PyResult<Option<String>> {
        let place = self.place(name)?;
        Ok(self.batch.schema().field(place).metadata().get("unit").cloned())
    }

    fn __len__(&self) -> usize {
        self.batch.num_rows()
    }

    /// The values of a column: NumPy's name of their type and their bytes, or a list of texts.
    fn values<'py>(&self, py: Python<'py>, name: &str) -> PyResult<(&'static str, Bound<'py, PyAny>)> {
        fn bytes<'py, const N: usize>(
            py: Python<'py>,
            numbers: impl ExactSizeIterator<Item = [u8; N]>,
        ) -> PyResult<Bound<'py, PyAny>> {
            let filled = PyBytes::new_with(py, numbers.len() * N, |buffer| {
                for (place, number) in buffer.chunks_exact_mut(N).zip(numbers) {
                    place.copy_from_slice(&number);
                }
                Ok(())
            });
            Ok(filled?.into_any())
        }
        let array = self.batch.column(self.place(name)?);
        Ok(match array.data_type() {
            DataType::Float64 => {
                let values = array.as_primitive::<Float64Type>().values();
                ("float64", bytes(py, values.iter().map(|value| value.to_ne_bytes()))?)
            }
            DataType::Int32 => {
                let values = array.as_primitive::<Int32Type>().values();
                ("int32", bytes(py, values.iter().map(|value| value.to_ne_bytes()))?)
            }
            DataType::Boolean => {
                let values: Vec<u8> = array.as_boolean().values().iter().map(u8::from).collect();
                ("bool", PyBytes::new(py, &values).into_any())
            }
            _ => ("str", PyList::new(py, array.as_string::<i32>().iter())?.into_any()),
        })
    }

    /// From the columns that `__reduce__` gives: name, unit, and what `values` has.
    #[new]
    fn again(columns: Vec<(String, Option<String>, String, Bound<'_, PyAny>)>) -> PyResult<Self> {
        let (mut fields, mut arrays) = (Vec::new(), Vec::new());
        for (name, unit, kind, values) in columns {
            let array: ArrayRef = match kind.as_str() {
                "float64" => Arc::new(Float64Array::from(numbers(&values, f64::from_ne_bytes)?)),
                "int32" => Arc::new(Int32Array::from(numbers(&values, i32::from_ne_bytes)?)),
                "bool" => Arc::new(BooleanArray::from(numbers(&values, |[byte]| byte != 0)?)),
                _ => Arc::new(StringArray::from(values.extract::<Vec<String>>()?)),
            };
            fields.push(field(&name, array.data_type().clone(), unit));
            arrays.push(array);
        }
        Ok(Self { batch: RecordBatch::try_new(Arc::new(Schema::new(fields)), arrays).map_err(other)? })
    }

    /// For pickle: the columns, which `__new__` makes the same table of.
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyType>, (Vec<Pickled<'py>>,))> {
        let column = |name: String| {
            let (unit, (kind, values)) = (self.unit(&name)?, self.values(py, &name)?);
            Ok((name, unit, kind, values))
        };
        let columns = self.columns().into_iter().map(column).collect::<PyResult<_>>()?;
        Ok((py.get_type::<Self>(), (columns,)))
    }

    /// Arrow's PyCapsule interface: a stream of one batch that shares our memory.
    #[pyo3(signature = (requested_schema = None))]
    fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        // The interface has a producer ignore what it can't cast to.
        let _ = requested_schema;
        let batches = RecordBatchIterator::new([Ok(self.batch.clone())], self.batch.schema());
        PyCapsule::new_with_value(py, FFI_ArrowArrayStream::new(Box::new(batches)), c"arrow_array_stream")
    }
}

/// The numbers that bytes hold.
fn numbers<T, const N: usize>(bytes: &Bound<'_, PyAny>, number: impl Fn([u8; N]) -> T) -> PyResult<Vec<T>> {
    let bytes = bytes.cast::<PyBytes>()?;
    let (whole, _) = bytes.as_bytes().as_chunks();
    Ok(whole.iter().copied().map(number).collect())
}

/// A frame: height, width and grey levels, row by row.
#[pyfunction]
pub fn grey(py: Python<'_>, path: PathBuf) -> PyResult<(u32, u32, Bound<'_, PyBytes>)> {
    let (height, width, levels) =
        read_grey(&path).map_err(|why| other(format!("{}: {why}", path.display())))?;
    Ok((height, width, PyBytes::new(py, &levels)))
}

fn read_grey(path: &Path) -> Result<(u32, u32, Vec<u8>), Box<dyn Error>> {
    let mut reader = png::Decoder::new(BufReader::new(File::open(path)?)).read_info()?;
    let mut levels = vec![0; reader.output_buffer_size().ok_or("the picture is too large")?];
    let info = reader.next_frame(&mut levels)?;
    if info.color_type != png::ColorType::Grayscale || info.bit_depth != png::BitDepth::Eight {
        return Err("no picture of 8-bit grey levels".into());
    }
    levels.truncate(info.buffer_size());
    Ok((info.height, info.width, levels))
}
