//! The hub: what comes from inputs becomes poses, in one thread, without waiting for anything.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use serde_json::json;
use shisei_core::estimator::BridgeSettings;
use shisei_core::frames::Axes;
use shisei_core::fuse::Source;
use shisei_core::{Lang, Vec3};

use super::board::Board;
use super::command::Command;
use super::input::{Arrival, Kind, State, ToHub, What, unix_ns};
use super::learn::{Learner, OpticalPast};
use super::merge::{Coupling, Merger, Moved, Seen};
use super::meter::{Latency, Rate};
use super::mounting::Mounting;
use super::node::Node;
use super::optics::{self, BodyKey, OpticalFrame};
use super::output::Output;
use super::recorder::{Record, Recorder};
use super::scene::{Key, Scene, Shown};
use crate::natnet;
use crate::session::{Item, Sample, Session};

/// Poses go to clients so often at most.
pub const SHOW: Duration = Duration::from_millis(16);
const STATUS: Duration = Duration::from_secs(1);
/// What has not moved for so long has vanished.
const VANISHED: Duration = Duration::from_millis(300);
/// Without a frame for so long, samples no longer wait for one.
const NO_FRAMES: Duration = Duration::from_millis(100);
/// An input without data for so long is waiting.
const SILENT: Duration = Duration::from_secs(2);
/// A frame number so much smaller than the last is another count.
const RESTART_FRAMES: i64 = 100;
/// Nodes and ports that are followed at most.
const NODES_MAX: usize = 256;
const PORTS_MAX: usize = 64;

/// How the hub works.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Axes of the cameras' world.
    pub axes: Axes,
    /// How well the cameras see.
    pub optics: BridgeSettings,
    /// Positions in gaps longer than this are not shown, s.
    pub position_trust_s: f64,
    /// Nodes that are on a body, by names; without one, bodies are found by their motion.
    pub pairs: Vec<(String, String)>,
    /// Where recordings go; the first begins at once where `record_now`.
    pub record: PathBuf,
    /// Record from the start.
    pub record_now: bool,
    /// The inputs are simulated.
    pub demo: bool,
    /// What `hello` tells clients.
    pub lang: Lang,
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            axes: Axes::YUp,
            optics: BridgeSettings { lever_m: 0.005, ..BridgeSettings::default() },
            position_trust_s: 5.0,
            pairs: Vec::new(),
            record: PathBuf::from("take.mcap"),
            record_now: false,
            demo: false,
            lang: Lang::En,
        }
    }
}

/// The first message to a client.
pub fn hello(settings: &Settings) -> String {
    let lang = if settings.lang == Lang::Ja { "ja" } else { "en" };
    json!({
        "type": "hello", "protocol": 1, "version": env!("CARGO_PKG_VERSION"), "lang": lang,
        "demo": settings.demo, "may": ["record", "align", "heading", "name"],
    })
    .to_string()
}

/// An input as the hub knows it.
#[derive(Debug)]
pub(super) struct InputState {
    pub name: String,
    pub kind: Kind,
    pub state: State,
    pub rate: Rate,
    pub lost: u64,
    pub bad: u64,
}

/// One port of one input.
#[derive(Debug)]
pub(super) struct Port {
    pub input: usize,
    pub name: Arc<str>,
    pub session: Option<Box<Session>>,
    pub stream: natnet::Stream,
    /// The server's newest words about itself and what it streams: a recording begins with them.
    pub words: [Option<Vec<u8>>; 2],
    pub from_gate: Option<bool>,
}

/// What the cameras say.
#[derive(Debug, Default)]
pub(super) struct Optical {
    pub past: OpticalPast,
    pub number: Option<i64>,
    pub exposure_s: f64,
    pub at: Option<Instant>,
    pub markers_m: Vec<Vec3>,
    pub frames: u64,
}

/// The hub.
#[derive(Debug)]
pub struct Hub {
    pub(super) settings: Settings,
    pub(super) inputs: Vec<InputState>,
    pub(super) ports: Vec<Port>,
    pub(super) nodes: Vec<Node>,
    pub(super) scene: Scene,
    pub(super) optical: Optical,
    pub(super) pulses: Rate,
    pub(super) latency: Latency,
    pub(super) outputs: Vec<Box<dyn Output>>,
    pub(super) recorder: Option<Recorder>,
    pub(super) learner: Learner,
    pub(super) board: Arc<Board>,
    pub(super) aliases: BTreeMap<String, String>,
    /// Mounting of bodies' sensors as it was given, by the body's name.
    pub(super) known: BTreeMap<String, Mounting>,
    pub(super) started: Instant,
    pub(super) ended_inputs: usize,
    shown_at: Instant,
    status_at: Option<Instant>,
    fresh: bool,
    items: Vec<Item>,
}

