//! What the values themselves tell: rest, units, gravity, axes, clipping.

use crate::options::Permutation;
use shisei_core::vector::norm;
use shisei_core::{STANDARD_GRAVITY_M_S2 as G, Vec3, math};

/// The stillest stretches of a recording.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Rest {
    /// Median of |a| over the stillest tenth of the windows.
    pub norm: f64,
    /// Mean acceleration over the stillest window.
    pub acc: Vec3,
    /// Largest standard deviation of a gyro axis over the stillest window.
    pub gyro_sigma: f64,
    /// Standard deviation of |a| over the stillest window, relative to its mean.
    pub relative_sigma: f64,
}

/// Finds the stillest windows of `window` rows.
pub(crate) fn rest(acc: &[Vec3], gyro: &[Vec3], window: usize) -> Rest {
    let window = window.clamp(2, acc.len().max(2));
    let mut found: Vec<(f64, f64, usize)> = Vec::new();
    for (k, rows) in acc.chunks(window).enumerate() {
        if rows.len() * 2 < window && k > 0 {
            continue;
        }
        let n = rows.len() as f64;
        let mut mean = [0.0; 3];
        for a in rows {
            for i in 0..3 {
                mean[i] += a[i];
            }
        }
        mean = mean.map(|m| m / n);
        let mut variance = 0.0;
        for a in rows {
            for i in 0..3 {
                variance += (a[i] - mean[i]) * (a[i] - mean[i]);
            }
        }
        variance /= n;
        let level = norm(mean);
        found.push((variance, level, k));
    }
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    // As still as the stillest, at most a tenth of all.
    let limit = found.first().map_or(0.0, |f| 4.0 * f.0);
    let alike = found.iter().take_while(|f| f.0 <= limit).count();
    let count = alike.min((found.len() / 10).max(1));
    let mut norms: Vec<f64> = found.iter().take(count).map(|f| f.1).collect();
    norms.sort_by(f64::total_cmp);
    let mut out = Rest { norm: norms.get(norms.len() / 2).copied().unwrap_or(0.0), ..Rest::default() };
    if let Some((variance, _, k)) = found.first() {
        let rows = k * window..((k + 1) * window).min(acc.len());
        let n = rows.len().max(1) as f64;
        for a in acc.get(rows.clone()).unwrap_or_default() {
            for i in 0..3 {
                out.acc[i] += a[i] / n;
            }
        }
        out.relative_sigma = if out.norm > 0.0 { math::sqrt(*variance) / out.norm } else { 0.0 };
        let rates = gyro.get(rows).unwrap_or_default();
        for i in 0..3 {
            let mean = rates.iter().map(|w| w[i]).sum::<f64>() / n;
            let variance = rates.iter().map(|w| (w[i] - mean) * (w[i] - mean)).sum::<f64>() / n;
            out.gyro_sigma = out.gyro_sigma.max(math::sqrt(variance));
        }
    }
    out
}

/// What |a| at rest says about a unit that is not written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Level {
    /// About 1: g.
    G,
    /// About 9.8: m/s².
    MS2,
    /// About 1000: mg.
    MilliG,
    /// Whole numbers far from any unit: counts.
    Counts,
    /// Next to nothing: gravity was removed.
    NoGravity,
    /// Anything else.
    Unclear,
}

pub(crate) fn level(norm: f64, whole_numbers: bool) -> Level {
    if (0.8..=1.25).contains(&norm) {
        Level::G
    } else if (7.8..=12.3).contains(&norm) {
        Level::MS2
    } else if (850.0..=1180.0).contains(&norm) && !(whole_numbers && (1010.0..=1040.0).contains(&norm)) {
        Level::MilliG
    } else if whole_numbers && norm > 50.0 {
        Level::Counts
    } else if norm < 0.35 {
        Level::NoGravity
    } else {
        Level::Unclear
    }
}

/// Samples at the end of a sensor's range, per axis: how many, and the level. Only axes whose extreme is
/// above `floor` and stands in at least three rows that follow each other count.
pub(crate) fn clipped(values: &[Vec3], floor: f64) -> ([usize; 3], Vec3) {
    let blocks = values.chunks(BLOCK);
    let greatest: Vec<Vec3> = blocks.clone().map(greatest).collect();
    let mut extreme = [0.0f64; 3];
    greatest.iter().for_each(|v| larger(&mut extreme, v));
    let limit = extreme.map(|e| e * (1.0 - 1e-3));
    let ends = |v: &Vec3| [0, 1, 2].map(|i| v[i].abs() >= limit[i]);
    let (mut total, mut run, mut longest) = ([0usize; 3], [0usize; 3], [0usize; 3]);
    for (rows, greatest) in blocks.zip(&greatest) {
        if ends(greatest) == [false; 3] {
            run = [0; 3];
            continue;
        }
        for v in rows {
            let at_end = ends(v);
            for i in 0..3 {
                run[i] = if at_end[i] { run[i] + 1 } else { 0 };
                total[i] += usize::from(at_end[i]);
                longest[i] = longest[i].max(run[i]);
            }
        }
    }
    for i in 0..3 {
        if longest[i] < 3 || extreme[i] <= floor {
            total[i] = 0;
            extreme[i] = 0.0;
        }
    }
    (total, extreme)
}

/// Rows of which one is looked for that is large before each is looked at.
const BLOCK: usize = 64;

