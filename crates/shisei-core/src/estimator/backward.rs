//! The backward pass: what later samples say about earlier ones.
//!
//! Rauch, Tung and Striebel's smoother in the form of Bryson and Frazier: instead of inverting covariances it
//! carries an adjoint λ and its matrix Λ back through the same measurements and transitions (G. J. Bierman,
//! "Fixed interval smoothing with discrete measurements", Int. J. Control 18 (1973)). All measurements at the end of
//! an interval are taken back together; with P the covariance after them, h their rows, r their variances and e
//! what is left of them after the update,
//!
//! ```text
//! measurements: K = P hᵀ/r        C = Kᵀ Λ K + (1 − h K)/r
//!     λ ← λ − hᵀ (Kᵀ λ + e/r)          Λ ← Λ − Λ K h − hᵀ Kᵀ Λ + hᵀ C h
//! transition Φ:
//!     λ ← Φᵀ λ                         Λ ← Φᵀ Λ Φ
//! smoothed error and covariance:
//!     −P λ                             P − P Λ P
//! ```
//!
//! (Kᵀ and e/r are the gain and S⁻¹ times the innovation, written with what the update leaves.)

use super::covariance::Covariance;
use super::engine::{Rows, Step, TRIPLES};
use super::model::MOVING;
use super::transition::{Three, add_product, three};
use crate::vector::Vec3;

/// λ and Λ.
#[derive(Clone, Copy, Debug)]
pub(super) struct Adjoint<const N: usize> {
    vector: [f64; N],
    matrix: [[f64; N]; N],
}

/// `a · b`, in three sums so that one addition need not wait for the other.
#[inline]
fn dot<const N: usize>(a: &[f64; N], b: &[f64; N]) -> f64 {
    let mut sums = [0.0; 3];
    for k in (0..N).step_by(3) {
        for j in 0..3 {
            sums[j] += a[k + j] * b[k + j];
        }
    }
    (sums[0] + sums[1]) + sums[2]
}

impl<const N: usize> Adjoint<N> {
    /// Nothing is known of what comes later.
    pub(super) fn new() -> Self {
        Adjoint { vector: [0.0; N], matrix: [[0.0; N]; N] }
    }

    /// The error of a filtered state, as later samples see it.
    #[inline]
    pub(super) fn error(&self, p: &Covariance<N>) -> [f64; N] {
        p.times(&self.vector).map(|x| -x)
    }

    /// Λ times three columns.
    fn times(&self, columns: &Three<N>) -> Three<N> {
        let mut out = [[0.0; N]; 3];
        for (k, rows) in self.matrix.as_chunks::<3>().0.iter().enumerate() {
            let m = [0, 1, 2].map(|j| [columns[j][3 * k], columns[j][3 * k + 1], columns[j][3 * k + 2]]);
            add_product(&mut out, &m, rows);
        }
        out
    }

    /// Covariance of three smoothed error states from `first` on.
    pub(super) fn covariance(&self, p: &Covariance<N>, first: usize) -> [Vec3; 3] {
        let rows = three(&p.0, first);
        let later = self.times(rows);
        let mut out = [[0.0; 3]; 3];
        for r in 0..3 {
            for c in 0..=r {
                out[r][c] = rows[r][first + c] - dot(&rows[r], &later[c]);
                out[c][r] = out[r][c];
            }
            out[r][r] = out[r][r].max(0.0);
        }
        out
    }

    /// Back through the end of an interval: its measurements, then its transition. `p` is the covariance after it.
    pub(super) fn back(&mut self, step: &Step, p: &Covariance<N>) {
        self.measurements(step, p);
        let mut vector = self.vector.map(|x| [x]);
        step.transition.back(&mut vector);
        self.vector = vector.map(|[x]| x);
        step.transition.back(&mut self.matrix);
        let mut turned = [[0.0; N]; N];
        for a in 0..N {
            for b in 0..N {
                turned[b][a] = self.matrix[a][b];
            }
        }
        step.transition.back(&mut turned);
        // rounding must not tear the halves apart
        for a in 0..N {
            for b in 0..=a {
                self.matrix[a][b] = turned[a][b];
                self.matrix[b][a] = turned[a][b];
            }
        }
    }

    fn measurements(&mut self, step: &Step, p: &Covariance<N>) {
        let measured = step.measured();
        let mut gain = [[[0.0; N]; 3]; TRIPLES];
        let mut later = [[[0.0; N]; 3]; TRIPLES];
        for (m, triple) in measured.iter().enumerate() {
            let weight = 1.0 / triple.variance;
            for j in 0..3 {
                triple.rows.terms(j, |index, factor| {
                    for (sum, x) in gain[m][j].iter_mut().zip(&p.0[index]) {
                        *sum += factor * weight * x;
                    }
                });
            }
            later[m] = self.times(&gain[m]);
        }
        // what changes λ, and C, a block for each pair of triples
        let mut change = [[0.0; 3]; TRIPLES];
        let mut square = [[[[0.0; 3]; 3]; TRIPLES]; TRIPLES];
        for (m, triple) in measured.iter().enumerate() {
            let weight = 1.0 / triple.variance;
            for j in 0..3 {
                change[m][j] = dot(&gain[m][j], &self.vector) + weight * triple.left[j];
                for n in 0..=m {
                    for l in 0..3 {
                        let mut own = if (m, j) == (n, l) { 1.0 } else { 0.0 };
                        triple.rows.terms(j, |index, factor| own -= factor * gain[n][l][index]);
                        square[m][n][j][l] = dot(&gain[m][j], &later[n][l]) + weight * own;
                        square[n][m][l][j] = square[m][n][j][l];
                    }
                }
            }
        }
        for (m, triple) in measured.iter().enumerate() {
            if let Rows::States(first) = triple.rows {
                self.subtract(first, &change[m], &later[m]);
            } else {
                for j in 0..3 {
                    triple.rows.terms(j, |index, factor| {
                        self.vector[index] -= factor * change[m][j];
                        for k in 0..N {
                            self.matrix[index][k] -= factor * later[m][j][k];
                            self.matrix[k][index] -= factor * later[m][j][k];
                        }
                    });
                }
            }
        }
        for (m, triple) in measured.iter().enumerate() {
            for (n, other) in measured.iter().enumerate() {
                for j in 0..3 {
                    triple.rows.terms(j, |index, factor| {
                        for l in 0..3 {
                            let weight = factor * square[m][n][j][l];
                            other.rows.terms(l, |at, by| self.matrix[index][at] += weight * by);
                        }
                    });
                }
            }
        }
    }

    /// λ and Λ less what three error states from `first` on were measured to be.
    #[inline]
    fn subtract(&mut self, first: usize, change: &Vec3, later: &Three<N>) {
        for j in 0..3 {
            self.vector[first + j] -= change[j];
            for (slot, x) in self.matrix[first + j].iter_mut().zip(&later[j]) {
                *slot -= x;
            }
        }
        for (k, row) in self.matrix.iter_mut().enumerate() {
            let slots = &mut row.as_chunks_mut::<3>().0[first / 3];
            for j in 0..3 {
                slots[j] -= later[j][k];
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

    /// Back through a start anew of all that moves.
    pub(super) fn restart_all(&mut self) {
        self.restart();
        self.vector[2] = 0.0;
        self.matrix[2] = [0.0; N];
        for row in &mut self.matrix {
            row[2] = 0.0;
        }
    }

    /// Back through a start of which nothing before is known.
    pub(super) fn forget(&mut self) {
        *self = Adjoint::new();
    }
}
