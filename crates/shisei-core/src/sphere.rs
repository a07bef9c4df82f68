//! Spheres and circles through points: where a field of constant size, turned and shifted by a bias, lies.
//!
//! Sphere: with X = points − centroid solve `(Σ X Xᵀ) C = ½ Σ X |X|²`; `r² = |C|² + Σ|X|²/N`. The points must
//! leave their plane clearly: the condition number says how clearly. Points in one plane (a level turntable)
//! determine only their circle, which is fitted in the plane that is nearest to them.

use crate::error::{Error, Result};
use crate::filter::check_rows;
use crate::math;
use crate::matrix;
use crate::rest;
use crate::vector::{self, Vec3};

/// Above this condition number a sphere's centre along the thin direction is mostly noise: the points should
/// be read as a circle. A sphere's even sampling has 1, the corners of a half-height band about 10.
pub const FLAT_CONDITION: f64 = 100.0;

/// A sphere through points, in the points' unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SphereFit {
    /// Centre.
    pub center: Vec3,
    /// Radius.
    pub radius: f64,
    /// Root mean square of |point − centre| − radius.
    pub residual_rms: f64,
    /// Standard error of the radius from the residuals; none for four points, which leave none.
    pub radius_sigma: Option<f64>,
    /// Largest by smallest eigenvalue of Σ X Xᵀ; infinite when the smallest comes out as zero.
    pub condition: f64,
    /// Root mean square distance of the points from their best plane.
    pub plane_rms: f64,
}

impl SphereFit {
    /// True when the points lie so nearly in one plane ([`FLAT_CONDITION`]) that a circle should be fitted.
    pub fn is_nearly_flat(&self) -> bool {
        self.condition > FLAT_CONDITION
    }
}

/// A circle through points, in the points' unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CircleFit {
    /// Centre.
    pub center: Vec3,
    /// Unit normal of the plane; its largest component is positive.
    pub normal: Vec3,
    /// Radius.
    pub radius: f64,
    /// Root mean square of the distance from the centre in the plane − radius.
    pub residual_rms: f64,
    /// Standard error of the radius from the residuals; none for three points, which leave none.
    pub radius_sigma: Option<f64>,
    /// Larger by smaller eigenvalue of Σ X Xᵀ in the plane.
    pub condition: f64,
    /// Root mean square distance of the points from the plane.
    pub plane_rms: f64,
}

/// Points about their centroid, scaled so that nothing over- or underflows.
struct Centred {
    centroid: Vec3,
    scale: f64,
    /// Σ X Xᵀ.
    spread: [[f64; 3]; 3],
    /// Eigenvalues of it, ascending, and its eigenvectors (columns).
    values: [f64; 3],
    vectors: [[f64; 3]; 3],
}

impl Centred {
    fn new(points: &[Vec3], needed: usize) -> Result<Self> {
        if points.len() < needed {
            return Err(Error::TooFewPoints { given: points.len(), needed });
        }
        check_rows(points, 0)?;
        let centroid = rest::mean_of(points);
        let mut scale = 0.0_f64;
        for &point in points {
            let x = vector::sub(point, centroid);
            scale = scale.max(x[0].abs()).max(x[1].abs()).max(x[2].abs());
        }
        if scale == 0.0 || !scale.is_finite() {
            return Err(Error::Degenerate);
        }
        let mut spread = [[0.0; 3]; 3];
        for &point in points {
            let x = unscaled(point, centroid, scale);
            for i in 0..3 {
                for j in 0..3 {
                    spread[i][j] += x[i] * x[j];
                }
            }
        }
        let (values, vectors) = matrix::symmetric_eigen(&spread);
        Ok(Centred { centroid, scale, spread, values, vectors })
    }

    fn point(&self, point: Vec3) -> Vec3 {
        unscaled(point, self.centroid, self.scale)
    }

    /// Column k of the eigenvectors.
    fn axis(&self, k: usize) -> Vec3 {
        [self.vectors[0][k], self.vectors[1][k], self.vectors[2][k]]
    }

    fn plane_rms(&self, points: usize) -> f64 {
        math::sqrt(self.values[0].max(0.0) / points as f64) * self.scale
    }
}