impl Hub {
    /// With its inputs' names and kinds, in the order of their lines.
    pub fn new(
        settings: Settings,
        inputs: Vec<(String, Kind)>,
        outputs: Vec<Box<dyn Output>>,
        board: Arc<Board>,
    ) -> Self {
        let now = Instant::now();
        let inputs = inputs.into_iter().map(|(name, kind)| InputState {
            name,
            kind,
            state: State::default(),
            rate: Rate::default(),
            lost: 0,
            bad: 0,
        });
        let mut hub = Hub {
            inputs: inputs.collect(),
            ports: Vec::new(),
            nodes: Vec::new(),
            scene: Scene::default(),
            optical: Optical::default(),
            pulses: Rate::default(),
            latency: Latency::default(),
            outputs,
            recorder: None,
            learner: Learner::default(),
            board,
            aliases: BTreeMap::new(),
            known: BTreeMap::new(),
            started: now,
            ended_inputs: 0,
            shown_at: now,
            status_at: None,
            fresh: false,
            items: Vec::new(),
            settings,
        };
        if hub.settings.record_now {
            hub.record(true);
        }
        hub
    }

    /// How bodies' sensors sit on them, by the bodies' names.
    pub fn know(&mut self, mountings: BTreeMap<String, Mounting>) {
        self.known = mountings;
    }

    /// All inputs have ended.
    pub fn over(&self) -> bool {
        self.ended_inputs > 0 && self.ended_inputs >= self.inputs.len()
    }

    /// When [`Hub::tick`] is due at the latest.
    pub fn due(&self) -> Instant {
        self.shown_at + SHOW
    }

    /// What there is to be seen.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// From samples' arrivals to their poses.
    pub fn latency(&self) -> &Latency {
        &self.latency
    }

    /// Samples lost on all ports, and frames read.
    pub fn losses(&self) -> (u64, u64) {
        let sessions = self.ports.iter().filter_map(|port| port.session.as_ref());
        sessions.fold((0, 0), |(lost, samples), session| {
            let counts = session.counts();
            (lost + counts.lost, samples + counts.samples)
        })
    }

    /// Takes what came.
    pub fn push(&mut self, message: ToHub) {
        match message {
            ToHub::Arrival(arrival) => self.arrival(arrival),
            ToHub::Command(command) => self.command(command),
        }
    }

    fn arrival(&mut self, arrival: Arrival) {
        let Some(input) = self.inputs.get_mut(arrival.input) else { return };
        if !matches!(arrival.what, What::State(_) | What::End) && input.state != State::Connected {
            input.state = State::Connected;
        }
        match &arrival.what {
            What::State(state) => self.input_state(arrival.input, *state),
            What::End => self.ended_inputs += 1,
            What::Serial(bytes) => self.serial(&arrival, bytes),
            What::NatNet(packet) => self.natnet(&arrival, packet),
        }
    }

    fn input_state(&mut self, input: usize, state: State) {
        let Some(known) = self.inputs.get_mut(input) else { return };
        if known.state == state {
            return;
        }
        known.state = state;
        let name = known.name.clone();
        match state {
            State::Lost => self.note(
                "warning",
                &format!("{name} is gone; waiting for it"),
                &format!("{name} との接続が切れました。復帰を待っています"),
            ),
            State::Connected => {
                self.note("info", &format!("{name} is connected"), &format!("{name} に接続しました"));
            }
            State::Waiting => {}
        }
    }

    /// The place of a port in the list; none where there are too many.
    fn port(&mut self, arrival: &Arrival) -> Option<usize> {
        let found =
            self.ports.iter().position(|port| port.input == arrival.input && *port.name == *arrival.port);
        if found.is_none() && self.ports.len() < PORTS_MAX {
            self.ports.push(Port {
                input: arrival.input,
                name: Arc::clone(&arrival.port),
                session: None,
                stream: natnet::Stream::default(),
                words: [None, None],
                from_gate: None,
            });
            return Some(self.ports.len() - 1);
        }
        found
    }

