//! `corrected = matrix (raw − bias)`, for the accelerometer and for the gyroscope.

use crate::error::{Error, Result};
use crate::filter::{check_rows, same_length};
use crate::vector::{self, Vec3};

/// Bias and matrix of one three-axis sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorModel {
    /// What the sensor reads too much, in its unit.
    pub bias: Vec3,
    /// Scale (diagonal), misalignment and cross-axis (rest); rows first.
    pub matrix: [[f64; 3]; 3],
}

impl SensorModel {
    /// Changes nothing.
    pub const IDENTITY: SensorModel =
        SensorModel { bias: [0.0; 3], matrix: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] };

    /// From a bias and a scale a axis: `(raw − bias) · scale`.
    pub const fn from_bias_scale(bias: Vec3, scale: Vec3) -> Self {
        SensorModel { bias, matrix: [[scale[0], 0.0, 0.0], [0.0, scale[1], 0.0], [0.0, 0.0, scale[2]]] }
    }

    /// From `[biasX, biasY, biasZ, scaleX, scaleY, scaleZ]`.
    pub const fn from_six(v: [f64; 6]) -> Self {
        SensorModel::from_bias_scale([v[0], v[1], v[2]], [v[3], v[4], v[5]])
    }

    /// The matrix' diagonal.
    pub const fn scale(&self) -> Vec3 {
        [self.matrix[0][0], self.matrix[1][1], self.matrix[2][2]]
    }

    /// `matrix (raw − bias)`.
    #[inline]
    pub fn apply(&self, raw: Vec3) -> Vec3 {
        let d = vector::sub(raw, self.bias);
        let m = &self.matrix;
        [vector::dot(m[0], d), vector::dot(m[1], d), vector::dot(m[2], d)]
    }

    /// The raw reading that `apply` turns into `corrected`; refused ([`Error::Degenerate`]) when the matrix has no
    /// inverse.
    pub fn unapply(&self, corrected: Vec3) -> Result<Vec3> {
        let inverse = crate::matrix::inverse(&self.matrix)?;
        Ok(vector::add(crate::matrix::times_vector(&inverse, &corrected), self.bias))
    }

    /// Refused unless every number is finite.
    pub fn check(&self) -> Result<()> {
        check_rows(&[self.bias], 0)?;
        check_rows(&self.matrix, 0)
    }

    /// [`SensorModel::apply`] of every row. Refused: unequal lengths, numbers that are not finite, and a row
    /// whose result is not.
    pub fn apply_series(&self, raw: &[Vec3], out: &mut [Vec3]) -> Result<()> {
        same_length(raw.len(), out.len())?;
        self.check()?;
        for (row, (out, &raw)) in out.iter_mut().zip(raw).enumerate() {
            *out = self.apply(raw);
            if !vector::is_finite(raw) || !vector::is_finite(*out) {
                return Err(Error::NotFinite { row });
            }
        }
        Ok(())
    }
}

/// Accelerometer and gyroscope.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Calibration {
    /// Bias in m/s².
    pub accelerometer: SensorModel,
    /// Bias in rad/s.
    pub gyroscope: SensorModel,
}

impl Calibration {
    /// Changes nothing.
    pub const IDENTITY: Calibration =
        Calibration { accelerometer: SensorModel::IDENTITY, gyroscope: SensorModel::IDENTITY };

    /// From accelerometer bias, accelerometer scale, gyroscope bias, gyroscope scale; three each.
    pub const fn from_twelve(v: [f64; 12]) -> Self {
        Calibration {
            accelerometer: SensorModel::from_six([v[0], v[1], v[2], v[3], v[4], v[5]]),
            gyroscope: SensorModel::from_six([v[6], v[7], v[8], v[9], v[10], v[11]]),
        }
    }

    /// Accelerometer bias, accelerometer scale, gyroscope bias, gyroscope scale; three each. What lies beside
    /// the matrices' diagonals is left out.
    pub const fn to_twelve(&self) -> [f64; 12] {
        let (a, g) = (&self.accelerometer, &self.gyroscope);
        let (s, t) = (a.scale(), g.scale());
        [a.bias[0], a.bias[1], a.bias[2], s[0], s[1], s[2], g.bias[0], g.bias[1], g.bias[2], t[0], t[1], t[2]]
    }

    /// The first nine of [`Calibration::to_twelve`].
    pub fn to_nine(&self) -> [f64; 9] {
        let v = self.to_twelve();
        [v[0], v[1], v[2], v[3], v[4], v[5], v[6], v[7], v[8]]
    }
}
