//! Quaternions, vectors and matrices, row by row.

use crate::arrays::{rows, table};
use crate::errors::exception;
use numpy::{PyArray2, PyReadonlyArray2};
use pyo3::prelude::*;
use shisei_core::{Error, Quaternion, Result, Vec3};

type Quat = [f64; 4];

/// What `of` makes of every row; a refusal names its row.
fn each<const M: usize, const N: usize>(
    py: Python<'_>,
    name: &str,
    given: &[[f64; M]],
    of: impl Fn([f64; M]) -> Result<[f64; N]> + Send + Sync,
) -> PyResult<Vec<[f64; N]>> {
    let all = || -> Result<Vec<[f64; N]>> {
        given.iter().enumerate().map(|(row, x)| of(*x).map_err(|error| error.at_row(row))).collect()
    };
    py.detach(all).map_err(|error| exception(name, error))
}

fn same_length(name: &str, first: usize, second: usize) -> PyResult<()> {
    if first == second { Ok(()) } else { Err(exception(name, Error::LengthMismatch { first, second })) }
}

/// Hamilton products row by row; both have as many rows.
#[pyfunction]
#[allow(clippy::needless_pass_by_value)] // what PyO3 extracts
pub fn multiply<'py>(
    py: Python<'py>,
    a: PyReadonlyArray2<'py, f64>,
    b: PyReadonlyArray2<'py, f64>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let (a, b) = (rows::<4>(&a, "a")?, rows::<4>(&b, "b")?);
    same_length("multiply", a.len(), b.len())?;
    let product =
        |(&a, &b): (&Quat, &Quat)| Quaternion::from_array(a).product(Quaternion::from_array(b)).to_array();
    let out: Vec<Quat> = py.detach(|| a.iter().zip(b).map(product).collect());
    table(py, out)
}

/// Vectors turned from sensor to world coordinates; both have as many rows.
#[pyfunction]
#[allow(clippy::needless_pass_by_value)] // what PyO3 extracts
pub fn rotate<'py>(
    py: Python<'py>,
    q: PyReadonlyArray2<'py, f64>,
    v: PyReadonlyArray2<'py, f64>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let (q, v) = (rows::<4>(&q, "q")?, rows::<3>(&v, "v")?);
    same_length("rotate", q.len(), v.len())?;
    let units = each(py, "rotate", q, |q| Ok(Quaternion::from_array(q).try_normalized()?.to_array()))?;
    let turned = |(q, v): (&Quat, &Vec3)| Quaternion::from_array(*q).rotate(*v);
    let out: Vec<Vec3> = py.detach(|| units.iter().zip(v).map(turned).collect());
    table(py, out)
}

/// Rotation matrices, nine numbers a row.
#[pyfunction]
#[allow(clippy::needless_pass_by_value)] // what PyO3 extracts
pub fn to_matrix<'py>(py: Python<'py>, q: PyReadonlyArray2<'py, f64>) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let matrix = |q: Quat| {
        let [x, y, z] = Quaternion::from_array(q).try_normalized()?.to_matrix();
        Ok([x[0], x[1], x[2], y[0], y[1], y[2], z[0], z[1], z[2]])
    };
    let out = each(py, "to_matrix", rows::<4>(&q, "q")?, matrix)?;
    table::<9>(py, out)
}

/// Quaternions of rotation matrices, nine numbers a row.
#[pyfunction]
#[allow(clippy::needless_pass_by_value)] // what PyO3 extracts
pub fn from_matrix<'py>(
    py: Python<'py>,
    matrix: PyReadonlyArray2<'py, f64>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let quat = |[a, b, c, d, e, f, g, h, i]: [f64; 9]| {
        Ok(Quaternion::from_matrix([[a, b, c], [d, e, f], [g, h, i]])?.to_array())
    };
    let out = each(py, "from_matrix", rows::<9>(&matrix, "matrix")?, quat)?;
    table::<4>(py, out)
}

/// Rotation vectors.
#[pyfunction]
#[allow(clippy::needless_pass_by_value)] // what PyO3 extracts
pub fn to_rotation_vector<'py>(
    py: Python<'py>,
    q: PyReadonlyArray2<'py, f64>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let vector = |q: Quat| Ok(Quaternion::from_array(q).try_normalized()?.to_rotation_vector());
    let out = each(py, "to_rotation_vector", rows::<4>(&q, "q")?, vector)?;
    table::<3>(py, out)
}

/// Spherical interpolation from `a` to `b` at each t.
#[pyfunction]
pub fn slerp(py: Python<'_>, a: Quat, b: Quat, t: Vec<f64>) -> PyResult<Bound<'_, PyArray2<f64>>> {
    let unit =
        |q: Quat| Quaternion::from_array(q).try_normalized().map_err(|error| exception("slerp", error));
    let (a, b) = (unit(a)?, unit(b)?);
    if let Some(row) = t.iter().position(|t| !t.is_finite()) {
        return Err(exception("slerp", Error::NotFinite { row }));
    }
    table(py, t.into_iter().map(|t| Quaternion::slerp(a, b, t).to_array()).collect::<Vec<Quat>>())
}
