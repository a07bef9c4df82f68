//! Small dense least squares: normal equations, covariances and Levenberg–Marquardt.
//!
//! Everything is a fixed-size array, `[[f64; N]; N]` rows first, with a written order of operations, so that
//! results have the same bits on every target. Residuals and parameters carry the caller's units.

use crate::error::{Error, Result};
use crate::math;
use crate::matrix::{Square, cholesky, cholesky_solve};

/// Inverse of a symmetric positive definite matrix; scaled by its diagonal first, so that parameters of
/// different units do not spoil each other. [`Error::Degenerate`] when it has none.
pub fn inverse_spd<const N: usize>(a: &Square<N>) -> Result<Square<N>> {
    let mut d = [0.0; N];
    for i in 0..N {
        if !(a[i][i].is_finite() && a[i][i] > 0.0) {
            return Err(Error::Degenerate);
        }
        d[i] = 1.0 / math::sqrt(a[i][i]);
    }
    let mut scaled = [[0.0; N]; N];
    for i in 0..N {
        for j in 0..N {
            scaled[i][j] = a[i][j] * d[i] * d[j];
        }
    }
    let l = cholesky(&scaled)?;
    if (0..N).any(|i| l[i][i] * l[i][i] < 1e-14) {
        return Err(Error::Degenerate);
    }
    let mut inverse = [[0.0; N]; N];
    for j in 0..N {
        let mut e = [0.0; N];
        e[j] = 1.0;
        let x = cholesky_solve(&l, &e);
        for i in 0..N {
            inverse[i][j] = x[i] * d[i] * d[j];
        }
    }
    for i in 0..N {
        for j in 0..i {
            let mean = 0.5 * (inverse[i][j] + inverse[j][i]);
            inverse[i][j] = mean;
            inverse[j][i] = mean;
        }
    }
    Ok(inverse)
}

/// vᵀ A v.
pub fn quadratic_form<const N: usize>(a: &Square<N>, v: &[f64; N]) -> f64 {
    let mut sum = 0.0;
    for i in 0..N {
        let mut row = 0.0;
        for j in 0..N {
            row += a[i][j] * v[j];
        }
        sum += v[i] * row;
    }
    sum
}

/// Normal equations of a linearised fit, summed one residual at a time.
#[derive(Clone, Copy, Debug)]
pub struct Normal<const N: usize> {
    /// JᵀWJ.
    pub matrix: Square<N>,
    /// JᵀWr.
    pub gradient: [f64; N],
    /// Σ w r².
    pub cost: f64,
    /// Residuals summed.
    pub count: usize,
}

impl<const N: usize> Default for Normal<N> {
    fn default() -> Self {
        Normal { matrix: [[0.0; N]; N], gradient: [0.0; N], cost: 0.0, count: 0 }
    }
}

impl<const N: usize> Normal<N> {
    /// Adds one residual r with its derivatives j = ∂r/∂parameters and weight w = 1/variance.
    pub fn add(&mut self, j: &[f64; N], r: f64, w: f64) {
        for a in 0..N {
            let wj = w * j[a];
            for b in 0..N {
                self.matrix[a][b] += wj * j[b];
            }
            self.gradient[a] += wj * r;
        }
        self.cost += w * r * r;
        self.count += 1;
    }
}

/// What a fit found.
#[derive(Clone, Copy, Debug)]
pub struct Fit<const N: usize> {
    /// The parameters at the minimum.
    pub parameters: [f64; N],
    /// (JᵀWJ)⁻¹ at the minimum: the covariance where the weights are 1/variance; otherwise multiply it by
    /// `cost / (count − N)`.
    pub inverse_normal: Square<N>,
    /// Σ w r² at the minimum.
    pub cost: f64,
    /// Number of residuals.
    pub count: usize,
    /// Iterations used.
    pub iterations: usize,
}

impl<const N: usize> Fit<N> {
    /// Degrees of freedom: residuals − parameters, 0 at least.
    pub fn degrees_of_freedom(&self) -> usize {
        self.count.saturating_sub(N)
    }

    /// `inverse_normal` scaled by the residuals' own variance s² = cost/(count − N); `None` without degrees of
    /// freedom.
    pub fn covariance_from_residuals(&self) -> Option<Square<N>> {
        let dof = self.degrees_of_freedom();
        if dof == 0 {
            return None;
        }
        let s2 = self.cost / dof as f64;
        let mut c = self.inverse_normal;
        for row in &mut c {
            for v in row {
                *v *= s2;
            }
        }
        Some(c)
    }
}

