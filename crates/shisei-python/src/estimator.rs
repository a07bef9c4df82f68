//! The estimator: whole recordings and sample by sample.

use crate::arrays::{Step, rows, table};
use crate::calibration;
use crate::errors::exception;
use crate::threads::{SideBySide, turn, turn_without_gil};
use numpy::{PyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use shisei_core::calibration::Calibration;
use shisei_core::estimator::{self as core, CALIBRATION_STATES, Sample, State};
use shisei_core::filter::Dt;
use shisei_core::orient::{self as whole, Method, Relative, RestChoice};
use shisei_core::{Error, Lang, Vec3};
use shisei_functions::last_error::user_lang;
use std::sync::Mutex;

type Matrix = [Vec3; 3];

/// What the estimator starts from, and what corrects the readings before it: one of the two. `text` is that of a
/// calibration file.
fn known(text: Option<&str>) -> PyResult<(Option<core::Calibration>, Option<Calibration>)> {
    let Some(text) = text else { return Ok((None, None)) };
    let file = calibration::read("calibration", text.as_bytes())?;
    let Some(learnt) = file.learnt() else { return Ok((None, Some(file.calibration))) };
    learnt.check().map_err(|error| exception("calibration", error))?;
    Ok((Some(learnt), None))
}

/// Gyroscope bias and matrix, accelerometer bias and matrix, and the covariance of what is left.
type Learnt = (Vec3, Matrix, Vec3, Matrix, Vec<[f64; CALIBRATION_STATES]>);

fn learnt(of: &core::Calibration) -> Learnt {
    (of.gyro_bias_rad_s, of.gyro_matrix, of.acc_bias_m_s2, of.acc_matrix, of.covariance.to_vec())
}

/// A whole recording. `rest_rows` are (start, end); without them the rest is found where `auto_rest` says so.
#[pyfunction]
#[allow(clippy::needless_pass_by_value, clippy::too_many_arguments)] // what PyO3 extracts; keywords in the package
pub fn estimate<'py>(
    py: Python<'py>,
    gyro_rad_s: PyReadonlyArray2<'py, f64>,
    acc_m_s2: PyReadonlyArray2<'py, f64>,
    dt_s: Step<'py>,
    online: bool,
    auto_rest: bool,
    rest_rows: Option<(usize, usize)>,
    forward_axis_body: Option<Vec3>,
    gravity_m_s2: f64,
    calibration: Option<&str>,
) -> PyResult<Bound<'py, PyDict>> {
    let (gyro, acc) = (rows::<3>(&gyro_rad_s, "gyro_rad_s")?, rows::<3>(&acc_m_s2, "acc_m_s2")?);
    let (sensor, correct) = known(calibration)?;
    let rest = match rest_rows {
        Some((start, end)) => RestChoice::Rows { start, end },
        None if auto_rest => RestChoice::Auto,
        None => RestChoice::None,
    };
    let settings = whole::Settings {
        method: if online { Method::EstimateOnline } else { Method::Estimate },
        rest,
        relative: Relative::None,
        forward_axis_body,
        gravity_m_s2,
        sensor,
    };
    let steps = dt_s.per_row(gyro.len())?;
    let dt = &*steps;
    let found = py
        .detach(|| {
            let Some(correct) = correct else {
                return whole::orient_with(acc, gyro, dt, &settings, &SideBySide);
            };
            let (mut corrected_acc, mut corrected_gyro) =
                (vec![[0.0; 3]; acc.len()], vec![[0.0; 3]; gyro.len()]);
            correct.accelerometer.apply_series(acc, &mut corrected_acc)?;
            correct.gyroscope.apply_series(gyro, &mut corrected_gyro)?;
            whole::orient_with(&corrected_acc, &corrected_gyro, dt, &settings, &SideBySide)
        })
        .map_err(|error| exception("estimate", error))?;
    let result = PyDict::new(py);
    let quats = found.world_from_body.into_iter().map(shisei_core::Quaternion::to_array).collect();
    result.set_item("q_wxyz", table::<4>(py, quats)?)?;
    result.set_item("start", found.start.to_array())?;
    result.set_item("rest_rows", found.rest.map(|r| (r.start, r.end)))?;
    if let Some(certainty) = found.certainty {
        result.set_item("sigma_tilt_rad", PyArray1::from_vec(py, certainty.sigma_tilt_rad))?;
        result.set_item("sigma_heading_rad", PyArray1::from_vec(py, certainty.sigma_heading_rad))?;
        result.set_item("rest", PyArray1::from_vec(py, certainty.rest))?;
    }
    result.set_item("learnt", found.learnt.as_ref().map(learnt))?;
    Ok(result)
}

