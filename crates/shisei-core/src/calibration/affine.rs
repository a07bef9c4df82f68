//! A three-axis sensor's calibration: `corrected = matrix · (raw − bias)`.

use crate::error::Result;
use crate::least_squares::{Square, inverse3};
use crate::vector::{self, Vec3};

/// Bias and matrix of one three-axis sensor. The raw unit is whatever the recording has (m/s², rad/s, counts);
/// the matrix turns it into m/s² or rad/s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Affine {
    /// What the sensor reads at zero input, raw unit.
    pub bias: Vec3,
    /// Rows first; scale on the diagonal, misalignment beside it.
    pub matrix: Square<3>,
}

impl Affine {
    /// Changes nothing.
    pub const IDENTITY: Affine =
        Affine { bias: [0.0; 3], matrix: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] };

    /// `matrix · (raw − bias)`.
    #[inline]
    pub fn apply(&self, raw: Vec3) -> Vec3 {
        let d = vector::sub(raw, self.bias);
        [vector::dot(self.matrix[0], d), vector::dot(self.matrix[1], d), vector::dot(self.matrix[2], d)]
    }

    /// The raw reading that gives `corrected`; [`crate::Error::Degenerate`] when the matrix has no inverse.
    pub fn unapply(&self, corrected: Vec3) -> Result<Vec3> {
        let m = inverse3(&self.matrix)?;
        let d = [vector::dot(m[0], corrected), vector::dot(m[1], corrected), vector::dot(m[2], corrected)];
        Ok(vector::add(d, self.bias))
    }
}
