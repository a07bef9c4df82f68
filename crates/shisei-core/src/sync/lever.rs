//! Where on a body the sensor sits, and which way gravity points in the optical world.
//!
//! The sensor's position is p + R l with the body's p and R and the lever arm l. Its acceleration is what the
//! accelerometer reads, turned into the world, less gravity. Both are compared through test functions
//! φ(u) = (1 − u²)⁵ over half a second, so that no position is differentiated:
//!
//! `∫ φ̈ (p + R l) dt = ∫ φ R_s (f − b) dt − ĝ ∫ φ dt`
//!
//! is linear in l, in the accelerometer's bias b and in the upward vector ĝ of gravity's size. A second round
//! holds ĝ to the gravity that is given, which a bias could otherwise take the place of.

use alloc::vec::Vec;

use crate::error::{Error, Result};
use crate::filter::{check_rows, positive, same_length};
use crate::frames::Pose;
use crate::least_squares::inverse_spd;
use crate::math;
use crate::matrix::{Square, times_vector};
use crate::quaternion::Quaternion;
use crate::vector::{self, Vec3};

/// Half the width of a test function, and from one to the next, s.
const HALF_WIDTH_S: f64 = 0.25;
const SPACING_S: f64 = 0.1;
/// Standard deviations a priori: lever arm, m; bias, m/s²; each component of gravity, m/s².
const PRIOR_LEVER_M: f64 = 1.0;
const PRIOR_BIAS_M_S2: f64 = 0.5;
const PRIOR_GRAVITY_M_S2: f64 = 20.0;
/// Standard deviation of the given gravity's size, m/s²: from the poles to the equator.
const GRAVITY_SIGMA_M_S2: f64 = 0.02;
/// Stretches needed.
const LEAST_WINDOWS: usize = 20;

/// Unknowns: lever arm, bias, gravity.
const UNKNOWNS: usize = 9;

/// What was found; errors are one standard deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lever {
    /// The sensor in body coordinates, m.
    pub sensor_m: Vec3,
    /// Its error, m.
    pub sigma_m: Vec3,
    /// The accelerometer's mean bias, sensor coordinates, m/s².
    pub acc_bias_m_s2: Vec3,
    /// Up in the optical world, unit length.
    pub up: Vec3,
    /// Its error, rad.
    pub sigma_up_rad: f64,
    /// Gravity's size, m/s².
    pub gravity_m_s2: f64,
    /// Root mean square of what is left, as an acceleration, m/s².
    pub residual_m_s2: f64,
    /// Test functions used.
    pub windows: usize,
}

/// Finds lever arm, bias and up.
///
/// `optical_s` ascends, one pose a frame where the body was seen; `sensor_s` are the times of the samples on the
/// optical clock, ascending; `gravity_m_s2` is gravity's size. Refused: unequal lengths, numbers that are not finite, fewer than 20 stretches of
/// half a second in which every frame was seen and the sensor has samples.
pub fn lever_arm(
    optical_s: &[f64],
    poses: &[Option<Pose>],
    sensor_s: &[f64],
    acc_m_s2: &[Vec3],
    body_from_sensor: Quaternion,
    gravity_m_s2: f64,
) -> Result<Lever> {
    positive("gravity", gravity_m_s2)?;
    same_length(optical_s.len(), poses.len())?;
    same_length(sensor_s.len(), acc_m_s2.len())?;
    check_rows(acc_m_s2, 0)?;
    let scene = Scene { optical_s, poses, sensor_s, acc_m_s2, body_from_sensor };
    let (Some(&first), Some(&last)) = (optical_s.first(), optical_s.last()) else {
        return Err(Error::Empty);
    };
    let count = math::floor((last - first - 2.0 * HALF_WIDTH_S) / SPACING_S);
    if !(count.is_finite() && count < 1e8) {
        return Err(Error::OutOfRange { rule: "take shorter than 115 days", value: last - first });
    }
    let mut windows: Vec<Window> = Vec::new();
    for k in 0..=(count.max(0.0) as usize) {
        windows.extend(scene.window(first + HALF_WIDTH_S + k as f64 * SPACING_S));
    }
    if windows.len() < LEAST_WINDOWS {
        return Err(Error::TooFewPoints { given: windows.len(), needed: LEAST_WINDOWS });
    }
    solve(&windows, gravity_m_s2)
}