    fn serial(&mut self, arrival: &Arrival, bytes: &[u8]) {
        let Some(index) = self.port(arrival) else { return };
        let port = &mut self.ports[index];
        if let Some(recorder) = &self.recorder {
            recorder.give(Record::Raw(Arc::clone(&port.name), bytes.to_vec(), arrival.unix_ns));
        }
        let mut items = std::mem::take(&mut self.items);
        let mut session = port.session.take().unwrap_or_default();
        let before = session.counts();
        session.push(bytes, &mut items);
        let after = session.counts();
        let (name, receiver_s) = (Arc::clone(&port.name), session.time_s());
        for place in session.nodes() {
            let Some(quality) = session.quality(place) else { continue };
            let Some(node) = self.node(index, place) else { continue };
            if quality.samples < node.taken {
                node.restart();
            }
            node.arrived(quality.samples.saturating_sub(node.taken), arrival.at);
            node.taken = quality.samples;
            node.clock_s = quality.clock_residual_s;
        }
        self.ports[index].session = Some(session);
        self.pulses.add(arrival.at, (after.pulses - before.pulses) as u32);
        if let Some(input) = self.inputs.get_mut(arrival.input) {
            input.rate.add(arrival.at, (after.samples - before.samples) as u32);
            input.lost += after.lost - before.lost;
            input.bad += after.garbage - before.garbage;
        }
        for item in items.drain(..) {
            if let Some(recorder) = &self.recorder
                && !matches!(item, Item::Hello(_))
            {
                let item = Box::new(item.clone());
                recorder.give(Record::Item(Arc::clone(&name), item, receiver_s, arrival.unix_ns));
            }
            self.item(index, item, arrival);
        }
        self.items = items;
    }

    /// The node at a place of a port.
    pub(super) fn node(&mut self, port: usize, place: u8) -> Option<&mut Node> {
        let found = self.nodes.iter().position(|node| node.place == (port, place));
        let index = match found {
            Some(index) => index,
            None if self.nodes.len() < NODES_MAX => {
                self.nodes.push(Node::new((port, place), format!("node {place}")).ok()?);
                self.nodes.len() - 1
            }
            None => return None,
        };
        self.nodes.get_mut(index)
    }

    fn item(&mut self, port: usize, item: Item, arrival: &Arrival) {
        match item {
            Item::Sample(sample) => self.sample(port, &sample, arrival),
            Item::Node(info) => {
                let alias = self.aliases.get(&info.name).cloned();
                let Some(node) = self.node(port, info.node) else { return };
                node.battery_v = (info.battery_mv > 0).then(|| f64::from(info.battery_mv) * 1e-3);
                node.temperature_c = info.temperature_centi_c.map(|t| f64::from(t) * 0.01);
                if !info.name.is_empty() && node.own_name != info.name {
                    node.own_name.clone_from(&info.name);
                    node.name = alias.unwrap_or(info.name);
                    let (name, place) = (node.name.clone(), node.place);
                    self.renamed(place, &name);
                }
            }
            Item::Lost(place, count) => {
                if let Some(node) = self.node(port, place) {
                    node.lost += count;
                }
            }
            Item::Rebooted(place, _) => {
                if let Some(node) = self.node(port, place) {
                    node.past.clear();
                    let name = node.name.clone();
                    self.note(
                        "warning",
                        &format!("{name} started anew"),
                        &format!("{name} が再起動しました"),
                    );
                }
            }
            Item::ReceiverRebooted(_) => {
                self.note("warning", "the receiver started anew", "レシーバが再起動しました");
                self.uncouple(port);
            }
            Item::Calibration(..) | Item::Event(_) | Item::Hello(_) | Item::Garbage => {}
        }
    }

    /// A name of a node has changed.
    pub(super) fn renamed(&mut self, place: (usize, u8), name: &str) {
        let Some(index) = self.nodes.iter().position(|node| node.place == place) else { return };
        let body = self.nodes[index].body;
        if let Some(object) = self.scene.get_mut(Key::Node(index)) {
            name.clone_into(&mut object.name);
        }
        if let Some(object) = body.and_then(|body| self.scene.get_mut(Key::Body(body))) {
            object.node = Some(name.to_owned());
        }
        self.scene.changed = true;
    }

