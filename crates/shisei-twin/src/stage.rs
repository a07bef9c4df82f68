//! Cameras that film a running laboratory, frame by frame: bodies that carry its nodes, a dancer without sensors,
//! markers that belong to nothing, and stretches in which a body is hidden.
//!
//! Coordinates: right-handed, z up, m. Frame n is exposed when the laboratory's camera pulse n is given, at true time
//! n / rate.

use core::f64::consts::PI;

use shisei_core::frames::Pose;
use shisei_core::vector::{add, scale};
use shisei_core::{Quaternion, Vec3, math};

use crate::lab::Lab;
use crate::random::Random;

const STREAM_NOISE: u64 = 60;
const STREAM_HIDDEN: u64 = 70;

/// A rigid body that carries a node.
#[derive(Clone, Debug, PartialEq)]
pub struct Carrier {
    /// Its name.
    pub name: String,
    /// Which node of the laboratory.
    pub node: usize,
    /// Turns sensor coordinates into body coordinates.
    pub body_from_sensor: Quaternion,
    /// The sensor in body coordinates, m.
    pub sensor_m: Vec3,
    /// Where the node's movement takes place, m.
    pub place_m: Vec3,
    /// Its markers, body coordinates, m.
    pub markers_m: Vec<Vec3>,
}

/// A bone of the dancer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bone {
    /// Its name.
    pub name: &'static str,
    /// The bone it hangs on, by its place in [`BONES`].
    pub parent: Option<usize>,
    /// Where it hangs there, m.
    pub offset_m: Vec3,
    /// The axis it swings about, by how much, rad, and how fast, Hz.
    swing: (Vec3, f64, f64),
}

const X: Vec3 = [1.0, 0.0, 0.0];
const Y: Vec3 = [0.0, 1.0, 0.0];
const Z: Vec3 = [0.0, 0.0, 1.0];

/// The dancer: facing x, parents before children.
pub const BONES: [Bone; 11] = [
    Bone { name: "Hips", parent: None, offset_m: [0.0, 0.0, 0.95], swing: (Z, 0.3, 0.25) },
    Bone { name: "Spine", parent: Some(0), offset_m: [0.0, 0.0, 0.12], swing: (Y, 0.15, 0.5) },
    Bone { name: "Head", parent: Some(1), offset_m: [0.0, 0.0, 0.42], swing: (Z, 0.4, 0.3) },
    Bone { name: "LeftArm", parent: Some(1), offset_m: [0.0, 0.19, 0.32], swing: (X, 0.8, 0.4) },
    Bone { name: "LeftForearm", parent: Some(3), offset_m: [0.0, 0.27, 0.0], swing: (Z, 0.7, 0.6) },
    Bone { name: "RightArm", parent: Some(1), offset_m: [0.0, -0.19, 0.32], swing: (X, -0.8, 0.4) },
    Bone { name: "RightForearm", parent: Some(5), offset_m: [0.0, -0.27, 0.0], swing: (Z, -0.7, 0.6) },
    Bone { name: "LeftThigh", parent: Some(0), offset_m: [0.0, 0.1, -0.04], swing: (Y, 0.4, 0.5) },
    Bone { name: "LeftShin", parent: Some(7), offset_m: [0.0, 0.0, -0.43], swing: (Y, 0.3, 0.5) },
    Bone { name: "RightThigh", parent: Some(0), offset_m: [0.0, -0.1, -0.04], swing: (Y, -0.4, 0.5) },
    Bone { name: "RightShin", parent: Some(9), offset_m: [0.0, 0.0, -0.43], swing: (Y, -0.3, 0.5) },
];

