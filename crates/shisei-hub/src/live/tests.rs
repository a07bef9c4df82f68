//! The whole hub with a simulated laboratory, in the laboratory's own time: what goes into a recording, against the
//! truth.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use serde_json::Value;
use shisei_core::Quaternion;
use shisei_core::frames::{Axes, Pose};
use shisei_core::vector;
use shisei_twin::lab::{self, Lab};
use shisei_twin::stage::{self, Carrier, Stage};
use shisei_wire::frame::FRAME_MAX;
use shisei_wire::{Deframer, Message, encode_frame};

use super::board::Board;
use super::hub::Hub;
use super::input::{Arrival, Kind, ToHub, What};
use super::merge::Clocking;
use super::scene::Key;
use super::settings::Settings;
use crate::natnet::{self, write};

const RATE_HZ: f64 = 120.0;
const CLOCK_HZ: u64 = 10_000_000;
/// What the cameras' clock shows at the laboratory's start, s.
const CLOCK_START_S: f64 = 1000.0;
/// Time of day then, ns since 1970.
const START_NS: u64 = 1_700_000_000_000_000_000;
/// The receiver's port: the second that brings something.
const RECEIVER: usize = 1;
const BODIES: [&str; 2] = ["Tool 1", "Board"];

/// What was recorded, by topics: seconds since the start, and the message.
type Topics = BTreeMap<String, Vec<(f64, Value)>>;

/// A laboratory with two nodes on two bodies, and the hub that sees it.
struct Room {
    hub: Hub,
    lab: Lab,
    /// The cameras while node 0 is on body 0, and while it is on body 1.
    stages: [Stage; 2],
    swapped: bool,
    began: Instant,
    file: PathBuf,
    /// What the cameras filmed.
    filmed: Vec<stage::Frame>,
}

fn carriers(swapped: bool) -> Vec<Carrier> {
    let carrier = |k: usize| Carrier {
        name: BODIES[k].to_owned(),
        node: if swapped { 1 - k } else { k },
        body_from_sensor: Quaternion::from_rotation_vector([0.3, -0.5 + k as f64, 1.2]),
        sensor_m: [0.03, 0.0, 0.01],
        place_m: [k as f64, 0.0, 1.0],
        markers_m: Vec::new(),
    };
    vec![carrier(0), carrier(1)]
}

impl Room {
    fn new(name: &str, lab: lab::Settings) -> Self {
        let file = std::env::temp_dir().join(format!("shisei-room-{}-{name}.mcap", std::process::id()));
        let settings = Settings { record: file.clone(), ..Settings::default() };
        let inputs = vec![("receiver".into(), Kind::Serial), ("cameras".into(), Kind::NatNet)];
        let mut hub = Hub::new(settings, inputs, Vec::new(), Arc::new(Board::new("{}")));
        hub.begin_recording().expect("a file");
        let stages = [false, true].map(|swapped| Stage::new(stage::Settings::default(), carriers(swapped)));
        let lab = Lab::new(lab);
        let (began, filmed) = (Instant::now(), Vec::new());
        let mut room = Room { hub, lab, stages, swapped: false, began, file, filmed };
        room.give(1, "cameras", What::NatNet(write::server_info(&server())));
        room.give(1, "cameras", What::NatNet(write::model(&model(), natnet::Version::V4_1)));
        room
    }

    fn now(&self) -> Instant {
        self.began + Duration::from_secs_f64(self.lab.time_s())
    }

    fn give(&mut self, input: usize, port: &str, what: What) {
        let unix_ns = START_NS + (self.lab.time_s() * 1e9) as u64;
        self.hub.push(ToHub::Arrival(Arrival { input, port: port.into(), at: self.now(), unix_ns, what }));
    }