    fn sample(&mut self, port: usize, sample: &Sample, arrival: &Arrival) {
        // another count of the pulses: frames before and after have nothing to do with each other
        let known = self.ports[port].from_gate;
        if sample.frame.is_some() && known != Some(sample.from_gate) {
            self.ports[port].from_gate = Some(sample.from_gate);
            if known.is_some() {
                self.uncouple(port);
            }
        }
        let Some(index) = self.nodes.iter().position(|node| node.place == (port, sample.node)) else {
            return;
        };
        let node = &mut self.nodes[index];
        let came = node.arrival();
        node.past.push(sample, arrival.unix_ns as f64 * 1e-9);
        if let Some(t) = sample.temperature_c {
            node.temperature_c = Some(t);
        }
        if let Some(merger) = &mut node.merger {
            let mut moved = Vec::new();
            merger.sample(sample, &mut moved);
            self.moved(index, &moved, arrival);
        } else {
            let shown = node.alone(sample, arrival.at);
            let name = node.name.clone();
            self.scene.object(Key::Node(index), &name).shown = Some(shown);
        }
        self.fresh = true;
        if let Some(came) = came {
            self.latency.add(came.elapsed());
        }
    }

    /// A body has moved as its sensor says.
    fn moved(&mut self, node: usize, moved: &[Moved], arrival: &Arrival) {
        let Some(body) = self.nodes.get(node).and_then(|node| node.body) else { return };
        let trust_s = self.settings.position_trust_s;
        let Some(object) = self.scene.get_mut(Key::Body(body)) else { return };
        for step in moved {
            let placed = step.sigma_m.is_finite() && step.gap_s <= trust_s;
            let in_gap = step.gap_s > 0.0;
            let source = match (in_gap, placed) {
                (false, _) => Source::Optical,
                (true, true) => Source::Bridged,
                (true, false) => Source::Inertial,
            };
            let shown = Shown {
                pose: step.pose,
                placed: placed || !in_gap,
                source,
                gap_s: step.gap_s,
                sigma_rad: step.sigma_rad,
                sigma_m: step.sigma_m,
                time_s: step.time_s,
                at: arrival.at,
            };
            if let Some(recorder) = &self.recorder {
                recorder.give(Record::Pose(object.path(), shown, arrival.unix_ns));
            }
            if in_gap && object.shown.is_none_or(|last| last.time_s < step.time_s) {
                object.shown = Some(shown);
            }
        }
    }

    fn natnet(&mut self, arrival: &Arrival, packet: &[u8]) {
        let Some(index) = self.port(arrival) else { return };
        let port = &mut self.ports[index];
        if let Some(recorder) = &self.recorder {
            recorder.give(Record::Raw(Arc::clone(&port.name), packet.to_vec(), arrival.unix_ns));
        }
        match port.stream.push(packet) {
            Ok(natnet::Told::Server(_)) => port.words[0] = Some(packet.to_vec()),
            Ok(natnet::Told::Model(model)) => {
                port.words[1] = Some(packet.to_vec());
                self.scene.describe(&optics::bodies(&model));
                self.pair_by_name();
            }
            Ok(natnet::Told::Frame(frame)) => {
                let clock_hz = port.stream.server().map_or(0, |server| server.clock_hz);
                let frame = optics::frame(&frame, clock_hz, self.settings.axes);
                self.frame(&frame, arrival);
            }
            Ok(natnet::Told::Nothing) => {}
            Err(natnet::Malformed) => {
                if let Some(input) = self.inputs.get_mut(arrival.input) {
                    input.bad += 1;
                }
            }
        }
    }

