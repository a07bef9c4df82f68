//! The estimator for live use: one sample in, one state out, in constant time and without an allocator.
//!
//! Two filters of the same model run side by side. The quick one follows gravity within a second or two and gives
//! the tilt; the calm one averages for long, learns the sensor, and gives heading, biases and calibration.

use super::calibration::Calibration;
use super::guard::Sample;
use super::model::STATES;
use super::runner::{Event, Runner, heading_between};
use super::settings::Settings;
use crate::error::Result;
use crate::filter::{Filter, positive};
use crate::math;
use crate::quaternion::Quaternion;
use crate::vector::Vec3;

/// What is known after a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State {
    /// Attitude; yaw is 0 at the start.
    pub world_from_body: Quaternion,
    /// Rate without bias, scale and misalignment, rad/s, body.
    pub rate_rad_s: Vec3,
    /// Gyroscope bias, rad/s, body.
    pub gyro_bias_rad_s: Vec3,
    /// Standard deviation of the tilt: the root mean square angle between true and stated vertical, rad.
    pub sigma_tilt_rad: f64,
    /// Standard deviation of the heading since the start, rad.
    pub sigma_heading_rad: f64,
    /// Covariance of the attitude's error, rad², world axes.
    pub covariance_rad2: [Vec3; 3],
    /// True while the sensor is at rest.
    pub rest: bool,
}

impl State {
    pub(super) fn new(
        world_from_body: Quaternion,
        rate_rad_s: Vec3,
        gyro_bias_rad_s: Vec3,
        covariance_rad2: [Vec3; 3],
        rest: bool,
    ) -> Self {
        let c = &covariance_rad2;
        State {
            world_from_body,
            rate_rad_s,
            gyro_bias_rad_s,
            sigma_tilt_rad: math::sqrt((c[0][0] + c[1][1]).max(0.0)),
            sigma_heading_rad: math::sqrt(c[2][2].max(0.0)),
            covariance_rad2,
            rest,
        }
    }
}

#[cfg(feature = "alloc")]
impl State {
    /// The same in a world that is turned about z.
    pub(super) fn turned(self, turn: Quaternion) -> Self {
        let m = turn.to_matrix();
        let mut covariance_rad2 = [[0.0; 3]; 3];
        for j in 0..3 {
            for l in 0..3 {
                for a in 0..3 {
                    for b in 0..3 {
                        covariance_rad2[j][l] += m[j][a] * self.covariance_rad2[a][b] * m[l][b];
                    }
                }
            }
        }
        State { world_from_body: turn.product(self.world_from_body), covariance_rad2, ..self }
    }
}

/// Standard deviation of the attitude while nothing is known, rad.
const UNKNOWN_RAD: f64 = core::f64::consts::PI;

/// The streaming estimator.
#[derive(Clone, Copy, Debug)]
pub struct Estimator {
    runner: Runner<STATES, 2>,
    state: State,
}

impl Estimator {
    /// Starts with the first sample. Refused where gravity or the update time is not positive, or where a stored
    /// calibration is out of range.
    pub fn new(settings: &Settings) -> Result<Self> {
        check(settings)?;
        let sigma = UNKNOWN_RAD * UNKNOWN_RAD;
        let nothing = [[sigma, 0.0, 0.0], [0.0, sigma, 0.0], [0.0, 0.0, 0.0]];
        Ok(Estimator {
            runner: Runner::new(settings, [&settings.quick, &settings.calm], 0.0),
            state: State::new(Quaternion::IDENTITY, [0.0; 3], [0.0; 3], nothing, false),
        })
    }

    /// Takes a sample; never NaN. A sample without a usable step leaves all as it is; an unreadable rate or
    /// acceleration (not finite, beyond the limits, or stuck) is bridged by the one before while the stated
    /// uncertainty grows; after more than [`Settings::gap_s`] without, or a loss in which it may have turned far, the level
    /// is found anew.
    pub fn update(&mut self, sample: &Sample) -> State {
        let event = self.runner.take(sample, None, None);
        if event != Event::Useless {
            self.state = compose(&self.runner, sample, self.state.rate_rad_s);
        }
        self.state
    }