    /// Lets time pass; the receiver's bytes as `line` has them.
    fn run(&mut self, to_s: f64, mut line: impl FnMut(Vec<u8>) -> Vec<u8>) {
        while self.lab.time_s() < to_s {
            self.lab.run_to(self.lab.time_s() + 0.005);
            let mut bytes = Vec::new();
            self.lab.serial(&mut bytes);
            self.give(0, "receiver", What::Serial(line(bytes)));
            loop {
                let by_s = self.lab.time_s() - 0.004;
                let [one, other] = &mut self.stages;
                let (Some(one), Some(other)) = (one.frame(&self.lab, by_s), other.frame(&self.lab, by_s))
                else {
                    break;
                };
                let seen = if self.swapped { other } else { one };
                self.give(1, "cameras", What::NatNet(frame(&seen)));
                self.filmed.push(seen);
            }
            self.hub.tick(self.now());
            // however busy this machine is, answers come at the same time
            while !self.hub.learner.free() {
                std::thread::sleep(Duration::from_millis(1));
                self.hub.learn(self.now());
            }
        }
    }

    /// The body that a node is on, with its sensor.
    fn body_of(&mut self, place: u8) -> Option<String> {
        let node = self.hub.nodes.iter().find(|node| node.place == (RECEIVER, place))?;
        let body = node.body.filter(|_| node.merger.is_some())?;
        self.hub.scene.get_mut(Key::Body(body)).map(|object| object.name.clone())
    }

    /// Ends it; what was recorded, and what was filmed.
    fn end(mut self) -> (Topics, Vec<stage::Frame>) {
        // samples wait for the next pulse
        self.run(self.lab.time_s() + 0.1, |bytes| without_pulses(&bytes));
        let session = self.hub.ports[RECEIVER].session.as_ref().expect("a receiver");
        let taken: u64 = (0..2).filter_map(|place| session.quality(place)).map(|q| q.samples).sum();
        assert!(taken > session.counts().samples + 10);
        self.hub.finish();
        assert!(self.hub.unrecorded().is_empty());
        let waiting = self.hub.nodes.iter().filter_map(|node| node.merger.as_ref());
        assert_eq!(waiting.map(|merger| merger.waiting()).sum::<usize>(), 0);
        let file = std::fs::read(&self.file).expect("the recording");
        std::fs::remove_file(&self.file).expect("removed");
        let mut topics = Topics::new();
        for message in mcap::MessageStream::new(&file).expect("a recording") {
            let message = message.expect("whole");
            let value = serde_json::from_slice(&message.data).unwrap_or(Value::Null);
            let since_s = (message.log_time as f64 - START_NS as f64) * 1e-9;
            topics.entry(message.channel.topic.clone()).or_default().push((since_s, value));
        }
        // what was taken in at the end is there, too
        let samples: usize =
            topics.iter().filter(|(topic, _)| topic.starts_with("/sample/")).map(|(_, all)| all.len()).sum();
        assert_eq!(samples as u64, taken);
        (topics, self.filmed)
    }
}

fn server() -> natnet::ServerInfo {
    natnet::ServerInfo {
        name: "room".into(),
        app_version: [3, 1, 0, 0],
        natnet_version: [4, 1, 0, 0],
        clock_hz: CLOCK_HZ,
        data_port: natnet::DATA_PORT,
        multicast: false,
        group: natnet::GROUP,
    }
}

fn model() -> natnet::Model {
    let bodies = BODIES.iter().zip(1..).map(|(name, id)| natnet::BodyDescription {
        name: (*name).to_owned(),
        id,
        parent: -1,
        ..natnet::BodyDescription::default()
    });
    natnet::Model { bodies: bodies.collect(), skeletons: Vec::new() }
}

fn frame(seen: &stage::Frame) -> Vec<u8> {
    let bodies = seen.bodies.iter().zip(1..).map(|(pose, id)| {
        let pose = pose.and_then(|pose| Axes::ZUp.to(Axes::YUp).world_of_pose(pose).ok());
        let (p, q) = pose.map_or(([0.0; 3], Quaternion::IDENTITY), |p| (p.position_m, p.world_from_body));
        natnet::Body {
            id,
            position_m: p.map(|x| x as f32),
            quaternion_xyzw: [q.x, q.y, q.z, q.w].map(|x| x as f32),
            error_m: 0.0,
            params: i16::from(pose.is_some()),
        }
    });
    let frame = natnet::Frame {
        number: seen.number as i32,
        bodies: bodies.collect(),
        mid_exposure: ((CLOCK_START_S + seen.time_s) * CLOCK_HZ as f64) as u64,
        ..natnet::Frame::default()
    };
    write::frame(&frame, natnet::Version::V4_1)
}

