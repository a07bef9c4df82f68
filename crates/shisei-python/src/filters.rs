//! Filters over arrays, one sample at a time, and whole recordings.

use crate::arrays::{Step, rows, table};
use crate::errors::exception;
use crate::fuse::in_python;
use crate::threads::{SideBySide, turn};
use numpy::{PyArray1, PyArray2, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use shisei_core::filter::{
    AdaptiveGain, Complementary, Dt, Filter, GyroIntegrator, GyroOnly, GyroRk4, Mahony, MahonyAdaptive,
    Readings,
};
use shisei_core::motion::{DeadReckoning, MotionState, Scheme};
use shisei_core::orient::{self as whole, Method, Relative, RestChoice, Settings};
use shisei_core::{Quaternion, Result, Vec3};
use shisei_functions::last_error::user_lang;
use shisei_wide::Vectors;
use std::sync::Mutex;

type Quat = [f64; 4];

fn at<const N: usize>(parameters: &[f64]) -> PyResult<[f64; N]> {
    <[f64; N]>::try_from(parameters)
        .map_err(|_| PyValueError::new_err(format!("{} parameters, {N} expected", parameters.len())))
}

fn gain(p: &[f64]) -> PyResult<AdaptiveGain> {
    let [kp_max, kp_min, upper_start, upper_end, lower_start, lower_end] = at(p)?;
    Ok(AdaptiveGain { kp_max, kp_min, upper_start, upper_end, lower_start, lower_end })
}

fn run(mut filter: impl Filter, gyro: &[Vec3], acc: &[Vec3], dt: Dt<'_>) -> Result<Vec<Quat>> {
    let mut out = vec![[0.0; 4]; gyro.len()];
    Vectors::widest().run_into(&mut filter, gyro, acc, dt, &mut out)?;
    Ok(out)
}

fn run_gyro(mut filter: impl GyroOnly, gyro: &[Vec3], dt: Dt<'_>) -> Result<Vec<Quat>> {
    let mut out = vec![[0.0; 4]; gyro.len()];
    Vectors::widest().run_gyro_into(&mut filter, gyro, dt, &mut out)?;
    Ok(out)
}

/// Runs the filter `kind` with its parameters (as the package orders them) from `start`.
#[pyfunction]
#[allow(clippy::needless_pass_by_value)] // what PyO3 extracts
pub fn run_filter<'py>(
    py: Python<'py>,
    kind: &str,
    parameters: Vec<f64>,
    start: Quat,
    gyro_rad_s: PyReadonlyArray2<'py, f64>,
    acc_m_s2: Option<PyReadonlyArray2<'py, f64>>,
    dt_s: Step<'py>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let gyro = rows::<3>(&gyro_rad_s, "gyro_rad_s")?;
    let acc = acc_m_s2.as_ref().map_or(Ok(&[][..]), |acc| rows::<3>(acc, "acc_m_s2"))?;
    let (dt, q, p) = (dt_s.dt()?, Quaternion::from_array(start), &parameters[..]);
    let out: Result<Vec<Quat>> = match kind {
        "gyro" => py.detach(|| run_gyro(GyroIntegrator::new(q)?, gyro, dt)),
        "gyro-rk4" => py.detach(|| run_gyro(GyroRk4::new(q)?, gyro, dt)),
        "mahony" => {
            let [kp, ki] = at(p)?;
            py.detach(|| run(Mahony::new(q, kp, ki)?, gyro, acc, dt))
        }
        "mahony-adaptive" => {
            let [.., ki, gravity] = at::<8>(p)?;
            let gain = gain(&p[..6])?;
            py.detach(|| run(MahonyAdaptive::new(q, gain, ki, gravity)?, gyro, acc, dt))
        }
        "complementary" => {
            let [alpha, gravity] = at(p)?;
            py.detach(|| run(Complementary::new(q, alpha, gravity)?, gyro, acc, dt))
        }
        other => return Err(PyValueError::new_err(format!("there is no filter {other:?}"))),
    };
    let function = match kind {
        "gyro" | "gyro-rk4" => "integrate_gyro",
        "mahony-adaptive" => "mahony_adaptive",
        named_alike => named_alike,
    };
    table(py, out.map_err(|error| exception(function, error))?)
}

/// A recording as the package gives it: start, kp, ki, rates, accelerations, step.
type Given<'py> = (Quat, f64, f64, PyReadonlyArray2<'py, f64>, PyReadonlyArray2<'py, f64>, Step<'py>);

