//! What is known of a sensor: to save, and to start from.
//!
//! `corrected = matrix · (raw − bias)` for both sensors, as in a calibration file. The covariance is that of what
//! may be left: of the rate `δbg + δM y` and of the acceleration `δba + δs ∘ a`, in the order bg 3, ba 3, M 9 (row
//! by row), s 3.

use super::covariance::Covariance;
use super::model::{BA, BG, LEVER, MG, Nominal, SA};
use super::settings::Model;
use crate::error::{Error, Result};
use crate::vector::{self, Vec3};

/// Elements of the covariance: bg 3, ba 3, M 9, s 3.
pub const CALIBRATION_STATES: usize = 18;

/// A gyroscope that was switched off comes back with another bias; of an accelerometer's bias this share of its
/// start value is doubted each time.
const ACC_BIAS_AGEING: f64 = 0.3;

/// Stored variances of matrix and scale are doubted by this factor: what was learnt in one movement fits that
/// movement best.
const CAUTION: f64 = 4.0;

/// Calibration of a sensor, with what may be left of its errors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Calibration {
    /// Gyroscope bias b, rad/s: `ω = M (raw − b)`.
    pub gyro_bias_rad_s: Vec3,
    /// Gyroscope matrix M.
    pub gyro_matrix: [Vec3; 3],
    /// Accelerometer bias b, m/s²: `f = M (raw − b)`.
    pub acc_bias_m_s2: Vec3,
    /// Accelerometer matrix M; from a six-face calibration the diagonal of the scales.
    pub acc_matrix: [Vec3; 3],
    /// Covariance of what is left; units (rad/s)², (m/s²)² and 1.
    pub covariance: [[f64; CALIBRATION_STATES]; CALIBRATION_STATES],
}

