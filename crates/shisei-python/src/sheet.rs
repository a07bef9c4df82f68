//! The worksheet functions.

use crate::errors::sheet_exception;
use numpy::{PyArray1, PyArrayMethods, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::exceptions::PyIndexError;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyList};
use shisei_functions::{Error, FUNCTIONS, Input, Output, Range, ReturnShape};

/// What the package needs to know of every function.
#[pyfunction]
pub fn functions(py: Python<'_>) -> PyResult<Bound<'_, PyList>> {
    let list = PyList::empty(py);
    for f in &FUNCTIONS {
        let entry = PyDict::new(py);
        entry.set_item("name", f.name)?;
        entry.set_item("doc", (f.doc.en, f.doc.ja))?;
        entry.set_item("returns", (f.returns.shape.to_string(), f.returns.doc.en, f.returns.doc.ja))?;
        let args = PyList::empty(py);
        for a in f.args {
            let doc = (a.doc.en, a.doc.ja);
            args.append((a.name, a.shape.is_number(), a.shape.to_string(), a.unit, a.default, doc))?;
        }
        entry.set_item("args", args)?;
        list.append(entry)?;
    }
    Ok(list)
}

/// One argument: a number, or a C-contiguous two-dimensional float64 array.
#[derive(FromPyObject)]
pub enum Given<'py> {
    Array(PyReadonlyArray2<'py, f64>),
    Number(f64),
}

/// Calls function `index` of the table; None is an argument left out.
#[pyfunction]
#[allow(clippy::needless_pass_by_value)] // what PyO3 extracts
pub fn call<'py>(
    py: Python<'py>,
    index: usize,
    given: Vec<Option<Given<'py>>>,
) -> PyResult<Bound<'py, PyAny>> {
    let function = FUNCTIONS.get(index).ok_or_else(|| PyIndexError::new_err(index))?;
    let refuse = |error: Error| sheet_exception(function.name, error);
    let mut inputs = Vec::with_capacity(given.len());
    for argument in &given {
        inputs.push(match argument {
            None => Input::Missing,
            Some(Given::Number(x)) => Input::Number(*x),
            Some(Given::Array(array)) => {
                let data = array.as_slice().map_err(|_| refuse(Error::Internal))?;
                let range = Range::new(data, array.shape()[0], array.shape()[1]);
                range.map_or(Input::Missing, Input::Range)
            }
        });
    }
    let output = py.detach(|| function.call(&inputs)).map_err(refuse)?;
    match output {
        Output::Truth(truth) => Ok(PyBool::new(py, truth).to_owned().into_any()),
        Output::Sentence(text) => Ok(text.into_pyobject(py)?.into_any()),
        Output::Numbers { data, rows, cols } => match function.returns.shape {
            ReturnShape::Number => {
                let number = data.first().copied().ok_or_else(|| refuse(Error::Internal))?;
                Ok(number.into_pyobject(py)?.into_any())
            }
            ReturnShape::Row(_) => Ok(PyArray1::from_vec(py, data).into_any()),
            _ => Ok(PyArray1::from_vec(py, data).reshape([rows, cols])?.into_any()),
        },
    }
}
