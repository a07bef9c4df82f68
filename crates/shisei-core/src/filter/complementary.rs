//! The complementary filter of a small object's node: gyroscope step, then a pull towards the accelerometer's
//! roll and pitch while |a| is near gravity.

use super::exponential::{direction, exp_half};
use super::gyro::half_turn;
use super::{Filter, positive};
use crate::error::{Error, Result};
use crate::initial;
use crate::quaternion::Quaternion;
use crate::vector::{self, Vec3};

/// The usual share of the gyroscope.
pub const DEFAULT_ALPHA: f64 = 0.98;

/// |a|/g between which the accelerometer is believed.
const BELIEVED: (f64, f64) = (0.5, 1.5);

/// `q = nlerp(q_gyro, q_acc, 1 − α)` on the shorter arc while 0.5 < |a|/g < 1.5, else `q = q_gyro`;
/// q_acc has roll and pitch of the acceleration and yaw of q_gyro.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Complementary {
    world_from_body: Quaternion,
    alpha: f64,
    gravity: f64,
}

impl Complementary {
    /// Starts from an attitude (normalised here).
    ///
    /// - `alpha`, 0 … 1, usually 0.98: the gyroscope's share of each sample. The time constant is
    ///   about dt α/(1 − α), so it depends on the sampling rate: 0.98 at 120 Hz is 0.4 s.
    /// - `gravity`, > 0: what |a| is at rest, in the data's unit (9.80665 m/s²).
    pub fn new(world_from_body: Quaternion, alpha: f64, gravity: f64) -> Result<Self> {
        if !(0.0..=1.0).contains(&alpha) {
            return Err(Error::OutOfRange { rule: "0 <= alpha <= 1", value: alpha });
        }
        Ok(Complementary {
            world_from_body: world_from_body.try_normalized()?,
            alpha,
            gravity: positive("gravity", gravity)?,
        })
    }
}

impl Filter for Complementary {
    fn update(&mut self, gyro_rad_s: Vec3, acc_m_s2: Vec3, dt_s: f64) -> Quaternion {
        let half_turn = half_turn(gyro_rad_s, dt_s);
        if dt_s.is_nan() || dt_s <= 0.0 || !vector::is_finite(half_turn) {
            return self.world_from_body;
        }
        let turn = exp_half(half_turn);
        let q_gyro = self.world_from_body.product(turn).normalized();
        let (acc_unit, norm) = direction(acc_m_s2);
        let ratio = norm / self.gravity;
        self.world_from_body = if ratio > BELIEVED.0 && ratio < BELIEVED.1 {
            let yaw_rad = q_gyro.to_ypr().yaw_rad;
            let q_acc = initial::from_direction(acc_unit, yaw_rad);
            Quaternion::nlerp(q_gyro, q_acc, 1.0 - self.alpha)
        } else {
            q_gyro
        };
        self.world_from_body
    }

    fn orientation(&self) -> Quaternion {
        self.world_from_body
    }
}
