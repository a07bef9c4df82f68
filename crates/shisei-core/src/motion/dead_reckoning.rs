//! Dead reckoning: attitude from the rate, velocity and position from the acceleration in world axes.
//!
//! ```text
//! ω = gyro − bias;   q ← Runge–Kutta step with ω;   a = R(q) acc − (0, 0, g)
//! semi-implicit:  v ← v + a dt;                p ← p + v dt      (with the new v)
//! Euler:          p ← p + v dt (the old v);    v ← v + a dt
//! trapezoid:      v' = v + ½ (a₋ + a) dt;      p ← p + ½ (v + v') dt;   v ← v'
//! ```
//!
//! The error grows with the square of the time and more: 10 s without a rest cost decimetres to metres.

use crate::error::{Error, Result};
use crate::filter::{Dt, Filter, GyroRk4, check_rows, positive, same_length};
use crate::quaternion::Quaternion;
use crate::vector::{self, Vec3};

/// Order of the integration steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Scheme {
    /// Position with the new velocity.
    #[default]
    SemiImplicit,
    /// Position with the old velocity.
    Euler,
    /// Means of old and new, of second order: what a careful user picks.
    Trapezoid,
}

/// What is known after a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionState {
    /// Attitude.
    pub world_from_body: Quaternion,
    /// Velocity in world axes, m/s.
    pub velocity_m_s: Vec3,
    /// Position in world axes, m, from the start.
    pub position_m: Vec3,
}

/// Dead reckoning, one sample at a time, from velocity and position zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeadReckoning {
    attitude: GyroRk4,
    gyro_bias_rad_s: Vec3,
    gravity_m_s2: f64,
    scheme: Scheme,
    /// World acceleration without gravity after the sample before; none before the first.
    acc_before: Option<Vec3>,
    velocity_m_s: Vec3,
    position_m: Vec3,
}

impl DeadReckoning {
    /// Starts at rest from an attitude (normalised here).
    ///
    /// - `gyro_bias_rad_s`: mean rate at rest; it is subtracted from every rate.
    /// - `gravity_m_s2`, > 0: mean |a| at rest, measured by the same sensor, so that its scale error cancels.
    pub fn new(
        world_from_body: Quaternion,
        gyro_bias_rad_s: Vec3,
        gravity_m_s2: f64,
        scheme: Scheme,
    ) -> Result<Self> {
        check_rows(&[gyro_bias_rad_s], 0)?;
        Ok(DeadReckoning {
            attitude: GyroRk4::new(world_from_body)?,
            gyro_bias_rad_s,
            gravity_m_s2: positive("gravity", gravity_m_s2)?,
            scheme,
            acc_before: None,
            velocity_m_s: [0.0; 3],
            position_m: [0.0; 3],
        })
    }

    /// One sample and the time since the sample before. With the trapezoid the first sample's acceleration
    /// also stands for the one before it. A sample or step that is not finite, a step not greater than zero,
    /// and a result that would overflow leave the state unchanged.
    pub fn update(&mut self, gyro_rad_s: Vec3, acc_m_s2: Vec3, dt_s: f64) -> MotionState {
        let before = *self;
        let usable = vector::is_finite(gyro_rad_s) && vector::is_finite(acc_m_s2) && dt_s.is_finite();
        if usable && dt_s > 0.0 {
            self.advance(gyro_rad_s, acc_m_s2, dt_s);
            if !(vector::is_finite(self.velocity_m_s) && vector::is_finite(self.position_m)) {
                *self = before;
            }
        }
        self.state()
    }

    fn advance(&mut self, gyro_rad_s: Vec3, acc_m_s2: Vec3, dt_s: f64) {
        let rate = vector::sub(gyro_rad_s, self.gyro_bias_rad_s);
        let q = self.attitude.update(rate, acc_m_s2, dt_s);
        let mut acc = q.rotate(acc_m_s2);
        acc[2] -= self.gravity_m_s2;
        let (v, p) = (self.velocity_m_s, self.position_m);
        let moved = |v: Vec3| vector::add(p, vector::scale(v, dt_s));
        match self.scheme {
            Scheme::SemiImplicit => {
                self.velocity_m_s = vector::add(v, vector::scale(acc, dt_s));
                self.position_m = moved(self.velocity_m_s);
            }
            Scheme::Euler => {
                self.velocity_m_s = vector::add(v, vector::scale(acc, dt_s));
                self.position_m = moved(v);
            }
            Scheme::Trapezoid => {
                let mean = vector::scale(vector::add(self.acc_before.unwrap_or(acc), acc), 0.5);
                self.velocity_m_s = vector::add(v, vector::scale(mean, dt_s));
                self.position_m = moved(vector::scale(vector::add(v, self.velocity_m_s), 0.5));
            }
        }
        self.acc_before = Some(acc);
    }

