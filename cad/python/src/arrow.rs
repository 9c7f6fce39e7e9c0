//! Columns as an Arrow stream (the C stream interface of Apache Arrow, in a `PyCapsule` as the PyCapsule protocol
//! requires: https://arrow.apache.org/docs/format/CDataInterface/PyCapsuleInterface.html).

use std::sync::Arc;

use arrow_array::ffi_stream::FFI_ArrowArrayStream;
use arrow_array::{ArrayRef, Float64Array, Int64Array, RecordBatch, RecordBatchIterator, StringArray};
use arrow_schema::{DataType, Field, Schema};
use numpy::{PyArrayMethods, PyReadonlyArray1};
use pinswitch::diagnostic::{Diagnostic, codes};
use pyo3::prelude::*;
use pyo3::types::PyCapsule;

use crate::error::OrRaise;

/// Returns the stream of columns: arrays of float64 or int64, or sequences of text. NaN and `None` are null.
#[pyfunction]
pub(crate) fn arrow_stream<'py>(
    py: Python<'py>,
    columns: Vec<(String, Bound<'py, PyAny>)>,
) -> PyResult<Bound<'py, PyCapsule>> {
    let mut fields = Vec::new();
    let mut arrays: Vec<ArrayRef> = Vec::new();
    for (name, column) in columns {
        let (kind, array): (DataType, ArrayRef) =
            if let Ok(numbers) = column.extract::<PyReadonlyArray1<'_, f64>>() {
                // A number that is missing in a table is NaN in numpy and null in Arrow.
                let numbers = numbers.to_vec()?;
                let numbers: Float64Array = if numbers.iter().any(|number| number.is_nan()) {
                    numbers.into_iter().map(|number| Some(number).filter(|number| !number.is_nan())).collect()
                } else {
                    Float64Array::from(numbers)
                };
                (DataType::Float64, Arc::new(numbers))
            } else if let Ok(numbers) = column.extract::<PyReadonlyArray1<'_, i64>>() {
                (DataType::Int64, Arc::new(Int64Array::from(numbers.to_vec()?)))
            } else {
                let texts: Vec<Option<String>> = column.extract()?;
                (DataType::Utf8, Arc::new(StringArray::from(texts)))
            };
        fields.push(Field::new(name, kind, true));
        arrays.push(array);
    }
    let schema = Arc::new(Schema::new(fields));
    let batch = RecordBatch::try_new(Arc::clone(&schema), arrays)
        .map_err(|e| Diagnostic::from_error(codes::INTERNAL_ERROR, e))
        .or_raise(py)?;
    let stream = FFI_ArrowArrayStream::new(Box::new(RecordBatchIterator::new([Ok(batch)], schema)));
    PyCapsule::new_with_value(py, stream, c"arrow_array_stream")
}
