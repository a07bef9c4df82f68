//! Mahony's complementary filter on the rotation group, with exact steps.
//!
//! R. Mahony, T. Hamel, J.-M. Pflimlin, "Nonlinear Complementary Filters on the Special Orthogonal Group",
//! IEEE Trans. Automatic Control 53 (2008). With v = q* (0,0,1) q, the world's z in body axes, and â = a/|a|:
//!
//! ```text
//! e = â × v;   i ← i + ki e dt;   ω' = ω + kp e + i;   q ← normalise(q ⊗ exp(ω' dt / 2))
//! ```
//!
//! From one sample to the next only q (and i) must wait; all that depends on the sample alone, the square
//! root and the division of 1/|a| with it, is prepared apart from the chain and overlaps the sample before.

use super::exponential::{advance, sized};
use super::gyro::half_turn;
use super::{Filter, not_negative};
use crate::error::Result;
use crate::lanes::Number;
use crate::quaternion::Quaternion;
use crate::vector::{self, Vec3};

/// Mahony's filter with constant gains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mahony {
    pub(super) kp: f64,
    pub(super) chain: Chain,
}

impl Mahony {
    /// Starts from an attitude (normalised here), with integral zero.
    ///
    /// - `kp`, 1/s, ≥ 0: how fast tilt follows the accelerometer; 1/kp is the time constant. Small values trust
    ///   the gyroscope (0.2 suits people's movements with a rest bias removed), large ones the accelerometer
    ///   (2 in the worked example of the worksheet functions).
    /// - `ki`, 1/s², ≥ 0: how fast the integral learns a constant gyroscope bias; 0 switches it off.
    ///
    /// Gravity's size plays no part: accelerations enter by their direction only.
    pub fn new(world_from_body: Quaternion, kp: f64, ki: f64) -> Result<Self> {
        Ok(Mahony {
            kp: not_negative("kp", kp)?,
            chain: Chain::new(world_from_body, not_negative("ki", ki)?)?,
        })
    }

    /// A filter whose state is still to be given.
    pub(super) fn in_the_middle(kp: f64, ki: f64) -> Self {
        Mahony { kp, chain: Chain { world_from_body: Quaternion::IDENTITY, integral_rad_s: [0.0; 3], ki } }
    }

    /// The integral i, rad/s in body axes: minus the gyroscope bias learnt so far.
    pub fn integral_rad_s(&self) -> Vec3 {
        self.chain.integral_rad_s
    }
}

impl Filter for Mahony {
    #[inline]
    fn update(&mut self, gyro_rad_s: Vec3, acc_m_s2: Vec3, dt_s: f64) -> Quaternion {
        let kp = self.kp;
        self.chain.step(&Prepared::new(gyro_rad_s, acc_m_s2, dt_s, |_| kp), dt_s)
    }

    fn orientation(&self) -> Quaternion {
        self.chain.world_from_body
    }
}

/// What of a step depends on its sample alone.
#[derive(Clone, Copy, Debug)]
pub(super) struct Prepared<T> {
    /// ½ ω dt.
    pub(super) half_turn: [T; 3],
    /// kp dt â: its product with ½ v is what kp adds to the half turn.
    pub(super) pull: [T; 3],
    /// a.
    pub(super) acc: [T; 3],
    /// |a|.
    pub(super) length: T,
}

impl<T: Number> Prepared<T> {
    /// Of an acceleration of ordinary size.
    #[inline(always)]
    pub(super) fn ordinary(gyro_rad_s: [T; 3], acc: [T; 3], length: T, kp_dt: T, half_dt_s: T) -> Self {
        let half_turn = vector::scale(gyro_rad_s, half_dt_s);
        Prepared { half_turn, pull: vector::scale(acc, kp_dt / length), acc, length }
    }
}

impl Prepared<f64> {
    /// `gain` maps |a|, m/s², to kp.
    #[inline(always)]
    pub(super) fn new(gyro_rad_s: Vec3, acc_m_s2: Vec3, dt_s: f64, gain: impl Fn(f64) -> f64) -> Self {
        let (acc, length, norm) = sized(acc_m_s2);
        let dt_s = if dt_s > 0.0 { dt_s } else { 0.0 };
        Prepared::ordinary(gyro_rad_s, acc, length, gain(norm) * dt_s, 0.5 * dt_s)
    }
}

/// ½ v; |q| = 1 makes its z w² + z² − ½.
#[inline(always)]
pub(super) fn half_up<T: Number>([w, x, y, z]: [T; 4]) -> [T; 3] {
    [x * z - w * y, w * x + y * z, (w * w + z * z) - T::of(0.5)]
}

/// The half turn with the pull towards the accelerometer: a × ½ v is added.
#[inline(always)]
pub(super) fn pulled<T: Number>(base: [T; 3], a: [T; 3], v: [T; 3]) -> [T; 3] {
    [
        (base[0] - a[2] * v[1]) + a[1] * v[2],
        (base[1] + a[2] * v[0]) - a[0] * v[2],
        (base[2] + a[0] * v[1]) - a[1] * v[0],
    ]
}

/// i + ki e dt.
#[inline(always)]
pub(super) fn integrated<T: Number>(
    integral: [T; 3],
    sample: &Prepared<T>,
    half_v: [T; 3],
    ki_dt: T,
) -> [T; 3] {
    let e = vector::cross(sample.acc, half_v);
    vector::add(integral, vector::scale(e, (ki_dt + ki_dt) / sample.length))
}

/// The state that waits for the sample before, shared by both Mahony filters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Chain {
    pub(super) world_from_body: Quaternion,
    pub(super) integral_rad_s: Vec3,
    pub(super) ki: f64,
}

impl Chain {
    pub(super) fn new(world_from_body: Quaternion, ki: f64) -> Result<Self> {
        Ok(Chain { world_from_body: world_from_body.try_normalized()?, integral_rad_s: [0.0; 3], ki })
    }

    #[inline(always)]
    pub(super) fn step(&mut self, sample: &Prepared<f64>, dt_s: f64) -> Quaternion {
        let q = self.world_from_body;
        let v = half_up(q.to_array());
        let base = if self.ki == 0.0 { sample.half_turn } else { self.integrate(sample, v, dt_s) };
        self.world_from_body = advance(q, pulled(base, sample.pull, v));
        self.world_from_body
    }

    /// i ← i + ki e dt, and ½ (ω + i) dt. An integral that would overflow stays as it is.
    #[inline(always)]
    fn integrate(&mut self, sample: &Prepared<f64>, half_v: Vec3, dt_s: f64) -> Vec3 {
        let i = integrated(self.integral_rad_s, sample, half_v, self.ki * dt_s);
        if dt_s > 0.0 && vector::is_finite(i) {
            self.integral_rad_s = i;
        }
        vector::add(sample.half_turn, half_turn(self.integral_rad_s, dt_s))
    }
}