    fn frame(&mut self, frame: &OpticalFrame, arrival: &Arrival) {
        if !frame.exposure_s.is_finite() {
            return;
        }
        if let Some(last) = self.optical.number {
            let back = last - frame.number;
            if back > RESTART_FRAMES || (back < 0 && frame.exposure_s < self.optical.exposure_s) {
                self.note(
                    "warning",
                    "the cameras' count began anew",
                    "カメラのフレーム番号が最初に戻りました",
                );
                self.optical.past.clear();
                (0..self.ports.len()).for_each(|port| self.uncouple(port));
                self.optical.number = None;
            } else if let Some(input) = self.inputs.get_mut(arrival.input) {
                // late ones are counted as lost and found again
                input.lost = match back {
                    ..=-1 => input.lost + (back.unsigned_abs() - 1),
                    _ => input.lost.saturating_sub(1),
                };
            }
        }
        if let Some(input) = self.inputs.get_mut(arrival.input)
            && input.kind == Kind::NatNet
        {
            input.rate.add(arrival.at, 1);
        }
        self.optical.frames += 1;
        self.optical.past.push(frame, arrival.unix_ns as f64 * 1e-9);
        let newest = self.optical.number.is_none_or(|last| frame.number > last);
        if newest {
            self.optical.number = Some(frame.number);
            self.optical.exposure_s = frame.exposure_s;
            self.optical.at = Some(arrival.at);
            self.optical.markers_m.clone_from(&frame.markers_m);
            frame.bodies.iter().for_each(|(key, pose)| self.seen(frame, *key, *pose, arrival));
        }
        for index in 0..self.nodes.len() {
            let node = &mut self.nodes[index];
            let (Some(merger), Some(body)) = (&mut node.merger, node.body) else { continue };
            let pose = frame.bodies.iter().find(|(key, _)| *key == body).and_then(|(_, pose)| *pose);
            let mut moved = Vec::new();
            let seen = Seen { number: frame.number, exposure_s: frame.exposure_s, pose };
            merger.frame(seen, &mut moved);
            self.moved(index, &moved, arrival);
        }
        if newest {
            self.give_out();
        }
    }

    /// Passes on where everything is.
    fn give_out(&mut self) {
        self.fresh = false;
        let (scene, optical) = (&self.scene, &self.optical);
        for output in &mut self.outputs {
            output.poses(scene, optical.number, optical.exposure_s);
        }
    }

    /// A body in the newest frame.
    fn seen(
        &mut self,
        frame: &OpticalFrame,
        key: BodyKey,
        pose: Option<shisei_core::frames::Pose>,
        arrival: &Arrival,
    ) {
        let node = self.nodes.iter().find(|node| node.body == Some(key) && node.merger.is_some());
        let coupling = node.and_then(|node| node.merger.as_ref()).map(|merger| *merger.coupling());
        let time_s = coupling
            .map_or(frame.exposure_s, |coupling| coupling.frame_time_s(frame.number, frame.exposure_s));
        let optics = self.settings.optics;
        let object = self.scene.object(Key::Body(key), &default_name(key));
        if let Some(pose) = pose {
            let shown = Shown {
                pose,
                placed: true,
                source: Source::Optical,
                gap_s: 0.0,
                sigma_rad: optics.attitude_rad,
                sigma_m: optics.position_m,
                time_s,
                at: arrival.at,
            };
            object.shown = Some(shown);
            if let Some(recorder) = &self.recorder {
                recorder.give(Record::Optical(object.path(), shown, frame.number, arrival.unix_ns));
                if coupling.is_none() {
                    recorder.give(Record::Pose(object.path(), shown, arrival.unix_ns));
                }
            }
        } else if coupling.is_none()
            && let Some(shown) = &mut object.shown
            && shown.source != Source::None
        {
            shown.source = Source::None;
            (shown.sigma_rad, shown.sigma_m) = (f64::NAN, f64::NAN);
        }
    }

    /// Sensors of a port are no longer brought together with bodies: its clock has changed.
    fn uncouple(&mut self, port: usize) {
        for node in self.nodes.iter_mut().filter(|node| node.place.0 == port) {
            node.past.clear();
            node.merger = None;
            node.asked = None;
            node.sync_s = None;
        }
    }

    /// A sensor is brought together with a body from now on.
    pub(super) fn couple(&mut self, index: usize, body: BodyKey, coupling: Coupling, sigma_s: f64) {
        let name = self.scene.get_mut(Key::Body(body)).map(|object| object.name.clone()).unwrap_or_default();
        let alignment =
            self.known.get(&name).map_or(coupling.alignment, |known| known.onto(&coupling.alignment));
        let coupling = Coupling { alignment, ..coupling };
        let Ok(merger) = Merger::new(coupling, &self.settings.optics) else { return };
        let Some(node) = self.nodes.get_mut(index) else { return };
        node.merger = Some(Box::new(merger));
        node.body = Some(body);
        node.sync_s = Some(sigma_s);
        let name = node.name.clone();
        self.scene.remove(Key::Node(index));
        if let Some(object) = self.scene.get_mut(Key::Body(body)) {
            object.node = Some(name.clone());
            let body_name = object.name.clone();
            if let Some(shown) = &mut object.shown {
                // times of another clock are not compared with the new one's
                shown.time_s = f64::NEG_INFINITY;
            }
            self.note(
                "info",
                &format!("{name} is on {body_name} (clocks to {:.1} ms)", sigma_s * 1e3),
                &format!("{name} を {body_name} に対応付けました (時刻の誤差 {:.1} ms)", sigma_s * 1e3),
            );
        }
        self.scene.changed = true;
    }