/// Levenberg–Marquardt (Marquardt's diagonal damping). `system(p)` returns the normal equations at p.
///
/// [`Error::Degenerate`] when the normal matrix has no inverse at the minimum, [`Error::NoConvergence`] after
/// 500 iterations that did not settle.
pub fn levenberg_marquardt<const N: usize>(
    start: [f64; N],
    mut system: impl FnMut(&[f64; N]) -> Normal<N>,
) -> Result<Fit<N>> {
    let mut p = start;
    let mut now = system(&p);
    let first_cost = now.cost;
    let mut lambda = 1e-3;
    for iteration in 1..=500 {
        if !now.cost.is_finite() {
            return Err(Error::NoConvergence);
        }
        let mut damped = now.matrix;
        for i in 0..N {
            damped[i][i] += lambda * now.matrix[i][i];
        }
        let step = match cholesky(&damped) {
            Ok(l) => cholesky_solve(&l, &now.gradient),
            Err(e) => {
                lambda *= 10.0;
                if lambda > 1e12 {
                    return Err(e);
                }
                continue;
            }
        };
        let mut trial = p;
        let mut decrement = 0.0;
        for i in 0..N {
            trial[i] -= step[i];
            decrement += step[i] * now.gradient[i];
        }
        let next = system(&trial);
        let better = next.cost.is_finite() && next.cost <= now.cost;
        // the second bound is for data without noise, whose cost ends in rounding
        let small = decrement.abs() <= 1e-14 * now.cost || decrement.abs() <= 1e-26 * first_cost;
        let settled = better && now.cost - next.cost <= 1e-13 * now.cost && lambda < 1.0;
        if better {
            p = trial;
            now = next;
            lambda = (lambda * 0.1).max(1e-15);
        } else {
            lambda *= 10.0;
        }
        if small || settled || (!better && lambda > 1e12) {
            return Ok(Fit {
                parameters: p,
                inverse_normal: inverse_spd(&now.matrix)?,
                cost: now.cost,
                count: now.count,
                iterations: iteration,
            });
        }
    }
    Err(Error::NoConvergence)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverse_of_a_hilbert_matrix() {
        // the inverse of the 4×4 Hilbert matrix is known in integers
        let mut h = [[0.0; 4]; 4];
        for i in 0..4 {
            for j in 0..4 {
                h[i][j] = 1.0 / (i + j + 1) as f64;
            }
        }
        let expected = [
            [16.0, -120.0, 240.0, -140.0],
            [-120.0, 1200.0, -2700.0, 1680.0],
            [240.0, -2700.0, 6480.0, -4200.0],
            [-140.0, 1680.0, -4200.0, 2800.0],
        ];
        let inverse = inverse_spd(&h).unwrap();
        for i in 0..4 {
            for j in 0..4 {
                assert!((inverse[i][j] - expected[i][j]).abs() < 1e-8 * 6480.0, "{i} {j}");
            }
        }
    }

    #[test]
    fn a_singular_matrix_is_refused() {
        assert_eq!(inverse_spd(&[[1.0, 2.0], [2.0, 4.0]]), Err(Error::Degenerate));
    }

    #[test]
    fn nist_misra1a() {
        // NIST StRD nonlinear regression, Misra1a: y = b1 (1 − exp(−b2 x)), certified values and errors
        let y = [
            10.07, 14.73, 17.94, 23.93, 29.61, 35.18, 40.02, 44.82, 50.76, 55.05, 61.01, 66.40, 75.47, 81.78,
        ];
        let x =
            [77.6, 114.9, 141.1, 190.8, 239.9, 289.0, 332.8, 378.4, 434.8, 477.3, 536.8, 593.1, 689.1, 760.0];
        let fit = levenberg_marquardt([500.0, 1e-4], |p| {
            let mut normal = Normal::default();
            for (x, y) in x.iter().zip(&y) {
                let e = math::exp(-p[1] * x);
                normal.add(&[1.0 - e, p[0] * x * e], p[0] * (1.0 - e) - y, 1.0);
            }
            normal
        })
        .unwrap();
        let c = fit.covariance_from_residuals().unwrap();
        assert!((fit.parameters[0] / 2.3894212918e2 - 1.0).abs() < 1e-8);
        assert!((fit.parameters[1] / 5.5015643181e-4 - 1.0).abs() < 1e-8);
        assert!((math::sqrt(c[0][0]) / 2.7070075241 - 1.0).abs() < 1e-6);
        assert!((math::sqrt(c[1][1]) / 7.2668688436e-6 - 1.0).abs() < 1e-6);
        assert!((fit.cost / 1.2455138894e-1 - 1.0).abs() < 1e-8);
    }
}
