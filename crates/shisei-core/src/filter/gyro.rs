//! Integration of the rate alone: the exact step, and the classical Runge-Kutta step of fourth order.

use super::exponential::{correction, exp_half};
use super::gyro_lanes::{self, BLOCK};
use super::{Dt, Filter, check_rows};
use crate::error::Result;
use crate::euler::{self, AttitudeRow};
use crate::lanes::{Lanes, Number};
use crate::quaternion::{Quaternion, product};
use crate::vector::{self, Vec3};

/// A filter that needs no accelerometer.
pub trait GyroOnly {
    /// One rate, in body axes, and the time since the sample before; `world_from_body` after it.
    fn update_gyro(&mut self, gyro_rad_s: Vec3, dt_s: f64) -> Quaternion;

    /// A series, with the bits of one sample after another however many go side by side. As many rates as rows; steps are checked, rates are not:
    /// refused at the first row that is not finite.
    #[inline(always)]
    fn run<const N: usize, L: Lanes<N>, O: AttitudeRow>(
        &mut self,
        gyro_rad_s: &[Vec3],
        dt: Dt<'_>,
        out: &mut [O],
    ) -> Result<()>
    where
        Self: Sized,
    {
        check_rows(gyro_rad_s, 0)?;
        euler::fill(out, |k| self.update_gyro(gyro_rad_s[k], dt.at(k)));
        Ok(())
    }
}

/// `q ← normalise(q ⊗ exp(ω dt / 2))`: exact where the rate is constant over the step.
///
/// The turns of sixteen samples are multiplied up by themselves, `p ← p ⊗ exp(ω dt / 2)`, and the attitude is that at
/// the block's start times p. So a series can take many blocks side by side and needs one product a block in
/// their order; what it gives has the bits of one sample after another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GyroIntegrator {
    world_from_body: Quaternion,
    /// At the start of the block.
    world_from_block: Quaternion,
    /// Since the start of the block; of unit norm to rounding.
    block_from_body: Quaternion,
    /// Samples since the start of the block, below [`BLOCK`].
    samples: u8,
}

impl GyroIntegrator {
    /// Starts from an attitude, which is normalised; refused when it is zero or not finite.
    pub fn new(world_from_body: Quaternion) -> Result<Self> {
        Ok(Self::starting(world_from_body.try_normalized()?))
    }

    /// At the start of a block.
    #[inline(always)]
    pub(super) fn starting(q: Quaternion) -> Self {
        GyroIntegrator {
            world_from_body: q,
            world_from_block: q,
            block_from_body: Quaternion::IDENTITY,
            samples: 0,
        }
    }

    #[inline(always)]
    pub(super) fn orientation(&self) -> Quaternion {
        self.world_from_body
    }

    /// Samples that are still missing in a block that is under way.
    #[inline(always)]
    pub(super) fn missing(&self) -> usize {
        (BLOCK - usize::from(self.samples)) % BLOCK
    }
}

/// The attitude in a block, renormalised without square root or division.
#[inline(always)]
pub(super) fn in_block<T: Number>(world_from_block: [T; 4], block_from_body: [T; 4]) -> [T; 4] {
    let q = product(world_from_block, block_from_body);
    let r = correction(q);
    q.map(|component| component * r)
}

impl GyroOnly for GyroIntegrator {
    #[inline]
    fn update_gyro(&mut self, gyro_rad_s: Vec3, dt_s: f64) -> Quaternion {
        self.block_from_body = self.block_from_body.product(exp_half(half_turn(gyro_rad_s, dt_s)));
        let q = in_block(self.world_from_block.to_array(), self.block_from_body.to_array());
        self.world_from_body = Quaternion::from_array(q);
        self.samples += 1;
        if usize::from(self.samples) == BLOCK {
            *self = Self::starting(self.world_from_body);
        }
        self.world_from_body
    }

    #[inline(always)]
    fn run<const N: usize, L: Lanes<N>, O: AttitudeRow>(
        &mut self,
        gyro_rad_s: &[Vec3],
        dt: Dt<'_>,
        out: &mut [O],
    ) -> Result<()> {
        gyro_lanes::run::<N, L, O>(self, gyro_rad_s, dt, out)
    }
}

/// ½ ω dt; zero where the step is not greater than zero.
#[inline(always)]
pub(crate) fn half_turn(gyro_rad_s: Vec3, dt_s: f64) -> Vec3 {
    vector::scale(gyro_rad_s, if dt_s > 0.0 { 0.5 * dt_s } else { 0.0 })
}

/// Runge-Kutta of fourth order on `q̇ = ½ q ⊗ (0, ω)` with ω held over the step, then normalised.
///
/// Because ω is held the four stages add up to `q ⊗ (1 + u + u²/2 + u³/6 + u⁴/24)`, u = (0, ½ ω dt), and
/// u² = −|u|²; that is what is computed. Its angle error is |u|⁵/60 rad a step; above 1 rad a step take
/// [`GyroIntegrator`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GyroRk4 {
    world_from_body: Quaternion,
}

impl GyroRk4 {
    /// Starts from an attitude, which is normalised; refused when it is zero or not finite.
    pub fn new(world_from_body: Quaternion) -> Result<Self> {
        Ok(GyroRk4 { world_from_body: world_from_body.try_normalized()? })
    }
}

impl GyroOnly for GyroRk4 {
    #[inline]
    fn update_gyro(&mut self, gyro_rad_s: Vec3, dt_s: f64) -> Quaternion {
        let h = half_turn(gyro_rad_s, dt_s);
        let x = vector::dot(h, h);
        let (c, s) = ((1.0 - 0.5 * x) + x * x / 24.0, 1.0 - x / 6.0);
        let p = self.world_from_body.product(Quaternion::new(c, s * h[0], s * h[1], s * h[2]));
        // A turn beyond 1e38 rad leaves the attitude unchanged.
        if p.norm_squared().is_finite() {
            self.world_from_body = p.normalized();
        }
        self.world_from_body
    }
}

macro_rules! ignores_acceleration {
    ($filter:ty) => {
        impl Filter for $filter {
            #[inline]
            fn update(&mut self, gyro_rad_s: Vec3, _acc_m_s2: Vec3, dt_s: f64) -> Quaternion {
                self.update_gyro(gyro_rad_s, dt_s)
            }

            fn orientation(&self) -> Quaternion {
                self.world_from_body
            }
        }
    };
}

ignores_acceleration!(GyroIntegrator);
ignores_acceleration!(GyroRk4);
