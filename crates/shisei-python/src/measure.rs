//! Long measurements at rest (Allan deviation, spheres, the Earth's rotation) and motion between rests.

use crate::arrays::{Step, rows, table};
use crate::errors::{ShapeError, exception};
use numpy::{PyArray1, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use shisei_core::allan::{self, Coefficient, Point};
use shisei_core::earth::Weights;
use shisei_core::earth::analysis::{Believed, analyse};
use shisei_core::earth::direction::{Direction, summarise};
use shisei_core::earth::fits::Measured;
use shisei_core::motion::foot::{self, FootSettings};
use shisei_core::motion::navigation::{GivenEnd, NavigationSettings, Phase, Track};
use shisei_core::motion::rest_to_rest::{self, RestToRestSettings};
use shisei_core::{Error, Vec3, sphere};

fn column<'a>(array: &'a PyReadonlyArray1<'_, f64>, name: &str) -> PyResult<&'a [f64]> {
    array.as_slice().map_err(|_| ShapeError::new_err(format!("{name} is not contiguous")))
}

/// Curve and noise coefficients of one axis.
#[pyfunction]
#[allow(clippy::needless_pass_by_value)] // what PyO3 extracts
pub fn allan_deviation<'py>(
    py: Python<'py>,
    data: PyReadonlyArray1<'py, f64>,
    dt_s: f64,
) -> PyResult<Bound<'py, PyDict>> {
    let data = column(&data, "data")?;
    let found =
        py.detach(|| allan::analyse(data, dt_s)).map_err(|error| exception("allan_deviation", error))?;
    let pair = |c: Coefficient| (c.value, c.sigma);
    let result = PyDict::new(py);
    result.set_item("quantisation", pair(found.quantisation))?;
    result.set_item("random_walk", pair(found.random_walk))?;
    result.set_item("bias_instability", pair(found.bias_instability))?;
    result.set_item("rate_random_walk", pair(found.rate_random_walk))?;
    result.set_item("floor", found.floor)?;
    result.set_item("floor_tau_s", found.floor_tau_s)?;
    result.set_item("floor_reached", found.floor_reached)?;
    result.set_item("recommended_s", found.recommended_s)?;
    let curve = found.curve;
    let series = |of: fn(&Point) -> f64| PyArray1::from_vec(py, curve.iter().map(of).collect());
    result.set_item("tau_s", series(|p| p.tau_s))?;
    result.set_item("deviation", series(|p| p.deviation))?;
    result.set_item("low", series(|p| p.low))?;
    result.set_item("high", series(|p| p.high))?;
    result.set_item("degrees_of_freedom", series(|p| p.degrees_of_freedom))?;
    Ok(result)
}

/// Centre, radius, residual, standard error of the radius, condition number, distance from the best plane.
#[pyfunction]
#[allow(clippy::needless_pass_by_value)] // what PyO3 extracts
pub fn fit_sphere(
    py: Python<'_>,
    points: PyReadonlyArray2<'_, f64>,
) -> PyResult<(Vec3, f64, f64, Option<f64>, f64, f64)> {
    let points = rows::<3>(&points, "points")?;
    let fit = py.detach(|| sphere::fit_sphere(points)).map_err(|error| exception("fit_sphere", error))?;
    Ok((fit.center, fit.radius, fit.residual_rms, fit.radius_sigma, fit.condition, fit.plane_rms))
}

