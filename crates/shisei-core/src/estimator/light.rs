//! The estimator for a microcontroller: attitude, velocity and gyroscope bias only.
//!
//! The same model with nine error states and no calibration of its own: 5 kB instead of 18, and a third of the work
//! of [`super::Estimator`] on a PC. It knows rests, gaps and unreadable samples as the large one does. A calibration
//! that the large one has stored is applied to its readings.

use super::covariance::Covariance;
use super::engine::Rows;
use super::guard::{Checked, Guard, Reading, Sample};
use super::level::Leveller;
use super::online::{State, check};
use super::rest::RestFinder;
use super::settings::Settings;
use super::watch::Watch;
use crate::error::Result;
use crate::filter::Filter;
use crate::filter::exponential::{advance, exp_half};
use crate::quaternion::Quaternion;
use crate::vector::{self, Vec3};

/// Error states: φ, velocity, gyroscope bias.
const LIGHT: usize = 9;
const VEL: usize = 3;
const BIAS: usize = 6;
/// Random walk of tilt, rad/√s: larger than in the large model, for it stands for the missing calibration too.
const TILT_NOISE: f64 = 0.004;
/// The share of the rate that the missing gyroscope matrix turns into noise, √s.
const NOISE_PER_RATE: f64 = 0.003;
/// Random walk of the bias, rad/s/√s.
const BIAS_WALK: f64 = 3e-4;
/// Random walk of velocity, m/s^1.5, for the missing accelerometer bias.
const VELOCITY_NOISE: f64 = 0.02;
/// "Velocity is zero" is measured with this times the speed, √s, at least [`SPEED_FLOOR`].
const SPEED_SHARE: f64 = 1.0;
const SPEED_FLOOR: f64 = 0.05;
/// A bias this far from where it started is that of a filter gone astray, rad/s.
const BIAS_LIMIT: f64 = 0.5;
const SPEED_LIMIT: f64 = 100.0;
/// The most that gaps add to the variance of the heading, rad².
const LARGEST_HEADING: f64 = core::f64::consts::PI * core::f64::consts::PI;

/// The small streaming estimator.
#[derive(Clone, Copy, Debug)]
pub struct LightEstimator {
    settings: Settings,
    guard: Guard,
    finder: RestFinder,
    level: Option<Leveller>,
    started: bool,
    q: Quaternion,
    velocity: Vec3,
    bias: Vec3,
    covariance: Covariance<LIGHT>,
    speed_squared: f64,
    watch: Watch,
    /// Variance that gaps have added to the heading, rad².
    heading_lost: f64,
    sums: Sums,
    last: Option<Reading>,
    state: State,
}

/// Sums since the last update of the covariance.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    by_bias: [Vec3; 3],
    force: Vec3,
    gyro: Vec3,
    rate_squared: f64,
    acc_change_squared: f64,
    time_s: f64,
    blind_s: f64,
}

impl LightEstimator {
    /// Starts with the first sample; of the settings it uses gravity, the update time, rests, level, gaps, limits,
    /// the calibration, and of the quick filter what rests and blows say. Refused as [`super::Estimator::new`].
    pub fn new(settings: &Settings) -> Result<Self> {
        check(settings)?;
        let state = State::new(Quaternion::IDENTITY, [0.0; 3], [0.0; 3], [[0.0; 3]; 3], false);
        let mut covariance = Covariance::zero();
        covariance.set_diagonal(BIAS, 3, settings.quick.gyro_bias_start);
        Ok(LightEstimator {
            settings: *settings,
            guard: Guard::default(),
            finder: RestFinder::default(),
            level: None,
            started: false,
            q: Quaternion::IDENTITY,
            velocity: [0.0; 3],
            bias: [0.0; 3],
            covariance,
            speed_squared: 0.0,
            watch: Watch::new(settings.gravity_m_s2),
            heading_lost: 0.0,
            sums: Sums::default(),
            last: None,
            state,
        })
    }

