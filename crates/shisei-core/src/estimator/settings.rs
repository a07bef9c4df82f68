//! What the estimator can be told.
//!
//! Noise densities are per root of the bandwidth, so that they mean the same at every sample rate and every
//! length of the interval between updates. The defaults were found on the even-numbered trials of BROAD
//! (D. Laidig et al., Data 6(7), 2021) by a search with folds left out; docs/en/estimator.md says how, and what
//! did not help.

use super::calibration::Calibration;
use super::rest::RestLimits;

/// The numbers of one filter. Symbols are those of docs/en/estimator.md.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Model {
    /// `sg`, rad/√s: random walk of tilt. Stands for what the model leaves out, not only for the gyroscope's
    /// noise: small values average gravity over many seconds, large ones follow it within a second or two.
    pub tilt_noise: f64,
    /// `sh`, rad/√s: random walk of heading; the gyroscope's own noise (2e-4 is 0.01 °/s/√Hz). Only the stated
    /// heading uncertainty feels it.
    pub heading_noise: f64,
    /// `kw`, √s: more of both while turning, times the rate. Large values forget the learnt gyroscope matrix
    /// sooner in fast turns.
    pub noise_per_rate: f64,
    /// `kd`, 1: more of both where the rate's course bends from sample to sample, times the change of its change and
    /// the step. Matters for readings that jump; what changes evenly is integrated well at any sample rate.
    pub noise_per_rate_bend: f64,
    /// `sa`, m/s^1.5: random walk of velocity. Large values let slow accelerations pass for motion.
    pub velocity_noise: f64,
    /// `kj`, 1: more of it where the acceleration jumps within a sample, times the change and the step: blows,
    /// vibration, clipping. Large values ignore gravity for a while after a blow.
    pub velocity_noise_per_change: f64,
    /// `sbg0`, rad/s: standard deviation of the gyroscope bias at the start.
    pub gyro_bias_start: f64,
    /// `qbg`, rad/s/√s: random walk of the gyroscope bias. Large values follow temperature, small ones average.
    pub gyro_bias_walk: f64,
    /// `sba0`, m/s²: standard deviation of the accelerometer bias at the start.
    pub acc_bias_start: f64,
    /// `qba`, m/s²/√s: random walk of the accelerometer bias.
    pub acc_bias_walk: f64,
    /// `sM0`, 1: standard deviation of the elements of the gyroscope matrix at the start. 0 switches it off.
    pub gyro_matrix_start: f64,
    /// `qM`, 1/√s: random walk of those elements: what turns into one another as the sensor's attitude changes.
    pub gyro_matrix_walk: f64,
    /// `ss0`, 1: standard deviation of the accelerometer's scales at the start. 0 switches them off.
    pub acc_scale_start: f64,
    /// `cv`, √s: bounded motion by speed: "velocity is zero" is measured with a density of `cv` times the
    /// present speed (root mean square over 1 s). 0, and `sv` 0: left out. Small values hold tilt firmly and take slow
    /// real motion for tilt.
    pub speed_share: f64,
    /// `sv`, (m/s)√s: least density of that measurement; alone a constant one.
    pub speed_floor: f64,
    /// `sp`, m√s: bounded motion by place: "position is zero" is measured with this density. 0 leaves it out.
    pub position_spread: f64,
    /// `τp`, s: time in which the position is forgotten, so that slow walks pass; 0: never.
    pub position_forget_s: f64,
    /// `svr`, (m/s)√s: density of "velocity is zero" at rest.
    pub rest_speed: f64,
    /// `sgr`, (rad/s)√s: density of "the rate is the bias" at rest.
    pub rest_rate: f64,
    /// `ad`, s: delay of accelerations against rates: positive where the acceleration belongs to a later attitude than
    /// that in the middle of its sample's step.
    pub acc_delay_s: f64,
}