    /// What is known now.
    pub fn state(&self) -> State {
        self.state
    }

    /// What has been learnt of the sensor, to be stored and given to [`Settings::calibration`] next time.
    pub fn calibration(&self) -> Calibration {
        let calm = &self.runner.engines[1];
        let before = match self.runner.settings.calibration {
            Some(calibration) => calibration,
            None => Calibration::unknown(&calm.model),
        };
        before.followed_by(&calm.nominal, &calm.covariance)
    }
}

/// The state of both filters together: tilt of the quick one, all else of the calm one.
pub(super) fn compose(runner: &Runner<STATES, 2>, sample: &Sample, rate_before: Vec3) -> State {
    let [quick, calm] = &runner.engines;
    let settings = &runner.settings;
    let turn = heading_between(calm.nominal.world_from_body, quick.nominal.world_from_body);
    let heading = calm.covariance.0[2][2] * settings.heading_sigma_share * settings.heading_sigma_share
        + runner.heading_lost;
    let (q, covariance) = if let Some(level) = &runner.level {
        let sigma = level.sigma(settings.level_sigma_rad, settings.gravity_m_s2);
        let tilt = 0.5 * sigma * sigma;
        (level.attitude(), [[tilt, 0.0, 0.0], [0.0, tilt, 0.0], [0.0, 0.0, heading]])
    } else {
        (
            quick.nominal.world_from_body,
            stated(quick.attitude_covariance(), settings.quick_sigma_share, heading),
        )
    };
    let readable = sample.gyro_rad_s.iter().all(|x| x.abs() <= settings.gyro_limit_rad_s);
    let gyro = match &settings.calibration {
        Some(calibration) => calibration.correct_gyro(sample.gyro_rad_s),
        None => sample.gyro_rad_s,
    };
    let rate = if readable { calm.nominal.rate(gyro) } else { rate_before };
    State::new(turn.product(q).normalized(), rate, calm.nominal.gyro_bias, covariance, runner.at_rest)
}

/// The stated covariance: a share of a filter's tilt, and the heading's variance.
pub(super) fn stated(filter: [Vec3; 3], share: f64, heading: f64) -> [Vec3; 3] {
    let share = share * share;
    [
        [filter[0][0] * share, filter[0][1] * share, 0.0],
        [filter[1][0] * share, filter[1][1] * share, 0.0],
        [0.0, 0.0, heading],
    ]
}

impl Filter for Estimator {
    fn update(&mut self, gyro_rad_s: Vec3, acc_m_s2: Vec3, dt_s: f64) -> Quaternion {
        Estimator::update(self, &Sample { gyro_rad_s, acc_m_s2, dt_s }).world_from_body
    }

    fn orientation(&self) -> Quaternion {
        self.state.world_from_body
    }
}

pub(super) fn check(settings: &Settings) -> Result<()> {
    positive("gravity", settings.gravity_m_s2)?;
    positive("update_s", settings.update_s)?;
    positive("gap_s", settings.gap_s)?;
    positive("gyro_limit_rad_s", settings.gyro_limit_rad_s)?;
    positive("acc_limit_m_s2", settings.acc_limit_m_s2)?;
    settings.calibration.as_ref().map_or(Ok(()), Calibration::check)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_level_sensor_at_rest_is_level_and_its_bias_is_found() {
        let mut estimator = Estimator::new(&Settings::default()).unwrap();
        let sample = Sample { gyro_rad_s: [0.01, -0.005, 0.002], acc_m_s2: [0.0, 0.0, 9.80665], dt_s: 0.01 };
        let mut state = estimator.state();
        for _ in 0..1000 {
            state = estimator.update(&sample);
        }
        assert!(state.rest);
        assert!(state.world_from_body.angle() < 0.03, "{state:?}");
        assert!((state.gyro_bias_rad_s[0] - 0.01).abs() < 2e-4, "{state:?}");
    }

    #[test]
    fn settings_out_of_range_are_refused() {
        let settings = Settings { gravity_m_s2: 0.0, ..Settings::default() };
        assert!(Estimator::new(&settings).is_err());
    }
}
