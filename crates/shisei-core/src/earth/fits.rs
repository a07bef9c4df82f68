//! The fits of an Earth-rate measurement, each with its covariance.
//!
//! With b the bias, u the unit vector up (from the accelerometer), Ω the Earth's rate and φ the latitude, the
//! mean rate of a direction is ω = b + Ω sin φ u + Ω cos φ n, n the unknown horizontal unit vector to the north.
//! Without an accelerometer only |ω − b| = Ω is known: a sphere; in one plane, a circle of radius Ω cos φ when
//! the plane is level.

use alloc::vec::Vec;

use super::direction::Direction;
use crate::error::{Error, Result};
use crate::least_squares::{Fit, Normal, levenberg_marquardt};
use crate::math;
use crate::matrix::Square;
use crate::sphere;
use crate::vector::{self, Vec3};

/// A number with its standard error.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Measured {
    /// The value.
    pub value: f64,
    /// Its standard error.
    pub sigma: f64,
}

/// What a fit found. Rates in rad/s, angles in rad.
#[derive(Clone, Debug, PartialEq)]
pub struct RateFit {
    /// Centre: the gyroscope's bias (of a circle without levelling: as far as it is known).
    pub bias_rad_s: Vec3,
    /// Standard error of the bias an axis.
    pub bias_sigma_rad_s: Vec3,
    /// The Earth's rate Ω, where the fit determines it.
    pub rate: Option<Measured>,
    /// The horizontal part Ω cos φ, where the fit determines it.
    pub horizontal: Option<Measured>,
    /// The latitude φ, where the fit determines it.
    pub latitude: Option<Measured>,
    /// Root mean square of the residuals, rad/s.
    pub residual_rms: f64,
    /// Residual of each direction, rad/s.
    pub residuals: Vec<f64>,
    /// Residuals − parameters.
    pub degrees_of_freedom: usize,
}

/// Variance a residual has, from the directions' own standard errors; none where they are unknown.
fn prior_variance(directions: &[Direction]) -> Option<f64> {
    let mut sum = 0.0;
    for d in directions {
        let s = d.sigma_rad_s?;
        sum += (s[0] * s[0] + s[1] * s[1] + s[2] * s[2]) / 3.0;
    }
    Some(sum / directions.len() as f64)
}

/// Degrees of freedom that the directions' own standard errors count for beside the residuals: they do not know
/// how the bias drifts from one direction to the next, so they count little.
const PRIOR_DEGREES: f64 = 2.0;

/// The variance of one residual, from the residuals and the directions' own standard errors together; widened as
/// Student's t asks for, so that one standard error covers 68 % with few directions too.
fn variance_of(directions: &[Direction], cost: f64, dof: usize) -> Result<f64> {
    let (sum, degrees) = match prior_variance(directions) {
        None => (cost, dof as f64),
        Some(prior) => (cost + PRIOR_DEGREES * prior, dof as f64 + PRIOR_DEGREES),
    };
    if degrees == 0.0 {
        return Err(Error::TooFewPoints { given: directions.len(), needed: directions.len() + 1 });
    }
    let t = crate::statistics::student_one_sigma(degrees);
    Ok(t * t * sum / degrees)
}

fn scaled<const N: usize>(fit: &Fit<N>, s2: f64) -> Square<N> {
    let mut c = fit.inverse_normal;
    for row in &mut c {
        for v in row {
            *v *= s2;
        }
    }
    c
}

fn root(v: f64) -> f64 {
    math::sqrt(v.max(0.0))
}

fn rms(residuals: &[f64]) -> f64 {
    root(residuals.iter().map(|r| r * r).sum::<f64>() / residuals.len().max(1) as f64)
}

/// Size of the numbers, so that the fits work on numbers about 1.
const UNIT: f64 = 1e-5;

