//! Yaw, pitch and roll: Z-Y-X intrinsic, `R = Rz(yaw) Ry(pitch) Rx(roll)`.

use crate::math;
use crate::quaternion::Quaternion;

/// Below this cos(pitch) roll is 0 and yaw carries the rest (gimbal lock).
const GIMBAL_LOCK_COS: f64 = 1e-12;

/// Yaw about z, then pitch about y, then roll about x; rad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ypr {
    /// About z, −π … π.
    pub yaw_rad: f64,
    /// About the turned y, −π/2 … π/2.
    pub pitch_rad: f64,
    /// About the turned x, −π … π.
    pub roll_rad: f64,
}

impl Ypr {
    /// `[yaw, pitch, roll]`, rad.
    pub const fn to_array(self) -> [f64; 3] {
        [self.yaw_rad, self.pitch_rad, self.roll_rad]
    }

    /// From `[yaw, pitch, roll]`, rad.
    pub const fn from_array(ypr_rad: [f64; 3]) -> Self {
        Ypr { yaw_rad: ypr_rad[0], pitch_rad: ypr_rad[1], roll_rad: ypr_rad[2] }
    }
}

impl From<Quaternion> for Ypr {
    fn from(q: Quaternion) -> Self {
        q.to_ypr()
    }
}

impl From<Quaternion> for [f64; 3] {
    /// `[yaw, pitch, roll]`, rad.
    fn from(q: Quaternion) -> Self {
        q.to_ypr().to_array()
    }
}

impl Quaternion {
    /// From yaw, pitch, roll; of unit norm to rounding.
    pub fn from_ypr(ypr: Ypr) -> Self {
        let (sy, cy) = math::sin_cos(0.5 * ypr.yaw_rad);
        let (sp, cp) = math::sin_cos(0.5 * ypr.pitch_rad);
        let (sr, cr) = math::sin_cos(0.5 * ypr.roll_rad);
        Quaternion::new(
            cy * cp * cr + sy * sp * sr,
            cy * cp * sr - sy * sp * cr,
            cy * sp * cr + sy * cp * sr,
            sy * cp * cr - cy * sp * sr,
        )
    }

    /// To yaw, pitch, roll. Pitch is `atan2(−R20, hypot(R00, R10))`, so it keeps its digits near ±π/2.
    ///
    /// Yaw and roll come from their half sum and half difference,
    /// `½(yaw + roll) = atan2(z + x, w − y)` and `½(yaw − roll) = atan2(z − x, w + y)`: near pitch ±π/2 one of the
    /// two is lost in rounding, but it is the one that hardly matters there, so that the three angles
    /// together stay the same rotation (E. Bernardes, S. Viollet, PLoS ONE 17(11), 2022).
    pub fn to_ypr(self) -> Ypr {
        let Quaternion { w, x, y, z } = self;
        let r00 = (w * w + x * x) - (y * y + z * z);
        let r10 = 2.0 * (x * y + w * z);
        let r20 = 2.0 * (x * z - w * y);
        let c = math::hypot(r00, r10);
        let pitch_rad = math::atan2(-r20, c);
        if c < GIMBAL_LOCK_COS {
            // nose up: only yaw − roll is determined; nose down: only yaw + roll
            let half = if r20 < 0.0 { math::atan2(z - x, w + y) } else { math::atan2(z + x, w - y) };
            return Ypr { yaw_rad: wrapped(2.0 * half), pitch_rad, roll_rad: 0.0 };
        }
        let half_sum = math::atan2(z + x, w - y);
        let half_difference = math::atan2(z - x, w + y);
        Ypr {
            yaw_rad: wrapped(half_sum + half_difference),
            pitch_rad,
            roll_rad: wrapped(half_sum - half_difference),
        }
    }
}

/// −2π … 2π to −π … π.
#[inline]
fn wrapped(angle_rad: f64) -> f64 {
    if angle_rad > core::f64::consts::PI {
        angle_rad - core::f64::consts::TAU
    } else if angle_rad < -core::f64::consts::PI {
        angle_rad + core::f64::consts::TAU
    } else {
        angle_rad
    }
}
