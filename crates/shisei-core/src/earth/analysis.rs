//! The whole judgement of an Earth-rate measurement: all fits, which one to believe, headings, the day.

use alloc::vec::Vec;

use super::direction::Direction;
use super::fits::{
    HeadingFit, Measured, RateFit, fit_circle, fit_headings, fit_levelled, fit_sphere, level_axes, ups,
};
use crate::error::{Error, Result};
use crate::filter::not_negative;
use crate::math;
use crate::sphere::{self, CircleFit, SphereFit};
use crate::statistics::chi_square_cdf;
use crate::vector::{self, Vec3};

/// The Earth's rate relative to the stars, rad/s (IERS Conventions 2010, table 1.1).
pub const EARTH_RATE_RAD_S: f64 = 7.292115e-5;

/// Which fit the result stands on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Believed {
    /// The sphere: the directions fill space.
    Sphere,
    /// Levelled by the accelerometer, latitude given.
    LevelledWithLatitude,
    /// Levelled by the accelerometer, latitude found.
    LevelledFree,
    /// The circle in one plane, turned into the Earth's rate by the latitude given.
    CircleWithLatitude,
    /// The circle in one plane: only Ω cos φ is known.
    Circle,
}

/// Why a fit is missing or not believed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Doubt {
    /// The directions lie in one plane to within their noise: a sphere through them is arbitrary.
    Flat,
    /// There are too few directions for it.
    TooFew,
    /// It needs accelerations.
    NoAcceleration,
    /// The directions do not determine it.
    Undetermined,
}

/// How nearly the directions lie in one plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneTest {
    /// Unit normal of the best plane.
    pub normal: Vec3,
    /// Root mean square distance from it, rad/s.
    pub distance_rms: f64,
    /// Condition number of the sphere's normal matrix.
    pub condition: f64,
    /// Probability of distances this large or larger if the directions do lie in one plane, from their
    /// standard errors; none where these are unknown.
    pub probability: Option<f64>,
    /// The verdict.
    pub flat: bool,
}

/// Heading of one direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Heading {
    /// Of the body's x axis (y where x stands upright), clockwise from true north, rad in 0 … 2π.
    pub heading_rad: Measured,
}

/// The judgement.
#[derive(Clone, Debug)]
pub struct Analysis {
    /// The published measurement's (algebraic) sphere; none for fewer than four directions or exactly flat ones.
    pub article: Option<SphereFit>,
    /// The plane circle as it comes, without levelling.
    pub circle: CircleFit,
    /// The plane test.
    pub plane: PlaneTest,
    /// Geometric sphere.
    pub sphere: core::result::Result<RateFit, Doubt>,
    /// Circle in the level plane (by the accelerometers where known, else the best plane).
    pub level_circle: RateFit,
    /// Levelled, with the latitude given.
    pub levelled: core::result::Result<RateFit, Doubt>,
    /// Levelled, latitude found.
    pub levelled_free: core::result::Result<RateFit, Doubt>,
    /// By known headings.
    pub headings_known: Option<HeadingFit>,
    /// Which one to believe.
    pub believed: Believed,
    /// Ω of the believed fit, rad/s; none when only Ω cos φ is known.
    pub rate: Option<Measured>,
    /// Ω cos φ, rad/s, where known: from a levelled fit, or from the circle where its plane is level (by the
    /// accelerations; without these where the directions lie in one plane).
    pub horizontal: Option<Measured>,
    /// The latitude: found, or from Ω cos φ with the Earth's rate taken as known, rad; north and south look
    /// alike in the latter.
    pub latitude: Option<Measured>,
    /// Length of the sidereal day, h.
    pub day_h: Option<Measured>,
    /// The gyroscope's bias, rad/s.
    pub bias_rad_s: Vec3,
    /// Heading of every direction; empty where up is unknown.
    pub headings: Vec<Heading>,
    /// Unit vector up used for every direction: the acceleration's, else the normal of the plane they lie in;
    /// empty where they have no accelerations and fill space.
    pub up_body: Vec<Vec3>,
}

/// Length of the day in hours with its error from a rate with its error.
pub fn day_h(rate: Measured) -> Option<Measured> {
    let hours = core::f64::consts::TAU / rate.value / 3600.0;
    (rate.value > 0.0 && hours.is_finite())
        .then(|| Measured { value: hours, sigma: hours * rate.sigma / rate.value })
}

fn doubt(e: Error) -> Doubt {
    match e {
        Error::TooFewPoints { .. } => Doubt::TooFew,
        _ => Doubt::Undetermined,
    }
}

