//! The estimator: whole recordings and sample by sample.

use crate::arrays::{Step, rows, table};
use crate::errors::exception;
use crate::threads::SideBySide;
use numpy::{PyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use shisei_core::calibration::{Calibration, SensorModel};
use shisei_core::estimator::{self as core, CALIBRATION_STATES, Sample, State};
use shisei_core::filter::Dt;
use shisei_core::orient::{self as whole, Method, Relative, RestChoice};
use shisei_core::{Error, Vec3};

type Matrix = [Vec3; 3];

/// Gyroscope bias and matrix, accelerometer bias and matrix, and the covariance of what is left where known.
type Known = (Vec3, Matrix, Vec3, Matrix, Option<Vec<[f64; CALIBRATION_STATES]>>);

/// What the estimator starts from, and what corrects the readings before it: one of the two.
fn known(given: Option<Known>) -> PyResult<(Option<core::Calibration>, Option<Calibration>)> {
    match given {
        None => Ok((None, None)),
        Some((gyro_bias, gyro_matrix, acc_bias, acc_matrix, None)) => {
            let calibration = Calibration {
                accelerometer: SensorModel { bias: acc_bias, matrix: acc_matrix },
                gyroscope: SensorModel { bias: gyro_bias, matrix: gyro_matrix },
            };
            let checked = calibration.accelerometer.check().and_then(|()| calibration.gyroscope.check());
            checked.map_err(|error| exception("calibration", error))?;
            Ok((None, Some(calibration)))
        }
        Some((gyro_bias, gyro_matrix, acc_bias, acc_matrix, Some(covariance))) => {
            let covariance = covariance.try_into().map_err(|_| {
                PyValueError::new_err(format!("{CALIBRATION_STATES} rows of covariance needed"))
            })?;
            let calibration = core::Calibration {
                gyro_bias_rad_s: gyro_bias,
                gyro_matrix,
                acc_bias_m_s2: acc_bias,
                acc_matrix,
                covariance,
            };
            calibration.check().map_err(|error| exception("calibration", error))?;
            Ok((Some(calibration), None))
        }
    }
}

/// As [`Known`].
fn learnt(of: &core::Calibration) -> Known {
    let covariance = Some(of.covariance.to_vec());
    (of.gyro_bias_rad_s, of.gyro_matrix, of.acc_bias_m_s2, of.acc_matrix, covariance)
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
    calibration: Option<Known>,
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

/// The estimator, one sample or one stretch of samples at a time.
#[pyclass(module = "shisei._native", name = "EstimatorFilter")]
#[derive(Debug)]
pub struct EstimatorFilter {
    estimator: Box<core::Estimator>,
    correct: Option<Calibration>,
}

#[pymethods]
impl EstimatorFilter {
    #[new]
    fn new(gravity_m_s2: f64, calibration: Option<Known>) -> PyResult<Self> {
        let (calibration, correct) = known(calibration)?;
        let settings = core::Settings { gravity_m_s2, calibration, ..core::Settings::default() };
        let estimator = core::Estimator::new(&settings).map_err(|error| exception("Estimator", error))?;
        Ok(EstimatorFilter { estimator: Box::new(estimator), correct })
    }

    fn update(&mut self, gyro_rad_s: Vec3, acc_m_s2: Vec3, dt_s: f64) -> StateTuple {
        state_tuple(&self.take(gyro_rad_s, acc_m_s2, dt_s))
    }

    #[allow(clippy::needless_pass_by_value)] // what PyO3 extracts
    fn update_all<'py>(
        &mut self,
        py: Python<'py>,
        gyro_rad_s: PyReadonlyArray2<'py, f64>,
        acc_m_s2: PyReadonlyArray2<'py, f64>,
        dt_s: Step<'py>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let (gyro, acc) = (rows::<3>(&gyro_rad_s, "gyro_rad_s")?, rows::<3>(&acc_m_s2, "acc_m_s2")?);
        let dt = equal_lengths(gyro, acc, &dt_s)?;
        let states: Vec<State> = py.detach(|| {
            let samples = gyro.iter().zip(acc).enumerate();
            samples.map(|(k, (&gyro, &acc))| self.take(gyro, acc, dt.at(k))).collect()
        });
        columns(py, &states)
    }

    #[getter]
    fn state(&self) -> StateTuple {
        state_tuple(&self.estimator.state())
    }

    #[getter]
    fn learnt(&self) -> Known {
        learnt(&self.estimator.calibration())
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

impl EstimatorFilter {
    fn take(&mut self, gyro_rad_s: Vec3, acc_m_s2: Vec3, dt_s: f64) -> State {
        self.estimator.update(&corrected(self.correct.as_ref(), gyro_rad_s, acc_m_s2, dt_s))
    }
}

/// The estimator with a delay; spent after `finish`.
#[pyclass(module = "shisei._native", name = "FixedLagFilter")]
#[derive(Debug)]
pub struct FixedLagFilter {
    estimator: Option<Box<core::FixedLag>>,
    correct: Option<Calibration>,
}

#[pymethods]
impl FixedLagFilter {
    #[new]
    fn new(lag_s: f64, gravity_m_s2: f64, calibration: Option<Known>) -> PyResult<Self> {
        let (calibration, correct) = known(calibration)?;
        let settings = core::Settings { gravity_m_s2, calibration, ..core::Settings::default() };
        let estimator =
            core::FixedLag::new(&settings, lag_s).map_err(|error| exception("FixedLag", error))?;
        Ok(FixedLagFilter { estimator: Some(Box::new(estimator)), correct })
    }

    fn update(&mut self, gyro_rad_s: Vec3, acc_m_s2: Vec3, dt_s: f64) -> PyResult<Vec<StateTuple>> {
        let sample = corrected(self.correct.as_ref(), gyro_rad_s, acc_m_s2, dt_s);
        let mut out = Vec::new();
        self.running()?.update(&sample, &mut out);
        Ok(out.iter().map(state_tuple).collect())
    }

    #[allow(clippy::needless_pass_by_value)] // what PyO3 extracts
    fn update_all<'py>(
        &mut self,
        py: Python<'py>,
        gyro_rad_s: PyReadonlyArray2<'py, f64>,
        acc_m_s2: PyReadonlyArray2<'py, f64>,
        dt_s: Step<'py>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let (gyro, acc) = (rows::<3>(&gyro_rad_s, "gyro_rad_s")?, rows::<3>(&acc_m_s2, "acc_m_s2")?);
        let dt = equal_lengths(gyro, acc, &dt_s)?;
        let correct = self.correct;
        let estimator = self.running()?;
        let states = py.detach(|| {
            let mut out = Vec::with_capacity(gyro.len());
            for (k, (&gyro, &acc)) in gyro.iter().zip(acc).enumerate() {
                estimator.update(&corrected(correct.as_ref(), gyro, acc, dt.at(k)), &mut out);
            }
            out
        });
        columns(py, &states)
    }

    fn finish<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.running()?;
        let mut out = Vec::new();
        if let Some(estimator) = self.estimator.take() {
            estimator.finish(&mut out);
        }
        columns(py, &out)
    }
}

impl FixedLagFilter {
    fn running(&mut self) -> PyResult<&mut core::FixedLag> {
        let spent = || PyValueError::new_err("FixedLag: finish() was called; make a new one");
        self.estimator.as_deref_mut().ok_or_else(spent)
    }
}
