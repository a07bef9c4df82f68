//! Orientation filters: one sample in, one attitude out.
//!
//! Every filter is a small `Copy` state with [`Filter::update`]; a series is a loop over the same type, so
//! that both give the same bits. Settings are checked once, by the constructors.
//!
//! What a filter does with samples it cannot use, so that one bad sample never poisons the state:
//! - a rate that is not finite, or a step that is not finite and greater than zero: attitude unchanged;
//! - an acceleration that is zero or not finite: a step by the gyroscope alone.
//!
//! The series functions refuse such numbers instead and name the row; there only a zero acceleration is a
//! step by the gyroscope alone.

mod complementary;
pub mod exponential;
mod gyro;
mod gyro_lanes;
mod mahony;
mod mahony_adaptive;
mod mahony_lanes;

pub use complementary::{Complementary, DEFAULT_ALPHA};
pub use gyro::{GyroIntegrator, GyroOnly, GyroRk4};
pub use mahony::Mahony;
pub use mahony_adaptive::{AdaptiveGain, MahonyAdaptive};
pub use mahony_lanes::{Readings, run_many_in_lanes, run_many_into};

use crate::error::{Error, Result};
use crate::euler::{self, AttitudeRow};
use crate::lanes::{Lanes, Portable};
use crate::quaternion::Quaternion;
use crate::vector::{self, Vec3};

/// Rows that are checked together before they are used, while they are in the nearest cache.
const BLOCK: usize = 128;

/// The time from one sample to the next, s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Dt<'a> {
    /// The same for all samples.
    Constant(f64),
    /// One a sample: entry k is the time from sample k − 1 to sample k (the first is the caller's choice,
    /// usually the nominal step).
    PerSample(&'a [f64]),
}

impl Dt<'_> {
    /// The step that leads to sample k, s.
    #[inline]
    pub fn at(self, k: usize) -> f64 {
        match self {
            Dt::Constant(dt_s) => dt_s,
            Dt::PerSample(dt_s) => dt_s[k],
        }
    }

    /// Refused unless every step is finite and greater than zero and there are `rows` of them.
    pub fn check(self, rows: usize) -> Result<()> {
        match self {
            Dt::Constant(dt_s) => check_step(dt_s, 0),
            Dt::PerSample(dt_s) => {
                if dt_s.len() != rows {
                    return Err(Error::LengthMismatch { first: rows, second: dt_s.len() });
                }
                dt_s.iter().enumerate().try_for_each(|(row, &dt_s)| check_step(dt_s, row))
            }
        }
    }
}

fn check_step(dt_s: f64, row: usize) -> Result<()> {
    if !dt_s.is_finite() {
        return Err(Error::NotFinite { row });
    }
    if dt_s <= 0.0 {
        return Err(Error::NotPositive { name: "dt", value: dt_s });
    }
    Ok(())
}

/// Something that turns rates and accelerations into attitudes.
pub trait Filter {
    /// One sample: rate and specific force in body axes, and the time since the sample before.
    /// Returns `world_from_body` after the sample. Never NaN: see the module's text for unusable samples.
    fn update(&mut self, gyro_rad_s: Vec3, acc_m_s2: Vec3, dt_s: f64) -> Quaternion;

    /// The attitude now, `world_from_body`.
    fn orientation(&self) -> Quaternion;
}

impl<F: Filter + ?Sized> Filter for &mut F {
    fn update(&mut self, gyro_rad_s: Vec3, acc_m_s2: Vec3, dt_s: f64) -> Quaternion {
        (**self).update(gyro_rad_s, acc_m_s2, dt_s)
    }

    fn orientation(&self) -> Quaternion {
        (**self).orientation()
    }
}

#[cfg(feature = "alloc")]
impl<F: Filter + ?Sized> Filter for alloc::boxed::Box<F> {
    fn update(&mut self, gyro_rad_s: Vec3, acc_m_s2: Vec3, dt_s: f64) -> Quaternion {
        (**self).update(gyro_rad_s, acc_m_s2, dt_s)
    }

    fn orientation(&self) -> Quaternion {
        (**self).orientation()
    }
}

