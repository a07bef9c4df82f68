//! Calibrations and their application.

use crate::arrays::{rows, table};
use crate::errors::{DomainError, exception};
use numpy::{PyArray2, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use shisei_core::Vec3;
use shisei_core::calibration::gyro_turns::{self, TurnSettings};
use shisei_core::calibration::known_turns::{self as turns, Part, Parts, TurnAngle};
use shisei_core::calibration::recording::{calibrate_poses, find_parts};
use shisei_core::calibration::still::{StillSegment, StillSettings, still_segments};
use shisei_core::calibration::{FaceTable, SensorModel, SixFaceSettings, search_faces, solve};
use shisei_functions::last_error::user_lang;
use shisei_record::calibration::CalibrationFile;

/// A calibration from the text of its file; `name` for the sentence that refuses it.
pub fn read(name: &str, text: &[u8]) -> PyResult<CalibrationFile> {
    let lang = user_lang();
    CalibrationFile::from_json(text)
        .map_err(|error| DomainError::new_err(format!("{name}: {}", error.sentence(lang))))
}

/// Refuses the text of a file that is no calibration.
#[pyfunction]
pub fn check_calibration(name: &str, text: &[u8]) -> PyResult<()> {
    read(name, text).map(drop)
}

/// Finds the faces, then solves; `faces` is there also when the solution is not (`error` says why then).
#[pyfunction]
#[allow(clippy::needless_pass_by_value)] // what PyO3 extracts
pub fn six_face<'py>(
    py: Python<'py>,
    acc_m_s2: PyReadonlyArray2<'py, f64>,
    gyro_rad_s: PyReadonlyArray2<'py, f64>,
    dt_s: f64,
    settings: [f64; 7],
) -> PyResult<Bound<'py, PyDict>> {
    let (acc, gyro) = (rows::<3>(&acc_m_s2, "acc_m_s2")?, rows::<3>(&gyro_rad_s, "gyro_rad_s")?);
    let [window_s, step_s, max_tilt_rad, variance_max, gravity_m_s2, min_acc_scale, max_acc_scale] = settings;
    let settings = SixFaceSettings {
        window_s,
        step_s,
        max_tilt_rad,
        variance_max,
        gravity_m_s2,
        min_acc_scale,
        max_acc_scale,
    };
    let refuse = |error| exception("six_face", error);
    let found = py.detach(|| search_faces(acc, gyro, dt_s, &settings)).map_err(refuse)?;
    let solved = solve(&found, &settings);
    let result = PyDict::new(py);
    result.set_item("faces", faces(py, &found, dt_s)?)?;
    match solved {
        Ok(solved) => {
            let (a, g) = (solved.calibration.accelerometer, solved.calibration.gyroscope);
            result.set_item("acc_bias_m_s2", a.bias)?;
            result.set_item("acc_matrix", a.matrix)?;
            result.set_item("gyro_bias_rad_s", g.bias)?;
            result.set_item("gyro_matrix", g.matrix)?;
            result.set_item("acc_covariance", solved.acc_covariance)?;
            result.set_item("gyro_bias_variance", solved.gyro_bias_variance)?;
        }
        Err(error) => result.set_item("error", refuse(error))?,
    }
    Ok(result)
}

fn faces<'py>(py: Python<'py>, found: &FaceTable, dt_s: f64) -> PyResult<Vec<Bound<'py, PyDict>>> {
    let missing: Vec<_> = found.missing().map(|row| row.face).collect();
    let entry = |row: &shisei_core::calibration::FaceRow| {
        let entry = PyDict::new(py);
        entry.set_item("face", row.face.to_string())?;
        entry.set_item("found", !missing.contains(&row.face))?;
        entry.set_item("start_s", row.window.map(|w| w.start_row as f64 * dt_s))?;
        entry.set_item("worst_variance", row.window.map(|w| w.worst_variance()))?;
        entry.set_item("tilt_rad", row.window.map(|w| w.tilt_rad))?;
        entry.set_item("mean_norm_m_s2", row.window.map(|w| w.mean_norm()))?;
        Ok(entry)
    };
    found.faces.iter().map(entry).collect()
}

/// `matrix (raw − bias)` of every row.
#[pyfunction]
#[allow(clippy::needless_pass_by_value)] // what PyO3 extracts
pub fn apply<'py>(
    py: Python<'py>,
    raw: PyReadonlyArray2<'py, f64>,
    bias: Vec3,
    matrix: [Vec3; 3],
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let raw = rows::<3>(&raw, "raw")?;
    let mut out = vec![[0.0; 3]; raw.len()];
    py.detach(|| SensorModel { bias, matrix }.apply_series(raw, &mut out))
        .map_err(|error| exception("apply", error))?;
    table(py, out)
}

