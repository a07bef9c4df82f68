//! Bridging, live: the forward half of [`super::bridge`], sample by sample.
//!
//! The same filter and the same measurements, but nothing that lies ahead: a rest is known when it is found, a long
//! gap is bounded by how long it has lasted so far. So an error in a gap grows until the cameras are back, where the
//! smoother's is held at both ends; docs/en/live.md has both in figures.

use super::bridge::{UPDATE_S, bound};
use super::engine::{OpticalNoise, OpticalPose, Sight};
use super::guard::Sample;
use super::model::{POS, STATES_WITH_LEVER};
use super::online::{State, check};
use super::runner::{Event, Runner};
use super::settings::Settings;
use super::{BridgeSettings, Bridged};
use crate::error::Result;
use crate::math;
use crate::quaternion::Quaternion;
use crate::vector::{self, Vec3};

/// A rest is only used while the rate is nearer than this to the bias, rad/s (0.1 °/s): its end is found late, and
/// the first of a movement must not pass for a bias that jumped.
const REST_RATE_RAD_S: f64 = 0.002;

/// The streaming bridge. Constant time a sample, no allocator.
#[derive(Clone, Debug)]
pub struct LiveBridge {
    runner: Runner<STATES_WITH_LEVER, 1>,
    noise: OpticalNoise,
    /// The first position seen: what the filter's positions count from, m.
    origin_m: Option<Vec3>,
    /// The position follows from one that was seen.
    placed: bool,
    unseen_s: f64,
    bridged: Bridged,
}

impl LiveBridge {
    /// Starts with the first sample that has a pose. Refused: as [`super::Estimator::new`], and noise that is not
    /// positive.
    pub fn new(optics: &BridgeSettings, settings: &Settings) -> Result<Self> {
        check(settings)?;
        let noise = optics.noise()?;
        let settings =
            Settings { update_s: settings.update_s.min(UPDATE_S), heading_sigma_share: 1.0, ..*settings };
        let unknown = core::f64::consts::PI * core::f64::consts::PI;
        let covariance = [[unknown, 0.0, 0.0], [0.0, unknown, 0.0], [0.0, 0.0, unknown]];
        Ok(LiveBridge {
            runner: Runner::new(&settings, [&settings.bridge], optics.lever_m),
            noise,
            origin_m: None,
            placed: false,
            unseen_s: 0.0,
            bridged: Bridged {
                state: State::new(Quaternion::IDENTITY, [0.0; 3], [0.0; 3], covariance, false),
                velocity_m_s: [0.0; 3],
                position_m: [0.0; 3],
                sigma_position_m: f64::INFINITY,
            },
        })
    }

    /// Takes a sample and, where the cameras saw the sensor then, its pose: attitude of the sensor, in a world with z
    /// up. A pose that is not finite is none. Until the first pose nothing is known: `sigma_position_m` is infinite,
    /// as it is later where a hole in the samples has cut the position off from the last pose.
    pub fn update(&mut self, sample: &Sample, pose: Option<&OpticalPose>) -> Bridged {
        let pose = pose.and_then(|pose| pose.counted_from(&mut self.origin_m));
        if self.origin_m.is_none() {
            return self.bridged;
        }
        let step_s = if sample.dt_s > 0.0 && sample.dt_s < f64::INFINITY { sample.dt_s } else { 0.0 };
        self.unseen_s = if pose.is_some() { 0.0 } else { self.unseen_s + step_s };
        let bound = bound(self.unseen_s);
        let density = if bound > 0.0 { 1.0 / bound } else { 0.0 };
        let model = &mut self.runner.engines[0].model;
        (model.speed_floor, model.position_spread) = (density, density);
        let measured = pose.as_ref().map(|pose| Sight::Pose(pose, self.noise));
        let rate = vector::sub(sample.gyro_rad_s, self.bridged.state.gyro_bias_rad_s);
        let turns = vector::norm(rate) > REST_RATE_RAD_S;
        match self.runner.take(sample, turns.then_some(false), measured) {
            Event::Useless => return self.bridged,
            Event::LevelBegins | Event::LevelCut | Event::Levelling | Event::GivenUp => self.placed = false,
            Event::Levelled => self.placed = pose.is_some(),
            Event::Closed => self.placed |= pose.is_some(),
            Event::Moved => {}
        }
        self.bridged = self.now();
        self.bridged
    }

    /// What is known now.
    pub fn bridged(&self) -> Bridged {
        self.bridged
    }

    /// What goes on in [`super::FixedLagBridge`]: filter, noise, the first position seen, whether the position
    /// follows from one that was seen.
    pub(super) fn parts(&self) -> (Runner<STATES_WITH_LEVER, 1>, OpticalNoise, Option<Vec3>, bool) {
        (self.runner, self.noise, self.origin_m, self.placed)
    }

    fn now(&self) -> Bridged {
        let engine = &self.runner.engines[0];
        let nominal = &engine.nominal;
        let world_from_body = match &self.runner.level {
            Some(level) => level.attitude(),
            None => nominal.world_from_body,
        };
        let mut covariance = engine.attitude_covariance();
        covariance[2][2] += self.runner.heading_lost;
        let last = &self.bridged.state;
        let rate = self.runner.last_rate().map_or(last.rate_rad_s, |gyro| nominal.rate(gyro));
        let p = &engine.covariance.0;
        let variance = p[POS][POS] + p[POS + 1][POS + 1] + p[POS + 2][POS + 2];
        let from_origin = vector::add(nominal.position, world_from_body.rotate(nominal.lever));
        Bridged {
            state: State::new(world_from_body, rate, nominal.gyro_bias, covariance, self.runner.at_rest),
            velocity_m_s: nominal.velocity,
            position_m: vector::add(from_origin, self.origin_m.unwrap_or([0.0; 3])),
            sigma_position_m: if self.placed { math::sqrt(variance.max(0.0)) } else { f64::INFINITY },
        }
    }
}
