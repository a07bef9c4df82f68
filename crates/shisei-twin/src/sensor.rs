//! Sensors as their makers describe them: noise, quantisation, range, and how far parts differ.
//!
//! A reading is `raw = matrix⁻¹ · ideal + bias + walk + noise`, clipped to the range, then quantised; so the
//! true calibration is `corrected = matrix · (raw − bias)`, the form of the calibration file.

use core::f64::consts::PI;

use shisei_core::{STANDARD_GRAVITY_M_S2, Vec3, math};

use crate::random::Random;

const DEG: f64 = PI / 180.0;
const MICRO_G: f64 = STANDARD_GRAVITY_M_S2 * 1e-6;
const MILLI_G: f64 = STANDARD_GRAVITY_M_S2 * 1e-3;
/// √60 s.
const SQRT_MINUTE: f64 = 7.745_966_692_414_834;
/// √(100 Hz / 2): from a deviation at 100 Hz to a density.
const SQRT_50_HZ: f64 = 7.071_067_811_865_475;

/// A 3×3 matrix, rows first.
pub type Matrix = [[f64; 3]; 3];

/// One three-axis sensor. "Unit" is m/s² for an accelerometer and rad/s for a gyroscope.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triad {
    /// Readings end at ± this, unit.
    pub full_scale: f64,
    /// One count, unit; 0 for no quantisation.
    pub count: f64,
    /// White noise, one-sided density, unit/√Hz; a sample at rate f has the deviation density · √(f/2).
    pub noise_density: f64,
    /// Random walk of the bias, unit/√s.
    pub bias_walk: f64,
    /// Deviation from part to part of the bias, unit.
    pub bias_sigma: f64,
    /// Deviation from part to part of each axis' scale, 1.
    pub scale_sigma: f64,
    /// Deviation from part to part of each off-diagonal element of the matrix, rad.
    pub misalignment_sigma: f64,
}

/// An accelerometer and a gyroscope.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensor {
    /// Its name.
    pub name: &'static str,
    /// The accelerometer, m/s².
    pub accelerometer: Triad,
    /// The gyroscope, rad/s.
    pub gyroscope: Triad,
}

impl Sensor {
    /// No errors at all, no range, no counts.
    pub fn ideal() -> Self {
        let perfect = Triad {
            full_scale: f64::INFINITY,
            count: 0.0,
            noise_density: 0.0,
            bias_walk: 0.0,
            bias_sigma: 0.0,
            scale_sigma: 0.0,
            misalignment_sigma: 0.0,
        };
        Sensor { name: "ideal", accelerometer: perfect, gyroscope: perfect }
    }

    /// Like the MU-01 at ±16 g, ±2000 °/s: counts and noise are those of the rows printed in its add-in's
    /// manual (at rest at 100 Hz the accelerometer scatters by 0.03 m/s², the gyroscope by 0.033 rad/s),
    /// biases of the size of its printed calibration.
    pub fn mu_01_like() -> Self {
        Sensor {
            name: "MU-01 like",
            accelerometer: Triad {
                full_scale: 16.0 * STANDARD_GRAVITY_M_S2,
                count: 16.0 * STANDARD_GRAVITY_M_S2 / 32768.0,
                noise_density: 0.03 / SQRT_50_HZ,
                bias_walk: 1e-4,
                bias_sigma: 0.07,
                scale_sigma: 0.003,
                misalignment_sigma: 0.003,
            },
            gyroscope: Triad {
                full_scale: 32768.0 * 0.001_063_7,
                count: 0.001_063_7,
                noise_density: 0.033 / SQRT_50_HZ,
                bias_walk: 1e-5,
                bias_sigma: 0.01,
                scale_sigma: 0.005,
                misalignment_sigma: 0.005,
            },
        }
    }

    /// LSM6DS3TR-C, the sensor of the XIAO nRF52840 Sense, at ±16 g, ±2000 °/s. "Table 3" is that of its data sheet
    /// (DocID030071 Rev 3, pages 21–22), typical values; what it does not state is assumed.
    pub fn lsm6ds3tr_c() -> Self {
        Sensor {
            name: "LSM6DS3TR-C",
            accelerometer: Triad {
                full_scale: 16.0 * STANDARD_GRAVITY_M_S2,
                // Table 3, LA_So: 0.488 mg a count at ±16 g.
                count: 0.488 * MILLI_G,
                // Table 3, An: 130 µg/√Hz at ±16 g, high-performance mode.
                noise_density: 130.0 * MICRO_G,
                // Assumed.
                bias_walk: 1e-4,
                // Table 3, LA_TyOff: ±40 mg, taken as a deviation.
                bias_sigma: 40.0 * MILLI_G,
                // Assumed: 1 % of scale, 0.3° between axes.
                scale_sigma: 0.01,
                misalignment_sigma: 0.005,
            },
            gyroscope: Triad {
                full_scale: 2000.0 * DEG,
                // Table 3, G_So: 70 m°/s a count at ±2000 °/s.
                count: 0.07 * DEG,
                // Table 3, Rn: 5 m°/s/√Hz, high-performance mode.
                noise_density: 0.005 * DEG,
                // Assumed. Table 3 has the change with temperature only, 0.05 °/s/°C.
                bias_walk: 2e-5,
                // Table 3, G_TyOff: ±3 °/s, taken as a deviation.
                bias_sigma: 3.0 * DEG,
                // Assumed, as above.
                scale_sigma: 0.01,
                misalignment_sigma: 0.005,
            },
        }
    }

