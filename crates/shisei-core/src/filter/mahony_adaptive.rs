//! Mahony's filter whose gain falls while the accelerometer reads something else than gravity.

use super::mahony::{Chain, Prepared};
use super::{Filter, not_negative, positive};
use crate::STANDARD_GRAVITY_M_S2;
use crate::error::{Error, Result};
use crate::quaternion::Quaternion;
use crate::vector::Vec3;

/// kp as a function of |a|: `kp_max` between the two starts, falling linearly to `kp_min` at the two ends.
///
/// The thresholds are m/s² under standard gravity; n = |a| · 9.80665 / gravity is compared with them, so that
/// data in g work with gravity = 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AdaptiveGain {
    /// Gain near 1 g, 1/s.
    pub kp_max: f64,
    /// Gain outside both ends, 1/s.
    pub kp_min: f64,
    /// n above which kp begins to fall, m/s².
    pub upper_start: f64,
    /// n from which on kp is `kp_min`, m/s².
    pub upper_end: f64,
    /// n below which kp begins to fall, m/s².
    pub lower_start: f64,
    /// n from which down kp is `kp_min`, m/s².
    pub lower_end: f64,
}

impl Default for AdaptiveGain {
    /// The values of the worksheet functions' example: 2, 0.05, 10.3, 14.7, 9.3, 4.9.
    fn default() -> Self {
        AdaptiveGain {
            kp_max: 2.0,
            kp_min: 0.05,
            upper_start: 10.3,
            upper_end: 14.7,
            lower_start: 9.3,
            lower_end: 4.9,
        }
    }
}

impl AdaptiveGain {
    /// Refused unless all are finite, 0 ≤ kpMin ≤ kpMax, 0 ≤ lowerEnd and
    /// lowerEnd < lowerStart ≤ upperStart < upperEnd.
    pub fn check(&self) -> Result<()> {
        let all =
            [self.kp_max, self.kp_min, self.upper_start, self.upper_end, self.lower_start, self.lower_end];
        if all.iter().any(|value| !value.is_finite()) {
            return Err(Error::NotFinite { row: 0 });
        }
        not_negative("kpMin", self.kp_min)?;
        not_negative("accelLowerEnd", self.lower_end)?;
        if self.kp_min > self.kp_max {
            return Err(Error::OutOfOrder { rule: "kpMin <= kpMax" });
        }
        let ascending = self.lower_end < self.lower_start
            && self.lower_start <= self.upper_start
            && self.upper_start < self.upper_end;
        if !ascending {
            return Err(Error::OutOfOrder {
                rule: "accelLowerEnd < accelLowerStart <= accelUpperStart < accelUpperEnd",
            });
        }
        Ok(())
    }

    /// kp for a norm |a| in the data's unit; refused when the gain or gravity is not valid, or the norm is
    /// negative or not finite.
    pub fn kp(&self, acc_norm: f64, gravity: f64) -> Result<f64> {
        self.check()?;
        let gravity = positive("gravity", gravity)?;
        let norm = not_negative("accelNorm", acc_norm)?;
        Ok(self.kp_unchecked(norm * (STANDARD_GRAVITY_M_S2 / gravity)))
    }

    /// kp for n, m/s² under standard gravity.
    #[inline(always)]
    fn kp_unchecked(&self, n: f64) -> f64 {
        let part = if n > self.upper_start {
            (n - self.upper_start) / (self.upper_end - self.upper_start)
        } else if n < self.lower_start {
            (self.lower_start - n) / (self.lower_start - self.lower_end)
        } else {
            return self.kp_max;
        };
        if part < 1.0 { self.kp_max - (self.kp_max - self.kp_min) * part } else { self.kp_min }
    }
}

/// Mahony's filter with the gain of [`AdaptiveGain`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MahonyAdaptive {
    gain: AdaptiveGain,
    to_standard_gravity: f64,
    chain: Chain,
}

impl MahonyAdaptive {
    /// Starts from an attitude (normalised here), with integral zero. `ki`, 1/s², ≥ 0, as
    /// [`Mahony::new`](super::Mahony::new); `gravity`, > 0: what |a| is at rest, in the data's unit.
    pub fn new(world_from_body: Quaternion, gain: AdaptiveGain, ki: f64, gravity: f64) -> Result<Self> {
        gain.check()?;
        Ok(MahonyAdaptive {
            gain,
            to_standard_gravity: STANDARD_GRAVITY_M_S2 / positive("gravity", gravity)?,
            chain: Chain::new(world_from_body, not_negative("ki", ki)?)?,
        })
    }

    /// The integral i, rad/s in body axes: minus the gyroscope bias learnt so far.
    pub fn integral_rad_s(&self) -> Vec3 {
        self.chain.integral_rad_s
    }
}

impl Filter for MahonyAdaptive {
    #[inline]
    fn update(&mut self, gyro_rad_s: Vec3, acc_m_s2: Vec3, dt_s: f64) -> Quaternion {
        let (gain, factor) = (self.gain, self.to_standard_gravity);
        let sample = Prepared::new(gyro_rad_s, acc_m_s2, dt_s, |norm| gain.kp_unchecked(norm * factor));
        self.chain.step(&sample, dt_s)
    }

    fn orientation(&self) -> Quaternion {
        self.chain.world_from_body
    }
}