/// The geometric sphere: the least sum of squares of |ω − b| − Ω, from four directions that do not lie in one
/// plane. (The published measurement's sphere is the algebraic one of [`crate::sphere::fit_sphere`].)
pub fn fit_sphere(directions: &[Direction]) -> Result<RateFit> {
    let points: Vec<Vec3> = directions.iter().map(|d| vector::scale(d.gyro_rad_s, 1.0 / UNIT)).collect();
    let start = sphere::fit_sphere(&points)?;
    let c = start.center;
    let residual = |p: &[f64; 4], w: Vec3| {
        let d = vector::sub(w, [p[0], p[1], p[2]]);
        let n = vector::norm(d).max(1e-12);
        ([-d[0] / n, -d[1] / n, -d[2] / n, -1.0], n - p[3])
    };
    let fit = levenberg_marquardt([c[0], c[1], c[2], start.radius], |p| {
        let mut normal = Normal::default();
        for w in &points {
            let (j, r) = residual(p, *w);
            normal.add(&j, r, 1.0);
        }
        normal
    })?;
    let p = fit.parameters;
    let dof = fit.degrees_of_freedom();
    let c = scaled(&fit, variance_of(directions, fit.cost * UNIT * UNIT, dof)?);
    let residuals: Vec<f64> = points.iter().map(|w| residual(&p, *w).1 * UNIT).collect();
    Ok(RateFit {
        bias_rad_s: vector::scale([p[0], p[1], p[2]], UNIT),
        bias_sigma_rad_s: [root(c[0][0]), root(c[1][1]), root(c[2][2])],
        rate: Some(Measured { value: p[3] * UNIT, sigma: root(c[3][3]) }),
        horizontal: None,
        latitude: None,
        residual_rms: rms(&residuals),
        residuals,
        degrees_of_freedom: dof,
    })
}

/// Two unit vectors that make a right-handed frame with `up`: the first is body x (or y, where x is upright)
/// laid flat.
pub fn level_axes(up: Vec3) -> (Vec3, Vec3) {
    let along = if up[0].abs() < 0.9 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
    let flat = vector::sub(along, vector::scale(up, vector::dot(along, up)));
    let e1 = vector::scale(flat, 1.0 / vector::norm(flat));
    (e1, vector::cross(up, e1))
}

/// A circle in a plane with the given normal (unit vector): radius Ω cos φ when the plane is level. Three
/// directions at least.
pub fn fit_circle(directions: &[Direction], normal: Vec3) -> Result<RateFit> {
    if directions.len() < 3 {
        return Err(Error::TooFewPoints { given: directions.len(), needed: 3 });
    }
    let (e1, e2) = level_axes(normal);
    let points: Vec<[f64; 2]> = directions
        .iter()
        .map(|d| [vector::dot(e1, d.gyro_rad_s) / UNIT, vector::dot(e2, d.gyro_rad_s) / UNIT])
        .collect();
    if points.iter().any(|p| !(p[0].is_finite() && p[1].is_finite())) {
        return Err(Error::NotFinite { row: 0 });
    }
    let start = algebraic_circle(&points)?;
    let residual = |p: &[f64; 3], w: &[f64; 2]| {
        let d = [w[0] - p[0], w[1] - p[1]];
        let n = math::hypot(d[0], d[1]).max(1e-12);
        ([-d[0] / n, -d[1] / n, -1.0], n - p[2])
    };
    let fit = levenberg_marquardt(start, |p| {
        let mut normal = Normal::default();
        for w in &points {
            let (j, r) = residual(p, w);
            normal.add(&j, r, 1.0);
        }
        normal
    })?;
    let p = fit.parameters;
    let dof = fit.degrees_of_freedom();
    let c = scaled(&fit, variance_of(directions, fit.cost * UNIT * UNIT, dof)?);
    let residuals: Vec<f64> = points.iter().map(|w| residual(&p, w).1 * UNIT).collect();
    let height =
        directions.iter().map(|d| vector::dot(normal, d.gyro_rad_s)).sum::<f64>() / directions.len() as f64;
    let mut bias = vector::scale(normal, height);
    let mut bias_sigma = [0.0; 3];
    for i in 0..3 {
        bias[i] += (p[0] * e1[i] + p[1] * e2[i]) * UNIT;
        bias_sigma[i] =
            root(e1[i] * e1[i] * c[0][0] + e2[i] * e2[i] * c[1][1] + 2.0 * e1[i] * e2[i] * c[0][1]);
    }
    Ok(RateFit {
        bias_rad_s: bias,
        bias_sigma_rad_s: bias_sigma,
        rate: None,
        horizontal: Some(Measured { value: p[2] * UNIT, sigma: root(c[2][2]) }),
        latitude: None,
        residual_rms: rms(&residuals),
        residuals,
        degrees_of_freedom: dof,
    })
}

/// Centre and radius of the algebraic circle through points of the plane.
fn algebraic_circle(points: &[[f64; 2]]) -> Result<[f64; 3]> {
    let n = points.len() as f64;
    let m = [points.iter().map(|p| p[0]).sum::<f64>() / n, points.iter().map(|p| p[1]).sum::<f64>() / n];
    let (mut s, mut t, mut square) = ([[0.0; 2]; 2], [0.0; 2], 0.0);
    for p in points {
        let x = [p[0] - m[0], p[1] - m[1]];
        let q = x[0] * x[0] + x[1] * x[1];
        square += q;
        for i in 0..2 {
            t[i] += 0.5 * x[i] * q;
            for j in 0..2 {
                s[i][j] += x[i] * x[j];
            }
        }
    }
    let c = crate::matrix::times_vector(&crate::matrix::inverse(&s)?, &t);
    Ok([c[0] + m[0], c[1] + m[1], math::sqrt(c[0] * c[0] + c[1] * c[1] + square / n)])
}

