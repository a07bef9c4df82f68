//! Rests, found as they happen: rates and accelerations near their own slow means.
//!
//! The means are first order with a time constant of 0.5 s. A sample is quiet while rate and acceleration stay
//! within their limits of the means and the mean rate itself is small (a bias is allowed, a slow turn is not);
//! a rest begins when all samples of the last second were quiet. (D. Laidig, T. Seel, "VQF", Information
//! Fusion 91 (2023), section 3.4, with a first-order mean.)

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
    /// Largest mean rate of an axis, rad/s.
    pub mean_rate_rad_s: f64,
}

impl Default for RestLimits {
    fn default() -> Self {
        RestLimits { mean_s: 0.5, hold_s: 1.0, rate_rad_s: 0.035, acc_m_s2: 0.5, mean_rate_rad_s: 0.035 }
    }
}

/// The running state of the search.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct RestFinder {
    means: Option<(Vec3, Vec3)>,
    quiet_s: f64,
}

impl RestFinder {
    /// True while the sensor has been at rest for [`RestLimits::hold_s`].
    pub fn update(&mut self, limits: &RestLimits, gyro: Vec3, acc: Vec3, dt_s: f64) -> bool {
        let (mut rate, mut force) = self.means.unwrap_or((gyro, acc));
        let share = dt_s / (limits.mean_s + dt_s);
        rate = vector::add(rate, vector::scale(vector::sub(gyro, rate), share));
        force = vector::add(force, vector::scale(vector::sub(acc, force), share));
        self.means = Some((rate, force));
        let (off_rate, off_force) = (vector::sub(gyro, rate), vector::sub(acc, force));
        let quiet = vector::dot(off_rate, off_rate) <= limits.rate_rad_s * limits.rate_rad_s
            && vector::dot(off_force, off_force) <= limits.acc_m_s2 * limits.acc_m_s2
            && rate.iter().all(|r| r.abs() <= limits.mean_rate_rad_s);
        self.quiet_s = if quiet { self.quiet_s + dt_s } else { 0.0 };
        self.quiet_s >= limits.hold_s
    }

    /// Starts anew, as after a gap.
    pub fn restart(&mut self) {
        *self = RestFinder::default();
    }
}
