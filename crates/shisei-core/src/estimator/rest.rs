//! Rests, found as they happen: rates and accelerations near their own slow means.
//!
//! The means are first order with a time constant of 0.5 s. A sample is quiet while rate and acceleration stay
//! within their limits of the means, and the mean rate within its limit of the bias that the last rest showed (zero
//! before the first), so that a slow turn is no rest. A sensor of unknown bias is found at rest by being much
//! quieter than a hand can be: a third of the limits, at any mean rate that can be a bias. A rest begins when all
//! samples of the last second were quiet. (After D. Laidig, T. Seel, "VQF", Information Fusion 91 (2023), section
//! 3.4.)

use super::guard::Reading;
use crate::vector::{self, Vec3};

/// Limits of a rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RestLimits {
    /// Time constant of the means, s.
    pub mean_s: f64,
    /// How long it must be quiet, s.
    pub hold_s: f64,
    /// Largest distance of a rate from the mean, rad/s.
    pub rate_rad_s: f64,
    /// Largest distance of an acceleration from the mean, m/s².
    pub acc_m_s2: f64,
    /// Largest distance of an axis' mean rate from the bias, rad/s.
    pub mean_rate_rad_s: f64,
}

impl Default for RestLimits {
    fn default() -> Self {
        RestLimits { mean_s: 0.5, hold_s: 1.0, rate_rad_s: 0.035, acc_m_s2: 0.5, mean_rate_rad_s: 0.035 }
    }
}

/// How much quieter a sensor of unknown bias must be.
const STILLER: f64 = 3.0;
/// Largest bias, rad/s.
const LARGEST_BIAS: f64 = 0.175;

/// The running state of the search.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct RestFinder {
    means: Option<(Vec3, Vec3)>,
    quiet_s: f64,
    still_s: f64,
    bias: Vec3,
}

impl RestFinder {
    /// True while the sensor has been read and at rest for [`RestLimits::hold_s`].
    pub(super) fn update(&mut self, limits: &RestLimits, reading: &Reading) -> bool {
        if !(reading.gyro_known && reading.acc_known) {
            self.restart();
            return false;
        }
        let Reading { gyro, acc, dt_s, .. } = *reading;
        let (mut rate, mut force) = self.means.unwrap_or((gyro, acc));
        let share = dt_s / (limits.mean_s + dt_s);
        rate = vector::add(rate, vector::scale(vector::sub(gyro, rate), share));
        force = vector::add(force, vector::scale(vector::sub(acc, force), share));
        self.means = Some((rate, force));
        let (off_rate, off_force) = (vector::sub(gyro, rate), vector::sub(acc, force));
        let off_rate = vector::dot(off_rate, off_rate) / (limits.rate_rad_s * limits.rate_rad_s);
        let off_force = vector::dot(off_force, off_force) / (limits.acc_m_s2 * limits.acc_m_s2);
        let off = off_rate.max(off_force);
        let near = |centre: Vec3, limit: f64| (0..3).all(|j| (rate[j] - centre[j]).abs() <= limit);
        let quiet = off <= 1.0 && near(self.bias, limits.mean_rate_rad_s);
        let still = off <= 1.0 / (STILLER * STILLER) && near([0.0; 3], LARGEST_BIAS);
        self.quiet_s = if quiet { self.quiet_s + dt_s } else { 0.0 };
        self.still_s = if still { self.still_s + dt_s } else { 0.0 };
        let rest = self.quiet_s >= limits.hold_s || self.still_s >= limits.hold_s;
        if rest {
            self.bias = rate;
        }
        rest
    }

    /// Starts anew, as after a gap.
    pub(super) fn restart(&mut self) {
        *self = RestFinder { bias: self.bias, ..RestFinder::default() };
    }
}
