//! Means, variances and stillness of a window, and the search for rests in a recording.

use crate::error::{Error, Result};
use crate::filter::check_rows;
use crate::vector::{self, Vec3};

#[cfg(feature = "alloc")]
mod search;

#[cfg(feature = "alloc")]
pub(crate) use search::first_of_checked;
#[cfg(feature = "alloc")]
pub use search::{RestSettings, find_rests, first_rest};

/// Fewer samples than this give no gyroscope bias.
pub const MIN_BIAS_SAMPLES: usize = 10;

/// Mean per axis; refused for no rows or a row that is not finite.
pub fn mean(rows: &[Vec3]) -> Result<Vec3> {
    if rows.is_empty() {
        return Err(Error::Empty);
    }
    check_rows(rows, 0)?;
    Ok(mean_of(rows))
}

/// Population variance per axis (divided by N; one row: 0), from deviations from the mean; refused as
/// [`mean`].
pub fn variance(rows: &[Vec3]) -> Result<Vec3> {
    let mean = mean(rows)?;
    let mut sum = [0.0; 3];
    for &row in rows {
        let d = vector::sub(row, mean);
        for axis in 0..3 {
            sum[axis] += d[axis] * d[axis];
        }
    }
    let n = rows.len() as f64;
    finite([sum[0] / n, sum[1] / n, sum[2] / n])
}

/// Mean of the rows' norms; refused as [`mean`].
pub fn mean_norm(rows: &[Vec3]) -> Result<f64> {
    if rows.is_empty() {
        return Err(Error::Empty);
    }
    check_rows(rows, 0)?;
    let n = rows.len() as f64;
    Ok(finite([rows.iter().fold(0.0, |sum, &row| sum + vector::norm(row)) / n; 3])?[0])
}

/// True when every axis' population variance is at most `variance_max`, (m/s²)², and the mean norm lies in
/// `norm_mean_min ..= norm_mean_max`, m/s². Refused for a negative variance or limits out of order.
pub fn is_stable(
    acc_m_s2: &[Vec3],
    variance_max: f64,
    norm_mean_min: f64,
    norm_mean_max: f64,
) -> Result<bool> {
    crate::filter::not_negative("varThreshold", variance_max)?;
    crate::filter::not_negative("normMeanMin", norm_mean_min)?;
    crate::filter::not_negative("normMeanMax", norm_mean_max)?;
    if norm_mean_min > norm_mean_max {
        return Err(Error::OutOfOrder { rule: "normMeanMin <= normMeanMax" });
    }
    let variance = variance(acc_m_s2)?;
    let norm = mean_norm(acc_m_s2)?;
    Ok(variance.iter().all(|&v| v <= variance_max) && norm >= norm_mean_min && norm <= norm_mean_max)
}

/// Gyroscope bias from rates at rest, rad/s: their mean, or zero for fewer than [`MIN_BIAS_SAMPLES`].
pub fn gyro_bias(gyro_rad_s: &[Vec3]) -> Result<Vec3> {
    check_rows(gyro_rad_s, 0)?;
    if gyro_rad_s.len() < MIN_BIAS_SAMPLES {
        return Ok([0.0; 3]);
    }
    mean(gyro_rad_s)
}

/// The mean of finite rows, at least one. Sums that would overflow are taken of the rows divided by N.
pub(crate) fn mean_of(rows: &[Vec3]) -> Vec3 {
    let n = rows.len() as f64;
    let sum = rows.iter().fold([0.0; 3], |sum, &row| vector::add(sum, row));
    if vector::is_finite(sum) {
        return [sum[0] / n, sum[1] / n, sum[2] / n];
    }
    rows.iter().fold([0.0; 3], |sum, &row| vector::add(sum, [row[0] / n, row[1] / n, row[2] / n]))
}

/// Sums of squares of huge numbers overflow: then they are refused, never returned.
fn finite(v: Vec3) -> Result<Vec3> {
    if vector::is_finite(v) { Ok(v) } else { Err(Error::OutOfRange { rule: "|x| < 1e150", value: f64::MAX }) }
}