/// Nine accelerometer parameters from many poses, and the gyroscope's matrix from the turns between them where
/// `gyro_from_turns` asks for it.
#[pyfunction]
#[allow(clippy::needless_pass_by_value)] // what PyO3 extracts
pub fn multi_pose<'py>(
    py: Python<'py>,
    acc_m_s2: PyReadonlyArray2<'py, f64>,
    gyro_rad_s: PyReadonlyArray2<'py, f64>,
    dt_s: f64,
    gravity_m_s2: f64,
    gyro_from_turns: bool,
) -> PyResult<Bound<'py, PyDict>> {
    let (acc, gyro) = (rows::<3>(&acc_m_s2, "acc_m_s2")?, rows::<3>(&gyro_rad_s, "gyro_rad_s")?);
    let refuse = |error: shisei_core::Error| exception("multi_pose", error);
    let (found, turns) = py
        .detach(|| {
            let found = calibrate_poses(acc, gyro, dt_s, gravity_m_s2, None)?;
            let accelerometer = &found.calibration.accelerometer;
            let turns = gyro_from_turns
                .then(|| {
                    gyro_turns::calibrate(
                        gyro,
                        dt_s,
                        &found.segments,
                        accelerometer,
                        &TurnSettings::default(),
                    )
                })
                .transpose()?;
            Ok((found, turns))
        })
        .map_err(refuse)?;
    let c = &found.calibration;
    let result = PyDict::new(py);
    result.set_item("acc_bias_m_s2", c.accelerometer.bias)?;
    result.set_item("acc_matrix", c.accelerometer.matrix)?;
    result.set_item("acc_sigma", c.sigma)?;
    result.set_item("acc_covariance", c.covariance)?;
    result.set_item("residual_rms_m_s2", c.residual_rms)?;
    result.set_item("held_out_rms_m_s2", Some(c.held_out_rms).filter(|x| x.is_finite()))?;
    result.set_item("poses_m_s2", table(py, found.segments.iter().map(|s| s.acc_mean).collect())?)?;
    result.set_item("rows", found.segments.iter().map(|s| (s.start, s.end)).collect::<Vec<_>>())?;
    result.set_item("suggested_up", c.suggest(3).iter().map(|s| s.up_body).collect::<Vec<_>>())?;
    if let Some(turns) = turns {
        result.set_item("gyro_bias_rad_s", turns.gyroscope.bias)?;
        result.set_item("gyro_matrix", turns.gyroscope.matrix)?;
        result.set_item("gyro_sigma", turns.sigma)?;
        result.set_item("turn_residual_rms_rad", turns.residual_rms_rad)?;
    } else {
        let rows: usize = found.segments.iter().map(StillSegment::rows).sum();
        let mean = |axis: usize| {
            found.segments.iter().map(|s| s.rows() as f64 * s.gyro_mean[axis]).sum::<f64>()
                / rows.max(1) as f64
        };
        result.set_item("gyro_bias_rad_s", [mean(0), mean(1), mean(2)])?;
        result.set_item("gyro_matrix", SensorModel::IDENTITY.matrix)?;
    }
    Ok(result)
}

/// Both sensors from six faces and three known turns. `parts` are (start, end) rows in the order up x y z, down x y
/// z, turn x y z; without them they are found.
#[pyfunction]
#[allow(clippy::needless_pass_by_value, clippy::too_many_arguments)] // what PyO3 extracts; keywords in the package
pub fn known_turns<'py>(
    py: Python<'py>,
    acc: PyReadonlyArray2<'py, f64>,
    gyro: PyReadonlyArray2<'py, f64>,
    dt_s: f64,
    turn_rad: f64,
    signed: bool,
    gravity_m_s2: f64,
    parts: Option<[(usize, usize); 9]>,
) -> PyResult<Bound<'py, PyDict>> {
    let (acc, gyro) = (rows::<3>(&acc, "acc")?, rows::<3>(&gyro, "gyro")?);
    let angle = if signed { TurnAngle::Signed(turn_rad) } else { TurnAngle::Size(turn_rad) };
    let found = py.detach(|| {
        let part = |(start, end): (usize, usize)| Part {
            acc: acc.get(start..end).unwrap_or(&[]),
            gyro: gyro.get(start..end).unwrap_or(&[]),
        };
        let parts = match parts {
            Some(p) => Parts {
                up: [part(p[0]), part(p[1]), part(p[2])],
                down: [part(p[3]), part(p[4]), part(p[5])],
                turn: [part(p[6]), part(p[7]), part(p[8])],
            },
            None => find_parts(acc, gyro, &still_segments(acc, gyro, dt_s, &StillSettings::default())?)?,
        };
        turns::calibrate(&parts, dt_s, angle, gravity_m_s2)
    });
    let found = found.map_err(|error: shisei_core::Error| exception("known_turns", error))?;
    let result = PyDict::new(py);
    result.set_item("acc_bias", found.accelerometer.bias)?;
    result.set_item("acc_matrix", found.accelerometer.matrix)?;
    result.set_item("gyro_bias", found.gyroscope.bias)?;
    result.set_item("gyro_matrix", found.gyroscope.matrix)?;
    result.set_item("acc_bias_sigma", found.acc_bias_sigma)?;
    result.set_item("acc_matrix_sigma", found.acc_matrix_sigma)?;
    result.set_item("gyro_bias_sigma", found.gyro_bias_sigma)?;
    result.set_item("gyro_matrix_sigma", found.gyro_matrix_sigma)?;
    result.set_item("gyro_per_acceleration", found.gyro_per_acceleration)?;
    Ok(result)
}
