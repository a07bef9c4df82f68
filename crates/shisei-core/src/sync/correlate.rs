//! Where two series with missing values are most alike.
//!
//! Correlation coefficient of x(k) and y(k + lag) over the rows where both are there, for every lag:
//! with masks m and zero-filled values, `n = m_x ⋆ m_y`, `s_x = x ⋆ m_y`, `s_xx = x² ⋆ m_y` and so on,
//! `ρ = (s_xy − s_x s_y / n) / √((s_xx − s_x²/n)(s_yy − s_y²/n))`. Source: D. Padfield, "Masked object
//! registration in the Fourier domain", IEEE Trans. Image Process. 21(5), 2012.

use alloc::vec::Vec;

use super::fourier::{Complex, Fourier, times};
use crate::error::{Error, Result};
use crate::math;

/// A lag at which two series are alike.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Peak {
    /// y is this many rows later than x.
    pub lag: i64,
    /// Correlation coefficient, −1 … 1.
    pub correlation: f64,
}

/// The highest local maxima of the correlation coefficient, highest first, at most `most`, `apart` rows from each
/// other at least. NaN is a missing value. Only lags at which `overlap` rows have both values count. Refused:
/// series without rows, without any value, or without variation.
pub fn peaks(x: &[f64], y: &[f64], overlap: usize, apart: usize, most: usize) -> Result<Vec<Peak>> {
    let length = x.len().saturating_add(y.len());
    if x.is_empty() || y.is_empty() {
        return Err(Error::Empty);
    }
    let fourier = Fourier::new(length)?;
    let (x, mx) = centred(x)?;
    let (y, my) = centred(y)?;
    let square = |values: &[f64]| values.iter().map(|v| v * v).collect::<Vec<f64>>();
    // two real series in one complex one: x + i m; their transforms are parted by symmetry
    let (fx, fmx) = pair(&fourier, &x, &mx)?;
    let (fy, fmy) = pair(&fourier, &y, &my)?;
    let (fxx, fyy) = pair(&fourier, &square(&x), &square(&y))?;
    let (n, sxy) = products(&fourier, [(&fmx, &fmy), (&fx, &fy)])?;
    let (sx, sy) = products(&fourier, [(&fx, &fmy), (&fmx, &fy)])?;
    let (sxx, syy) = products(&fourier, [(&fxx, &fmy), (&fmx, &fyy)])?;
    let size = fourier.len();
    let row = |lag: i64| lag.rem_euclid(size as i64) as usize;
    let scale: f64 = math::sqrt(square(&x).iter().sum::<f64>() * square(&y).iter().sum::<f64>());
    let coefficient = |lag: i64| {
        let k = row(lag);
        let count = math::round(n[k]);
        if count < overlap.max(2) as f64 {
            return f64::NEG_INFINITY;
        }
        let (vx, vy) = (sxx[k] - sx[k] * sx[k] / count, syy[k] - sy[k] * sy[k] / count);
        // stretches without variation, to the transform's rounding
        if vx <= 0.0 || vy <= 0.0 || math::sqrt(vx * vy) < 1e-9 * scale {
            return f64::NEG_INFINITY;
        }
        (sxy[k] - sx[k] * sy[k] / count) / math::sqrt(vx * vy)
    };
    let (first, last) = (1 - x.len() as i64, y.len() as i64 - 1);
    let all: Vec<f64> = (first..=last).map(coefficient).collect();
    let at = |k: usize| all.get(k).copied().unwrap_or(f64::NEG_INFINITY);
    let mut found: Vec<Peak> = (0..all.len())
        .filter(|&k| all[k].is_finite() && all[k] >= at(k.wrapping_sub(1)) && all[k] > at(k + 1))
        .map(|k| Peak { lag: first + k as i64, correlation: all[k] })
        .collect();
    found.sort_by(|a, b| b.correlation.total_cmp(&a.correlation).then(a.lag.cmp(&b.lag)));
    let mut kept: Vec<Peak> = Vec::new();
    for peak in found {
        if kept.len() >= most {
            break;
        }
        if kept.iter().all(|k| k.lag.abs_diff(peak.lag) >= apart as u64) {
            kept.push(peak);
        }
    }
    Ok(kept)
}

