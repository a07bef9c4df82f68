//! Gyroscope scale and misalignment from the turns between still poses.
//!
//! Between two rests the calibrated gyroscope must carry the direction of gravity from the first pose into that
//! of the second: with q the rotation integrated from M (ω − b), q* u₀ = u₁ (Tedaldi, Pretto & Menegatti 2014,
//! eq. 11–14). The nine elements of M are found by Gauss–Newton; the derivative of the turned direction with
//! respect to M is integrated along. The bias is that of the rests on both sides of each turn, weighted by
//! distance in time, so that a slow drift drops out.

use alloc::vec::Vec;

use crate::calibration::SensorModel;
use crate::calibration::still::StillSegment;
use crate::error::{Error, Result};
use crate::least_squares::{Fit, Normal, levenberg_marquardt};
use crate::math;
use crate::matrix::Square;
use crate::quaternion::Quaternion;
use crate::vector::{self, Vec3};

/// Elements of M, row by row.
pub const PARAMETERS: usize = 9;

/// Names of the nine parameters, in the covariance's order.
pub const PARAMETER_NAMES: [&str; PARAMETERS] =
    ["g_xx", "g_xy", "g_xz", "g_yx", "g_yy", "g_yz", "g_zx", "g_zy", "g_zz"];

/// Settings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TurnSettings {
    /// Turns that took longer are left out, s; default 30: the bias drifts and noise grows.
    pub max_duration_s: f64,
    /// Turns that moved gravity by less are left out, rad; default 0.17 (10°): they say little.
    pub min_angle_rad: f64,
}

impl Default for TurnSettings {
    fn default() -> Self {
        TurnSettings { max_duration_s: 30.0, min_angle_rad: 0.17 }
    }
}

/// The result.
#[derive(Clone, Debug)]
pub struct GyroTurns {
    /// The calibration; the bias is the mean over all rests.
    pub gyroscope: SensorModel,
    /// Standard error of the bias, raw unit: the scatter of the rests' means over √ of their number.
    pub bias_sigma: Vec3,
    /// Standard errors in the order of [`PARAMETER_NAMES`].
    pub sigma: [f64; PARAMETERS],
    /// Covariance in the same order.
    pub covariance: Square<PARAMETERS>,
    /// Angle between gravity as carried by the gyroscope and as seen by the accelerometer, a turn, rad.
    pub residuals_rad: Vec<f64>,
    /// Root mean square of the residuals, rad.
    pub residual_rms_rad: f64,
    /// The same for turns left out of the fit (five rounds), rad; empty with fewer than 10 turns.
    pub held_out_rad: Vec<f64>,
    /// Root mean square of `held_out_rad`, rad; NaN when that is empty.
    pub held_out_rms_rad: f64,
}

struct Turn<'a> {
    gyro: &'a [Vec3],
    bias_before: Vec3,
    bias_after: Vec3,
    up_before: Vec3,
    up_after: Vec3,
}

/// Direction at the end as the gyroscope has it, and its derivatives with respect to M.
fn carry(turn: &Turn<'_>, m: &Square<3>, dt_s: f64) -> (Vec3, [Vec3; PARAMETERS]) {
    let n = turn.gyro.len().max(1) as f64;
    let mut q = Quaternion::IDENTITY;
    // ∂(rotation vector in the first pose's frame)/∂m_ij = Σ R e_i (ω_j − b_j) dt
    let mut sensitivity = [[0.0; 3]; PARAMETERS];
    for (k, raw) in turn.gyro.iter().enumerate() {
        let f = (k as f64 + 0.5) / n;
        let mut d = [0.0; 3];
        for i in 0..3 {
            d[i] = raw[i] - (turn.bias_before[i] * (1.0 - f) + turn.bias_after[i] * f);
        }
        let rate = [vector::dot(m[0], d), vector::dot(m[1], d), vector::dot(m[2], d)];
        let half = q.product(Quaternion::from_rotation_vector(vector::scale(rate, 0.5 * dt_s)));
        let r = half.to_matrix();
        for i in 0..3 {
            for j in 0..3 {
                let w = d[j] * dt_s;
                for a in 0..3 {
                    sensitivity[3 * i + j][a] += r[a][i] * w;
                }
            }
        }
        q = q.product(Quaternion::from_rotation_vector(vector::scale(rate, dt_s)));
        q = q.normalized();
    }
    let back = q.conjugate();
    let end = back.rotate(turn.up_before);
    // u₁ = R* u₀; a small turn θ of the first frame gives R* (u₀ × θ)
    let mut derivatives = [[0.0; 3]; PARAMETERS];
    for p in 0..PARAMETERS {
        derivatives[p] = back.rotate(vector::cross(turn.up_before, sensitivity[p]));
    }
    (end, derivatives)
}