    /// Sony's multi-IMU add-on board CXD5602PWBIMU at ±2 g, ±125 °/s. "Sony" are the figures with which its maker
    /// announced it; deviations from part to part are assumed. It sends 32-bit floats, finer than its noise: no counts.
    pub fn spresense() -> Self {
        Sensor {
            name: "CXD5602PWBIMU",
            accelerometer: Triad {
                full_scale: 2.0 * STANDARD_GRAVITY_M_S2,
                count: 0.0,
                // Sony: 14 µg/√Hz.
                noise_density: 14.0 * MICRO_G,
                // Sony: bias instability 4.4 µg, taken as a walk a minute long.
                bias_walk: 4.4 * MICRO_G / SQRT_MINUTE,
                // Assumed, all three.
                bias_sigma: 5.0 * MILLI_G,
                scale_sigma: 0.003,
                misalignment_sigma: 0.002,
            },
            gyroscope: Triad {
                full_scale: 125.0 * DEG,
                count: 0.0,
                // Sony: 1.0 m°/s/√Hz.
                noise_density: 0.001 * DEG,
                // Sony: bias instability 0.39 °/h, taken as a walk a minute long.
                bias_walk: 0.39 * DEG / 3600.0 / SQRT_MINUTE,
                // Assumed, all three.
                bias_sigma: 0.1 * DEG,
                scale_sigma: 0.003,
                misalignment_sigma: 0.002,
            },
        }
    }
}

/// The true correction of one triad: `corrected = matrix · (raw − bias)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Correction {
    /// Bias, unit.
    pub bias: Vec3,
    /// Scales and misalignment.
    pub matrix: Matrix,
}

impl Correction {
    /// Nothing to correct.
    pub const NONE: Correction =
        Correction { bias: [0.0; 3], matrix: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] };

    /// A bias and a scale per axis, no misalignment.
    pub fn diagonal(bias: Vec3, scale: Vec3) -> Self {
        let mut matrix = [[0.0; 3]; 3];
        for axis in 0..3 {
            matrix[axis][axis] = scale[axis];
        }
        Correction { bias, matrix }
    }

    /// One part out of many.
    pub fn draw(triad: &Triad, random: &mut Random) -> Self {
        let bias = random.normal3(triad.bias_sigma);
        let mut matrix = Correction::NONE.matrix;
        for (i, row) in matrix.iter_mut().enumerate() {
            for (j, element) in row.iter_mut().enumerate() {
                *element +=
                    random.normal() * if i == j { triad.scale_sigma } else { triad.misalignment_sigma };
            }
        }
        Correction { bias, matrix }
    }

    /// What a sensor with these errors reads, before noise; the matrix must be invertible.
    pub(crate) fn raw(&self, inverse: &Matrix, ideal: Vec3) -> Vec3 {
        let mut raw = self.bias;
        for i in 0..3 {
            raw[i] += inverse[i][0] * ideal[0] + inverse[i][1] * ideal[1] + inverse[i][2] * ideal[2];
        }
        raw
    }

    /// The inverse of the matrix (by cofactors).
    pub(crate) fn inverse(&self) -> Matrix {
        let m = &self.matrix;
        let cofactor = |r: usize, c: usize| {
            let (r1, r2, c1, c2) = ((r + 1) % 3, (r + 2) % 3, (c + 1) % 3, (c + 2) % 3);
            m[r1][c1] * m[r2][c2] - m[r1][c2] * m[r2][c1]
        };
        let determinant = m[0][0] * cofactor(0, 0) + m[0][1] * cofactor(0, 1) + m[0][2] * cofactor(0, 2);
        let mut inverse = [[0.0; 3]; 3];
        for r in 0..3 {
            for c in 0..3 {
                inverse[c][r] = cofactor(r, c) / determinant;
            }
        }
        inverse
    }
}

/// The true calibration of a simulated sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Calibration {
    /// Accelerometer, m/s².
    pub accelerometer: Correction,
    /// Gyroscope, rad/s; the bias is that at time 0, the walk comes on top.
    pub gyroscope: Correction,
}

impl Calibration {
    /// Nothing to correct.
    pub const NONE: Calibration =
        Calibration { accelerometer: Correction::NONE, gyroscope: Correction::NONE };
}

impl Triad {
    /// Clipped to the range and rounded to a count; 16 bits reach one count less above than below.
    pub fn quantise(&self, value: f64) -> f64 {
        if self.count <= 0.0 {
            return value.clamp(-self.full_scale, self.full_scale);
        }
        let last = math::round(self.full_scale / self.count);
        math::round(value / self.count).clamp(-last, last - 1.0) * self.count
    }
}
