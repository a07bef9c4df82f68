//! The demonstration: a simulated laboratory and a simulated Motive, as an input of the hub.

use std::sync::Arc;
use std::time::{Duration, Instant};

use shisei_core::frames::{Axes, Pose};
use shisei_core::{Quaternion, Vec3};
use shisei_hub::live::{Input, Kind, Line, State, What};
use shisei_hub::natnet::{self, write};
use shisei_twin::lab::{self, Lab};
use shisei_twin::stage::{self, BONES, Carrier, Stage};

/// From one look at everything to the next.
const LOOK: Duration = Duration::from_millis(4);
/// The laboratory's time goes on in steps; after a pulse by as much as brings the pulse out, s.
const AFTER_PULSE_S: f64 = 1e-3;
/// What the cameras' count is ahead of the receiver's.
const COUNT_AHEAD: i32 = 41_233;
/// Ticks of the simulated Motive's clock a second, Hz, and what it shows at the start, s.
const CLOCK_HZ: u64 = 10_000_000;
const CLOCK_START_S: f64 = 5_123.4;
/// From exposure to packet, s.
const TRANSPORT_S: f64 = 0.004;
/// Diameter of a marker, m.
const MARKER_M: f32 = 0.014;
const ALICE: i32 = 11;
/// Descriptions are sent so often, in frames, as an answer to a client that asks.
const DESCRIBED_EVERY: u32 = 600;

/// The simulated laboratory and cameras.
#[derive(Debug)]
pub struct Demo {
    lab: Lab,
    stage: Stage,
    version: natnet::Version,
    camera_hz: f64,
}

impl Demo {
    /// Four nodes, of which three are on bodies.
    pub fn new(seed: u64) -> Self {
        let settings = lab::Settings { nodes: 4, seed, movement_s: 120.0, ..lab::Settings::default() };
        let stage = stage::Settings { seed, ..stage::Settings::default() };
        let turn = Quaternion::from_rotation_vector;
        let carrier =
            |node: usize, name: &str, body_from_sensor, sensor_m, place_m, markers_m: &[Vec3]| Carrier {
                name: name.to_owned(),
                node,
                body_from_sensor,
                sensor_m,
                place_m,
                markers_m: markers_m.to_vec(),
            };
        let carriers = vec![
            carrier(
                0,
                "Tool 1",
                turn([0.3, -0.5, 1.2]),
                [0.03, 0.0, 0.01],
                [0.7, -0.6, 1.1],
                &[[0.0, 0.0, 0.0], [0.12, 0.0, 0.0], [0.0, 0.08, 0.0], [0.05, 0.0, 0.06]],
            ),
            carrier(
                1,
                "Board",
                turn([-1.0, 0.2, 0.1]),
                [-0.02, 0.04, 0.02],
                [-0.7, -0.6, 1.1],
                &[
                    [0.15, 0.1, 0.0],
                    [-0.15, 0.1, 0.0],
                    [-0.15, -0.1, 0.0],
                    [0.15, -0.1, 0.0],
                    [0.1, 0.0, 0.03],
                ],
            ),
            carrier(
                2,
                "Wand",
                turn([0.1, 2.0, -0.4]),
                [0.0, 0.0, 0.05],
                [0.0, -1.3, 1.2],
                &[[0.0, 0.0, 0.3], [0.0, 0.06, 0.2], [0.0, -0.05, 0.1], [0.04, 0.0, 0.0]],
            ),
        ];
        let camera_hz = settings.camera_hz;
        let (lab, stage) = (Lab::new(settings), Stage::new(stage, carriers));
        Demo { lab, stage, version: natnet::Version::V4_1, camera_hz }
    }

    fn server(&self) -> Vec<u8> {
        write::server_info(&natnet::ServerInfo {
            name: "shisei demo".into(),
            app_version: [3, 1, 0, 0],
            natnet_version: [self.version.major, self.version.minor, 0, 0],
            clock_hz: CLOCK_HZ,
            data_port: natnet::DATA_PORT,
            multicast: false,
            group: natnet::GROUP,
        })
    }

    fn model(&self) -> Vec<u8> {
        // the axes of bodies are their own; only the world's are renamed
        let floats = |v: Vec3| v.map(|x| x as f32);
        let bodies = self.stage.carriers().iter().zip(1..).map(|(carrier, id)| natnet::BodyDescription {
            name: carrier.name.clone(),
            id,
            parent: -1,
            offset_m: [0.0; 3],
            markers_m: carrier.markers_m.iter().map(|m| floats(*m)).collect(),
        });
        let bones = BONES.iter().zip(1..).map(|(bone, id)| natnet::BodyDescription {
            name: bone.name.to_owned(),
            id,
            parent: bone.parent.map_or(0, |parent| parent as i32 + 1),
            offset_m: floats(bone.offset_m),
            markers_m: Vec::new(),
        });
        let alice = natnet::SkeletonDescription { name: "Alice".into(), id: ALICE, bones: bones.collect() };
        write::model(&natnet::Model { bodies: bodies.collect(), skeletons: vec![alice] }, self.version)
    }