/// How the cameras are.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Frames a second, Hz: the laboratory's.
    pub rate_hz: f64,
    /// Deviation of each component of an attitude, rad.
    pub attitude_sigma_rad: f64,
    /// Deviation of each coordinate, m.
    pub position_sigma_m: f64,
    /// Each body is hidden once in so many seconds; 0: never.
    pub hidden_every_s: f64,
    /// For how long at least and at most, s.
    pub hidden_s: (f64, f64),
    /// Nothing is hidden before, s.
    pub hidden_from_s: f64,
    /// Where the dancer dances, m.
    pub dancer_m: Vec3,
    /// Markers that belong to nothing.
    pub loose: usize,
    /// Seed of all that is random.
    pub seed: u64,
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            rate_hz: 120.0,
            attitude_sigma_rad: 0.02 * PI / 180.0,
            position_sigma_m: 1e-4,
            hidden_every_s: 7.0,
            hidden_s: (0.4, 2.0),
            hidden_from_s: 20.0,
            dancer_m: [0.0, 1.6, 0.0],
            loose: 3,
            seed: 1,
        }
    }
}

/// What the cameras make of a moment.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// Number of the pulse.
    pub number: u32,
    /// True time, s.
    pub time_s: f64,
    /// The carriers; none where one is hidden.
    pub bodies: Vec<Option<Pose>>,
    /// The carriers as they are.
    pub truth: Vec<Pose>,
    /// The dancer's bones, in the order of [`BONES`].
    pub bones: Vec<Pose>,
    /// Markers that belong to nothing, m.
    pub loose_m: Vec<Vec3>,
}

/// The cameras.
#[derive(Clone, Debug)]
pub struct Stage {
    settings: Settings,
    carriers: Vec<Carrier>,
    noise: Random,
    next: u32,
}

impl Stage {
    /// With bodies.
    pub fn new(settings: Settings, carriers: Vec<Carrier>) -> Self {
        let noise = Random::new(settings.seed, STREAM_NOISE);
        Stage { settings, carriers, noise, next: 0 }
    }

    /// The bodies.
    pub fn carriers(&self) -> &[Carrier] {
        &self.carriers
    }

    /// The next frame that is exposed by a true time; none until then.
    pub fn frame(&mut self, lab: &Lab, by_s: f64) -> Option<Frame> {
        let number = self.next;
        let time_s = f64::from(number) / self.settings.rate_hz;
        if time_s > by_s {
            return None;
        }
        self.next += 1;
        let truth: Vec<Pose> = self.carriers.iter().map(|carrier| pose(carrier, lab, time_s)).collect();
        let bodies = truth.iter().enumerate().map(|(index, truth)| {
            // noise is drawn for hidden ones too, so that what is hidden changes nothing else
            let seen = noisy(truth, &mut self.noise, &self.settings);
            (!hidden(&self.settings, index, time_s)).then_some(seen)
        });
        let bodies = bodies.collect();
        let bones = dancer(&self.settings, time_s);
        let loose_m = (0..self.settings.loose).map(|k| loose(k, time_s)).collect();
        Some(Frame { number, time_s, bodies, truth, bones, loose_m })
    }
}

fn pose(carrier: &Carrier, lab: &Lab, time_s: f64) -> Pose {
    let (sensor, place) = match lab.state(carrier.node, time_s) {
        Some(state) => (state.world_from_body, state.position_m),
        None => (Quaternion::IDENTITY, [0.0; 3]),
    };
    let world_from_body = sensor.product(carrier.body_from_sensor.conjugate());
    let arm = world_from_body.rotate(carrier.sensor_m);
    Pose { position_m: add(add(place, carrier.place_m), scale(arm, -1.0)), world_from_body }
}

fn noisy(truth: &Pose, random: &mut Random, settings: &Settings) -> Pose {
    let turn = Quaternion::from_rotation_vector(random.normal3(settings.attitude_sigma_rad));
    Pose {
        position_m: add(truth.position_m, random.normal3(settings.position_sigma_m)),
        world_from_body: truth.world_from_body.product(turn).normalized(),
    }
}