    /// Shows what is new, looks after what has vanished.
    pub fn tick(&mut self, now: Instant) {
        if self.fresh {
            self.give_out();
        }
        if now < self.due() {
            return;
        }
        self.shown_at = now;
        if self.optical.at.is_none_or(|at| now.saturating_duration_since(at) > NO_FRAMES) {
            self.release(now);
        }
        self.vanish(now);
        self.learn(now);
        self.look_after_recording();
        if self.scene.changed {
            self.scene.changed = false;
            let scene = self.scene.message().to_string();
            self.board.scene.send_replace(Arc::from(scene));
            for output in &mut self.outputs {
                output.scene(&self.scene);
            }
        }
        let time_s = now.saturating_duration_since(self.started).as_secs_f64();
        let frame = self.optical.number.map(|number| number as f64);
        let poses = self.scene.poses(time_s, frame, &self.optical.markers_m);
        self.board.poses.send_replace(Arc::from(poses));
        if self.status_at.is_none_or(|at| now.saturating_duration_since(at) >= STATUS) {
            self.status_at = Some(now);
            let status = self.status(now).to_string();
            self.board.status.send_replace(Arc::from(status));
        }
    }

    /// No frames come: samples do not wait for them.
    fn release(&mut self, now: Instant) {
        self.optical.markers_m.clear();
        let arrival = Arrival {
            input: 0,
            port: Arc::from(""),
            at: now,
            unix_ns: unix_ns(),
            what: What::State(State::Waiting),
        };
        for index in 0..self.nodes.len() {
            let mut moved = Vec::new();
            if let Some(merger) = &mut self.nodes[index].merger {
                merger.release(&mut moved);
            }
            self.moved(index, &moved, &arrival);
        }
    }

    fn vanish(&mut self, now: Instant) {
        for object in self.scene.objects_mut() {
            let Some(shown) = &mut object.shown else { continue };
            let age = now.saturating_duration_since(shown.at);
            if shown.source != Source::None && age > VANISHED {
                shown.source = Source::None;
                (shown.sigma_rad, shown.sigma_m) = (f64::NAN, f64::NAN);
            }
            if shown.source == Source::None {
                shown.gap_s = age.as_secs_f64();
            }
        }
        for input in &mut self.inputs {
            let silent = input.rate.silent_s(now).is_none_or(|s| s > SILENT.as_secs_f64());
            if silent && input.state == State::Connected && input.kind != Kind::NatNet {
                input.state = State::Waiting;
            }
        }
    }

    /// Tells clients something.
    pub(super) fn note(&mut self, level: &str, en: &str, ja: &str) {
        let note = json!({"type": "note", "level": level, "en": en, "ja": ja}).to_string();
        // without clients nobody hears it
        let _ = self.board.notes.send(Arc::from(note));
        if let Some(recorder) = &self.recorder {
            recorder.give(Record::Note(en.to_owned(), unix_ns()));
        }
    }

    fn command(&mut self, command: Command) {
        match command {
            Command::Record(on) => self.record(on),
            Command::Align(id) => {
                if let Some(node) = self.node_of(id) {
                    node.align();
                }
            }
            Command::Heading(id, yaw_rad) => {
                if let Some(node) = self.node_of(id) {
                    node.set_heading(yaw_rad);
                }
            }
            Command::Name(node, name) => {
                let Some(found) = self.nodes.iter_mut().find(|known| known.name == node) else { return };
                found.name.clone_from(&name);
                let (place, own) = (found.place, found.own_name.clone());
                if self.aliases.len() < NODES_MAX {
                    self.aliases.insert(own, name.clone());
                }
                self.renamed(place, &name);
            }
        }
    }

    fn node_of(&mut self, id: u32) -> Option<&mut Node> {
        match self.scene.key_of(id)? {
            Key::Node(index) => self.nodes.get_mut(index),
            Key::Body(_) => None,
        }
    }

    /// The end: recordings are closed.
    pub fn finish(&mut self) {
        self.record(false);
    }
}

fn default_name(key: BodyKey) -> String {
    match key {
        BodyKey::Rigid(id) => format!("body {id}"),
        BodyKey::Bone(skeleton, id) => format!("bone {skeleton}.{id}"),
    }
}