/// The judgement of an Earth-rate measurement: mean rates, and what else is known of each direction.
#[pyfunction]
#[allow(clippy::needless_pass_by_value)] // what PyO3 extracts
pub fn earth_rate<'py>(
    py: Python<'py>,
    gyro_rad_s: PyReadonlyArray2<'py, f64>,
    sigma_rad_s: Option<PyReadonlyArray2<'py, f64>>,
    acc_m_s2: Option<PyReadonlyArray2<'py, f64>>,
    latitude_rad: Option<f64>,
) -> PyResult<Bound<'py, PyDict>> {
    let gyro = rows::<3>(&gyro_rad_s, "gyro_rad_s")?;
    let sigma = sigma_rad_s.as_ref().map(|a| rows::<3>(a, "sigma_rad_s")).transpose()?;
    let acc = acc_m_s2.as_ref().map(|a| rows::<3>(a, "acc_m_s2")).transpose()?;
    let refuse = |error| exception("earth_rate", error);
    for other in [sigma, acc].into_iter().flatten() {
        if other.len() != gyro.len() {
            return Err(refuse(Error::LengthMismatch { first: gyro.len(), second: other.len() }));
        }
        if let Some(row) = other.iter().position(|v| v.iter().any(|x| !x.is_finite())) {
            return Err(refuse(Error::NotFinite { row }));
        }
    }
    let direction = |(k, &gyro_rad_s): (usize, &Vec3)| Direction {
        gyro_rad_s,
        sigma_rad_s: sigma.map(|s| s[k]),
        acc_m_s2: acc.map(|a| a[k]),
        heading_rad: None,
    };
    let directions: Vec<Direction> = gyro.iter().enumerate().map(direction).collect();
    let found = py.detach(|| analyse(&directions, latitude_rad)).map_err(refuse)?;
    let pair = |m: Option<Measured>| m.map(|m| (m.value, m.sigma));
    let result = PyDict::new(py);
    let fit = match found.believed {
        Believed::Sphere => "sphere",
        Believed::LevelledWithLatitude | Believed::LevelledFree => "levelled",
        Believed::CircleWithLatitude | Believed::Circle => "circle",
    };
    result.set_item("fit", fit)?;
    result.set_item("rate_rad_s", pair(found.rate))?;
    result.set_item("horizontal_rad_s", pair(found.horizontal))?;
    result.set_item("latitude_rad", pair(found.latitude))?;
    result.set_item("sidereal_day_h", pair(found.day_h))?;
    result.set_item("gyro_bias_rad_s", found.bias_rad_s)?;
    let headings: Vec<_> =
        found.headings.iter().map(|h| [h.heading_rad.value, h.heading_rad.sigma]).collect();
    result
        .set_item("heading_rad", if headings.is_empty() { None } else { Some(table::<2>(py, headings)?) })?;
    result.set_item("flat", found.plane.flat)?;
    result.set_item("condition", found.plane.condition)?;
    result.set_item("flat_probability", found.plane.probability)?;
    Ok(result)
}

/// Mean rate and acceleration of one recording at rest.
#[pyfunction]
#[allow(clippy::needless_pass_by_value)] // what PyO3 extracts
pub fn mean_rate<'py>(
    py: Python<'py>,
    gyro_rad_s: PyReadonlyArray2<'py, f64>,
    acc_m_s2: Option<PyReadonlyArray2<'py, f64>>,
    dt_s: Step<'py>,
    as_measured: bool,
) -> PyResult<Bound<'py, PyDict>> {
    let refuse = |error| exception("mean_rate", error);
    let gyro = rows::<3>(&gyro_rad_s, "gyro_rad_s")?;
    let acc = acc_m_s2.as_ref().map(|a| rows::<3>(a, "acc_m_s2")).transpose()?.unwrap_or(&[]);
    if acc_m_s2.is_some() && acc.len() != gyro.len() {
        return Err(refuse(Error::LengthMismatch { first: gyro.len(), second: acc.len() }));
    }
    if let Some(row) = acc.iter().position(|a| a.iter().any(|x| !x.is_finite())) {
        return Err(refuse(Error::NotFinite { row }));
    }
    let steps = dt_s.per_row(gyro.len())?;
    let dt = &*steps;
    let weights = if as_measured { Weights::AsMeasured } else { Weights::Capped };
    let found = py.detach(|| summarise(gyro, acc, &[], dt, weights)).map_err(refuse)?;
    let result = PyDict::new(py);
    result.set_item("gyro_rad_s", found.direction.gyro_rad_s)?;
    result.set_item("sigma_rad_s", found.direction.sigma_rad_s)?;
    result.set_item("acc_m_s2", found.direction.acc_m_s2)?;
    result.set_item("span_s", found.mean.span_s)?;
    result.set_item("long_steps", found.mean.long_steps)?;
    Ok(result)
}

