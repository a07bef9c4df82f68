//! Quaternions, vectors and matrices, row by row.

use crate::arrays::{rows, table};
use crate::errors::exception;
use numpy::{PyArray1, PyArray2, PyReadonlyArray2};
use pyo3::prelude::*;
use shisei_core::{Error, Quaternion, Result, Vec3, initial, relative as relative_to};
use shisei_wide::Vectors;

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

/// A series that the core makes of a series.
fn whole<'py, const N: usize>(
    py: Python<'py>,
    name: &str,
    rows: usize,
    fill: impl FnOnce(&mut [[f64; N]]) -> Result<()> + Send,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let mut out = vec![[0.0; N]; rows];
    py.detach(|| fill(&mut out)).map_err(|error| exception(name, error))?;
    table(py, out)
}

/// Unit quaternions.
#[pyfunction]
#[allow(clippy::needless_pass_by_value)] // what PyO3 extracts
pub fn normalize<'py>(py: Python<'py>, q: PyReadonlyArray2<'py, f64>) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let q = rows::<4>(&q, "q")?;
    whole::<4>(py, "normalize", q.len(), |out| Vectors::widest().convert_series(q, out))
}

/// Yaw, pitch, roll.
#[pyfunction]
#[allow(clippy::needless_pass_by_value)] // what PyO3 extracts
pub fn to_ypr<'py>(py: Python<'py>, q: PyReadonlyArray2<'py, f64>) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let q = rows::<4>(&q, "q")?;
    whole::<3>(py, "to_ypr", q.len(), |out| Vectors::widest().convert_series(q, out))
}

/// Quaternions of yaw, pitch, roll.
#[pyfunction]
#[allow(clippy::needless_pass_by_value)] // what PyO3 extracts
pub fn from_ypr<'py>(
    py: Python<'py>,
    ypr_rad: PyReadonlyArray2<'py, f64>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let ypr_rad = rows::<3>(&ypr_rad, "ypr_rad")?;
    whole::<4>(py, "from_ypr", ypr_rad.len(), |out| relative_to::from_ypr_series(ypr_rad, out))
}

/// The turns since `start`, which has a direction: in the sensor's axes then, or in world axes.
#[pyfunction]
#[allow(clippy::needless_pass_by_value)] // what PyO3 extracts
pub fn relative<'py>(
    py: Python<'py>,
    q: PyReadonlyArray2<'py, f64>,
    start: Quat,
    in_body: bool,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let (q, start) = (rows::<4>(&q, "q")?, Quaternion::from_array(start));
    whole::<4>(py, "relative", q.len(), |out| {
        if in_body {
            Vectors::widest().body_series(q, start, out)
        } else {
            Vectors::widest().world_series(q, start, out)
        }
    })
}

/// The quaternion of a turn about an axis.
#[pyfunction]
pub fn from_axis_angle(py: Python<'_>, axis: Vec3, angle_rad: f64) -> PyResult<Bound<'_, PyArray1<f64>>> {
    let found = Quaternion::from_axis_angle(axis, angle_rad);
    let q = found.map_err(|error| exception("from_axis_angle", error))?;
    Ok(PyArray1::from_slice(py, &q.to_array()))
}

/// The attitude at rest, with yaw 0; refused where the variance of an axis is larger, or the mean norm is beyond
/// the limits.
#[pyfunction]
#[allow(clippy::needless_pass_by_value)] // what PyO3 extracts
pub fn initial_attitude<'py>(
    py: Python<'py>,
    acc_m_s2: PyReadonlyArray2<'py, f64>,
    max_variance: f64,
    norm_limits: (f64, f64),
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let acc = rows::<3>(&acc_m_s2, "acc_m_s2")?;
    let (low, high) = norm_limits;
    let found = py.detach(|| initial::from_stable_window(acc, max_variance, low, high));
    let q = found.map_err(|error| exception("initial_attitude", error))?;
    Ok(PyArray1::from_slice(py, &q.to_array()))
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
    table(py, t.into_iter().map(|t| Quaternion::slerp(a, b, t).to_array()).collect::<Vec<Quat>>())
}