/// Values about their mean, 0 where missing, and the mask.
fn centred(values: &[f64]) -> Result<(Vec<f64>, Vec<f64>)> {
    let there = || values.iter().filter(|v| v.is_finite());
    let count = there().count();
    if count == 0 {
        return Err(Error::Empty);
    }
    let mean = there().sum::<f64>() / count as f64;
    let shift = |v: &f64| if v.is_finite() { v - mean } else { 0.0 };
    let mask = values.iter().map(|v| if v.is_finite() { 1.0 } else { 0.0 }).collect();
    Ok((values.iter().map(shift).collect(), mask))
}

/// Transforms of two real series.
fn pair(fourier: &Fourier, a: &[f64], b: &[f64]) -> Result<(Vec<Complex>, Vec<Complex>)> {
    let n = fourier.len();
    let value = |series: &[f64], k: usize| series.get(k).copied().unwrap_or(0.0);
    let mut z: Vec<Complex> = (0..n).map(|k| [value(a, k), value(b, k)]).collect();
    fourier.forward(&mut z)?;
    let mirrored = |k: usize| z[(n - k) % n];
    let even = |k: usize| {
        let (p, m) = (z[k], mirrored(k));
        [0.5 * (p[0] + m[0]), 0.5 * (p[1] - m[1])]
    };
    let odd = |k: usize| {
        let (p, m) = (z[k], mirrored(k));
        [0.5 * (p[1] + m[1]), 0.5 * (m[0] - p[0])]
    };
    Ok(((0..n).map(even).collect(), (0..n).map(odd).collect()))
}

/// Two correlations Σ a(k) b(k + lag) at once, from transforms of real series.
fn products(fourier: &Fourier, pairs: [(&[Complex], &[Complex]); 2]) -> Result<(Vec<f64>, Vec<f64>)> {
    let product = |(a, b): (&[Complex], &[Complex]), k: usize| times([a[k][0], -a[k][1]], b[k]);
    let mut z: Vec<Complex> = (0..fourier.len())
        .map(|k| {
            let (first, second) = (product(pairs[0], k), product(pairs[1], k));
            // first + i second
            [first[0] - second[1], first[1] + second[0]]
        })
        .collect();
    fourier.inverse(&mut z)?;
    Ok((z.iter().map(|v| v[0]).collect(), z.iter().map(|v| v[1]).collect()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noise(rows: usize) -> Vec<f64> {
        let mut state = 7_u64;
        (0..rows)
            .map(|_| {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                (state >> 40) as f64 / f64::from(1 << 24)
            })
            .collect()
    }

    /// The coefficient by its definition.
    fn slow(x: &[f64], y: &[f64], lag: i64) -> f64 {
        let both: Vec<(f64, f64)> = (0..x.len())
            .filter_map(|k| {
                let other = *y.get(usize::try_from(k as i64 + lag).ok()?)?;
                (x[k].is_finite() && other.is_finite()).then_some((x[k], other))
            })
            .collect();
        let n = both.len() as f64;
        let mean = both.iter().fold((0.0, 0.0), |m, b| (m.0 + b.0 / n, m.1 + b.1 / n));
        let sum = |f: fn(f64, f64) -> f64| both.iter().map(|b| f(b.0 - mean.0, b.1 - mean.1)).sum::<f64>();
        sum(|a, b| a * b) / math::sqrt(sum(|a, _| a * a) * sum(|_, b| b * b))
    }

    #[test]
    fn a_shifted_series_with_holes_is_found() {
        let all = noise(400);
        let mut x = all[100..300].to_vec();
        let mut y: Vec<f64> = all[30..350].iter().map(|v| 3.0 * v - 1.0).collect();
        x[20..50].fill(f64::NAN);
        y[150] = f64::NAN;
        let found = peaks(&x, &y, 50, 5, 3).unwrap();
        assert_eq!(found[0].lag, 70);
        assert!((found[0].correlation - 1.0).abs() < 1e-9, "{found:?}");
        for peak in found {
            assert!((peak.correlation - slow(&x, &y, peak.lag)).abs() < 1e-9, "{peak:?}");
        }
    }

    #[test]
    fn nothing_to_compare_is_refused() {
        assert_eq!(peaks(&[], &[1.0], 1, 1, 1), Err(Error::Empty));
        assert_eq!(peaks(&[f64::NAN; 4], &[1.0; 4], 1, 1, 1), Err(Error::Empty));
        assert_eq!(peaks(&[1.0; 8], &[1.0; 8], 1, 1, 1), Ok(Vec::new()));
    }
}
