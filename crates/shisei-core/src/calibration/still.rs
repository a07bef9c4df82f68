//! Still segments of a recording: where the sensor lay in one pose.
//!
//! A sample is still when the summed variance of the accelerometer over a centred window, and that of the
//! gyroscope, stay below a multiple of the recording's own noise floor (the 10th percentile of the windows).
//! No absolute threshold is needed, so counts, g and m/s² all work (after Tedaldi, Pretto & Menegatti 2014,
//! who take the floor from the first seconds).

use alloc::vec::Vec;

use crate::error::{Error, Result};
use crate::math;
use crate::vector::Vec3;

/// How still segments are found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StillSettings {
    /// Length of the variance window, s; default 0.5. Longer: fewer, cleaner segments.
    pub window_s: f64,
    /// Shortest segment kept, s; default 1.0.
    pub min_duration_s: f64,
    /// Multiple of the noise floor's variance that still counts as still; default 20. Larger accepts poses held
    /// by hand, smaller only a firm support.
    pub floor_multiple: f64,
}

impl Default for StillSettings {
    fn default() -> Self {
        StillSettings { window_s: 0.5, min_duration_s: 1.0, floor_multiple: 20.0 }
    }
}

/// One still segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StillSegment {
    /// First row.
    pub start: usize,
    /// Row after the last.
    pub end: usize,
    /// Mean of the accelerometer, its unit.
    pub acc_mean: Vec3,
    /// Population variance of the accelerometer, an axis.
    pub acc_variance: Vec3,
    /// Mean of the gyroscope, its unit.
    pub gyro_mean: Vec3,
    /// Population variance of the gyroscope, an axis.
    pub gyro_variance: Vec3,
}

impl StillSegment {
    /// From rows `start .. end` of a recording; the caller keeps them inside both series.
    pub fn of(acc: &[Vec3], gyro: &[Vec3], start: usize, end: usize) -> Self {
        let (acc_mean, acc_variance) = moments(acc.get(start..end).unwrap_or(&[]));
        let (gyro_mean, gyro_variance) = moments(gyro.get(start..end).unwrap_or(&[]));
        StillSegment { start, end, acc_mean, acc_variance, gyro_mean, gyro_variance }
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.end - self.start
    }
}

/// Mean and population variance of each axis.
pub(crate) fn moments(rows: &[Vec3]) -> (Vec3, Vec3) {
    let n = rows.len().max(1) as f64;
    let (mut mean, mut variance) = ([0.0; 3], [0.0; 3]);
    for i in 0..3 {
        mean[i] = rows.iter().map(|r| r[i]).sum::<f64>() / n;
        variance[i] = rows.iter().map(|r| (r[i] - mean[i]) * (r[i] - mean[i])).sum::<f64>() / n;
    }
    (mean, variance)
}

/// Summed variance of all windows of `width` rows; entry k belongs to rows k … k + width − 1.
fn window_variances(rows: &[Vec3], width: usize) -> Vec<f64> {
    let (mean, _) = moments(rows);
    let n = width as f64;
    let (mut sum, mut square) = ([0.0; 3], [0.0; 3]);
    let mut variances = Vec::with_capacity(rows.len().saturating_sub(width) + 1);
    for (k, row) in rows.iter().enumerate() {
        for i in 0..3 {
            let v = row[i] - mean[i];
            sum[i] += v;
            square[i] += v * v;
            if k >= width {
                let old = rows[k - width][i] - mean[i];
                sum[i] -= old;
                square[i] -= old * old;
            }
        }
        if k + 1 >= width {
            let total: f64 = (0..3).map(|i| square[i] / n - (sum[i] / n) * (sum[i] / n)).sum();
            variances.push(total.max(0.0));
        }
    }
    variances
}

fn percentile_10(values: &[f64]) -> f64 {
    let mut sorted: Vec<f64> = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 10).copied().unwrap_or(0.0)
}

/// The still segments of a recording, in order; acc and gyro N rows each, one every `dt_s` s. An empty list when
/// nothing is still.
pub fn still_segments(
    acc: &[Vec3],
    gyro: &[Vec3],
    dt_s: f64,
    settings: &StillSettings,
) -> Result<Vec<StillSegment>> {
    if acc.len() != gyro.len() {
        return Err(Error::LengthMismatch { first: acc.len(), second: gyro.len() });
    }
    for (name, value) in [
        ("dt", dt_s),
        ("window_s", settings.window_s),
        ("min_duration_s", settings.min_duration_s),
        ("floor_multiple", settings.floor_multiple),
    ] {
        if !(value > 0.0 && value.is_finite()) {
            return Err(Error::NotPositive { name, value });
        }
    }
    for row in 0..acc.len() {
        if !(crate::vector::is_finite(acc[row]) && crate::vector::is_finite(gyro[row])) {
            return Err(Error::NotFinite { row });
        }
    }
    let width = (math::round(settings.window_s / dt_s).min(1e9) as usize).max(3);
    if acc.len() < width {
        return Ok(Vec::new());
    }
    let acc_variance = window_variances(acc, width);
    let gyro_variance = window_variances(gyro, width);
    let acc_limit = settings.floor_multiple * percentile_10(&acc_variance);
    let gyro_limit = settings.floor_multiple * percentile_10(&gyro_variance);
    let min_rows = (math::round(settings.min_duration_s / dt_s).min(1e9) as usize).max(width);
    let half = width / 2;
    let mut segments = Vec::new();
    let mut start = None;
    for k in 0..=acc_variance.len() {
        let still = k < acc_variance.len() && acc_variance[k] <= acc_limit && gyro_variance[k] <= gyro_limit;
        match (still, start) {
            (true, None) => start = Some(k),
            (false, Some(first)) => {
                // a window speaks for the sample in its middle; the outer ones for their ends
                let from = if first == 0 { 0 } else { first + half };
                let to = if k == acc_variance.len() { acc.len() } else { k + half };
                if to >= from + min_rows {
                    segments.push(StillSegment::of(acc, gyro, from, to));
                }
                start = None;
            }
            _ => {}
        }
    }
    Ok(segments)
}