fn unscaled(point: Vec3, centroid: Vec3, scale: f64) -> Vec3 {
    let x = vector::sub(point, centroid);
    [x[0] / scale, x[1] / scale, x[2] / scale]
}

/// The least-squares sphere through at least four points. Refused: too few points, numbers that are not finite,
/// points in one plane to rounding ([`Error::Degenerate`]).
pub fn fit_sphere(points: &[Vec3]) -> Result<SphereFit> {
    let centred = Centred::new(points, 4)?;
    let mut moment = [0.0; 3];
    let mut squares = 0.0;
    for &point in points {
        let x = centred.point(point);
        let square = vector::dot(x, x);
        moment = vector::add(moment, vector::scale(x, 0.5 * square));
        squares += square;
    }
    let c = matrix::times_vector(&matrix::inverse(&centred.spread)?, &moment);
    let n = points.len() as f64;
    let radius = math::sqrt(vector::dot(c, c) + squares / n);
    // residuals, and the normal matrix of (centre, radius) for the radius' standard error
    let mut residuals = 0.0;
    let mut normal = [[0.0; 4]; 4];
    for &point in points {
        let d = vector::sub(centred.point(point), c);
        let distance = vector::norm(d);
        residuals += (distance - radius) * (distance - radius);
        let row = [d[0] / distance, d[1] / distance, d[2] / distance, 1.0];
        accumulate(&mut normal, &row);
    }
    let fit = SphereFit {
        center: vector::add(centred.centroid, vector::scale(c, centred.scale)),
        radius: radius * centred.scale,
        residual_rms: math::sqrt(residuals / n) * centred.scale,
        radius_sigma: sigma(&normal, 3, residuals, points.len()).map(|sigma| sigma * centred.scale),
        condition: if centred.values[0] > 0.0 {
            centred.values[2] / centred.values[0]
        } else {
            f64::INFINITY
        },
        plane_rms: centred.plane_rms(points.len()),
    };
    finite(fit.radius, fit.center).map(|()| fit)
}

/// The least-squares circle through at least three points, in their best plane. Refused: too few points,
/// numbers that are not finite, points on one line to rounding ([`Error::Degenerate`]).
pub fn fit_circle(points: &[Vec3]) -> Result<CircleFit> {
    let centred = Centred::new(points, 3)?;
    let (e1, e2, mut normal) = (centred.axis(2), centred.axis(1), centred.axis(0));
    let largest = normal.iter().fold(0.0_f64, |best, &x| if x.abs() > best.abs() { x } else { best });
    if largest < 0.0 {
        normal = vector::scale(normal, -1.0);
    }
    let in_plane = |point: Vec3| {
        let x = centred.point(point);
        [vector::dot(x, e1), vector::dot(x, e2)]
    };
    let mut spread = [[0.0; 2]; 2];
    let mut moment = [0.0; 2];
    let mut squares = 0.0;
    for &point in points {
        let x = in_plane(point);
        let square = x[0] * x[0] + x[1] * x[1];
        squares += square;
        for i in 0..2 {
            moment[i] += 0.5 * x[i] * square;
            for j in 0..2 {
                spread[i][j] += x[i] * x[j];
            }
        }
    }
    if centred.values[1] <= 1e-13 * centred.values[2] {
        return Err(Error::Degenerate);
    }
    let c = matrix::times_vector(&matrix::inverse(&spread)?, &moment);
    let n = points.len() as f64;
    let radius = math::sqrt(c[0] * c[0] + c[1] * c[1] + squares / n);
    let mut residuals = 0.0;
    let mut information = [[0.0; 3]; 3];
    for &point in points {
        let x = in_plane(point);
        let d = [x[0] - c[0], x[1] - c[1]];
        let distance = math::hypot(d[0], d[1]);
        residuals += (distance - radius) * (distance - radius);
        accumulate(&mut information, &[d[0] / distance, d[1] / distance, 1.0]);
    }
    let shift = vector::add(vector::scale(e1, c[0]), vector::scale(e2, c[1]));
    let fit = CircleFit {
        center: vector::add(centred.centroid, vector::scale(shift, centred.scale)),
        normal,
        radius: radius * centred.scale,
        residual_rms: math::sqrt(residuals / n) * centred.scale,
        radius_sigma: sigma(&information, 2, residuals, points.len()).map(|sigma| sigma * centred.scale),
        condition: centred.values[2] / centred.values[1],
        plane_rms: centred.plane_rms(points.len()),
    };
    finite(fit.radius, fit.center).map(|()| fit)
}

