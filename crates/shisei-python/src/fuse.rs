//! Takes, recordings, and the two brought together.

use crate::arrays::{rows, table};
use crate::errors::{DomainError, ShapeError, exception};
use numpy::{PyArray1, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use shisei_core::frames::{Axes, Pose};
use shisei_core::fuse::{FuseSettings, Fusion, Inertial, Optical, fuse_with_markers};
use shisei_core::sync::rates::{RatesSettings, Start};
use shisei_core::{Error, Quaternion, Vec3};
use shisei_functions::last_error::user_lang;
use shisei_record::motive::{self, LossRule};
use shisei_record::{Input, Names, Note, Options, with_names};

/// One body of a Motive take; lost frames are NaN.
#[pyfunction]
pub fn read_motive<'py>(
    py: Python<'py>,
    bytes: &[u8],
    name: &str,
    body: Option<&str>,
    frozen: usize,
) -> PyResult<Bound<'py, PyDict>> {
    let refuse = |error: motive::Error| DomainError::new_err(error.sentence(user_lang()));
    let (take, body, time_s, tracked, markers) = py
        .detach(|| {
            let take = motive::read(&Input { name, bytes })?;
            let body = take.body(body)?;
            let time_s = take.time_s()?;
            let rule = LossRule { frozen_run: (frozen > 0).then_some(frozen) };
            let tracked = take.tracked(&body, rule);
            let of = |marker: motive::Marker| {
                let seen = take.sightings(&marker, rule).into_iter();
                let rows: Vec<Vec3> = seen.map(|place| place.unwrap_or([f64::NAN; 3])).collect();
                (marker.name, rows)
            };
            let markers: Vec<(String, Vec<Vec3>)> = take.markers_of(&body)?.into_iter().map(of).collect();
            Ok((take, body, time_s, tracked, markers))
        })
        .map_err(refuse)?;
    let poses = (0..take.len()).map(|row| take.pose(&body, row).filter(|_| tracked[row]));
    let (position_m, q_wxyz): (Vec<Vec3>, Vec<[f64; 4]>) = poses.map(numbers).unzip();
    let result = PyDict::new(py);
    result.set_item("name", &body.name)?;
    result.set_item("axes", take.axes().name())?;
    result.set_item("frame", PyArray1::from_vec(py, take.frame))?;
    result.set_item("time_s", PyArray1::from_vec(py, time_s))?;
    result.set_item("position_m", table::<3>(py, position_m)?)?;
    result.set_item("q_wxyz", table::<4>(py, q_wxyz)?)?;
    let by_name = PyDict::new(py);
    for (name, rows) in markers {
        by_name.set_item(name, table::<3>(py, rows)?)?;
    }
    result.set_item("markers_m", by_name)?;
    Ok(result)
}

/// An inertial recording of one file or two.
/// `said`: `columns`, `units`, `axes`, `scale`, as the command line takes them.
#[pyfunction]
#[allow(clippy::needless_pass_by_value)] // what PyO3 extracts
pub fn read_recording(
    py: Python<'_>,
    files: Vec<(String, Vec<u8>)>,
    said: Vec<(String, String)>,
    rate_hz: Option<f64>,
    sensor: Option<String>,
    skip_bad_rows: bool,
) -> PyResult<Bound<'_, PyDict>> {
    let lang = user_lang();
    let refuse = |error: shisei_record::Error| DomainError::new_err(in_python(&error.sentence(lang)));
    let mut options = Options { rate_hz, sensor, skip_bad_rows, ..Options::default() };
    for (name, text) in &said {
        options.set(name, text).map_err(refuse)?;
    }
    let inputs: Vec<Input<'_>> = files.iter().map(|(name, bytes)| Input { name, bytes }).collect();
    let recording = py.detach(|| shisei_record::open(&inputs, &options)).map_err(refuse)?;
    let sentences =
        |notes: &[Note]| -> Vec<String> { notes.iter().map(|note| in_python(note.sentence(lang))).collect() };
    let result = PyDict::new(py);
    result.set_item("assumptions", sentences(&recording.assumptions))?;
    result.set_item("warnings", sentences(&recording.warnings))?;
    result.set_item("rate_hz", recording.findings.rate_hz)?;
    result.set_item("time_s", PyArray1::from_vec(py, recording.time_s))?;
    result.set_item("dt_s", PyArray1::from_vec(py, recording.dt_s))?;
    result.set_item("acc_m_s2", table::<3>(py, recording.acc_m_s2)?)?;
    result.set_item("gyro_rad_s", table::<3>(py, recording.gyro_rad_s)?)?;
    Ok(result)
}

/// With the package's names for the command line's options.
pub fn in_python(sentence: &str) -> String {
    with_names(sentence, Names { rate: "rate_hz", skip_bad_rows: "skip_bad_rows", gravity: "gravity_m_s2" })
}

fn numbers(pose: Option<Pose>) -> (Vec3, [f64; 4]) {
    pose.map_or(([f64::NAN; 3], [f64::NAN; 4]), |pose| (pose.position_m, pose.world_from_body.to_array()))
}

/// The poses of rows of numbers; none where one of them is not a number.
fn poses(position_m: &[Vec3], q_wxyz: &[[f64; 4]]) -> PyResult<Vec<Option<Pose>>> {
    if position_m.len() != q_wxyz.len() {
        let error = Error::LengthMismatch { first: position_m.len(), second: q_wxyz.len() };
        return Err(exception("fuse", error));
    }
    let of = |(row, (p, q)): (usize, (&Vec3, &[f64; 4]))| {
        if p.iter().chain(q).any(|x| x.is_nan()) {
            return Ok(None);
        }
        let world_from_body = Quaternion::new(q[0], q[1], q[2], q[3]).try_normalized();
        let world_from_body = world_from_body.map_err(|error| exception("fuse", error.at_row(row)))?;
        Ok(Some(Pose { position_m: *p, world_from_body }))
    };
    position_m.iter().zip(q_wxyz).enumerate().map(of).collect()
}