/// Errors of what was given out of a body with a sensor while the cameras saw it and while they did not.
#[derive(Debug, Default)]
struct Errors {
    seen: usize,
    hidden: usize,
    /// Largest turn, rad, and largest distance, m, to the frame nearest in time.
    turn_rad: f64,
    apart_m: f64,
}

/// Rows of a sensor on a body against what was filmed; they are about what has just happened.
fn errors(rows: &[(f64, Value)], filmed: &[stage::Frame], body: usize) -> Errors {
    let mut errors = Errors::default();
    let mut last_s = 0.0;
    for (since_s, row) in rows {
        let time_s = row["time_s"].as_f64().expect("a time");
        // by pulses, or by the cameras' clock
        let time_s = if time_s >= CLOCK_START_S { time_s - CLOCK_START_S } else { time_s };
        assert!((-0.01..2.5).contains(&(since_s - time_s)), "{since_s}: {row}");
        assert!(time_s > last_s - 0.05, "{since_s}: {row} after {last_s}");
        last_s = time_s;
        let gap_s = row["gap_s"].as_f64().expect("a gap");
        assert!((0.0..5.0).contains(&gap_s), "{since_s}: {row}");
        let nearest = &filmed[((time_s * RATE_HZ).round() as usize).min(filmed.len() - 1)];
        let around = (time_s * RATE_HZ) as usize;
        let hidden = (around.saturating_sub(12)..around + 3)
            .all(|k| filmed.get(k).is_some_and(|frame| frame.bodies[body].is_none()));
        assert!(!hidden || row["source"] != "optical", "{since_s}: {row}");
        *(if hidden { &mut errors.hidden } else { &mut errors.seen }) += 1;
        let number = |value: &Value| value.as_f64().unwrap_or(f64::NAN);
        let (p, q) = (&row["p_m"], &row["q_wxyz"]);
        let q = Quaternion::new(number(&q[0]), number(&q[1]), number(&q[2]), number(&q[3]));
        let pose = Pose { position_m: [0, 1, 2].map(|axis| number(&p[axis])), world_from_body: q };
        let truth = nearest.truth[body];
        let turn = pose.world_from_body.conjugate().product(truth.world_from_body).angle();
        let apart = vector::norm(vector::sub(pose.position_m, truth.position_m));
        errors.turn_rad = errors.turn_rad.max(turn);
        errors.apart_m = errors.apart_m.max(apart);
    }
    println!("{} rows of {}: {errors:?}", rows.len(), BODIES[body]);
    errors
}

/// Two takes in one session, and the nodes change places in between.
#[test]
fn a_second_take_is_fused_anew_and_sensors_may_have_been_moved() {
    let (gate_s, second_gate_s) = (Some(1.5), Some(24.0));
    let lab = lab::Settings { gate_s, second_gate_s, movement_s: 120.0, ..lab::Settings::default() };
    let mut room = Room::new("takes", lab);
    room.run(23.9, |bytes| bytes);
    let on = |room: &mut Room| [room.body_of(0), room.body_of(1)].map(Option::unwrap_or_default);
    assert_eq!(on(&mut room), ["Tool 1", "Board"]);
    room.run(24.05, |bytes| bytes);
    room.swapped = true;
    room.run(25.0, |bytes| bytes);
    assert_eq!(on(&mut room), ["", ""]);
    assert!(room.hub.scene.objects().all(|object| object.node.is_none()));
    room.run(50.0, |bytes| bytes);
    assert_eq!(on(&mut room), ["Board", "Tool 1"]);
    let (topics, filmed) = room.end();
    for (body, topic) in ["Tool_1", "Board"].into_iter().enumerate() {
        for kind in ["fused", "smoothed"] {
            let rows = &topics[&format!("/{kind}/{topic}")];
            // what the cameras see without a sensor carries their own clock as well
            let errors = errors(rows, &filmed, body);
            assert!(errors.seen > 2000 && errors.hidden > 100, "{errors:?}");
            assert!(errors.turn_rad < 0.05 && errors.apart_m < 0.15, "{errors:?}");
        }
    }
}