    /// Over a hole of `dt_s` between two samples (rate, acceleration), the first of them taken already: rate and
    /// acceleration without gravity go from the one to the other, and count for `share` of the time.
    #[cfg(feature = "alloc")]
    pub(super) fn cross(&mut self, ends: [(Vec3, Vec3); 2], dt_s: f64, share: f64, pieces: usize) {
        let middle = |a: Vec3, b: Vec3, f: f64| vector::add(a, vector::scale(vector::sub(b, a), f));
        let rates = ends.map(|(gyro, _)| vector::scale(vector::sub(gyro, self.gyro_bias_rad_s), share));
        let start = self.attitude.orientation();
        let turned = |f: f64| {
            let mean = middle(rates[0], rates[1], 0.5 * f);
            start.product(Quaternion::from_rotation_vector(vector::scale(mean, f * dt_s)))
        };
        let up = [0.0, 0.0, self.gravity_m_s2];
        let linear = [(start, ends[0].1), (turned(1.0), ends[1].1)]
            .map(|(q, acc)| vector::scale(vector::sub(q.rotate(acc), up), share));
        let part = 1.0 / pieces as f64;
        for piece in 0..pieces {
            let f = (piece as f64 + 0.5) * part;
            let rate = middle(rates[0], rates[1], f);
            let force = vector::add(middle(linear[0], linear[1], f), up);
            let acc = turned(f + 0.5 * part).conjugate().rotate(force);
            self.update(vector::add(rate, self.gyro_bias_rad_s), acc, dt_s * part);
        }
    }

    /// What is known now.
    pub fn state(&self) -> MotionState {
        MotionState {
            world_from_body: self.attitude.orientation(),
            velocity_m_s: self.velocity_m_s,
            position_m: self.position_m,
        }
    }

    /// Says that the sensor stands still now: velocity zero, position kept.
    pub fn stop(&mut self) {
        self.velocity_m_s = [0.0; 3];
        self.acc_before = None;
    }

    /// Runs over a series and writes row k = state after sample k. Refused: unequal lengths, numbers that are
    /// not finite (with their row), steps that are not greater than zero.
    pub fn run_into(
        &mut self,
        gyro_rad_s: &[Vec3],
        acc_m_s2: &[Vec3],
        dt: Dt<'_>,
        out: &mut [MotionState],
    ) -> Result<()> {
        same_length(gyro_rad_s.len(), acc_m_s2.len())?;
        same_length(gyro_rad_s.len(), out.len())?;
        if gyro_rad_s.is_empty() {
            return Err(Error::Empty);
        }
        dt.check(gyro_rad_s.len())?;
        check_rows(gyro_rad_s, 0)?;
        check_rows(acc_m_s2, 0)?;
        for (k, row) in out.iter_mut().enumerate() {
            *row = self.update(gyro_rad_s[k], acc_m_s2[k], dt.at(k));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ten steps of 0.1 s with 1 m/s² along x, level: the sums by hand.
    fn end(scheme: Scheme) -> MotionState {
        let mut dead = DeadReckoning::new(Quaternion::IDENTITY, [0.0; 3], 9.8, scheme).unwrap();
        (0..10).for_each(|_| {
            dead.update([0.0; 3], [1.0, 0.0, 9.8], 0.1);
        });
        dead.state()
    }

    fn check(scheme: Scheme, expected_position_m: f64) {
        let state = end(scheme);
        assert!((state.velocity_m_s[0] - 1.0).abs() < 1e-15);
        assert!(
            (state.position_m[0] - expected_position_m).abs() < 1e-15,
            "{scheme:?} {:?}",
            state.position_m
        );
        assert!(state.position_m[2].abs() < 1e-15);
    }

    #[test]
    fn the_three_schemes() {
        check(Scheme::SemiImplicit, 0.55); // 0.01 (1 + … + 10)
        check(Scheme::Euler, 0.45); // 0.01 (0 + … + 9)
        check(Scheme::Trapezoid, 0.5); // ½ a t²
    }

    /// Half a turn about z in 1 s while moving: the bias is removed and the attitude turns the acceleration.
    #[test]
    fn attitude_turns_the_acceleration() {
        let bias = [0.1, -0.2, 0.3];
        let mut dead = DeadReckoning::new(Quaternion::IDENTITY, bias, 9.8, Scheme::Trapezoid).unwrap();
        let rate = vector::add(bias, [0.0, 0.0, core::f64::consts::PI]);
        for _ in 0..10_000 {
            dead.update(rate, [1.0, 0.0, 9.8], 1e-4);
        }
        // ∫ (cos πt, sin πt) dt = (0, 2/π)
        let v = dead.state().velocity_m_s;
        assert!(v[0].abs() < 2e-4 && (v[1] - core::f64::consts::FRAC_2_PI).abs() < 1e-7, "{v:?}");
    }

    #[test]
    fn a_bad_sample_does_not_poison() {
        let mut dead = DeadReckoning::new(Quaternion::IDENTITY, [0.0; 3], 9.8, Scheme::Trapezoid).unwrap();
        let before = dead.update([0.0; 3], [1.0, 0.0, 9.8], 0.1);
        assert_eq!(dead.update([f64::NAN, 0.0, 0.0], [0.0; 3], 0.1), before);
        assert_eq!(dead.update([0.0; 3], [0.0, f64::INFINITY, 0.0], 0.1), before);
        assert_eq!(dead.update([0.0; 3], [0.0; 3], f64::NAN), before);
        assert_eq!(dead.update([0.0; 3], [1e308; 3], 1e308), before);
    }
}