    /// Takes a sample; as [`super::Estimator::update`].
    pub fn update(&mut self, sample: &Sample) -> State {
        let (reading, gap_s) = match self.guard.check(sample, &self.settings) {
            Checked::Useless => return self.state,
            Checked::Next(reading) => (reading, None),
            Checked::AfterGap(reading, gap_s) => (reading, Some(gap_s)),
        };
        if gap_s.is_some() {
            self.finder.restart();
        }
        let rest = self.finder.update(&self.settings.rest, &reading);
        let rate = vector::sub(reading.gyro, self.bias);
        if gap_s.is_some() || (!self.started && self.level.is_none()) {
            let turned = gap_s.unwrap_or(0.0) * self.settings.gap_rate_rad_s;
            self.heading_lost = (self.heading_lost + turned * turned).min(LARGEST_HEADING);
            self.level = Some(Leveller::new(self.started.then_some(self.q)));
        }
        if let Some(level) = &mut self.level {
            level.add(&reading, rate, reading.acc);
            let level = *level;
            self.q = level.attitude();
            if level.time_s + 0.5 * reading.dt_s >= self.settings.level_s {
                self.start(&level);
            }
        } else {
            self.add(&reading, rate);
            if self.sums.time_s + 0.5 * reading.dt_s >= self.settings.update_s {
                self.close(rest);
            }
        }
        let p = &self.covariance.0;
        let heading = p[2][2] + self.heading_lost;
        let covariance = match &self.level {
            Some(level) => {
                let sigma = level.sigma(self.settings.level_sigma_rad, self.settings.gravity_m_s2);
                let tilt = 0.5 * sigma * sigma;
                [[tilt, 0.0, 0.0], [0.0, tilt, 0.0], [0.0, 0.0, heading]]
            }
            None => [[p[0][0], p[0][1], 0.0], [p[1][0], p[1][1], 0.0], [0.0, 0.0, heading]],
        };
        self.state = State::new(self.q, rate, self.bias, covariance, rest);
        self.state
    }

    fn start(&mut self, level: &Leveller) {
        let sigma = level.sigma(self.settings.level_sigma_rad, self.settings.gravity_m_s2);
        let heading = self.covariance.0[2][2];
        let keep = [self.covariance.0[6], self.covariance.0[7], self.covariance.0[8]];
        self.covariance = Covariance::zero();
        for j in 0..3 {
            for l in 0..3 {
                self.covariance.0[BIAS + j][BIAS + l] = keep[j][BIAS + l];
            }
        }
        self.covariance.set_diagonal(0, 2, sigma);
        self.covariance.0[2][2] = heading + 1e-6;
        self.covariance.set_diagonal(VEL, 3, 0.3);
        self.velocity = [0.0; 3];
        self.speed_squared = 0.0;
        self.watch = Watch::new(self.settings.gravity_m_s2);
        self.sums = Sums::default();
        self.last = None;
        self.level = None;
        self.started = true;
    }

    fn add(&mut self, reading: &Reading, rate: Vec3) {
        let dt = reading.dt_s;
        let before = self.last.unwrap_or(*reading);
        let change = vector::sub(reading.gyro, before.gyro);
        let acc_change = vector::sub(reading.acc, before.acc);
        let rate = vector::sub(rate, vector::scale(change, reading.irregular));
        let quarter = vector::scale(rate, 0.25 * dt);
        let middle = advance(self.q, quarter);
        self.q = advance(middle, quarter);
        let matrix = middle.to_matrix();
        let mut acc = reading.acc;
        if reading.irregular != 0.0 {
            // in the middle of the usual step, not of this one: exp([δ]×) a to second order, for δ is small
            let turned = vector::scale(rate, reading.irregular * dt);
            let once = vector::cross(turned, acc);
            let twice = vector::cross(turned, once);
            acc = vector::add(acc, vector::add(once, vector::scale(twice, 0.5)));
        }
        let mut force =
            [vector::dot(matrix[0], acc), vector::dot(matrix[1], acc), vector::dot(matrix[2], acc)];
        if !reading.acc_known {
            force = [0.0, 0.0, self.settings.gravity_m_s2];
        }
        for j in 0..3 {
            for l in 0..3 {
                self.sums.by_bias[j][l] -= matrix[j][l] * dt;
            }
            self.sums.force[j] += force[j] * dt;
            self.sums.gyro[j] += reading.gyro[j] * dt;
            self.velocity[j] += force[j] * dt;
        }
        self.velocity[2] -= self.settings.gravity_m_s2 * dt;
        self.sums.rate_squared += vector::dot(rate, rate) * dt;
        self.sums.acc_change_squared += vector::dot(acc_change, acc_change) * dt * dt;
        self.sums.time_s += dt;
        if !(reading.gyro_known && reading.acc_known) {
            self.sums.blind_s += dt;
        }
        self.last = Some(*reading);
    }