/// Attitude, rate, gyroscope bias, standard deviations of tilt and heading, covariance, rest.
type StateTuple = ([f64; 4], Vec3, Vec3, f64, f64, Matrix, bool);

fn state_tuple(s: &State) -> StateTuple {
    let q = s.world_from_body.to_array();
    (q, s.rate_rad_s, s.gyro_bias_rad_s, s.sigma_tilt_rad, s.sigma_heading_rad, s.covariance_rad2, s.rest)
}

/// The estimator, one sample or one stretch of samples at a time; threads take turns.
#[pyclass(module = "shisei._native", name = "EstimatorFilter", frozen)]
#[derive(Debug)]
pub struct EstimatorFilter {
    estimator: Mutex<Box<core::Estimator>>,
    correct: Option<Calibration>,
}

#[pymethods]
impl EstimatorFilter {
    #[new]
    fn new(gravity_m_s2: f64, calibration: Option<&str>) -> PyResult<Self> {
        let (calibration, correct) = known(calibration)?;
        let settings = core::Settings { gravity_m_s2, calibration, ..core::Settings::default() };
        let estimator = core::Estimator::new(&settings).map_err(|error| exception("Estimator", error))?;
        Ok(EstimatorFilter { estimator: Mutex::new(Box::new(estimator)), correct })
    }

    fn update(&self, py: Python<'_>, gyro_rad_s: Vec3, acc_m_s2: Vec3, dt_s: f64) -> StateTuple {
        let sample = corrected(self.correct.as_ref(), gyro_rad_s, acc_m_s2, dt_s);
        state_tuple(&turn(&self.estimator, py).update(&sample))
    }

    #[allow(clippy::needless_pass_by_value)] // what PyO3 extracts
    fn update_all<'py>(
        &self,
        py: Python<'py>,
        gyro_rad_s: PyReadonlyArray2<'py, f64>,
        acc_m_s2: PyReadonlyArray2<'py, f64>,
        dt_s: Step<'py>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let (gyro, acc) = (rows::<3>(&gyro_rad_s, "gyro_rad_s")?, rows::<3>(&acc_m_s2, "acc_m_s2")?);
        let dt = equal_lengths(gyro, acc, &dt_s)?;
        let states: Vec<State> = py.detach(|| {
            let mut estimator = turn_without_gil(&self.estimator);
            let samples = gyro.iter().zip(acc).enumerate();
            let correct = self.correct.as_ref();
            samples
                .map(|(k, (&gyro, &acc))| estimator.update(&corrected(correct, gyro, acc, dt.at(k))))
                .collect()
        });
        columns(py, &states)
    }

    #[getter]
    fn state(&self, py: Python<'_>) -> StateTuple {
        state_tuple(&turn(&self.estimator, py).state())
    }

    #[getter]
    fn learnt(&self, py: Python<'_>) -> Learnt {
        learnt(&turn(&self.estimator, py).calibration())
    }
}

/// The steps, where there are as many as samples of both sensors.
fn equal_lengths<'a>(gyro: &[Vec3], acc: &[Vec3], dt_s: &'a Step<'_>) -> PyResult<Dt<'a>> {
    let dt = dt_s.dt()?;
    let steps = match dt {
        Dt::PerSample(steps) => steps.len(),
        Dt::Constant(_) => gyro.len(),
    };
    for second in [acc.len(), steps] {
        if second != gyro.len() {
            return Err(exception("update_all", Error::LengthMismatch { first: gyro.len(), second }));
        }
    }
    Ok(dt)
}