fn plane_test(directions: &[Direction], circle: &CircleFit, article: Option<&SphereFit>) -> PlaneTest {
    let n = directions.len() as f64;
    let normal = circle.normal;
    let height = directions.iter().map(|d| vector::dot(normal, d.gyro_rad_s)).sum::<f64>() / n;
    let mut chi2 = Some(0.0);
    for d in directions {
        let distance = vector::dot(normal, d.gyro_rad_s) - height;
        chi2 = chi2.zip(d.sigma_rad_s).map(|(sum, s)| {
            let variance: f64 = (0..3).map(|i| normal[i] * normal[i] * s[i] * s[i]).sum();
            sum + distance * distance / variance.max(1e-300)
        });
    }
    let dof = n - 3.0;
    let probability = chi2.filter(|_| dof > 0.0).map(|c| 1.0 - chi_square_cdf(c, dof));
    let condition = article.map_or(f64::INFINITY, |a| a.condition);
    PlaneTest {
        normal,
        distance_rms: circle.plane_rms,
        condition,
        probability,
        flat: condition > sphere::FLAT_CONDITION || probability.is_some_and(|p| p > 0.01),
    }
}

/// Judges a measurement of three directions or more. `latitude_rad` where it is known.
///
/// Refuses with [`Error::TooFewPoints`], [`Error::NotFinite`], [`Error::Negative`] (a standard error that is not
/// finite or below 0), [`Error::OutOfRange`] (latitude beyond ±π/2) and [`Error::Degenerate`] (directions all alike
/// or in one line).
pub fn analyse(directions: &[Direction], latitude_rad: Option<f64>) -> Result<Analysis> {
    if directions.len() < 3 {
        return Err(Error::TooFewPoints { given: directions.len(), needed: 3 });
    }
    if let Some(latitude) = latitude_rad
        && latitude.abs().partial_cmp(&core::f64::consts::FRAC_PI_2) != Some(core::cmp::Ordering::Less)
    {
        return Err(Error::OutOfRange { rule: "-pi/2 < latitude (rad) < pi/2", value: latitude });
    }
    for &value in directions.iter().filter_map(|d| d.sigma_rad_s.as_ref()).flatten() {
        not_negative("sigma_rad_s", value)?;
    }
    let points: Vec<Vec3> = directions.iter().map(|d| d.gyro_rad_s).collect();
    if let Some(row) = points.iter().position(|p| !vector::is_finite(*p)) {
        return Err(Error::NotFinite { row });
    }
    differ(directions)?;
    let circle = sphere::fit_circle(&points)?;
    let article = sphere::fit_sphere(&points).ok();
    let plane = plane_test(directions, &circle, article.as_ref());
    let sphere = fit_sphere(directions).map_err(doubt);
    let known_ups = ups(directions);
    let common_up = known_ups.as_deref().and_then(common_up);
    let level_normal = common_up.unwrap_or(plane.normal);
    // without accelerations only directions in one plane can stand for level ones: a turntable's
    let level = if known_ups.is_some() { common_up.is_some() } else { plane.flat };
    let up_body = known_ups
        .clone()
        .or_else(|| level.then(|| alloc::vec![plane.normal; directions.len()]))
        .unwrap_or_default();
    let level_circle = fit_circle(directions, level_normal)?;
    let (levelled, levelled_free) = if known_ups.is_some() {
        (
            latitude_rad
                .map_or(Err(Doubt::Undetermined), |l| fit_levelled(directions, Some(l)).map_err(doubt)),
            fit_levelled(directions, None).map_err(doubt),
        )
    } else {
        (Err(Doubt::NoAcceleration), Err(Doubt::NoAcceleration))
    };
    let headings_known = (level && directions.iter().all(|d| d.heading_rad.is_some()))
        .then(|| fit_headings(directions, level_normal).ok())
        .flatten();

    // the fit that uses most of what is known comes first; one that knows Ω to no better than a fifth is passed over
    let knows = |rate: Option<Measured>| rate.filter(|r| r.sigma < 0.2 * r.value);
    let mut best: Option<(Believed, Measured, RateFit)> = None;
    let mut consider = |kind: Believed, rate: Option<Measured>, fit: &RateFit| {
        if let (Some(rate), true) = (knows(rate), best.is_none()) {
            best = Some((kind, rate, fit.clone()));
        }
    };
    if let Ok(fit) = &levelled {
        consider(Believed::LevelledWithLatitude, fit.rate, fit);
    }
    if let Ok(fit) = &levelled_free {
        consider(Believed::LevelledFree, fit.rate, fit);
    }
    if let (Ok(fit), false) = (&sphere, plane.flat) {
        consider(Believed::Sphere, fit.rate, fit);
    }
    if let (Some(latitude), true) = (latitude_rad, level) {
        let cos = math::cos(latitude);
        let rate = level_circle.horizontal.map(|h| Measured { value: h.value / cos, sigma: h.sigma / cos });
        consider(Believed::CircleWithLatitude, rate, &level_circle);
    }
    let (believed, rate, fit) =
        best.map_or((Believed::Circle, None, level_circle.clone()), |b| (b.0, Some(b.1), b.2));
    let horizontal = if level {
        fit.horizontal.or(level_circle.horizontal)
    } else {
        // of a circle in a plane that need not be level it says nothing
        fit.horizontal.filter(|_| matches!(believed, Believed::LevelledWithLatitude | Believed::LevelledFree))
    };
    let latitude = latitude_rad
        .map(|value| Measured { value, sigma: 0.0 })
        .or(fit.latitude)
        .or_else(|| horizontal.and_then(latitude_from_horizontal));
    let headings = directions.iter().zip(&up_body).map(|(d, up)| heading_of(d, *up, &fit)).collect();
    Ok(Analysis {
        article,
        circle,
        plane,
        sphere,
        level_circle,
        levelled,
        levelled_free,
        headings_known,
        believed,
        rate,
        horizontal,
        latitude,
        day_h: rate.and_then(day_h),
        bias_rad_s: fit.bias_rad_s,
        headings,
        up_body,
    })
}

