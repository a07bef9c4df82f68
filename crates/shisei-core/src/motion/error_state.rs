//! The error state of an inertial navigator: 33 numbers, their covariance, and the way back.
//!
//! Order: position, velocity (m, m/s, world), attitude (rad, world: R_true = exp(δθ) R), gyroscope bias, acceleration
//! bias (body), then the 3×3 errors of the gyroscope's and the accelerometer's matrices, row by row:
//! ω_true = ω − δb_g + δM_g ω, a_true = a − δb_a + δM_a a. Over a step dt
//! δp += δv dt; δv += (δθ × a_world + R (δM_a a − δb_a)) dt; δθ += R (δM_g ω − δb_g) dt.
//!
//! Measurements are scalars, one after another. The smoother is that of Bryson and Frazier in its modified form
//! (Bierman 1977): λ and Λ run back through the same steps, and no matrix is inverted.

use crate::vector::{self, Vec3};

/// Number of error states.
pub const STATES: usize = 33;
/// First index of the position.
pub const POSITION: usize = 0;
/// First index of the velocity.
pub const VELOCITY: usize = 3;
/// First index of the attitude.
pub const ATTITUDE: usize = 6;
/// First index of the gyroscope's bias.
pub const GYRO_BIAS: usize = 9;
/// First index of the accelerometer's bias.
pub const ACC_BIAS: usize = 12;
/// First index of the gyroscope's matrix.
pub const GYRO_MATRIX: usize = 15;
/// First index of the accelerometer's matrix.
pub const ACC_MATRIX: usize = 24;

/// One vector of error states.
pub type State = [f64; STATES];
/// A covariance, rows first.
pub type Covariance = [State; STATES];

/// What the linearised step needs to know.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// Rotation matrix world from body in the middle of the step.
    pub rotation: [[f64; 3]; 3],
    /// Corrected specific force, body, m/s².
    pub acc_body: Vec3,
    /// Corrected rate, body, rad/s.
    pub rate_body: Vec3,
    /// Length, s.
    pub dt_s: f64,
}

/// Densities of the noise that drives the errors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProcessNoise {
    /// Accelerometer, m/s²/√Hz (two-sided: σ² of the velocity grows by its square a second).
    pub acc_density: f64,
    /// Gyroscope, rad/s/√Hz, in the same sense.
    pub gyro_density: f64,
    /// Random walk of the accelerometer's bias, m/s²/√s.
    pub acc_bias_walk: f64,
    /// Random walk of the gyroscope's bias, rad/s/√s.
    pub gyro_bias_walk: f64,
}

impl Step {
    /// Φ x in place.
    #[inline]
    pub fn forward(&self, x: &mut State) {
        let (r, dt) = (&self.rotation, self.dt_s);
        let theta = [x[ATTITUDE], x[ATTITUDE + 1], x[ATTITUDE + 2]];
        let acc_world = rotate(r, self.acc_body);
        let turned = vector::cross(theta, acc_world);
        let acc = rotate(r, channel(x, ACC_BIAS, ACC_MATRIX, self.acc_body));
        let rate = rotate(r, channel(x, GYRO_BIAS, GYRO_MATRIX, self.rate_body));
        for i in 0..3 {
            x[POSITION + i] += x[VELOCITY + i] * dt;
            x[VELOCITY + i] += (turned[i] + acc[i]) * dt;
            x[ATTITUDE + i] += rate[i] * dt;
        }
    }

    /// Φᵀ x in place.
    #[inline]
    pub fn backward(&self, x: &mut State) {
        let (r, dt) = (&self.rotation, self.dt_s);
        let theta = [x[ATTITUDE], x[ATTITUDE + 1], x[ATTITUDE + 2]];
        let velocity = [x[VELOCITY], x[VELOCITY + 1], x[VELOCITY + 2]];
        let acc_world = rotate(r, self.acc_body);
        // v · (θ × a) = θ · (a × v)
        let turned = vector::cross(acc_world, velocity);
        let (back_acc, back_rate) = (rotate_back(r, velocity), rotate_back(r, theta));
        for i in 0..3 {
            x[ATTITUDE + i] += turned[i] * dt;
            x[VELOCITY + i] += x[POSITION + i] * dt;
            x[ACC_BIAS + i] -= back_acc[i] * dt;
            x[GYRO_BIAS + i] -= back_rate[i] * dt;
            for j in 0..3 {
                x[ACC_MATRIX + 3 * i + j] += back_acc[i] * self.acc_body[j] * dt;
                x[GYRO_MATRIX + 3 * i + j] += back_rate[i] * self.rate_body[j] * dt;
            }
        }
    }
}

