//! Heading without a magnetometer: the world may be turned about its z so that it suits the wearer.

use crate::error::{Error, Result};
use crate::math;
use crate::quaternion::Quaternion;
use crate::vector::{self, Vec3};

/// Nearer to the vertical than this, an axis has no heading worth the name: 10°, rad.
pub const NEAR_VERTICAL_RAD: f64 = 0.17453292519943295;

/// The turn about world z that makes a sensor axis, laid flat, point along world x at the start.
///
/// `world_from_body` is the attitude at the start, `axis_body` an axis in sensor coordinates of any length.
/// Multiply every attitude from the left: `turn ⊗ q`. Refused ([`Error::AxisNearVertical`]) when the axis
/// stands within [`NEAR_VERTICAL_RAD`] of the vertical, or is zero or not finite.
pub fn from_forward_axis(world_from_body: Quaternion, axis_body: Vec3) -> Result<Quaternion> {
    let q = world_from_body.try_normalized()?;
    if !vector::is_finite(axis_body) {
        return Err(Error::NotFinite { row: 0 });
    }
    let largest = axis_body[0].abs().max(axis_body[1].abs()).max(axis_body[2].abs());
    if largest == 0.0 {
        return Err(Error::ZeroAxis);
    }
    let axis = q.rotate([axis_body[0] / largest, axis_body[1] / largest, axis_body[2] / largest]);
    let from_vertical_rad = math::atan2(math::hypot(axis[0], axis[1]), axis[2].abs());
    if from_vertical_rad < NEAR_VERTICAL_RAD {
        return Err(Error::AxisNearVertical { angle_rad: from_vertical_rad });
    }
    let (sin, cos) = math::sin_cos(-0.5 * math::atan2(axis[1], axis[0]));
    Ok(Quaternion::new(cos, 0.0, 0.0, sin))
}

/// True within [`NEAR_VERTICAL_RAD`] of pitch ±90°, where yaw and roll of an attitude mix.
pub fn is_near_gimbal_lock(world_from_body: Quaternion) -> bool {
    // the sensor's x axis stands near the vertical
    let x_axis = world_from_body.rotate([1.0, 0.0, 0.0]);
    math::atan2(math::hypot(x_axis[0], x_axis[1]), x_axis[2].abs()) < NEAR_VERTICAL_RAD
}