/// Velocity and position: between rests, or with the sensor on a foot where `on_foot` says so.
#[pyfunction]
#[allow(clippy::needless_pass_by_value, clippy::too_many_arguments)] // what PyO3 extracts; keywords in the package
pub fn navigate<'py>(
    py: Python<'py>,
    on_foot: bool,
    gyro_rad_s: PyReadonlyArray2<'py, f64>,
    acc_m_s2: PyReadonlyArray2<'py, f64>,
    dt_s: Step<'py>,
    gravity_m_s2: f64,
    max_without_rest_s: f64,
    max_hole_s: f64,
    max_end_distance: f64,
    end: Option<(Vec3, f64)>,
) -> PyResult<Bound<'py, PyDict>> {
    let (gyro, acc) = (rows::<3>(&gyro_rad_s, "gyro_rad_s")?, rows::<3>(&acc_m_s2, "acc_m_s2")?);
    let name = if on_foot { "foot_motion" } else { "rest_to_rest" };
    let refuse = |error| exception(name, error);
    let dt = dt_s.dt()?;
    if acc.len() != gyro.len() {
        return Err(refuse(Error::LengthMismatch { first: acc.len(), second: gyro.len() }));
    }
    if acc.is_empty() {
        return Err(refuse(Error::Empty));
    }
    dt.check(acc.len()).map_err(refuse)?;
    if let Some(row) = acc.iter().zip(gyro).position(|(a, g)| a.iter().chain(g).any(|x| !x.is_finite())) {
        return Err(refuse(Error::NotFinite { row }));
    }
    if !(gravity_m_s2 > 0.0 && gravity_m_s2.is_finite()) {
        return Err(refuse(Error::NotPositive { name: "gravity", value: gravity_m_s2 }));
    }
    let navigation = |usual: NavigationSettings| NavigationSettings {
        gravity_m_s2,
        end,
        max_hole_s,
        max_end_distance,
        ..usual
    };
    let track = py.detach(|| {
        if on_foot {
            let usual = FootSettings::default();
            let navigation = navigation(usual.navigation);
            foot::foot(acc, gyro, dt, &FootSettings { navigation, max_without_rest_s, ..usual })
        } else {
            let usual = RestToRestSettings::default();
            let navigation = navigation(usual.navigation);
            let settings = RestToRestSettings { navigation, max_without_rest_s, ..usual };
            rest_to_rest::rest_to_rest(acc, gyro, dt, &settings)
        }
    });
    tracked(py, track.map_err(refuse)?)
}

fn tracked(py: Python<'_>, track: Track) -> PyResult<Bound<'_, PyDict>> {
    let result = PyDict::new(py);
    let quats = track.world_from_body.into_iter().map(shisei_core::Quaternion::to_array).collect();
    let phase = |of: Phase| PyArray1::from_vec(py, track.phases.iter().map(|p| *p == of).collect());
    result.set_item("world_from_body", table::<4>(py, quats)?)?;
    result.set_item("rest", phase(Phase::Rest))?;
    result.set_item("stance", phase(Phase::Stance))?;
    result.set_item("velocity_m_s", table::<3>(py, track.velocity_m_s)?)?;
    result.set_item("position_m", table::<3>(py, track.position_m)?)?;
    result.set_item("sigma_position_m", table::<3>(py, track.sigma_position_m)?)?;
    let holes = track.holes.iter().map(|hole| (hole.row, hole.length_s)).collect::<Vec<_>>();
    result.set_item("holes", holes)?;
    result.set_item("passed_over", track.passed_over)?;
    let given = track.given_end.filter(GivenEnd::is_doubtful);
    result.set_item("doubtful_end", given.map(|end| (end.off_m, end.sigma_m, end.distance)))?;
    result.set_item("longest_without_rest_s", track.longest_without_rest_s)?;
    result.set_item("gyro_bias_rad_s", track.gyro_bias_rad_s)?;
    result.set_item("acc_bias_m_s2", track.acc_bias_m_s2)?;
    Ok(result)
}
