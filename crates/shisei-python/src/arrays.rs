//! NumPy arrays as slices of rows, and back.

use std::borrow::Cow;

use crate::errors::ShapeError;
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use shisei_core::filter::Dt;

/// The rows of a C-contiguous (N, n) array.
pub fn rows<'a, const N: usize>(
    array: &'a PyReadonlyArray2<'_, f64>,
    name: &str,
) -> PyResult<&'a [[f64; N]]> {
    let [n, cols] = [array.shape()[0], array.shape()[1]];
    if cols != N {
        return Err(ShapeError::new_err(format!("{name} has shape ({n}, {cols}) and must be (N, {N})")));
    }
    let slice = array.as_slice().map_err(|_| {
        ShapeError::new_err(format!("{name} is not C-contiguous; pass numpy.ascontiguousarray"))
    })?;
    Ok(slice.as_chunks::<N>().0)
}

/// A result as a (N, n) array, handed over without a copy.
pub fn table<const N: usize>(py: Python<'_>, rows: Vec<[f64; N]>) -> PyResult<Bound<'_, PyArray2<f64>>> {
    let n = rows.len();
    PyArray1::from_vec(py, rows.into_flattened()).reshape([n, N])
}

/// A step: one number, or one a sample.
#[derive(FromPyObject)]
pub enum Step<'py> {
    Constant(f64),
    PerSample(PyReadonlyArray1<'py, f64>),
}

impl Step<'_> {
    pub fn dt(&self) -> PyResult<Dt<'_>> {
        match self {
            Step::Constant(dt_s) => Ok(Dt::Constant(*dt_s)),
            Step::PerSample(dt_s) => {
                let slice = dt_s.as_slice().map_err(|_| ShapeError::new_err("dt_s is not contiguous"))?;
                Ok(Dt::PerSample(slice))
            }
        }
    }

    /// A step for each of so many rows.
    pub fn per_row(&self, rows: usize) -> PyResult<Cow<'_, [f64]>> {
        Ok(match self.dt()? {
            Dt::PerSample(dt_s) => Cow::Borrowed(dt_s),
            Dt::Constant(dt_s) => Cow::Owned(vec![dt_s; rows]),
        })
    }
}
