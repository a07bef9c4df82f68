//! A sensor node as the hub sees it.

use std::collections::VecDeque;
use std::time::Instant;

use serde_json::{Value, json};
use shisei_core::calibration::Calibration;
use shisei_core::estimator::{Estimator, Sample as Reading, Settings};
use shisei_core::frames::Pose;
use shisei_core::fuse::Source;
use shisei_core::{Quaternion, Result, math};

use super::learn::NodePast;
use super::merge::{Merger, step};
use super::meter::Rate;
use super::optics::BodyKey;
use super::scene::Shown;
use crate::session::Sample;

/// Arrivals that wait for their samples at most.
const ARRIVALS: usize = 4096;

/// One node.
#[derive(Debug)]
pub struct Node {
    /// Which port it is on, and its place in the receiver.
    pub place: (usize, u8),
    /// As it calls itself.
    pub own_name: String,
    /// As it is called here.
    pub name: String,
    /// Its battery, V.
    pub battery_v: Option<f64>,
    /// Its temperature, °C.
    pub temperature_c: Option<f64>,
    /// Samples.
    pub rate: Rate,
    /// Samples lost since it was first heard.
    pub lost: u64,
    /// Error of its clock, s.
    pub clock_s: Option<f64>,
    /// Its last half minute.
    pub past: NodePast,
    /// The body it is on, as it was found or said.
    pub body: Option<BodyKey>,
    /// With that body.
    pub merger: Option<Box<Merger>>,
    /// Error of clocks when they were last compared, s.
    pub sync_s: Option<f64>,
    /// When that was asked last, by the length of its own past.
    pub asked: Option<Instant>,
    /// How often nothing was found.
    pub tries: u32,
    /// When samples came that the session has not yet given.
    arrivals: VecDeque<Instant>,
    /// When samples came that wait in the merger.
    pub merging: VecDeque<Instant>,
    /// Samples that the session has taken in.
    pub taken: u64,
    /// The calibration that it keeps: what it sends is as the sensor gave it.
    kept: Option<Calibration>,
    estimator: Estimator,
    last: Option<Sample>,
    attitude: Quaternion,
    /// What clients have set.
    heading: Quaternion,
    mounting: Quaternion,
    time_s: f64,
}

impl Node {
    /// A node that was just heard of.
    pub fn new(place: (usize, u8), name: String) -> Result<Self> {
        Ok(Node {
            place,
            own_name: name.clone(),
            name,
            battery_v: None,
            temperature_c: None,
            rate: Rate::default(),
            lost: 0,
            clock_s: None,
            past: NodePast::default(),
            body: None,
            merger: None,
            sync_s: None,
            asked: None,
            tries: 0,
            arrivals: VecDeque::new(),
            merging: VecDeque::new(),
            taken: 0,
            kept: None,
            estimator: Estimator::new(&Settings::default())?,
            last: None,
            attitude: Quaternion::IDENTITY,
            heading: Quaternion::IDENTITY,
            mounting: Quaternion::IDENTITY,
            time_s: 0.0,
        })
    }

    /// So many samples came in.
    pub fn arrived(&mut self, count: u64, at: Instant) {
        self.rate.add(at, count as u32);
        for _ in 0..count.min(ARRIVALS as u64) {
            self.arrivals.push_back(at);
        }
        while self.arrivals.len() > ARRIVALS {
            self.arrivals.pop_front();
        }
    }

    /// When the sample came that the session gives now.
    pub fn arrival(&mut self) -> Option<Instant> {
        self.arrivals.pop_front()
    }

    /// Its session began anew.
    pub fn restart(&mut self) {
        self.arrivals.clear();
        self.taken = 0;
    }

    /// It keeps this calibration, or none; true where that is another than was known. What was learnt of the sensor
    /// is no longer so then.
    pub fn keeps(&mut self, kept: Option<Calibration>) -> Result<bool> {
        if self.kept == kept {
            return Ok(false);
        }
        self.kept = kept;
        self.estimator = Estimator::new(&Settings::default())?;
        Ok(true)
    }

    /// A sample as the calibration corrects it.
    pub fn corrected(&self, sample: &Sample) -> Sample {
        self.kept.as_ref().map_or(*sample, |kept| Sample {
            gyro_rad_s: kept.gyroscope.apply(sample.gyro_rad_s),
            acc_m_s2: kept.accelerometer.apply(sample.acc_m_s2),
            ..*sample
        })
    }

    /// Without a body: the attitude alone.
    pub fn alone(&mut self, sample: &Sample, at: Instant) -> Shown {
        let usual_s = 1.0 / 120.0;
        let dt_s = self.last.map_or(usual_s, |last| step(&last, sample));
        self.last = Some(*sample);
        let reading = Reading { gyro_rad_s: sample.gyro_rad_s, acc_m_s2: sample.acc_m_s2, dt_s };
        let state = self.estimator.update(&reading);
        self.attitude = state.world_from_body;
        self.time_s += dt_s;
        Shown {
            pose: Pose { position_m: [0.0; 3], world_from_body: self.shown_attitude() },
            placed: false,
            source: Source::Inertial,
            gap_s: 0.0,
            sigma_rad: math::hypot(state.sigma_tilt_rad, state.sigma_heading_rad),
            sigma_m: f64::NAN,
            time_s: self.time_s,
            at,
        }
    }

    fn shown_attitude(&self) -> Quaternion {
        self.heading.product(self.attitude).product(self.mounting).normalized()
    }

    /// Its attitude becomes none, as of now: however it sits, it is straight.
    pub fn align(&mut self) {
        let yaw = self.attitude.to_ypr().yaw_rad;
        // the heading is kept apart from how it sits: turning it later turns about the vertical
        self.heading = about_z(-yaw);
        self.mounting = self.attitude.conjugate().product(about_z(yaw));
    }

    /// Its heading becomes this.
    pub fn set_heading(&mut self, yaw_rad: f64) {
        let now = self.shown_attitude().to_ypr().yaw_rad;
        self.heading = about_z(yaw_rad - now).product(self.heading).normalized();
    }

    /// Its line of the status message.
    pub fn status(&mut self, now: Instant) -> Value {
        json!({
            "name": self.name,
            "battery_v": self.battery_v,
            "temperature_c": self.temperature_c,
            "rate_hz": round(self.rate.hz(now), 1),
            "lost": self.lost,
            "clock_error_us": self.clock_s.map(|s| round(s * 1e6, 1)),
            "sync_error_us": self.sync_s.map(|s| round(s * 1e6, 1)),
            "last_s": self.rate.silent_s(now).map(|s| round(s, 3)),
        })
    }
}

fn about_z(angle_rad: f64) -> Quaternion {
    Quaternion::from_rotation_vector([0.0, 0.0, angle_rad])
}

/// A number as people read it.
pub fn round(value: f64, digits: i32) -> f64 {
    let scale = [1.0, 10.0, 100.0, 1000.0].get(digits.unsigned_abs() as usize).copied().unwrap_or(1.0);
    (value * scale).round() / scale
}