/// One test function: three equations `value = Σ jacobian · unknowns`.
struct Window {
    value: Vec3,
    jacobian: [[f64; UNKNOWNS]; 3],
}

struct Scene<'a> {
    optical_s: &'a [f64],
    poses: &'a [Option<Pose>],
    sensor_s: &'a [f64],
    acc_m_s2: &'a [Vec3],
    body_from_sensor: Quaternion,
}

/// φ and its second derivative by time.
fn test_function(time_s: f64) -> (f64, f64) {
    let u = time_s / HALF_WIDTH_S;
    let v = 1.0 - u * u;
    if v <= 0.0 {
        return (0.0, 0.0);
    }
    let v3 = v * v * v;
    (v3 * v * v, 10.0 * v3 * (9.0 * u * u - 1.0) / (HALF_WIDTH_S * HALF_WIDTH_S))
}

impl Scene<'_> {
    fn window(&self, middle_s: f64) -> Option<Window> {
        let (from, to) = (middle_s - HALF_WIDTH_S, middle_s + HALF_WIDTH_S);
        let frames = inside(self.optical_s, from, to);
        let samples = inside(self.sensor_s, from, to);
        if frames.len() < 12 || samples.len() < 12 {
            return None;
        }
        let centre = self.poses[usize::midpoint(frames.start, frames.end)]?.position_m;
        let mut value = [0.0; 3];
        let mut jacobian = [[0.0; UNKNOWNS]; 3];
        for k in frames {
            let pose = self.poses[k]?;
            let (_, second) = test_function(self.optical_s[k] - middle_s);
            let weight = second * share(self.optical_s, k)?;
            let r = pose.world_from_body.to_matrix();
            for axis in 0..3 {
                value[axis] -= weight * (pose.position_m[axis] - centre[axis]);
                for j in 0..3 {
                    jacobian[axis][j] += weight * r[axis][j];
                }
            }
        }
        for k in samples {
            let (phi, _) = test_function(self.sensor_s[k] - middle_s);
            let weight = phi * share(self.sensor_s, k)?;
            let r = self.attitude(self.sensor_s[k])?.product(self.body_from_sensor).to_matrix();
            for axis in 0..3 {
                value[axis] += weight * vector::dot(r[axis], self.acc_m_s2[k]);
                for j in 0..3 {
                    jacobian[axis][3 + j] += weight * r[axis][j];
                }
                jacobian[axis][6 + axis] += weight;
            }
        }
        Some(Window { value, jacobian })
    }

    /// The body's attitude at a time between two frames in which it was seen.
    fn attitude(&self, time_s: f64) -> Option<Quaternion> {
        let after = self.optical_s.partition_point(|t| *t <= time_s).clamp(1, self.optical_s.len() - 1);
        let (a, b) = (self.poses[after - 1]?, self.poses[after]?);
        let (ta, tb) = (self.optical_s[after - 1], self.optical_s[after]);
        Some(Quaternion::slerp(a.world_from_body, b.world_from_body, (time_s - ta) / (tb - ta)))
    }
}

/// Rows whose times lie within.
fn inside(time_s: &[f64], from: f64, to: f64) -> core::ops::Range<usize> {
    let start = time_s.partition_point(|t| *t <= from);
    let end = time_s.partition_point(|t| *t < to);
    start..end.max(start)
}

/// Half the time from the row before to the row after; none at the ends and beside holes of 50 ms.
fn share(time_s: &[f64], row: usize) -> Option<f64> {
    let (before, after) = (time_s.get(row.checked_sub(1)?)?, time_s.get(row + 1)?);
    let width = 0.5 * (after - before);
    (width > 0.0 && width < 0.05).then_some(width)
}

