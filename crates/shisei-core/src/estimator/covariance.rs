//! Covariance of the error states: over an interval, and at measurements.

use super::engine::Rows;
use super::model::MOVING;
use super::transition::Transition;
use crate::math;
use crate::vector::Vec3;

/// Rows that a measurement changes together, from the diagonal's block to the right.
const BLOCK: usize = 9;

/// The covariance, N × N. After measurements only the diagonal and what is right of it is up to date, until
/// [`Covariance::settle`].
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

    /// `Φ P Φᵀ`.
    pub(super) fn propagate(&mut self, transition: &Transition) {
        let moved = transition.moved(&self.0);
        let mut turned = [[0.0; MOVING]; N];
        for r in 0..MOVING {
            for c in 0..N {
                turned[c][r] = moved[r][c];
            }
        }
        let both = transition.moved(&turned);
        for r in 0..MOVING {
            for c in 0..=r {
                self.0[r][c] = both[r][c];
                self.0[c][r] = both[r][c];
            }
            self.0[r][MOVING..].copy_from_slice(&moved[r][MOVING..]);
        }
        for c in MOVING..N {
            self.0[c][..MOVING].copy_from_slice(&turned[c]);
        }
    }

    /// The first column of row a that is up to date while measurements are under way. Whole blocks go faster where
    /// two numbers are added at once; the small filters run where each addition costs.
    #[inline(always)]
    fn first_column(a: usize) -> usize {
        if N > BLOCK { a - a % BLOCK } else { a }
    }

    /// Column `index` while measurements are under way.
    #[inline(always)]
    fn column(&self, index: usize) -> [f64; N] {
        let mut column = self.0[index];
        for k in 0..Self::first_column(index) {
            column[k] = self.0[k][index];
        }
        column
    }

    /// Measurements z of three combinations of error states, one after another, with variance r each: moves
    /// `error`, shrinks the covariance.
    pub(super) fn measure(&mut self, error: &mut [f64; N], rows: &Rows, z: Vec3, r: f64) {
        let mut u = [[0.0; N]; 3];
        for j in 0..3 {
            let mut column = [0.0; N];
            let (mut innovation, mut s) = (z[j], r);
            if let Rows::States(first) = rows {
                column = self.column(first + j);
                innovation -= error[first + j];
            } else {
                rows.terms(j, |index, factor| {
                    for (sum, p) in column.iter_mut().zip(self.column(index)) {
                        *sum += factor * p;
                    }
                    innovation -= factor * error[index];
                });
            }
            // what the measurements before have left of it
            for before in &u[..j] {
                let mut along = 0.0;
                rows.terms(j, |index, factor| along += factor * before[index]);
                for k in 0..N {
                    column[k] -= along * before[k];
                }
            }
            rows.terms(j, |index, factor| s += factor * column[index]);
            let root = 1.0 / math::sqrt(s);
            let step = root * innovation;
            for k in 0..N {
                u[j][k] = column[k] * root;
                error[k] += u[j][k] * step;
            }
        }
        self.subtract::<0>(&u);
        self.subtract::<BLOCK>(&u);
        self.subtract::<{ 2 * BLOCK }>(&u);
        self.subtract::<{ 3 * BLOCK }>(&u);
    }

    #[inline(always)]
    fn subtract<const FIRST: usize>(&mut self, u: &[[f64; N]; 3]) {
        for a in FIRST..N.min(FIRST + BLOCK) {
            let (x, y, z) = (u[0][a], u[1][a], u[2][a]);
            for b in Self::first_column(a)..N {
                self.0[a][b] -= (x * u[0][b] + y * u[1][b]) + z * u[2][b];
            }
        }
    }

    /// Ends the measurements: left of the diagonal is what is right of it.
    pub(super) fn settle(&mut self) {
        for a in 1..N {
            for b in 0..Self::first_column(a) {
                self.0[a][b] = self.0[b][a];
            }
        }
    }

    /// `P x`.
    pub(super) fn times(&self, x: &[f64; N]) -> [f64; N] {
        let mut out = [0.0; N];
        for k in 0..N {
            for (sum, p) in out.iter_mut().zip(&self.0[k]) {
                *sum += x[k] * p;
            }
        }
        out
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
