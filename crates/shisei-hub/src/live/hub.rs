//! The hub: what comes from inputs becomes poses, in one thread, without waiting for anything.
//!
//! Here is what it consists of, and who hears what arrives: receivers' bytes go to `receivers`, the cameras' packets
//! to `cameras`, wishes to `command`. `pairing` brings sensors and bodies together, `showing` tells clients.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::{Duration, Instant};

use shisei_core::Vec3;
use shisei_wire::message::Command;

use super::board::Board;
use super::input::{Arrival, Kind, Outbox, State, ToHub, What};
use super::learn::{Learner, OpticalPast};
use super::meter::{Latency, Rate};
use super::mounting::Mounting;
use super::naming::Naming;
use super::node::Node;
use super::note::{Level, Note, Notes};
use super::output::Output;
use super::recorder::{Ending, Recorder};
use super::scene::Scene;
use super::settings::Settings;
use crate::natnet;
use crate::session::{Item, Session, command_bytes};

/// Poses go to clients so often at most.
pub const SHOW: Duration = Duration::from_millis(16);
/// Nodes and ports that are followed at most.
pub(super) const NODES_MAX: usize = 256;
const PORTS_MAX: usize = 64;

/// An input as the hub knows it.
#[derive(Debug)]
pub(super) struct InputState {
    pub name: String,
    pub kind: Kind,
    pub state: State,
    pub rate: Rate,
    pub lost: u64,
    pub bad: u64,
    /// What is to be written to its ports; none where nothing can be.
    pub outbox: Option<Outbox>,
}

impl InputState {
    /// Has the receiver at a port tell nodes' names and calibrations now, not within ten seconds.
    pub fn ask(&self, port: &Arc<str>) {
        if let (Some(outbox), Some(bytes)) = (&self.outbox, command_bytes(Command::Ask)) {
            outbox.push(port, bytes);
        }
    }
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
    /// When it first brought something.
    pub since: Instant,
    /// When its newest bytes came, ns since 1970: of a recording, when they were recorded.
    pub heard_ns: u64,
    /// That nothing of it can be read has been told.
    pub unreadable: bool,
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
    /// Recordings that are being written to their end.
    pub(super) ending: Vec<Ending>,
    /// Files that were not recorded to their end.
    pub(super) unrecorded: Vec<String>,
    pub(super) notes: Notes,
    pub(super) learner: Learner,
    pub(super) board: Arc<Board>,
    pub(super) aliases: BTreeMap<String, String>,
    /// Names that nodes were asked to take.
    pub(super) namings: Vec<Naming>,
    /// Mounting of bodies' sensors as it was given, by the body's name.
    pub(super) known: BTreeMap<String, Mounting>,
    pub(super) started: Instant,
    /// That pairs name what is not there has been told.
    pub(super) pairs_doubted: bool,
    pub(super) ended_inputs: usize,
    pub(super) shown_at: Instant,
    pub(super) status_at: Option<Instant>,
    pub(super) fresh: bool,
    pub(super) items: Vec<Item>,
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
            outbox: None,
        });
        Hub {
            inputs: inputs.collect(),
            ports: Vec::new(),
            nodes: Vec::new(),
            scene: Scene::default(),
            optical: Optical::default(),
            pulses: Rate::default(),
            latency: Latency::default(),
            outputs,
            recorder: None,
            ending: Vec::new(),
            unrecorded: Vec::new(),
            notes: Notes::default(),
            learner: Learner::default(),
            board,
            aliases: BTreeMap::new(),
            namings: Vec::new(),
            known: BTreeMap::new(),
            started: now,
            pairs_doubted: false,
            ended_inputs: 0,
            shown_at: now,
            status_at: None,
            fresh: false,
            items: Vec::new(),
            settings,
        }
    }

    /// How bodies' sensors sit on them, by the bodies' names.
    pub fn know(&mut self, mountings: BTreeMap<String, Mounting>) {
        self.known = mountings;
    }

    /// Where to put what an input is to write: receivers take commands, nothing else does.
    pub fn reach(&mut self, input: usize, outbox: Outbox) {
        let takes = |input: &&mut InputState| matches!(input.kind, Kind::Serial | Kind::Demo);
        if let Some(input) = self.inputs.get_mut(input).filter(takes) {
            input.outbox = Some(outbox);
        }
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
        if !matches!(arrival.what, What::State(_) | What::Note(_) | What::End)
            && input.state != State::Connected
        {
            input.state = State::Connected;
        }
        match &arrival.what {
            What::State(state) => self.input_state(arrival.input, *state),
            What::Note(note) => self.note(note.clone()),
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
            State::Lost => self.note(Note::new(
                Level::Warning,
                format!("{name} is gone; waiting for it"),
                format!("{name} との接続が切れました。復帰を待っています"),
            )),
            State::Connected => {
                self.note(Note::new(
                    Level::Info,
                    format!("{name} is connected"),
                    format!("{name} に接続しました"),
                ));
            }
            State::Waiting => {}
        }
    }

    /// The place of a port in the list; none where there are too many.
    pub(super) fn port(&mut self, arrival: &Arrival) -> Option<usize> {
        let found =
            self.ports.iter().position(|port| port.input == arrival.input && *port.name == *arrival.port);
        if found.is_none() && self.ports.len() < PORTS_MAX {
            if let Some(input) = self.inputs.get(arrival.input) {
                input.ask(&arrival.port);
            }
            self.ports.push(Port {
                input: arrival.input,
                name: Arc::clone(&arrival.port),
                session: None,
                stream: natnet::Stream::default(),
                words: [None, None],
                since: arrival.at,
                heard_ns: arrival.unix_ns,
                unreadable: false,
            });
            return Some(self.ports.len() - 1);
        }
        found
    }
}