/// Runs a filter over a series and writes row k = state after sample k into `out`.
///
/// Refused: unequal lengths, numbers that are not finite (with their row), steps that are not greater than
/// zero. The result may be asked for as [`Quaternion`], `[f64; 4]`, [`Ypr`](crate::Ypr) or `[f64; 3]` (yaw,
/// pitch, roll). After a refusal `out` and the filter have seen some of the rows before the refused one.
#[inline(always)]
pub fn run_into<F: Filter + ?Sized, O: AttitudeRow>(
    filter: &mut F,
    gyro_rad_s: &[Vec3],
    acc_m_s2: &[Vec3],
    dt: Dt<'_>,
    out: &mut [O],
) -> Result<()> {
    let rows = gyro_rad_s.len();
    same_length(rows, acc_m_s2.len())?;
    same_length(rows, out.len())?;
    dt.check(rows)?;
    let mut start = 0;
    while start < rows {
        let end = rows.min(start + BLOCK);
        check_rows(&gyro_rad_s[start..end], start)?;
        check_rows(&acc_m_s2[start..end], start)?;
        euler::fill(&mut out[start..end], |i| {
            let k = start + i;
            filter.update(gyro_rad_s[k], acc_m_s2[k], dt.at(k))
        });
        start = end;
    }
    Ok(())
}

/// [`run_into`] with a new vector.
#[cfg(feature = "alloc")]
pub fn run<F: Filter + ?Sized, O: AttitudeRow + Clone>(
    filter: &mut F,
    gyro_rad_s: &[Vec3],
    acc_m_s2: &[Vec3],
    dt: Dt<'_>,
) -> Result<alloc::vec::Vec<O>> {
    let mut out = alloc::vec![O::from(Quaternion::IDENTITY); gyro_rad_s.len()];
    run_into(filter, gyro_rad_s, acc_m_s2, dt, &mut out)?;
    Ok(out)
}

/// Runs a gyroscope integrator over a series of rates; otherwise as [`run_into`].
pub fn run_gyro_into<F: GyroOnly, O: AttitudeRow>(
    filter: &mut F,
    gyro_rad_s: &[Vec3],
    dt: Dt<'_>,
    out: &mut [O],
) -> Result<()> {
    run_gyro_in_lanes::<1, Portable<1>, F, O>(filter, gyro_rad_s, dt, out)
}

/// [`run_gyro_into`] with `N` parts of the series side by side.
#[inline(always)]
pub fn run_gyro_in_lanes<const N: usize, L: Lanes<N>, F: GyroOnly, O: AttitudeRow>(
    filter: &mut F,
    gyro_rad_s: &[Vec3],
    dt: Dt<'_>,
    out: &mut [O],
) -> Result<()> {
    let rows = gyro_rad_s.len();
    same_length(rows, out.len())?;
    dt.check(rows)?;
    filter.run::<N, L, O>(gyro_rad_s, dt, out)
}

/// [`run_gyro_into`] with a new vector.
#[cfg(feature = "alloc")]
pub fn run_gyro<F: GyroOnly, O: AttitudeRow + Clone>(
    filter: &mut F,
    gyro_rad_s: &[Vec3],
    dt: Dt<'_>,
) -> Result<alloc::vec::Vec<O>> {
    let mut out = alloc::vec![O::from(Quaternion::IDENTITY); gyro_rad_s.len()];
    run_gyro_into(filter, gyro_rad_s, dt, &mut out)?;
    Ok(out)
}

pub(crate) fn same_length(first: usize, second: usize) -> Result<()> {
    if first == second { Ok(()) } else { Err(Error::LengthMismatch { first, second }) }
}

/// Refused at the first row that is not finite; rows count from `first_row`.
#[inline(always)]
pub(crate) fn check_rows(rows: &[Vec3], first_row: usize) -> Result<()> {
    // without a way out in between, so that compilers take several at once
    let mut fine = true;
    for value in rows.as_flattened() {
        fine &= value.is_finite();
    }
    if fine { Ok(()) } else { refused_row(rows, first_row) }
}

#[cold]
fn refused_row(rows: &[Vec3], first_row: usize) -> Result<()> {
    match rows.iter().position(|&v| !vector::is_finite(v)) {
        None => Ok(()),
        Some(k) => Err(Error::NotFinite { row: first_row + k }),
    }
}

/// Refused unless finite and greater than zero.
pub(crate) fn positive(name: &'static str, value: f64) -> Result<f64> {
    if value > 0.0 && value < f64::INFINITY { Ok(value) } else { Err(Error::NotPositive { name, value }) }
}

/// Refused unless finite and zero or more.
pub(crate) fn not_negative(name: &'static str, value: f64) -> Result<f64> {
    if (0.0..f64::INFINITY).contains(&value) { Ok(value) } else { Err(Error::Negative { name, value }) }
}
