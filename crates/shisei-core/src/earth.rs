//! Earth's rotation from a gyroscope: mean rates by time, and what a radius of their sphere means.
//!
//! `ω̄ = Σ ω_i Δt_i / Σ Δt_i`, with Δt_i from a free-running 32-bit counter that wraps. Sensors with a
//! first-in-first-out memory deliver bursts and gaps; a sample after a gap would weigh as much as the gap is
//! long. So a step longer than 1.5 median steps counts as one median step, unless the rule of the published
//! measurement (every step as it is) is asked for.

use crate::error::{Error, Result};
use crate::filter::positive;

#[cfg(feature = "alloc")]
pub mod advice;
#[cfg(feature = "alloc")]
pub mod analysis;
#[cfg(feature = "alloc")]
pub mod direction;
#[cfg(feature = "alloc")]
pub mod fits;
#[cfg(feature = "alloc")]
mod mean;

#[cfg(feature = "alloc")]
pub use mean::{WeightedMean, Weights, mean_by_steps, mean_by_ticks};

/// Ticks a second of the Spresense multi-IMU board's counter.
pub const SPRESENSE_TICK_HZ: f64 = 19_200_000.0;

/// Steps longer than this many median steps are capped.
pub const CAP_STEPS: f64 = 1.5;

/// The steps of a wrapping counter, ticks: entry k leads from sample k to sample k + 1.
pub fn tick_steps(ticks: &[u32]) -> impl Iterator<Item = u32> {
    ticks.windows(2).map(|pair| pair[1].wrapping_sub(pair[0]))
}

/// Length of a day for a rate of rotation, s: 2π / r; refused unless the rate is finite and greater than zero.
pub fn sidereal_day_s(rate_rad_s: f64) -> Result<f64> {
    let day_s = core::f64::consts::TAU / positive("rate", rate_rad_s)?;
    if day_s.is_finite() { Ok(day_s) } else { Err(Error::NotPositive { name: "rate", value: rate_rad_s }) }
}