/// Unit vectors up of all directions; none where one lacks its acceleration.
pub fn ups(directions: &[Direction]) -> Option<Vec<Vec3>> {
    directions
        .iter()
        .map(|d| {
            let a = d.acc_m_s2?;
            let n = vector::norm(a);
            (n > 0.0 && n.is_finite()).then(|| vector::scale(a, 1.0 / n))
        })
        .collect()
}

/// Rows of the levelled model: derivatives by (b, S = Ω sin φ, C = Ω cos φ) and residuals of the vertical and
/// the horizontal part.
fn levelled_rows(p: &[f64; 5], w: Vec3, up: Vec3) -> [([f64; 5], f64); 2] {
    let d = vector::sub(w, [p[0], p[1], p[2]]);
    let v = vector::dot(d, up);
    let h = vector::sub(d, vector::scale(up, v));
    let n = vector::norm(h).max(1e-12);
    let k = vector::scale(h, -1.0 / n);
    [([-up[0], -up[1], -up[2], -1.0, 0.0], v - p[3]), ([k[0], k[1], k[2], 0.0, -1.0], n - p[4])]
}

/// The levelled fit: with the accelerometer's up of every direction, and with the latitude where it is known.
///
/// With the latitude the parameters are b and Ω; without it b, Ω sin φ and Ω cos φ, which needs the sensor
/// upright and upside down (or tilted widely), otherwise [`Error::Degenerate`].
pub fn fit_levelled(directions: &[Direction], latitude_rad: Option<f64>) -> Result<RateFit> {
    let Some(ups) = ups(directions) else { return Err(Error::Degenerate) };
    if directions.len() < 3 {
        return Err(Error::TooFewPoints { given: directions.len(), needed: 3 });
    }
    let points: Vec<Vec3> = directions.iter().map(|d| vector::scale(d.gyro_rad_s, 1.0 / UNIT)).collect();
    // start: the circle in the plane level on average
    let mean_up = ups.iter().fold([0.0; 3], |a, u| vector::add(a, *u));
    let start = if vector::norm(mean_up) > 0.5 * ups.len() as f64 {
        fit_circle(directions, vector::scale(mean_up, 1.0 / vector::norm(mean_up)))
    } else {
        fit_sphere(directions)
    }?;
    let b = vector::scale(start.bias_rad_s, 1.0 / UNIT);
    let size = start.horizontal.or(start.rate).map_or(7.0, |m| m.value / UNIT);
    let system = |p: &[f64; 5]| {
        let mut rows = Vec::with_capacity(2 * points.len());
        for (w, up) in points.iter().zip(&ups) {
            rows.extend(levelled_rows(p, *w, *up));
        }
        rows
    };
    let (p, c5, dof, cost) = if let Some(latitude) = latitude_rad {
        let (s, k) = math::sin_cos(latitude);
        let expand = |p: &[f64; 4]| [p[0], p[1], p[2], p[3] * s, p[3] * k];
        let fit = levenberg_marquardt([b[0], b[1], b[2], size], |p| {
            let mut normal = Normal::default();
            for (j, r) in system(&expand(p)) {
                normal.add(&[j[0], j[1], j[2], j[3] * s + j[4] * k], r, 1.0);
            }
            normal
        })?;
        let dof = fit.degrees_of_freedom();
        let c = scaled(&fit, variance_of(directions, fit.cost * UNIT * UNIT, dof)?);
        let mut c5 = [[0.0; 5]; 5];
        for i in 0..3 {
            c5[i][..3].copy_from_slice(&c[i][..3]);
        }
        c5[3][3] = c[3][3];
        (expand(&fit.parameters), c5, dof, (fit.cost, fit.parameters[3] * UNIT))
    } else {
        let fit = levenberg_marquardt([b[0], b[1], b[2], 0.5 * size, size], |p| {
            let mut normal = Normal::default();
            for (j, r) in system(p) {
                normal.add(&j, r, 1.0);
            }
            normal
        })?;
        let dof = fit.degrees_of_freedom();
        let c = scaled(&fit, variance_of(directions, fit.cost * UNIT * UNIT, dof)?);
        // Ω sin φ unknown to its own size: the poses do not separate it from the bias
        if root(c[3][3]) > math::hypot(fit.parameters[3], fit.parameters[4]) * UNIT {
            return Err(Error::Degenerate);
        }
        (fit.parameters, c, dof, (fit.cost, 0.0))
    };
    let (s, k) = (p[3] * UNIT, p[4] * UNIT);
    let total = math::hypot(s, k);
    let (rate, horizontal, latitude) = if let Some(latitude) = latitude_rad {
        let sigma = root(c5[3][3]);
        let cos = math::cos(latitude);
        let rate = Measured { value: cost.1, sigma };
        (
            rate,
            Measured { value: cost.1 * cos, sigma: sigma * cos.abs() },
            Measured { value: latitude, sigma: 0.0 },
        )
    } else {
        let g = [s / total, k / total];
        let variance = g[0] * g[0] * c5[3][3] + g[1] * g[1] * c5[4][4] + 2.0 * g[0] * g[1] * c5[3][4];
        let turn = g[1] * g[1] * c5[3][3] + g[0] * g[0] * c5[4][4] - 2.0 * g[0] * g[1] * c5[3][4];
        (
            Measured { value: total, sigma: root(variance) },
            Measured { value: k, sigma: root(c5[4][4]) },
            Measured { value: math::atan2(s, k), sigma: root(turn) / total },
        )
    };
    let rows = system(&p);
    let residuals: Vec<f64> = rows.chunks(2).map(|r| math::hypot(r[0].1, r[1].1) * UNIT).collect();
    Ok(RateFit {
        bias_rad_s: vector::scale([p[0], p[1], p[2]], UNIT),
        bias_sigma_rad_s: [root(c5[0][0]), root(c5[1][1]), root(c5[2][2])],
        rate: Some(rate),
        horizontal: Some(horizontal),
        latitude: Some(latitude),
        residual_rms: root(cost.0 * UNIT * UNIT / rows.len() as f64),
        residuals,
        degrees_of_freedom: dof,
    })
}