/// The direction that was up in all directions to within about 14°; none where the sensor was also laid otherwise.
fn common_up(ups: &[Vec3]) -> Option<Vec3> {
    let sum = ups.iter().fold([0.0; 3], |a, u| vector::add(a, *u));
    let length = vector::norm(sum);
    (length > 0.97 * ups.len() as f64).then(|| vector::scale(sum, 1.0 / length))
}

/// Directions that do not differ by more than their noise determine nothing.
fn differ(directions: &[Direction]) -> Result<()> {
    let n = directions.len() as f64;
    let mean = directions.iter().fold([0.0; 3], |a, d| vector::add(a, vector::scale(d.gyro_rad_s, 1.0 / n)));
    let mut chi2 = Some(0.0);
    let mut spread = 0.0;
    for d in directions {
        let x = vector::sub(d.gyro_rad_s, mean);
        spread += vector::dot(x, x);
        chi2 = chi2
            .zip(d.sigma_rad_s)
            .map(|(sum, s)| sum + (0..3).map(|i| x[i] * x[i] / (s[i] * s[i]).max(1e-300)).sum::<f64>());
    }
    let dof = 3.0 * (n - 1.0);
    let noise_only = chi2.is_some_and(|c| chi_square_cdf(c, dof) < 0.999);
    if noise_only || spread == 0.0 { Err(Error::Degenerate) } else { Ok(()) }
}

/// cos φ = R/Ω with the Earth's rate known; none when R is larger than it by more than two errors.
fn latitude_from_horizontal(h: Measured) -> Option<Measured> {
    let cos = h.value / EARTH_RATE_RAD_S;
    if cos > 1.0 {
        let within = h.value - 2.0 * h.sigma < EARTH_RATE_RAD_S;
        return within.then(|| {
            let edge = math::acos(((h.value - h.sigma) / EARTH_RATE_RAD_S).clamp(-1.0, 1.0));
            Measured { value: 0.0, sigma: edge }
        });
    }
    let value = math::acos(cos);
    let sin = math::sqrt((1.0 - cos * cos).max(1e-6));
    Some(Measured { value, sigma: h.sigma / EARTH_RATE_RAD_S / sin })
}

fn heading_of(d: &Direction, up: Vec3, fit: &RateFit) -> Heading {
    let (e1, e2) = level_axes(up);
    let w = vector::sub(d.gyro_rad_s, fit.bias_rad_s);
    let (x, y) = (vector::dot(w, e1), vector::dot(w, e2));
    let turn = core::f64::consts::TAU;
    let angle = math::atan2(y, x);
    let r = math::hypot(x, y).max(1e-12);
    // across the arrow: the direction's own noise and the centre's
    let across = [-y / r, x / r];
    let own = d
        .sigma_rad_s
        .map_or(fit.residual_rms * fit.residual_rms, |s| (s[0] * s[0] + s[1] * s[1] + s[2] * s[2]) / 3.0);
    let b = fit.bias_sigma_rad_s;
    let centre: f64 = (0..3)
        .map(|i| {
            let k = across[0] * e1[i] + across[1] * e2[i];
            k * k * b[i] * b[i]
        })
        .sum();
    Heading {
        heading_rad: Measured {
            value: if angle < 0.0 { angle + turn } else { angle },
            sigma: math::sqrt(own + centre) / r,
        },
    }
}
