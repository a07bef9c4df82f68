//! Accelerometer, gyroscope and acceleration sensitivity from six faces and three known turns.
//!
//! Ferraris, Grimaldi & Parvis 1995: the sensor rests on its six faces, then turns through a known angle about
//! each of its three axes. All axes are those of the case, which must lie true: unlike the norm fits this gives
//! the full matrices, and errors of placement go into them. With ū± the mean readings on the faces,
//! `S = (Ū₊ − Ū₋) / 2g`, bias `= diag(Ū₊ + Ū₋)/2`, matrix `= S⁻¹`; with w the offset-corrected integral of a turn
//! of angle φ, `S_g = [w_x w_y w_z] / φ`, matrix `= S_g⁻¹`.

use crate::calibration::SensorModel;
use crate::calibration::still::moments;
use crate::error::{Error, Result};
use crate::matrix::{Square, inverse};
use crate::vector::{self, Vec3};

/// Rows of one part of the procedure: accelerometer and gyroscope, raw.
#[derive(Clone, Copy, Debug)]
pub struct Part<'a> {
    /// Accelerometer rows.
    pub acc: &'a [Vec3],
    /// Gyroscope rows, as many.
    pub gyro: &'a [Vec3],
}

/// The nine parts. Index 0, 1, 2 is the axis x, y, z.
#[derive(Clone, Copy, Debug)]
pub struct Parts<'a> {
    /// At rest with the axis up (it reads +g).
    pub up: [Part<'a>; 3],
    /// At rest with the axis down (it reads −g).
    pub down: [Part<'a>; 3],
    /// Turning about the axis.
    pub turn: [Part<'a>; 3],
}

/// The angle of each turn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TurnAngle {
    /// Its size in rad; the direction is taken from the reading.
    Size(f64),
    /// With its sign, right-handed about the axis, rad; a gyroscope that reads the other way comes out reversed.
    Signed(f64),
}

/// The result.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KnownTurns {
    /// Accelerometer, to m/s².
    pub accelerometer: SensorModel,
    /// Gyroscope, to rad/s.
    pub gyroscope: SensorModel,
    /// Raw gyro reading per m/s² (column: axis of the acceleration). `corrected = matrix · (raw − bias − K a)`.
    pub gyro_per_acceleration: Square<3>,
    /// Standard error of the accelerometer's bias from the noise of the means, raw unit.
    pub acc_bias_sigma: Vec3,
    /// Standard error of the gyroscope's bias from the noise of the means, raw unit.
    pub gyro_bias_sigma: Vec3,
    /// Standard errors of the accelerometer's matrix from the noise of the means, unit of the matrix.
    pub acc_matrix_sigma: Square<3>,
    /// Standard errors of the gyroscope's matrix from the noise of the turns and of the offsets taken off them,
    /// unit of the matrix. As all errors here they do not know of faces and turns that are not true.
    pub gyro_matrix_sigma: Square<3>,
}

/// Standard errors of S⁻¹ for errors of S whose rows are independent and whose row i has the covariance
/// `of_row[i]`: δ(S⁻¹) = −S⁻¹ δS S⁻¹.
fn inverse_sigma(inverse: &Square<3>, of_row: &[Square<3>; 3]) -> Square<3> {
    let mut sigma = [[0.0; 3]; 3];
    for a in 0..3 {
        for b in 0..3 {
            let mut variance = 0.0;
            for (i, covariance) in of_row.iter().enumerate() {
                let weight = inverse[a][i] * inverse[a][i];
                for s in 0..3 {
                    for t in 0..3 {
                        variance += weight * inverse[s][b] * inverse[t][b] * covariance[s][t];
                    }
                }
            }
            sigma[a][b] = crate::math::sqrt(variance.max(0.0));
        }
    }
    sigma
}

/// Moments of one face's readings, of the gyroscope.
#[derive(Clone, Copy, Default)]
struct Face {
    rows: f64,
    variance: Vec3,
}

/// What is taken off the integral of a turn is a sum of the faces' mean gyro readings: its weights.
fn weights_of_faces(turn_s: f64, acc_integral: Vec3, faces: &[[Face; 2]; 3], gravity: f64) -> [[f64; 2]; 3] {
    let rows: f64 = faces.iter().flatten().map(|f| f.rows).sum();
    let mut weights = [[0.0; 2]; 3];
    for axis in 0..3 {
        let sensitivity = acc_integral[axis] / (2.0 * gravity);
        weights[axis] = [
            turn_s * faces[axis][0].rows / rows + sensitivity,
            turn_s * faces[axis][1].rows / rows - sensitivity,
        ];
    }
    weights
}