/// The answer of nearly flat points of a huge size may lie beyond all numbers.
fn finite(radius: f64, center: Vec3) -> Result<()> {
    if radius.is_finite() && vector::is_finite(center) { Ok(()) } else { Err(Error::Degenerate) }
}

fn accumulate<const N: usize>(normal: &mut [[f64; N]; N], row: &[f64; N]) {
    for i in 0..N {
        for j in 0..N {
            normal[i][j] += row[i] * row[j];
        }
    }
}

/// Standard error of parameter `k`: residual variance with N − parameters degrees of freedom.
fn sigma<const N: usize>(normal: &[[f64; N]; N], k: usize, residuals: f64, points: usize) -> Option<f64> {
    if points <= N {
        return None;
    }
    let inverse = matrix::inverse(normal).ok()?;
    Some(math::sqrt(inverse[k][k].max(0.0) * residuals / (points - N) as f64))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_on_a_sphere_give_it_back() {
        for scale in [1.0, 1e-200, 1e150] {
            let center = [3.0 * scale, -2.0 * scale, 0.5 * scale];
            let directions = [
                [0.6, 0.8, 0.0],
                [0.0, 0.6, -0.8],
                [0.0, -0.28, 0.96],
                [-0.96, 0.0, 0.28],
                [0.48, 0.64, 0.6],
            ];
            let points = directions.map(|d| vector::add(center, vector::scale(d, 2.0 * scale)));
            let fit = fit_sphere(&points).unwrap();
            assert!((fit.radius / scale - 2.0).abs() < 1e-14);
            for k in 0..3 {
                assert!(((fit.center[k] - center[k]) / scale).abs() < 1e-14);
            }
            assert!(fit.residual_rms / scale < 1e-14 && fit.radius_sigma.unwrap() / scale < 1e-13);
        }
    }

    /// A circle of radius 2 in the plane through (1, 1, 1) with normal (1, 2, 2)/3.
    #[test]
    fn points_on_a_circle_give_it_back() {
        let (e1, e2) = ([2.0 / 3.0, 1.0 / 3.0, -2.0 / 3.0], [2.0 / 3.0, -2.0 / 3.0, 1.0 / 3.0]);
        let on = |c: f64, s: f64| {
            vector::add([1.0; 3], vector::add(vector::scale(e1, 2.0 * c), vector::scale(e2, 2.0 * s)))
        };
        let points = [on(1.0, 0.0), on(0.6, 0.8), on(-0.28, 0.96), on(0.0, -1.0)];
        let fit = fit_circle(&points).unwrap();
        assert!((fit.radius - 2.0).abs() < 1e-14 && fit.plane_rms < 1e-14);
        for k in 0..3 {
            assert!((fit.center[k] - 1.0).abs() < 1e-14);
            assert!((fit.normal[k] - [1.0, 2.0, 2.0][k] / 3.0).abs() < 1e-14);
        }
        assert_eq!(fit_sphere(&points), Err(Error::Degenerate));
    }

    #[test]
    fn points_that_determine_nothing_are_refused() {
        let line = [[0.0; 3], [1.0, 2.0, 3.0], [2.0, 4.0, 6.0], [3.0, 6.0, 9.0]];
        assert_eq!(fit_circle(&line), Err(Error::Degenerate));
        assert_eq!(fit_sphere(&[[1.0; 3]; 9]), Err(Error::Degenerate));
        assert_eq!(fit_sphere(&line[..3]), Err(Error::TooFewPoints { given: 3, needed: 4 }));
        assert_eq!(fit_circle(&[[f64::NAN; 3]; 4]), Err(Error::NotFinite { row: 0 }));
    }
}
