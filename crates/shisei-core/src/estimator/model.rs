//! The state of the estimator, its error coordinates, and the sums of an interval.
//!
//! Attitude errors live in the world frame: `q_true = Exp(φ) q`. All other errors are differences. Order of
//! the error states: φ 3, velocity 3, position 3, gyroscope bias 3, accelerometer bias 3, gyroscope matrix 9
//! (row by row), accelerometer scale 3, lever arm 3 (bridging only). A raw rate y and a raw acceleration a are
//! corrected as
//!
//! ```text
//! w = y − bg − M y        f = a − ba − s ∘ a
//! ```

use crate::filter::exponential::exp_half;
use crate::quaternion::Quaternion;
use crate::vector::{self, Vec3};

/// First error state of the attitude.
pub(super) const PHI: usize = 0;
/// First error state of the velocity.
pub(super) const VEL: usize = 3;
/// First error state of the position.
pub(super) const POS: usize = 6;
/// First error state of the gyroscope bias.
pub(super) const BG: usize = 9;
/// First error state of the accelerometer bias.
pub(super) const BA: usize = 12;
/// First error state of the gyroscope matrix.
pub(super) const MG: usize = 15;
/// First error state of the accelerometer scale.
pub(super) const SA: usize = 24;
/// First error state of the lever arm.
pub(super) const LEVER: usize = 27;
/// Error states without the lever arm.
pub(super) const STATES: usize = 27;
/// Error states with the lever arm.
pub(super) const STATES_WITH_LEVER: usize = 30;
/// Error states that move between measurements: attitude, velocity, position.
pub(super) const MOVING: usize = 9;

/// What is estimated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Nominal {
    pub world_from_body: Quaternion,
    /// m/s, world.
    pub velocity: Vec3,
    /// m, world.
    pub position: Vec3,
    /// rad/s, body.
    pub gyro_bias: Vec3,
    /// m/s², body.
    pub acc_bias: Vec3,
    /// Scale and misalignment of the gyroscope, 1.
    pub gyro_matrix: [Vec3; 3],
    /// Scale of the accelerometer, 1.
    pub acc_scale: Vec3,
    /// From the sensor to the optical body's point, m, body.
    pub lever: Vec3,
}

impl Nominal {
    pub(super) fn new(world_from_body: Quaternion) -> Self {
        Nominal {
            world_from_body,
            velocity: [0.0; 3],
            position: [0.0; 3],
            gyro_bias: [0.0; 3],
            acc_bias: [0.0; 3],
            gyro_matrix: [[0.0; 3]; 3],
            acc_scale: [0.0; 3],
            lever: [0.0; 3],
        }
    }

    /// The corrected rate, rad/s.
    #[inline]
    pub(super) fn rate(&self, gyro: Vec3) -> Vec3 {
        let m = &self.gyro_matrix;
        let turned = [vector::dot(m[0], gyro), vector::dot(m[1], gyro), vector::dot(m[2], gyro)];
        vector::sub(vector::sub(gyro, self.gyro_bias), turned)
    }

    /// The corrected specific force, m/s².
    #[inline]
    pub(super) fn force(&self, acc: Vec3) -> Vec3 {
        let (b, s) = (self.acc_bias, self.acc_scale);
        [acc[0] - b[0] - s[0] * acc[0], acc[1] - b[1] - s[1] * acc[1], acc[2] - b[2] - s[2] * acc[2]]
    }

    /// The state moved by an error.
    pub(super) fn moved<const N: usize>(&self, error: &[f64; N]) -> Self {
        let three = |at: usize| [error[at], error[at + 1], error[at + 2]];
        let turn = exp_half(vector::scale(three(PHI), 0.5));
        Nominal {
            world_from_body: turn.product(self.world_from_body).normalized(),
            velocity: vector::add(self.velocity, three(VEL)),
            position: vector::add(self.position, three(POS)),
            gyro_bias: vector::add(self.gyro_bias, three(BG)),
            acc_bias: vector::add(self.acc_bias, three(BA)),
            gyro_matrix: [
                vector::add(self.gyro_matrix[0], three(MG)),
                vector::add(self.gyro_matrix[1], three(MG + 3)),
                vector::add(self.gyro_matrix[2], three(MG + 6)),
            ],
            acc_scale: vector::add(self.acc_scale, three(SA)),
            lever: if N > LEVER { vector::add(self.lever, three(LEVER)) } else { self.lever },
        }
    }

