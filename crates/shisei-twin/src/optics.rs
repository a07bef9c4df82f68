//! Cameras that film the body a sensor is fixed to: a clock of their own, noise, frames in which the body is
//! lost, markers that hide.
//!
//! Camera time t is motion time `offset + (1 + skew) t`. The body's frame is fixed to the sensor's by a
//! rotation and a lever arm, as a rigid body's frame in a motion capture program is.

use shisei_core::frames::Pose;
use shisei_core::vector::{add, scale};
use shisei_core::{Quaternion, Vec3, math};

use crate::motion::Motion;
use crate::random::Random;

const STREAM_OPTICS: u64 = 5;

/// What is filmed: where the sensor and the markers sit on the body.
#[derive(Clone, Debug, PartialEq)]
pub struct Rig {
    /// Turns sensor coordinates into body coordinates.
    pub body_from_sensor: Quaternion,
    /// The sensor in body coordinates, m.
    pub sensor_m: Vec3,
    /// Markers in body coordinates, m.
    pub markers_m: Vec<Vec3>,
}

/// The cameras.
#[derive(Clone, Debug, PartialEq)]
pub struct Cameras {
    /// Frames a second, Hz.
    pub rate_hz: f64,
    /// Length of the take in camera time, s.
    pub duration_s: f64,
    /// Motion time of camera time 0, s.
    pub offset_s: f64,
    /// Motion seconds in a camera second, less 1.
    pub skew: f64,
    /// Deviation of each component of the attitude, rad.
    pub attitude_sigma_rad: f64,
    /// Deviation of each coordinate, m.
    pub position_sigma_m: f64,
    /// Stretches of camera time without a pose, s.
    pub lost_s: Vec<(f64, f64)>,
    /// Share of frames without a pose, at random.
    pub lost: f64,
    /// Stretches in which only the first so many markers are seen, camera time, s.
    pub hidden_s: Vec<(f64, f64, usize)>,
    /// Seed of all that is random.
    pub seed: u64,
}

impl Cameras {
    /// Clocks alike, nothing lost, noise of a good room: 0.02° and 0.1 mm.
    pub fn new(rate_hz: f64, duration_s: f64, seed: u64) -> Self {
        Cameras {
            rate_hz,
            duration_s,
            offset_s: 0.0,
            skew: 0.0,
            attitude_sigma_rad: 0.02 * core::f64::consts::PI / 180.0,
            position_sigma_m: 1e-4,
            lost_s: Vec::new(),
            lost: 0.0,
            hidden_s: Vec::new(),
            seed,
        }
    }

    /// Motion time of a camera time, s.
    pub fn motion_time_s(&self, time_s: f64) -> f64 {
        self.offset_s + (1.0 + self.skew) * time_s
    }
}

/// What the cameras made of one frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// Number, from 0.
    pub number: i64,
    /// Camera time: number / rate, s.
    pub time_s: f64,
    /// The body, z up; none where it was lost.
    pub pose: Option<Pose>,
    /// The markers, z up; none where one was hidden.
    pub markers_m: Vec<Option<Vec3>>,
    /// The body as it was.
    pub truth: Pose,
}

/// Films a movement of a sensor. The position of the sensor is that of the motion.
pub fn film(motion: &dyn Motion, rig: &Rig, cameras: &Cameras) -> Vec<Frame> {
    let mut random = Random::new(cameras.seed, STREAM_OPTICS);
    let count = math::floor(cameras.duration_s * cameras.rate_hz + 1e-9) as i64;
    (0..=count)
        .map(|number| {
            let time_s = number as f64 / cameras.rate_hz;
            let state = motion.state(cameras.motion_time_s(time_s));
            let world_from_body = state.world_from_body.product(rig.body_from_sensor.conjugate());
            let position_m = add(state.position_m, scale(world_from_body.rotate(rig.sensor_m), -1.0));
            let truth = Pose { position_m, world_from_body };
            let turned = Quaternion::from_rotation_vector(random.normal3(cameras.attitude_sigma_rad));
            let seen = Pose {
                position_m: add(position_m, random.normal3(cameras.position_sigma_m)),
                world_from_body: world_from_body.product(turned).normalized(),
            };
            let during = |from: f64, to: f64| (from..to).contains(&time_s);
            let lost = cameras.lost_s.iter().any(|(from, to)| during(*from, *to));
            let lost = random.uniform() < cameras.lost || lost;
            let hidden = cameras.hidden_s.iter().find(|(from, to, _)| during(*from, *to));
            let left = if lost { 0 } else { hidden.map_or(usize::MAX, |(_, _, left)| *left) };
            let markers_m = rig.markers_m.iter().enumerate().map(|(index, marker)| {
                let noise = random.normal3(cameras.position_sigma_m);
                let place = add(add(position_m, world_from_body.rotate(*marker)), noise);
                (index < left).then_some(place)
            });
            let markers_m = markers_m.collect();
            let pose = (!lost && (left >= 3)).then_some(seen);
            Frame { number, time_s, pose, markers_m, truth }
        })
        .collect()
}
