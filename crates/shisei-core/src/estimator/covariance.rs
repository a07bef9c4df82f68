//! Covariance of the error states: the transition over an interval and scalar measurements.
//!
//! Only attitude, velocity and position move; the rows of all other states in the transition are those of the
//! identity, and of the moving rows only the stated columns are not zero. Every update subtracts `u uᵀ`, so the
//! matrix stays symmetric to the last bit.

use super::model::{BA, BG, Interval, MG, MOVING, PHI, POS, SA, STATES, VEL};
use crate::math;
use crate::vector::Vec3;

/// Rows of the transition that are not the identity's.
pub(super) type Transition = [[f64; STATES]; MOVING];

/// Columns that can be other than zero, by row.
const COLUMNS: [&[(usize, usize)]; MOVING] = [
    &[(0, 1), (BG, BG + 3), (MG, SA)],
    &[(1, 2), (BG, BG + 3), (MG, SA)],
    &[(2, 3), (BG, BG + 3), (MG, SA)],
    &[(0, 4), (BG, STATES)],
    &[(0, 3), (4, 5), (BG, STATES)],
    &[(0, 3), (5, 6), (BG, STATES)],
    &[(0, 4), (6, 7), (BG, MG), (SA, STATES)],
    &[(0, 3), (4, 5), (7, 8), (BG, MG), (SA, STATES)],
    &[(0, 3), (5, 6), (8, 9), (BG, MG), (SA, STATES)],
];

/// `[f]× m`.
fn cross_matrix<const C: usize>(f: Vec3, m: &[[f64; C]; 3]) -> [[f64; C]; 3] {
    let mut out = [[0.0; C]; 3];
    for c in 0..C {
        out[0][c] = f[1] * m[2][c] - f[2] * m[1][c];
        out[1][c] = f[2] * m[0][c] - f[0] * m[2][c];
        out[2][c] = f[0] * m[1][c] - f[1] * m[0][c];
    }
    out
}

/// Transition over an interval; `keep` is the share of the position that is kept (1 − T/τ).
pub(super) fn transition(sums: &Interval, keep: f64) -> Transition {
    let mut t: Transition = [[0.0; STATES]; MOVING];
    let time = sums.time_s;
    let f = sums.force;
    let skew = [[0.0, -f[2], f[1]], [f[2], 0.0, -f[0]], [-f[1], f[0], 0.0]];
    let by_bias = cross_matrix(f, &sums.attitude_by_bias);
    let by_matrix = cross_matrix(f, &sums.attitude_by_matrix);
    for j in 0..3 {
        t[PHI + j][PHI + j] = 1.0;
        t[VEL + j][VEL + j] = 1.0;
        t[POS + j][POS + j] = keep;
        t[POS + j][VEL + j] = time * keep;
        for l in 0..3 {
            t[PHI + j][BG + l] = sums.attitude_by_bias[j][l];
            t[VEL + j][PHI + l] = -skew[j][l];
            t[POS + j][PHI + l] = -0.5 * time * skew[j][l];
            t[VEL + j][BG + l] = -0.5 * by_bias[j][l];
            t[POS + j][BG + l] = -by_bias[j][l] * time / 6.0;
            t[VEL + j][BA + l] = sums.velocity_by_bias[j][l];
            t[POS + j][BA + l] = 0.5 * time * sums.velocity_by_bias[j][l];
            t[VEL + j][SA + l] = sums.velocity_by_scale[j][l];
            t[POS + j][SA + l] = 0.5 * time * sums.velocity_by_scale[j][l];
        }
        for l in 0..9 {
            t[PHI + j][MG + l] = sums.attitude_by_matrix[j][l];
            t[VEL + j][MG + l] = -0.5 * by_matrix[j][l];
        }
    }
    t
}