/// A body is hidden once a period, at a time and for a length drawn for that period.
fn hidden(settings: &Settings, body: usize, time_s: f64) -> bool {
    let every_s = settings.hidden_every_s;
    if every_s <= 0.0 || time_s < settings.hidden_from_s {
        return false;
    }
    let period = math::floor(time_s / every_s);
    let stream = STREAM_HIDDEN + body as u64;
    let mut random = Random::new(settings.seed.wrapping_add(period as u64), stream);
    let (least, most) = settings.hidden_s;
    let length_s = random.between(least, most).min(every_s);
    let from_s = period * every_s + random.between(0.0, every_s - length_s);
    (from_s..from_s + length_s).contains(&time_s)
}

fn dancer(settings: &Settings, time_s: f64) -> Vec<Pose> {
    let mut poses: Vec<Pose> = Vec::with_capacity(BONES.len());
    for bone in &BONES {
        let (axis, amount_rad, frequency_hz) = bone.swing;
        let angle_rad = amount_rad * math::sin(2.0 * PI * frequency_hz * time_s);
        let swing = Quaternion::from_rotation_vector(scale(axis, angle_rad));
        let start = Pose { position_m: settings.dancer_m, world_from_body: Quaternion::IDENTITY };
        let parent = bone.parent.and_then(|parent| poses.get(parent)).copied().unwrap_or(start);
        poses.push(Pose {
            position_m: add(parent.position_m, parent.world_from_body.rotate(bone.offset_m)),
            world_from_body: parent.world_from_body.product(swing).normalized(),
        });
    }
    poses
}

fn loose(index: usize, time_s: f64) -> Vec3 {
    let phase = 2.0 * PI * (0.1 * time_s + 0.31 * index as f64);
    let (sin, cos) = math::sin_cos(phase);
    [-1.4 + 0.3 * cos, -0.8 + 0.3 * sin, 0.02 + 0.3 * index as f64]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lab;

    fn stage(hidden_every_s: f64) -> (Lab, Stage) {
        let lab = Lab::new(lab::Settings { nodes: 1, movement_s: 20.0, ..lab::Settings::default() });
        let carrier = Carrier {
            name: "body".into(),
            node: 0,
            body_from_sensor: Quaternion::from_rotation_vector([0.4, -0.2, 1.1]),
            sensor_m: [0.02, 0.01, -0.03],
            place_m: [1.0, 0.0, 1.0],
            markers_m: Vec::new(),
        };
        let settings = Settings { hidden_every_s, hidden_from_s: 0.0, ..Settings::default() };
        (lab, Stage::new(settings, vec![carrier]))
    }

    #[test]
    fn the_sensor_is_where_the_laboratory_has_it() {
        let (lab, mut stage) = stage(0.0);
        let mut count = 0;
        while let Some(frame) = stage.frame(&lab, 10.0) {
            let (carrier, truth) = (&stage.carriers()[0], frame.truth[0]);
            let state = lab.state(0, frame.time_s).unwrap();
            let arm = truth.world_from_body.rotate(carrier.sensor_m);
            let sensor = add(add(truth.position_m, arm), scale(carrier.place_m, -1.0));
            let off = add(sensor, scale(state.position_m, -1.0));
            assert!(off.iter().all(|x| x.abs() < 1e-12));
            let q = truth.world_from_body.product(carrier.body_from_sensor);
            assert!(q.conjugate().product(state.world_from_body).angle() < 1e-12);
            let seen = frame.bodies[0].unwrap();
            assert!(seen.world_from_body.conjugate().product(truth.world_from_body).angle() < 0.01);
            count += 1;
        }
        assert_eq!(count, 1201);
    }

    #[test]
    fn bodies_are_hidden_now_and_then() {
        let (lab, mut stage) = stage(5.0);
        let mut hidden = Vec::new();
        while let Some(frame) = stage.frame(&lab, 20.0) {
            hidden.push(frame.bodies[0].is_none());
        }
        let gaps = hidden.windows(2).filter(|pair| !pair[0] && pair[1]).count();
        let lost = hidden.iter().filter(|hidden| **hidden).count();
        assert!((3..=5).contains(&gaps), "{gaps}");
        assert!((150..1100).contains(&lost), "{lost}");
    }
}