/// The fit with known headings: the horizontal rate is a sine of the heading. Both senses of turning are tried.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeadingFit {
    /// Ω cos φ.
    pub horizontal: Measured,
    /// Heading of true north on the scale of the headings given, rad: where the sensor's forward axis would
    /// point north.
    pub north: Measured,
    /// Sum of squared residuals with headings clockwise, (rad/s)².
    pub clockwise_cost: f64,
    /// The same with headings counter-clockwise: much larger when the headings are right.
    pub counter_clockwise_cost: f64,
    /// Probability that the opposite sense fits so much worse by chance alone (an F test).
    pub sense_probability: f64,
}

/// Fits with known headings in the plane with the given normal (up); all directions need a heading. Three at
/// least.
pub fn fit_headings(directions: &[Direction], up: Vec3) -> Result<HeadingFit> {
    if directions.len() < 3 {
        return Err(Error::TooFewPoints { given: directions.len(), needed: 3 });
    }
    let (e1, e2) = level_axes(up);
    let solve = |sense: f64| -> Result<([f64; 4], Square<4>, f64)> {
        let mut normal = Normal::<4>::default();
        for d in directions {
            let heading = d.heading_rad.ok_or(Error::Degenerate)?;
            // forward clockwise of north by ψ: north lies to the left of forward by ψ
            let (s, c) = math::sin_cos(sense * heading);
            let x = vector::dot(e1, d.gyro_rad_s) / UNIT;
            let y = vector::dot(e2, d.gyro_rad_s) / UNIT;
            normal.add(&[1.0, 0.0, c, -s], x, 1.0);
            normal.add(&[0.0, 1.0, s, c], y, 1.0);
        }
        let inverse = crate::least_squares::inverse_spd(&normal.matrix)?;
        let p = crate::matrix::times_vector(&inverse, &normal.gradient);
        let mut cost = normal.cost;
        for i in 0..4 {
            cost -= p[i] * normal.gradient[i];
        }
        Ok((p, inverse, cost.max(0.0) * UNIT * UNIT))
    };
    let (p, inverse, clockwise_cost) = solve(1.0)?;
    let (_, _, counter_clockwise_cost) = solve(-1.0)?;
    let dof = 2 * directions.len() - 4;
    let s2 = variance_of(directions, clockwise_cost, dof)?;
    let r = math::hypot(p[2], p[3]);
    // north at angle ψ + α: the heading at which forward points north is −α
    let alpha = math::atan2(p[3], p[2]);
    let sigma = root(s2 * inverse[2][2]);
    Ok(HeadingFit {
        horizontal: Measured { value: r * UNIT, sigma },
        north: Measured { value: -alpha, sigma: sigma / (r * UNIT) },
        clockwise_cost,
        counter_clockwise_cost,
        sense_probability: crate::statistics::f_survival(
            counter_clockwise_cost / (dof as f64 * s2),
            dof as f64,
            dof as f64,
        ),
    })
}