/// Calibrates from the nine parts. `dt_s` between rows, gravity in m/s².
///
/// Refuses with [`Error::Empty`], [`Error::LengthMismatch`], [`Error::NotFinite`] and [`Error::Degenerate`]
/// (faces mixed up or turns without rotation).
pub fn calibrate(parts: &Parts<'_>, dt_s: f64, angle: TurnAngle, gravity_m_s2: f64) -> Result<KnownTurns> {
    for (name, value) in [("dt", dt_s), ("gravity", gravity_m_s2)] {
        if !(value > 0.0 && value.is_finite()) {
            return Err(Error::NotPositive { name, value });
        }
    }
    for part in parts.up.iter().chain(&parts.down).chain(&parts.turn) {
        if part.acc.is_empty() {
            return Err(Error::Empty);
        }
        if part.acc.len() != part.gyro.len() {
            return Err(Error::LengthMismatch { first: part.acc.len(), second: part.gyro.len() });
        }
        let bad = |(a, g): (&Vec3, &Vec3)| !(vector::is_finite(*a) && vector::is_finite(*g));
        if let Some(row) = part.acc.iter().zip(part.gyro).position(bad) {
            return Err(Error::NotFinite { row });
        }
    }
    let (mut acc_s, mut gyro_per_acceleration) = ([[0.0; 3]; 3], [[0.0; 3]; 3]);
    let (mut acc_bias, mut acc_bias_sigma) = ([0.0; 3], [0.0; 3]);
    let (mut gyro_sum, mut gyro_square, mut rows) = ([0.0; 3], [0.0; 3], 0.0);
    let mut acc_of_row = [[[0.0; 3]; 3]; 3];
    let mut faces = [[Face::default(); 2]; 3];
    for axis in 0..3 {
        let (up, up_variance) = moments(parts.up[axis].acc);
        let (down, down_variance) = moments(parts.down[axis].acc);
        let (gyro_up, gyro_up_variance) = moments(parts.up[axis].gyro);
        let (gyro_down, gyro_down_variance) = moments(parts.down[axis].gyro);
        let (n, m) = (parts.up[axis].acc.len() as f64, parts.down[axis].acc.len() as f64);
        for row in 0..3 {
            acc_s[row][axis] = (up[row] - down[row]) / (2.0 * gravity_m_s2);
            gyro_per_acceleration[row][axis] = (gyro_up[row] - gyro_down[row]) / (2.0 * gravity_m_s2);
            gyro_sum[row] += n * gyro_up[row] + m * gyro_down[row];
            gyro_square[row] += n * gyro_up_variance[row] + m * gyro_down_variance[row];
            acc_of_row[row][axis][axis] =
                (up_variance[row] / n + down_variance[row] / m) / (4.0 * gravity_m_s2 * gravity_m_s2);
        }
        rows += n + m;
        faces[axis] =
            [Face { rows: n, variance: gyro_up_variance }, Face { rows: m, variance: gyro_down_variance }];
        acc_bias[axis] = 0.5 * (up[axis] + down[axis]);
        acc_bias_sigma[axis] = 0.5 * crate::math::sqrt(up_variance[axis] / n + down_variance[axis] / m);
    }
    let accelerometer = SensorModel { bias: acc_bias, matrix: inverse(&acc_s)? };
    let gyro_bias = vector::scale(gyro_sum, 1.0 / rows);
    let mut gyro_bias_sigma = [0.0; 3];
    for i in 0..3 {
        gyro_bias_sigma[i] = crate::math::sqrt(gyro_square[i]) / rows;
    }
    let mut gyro_s = [[0.0; 3]; 3];
    let (mut angles, mut lengths, mut weights) = ([0.0; 3], [0.0; 3], [[[0.0; 2]; 3]; 3]);
    for axis in 0..3 {
        let (mut w, mut acc_integral) = ([0.0; 3], [0.0; 3]);
        for (acc, gyro) in parts.turn[axis].acc.iter().zip(parts.turn[axis].gyro) {
            let a = accelerometer.apply(*acc);
            acc_integral = vector::add(acc_integral, vector::scale(a, dt_s));
            for i in 0..3 {
                w[i] += (gyro[i] - gyro_bias[i] - vector::dot(gyro_per_acceleration[i], a)) * dt_s;
            }
        }
        let phi = match angle {
            TurnAngle::Signed(phi) => phi,
            TurnAngle::Size(phi) => {
                if w[axis] < 0.0 {
                    -phi.abs()
                } else {
                    phi.abs()
                }
            }
        };
        if !(phi.is_finite() && phi != 0.0) {
            return Err(Error::NotPositive { name: "turns", value: phi });
        }
        // a turn about this axis must be seen mostly by this axis
        if w[axis].abs() < 0.7 * vector::norm(w) {
            return Err(Error::Degenerate);
        }
        for i in 0..3 {
            gyro_s[i][axis] = w[i] / phi;
        }
        angles[axis] = phi;
        lengths[axis] = parts.turn[axis].gyro.len() as f64;
        weights[axis] = weights_of_faces(lengths[axis] * dt_s, acc_integral, &faces, gravity_m_s2);
    }
    let gyroscope = SensorModel { bias: gyro_bias, matrix: inverse(&gyro_s)? };
    let mut gyro_of_row = [[[0.0; 3]; 3]; 3];
    for i in 0..3 {
        let noise = gyro_square[i] / rows; // variance of one sample at rest
        for s in 0..3 {
            for t in 0..3 {
                let mut covariance = if s == t { lengths[s] * noise * dt_s * dt_s } else { 0.0 };
                for axis in 0..3 {
                    for side in 0..2 {
                        let face = faces[axis][side];
                        covariance +=
                            weights[s][axis][side] * weights[t][axis][side] * face.variance[i] / face.rows;
                    }
                }
                gyro_of_row[i][s][t] = covariance / (angles[s] * angles[t]);
            }
        }
    }
    Ok(KnownTurns {
        acc_matrix_sigma: inverse_sigma(&accelerometer.matrix, &acc_of_row),
        gyro_matrix_sigma: inverse_sigma(&gyroscope.matrix, &gyro_of_row),
        accelerometer,
        gyroscope,
        gyro_per_acceleration,
        acc_bias_sigma,
        gyro_bias_sigma,
    })
}
