//! The attitude of a sensor at rest, from its mean acceleration.
//!
//! roll = atan2(ay, az), pitch = atan2(−ax, √(ay² + az²)), yaw = 0.

use crate::error::{Error, Result};
use crate::euler::Ypr;
use crate::math;
use crate::quaternion::Quaternion;
use crate::rest;
use crate::vector::{self, Vec3};

/// `world_from_body` with yaw 0 from the mean acceleration at rest, m/s² or any other unit; refused when it is
/// zero or not finite.
pub fn from_mean_acceleration(acc_mean: Vec3) -> Result<Quaternion> {
    if !vector::is_finite(acc_mean) {
        return Err(Error::NotFinite { row: 0 });
    }
    if acc_mean == [0.0; 3] {
        return Err(Error::ZeroAcceleration);
    }
    Ok(from_direction(acc_mean, 0.0))
}

/// As [`from_mean_acceleration`], from samples that must be at rest: refused ([`Error::NotStable`]) unless
/// [`rest::is_stable`].
pub fn from_stable_window(
    acc_m_s2: &[Vec3],
    variance_max: f64,
    norm_mean_min: f64,
    norm_mean_max: f64,
) -> Result<Quaternion> {
    if !rest::is_stable(acc_m_s2, variance_max, norm_mean_min, norm_mean_max)? {
        let variance = rest::variance(acc_m_s2)?;
        return Err(Error::NotStable {
            variance: variance[0].max(variance[1]).max(variance[2]),
            mean_norm: rest::mean_norm(acc_m_s2)?,
        });
    }
    from_mean_acceleration(rest::mean(acc_m_s2)?)
}

/// An attitude made level by an acceleration, m/s²: the shortest turn that brings the acceleration, as the
/// attitude sees it, to world z. Its axis lies flat, so the heading is kept. Unchanged where the acceleration is
/// zero or not finite.
pub fn level(world_from_body: Quaternion, acc: Vec3) -> Quaternion {
    let up = world_from_body.rotate(acc);
    let flat = math::hypot(up[0], up[1]);
    if !vector::is_finite(up) || (flat == 0.0 && up[2] >= 0.0) {
        return world_from_body;
    }
    let angle_rad = math::atan2(flat, up[2]);
    // up × z; upside down every flat axis is as good as another
    let axis = if flat == 0.0 { [1.0, 0.0, 0.0] } else { [up[1] / flat, -up[0] / flat, 0.0] };
    Quaternion::from_rotation_vector(vector::scale(axis, angle_rad)).product(world_from_body).normalized()
}

/// Roll and pitch of an acceleration (finite, any length), with a given yaw.
pub(crate) fn from_direction(acc: Vec3, yaw_rad: f64) -> Quaternion {
    let roll_rad = math::atan2(acc[1], acc[2]);
    let pitch_rad = math::atan2(-acc[0], math::hypot(acc[1], acc[2]));
    Quaternion::from_ypr(Ypr { yaw_rad, pitch_rad, roll_rad })
}