/// Mahony's filter over several recordings side by side.
#[pyfunction]
#[allow(clippy::needless_pass_by_value)] // what PyO3 extracts
pub fn run_mahony_many<'py>(
    py: Python<'py>,
    recordings: Vec<Given<'py>>,
) -> PyResult<Vec<Bound<'py, PyArray2<f64>>>> {
    let mut outs: Vec<Vec<Quat>> =
        recordings.iter().map(|given| vec![[0.0; 4]; given.3.shape()[0]]).collect();
    let mut readings = Vec::with_capacity(outs.len());
    for ((start, kp, ki, gyro, acc, step), out) in recordings.iter().zip(&mut outs) {
        let filter = Mahony::new(Quaternion::from_array(*start), *kp, *ki);
        readings.push(Readings {
            filter: filter.map_err(|error| exception("mahony", error))?,
            gyro_rad_s: rows::<3>(gyro, "gyro_rad_s")?,
            acc_m_s2: rows::<3>(acc, "acc_m_s2")?,
            dt: step.dt()?,
            out,
        });
    }
    py.detach(|| Vectors::widest().run_many_into(&mut readings))
        .map_err(|(_, error)| exception("mahony", error))?;
    outs.into_iter().map(|out| table(py, out)).collect()
}

/// Mahony's filter, one sample at a time; threads take turns.
#[pyclass(module = "shisei._native", name = "MahonyFilter", frozen)]
#[derive(Debug)]
pub struct MahonyFilter(Mutex<Mahony>);

#[pymethods]
impl MahonyFilter {
    #[new]
    fn new(start: Quat, kp: f64, ki: f64) -> PyResult<Self> {
        let filter = Mahony::new(Quaternion::from_array(start), kp, ki);
        filter.map(|filter| MahonyFilter(Mutex::new(filter))).map_err(|error| exception("Mahony", error))
    }

    fn update(&self, py: Python<'_>, gyro_rad_s: Vec3, acc_m_s2: Vec3, dt_s: f64) -> Quat {
        turn(&self.0, py).update(gyro_rad_s, acc_m_s2, dt_s).to_array()
    }

    #[getter]
    fn world_from_body(&self, py: Python<'_>) -> Quat {
        turn(&self.0, py).orientation().to_array()
    }

    #[getter]
    fn integral_rad_s(&self, py: Python<'_>) -> Vec3 {
        turn(&self.0, py).integral_rad_s()
    }
}

/// What is odd about readings that are said to be in m/s² and rad/s, a sentence each.
#[pyfunction]
#[allow(clippy::needless_pass_by_value)] // what PyO3 extracts
pub fn doubts<'py>(
    py: Python<'py>,
    acc_m_s2: PyReadonlyArray2<'py, f64>,
    gyro_rad_s: PyReadonlyArray2<'py, f64>,
    dt_s: Step<'py>,
) -> PyResult<Vec<String>> {
    let (acc, gyro) = (rows::<3>(&acc_m_s2, "acc_m_s2")?, rows::<3>(&gyro_rad_s, "gyro_rad_s")?);
    let steps = dt_s.per_row(gyro.len())?;
    let dt = &*steps;
    let lang = user_lang();
    let notes = py.detach(|| shisei_record::doubts(acc, gyro, dt));
    Ok(notes.iter().map(|note| note.sentence(lang).to_owned()).collect())
}

/// What is odd about attitudes that start so, a sentence each.
#[pyfunction]
pub fn doubts_of_attitudes(start: Quat, forward_said: bool, gravity_m_s2: f64) -> Vec<String> {
    let notes = shisei_record::doubts_of_attitudes(Quaternion::from_array(start), forward_said, gravity_m_s2);
    notes.iter().map(|note| in_python(note.sentence(user_lang()))).collect()
}