fn column<'a>(array: &'a PyReadonlyArray1<'_, f64>, name: &str) -> PyResult<&'a [f64]> {
    array.as_slice().map_err(|_| ShapeError::new_err(format!("{name} is not contiguous")))
}

/// A take and a recording brought together. `near_s` is the clock offset where it is known to 0.1 s.
#[pyfunction]
#[allow(clippy::needless_pass_by_value, clippy::too_many_arguments)] // what PyO3 extracts; keywords in the package
pub fn fuse<'py>(
    py: Python<'py>,
    optical_s: PyReadonlyArray1<'py, f64>,
    position_m: PyReadonlyArray2<'py, f64>,
    q_wxyz: PyReadonlyArray2<'py, f64>,
    sensor_s: PyReadonlyArray1<'py, f64>,
    acc_m_s2: PyReadonlyArray2<'py, f64>,
    gyro_rad_s: PyReadonlyArray2<'py, f64>,
    axes: &str,
    gravity_m_s2: f64,
    near_s: Option<f64>,
    markers_m: Vec<PyReadonlyArray2<'py, f64>>,
) -> PyResult<Bound<'py, PyDict>> {
    let poses = poses(rows::<3>(&position_m, "position_m")?, rows::<4>(&q_wxyz, "q_wxyz")?)?;
    let axes = Axes::from_name(axes).filter(|axes| *axes != Axes::UnityYUp);
    let axes = axes.ok_or_else(|| DomainError::new_err("axes must be 'y-up' or 'z-up'"))?;
    let start = near_s.map_or(Start::Search, Start::Near);
    let settings = FuseSettings {
        rates: RatesSettings { start, ..RatesSettings::default() },
        axes,
        gravity_m_s2,
        ..FuseSettings::default()
    };
    let optical = Optical { time_s: column(&optical_s, "time_s")?, poses: &poses };
    let inertial = Inertial {
        time_s: column(&sensor_s, "time_s")?,
        acc_m_s2: rows::<3>(&acc_m_s2, "acc_m_s2")?,
        gyro_rad_s: rows::<3>(&gyro_rad_s, "gyro_rad_s")?,
    };
    let mut markers: Vec<Vec<Option<Vec3>>> = Vec::with_capacity(markers_m.len());
    for marker in &markers_m {
        let seen = rows::<3>(marker, "markers_m")?.iter();
        markers.push(seen.map(|place| (!place.iter().any(|x| x.is_nan())).then_some(*place)).collect());
    }
    let markers: Vec<&[Option<Vec3>]> = markers.iter().map(Vec::as_slice).collect();
    let fusion = py.detach(|| fuse_with_markers(&optical, &markers, &inertial, &settings));
    told(py, &fusion.map_err(|error| exception("fuse", error))?)
}

fn told<'py>(py: Python<'py>, fusion: &Fusion) -> PyResult<Bound<'py, PyDict>> {
    let frames = &fusion.frames;
    let (position_m, q_wxyz): (Vec<Vec3>, Vec<[f64; 4]>) =
        frames.iter().map(|frame| numbers(frame.pose)).unzip();
    let result = PyDict::new(py);
    result.set_item("position_m", table::<3>(py, position_m)?)?;
    result.set_item("q_wxyz", table::<4>(py, q_wxyz)?)?;
    result.set_item("source", frames.iter().map(|frame| frame.source.name()).collect::<Vec<_>>())?;
    result.set_item("gap_s", PyArray1::from_vec(py, frames.iter().map(|f| f.gap_s).collect()))?;
    result.set_item("sigma_rad", PyArray1::from_vec(py, frames.iter().map(|f| f.sigma_rad).collect()))?;
    result.set_item("sigma_m", PyArray1::from_vec(py, frames.iter().map(|f| f.sigma_m).collect()))?;
    let gaps = fusion
        .gaps
        .iter()
        .map(|gap| (gap.first, gap.end, gap.length_s, gap.source.name(), gap.sigma_rad, gap.sigma_m));
    result.set_item("gaps", gaps.collect::<Vec<_>>())?;
    let sync = PyDict::new(py);
    sync.set_item("offset_s", fusion.sync.offset_s)?;
    sync.set_item("sigma_offset_s", fusion.sync.sigma_offset_s)?;
    sync.set_item("skew", fusion.sync.skew)?;
    sync.set_item("sigma_skew", fusion.sync.sigma_skew)?;
    sync.set_item("body_from_sensor", fusion.sync.body_from_sensor.to_array())?;
    sync.set_item("sigma_mounting_rad", fusion.sync.sigma_mounting_rad)?;
    sync.set_item("explained", fusion.sync.explained)?;
    sync.set_item("runner_up", fusion.sync.runner_up)?;
    result.set_item("sync", sync)?;
    result.set_item("lever_arm_m", fusion.lever.map(|lever| lever.sensor_m))?;
    result.set_item("sigma_lever_arm_m", fusion.lever.map(|lever| lever.sigma_m))?;
    result.set_item("up", fusion.up)?;
    let places = fusion.held.places.iter().map(|place| place.map(|place| (place.at_m, place.sigma_m)));
    result.set_item("places", places.collect::<Vec<_>>())?;
    result.set_item("held", fusion.held.frames.clone())?;
    Ok(result)
}