    fn frame(&self, seen: &stage::Frame) -> Vec<u8> {
        let to_motive = Axes::ZUp.to(Axes::YUp);
        let floats = |v: Vec3| to_motive.vector(v).map(|x| x as f32);
        let body = |id: i32, pose: Option<&Pose>| {
            let pose = pose.and_then(|pose| to_motive.world_of_pose(*pose).ok());
            let q = pose.map_or(Quaternion::IDENTITY, |pose| pose.world_from_body);
            let p = pose.map_or([0.0; 3], |pose| pose.position_m);
            natnet::Body {
                id,
                position_m: p.map(|x| x as f32),
                quaternion_xyzw: [q.x, q.y, q.z, q.w].map(|x| x as f32),
                error_m: if pose.is_some() { 2e-4 } else { 0.0 },
                params: i16::from(pose.is_some()),
            }
        };
        let bones = seen.bones.iter().zip(1..).map(|(bone, id)| body(ALICE << 16 | id, Some(bone)));
        let on_bodies =
            seen.bodies.iter().zip(self.stage.carriers()).zip(1..).flat_map(|((pose, carrier), id)| {
                carrier.markers_m.iter().zip(1..).filter_map(move |(marker, k)| {
                    let pose = (*pose)?;
                    let place =
                        shisei_core::vector::add(pose.position_m, pose.world_from_body.rotate(*marker));
                    Some(marker_at(id << 16 | k, floats(place), 0x0a))
                })
            });
        let loose = seen.loose_m.iter().zip(50_000..).map(|(m, id)| marker_at(id, floats(*m), 0x12));
        let time_s = seen.time_s;
        let ticks = |late_s: f64| ((CLOCK_START_S + time_s + late_s) * CLOCK_HZ as f64).round() as u64;
        let frame = natnet::Frame {
            number: COUNT_AHEAD + seen.number as i32,
            bodies: seen.bodies.iter().zip(1..).map(|(pose, id)| body(id, pose.as_ref())).collect(),
            skeletons: vec![natnet::Skeleton { id: ALICE, bones: bones.collect() }],
            markers: on_bodies.chain(loose).collect(),
            timestamp_s: time_s,
            mid_exposure: ticks(0.0),
            data_received: ticks(0.5 * TRANSPORT_S),
            transmit: ticks(TRANSPORT_S),
            ..natnet::Frame::default()
        };
        write::frame(&frame, self.version)
    }
}

fn marker_at(id: i32, position_m: [f32; 3], params: i16) -> natnet::LabeledMarker {
    natnet::LabeledMarker { id, position_m, size_m: MARKER_M, params, residual_m: 2e-4 }
}

impl Input for Demo {
    fn name(&self) -> String {
        "demo".into()
    }

    fn kind(&self) -> Kind {
        Kind::Demo
    }

    fn run(mut self: Box<Self>, line: &Line) {
        let (receiver, motive): (Arc<str>, Arc<str>) = ("demo-receiver".into(), "demo-motive".into());
        line.give(&receiver, What::State(State::Connected));
        line.give(&motive, What::NatNet(self.server()));
        let started = Instant::now();
        while !line.stopped() {
            while let Some((_, bytes)) = line.outbox().fetch() {
                self.lab.command(&bytes);
            }
            let time_s = started.elapsed().as_secs_f64();
            // up to the newest pulse: when this thread comes late, on a machine that is busy, no sample shall wait
            // for a pulse that the receiver would have sent in time
            let pulse_s = (time_s * self.camera_hz).floor() / self.camera_hz;
            self.lab.run_to(pulse_s + AFTER_PULSE_S);
            let mut bytes = Vec::new();
            self.lab.serial(&mut bytes);
            if !bytes.is_empty() && !line.give(&receiver, What::Serial(bytes)) {
                return;
            }
            while let Some(frame) = self.stage.frame(&self.lab, time_s - TRANSPORT_S) {
                if frame.number % DESCRIBED_EVERY == 0 {
                    line.give(&motive, What::NatNet(self.model()));
                }
                if !line.give(&motive, What::NatNet(self.frame(&frame))) {
                    return;
                }
            }
            std::thread::sleep(LOOK);
        }
    }
}