/// States as arrays, one row a state.
fn columns<'py>(py: Python<'py>, states: &[State]) -> PyResult<Bound<'py, PyDict>> {
    let result = PyDict::new(py);
    let series = |of: fn(&State) -> f64| PyArray1::from_vec(py, states.iter().map(of).collect());
    let vectors = |of: fn(&State) -> Vec3| table::<3>(py, states.iter().map(of).collect());
    let quats = states.iter().map(|s| s.world_from_body.to_array()).collect();
    result.set_item("q_wxyz", table::<4>(py, quats)?)?;
    result.set_item("rate_rad_s", vectors(|s| s.rate_rad_s)?)?;
    result.set_item("gyro_bias_rad_s", vectors(|s| s.gyro_bias_rad_s)?)?;
    result.set_item("sigma_tilt_rad", series(|s| s.sigma_tilt_rad))?;
    result.set_item("sigma_heading_rad", series(|s| s.sigma_heading_rad))?;
    result.set_item("rest", PyArray1::from_vec(py, states.iter().map(|s| s.rest).collect()))?;
    Ok(result)
}

fn corrected(correct: Option<&Calibration>, gyro_rad_s: Vec3, acc_m_s2: Vec3, dt_s: f64) -> Sample {
    match correct {
        Some(correct) => Sample {
            gyro_rad_s: correct.gyroscope.apply(gyro_rad_s),
            acc_m_s2: correct.accelerometer.apply(acc_m_s2),
            dt_s,
        },
        None => Sample { gyro_rad_s, acc_m_s2, dt_s },
    }
}

/// The estimator with a delay; spent after `finish`. Threads take turns.
#[pyclass(module = "shisei._native", name = "FixedLagFilter", frozen)]
#[derive(Debug)]
pub struct FixedLagFilter {
    estimator: Mutex<Option<Box<core::FixedLag>>>,
    correct: Option<Calibration>,
}

#[pymethods]
impl FixedLagFilter {
    #[new]
    fn new(lag_s: f64, gravity_m_s2: f64, calibration: Option<&str>) -> PyResult<Self> {
        let (calibration, correct) = known(calibration)?;
        let settings = core::Settings { gravity_m_s2, calibration, ..core::Settings::default() };
        let estimator =
            core::FixedLag::new(&settings, lag_s).map_err(|error| exception("FixedLag", error))?;
        Ok(FixedLagFilter { estimator: Mutex::new(Some(Box::new(estimator))), correct })
    }

    fn update(
        &self,
        py: Python<'_>,
        gyro_rad_s: Vec3,
        acc_m_s2: Vec3,
        dt_s: f64,
    ) -> PyResult<Vec<StateTuple>> {
        let sample = corrected(self.correct.as_ref(), gyro_rad_s, acc_m_s2, dt_s);
        let mut out = Vec::new();
        turn(&self.estimator, py).as_mut().ok_or_else(spent)?.update(&sample, &mut out);
        Ok(out.iter().map(state_tuple).collect())
    }

    #[allow(clippy::needless_pass_by_value)] // what PyO3 extracts
    fn update_all<'py>(
        &self,
        py: Python<'py>,
        gyro_rad_s: PyReadonlyArray2<'py, f64>,
        acc_m_s2: PyReadonlyArray2<'py, f64>,
        dt_s: Step<'py>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let (gyro, acc) = (rows::<3>(&gyro_rad_s, "gyro_rad_s")?, rows::<3>(&acc_m_s2, "acc_m_s2")?);
        let dt = equal_lengths(gyro, acc, &dt_s)?;
        let correct = self.correct.as_ref();
        let states = py.detach(|| {
            let mut running = turn_without_gil(&self.estimator);
            let estimator = running.as_mut()?;
            let mut out = Vec::with_capacity(gyro.len());
            for (k, (&gyro, &acc)) in gyro.iter().zip(acc).enumerate() {
                estimator.update(&corrected(correct, gyro, acc, dt.at(k)), &mut out);
            }
            Some(out)
        });
        columns(py, &states.ok_or_else(spent)?)
    }

    fn finish<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let estimator = turn(&self.estimator, py).take().ok_or_else(spent)?;
        let mut out = Vec::new();
        estimator.finish(&mut out);
        columns(py, &out)
    }
}

fn spent() -> PyErr {
    PyValueError::new_err(match user_lang() {
        Lang::En => "FixedLag: finish() was called; make a new one",
        Lang::Ja => "FixedLag: finish() が呼ばれた後は使えません。新しく作ってください",
    })
}