/// A scalar measurement, kept for the backward pass: `gain · innovation` was added to the error.
#[derive(Clone, Copy, Debug)]
pub(super) struct Measured<const N: usize> {
    /// P h / √s, s = h P hᵀ + r.
    pub u: [f64; N],
    /// 1/√s.
    pub root: f64,
    /// z − h · error, before the update.
    pub innovation: f64,
}

/// The covariance, N × N.
#[derive(Clone, Copy, Debug)]
pub(super) struct Covariance<const N: usize>(pub [[f64; N]; N]);

impl<const N: usize> Covariance<N> {
    pub(super) fn zero() -> Self {
        Covariance([[0.0; N]; N])
    }

    pub(super) fn set_diagonal(&mut self, first: usize, count: usize, sigma: f64) {
        for k in first..first + count {
            self.0[k][k] = sigma * sigma;
        }
    }

    /// `Φ P Φᵀ` for the sparse transition.
    pub(super) fn propagate(&mut self, t: &Transition) {
        let mut moved = [[0.0; N]; MOVING];
        for r in 0..MOVING {
            let mut row = [0.0; N];
            for &(first, end) in COLUMNS[r] {
                for c in first..end {
                    let factor = t[r][c];
                    for (sum, &p) in row.iter_mut().zip(&self.0[c]) {
                        *sum += factor * p;
                    }
                }
            }
            moved[r] = row;
        }
        for r in 0..MOVING {
            for s in 0..=r {
                let mut sum = 0.0;
                for &(first, end) in COLUMNS[s] {
                    for c in first..end {
                        sum += moved[r][c] * t[s][c];
                    }
                }
                self.0[r][s] = sum;
                self.0[s][r] = sum;
            }
            for c in MOVING..N {
                self.0[r][c] = moved[r][c];
                self.0[c][r] = moved[r][c];
            }
        }
    }

    /// Measurement z of the error state `index` with variance r: moves `error`, shrinks the covariance.
    pub(super) fn measure(&mut self, error: &mut [f64; N], index: usize, z: f64, r: f64) -> Measured<N> {
        let column = self.0[index];
        let innovation = z - error[index];
        self.subtract(error, &column, innovation, column[index] + r)
    }

    /// As [`Covariance::measure`], of the combination `h · error`.
    pub(super) fn measure_row(&mut self, error: &mut [f64; N], h: &[f64; N], z: f64, r: f64) -> Measured<N> {
        let mut column = [0.0; N];
        for (k, &factor) in h.iter().enumerate() {
            if factor != 0.0 {
                for (sum, &p) in column.iter_mut().zip(&self.0[k]) {
                    *sum += factor * p;
                }
            }
        }
        let (mut innovation, mut s) = (z, r);
        for k in 0..N {
            innovation -= h[k] * error[k];
            s += h[k] * column[k];
        }
        self.subtract(error, &column, innovation, s)
    }

    fn subtract(&mut self, error: &mut [f64; N], column: &[f64; N], innovation: f64, s: f64) -> Measured<N> {
        let root = 1.0 / math::sqrt(s);
        let mut u = *column;
        for k in 0..N {
            u[k] *= root;
            error[k] += u[k] * (root * innovation);
        }
        for a in 0..N {
            let factor = u[a];
            for (p, &b) in self.0[a].iter_mut().zip(&u) {
                *p -= factor * b;
            }
        }
        Measured { u, root, innovation }
    }

    /// Forgets how the moving states relate to all others, and sets their variances.
    pub(super) fn restart_moving(&mut self, sigma: [f64; MOVING]) {
        for k in 0..MOVING {
            for c in 0..N {
                self.0[k][c] = 0.0;
                self.0[c][k] = 0.0;
            }
            self.0[k][k] = sigma[k] * sigma[k];
        }
    }

    /// True when every variance is finite and not negative beyond rounding.
    pub(super) fn is_sound(&self) -> bool {
        (0..N).all(|k| self.0[k][k].is_finite() && self.0[k][k] > -1e-9)
    }
}
