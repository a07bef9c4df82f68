//! The backward pass: what later samples say about earlier ones.
//!
//! Rauch, Tung and Striebel's smoother in the form of Bierman ("Fixed interval smoothing with discrete
//! measurements", Int. J. Control 18 (1973)): instead of inverting covariances it carries an adjoint λ and its
//! matrix Λ back through the same measurements and transitions,
//!
//! ```text
//! measurement h, gain K, innovation y of variance s:
//!     λ ← λ − h (K·λ) − h y/s          Λ ← (1 − K h)ᵀ Λ (1 − K h) + h hᵀ/s
//! transition Φ:
//!     λ ← Φᵀ λ                         Λ ← Φᵀ Λ Φ
//! smoothed error and covariance:
//!     −P λ                             P − P Λ P
//! ```

use super::covariance::{Covariance, Transition};
use super::engine::{Row, Step};
use super::model::{MOVING, STATES};
use crate::vector::Vec3;

/// λ and Λ.
#[derive(Clone, Copy, Debug)]
pub(super) struct Adjoint<const N: usize> {
    vector: [f64; N],
    matrix: [[f64; N]; N],
    /// False where only states are wanted: Λ is left alone.
    with_matrix: bool,
}

impl<const N: usize> Adjoint<N> {
    /// Nothing is known of what comes later.
    pub(super) fn new(with_matrix: bool) -> Self {
        Adjoint { vector: [0.0; N], matrix: [[0.0; N]; N], with_matrix }
    }

    /// The error of a filtered state, as later samples see it.
    pub(super) fn error(&self, p: &Covariance<N>) -> [f64; N] {
        let mut error = [0.0; N];
        for (slot, row) in error.iter_mut().zip(&p.0) {
            for (a, b) in row.iter().zip(&self.vector) {
                *slot -= a * b;
            }
        }
        error
    }

    /// Covariance of the smoothed attitude.
    pub(super) fn attitude_covariance(&self, p: &Covariance<N>) -> [Vec3; 3] {
        let mut out = [[0.0; 3]; 3];
        for r in 0..3 {
            let mut row = [0.0; N];
            for (factor, later) in p.0[r].iter().zip(&self.matrix) {
                for (sum, l) in row.iter_mut().zip(later) {
                    *sum += factor * l;
                }
            }
            for c in 0..=r {
                let mut sum = p.0[r][c];
                for (a, b) in row.iter().zip(&p.0[c]) {
                    sum -= a * b;
                }
                out[r][c] = sum;
                out[c][r] = sum;
            }
        }
        for k in 0..3 {
            out[k][k] = out[k][k].max(0.0);
        }
        out
    }

    /// Variance of the smoothed error state `index`.
    pub(super) fn variance(&self, p: &Covariance<N>, index: usize) -> f64 {
        let mut sum = p.0[index][index];
        for (factor, later) in p.0[index].iter().zip(&self.matrix) {
            let mut row = 0.0;
            for (l, b) in later.iter().zip(&p.0[index]) {
                row += l * b;
            }
            sum -= factor * row;
        }
        sum.max(0.0)
    }

    /// Back through the end of an interval: its measurements, then its transition.
    pub(super) fn back(&mut self, step: &Step<N>) {
        for (row, measured) in step.measured[..step.count].iter().rev() {
            let h = match row {
                Row::State(index) => {
                    let mut h = [0.0; N];
                    h[*index] = 1.0;
                    h
                }
                Row::Mixed(h) => *h,
            };
            let (u, root) = (&measured.u, measured.root);
            let mut along = 0.0;
            for (a, b) in u.iter().zip(&self.vector) {
                along += a * b;
            }
            let change = root * along + root * root * measured.innovation;
            for (slot, factor) in self.vector.iter_mut().zip(&h) {
                *slot -= factor * change;
            }
            if self.with_matrix {
                self.measured(&h, u, root);
            }
        }
        self.transition(&step.transition);
    }

    fn measured(&mut self, h: &[f64; N], u: &[f64; N], root: f64) {
        let mut w = [0.0; N];
        for (factor, row) in u.iter().zip(&self.matrix) {
            for (sum, l) in w.iter_mut().zip(row) {
                *sum += factor * l;
            }
        }
        let mut square = 0.0;
        for (slot, a) in w.iter_mut().zip(u) {
            *slot *= root;
            square += *slot * a;
        }
        let own = root * square + root * root;
        for a in 0..N {
            let (ha, wa) = (h[a], w[a]);
            if ha == 0.0 {
                for b in 0..N {
                    if h[b] != 0.0 {
                        self.matrix[a][b] -= wa * h[b];
                    }
                }
            } else {
                for b in 0..N {
                    self.matrix[a][b] += ha * h[b] * own - (ha * w[b] + wa * h[b]);
                }
            }
        }
    }

    fn transition(&mut self, t: &Transition) {
        let old = self.vector;
        self.vector[..MOVING].fill(0.0);
        for r in 0..MOVING {
            for c in 0..STATES {
                self.vector[c] += t[r][c] * old[r];
            }
        }
        if !self.with_matrix {
            return;
        }
        // Φᵀ Λ, then its product with Φ
        let mut left = self.matrix;
        for row in &mut left[..MOVING] {
            *row = [0.0; N];
        }
        for r in 0..MOVING {
            for c in 0..STATES {
                let factor = t[r][c];
                if factor != 0.0 {
                    for (sum, l) in left[c].iter_mut().zip(&self.matrix[r]) {
                        *sum += factor * l;
                    }
                }
            }
        }
        for a in 0..N {
            let mut row = left[a];
            row[..MOVING].fill(0.0);
            for r in 0..MOVING {
                let factor = left[a][r];
                for (sum, phi) in row.iter_mut().zip(&t[r]) {
                    *sum += factor * phi;
                }
            }
            self.matrix[a] = row;
        }
        // rounding must not tear the halves apart
        for a in 0..N {
            for b in 0..a {
                let mean = 0.5 * (self.matrix[a][b] + self.matrix[b][a]);
                self.matrix[a][b] = mean;
                self.matrix[b][a] = mean;
            }
        }
    }

    /// Back through a start anew: of the moving states only the heading is the one before.
    pub(super) fn restart(&mut self) {
        for k in (0..MOVING).filter(|&k| k != 2) {
            self.vector[k] = 0.0;
            self.matrix[k] = [0.0; N];
            for row in &mut self.matrix {
                row[k] = 0.0;
            }
        }
    }

    /// Back through a start of which nothing before is known.
    pub(super) fn forget(&mut self) {
        *self = Adjoint::new(self.with_matrix);
    }
}
