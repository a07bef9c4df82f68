//! The rotation that turns one set of vectors into another best: min Σ |b − R a|² (G. Wahba, SIAM Review 7(3),
//! 409, 1965), by Davenport's method: the quaternion is the eigenvector of K(B), B = Σ b aᵀ, with the largest
//! eigenvalue.

use crate::error::{Error, Result};
use crate::math;
use crate::matrix;
use crate::quaternion::Quaternion;
use crate::vector::Vec3;

/// Least ratio of the second to the first spread of the vectors at which a rotation is taken to be determined.
pub const LEAST_RATIO: f64 = 0.05;

/// Sums over pairs of vectors.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pairs {
    /// Σ w b aᵀ.
    pub b_a: [[f64; 3]; 3],
    /// Σ w a aᵀ.
    pub a_a: [[f64; 3]; 3],
}

impl Pairs {
    /// Adds a pair with a weight.
    pub fn add(&mut self, a: Vec3, b: Vec3, weight: f64) {
        for i in 0..3 {
            for j in 0..3 {
                self.b_a[i][j] += weight * b[i] * a[j];
                self.a_a[i][j] += weight * a[i] * a[j];
            }
        }
    }

    /// Square roots of the second and first eigenvalue of Σ w a aᵀ, as a ratio: 0 where all vectors are parallel.
    pub fn ratio(&self) -> f64 {
        let (values, _) = matrix::symmetric_eigen(&self.a_a);
        if values[2] > 0.0 { math::sqrt(values[1].max(0.0) / values[2]) } else { 0.0 }
    }

    /// `b_from_a`. Refused ([`Error::OneAxisOnly`]) when all vectors lie too nearly along one axis.
    pub fn rotation(&self) -> Result<Quaternion> {
        if !self.b_a.iter().flatten().all(|x| x.is_finite()) {
            return Err(Error::NotFinite { row: 0 });
        }
        let ratio = self.ratio();
        if ratio < LEAST_RATIO {
            return Err(Error::OneAxisOnly { ratio });
        }
        Ok(nearest_rotation(&self.b_a))
    }
}

/// The rotation R with the largest trace of Rᵀ B: the one nearest to B.
pub fn nearest_rotation(b: &[[f64; 3]; 3]) -> Quaternion {
    let trace = b[0][0] + b[1][1] + b[2][2];
    let z = [b[2][1] - b[1][2], b[0][2] - b[2][0], b[1][0] - b[0][1]];
    let mut k = [[0.0; 4]; 4];
    k[0][0] = trace;
    for i in 0..3 {
        k[0][i + 1] = z[i];
        k[i + 1][0] = z[i];
        for j in 0..3 {
            k[i + 1][j + 1] = b[i][j] + b[j][i];
        }
        k[i + 1][i + 1] -= trace;
    }
    let (_, vectors) = matrix::symmetric_eigen(&k);
    let q = Quaternion::new(vectors[0][3], vectors[1][3], vectors[2][3], vectors[3][3]).normalized();
    if q.w < 0.0 { q.negated() } else { q }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vector;

    #[test]
    fn a_known_rotation_is_found() {
        let q = Quaternion::new(-0.3, 0.5, 0.7, -0.1).normalized().negated();
        let mut pairs = Pairs::default();
        for a in [[1.0, 2.0, -0.5], [0.3, -1.0, 0.8], [2.0, 0.1, 0.4]] {
            pairs.add(a, q.rotate(a), 0.7);
        }
        let found = pairs.rotation().unwrap();
        assert!(found.conjugate().product(q).angle() < 1e-14);
    }

    #[test]
    fn two_directions_are_enough_and_one_is_not() {
        let q = Quaternion::from_rotation_vector([3.0, 0.5, 0.2]);
        let mut pairs = Pairs::default();
        for (along, across) in [(1.0, 0.0), (-2.0, 0.0), (1.0, 0.5)] {
            let a = [along, across, 0.0];
            pairs.add(a, q.rotate(a), 1.0);
        }
        assert!(pairs.rotation().unwrap().conjugate().product(q).angle() < 1e-13);
        let mut line = Pairs::default();
        for size in [1.0, -2.0, 3.0] {
            let a = vector::scale([0.6, 0.0, 0.8], size);
            line.add(a, q.rotate(a), 1.0);
        }
        assert!(matches!(line.rotation(), Err(Error::OneAxisOnly { ratio }) if ratio < 1e-7));
    }
}