fn fit(
    turns: &[Turn<'_>],
    start: [f64; 9],
    dt_s: f64,
    used: impl Fn(usize) -> bool,
) -> Result<Fit<PARAMETERS>> {
    levenberg_marquardt(start, |p| {
        let m = [[p[0], p[1], p[2]], [p[3], p[4], p[5]], [p[6], p[7], p[8]]];
        let mut normal = Normal::default();
        for (i, turn) in turns.iter().enumerate() {
            if used(i) {
                let (end, derivatives) = carry(turn, &m, dt_s);
                for a in 0..3 {
                    let mut j = [0.0; PARAMETERS];
                    for p in 0..PARAMETERS {
                        j[p] = derivatives[p][a];
                    }
                    normal.add(&j, end[a] - turn.up_after[a], 1.0);
                }
            }
        }
        normal
    })
}

fn angle_between(a: Vec3, b: Vec3) -> f64 {
    math::atan2(vector::norm(vector::cross(a, b)), vector::dot(a, b))
}

/// Calibrates a gyroscope (raw N rows, one every `dt_s` s, any unit) from the turns between still segments,
/// with an accelerometer already calibrated. The unit of the result is rad/s.
///
/// Refuses with [`Error::TooFewPoints`] (five turns at least) or [`Error::Degenerate`] (turns about too few
/// axes: turn about x, y and z).
pub fn calibrate(
    gyro: &[Vec3],
    dt_s: f64,
    segments: &[StillSegment],
    accelerometer: &SensorModel,
    settings: &TurnSettings,
) -> Result<GyroTurns> {
    if !(dt_s > 0.0 && dt_s.is_finite()) {
        return Err(Error::NotPositive { name: "dt", value: dt_s });
    }
    let up = |s: &StillSegment| {
        let a = accelerometer.apply(s.acc_mean);
        let n = vector::norm(a);
        if n > 0.0 { Ok(vector::scale(a, 1.0 / n)) } else { Err(Error::Degenerate) }
    };
    let mut turns = Vec::new();
    for pair in segments.windows(2) {
        let [before, after] = pair else { continue };
        let rows = gyro.get(before.end..after.start).unwrap_or(&[]);
        let (up_before, up_after) = (up(before)?, up(after)?);
        let long = rows.len() as f64 * dt_s > settings.max_duration_s;
        if rows.is_empty() || long || angle_between(up_before, up_after) < settings.min_angle_rad {
            continue;
        }
        turns.push(Turn {
            gyro: rows,
            bias_before: before.gyro_mean,
            bias_after: after.gyro_mean,
            up_before,
            up_after,
        });
    }
    if turns.len() < 5 {
        return Err(Error::TooFewPoints { given: turns.len(), needed: 5 });
    }
    // counts have a scale far from 1: start from the size that carries gravity through the turns' angle
    let s = starting_scale(&turns, dt_s)?;
    let solved = fit(&turns, [s, 0.0, 0.0, 0.0, s, 0.0, 0.0, 0.0, s], dt_s, |_| true)?;
    // a turn has two independent residuals: the carried direction keeps its length
    let dof = (2 * turns.len()).saturating_sub(PARAMETERS);
    let s2 = if dof == 0 { return Err(Error::Degenerate) } else { solved.cost / dof as f64 };
    let mut covariance = solved.inverse_normal;
    let mut sigma = [0.0; PARAMETERS];
    for i in 0..PARAMETERS {
        for j in 0..PARAMETERS {
            covariance[i][j] *= s2;
        }
        sigma[i] = math::sqrt(covariance[i][i].max(0.0));
    }
    let p = solved.parameters;
    let matrix = [[p[0], p[1], p[2]], [p[3], p[4], p[5]], [p[6], p[7], p[8]]];
    if sigma.iter().any(|v| *v > 0.3 * s) {
        return Err(Error::Degenerate);
    }
    let error = |turn: &Turn<'_>, m: &Square<3>| angle_between(carry(turn, m, dt_s).0, turn.up_after);
    let residuals_rad: Vec<f64> = turns.iter().map(|t| error(t, &matrix)).collect();
    let mut held_out_rad = Vec::new();
    if turns.len() >= 10 {
        for round in 0..5 {
            let Ok(f) = fit(&turns, p, dt_s, |i| i % 5 != round) else { continue };
            let p = f.parameters;
            let m = [[p[0], p[1], p[2]], [p[3], p[4], p[5]], [p[6], p[7], p[8]]];
            held_out_rad
                .extend(turns.iter().enumerate().filter(|(i, _)| i % 5 == round).map(|(_, t)| error(t, &m)));
        }
    }
    let (bias, bias_sigma) = bias_of(segments);
    Ok(GyroTurns {
        gyroscope: SensorModel { bias, matrix },
        bias_sigma,
        sigma,
        covariance,
        residual_rms_rad: rms(&residuals_rad),
        residuals_rad,
        held_out_rms_rad: rms(&held_out_rad),
        held_out_rad,
    })
}

/// The scale (of a short list) whose carried directions fit best: 1, a degree, and full scales of 16-bit counts.
fn starting_scale(turns: &[Turn<'_>], dt_s: f64) -> Result<f64> {
    let degree = core::f64::consts::PI / 180.0;
    let mut best = (f64::INFINITY, 1.0);
    for s in [
        1.0,
        degree,
        degree / 131.0,
        degree / 65.5,
        degree / 32.8,
        degree / 16.4,
        degree / 262.0,
        degree * 0.00875,
        degree * 0.0175,
        degree * 0.035,
        degree * 0.07,
    ] {
        let m = [[s, 0.0, 0.0], [0.0, s, 0.0], [0.0, 0.0, s]];
        let cost: f64 = turns
            .iter()
            .map(|t| {
                let e = vector::sub(carry(t, &m, dt_s).0, t.up_after);
                vector::dot(e, e)
            })
            .sum();
        if cost < best.0 {
            best = (cost, s);
        }
    }
    if best.0.is_finite() { Ok(best.1) } else { Err(Error::NoConvergence) }
}

/// Mean of the rests' gyro means, weighted by their rows, and its standard error from their scatter.
fn bias_of(segments: &[StillSegment]) -> (Vec3, Vec3) {
    let total: f64 = segments.iter().map(|s| s.rows() as f64).sum();
    let (mut bias, mut sigma) = ([0.0; 3], [0.0; 3]);
    let n = segments.len() as f64;
    for i in 0..3 {
        bias[i] = segments.iter().map(|s| s.gyro_mean[i] * s.rows() as f64).sum::<f64>() / total;
        let scatter: f64 =
            segments.iter().map(|s| (s.gyro_mean[i] - bias[i]) * (s.gyro_mean[i] - bias[i])).sum();
        sigma[i] = math::sqrt(scatter / ((n - 1.0).max(1.0) * n));
    }
    (bias, sigma)
}

fn rms(values: &[f64]) -> f64 {
    if values.is_empty() {
        return f64::NAN;
    }
    math::sqrt(values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64)
}