const IDENTITY: [Vec3; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

fn times(m: &[Vec3; 3], v: Vec3) -> Vec3 {
    [vector::dot(m[0], v), vector::dot(m[1], v), vector::dot(m[2], v)]
}

fn product(a: &[Vec3; 3], b: &[Vec3; 3]) -> [Vec3; 3] {
    let mut out = [[0.0; 3]; 3];
    for i in 0..3 {
        for j in 0..3 {
            out[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
        }
    }
    out
}

/// m⁻¹ v by Cramer's rule.
fn solve(m: &[Vec3; 3], v: Vec3) -> Vec3 {
    let columns = [[m[0][0], m[1][0], m[2][0]], [m[0][1], m[1][1], m[2][1]], [m[0][2], m[1][2], m[2][2]]];
    let [a, b, c] = columns;
    let det = vector::dot(a, vector::cross(b, c));
    [
        vector::dot(v, vector::cross(b, c)) / det,
        vector::dot(a, vector::cross(v, c)) / det,
        vector::dot(a, vector::cross(b, v)) / det,
    ]
}

impl Calibration {
    /// Standard deviations in place of a covariance: of bg rad/s, ba m/s², the elements of the gyroscope matrix,
    /// and the accelerometer's scales.
    pub fn with_sigmas(
        gyro: (Vec3, [Vec3; 3]),
        acc: (Vec3, [Vec3; 3]),
        gyro_bias_sigma: f64,
        acc_bias_sigma: f64,
        gyro_matrix_sigma: f64,
        acc_scale_sigma: f64,
    ) -> Self {
        let mut covariance = [[0.0; CALIBRATION_STATES]; CALIBRATION_STATES];
        for k in 0..CALIBRATION_STATES {
            let sigma = match k {
                0..3 => gyro_bias_sigma,
                3..6 => acc_bias_sigma,
                6..15 => gyro_matrix_sigma,
                _ => acc_scale_sigma,
            };
            covariance[k][k] = sigma * sigma;
        }
        Calibration {
            gyro_bias_rad_s: gyro.0,
            gyro_matrix: gyro.1,
            acc_bias_m_s2: acc.0,
            acc_matrix: acc.1,
            covariance,
        }
    }

    /// Nothing known: corrects nothing; variances are the model's start values.
    pub(super) fn unknown(model: &Model) -> Self {
        Self::with_sigmas(
            ([0.0; 3], IDENTITY),
            ([0.0; 3], IDENTITY),
            model.gyro_bias_start,
            model.acc_bias_start,
            model.gyro_matrix_start,
            model.acc_scale_start,
        )
    }

    /// Refused unless all numbers are finite, variances not negative, and the matrices near the identity
    /// (elements within 0.5 of it).
    pub fn check(&self) -> Result<()> {
        let biases = [self.gyro_bias_rad_s, self.acc_bias_m_s2];
        let all = biases.iter().chain(&self.gyro_matrix).chain(&self.acc_matrix);
        if !all.copied().all(vector::is_finite) || self.covariance.iter().flatten().any(|c| !c.is_finite()) {
            return Err(Error::NotFinite { row: 0 });
        }
        for k in 0..CALIBRATION_STATES {
            if self.covariance[k][k] < 0.0 {
                return Err(Error::Negative { name: "covariance", value: self.covariance[k][k] });
            }
        }
        for matrix in [&self.gyro_matrix, &self.acc_matrix] {
            for i in 0..3 {
                for j in 0..3 {
                    let off = matrix[i][j] - IDENTITY[i][j];
                    if off.abs() > 0.5 {
                        return Err(Error::OutOfRange {
                            rule: "|calibration matrix - identity| <= 0.5",
                            value: off,
                        });
                    }
                }
            }
        }
        Ok(())
    }

    /// The rate, rad/s.
    #[inline]
    pub fn correct_gyro(&self, raw_rad_s: Vec3) -> Vec3 {
        times(&self.gyro_matrix, vector::sub(raw_rad_s, self.gyro_bias_rad_s))
    }

    /// The specific force, m/s².
    #[inline]
    pub fn correct_acc(&self, raw_m_s2: Vec3) -> Vec3 {
        times(&self.acc_matrix, vector::sub(raw_m_s2, self.acc_bias_m_s2))
    }

    /// The covariance a filter starts with when the sensor is switched on again: never better than stored, with
    /// the gyroscope bias as unknown as at any start.
    pub(super) fn start_covariance<const N: usize>(&self, model: &Model, p: &mut Covariance<N>) {
        for a in 0..CALIBRATION_STATES {
            for b in 0..CALIBRATION_STATES {
                let factor = if a >= 6 && b >= 6 { CAUTION } else { 0.0 };
                p.0[BG + a][BG + b] = factor * self.covariance[a][b];
            }
        }
        let sq = |x: f64| x * x;
        for j in 0..3 {
            p.0[BG + j][BG + j] = sq(model.gyro_bias_start);
            p.0[BA + j][BA + j] = self.covariance[3 + j][3 + j] + sq(ACC_BIAS_AGEING * model.acc_bias_start);
        }
        for k in MG..LEVER {
            let start = if k < SA { model.gyro_matrix_start } else { model.acc_scale_start };
            // a filter that does not learn these goes on not learning them
            if start == 0.0 {
                for c in 0..N {
                    p.0[k][c] = 0.0;
                    p.0[c][k] = 0.0;
                }
            }
        }
    }

    /// This calibration and what a filter has learnt behind it, as one.
    pub(super) fn followed_by<const N: usize>(&self, learnt: &Nominal, p: &Covariance<N>) -> Self {
        let m = &learnt.gyro_matrix;
        let mut gyro = IDENTITY;
        let mut acc = IDENTITY;
        for i in 0..3 {
            for j in 0..3 {
                gyro[i][j] -= m[i][j];
            }
            acc[i][i] -= learnt.acc_scale[i];
        }
        // (I − M)(c − b') with c = matrix (raw − bias) and (I − M) b' = bg
        let gyro_matrix = product(&gyro, &self.gyro_matrix);
        let acc_matrix = product(&acc, &self.acc_matrix);
        let gyro_more = solve(&gyro_matrix, learnt.gyro_bias);
        let acc_more = solve(&acc_matrix, learnt.acc_bias);
        let mut covariance = [[0.0; CALIBRATION_STATES]; CALIBRATION_STATES];
        for a in 0..CALIBRATION_STATES {
            covariance[a].copy_from_slice(&p.0[BG + a][BG..BG + CALIBRATION_STATES]);
        }
        Calibration {
            gyro_bias_rad_s: vector::add(self.gyro_bias_rad_s, gyro_more),
            gyro_matrix,
            acc_bias_m_s2: vector::add(self.acc_bias_m_s2, acc_more),
            acc_matrix,
            covariance,
        }
    }
}
