//! Levenberg and Marquardt on `Σ (|s ∘ (m − b)| − g)²` over six means, and the covariance of its answer.

use super::six_face::FaceWindow;
use crate::error::{Error, Result};
use crate::math;
use crate::matrix::{self, Square};
use crate::vector::{self, Vec3};

const MAX_ITERATIONS: usize = 200;

/// Bias, scale and the covariance of both, in that order.
pub(super) struct Fitted {
    pub bias: Vec3,
    pub scale: Vec3,
    pub covariance: Square<6>,
}

/// Parameters: bias / g, then scale. In units of g all six are of the same size.
type Parameters = [f64; 6];

pub(super) fn fit(windows: &[FaceWindow; 6], gravity: f64) -> Result<Fitted> {
    let mut means = [[0.0; 3]; 6];
    for (mean, window) in means.iter_mut().zip(windows) {
        *mean = vector::scale(window.acc_mean, 1.0 / gravity);
    }
    let mut p = start(&means)?;
    let (mut residual, mut jacobian) = evaluate(&means, &p);
    let mut cost = sum_of_squares(&residual);
    let mut damping = 1e-3;
    let mut converged = false;
    for _ in 0..MAX_ITERATIONS {
        let (normal, gradient) = normal_equations(&jacobian, &residual);
        let mut damped = normal;
        for i in 0..6 {
            damped[i][i] += damping * normal[i][i];
        }
        let l = matrix::cholesky(&damped)?;
        let step = matrix::cholesky_solve(&l, &gradient);
        let mut next = p;
        for i in 0..6 {
            next[i] -= step[i];
        }
        let (next_residual, next_jacobian) = evaluate(&means, &next);
        let next_cost = sum_of_squares(&next_residual);
        let size = step.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
        if next_cost < cost {
            (p, residual, jacobian, cost) = (next, next_residual, next_jacobian, next_cost);
            damping *= 0.1;
        } else {
            damping *= 10.0;
        }
        // units of g: 1e-15 is below the rounding of the means; a damping this large moves nothing any more
        if size < 1e-15 || damping > 1e12 {
            converged = size < 1e-9;
            break;
        }
        if !next_cost.is_finite() && damping > 1e6 {
            break;
        }
    }
    if !converged || p.iter().any(|x| !x.is_finite()) {
        return Err(Error::NoConvergence);
    }
    Ok(Fitted {
        bias: [p[0] * gravity, p[1] * gravity, p[2] * gravity],
        scale: [p[3], p[4], p[5]],
        covariance: covariance(windows, &jacobian, gravity)?,
    })
}

/// Middle and half distance of the two opposite faces.
fn start(means: &[Vec3; 6]) -> Result<Parameters> {
    let mut p = [0.0; 6];
    for axis in 0..3 {
        let (up, down) = (means[2 * axis][axis], means[2 * axis + 1][axis]);
        let span = up - down;
        if span.is_nan() || span <= 0.0 {
            return Err(Error::Degenerate);
        }
        p[axis] = 0.5 * (up + down);
        p[3 + axis] = 2.0 / span;
    }
    Ok(p)
}

/// Residuals |s ∘ (m − b)| − 1 and their derivatives.
fn evaluate(means: &[Vec3; 6], p: &Parameters) -> ([f64; 6], Square<6>) {
    let mut residual = [0.0; 6];
    let mut jacobian = [[0.0; 6]; 6];
    for (k, mean) in means.iter().enumerate() {
        let d = [mean[0] - p[0], mean[1] - p[1], mean[2] - p[2]];
        let c = [p[3] * d[0], p[4] * d[1], p[5] * d[2]];
        let norm = vector::norm(c);
        residual[k] = norm - 1.0;
        for axis in 0..3 {
            jacobian[k][axis] = -p[3 + axis] * c[axis] / norm;
            jacobian[k][3 + axis] = d[axis] * c[axis] / norm;
        }
    }
    (residual, jacobian)
}

fn sum_of_squares(residual: &[f64; 6]) -> f64 {
    residual.iter().fold(0.0, |sum, r| sum + r * r)
}

/// Jᵀ J and Jᵀ r.
fn normal_equations(jacobian: &Square<6>, residual: &[f64; 6]) -> (Square<6>, [f64; 6]) {
    let mut normal = [[0.0; 6]; 6];
    let mut gradient = [0.0; 6];
    for i in 0..6 {
        for k in 0..6 {
            gradient[i] += jacobian[k][i] * residual[k];
        }
        for j in 0..6 {
            for k in 0..6 {
                normal[i][j] += jacobian[k][i] * jacobian[k][j];
            }
        }
    }
    (normal, gradient)
}

/// J⁻¹ diag(variance of each window's |s ∘ (m − b)|) J⁻ᵀ, back in m/s².
fn covariance(windows: &[FaceWindow; 6], jacobian: &Square<6>, gravity: f64) -> Result<Square<6>> {
    let inverse = matrix::inverse(jacobian)?;
    let mut sigma = [0.0; 6];
    for (k, window) in windows.iter().enumerate() {
        let mut variance = 0.0;
        for axis in 0..3 {
            // the residual's derivative by the mean is minus that by the bias
            let slope = jacobian[k][axis];
            variance += slope * slope * window.acc_mean_variance[axis] / (gravity * gravity);
        }
        sigma[k] = math::sqrt(variance);
    }
    let unit = |i: usize| if i < 3 { gravity } else { 1.0 };
    let mut out = [[0.0; 6]; 6];
    for i in 0..6 {
        for j in 0..6 {
            for k in 0..6 {
                out[i][j] += (inverse[i][k] * sigma[k]) * (inverse[j][k] * sigma[k]);
            }
            out[i][j] *= unit(i) * unit(j);
        }
    }
    Ok(out)
}
