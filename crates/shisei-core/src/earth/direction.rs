//! One direction of an Earth-rate measurement: mean rate with its standard error, and its drift.
//!
//! The standard error comes from the scatter of the means of consecutive blocks, so that noise which is not white
//! is counted as it averages, not as its samples scatter.

use alloc::vec::Vec;

use super::{WeightedMean, Weights, mean_by_steps};
use crate::error::Result;
use crate::least_squares::Normal;
use crate::math;
use crate::vector::{self, Vec3};

/// What one direction contributes to the fits.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Direction {
    /// Mean rate, body, rad/s.
    pub gyro_rad_s: Vec3,
    /// Its standard error an axis, rad/s, where known.
    pub sigma_rad_s: Option<Vec3>,
    /// Mean acceleration, body, m/s² (any scale: its direction counts), where known.
    pub acc_m_s2: Option<Vec3>,
    /// Heading it was set up at, clockwise from above, rad from any zero, where known.
    pub heading_rad: Option<f64>,
}

/// A recording of one direction, summed up.
#[derive(Clone, Debug, PartialEq)]
pub struct DirectionSummary {
    /// For the fits.
    pub direction: Direction,
    /// The mean and how it was weighted.
    pub mean: WeightedMean,
    /// Means of consecutive blocks: time of the middle s, rate rad/s, temperature °C (NaN where unknown).
    pub blocks: Vec<(f64, Vec3, f64)>,
    /// Mean temperature, °C.
    pub temperature_c: Option<f64>,
}

/// Number of blocks that give the standard error.
pub const BLOCKS: usize = 20;

/// Sums up a recording of one direction: gyro, acc (same length, or empty) and temperature (same length, or
/// empty), `dt_s` a sample. The errors are those of [`mean_by_steps`]; with fewer than 60 samples there is no
/// standard error.
pub fn summarise(
    gyro_rad_s: &[Vec3],
    acc_m_s2: &[Vec3],
    temperature_c: &[f64],
    dt_s: &[f64],
    weights: Weights,
) -> Result<DirectionSummary> {
    let mean = mean_by_steps(gyro_rad_s, dt_s, weights)?;
    let rows = gyro_rad_s.len();
    let mut blocks = Vec::new();
    let mut sigma = None;
    if rows >= 3 * BLOCKS {
        let mut time = 0.0;
        for b in 0..BLOCKS {
            let range = b * rows / BLOCKS..(b + 1) * rows / BLOCKS;
            let part = mean_by_steps(&gyro_rad_s[range.clone()], &dt_s[range.clone()], weights)?;
            let temperature =
                temperature_c.get(range.clone()).map_or(f64::NAN, |t| t.iter().sum::<f64>() / t.len() as f64);
            blocks.push((time + 0.5 * part.span_s, part.mean_rad_s, temperature));
            time += part.span_s;
        }
        let mut s = [0.0; 3];
        for i in 0..3 {
            let m = blocks.iter().map(|b| b.1[i]).sum::<f64>() / BLOCKS as f64;
            let scatter: f64 = blocks.iter().map(|b| (b.1[i] - m) * (b.1[i] - m)).sum();
            s[i] = math::sqrt(scatter / ((BLOCKS - 1) * BLOCKS) as f64);
        }
        sigma = Some(s);
    }
    let mean_of = |rows: &[Vec3]| {
        let sum = rows.iter().fold([0.0; 3], |a, b| vector::add(a, *b));
        vector::scale(sum, 1.0 / rows.len() as f64)
    };
    Ok(DirectionSummary {
        direction: Direction {
            gyro_rad_s: mean.mean_rad_s,
            sigma_rad_s: sigma,
            acc_m_s2: (acc_m_s2.len() == rows).then(|| mean_of(acc_m_s2)),
            heading_rad: None,
        },
        mean,
        blocks,
        temperature_c: (temperature_c.len() == rows).then(|| temperature_c.iter().sum::<f64>() / rows as f64),
    })
}

/// Drift of the gyroscope's bias within the recordings, every axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drift {
    /// Per time, rad/s per s.
    pub per_s: Vec3,
    /// Its standard error.
    pub per_s_sigma: Vec3,
    /// Per temperature, rad/s per °C; none where the temperature is unknown or hardly changed.
    pub per_c: Option<(Vec3, Vec3)>,
    /// Span of temperature used, °C.
    pub temperature_span_c: f64,
}

/// Bias drift by time and temperature, from the blocks of all recordings together; each recording has its own
/// mean, so that the directions do not matter. None with fewer than two recordings' worth of blocks.
pub fn drift(recordings: &[DirectionSummary]) -> Option<Drift> {
    let mut rows: Vec<(f64, f64, Vec3)> = Vec::new();
    let mut temperatures = true;
    for r in recordings.iter().filter(|r| r.blocks.len() > 3) {
        let n = r.blocks.len() as f64;
        let mean = |f: &dyn Fn(&(f64, Vec3, f64)) -> f64| r.blocks.iter().map(f).sum::<f64>() / n;
        let (t, c) = (mean(&|b| b.0), mean(&|b| b.2));
        temperatures &= c.is_finite();
        let g = [mean(&|b| b.1[0]), mean(&|b| b.1[1]), mean(&|b| b.1[2])];
        rows.extend(r.blocks.iter().map(|b| (b.0 - t, b.2 - c, vector::sub(b.1, g))));
    }
    if rows.len() < BLOCKS {
        return None;
    }
    let (low, high) =
        rows.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |a, r| (a.0.min(r.1), a.1.max(r.1)));
    let span = if temperatures { high - low } else { 0.0 };
    let with_temperature = span > 0.2;
    let dof = rows.len().saturating_sub(recordings.len() + 2).max(1) as f64;
    let mut found = Drift {
        per_s: [0.0; 3],
        per_s_sigma: [0.0; 3],
        per_c: with_temperature.then_some(([0.0; 3], [0.0; 3])),
        temperature_span_c: span,
    };
    for axis in 0..3 {
        let mut normal = Normal::<2>::default();
        for (t, c, g) in &rows {
            normal.add(&[*t, if with_temperature { *c } else { 0.0 }], g[axis], 1.0);
        }
        if !with_temperature {
            normal.matrix[1][1] = 1.0;
        }
        let inverse = crate::least_squares::inverse_spd(&normal.matrix).ok()?;
        let p = crate::matrix::times_vector(&inverse, &normal.gradient);
        let cost = normal.cost - p[0] * normal.gradient[0] - p[1] * normal.gradient[1];
        let s2 = cost.max(0.0) / dof;
        found.per_s[axis] = p[0];
        found.per_s_sigma[axis] = math::sqrt(inverse[0][0] * s2);
        if let Some((value, sigma)) = &mut found.per_c {
            value[axis] = p[1];
            sigma[axis] = math::sqrt(inverse[1][1] * s2);
        }
    }
    Some(found)
}