/// δM s − δb of one sensor, body.
#[inline]
fn channel(x: &State, bias: usize, matrix: usize, s: Vec3) -> Vec3 {
    let mut d = [0.0; 3];
    for i in 0..3 {
        let m = matrix + 3 * i;
        d[i] = x[m] * s[0] + x[m + 1] * s[1] + x[m + 2] * s[2] - x[bias + i];
    }
    d
}

#[inline]
fn rotate(r: &[[f64; 3]; 3], v: Vec3) -> Vec3 {
    [vector::dot(r[0], v), vector::dot(r[1], v), vector::dot(r[2], v)]
}

#[inline]
fn rotate_back(r: &[[f64; 3]; 3], v: Vec3) -> Vec3 {
    [
        r[0][0] * v[0] + r[1][0] * v[1] + r[2][0] * v[2],
        r[0][1] * v[0] + r[1][1] * v[1] + r[2][1] * v[2],
        r[0][2] * v[0] + r[1][2] * v[1] + r[2][2] * v[2],
    ]
}

fn transpose(p: &mut Covariance) {
    for i in 0..STATES {
        for j in 0..i {
            let t = p[i][j];
            p[i][j] = p[j][i];
            p[j][i] = t;
        }
    }
}

/// P ← Φ P Φᵀ + Q.
pub fn propagate(p: &mut Covariance, step: &Step, noise: &ProcessNoise) {
    for row in p.iter_mut() {
        step.forward(row);
    }
    transpose(p);
    for row in p.iter_mut() {
        step.forward(row);
    }
    let dt = step.dt_s;
    let white = [
        (VELOCITY, noise.acc_density),
        (ATTITUDE, noise.gyro_density),
        (GYRO_BIAS, noise.gyro_bias_walk),
        (ACC_BIAS, noise.acc_bias_walk),
    ];
    for (at, density) in white {
        for i in at..at + 3 {
            p[i][i] += density * density * dt;
        }
    }
    for i in 0..STATES {
        for j in 0..i {
            let mean = 0.5 * (p[i][j] + p[j][i]);
            p[i][j] = mean;
            p[j][i] = mean;
        }
    }
}

/// A scalar measurement as the smoother needs it: y = h·x + noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Update {
    /// Derivatives h.
    pub h: State,
    /// Gain P h / s.
    pub gain: State,
    /// Variance s of the innovation.
    pub variance: f64,
    /// Innovation y.
    pub innovation: f64,
}

/// Measures y = h·x with a variance: changes P, and returns the correction's parts; the estimated error is
/// `gain · innovation`.
pub fn update(p: &mut Covariance, h: &State, innovation: f64, noise_variance: f64) -> Update {
    let mut ph = [0.0; STATES];
    for i in 0..STATES {
        let mut sum = 0.0;
        for j in 0..STATES {
            sum += p[i][j] * h[j];
        }
        ph[i] = sum;
    }
    let mut variance = noise_variance;
    for i in 0..STATES {
        variance += h[i] * ph[i];
    }
    let mut gain = [0.0; STATES];
    for i in 0..STATES {
        gain[i] = ph[i] / variance;
    }
    for i in 0..STATES {
        for j in 0..=i {
            p[i][j] -= gain[i] * ph[j];
            p[j][i] = p[i][j];
        }
        p[i][i] = p[i][i].max(0.0);
    }
    Update { h: *h, gain, variance, innovation }
}

/// The smoother's λ and Λ on their way back.
#[derive(Clone, Copy, Debug)]
pub struct Adjoint {
    /// λ.
    pub vector: State,
    /// Λ.
    pub matrix: Covariance,
}

impl Default for Adjoint {
    fn default() -> Self {
        Adjoint { vector: [0.0; STATES], matrix: [[0.0; STATES]; STATES] }
    }
}