    fn close(&mut self, rest: bool) {
        let sums = core::mem::take(&mut self.sums);
        let t = sums.time_s;
        self.propagate(&sums);
        let sq = |x: f64| x * x;
        let quick = &self.settings.quick;
        let p = &mut self.covariance.0;
        let turning = sq(NOISE_PER_RATE) * sums.rate_squared + sq(sums.blind_s);
        let push = sq(VELOCITY_NOISE) * t
            + sq(quick.velocity_noise_per_change) * sums.acc_change_squared
            + sq(5.0 * sums.blind_s);
        for j in 0..3 {
            p[j][j] += sq(if j < 2 { TILT_NOISE } else { quick.heading_noise }) * t + turning;
            p[VEL + j][VEL + j] += push;
            p[BIAS + j][BIAS + j] += sq(BIAS_WALK) * t;
        }
        let v = self.velocity;
        self.speed_squared += t.min(1.0) * (vector::dot(v, v) - self.speed_squared);
        let density = if rest {
            sq(quick.rest_speed)
        } else {
            (sq(SPEED_SHARE) * self.speed_squared).max(sq(SPEED_FLOOR))
        };
        let mut error = [0.0; LIGHT];
        self.covariance.measure(&mut error, &Rows::States(VEL), vector::scale(v, -1.0), density / t);
        if rest && sums.blind_s == 0.0 {
            let r = sq(quick.rest_rate) / t;
            let mut z = [0.0; 3];
            for j in 0..3 {
                z[j] = sums.gyro[j] / t - self.bias[j];
                let off = z[j] - error[BIAS + j];
                if off * off > 36.0 * (self.covariance.0[BIAS + j][BIAS + j] + r) {
                    self.covariance.0[BIAS + j][BIAS + j] += off * off;
                }
            }
            self.covariance.measure(&mut error, &Rows::States(BIAS), z, r);
        }
        self.covariance.settle();
        let turn = exp_half([0.5 * error[0], 0.5 * error[1], 0.5 * error[2]]);
        self.q = turn.product(self.q).normalized();
        for j in 0..3 {
            self.velocity[j] += error[VEL + j];
            self.bias[j] += error[BIAS + j];
        }
        let strange = sums.blind_s == 0.0 && self.watch.update(sums.force, t);
        let sound = !strange
            && self.q.is_finite()
            && self.covariance.is_sound()
            && self.bias.iter().all(|b| b.abs() <= BIAS_LIMIT)
            && self.velocity.iter().all(|v| v.abs() <= SPEED_LIMIT);
        if !sound {
            let q = if self.q.is_finite() { self.q } else { Quaternion::IDENTITY };
            self.covariance = Covariance::zero();
            self.covariance.set_diagonal(BIAS, 3, quick.gyro_bias_start);
            self.bias = [0.0; 3];
            self.heading_lost = (self.heading_lost + 1.0).min(LARGEST_HEADING);
            self.level = Some(Leveller::new(Some(q)));
        }
    }

    /// `Φ P Φᵀ` with φ ← A bg, v ← −[F]× φ − ½ [F]× A bg.
    fn propagate(&mut self, sums: &Sums) {
        let f = sums.force;
        let skew = [[0.0, -f[2], f[1]], [f[2], 0.0, -f[0]], [-f[1], f[0], 0.0]];
        let mut phi = [[0.0; LIGHT]; 6];
        for j in 0..3 {
            phi[j][j] = 1.0;
            phi[VEL + j][VEL + j] = 1.0;
            for l in 0..3 {
                phi[j][BIAS + l] = sums.by_bias[j][l];
                phi[VEL + j][l] = -skew[j][l];
                let mut sum = 0.0;
                for m in 0..3 {
                    sum -= skew[j][m] * sums.by_bias[m][l];
                }
                phi[VEL + j][BIAS + l] = 0.5 * sum;
            }
        }
        let p = &mut self.covariance.0;
        let mut moved = [[0.0; LIGHT]; 6];
        for r in 0..6 {
            for c in 0..LIGHT {
                if phi[r][c] != 0.0 {
                    for k in 0..LIGHT {
                        moved[r][k] += phi[r][c] * p[c][k];
                    }
                }
            }
        }
        for r in 0..6 {
            for s in 0..=r {
                let mut sum = 0.0;
                for c in 0..LIGHT {
                    sum += moved[r][c] * phi[s][c];
                }
                p[r][s] = sum;
                p[s][r] = sum;
            }
            for c in 6..LIGHT {
                p[r][c] = moved[r][c];
                p[c][r] = moved[r][c];
            }
        }
    }
}

impl Filter for LightEstimator {
    fn update(&mut self, gyro_rad_s: Vec3, acc_m_s2: Vec3, dt_s: f64) -> Quaternion {
        LightEstimator::update(self, &Sample { gyro_rad_s, acc_m_s2, dt_s }).world_from_body
    }

    fn orientation(&self) -> Quaternion {
        self.state.world_from_body
    }
}