/// The receiver's bytes without pulses.
fn without_pulses(bytes: &[u8]) -> Vec<u8> {
    let (mut deframer, mut out, mut frame) = (Deframer::default(), Vec::new(), [0; FRAME_MAX]);
    for &byte in bytes {
        let Some(Ok(message)) = deframer.push(byte) else { continue };
        if !matches!(Message::decode(message), Ok(Message::Pulse(_))) {
            let length = encode_frame(message, &mut frame).expect("it was one");
            out.extend_from_slice(&frame[..length]);
        }
    }
    out
}

/// The cable with the cameras' pulses is plugged in later.
#[test]
fn pulses_that_begin_later_move_no_times() {
    let mut room = Room::new("pulses", lab::Settings { movement_s: 120.0, ..lab::Settings::default() });
    room.hub.settings.pairs = vec![("node 0".into(), "Tool 1".into())];
    let clocking = |room: &Room| {
        let mergers = room.hub.nodes.iter().filter_map(|node| node.merger.as_ref());
        mergers.map(|merger| merger.coupling().clocking).collect::<Vec<_>>()
    };
    room.run(16.0, |bytes| without_pulses(&bytes));
    let by_times = clocking(&room);
    assert!(
        by_times.len() == 2 && by_times.iter().all(|c| matches!(c, Clocking::Times { .. })),
        "{by_times:?}"
    );
    room.run(66.0, |bytes| bytes);
    let by_pulses = clocking(&room);
    assert!(by_pulses.len() == 2 && by_pulses.iter().all(|c| matches!(c, Clocking::Pulses { .. })));
    // what was said of a body is brought back when its sensor has to be found again
    room.hub.uncouple(RECEIVER);
    assert!(room.hub.nodes.iter().all(|node| node.body.is_none()));
    room.hub.pair_by_name();
    let said: Vec<bool> = room.hub.nodes.iter().map(|node| node.body.is_some()).collect();
    assert_eq!(said, [true, false]);
    let (topics, filmed) = room.end();
    for (body, topic) in ["Tool_1", "Board"].into_iter().enumerate() {
        for kind in ["fused", "smoothed"] {
            let rows = &topics[&format!("/{kind}/{topic}")];
            let errors = errors(rows, &filmed, body);
            assert!(errors.seen > 4000 && errors.hidden > 100, "{errors:?}");
            assert!(errors.turn_rad < 0.05 && errors.apart_m < 0.15, "{errors:?}");
            assert!(rows.last().expect("rows").0 > 65.5);
        }
    }
}

/// A recording of the cameras alone is an input from which something comes.
#[test]
fn a_replay_of_cameras_is_not_waiting() {
    let inputs = vec![("take.mcap".into(), Kind::Replay)];
    let mut hub = Hub::new(Settings::default(), inputs, Vec::new(), Arc::new(Board::new("{}")));
    let lab = Lab::new(lab::Settings { nodes: 1, ..lab::Settings::default() });
    let mut stage = Stage::new(stage::Settings::default(), Vec::new());
    let began = Instant::now();
    let mut packets = vec![(0.0, write::server_info(&server()))];
    packets.extend(std::iter::from_fn(|| stage.frame(&lab, 4.0)).map(|seen| (seen.time_s, frame(&seen))));
    for (time_s, packet) in packets {
        let at = began + Duration::from_secs_f64(time_s);
        let (port, what) = ("cameras".into(), What::NatNet(packet));
        hub.push(ToHub::Arrival(Arrival { input: 0, port, at, unix_ns: START_NS, what }));
        hub.tick(at);
    }
    let status = hub.status(began + Duration::from_secs(4));
    let input = &status["inputs"][0];
    assert!(input["state"] == "connected" && input["rate_hz"].as_f64() > Some(100.0), "{input}");
}