/// A whole recording: rest, bias, start, filter. `rest` is None, "auto" or (start, end) in rows.
#[pyfunction]
#[allow(clippy::needless_pass_by_value, clippy::too_many_arguments)] // what PyO3 extracts; keywords in the package
pub fn orient<'py>(
    py: Python<'py>,
    kind: &str,
    parameters: Vec<f64>,
    gyro_rad_s: PyReadonlyArray2<'py, f64>,
    acc_m_s2: PyReadonlyArray2<'py, f64>,
    dt_s: Step<'py>,
    auto_rest: bool,
    rest_rows: Option<(usize, usize)>,
    forward_axis_body: Option<Vec3>,
    gravity_m_s2: f64,
) -> PyResult<Bound<'py, PyDict>> {
    let (gyro, acc) = (rows::<3>(&gyro_rad_s, "gyro_rad_s")?, rows::<3>(&acc_m_s2, "acc_m_s2")?);
    let p = &parameters[..];
    let method = match kind {
        "shisei" => Method::Estimate,
        "shisei-online" => Method::EstimateOnline,
        "gyro" => Method::Gyro,
        "gyro-rk4" => Method::GyroRk4,
        "mahony" => at(p).map(|[kp, ki]| Method::Mahony { kp, ki })?,
        "mahony-adaptive" => {
            let [.., ki, _] = at::<8>(p)?;
            Method::MahonyAdaptive { gain: gain(&p[..6])?, ki }
        }
        "complementary" => at(p).map(|[alpha, _]| Method::Complementary { alpha })?,
        other => return Err(PyValueError::new_err(format!("there is no filter {other:?}"))),
    };
    let rest = match rest_rows {
        Some((start, end)) => RestChoice::Rows { start, end },
        None if auto_rest => RestChoice::Auto,
        None => RestChoice::None,
    };
    let settings =
        Settings { method, rest, relative: Relative::None, forward_axis_body, gravity_m_s2, sensor: None };
    let steps = dt_s.per_row(gyro.len())?;
    let dt = &*steps;
    let found = py
        .detach(|| whole::orient_with(acc, gyro, dt, &settings, &SideBySide))
        .map_err(|error| exception("orient", error))?;
    let result = PyDict::new(py);
    let quats: Vec<Quat> = found.world_from_body.into_iter().map(Quaternion::to_array).collect();
    result.set_item("world_from_body", table(py, quats)?)?;
    result.set_item("start", found.start.to_array())?;
    result.set_item("rest", found.rest.map(|r| (r.start, r.end)))?;
    result.set_item("gyro_bias_rad_s", found.gyro_bias_rad_s)?;
    if let Some(certainty) = found.certainty {
        result.set_item("sigma_tilt_rad", PyArray1::from_vec(py, certainty.sigma_tilt_rad))?;
        result.set_item("sigma_heading_rad", PyArray1::from_vec(py, certainty.sigma_heading_rad))?;
    }
    Ok(result)
}

/// Yaw, pitch, roll of attitudes of unit norm, relative to the start in "world" or "body" axes, or themselves ("none").
#[pyfunction]
#[allow(clippy::needless_pass_by_value)] // what PyO3 extracts
pub fn ypr_rad<'py>(
    py: Python<'py>,
    world_from_body: PyReadonlyArray2<'py, f64>,
    start: Quat,
    relative: &str,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let quats = rows::<4>(&world_from_body, "world_from_body")?;
    let relative = match relative {
        "world" => Relative::World,
        "body" => Relative::Body,
        _ => Relative::None,
    };
    let ypr_rad = py.detach(|| {
        let quats: Vec<Quaternion> = quats.iter().copied().map(Quaternion::from_array).collect();
        Vectors::widest().ypr_rad(&quats, Quaternion::from_array(start), relative)
    });
    table(py, ypr_rad)
}

/// Attitude, velocity and position: columns w, x, y, z, vx, vy, vz, px, py, pz.
#[pyfunction]
#[allow(clippy::needless_pass_by_value, clippy::too_many_arguments)] // what PyO3 extracts; keywords in the package
pub fn dead_reckon<'py>(
    py: Python<'py>,
    start: Quat,
    gyro_rad_s: PyReadonlyArray2<'py, f64>,
    acc_m_s2: PyReadonlyArray2<'py, f64>,
    dt_s: Step<'py>,
    gyro_bias_rad_s: Vec3,
    gravity_m_s2: f64,
    scheme: &str,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let (gyro, acc) = (rows::<3>(&gyro_rad_s, "gyro_rad_s")?, rows::<3>(&acc_m_s2, "acc_m_s2")?);
    let scheme = match scheme {
        "semi-implicit" => Scheme::SemiImplicit,
        "euler" => Scheme::Euler,
        "trapezoid" => Scheme::Trapezoid,
        other => return Err(PyValueError::new_err(format!("there is no scheme {other:?}"))),
    };
    let dt = dt_s.dt()?;
    let states = py.detach(|| -> Result<Vec<MotionState>> {
        let q = Quaternion::from_array(start);
        let mut reckoning = DeadReckoning::new(q, gyro_bias_rad_s, gravity_m_s2, scheme)?;
        let mut states = vec![reckoning.state(); gyro.len()];
        reckoning.run_into(gyro, acc, dt, &mut states)?;
        Ok(states)
    });
    let states = states.map_err(|error| exception("dead_reckon", error))?;
    let row = |s: &MotionState| {
        let ([w, x, y, z], v, p) = (s.world_from_body.to_array(), s.velocity_m_s, s.position_m);
        [w, x, y, z, v[0], v[1], v[2], p[0], p[1], p[2]]
    };
    table(py, states.iter().map(row).collect::<Vec<[f64; 10]>>())
}