impl Adjoint {
    /// Back over a measurement.
    pub fn back_over_update(&mut self, u: &Update) {
        // λ ← (I − K h)ᵀ λ − h y / s ;  Λ ← (I − K h)ᵀ Λ (I − K h) + h hᵀ / s
        let mut along = 0.0;
        let mut lk = [0.0; STATES];
        for i in 0..STATES {
            along += u.gain[i] * self.vector[i];
            let mut sum = 0.0;
            for j in 0..STATES {
                sum += self.matrix[i][j] * u.gain[j];
            }
            lk[i] = sum;
        }
        let mut klk = 0.0;
        for i in 0..STATES {
            klk += u.gain[i] * lk[i];
        }
        let diagonal = klk + 1.0 / u.variance;
        for i in 0..STATES {
            if u.h[i] != 0.0 {
                self.vector[i] -= u.h[i] * (along + u.innovation / u.variance);
            }
        }
        for i in 0..STATES {
            for j in 0..=i {
                let change = u.h[i] * u.h[j] * diagonal - u.h[i] * lk[j] - lk[i] * u.h[j];
                self.matrix[i][j] += change;
                self.matrix[j][i] = self.matrix[i][j];
            }
        }
    }

    /// Back over a step.
    pub fn back_over_step(&mut self, step: &Step) {
        step.backward(&mut self.vector);
        for row in &mut self.matrix {
            step.backward(row);
        }
        transpose(&mut self.matrix);
        for row in &mut self.matrix {
            step.backward(row);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn step() -> Step {
        let q = crate::Quaternion::new(0.5, -0.1, 0.7, 0.3).normalized();
        Step { rotation: q.to_matrix(), acc_body: [1.0, -2.0, 9.0], rate_body: [0.3, 2.0, -1.0], dt_s: 0.01 }
    }

    #[test]
    fn backward_is_the_transpose_of_forward() {
        let s = step();
        for i in 0..STATES {
            let mut column = [0.0; STATES];
            column[i] = 1.0;
            s.forward(&mut column);
            for j in 0..STATES {
                let mut row = [0.0; STATES];
                row[j] = 1.0;
                s.backward(&mut row);
                assert!((column[j] - row[i]).abs() < 1e-15, "{i} {j}");
            }
        }
    }

    #[test]
    fn the_smoother_agrees_with_one_large_estimate() {
        // two steps, measurements of position x at the end and of velocity y at the start: the smoothed start
        // equals the update of the start by both at once, the end's measurement carried back by Φᵀ
        let s = step();
        let quiet =
            ProcessNoise { acc_density: 0.0, gyro_density: 0.0, acc_bias_walk: 0.0, gyro_bias_walk: 0.0 };
        let mut start = [[0.0; STATES]; STATES];
        for i in 0..STATES {
            start[i][i] = 0.01 + 0.001 * i as f64;
        }
        let mut h_velocity = [0.0; STATES];
        h_velocity[VELOCITY + 1] = 1.0;
        let mut h_position = [0.0; STATES];
        h_position[POSITION] = 1.0;

        let mut p = start;
        let first = update(&mut p, &h_velocity, 0.02, 1e-4);
        let after_first = p;
        propagate(&mut p, &s, &quiet);
        propagate(&mut p, &s, &quiet);
        // the filter has moved by its estimate: the second innovation is what is left
        let mut x = [0.0; STATES];
        for i in 0..STATES {
            x[i] = first.gain[i] * first.innovation;
        }
        s.forward(&mut x);
        s.forward(&mut x);
        let second = update(&mut p, &h_position, 0.03 - x[POSITION], 1e-5);
        let mut adjoint = Adjoint::default();
        adjoint.back_over_update(&second);
        adjoint.back_over_step(&s);
        adjoint.back_over_step(&s);

        let mut q = start;
        let a = update(&mut q, &h_velocity, 0.02, 1e-4);
        let mut h = h_position;
        s.backward(&mut h);
        s.backward(&mut h);
        let mut known = [0.0; STATES];
        let mut expected_innovation = 0.03;
        for i in 0..STATES {
            known[i] = a.gain[i] * a.innovation;
            expected_innovation -= h[i] * known[i];
        }
        let b = update(&mut q, &h, expected_innovation, 1e-5);
        for i in 0..STATES {
            let mut smoothed = known[i];
            let mut variance = after_first[i][i];
            for j in 0..STATES {
                smoothed -= after_first[i][j] * adjoint.vector[j];
                for k in 0..STATES {
                    variance -= after_first[i][j] * adjoint.matrix[j][k] * after_first[k][i];
                }
            }
            let expected = known[i] + b.gain[i] * b.innovation;
            assert!((smoothed - expected).abs() < 1e-12, "{i}: {smoothed} {expected}");
            assert!((variance - q[i][i]).abs() < 1e-12, "{i}: {variance} {}", q[i][i]);
        }
    }
}