/// Greatest sizes per axis.
fn greatest(rows: &[Vec3]) -> Vec3 {
    // Four rows at a time: their maxima need not wait for each other.
    let (fours, last) = rows.as_chunks::<4>();
    let mut most = [[0.0; 3]; 4];
    for four in fours {
        for (most, v) in most.iter_mut().zip(four) {
            larger(most, v);
        }
    }
    let mut all = [0.0; 3];
    most.iter().chain(last).for_each(|v| larger(&mut all, v));
    all
}

fn larger(most: &mut Vec3, v: &Vec3) {
    for i in 0..3 {
        let size = v[i].abs();
        most[i] = if size > most[i] { size } else { most[i] };
    }
}

/// How the direction of gravity in the sensor moves against what the gyro says: for slow motion the
/// derivative of the vertical v is v × ω. Normal equations of the 3×3 matrix M with dv = v × (M θ).
#[derive(Clone, Debug)]
pub(crate) struct Agreement {
    normal: [[f64; 9]; 9],
    right: [f64; 9],
    total: f64,
    /// Steps used.
    pub steps: usize,
}

impl Agreement {
    /// Measures; `block` rows are averaged to one direction.
    pub fn measure(acc: &[Vec3], gyro: &[Vec3], dt_s: &[f64], block: usize, gravity: f64) -> Self {
        let mut out = Agreement { normal: [[0.0; 9]; 9], right: [0.0; 9], total: 0.0, steps: 0 };
        let block = block.max(1);
        // Bias: the median of each axis is enough for signs.
        let mut previous: Option<(Vec3, Vec3)> = None;
        let mut k = 0;
        while (k + 1) * block <= acc.len() {
            let rows = k * block..(k + 1) * block;
            k += 1;
            let n = block as f64;
            let (mut v, mut theta) = ([0.0; 3], [0.0; 3]);
            let mut length = 0.0;
            for i in rows {
                let (Some(a), Some(w), Some(dt)) = (acc.get(i), gyro.get(i), dt_s.get(i)) else { continue };
                let dt = dt.min(1.0);
                for j in 0..3 {
                    v[j] += a[j];
                    theta[j] += w[j] * dt;
                }
                length += dt;
            }
            v = v.map(|x| x / n);
            let size = norm(v);
            let good = size > 0.9 * gravity && size < 1.1 * gravity && length < 1.0;
            if !good {
                previous = None;
                continue;
            }
            let v = v.map(|x| x / size);
            if let Some((v0, theta0)) = previous {
                let turn = [0, 1, 2].map(|i| 0.5 * (theta0[i] + theta[i]));
                let dv = [0, 1, 2].map(|i| v[i] - v0[i]);
                let moved = norm(dv);
                if moved > 0.02 && moved < 0.6 {
                    out.add([0, 1, 2].map(|i| 0.5 * (v[i] + v0[i])), turn, dv);
                }
            }
            previous = Some((v, theta));
        }
        out
    }

    fn add(&mut self, v: Vec3, theta: Vec3, dv: Vec3) {
        // dv = [v]× M θ; the column of M[i][j] is (v × e_i) θ_j.
        let cross = [[0.0, v[2], -v[1]], [-v[2], 0.0, v[0]], [v[1], -v[0], 0.0]];
        let mut rows = [[0.0; 3]; 9];
        for i in 0..3 {
            for j in 0..3 {
                for c in 0..3 {
                    rows[3 * i + j][c] = cross[i][c] * theta[j];
                }
            }
        }
        for a in 0..9 {
            for b in 0..9 {
                self.normal[a][b] +=
                    rows[a][0] * rows[b][0] + rows[a][1] * rows[b][1] + rows[a][2] * rows[b][2];
            }
            self.right[a] += rows[a][0] * dv[0] + rows[a][1] * dv[1] + rows[a][2] * dv[2];
        }
        self.total += dv[0] * dv[0] + dv[1] * dv[1] + dv[2] * dv[2];
        self.steps += 1;
    }

    /// With the gyro's axes mapped by signs and order: the best factor, and the part of the motion that
    /// stays unexplained (0 to 1).
    pub fn fit(&self, from: [usize; 3], negative: [bool; 3]) -> (f64, f64) {
        let mut m = [0.0; 9];
        for i in 0..3 {
            m[3 * i + from[i]] = if negative[i] { -1.0 } else { 1.0 };
        }
        let (mut quadratic, mut linear) = (0.0, 0.0);
        for a in 0..9 {
            linear += m[a] * self.right[a];
            for b in 0..9 {
                quadratic += m[a] * self.normal[a][b] * m[b];
            }
        }
        if quadratic <= 0.0 || self.total <= 0.0 {
            return (0.0, 1.0);
        }
        let factor = linear / quadratic;
        (factor, 1.0 - linear * linear / quadratic / self.total)
    }
}

impl Rest {
    /// The same rest after scaling and turning.
    pub fn converted(&self, acc_factor: f64, gyro_factor: f64, axes: &Permutation) -> Rest {
        Rest {
            norm: self.norm * acc_factor,
            acc: axes.apply(self.acc.map(|a| a * acc_factor)),
            gyro_sigma: self.gyro_sigma * gyro_factor,
            ..*self
        }
    }
}

/// True when z points down at rest, within 45°, in units of g.
pub(crate) fn z_down(rest: &Rest) -> bool {
    rest.acc[2] < -0.7 * norm(rest.acc) && norm(rest.acc) > 0.5 * G
}