    pub(super) fn is_finite(&self) -> bool {
        self.world_from_body.is_finite()
            && [
                self.velocity,
                self.position,
                self.gyro_bias,
                self.acc_bias,
                self.gyro_matrix[0],
                self.gyro_matrix[1],
                self.gyro_matrix[2],
                self.acc_scale,
                self.lever,
            ]
            .iter()
            .all(|&v| vector::is_finite(v))
    }
}

/// Sums over the samples between two updates of the covariance, from which its transition is made.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Interval {
    /// −Σ R dt: from gyroscope bias to attitude.
    pub attitude_by_bias: [Vec3; 3],
    /// −Σ R y dt: from the gyroscope matrix to attitude, a matrix for each of its rows.
    pub attitude_by_matrix: [[Vec3; 3]; 3],
    /// −Σ R dt with the attitude of the accelerations: from accelerometer bias to velocity.
    pub velocity_by_bias: [Vec3; 3],
    /// −Σ R diag(a) dt: from accelerometer scale to velocity.
    pub velocity_by_scale: [Vec3; 3],
    /// Σ of the specific force in the world, times dt, m/s.
    pub force: Vec3,
    /// Σ |w|² dt.
    pub rate_squared: f64,
    /// Σ |change of a|² dt².
    pub acc_change_squared: f64,
    /// Σ |change of the change of y|² dt².
    pub rate_bend_squared: f64,
    /// Covariance of the turns for which no sample stands, rad², world.
    pub unseen: [Vec3; 3],
    /// Variance of velocities for which no sample stands, (m/s)².
    pub unseen_velocity: f64,
    /// Σ y dt, rad.
    pub gyro: Vec3,
    /// Length, s.
    pub time_s: f64,
    /// Of it without a usable rate, s.
    pub blind_rate_s: f64,
    /// Of it without a usable acceleration, s.
    pub blind_force_s: f64,
}

/// A sample as the interval takes it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corrected {
    pub gyro: Vec3,
    pub acc: Vec3,
    pub rate: Vec3,
    /// Specific force in the world, m/s².
    pub force_world: Vec3,
    /// Rotation matrix in the middle of the turn.
    pub middle: [Vec3; 3],
    /// Rotation matrix at the acceleration.
    pub at_force: [Vec3; 3],
}

impl Interval {
    /// Adds doubt about a turn of this length, s, by the variance of its rate in body axes, (rad/s)².
    pub(super) fn doubt(&mut self, world_from_body: Quaternion, variance: Vec3, time_s: f64) {
        let matrix = world_from_body.to_matrix();
        for j in 0..3 {
            for l in 0..3 {
                for c in 0..3 {
                    self.unseen[j][l] += time_s * time_s * matrix[j][c] * variance[c] * matrix[l][c];
                }
            }
        }
    }

    /// Adds a sample.
    #[inline]
    pub(super) fn add(&mut self, sample: &Corrected, dt: f64) {
        for j in 0..3 {
            for l in 0..3 {
                let turn = sample.middle[j][l] * dt;
                self.attitude_by_bias[j][l] -= turn;
                for c in 0..3 {
                    self.attitude_by_matrix[l][j][c] -= turn * sample.gyro[c];
                }
                let push = sample.at_force[j][l] * dt;
                self.velocity_by_bias[j][l] -= push;
                self.velocity_by_scale[j][l] -= push * sample.acc[l];
            }
            self.force[j] += sample.force_world[j] * dt;
            self.gyro[j] += sample.gyro[j] * dt;
        }
        self.rate_squared += vector::dot(sample.rate, sample.rate) * dt;
        self.time_s += dt;
    }
}