fn solve(windows: &[Window], gravity_m_s2: f64) -> Result<Lever> {
    let mut matrix: Square<UNKNOWNS> = [[0.0; UNKNOWNS]; UNKNOWNS];
    let mut gradient = [0.0; UNKNOWNS];
    for window in windows {
        for (j, value) in window.jacobian.iter().zip(window.value) {
            for a in 0..UNKNOWNS {
                for b in 0..UNKNOWNS {
                    matrix[a][b] += j[a] * j[b];
                }
                gradient[a] += j[a] * value;
            }
        }
    }
    // ∫ φ dt, which turns a residual into a mean acceleration
    let width = HALF_WIDTH_S * 512.0 / 693.0;
    let mut x = [0.0; UNKNOWNS];
    let mut covariance = [[0.0; UNKNOWNS]; UNKNOWNS];
    let mut variance = (0.1 * width) * (0.1 * width);
    // the priors weigh against the residuals' own variance, which the second round knows
    for round in 0..3 {
        let (mut with_priors, mut gradient) = (matrix, gradient);
        let size = vector::norm([x[6], x[7], x[8]]);
        if round > 0 && size > 0.0 {
            // up · ĝ = gravity
            let up = vector::scale([x[6], x[7], x[8]], 1.0 / size);
            let weight = variance / (GRAVITY_SIGMA_M_S2 * GRAVITY_SIGMA_M_S2);
            for a in 0..3 {
                for b in 0..3 {
                    with_priors[6 + a][6 + b] += weight * up[a] * up[b];
                }
                gradient[6 + a] += weight * up[a] * gravity_m_s2;
            }
        }
        for k in 0..UNKNOWNS {
            let prior = [PRIOR_LEVER_M, PRIOR_BIAS_M_S2, PRIOR_GRAVITY_M_S2][k / 3];
            with_priors[k][k] += variance / (prior * prior);
        }
        let inverse = inverse_spd(&with_priors)?;
        x = times_vector(&inverse, &gradient);
        let mut squares = 0.0;
        for window in windows {
            for (j, value) in window.jacobian.iter().zip(window.value) {
                let left = value - j.iter().zip(&x).map(|(a, b)| a * b).sum::<f64>();
                squares += left * left;
            }
        }
        variance = squares / (3 * windows.len()).saturating_sub(UNKNOWNS).max(1) as f64;
        // neighbouring test functions overlap: only each fifth is new
        let overlap = 2.0 * HALF_WIDTH_S / SPACING_S;
        for a in 0..UNKNOWNS {
            for b in 0..UNKNOWNS {
                covariance[a][b] = inverse[a][b] * variance * overlap;
            }
        }
    }
    let gravity = [x[6], x[7], x[8]];
    let size = vector::norm(gravity);
    if size.is_nan() || size <= 0.0 {
        return Err(Error::Degenerate);
    }
    let sigma = |k: usize| math::sqrt(covariance[k][k].max(0.0));
    Ok(Lever {
        sensor_m: [x[0], x[1], x[2]],
        sigma_m: [sigma(0), sigma(1), sigma(2)],
        acc_bias_m_s2: [x[3], x[4], x[5]],
        up: vector::scale(gravity, 1.0 / size),
        sigma_up_rad: vector::norm([sigma(6), sigma(7), sigma(8)]) / size,
        gravity_m_s2: size,
        residual_m_s2: math::sqrt(variance) / width,
        windows: windows.len(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The second derivative by differences, and the integral of φ.
    #[test]
    fn the_test_function_is_its_own_derivative() {
        let h = 1e-4;
        let phi = |t: f64| test_function(t).0;
        for t in [-0.2, -0.05, 0.0, 0.11, 0.24] {
            let differences = (phi(t + h) - 2.0 * phi(t) + phi(t - h)) / (h * h);
            assert!((test_function(t).1 - differences).abs() < 1e-3, "{t}");
        }
        let sum: f64 = (-5000..5000).map(|k| phi(f64::from(k) * 5e-5) * 5e-5).sum();
        assert!((sum - HALF_WIDTH_S * 512.0 / 693.0).abs() < 1e-9, "{sum}");
    }
}
