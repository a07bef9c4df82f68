//! Means weighted by time.

use alloc::vec::Vec;

use super::{CAP_STEPS, tick_steps};
use crate::error::{Error, Result};
use crate::filter::{check_rows, not_negative, positive, same_length};
use crate::vector::{self, Vec3};

/// What a long step counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Weights {
    /// Beyond 1.5 median steps: one median step.
    #[default]
    Capped,
    /// Its whole length, as the published measurement has it.
    AsMeasured,
}

/// A time-weighted mean.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WeightedMean {
    /// Mean rate, rad/s.
    pub mean_rad_s: Vec3,
    /// Sum of the weights, s.
    pub weight_s: f64,
    /// Time from the first sample to the last, s.
    pub span_s: f64,
    /// Median step, s.
    pub median_step_s: f64,
    /// Steps that were longer than 1.5 median steps.
    pub long_steps: usize,
}

/// The mean rate of a recording by time. The first sample only starts the clock.
///
/// `ticks` is a 32-bit counter that wraps, `tick_hz` its rate. Refused: unequal lengths, fewer than two samples,
/// rates that are not finite, a tick rate not greater than zero, a counter that stands still.
pub fn mean_by_ticks(
    gyro_rad_s: &[Vec3],
    ticks: &[u32],
    tick_hz: f64,
    weights: Weights,
) -> Result<WeightedMean> {
    same_length(gyro_rad_s.len(), ticks.len())?;
    positive("tickRate", tick_hz)?;
    if ticks.len() < 2 {
        return Err(Error::TooFewPoints { given: ticks.len(), needed: 2 });
    }
    check_rows(gyro_rad_s, 0)?;
    let steps: Vec<f64> = tick_steps(ticks).map(f64::from).collect();
    let in_ticks = weighted(&gyro_rad_s[1..], &steps, weights)?;
    Ok(WeightedMean {
        weight_s: in_ticks.weight_s / tick_hz,
        span_s: in_ticks.span_s / tick_hz,
        median_step_s: in_ticks.median_step_s / tick_hz,
        ..in_ticks
    })
}

/// The same with a step a sample, s: entry k is the time from sample k − 1 to sample k and weighs sample k.
/// Refused as [`mean_by_ticks`]; a step may be zero but not negative.
pub fn mean_by_steps(gyro_rad_s: &[Vec3], dt_s: &[f64], weights: Weights) -> Result<WeightedMean> {
    same_length(gyro_rad_s.len(), dt_s.len())?;
    if dt_s.is_empty() {
        return Err(Error::Empty);
    }
    check_rows(gyro_rad_s, 0)?;
    for (row, &dt_s) in dt_s.iter().enumerate() {
        not_negative("dt", dt_s).map_err(|error| error.at_row(row))?;
    }
    weighted(gyro_rad_s, dt_s, weights)
}

fn weighted(gyro_rad_s: &[Vec3], steps: &[f64], weights: Weights) -> Result<WeightedMean> {
    let median = median(steps);
    let limit = CAP_STEPS * median;
    let mut sum = [0.0; 3];
    let (mut weight_s, mut span_s, mut long_steps) = (0.0, 0.0, 0);
    for (&rate, &step) in gyro_rad_s.iter().zip(steps) {
        let long = step > limit;
        long_steps += usize::from(long);
        let weight = if long && weights == Weights::Capped { median } else { step };
        sum = vector::add(sum, vector::scale(rate, weight));
        weight_s += weight;
        span_s += step;
    }
    let mean_rad_s = [sum[0] / weight_s, sum[1] / weight_s, sum[2] / weight_s];
    if weight_s <= 0.0 || !vector::is_finite(mean_rad_s) {
        return Err(Error::Degenerate);
    }
    Ok(WeightedMean { mean_rad_s, weight_s, span_s, median_step_s: median, long_steps })
}

/// The middle value, or the mean of the two middle ones.
fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    let middle = sorted.len() / 2;
    if sorted.len() % 2 == 1 { sorted[middle] } else { 0.5 * sorted[middle - 1] + 0.5 * sorted[middle] }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The counter wraps between the second and the third sample; every step is 10 000 ticks but one of
    /// 30 000, whose sample reads 5 and not 1.
    fn check(weights: Weights, expected_mean: f64, expected_weight_ticks: f64) {
        let ticks = [u32::MAX - 14_999, u32::MAX - 4_999, 5_000, 35_000, 45_000];
        let gyro = [[1e6; 3], [1.0; 3], [1.0; 3], [5.0; 3], [1.0; 3]];
        let found = mean_by_ticks(&gyro, &ticks, 19.2e6, weights).unwrap();
        assert!((found.mean_rad_s[0] - expected_mean).abs() < 1e-15, "{found:?}");
        assert!((found.weight_s - expected_weight_ticks / 19.2e6).abs() < 1e-18);
        assert!((found.span_s - 60_000.0 / 19.2e6).abs() < 1e-18);
        assert_eq!(found.median_step_s, 10_000.0 / 19.2e6);
        assert_eq!(found.long_steps, 1);
    }

    #[test]
    fn means_by_a_wrapping_counter() {
        check(Weights::Capped, 2.0, 40_000.0); // (1 + 1 + 5 + 1)/4
        check(Weights::AsMeasured, 3.0, 60_000.0); // (1 + 1 + 3·5 + 1)/6
    }

    #[test]
    fn means_by_steps() {
        let gyro = [[1.0, 2.0, 3.0], [2.0, 4.0, 6.0]];
        let found = mean_by_steps(&gyro, &[0.1, 0.1], Weights::Capped).unwrap();
        assert!((found.mean_rad_s[2] - 4.5).abs() < 1e-15);
        assert!(mean_by_steps(&gyro, &[0.1, -0.1], Weights::Capped).is_err());
        assert_eq!(mean_by_steps(&gyro, &[0.0, 0.0], Weights::Capped), Err(Error::Degenerate));
        assert_eq!(mean_by_ticks(&gyro, &[7, 7], 1.0, Weights::AsMeasured), Err(Error::Degenerate));
    }
}