/// All settings of the estimator, its smoother and its bridging form.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// g, m/s²: gravity where the sensor is. Default 9.80665. An error of 0.03 is learnt as scale.
    pub gravity_m_s2: f64,
    /// T, s: time between updates of the covariance. Default 0.14. Smaller values cost time and change little.
    pub update_s: f64,
    /// The quick filter: tilt of the online form and of the fixed lag.
    pub quick: Model,
    /// The calm filter: heading and calibration of the online form, all of the smoother.
    pub calm: Model,
    /// Where optical poses are seen, and across their gaps.
    pub bridge: Model,
    /// When the sensor is at rest.
    pub rest: RestLimits,
    /// How much acceleration levels the start, s. Default 0.5.
    pub level_s: f64,
    /// Standard deviation of the tilt so found at rest, rad. Default 0.03; what moves at the start adds to it.
    pub level_sigma_rad: f64,
    /// A step longer than this is a gap, s: nothing is integrated over it. Default 0.5. Shorter ones are filled while the
    /// turn in them can be foretold, and treated as gaps where it cannot.
    pub gap_s: f64,
    /// What the rate may have been in a gap at least, rad/s: the heading's standard deviation grows by this times the
    /// gap's length, or by more where the movement before it was quicker. Default 0.5.
    pub gap_rate_rad_s: f64,
    /// Rates beyond this are no readings, rad/s. Default 100.
    pub gyro_limit_rad_s: f64,
    /// Accelerations beyond this are no readings, m/s². Default 2000.
    pub acc_limit_m_s2: f64,
    /// What is stated of the quick filter's tilt, as a share of its own standard deviation: a filter that is told of
    /// more noise than there is, so as to follow, doubts itself more than it must. Default 0.53; large values state
    /// more uncertainty. This and the next two make the stated uncertainty that of a simulated sensor whose errors
    /// are as these settings say; docs/en/estimator.md has the figures and the coverage on recordings.
    pub quick_sigma_share: f64,
    /// The same of the smoother's tilt. Default 0.7.
    pub smooth_sigma_share: f64,
    /// The same of the calm filter's heading, live and smoothed. Default 0.35.
    pub heading_sigma_share: f64,
    /// What is known of the sensor: applied before the filter, with its covariance in place of the start values.
    pub calibration: Option<Calibration>,
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            gravity_m_s2: crate::STANDARD_GRAVITY_M_S2,
            update_s: 0.14,
            quick: QUICK,
            calm: CALM,
            bridge: BRIDGE,
            rest: RestLimits::default(),
            level_s: 0.5,
            level_sigma_rad: 0.03,
            gap_s: 0.5,
            gap_rate_rad_s: 0.5,
            gyro_limit_rad_s: crate::LARGEST_RATE_RAD_S,
            acc_limit_m_s2: crate::LARGEST_ACC_M_S2,
            quick_sigma_share: 0.53,
            smooth_sigma_share: 0.7,
            heading_sigma_share: 0.35,
            calibration: None,
        }
    }
}

const QUICK: Model = Model {
    tilt_noise: 0.003,
    heading_noise: 2e-4,
    noise_per_rate: 1e-4,
    noise_per_rate_bend: 0.1,
    velocity_noise: 3e-4,
    velocity_noise_per_change: 0.25,
    gyro_bias_start: 0.03,
    gyro_bias_walk: 5e-4,
    acc_bias_start: 0.045,
    acc_bias_walk: 5e-5,
    gyro_matrix_start: 0.0075,
    gyro_matrix_walk: 0.0,
    acc_scale_start: 0.0066,
    speed_share: 1.25,
    speed_floor: 0.05,
    position_spread: 0.65,
    position_forget_s: 1.5,
    rest_speed: 0.0094,
    rest_rate: 0.001,
    acc_delay_s: 0.00125,
};

const CALM: Model = Model {
    tilt_noise: 2e-4,
    heading_noise: 2e-4,
    noise_per_rate: 3.5e-4,
    noise_per_rate_bend: 0.0,
    velocity_noise: 0.07,
    velocity_noise_per_change: 0.0,
    gyro_bias_start: 0.03,
    gyro_bias_walk: 2.5e-4,
    acc_bias_start: 0.02,
    acc_bias_walk: 1e-5,
    gyro_matrix_start: 0.009,
    gyro_matrix_walk: 4e-5,
    acc_scale_start: 0.02,
    speed_share: 3.0,
    speed_floor: 0.05,
    position_spread: 1.8,
    position_forget_s: 0.0,
    rest_speed: 0.0056,
    rest_rate: 0.006,
    acc_delay_s: 0.0015,
};

const BRIDGE: Model = Model {
    tilt_noise: 1.75e-4,
    heading_noise: 1.75e-4,
    noise_per_rate: 5e-4,
    velocity_noise: 0.03,
    velocity_noise_per_change: 0.2,
    gyro_bias_walk: 1.75e-5,
    acc_bias_start: 0.05,
    acc_bias_walk: 1e-5,
    gyro_matrix_start: 0.005,
    gyro_matrix_walk: 0.0,
    acc_scale_start: 0.01,
    speed_share: 0.0,
    speed_floor: 0.0,
    position_spread: 0.0,
    rest_speed: 0.0037,
    rest_rate: 1e-4,
    ..CALM
};
