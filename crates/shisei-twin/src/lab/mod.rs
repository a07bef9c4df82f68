//! A laboratory without hardware: nodes that move, their radio links, camera pulses and the receiver, whose serial
//! port can be read.
//!
//! Node and receiver are those of `shisei_device`, the same code that runs on the boards; simulated is what surrounds
//! them: the sensor ([`crate::simulate()`]), clocks with offset and skew, connection events that are missed, outages,
//! restarts, camera pulses and the recording gate. True times are seconds from the laboratory's start; the same
//! settings give the same bytes.

mod clock;
mod link;
mod node;
mod truth;

pub use clock::Clock;
pub use truth::Boot;

use std::collections::VecDeque;

use shisei_device::receiver::{NODES_MAX, Receiver};
use shisei_wire::Calibration;
use shisei_wire::message::NO_NODE;

use crate::motion::Motion;
use crate::random::Random;
use crate::sensor::Sensor;
use crate::simulate::Errors;

use node::SimulatedNode;

/// Time between two looks at everything, s.
const STEP_S: f64 = 1e-3;
/// Bytes that wait for the PC.
const OUTBOX: usize = 8192;

/// The recording gate is down for so long before it rises again, s.
pub const GATE_DOWN_S: f64 = 1.0;

const STREAM_RECEIVER: u64 = 20;
const STREAM_NODES: u64 = 30;

/// A time in which a node is out of reach.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outage {
    /// Which node.
    pub node: usize,
    /// From, s.
    pub from_s: f64,
    /// To, s.
    pub to_s: f64,
}

/// What the nodes do, again and again.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Movement {
    /// Rest, free movement, rest: [`crate::movements::wander`].
    #[default]
    Free,
    /// Six faces and many poses: [`crate::movements::calibration_poses`]. The sensors are those of the same seed's free
    /// movement, their noise is another.
    Poses,
}

/// What the laboratory is like.
#[derive(Clone, Debug)]
pub struct Settings {
    /// How many nodes, 1 … 6.
    pub nodes: usize,
    /// The seed of all that is random.
    pub seed: u64,
    /// Camera frames a second, Hz.
    pub camera_hz: f64,
    /// When the recording gate rises, s; none: no gate, pulses count from the start.
    pub gate_s: Option<f64>,
    /// When it rises once more, for a second take, s: later than the first time by more than [`GATE_DOWN_S`], for which
    /// it is down before; none: it stays up.
    pub second_gate_s: Option<f64>,
    /// Share of connection events that are missed, 0 … 1.
    pub missed: f64,
    /// Standard deviation of anchor points on either side, µs.
    pub anchor_jitter_us: f64,
    /// Largest skew of a clock, ppm; node 0 has it in full, the others something between.
    pub skew_ppm: f64,
    /// Outages.
    pub outages: Vec<Outage>,
    /// Restarts: node and time, s.
    pub reboots: Vec<(usize, f64)>,
    /// The nodes' sensor.
    pub sensor: Sensor,
    /// Its errors.
    pub errors: Errors,
    /// What the nodes do.
    pub movement: Movement,
    /// How long a free movement is before it begins anew, s; of it the first and last 3 s are at rest.
    pub movement_s: f64,
    /// Calibrations that nodes keep from the start: which node, and what.
    pub calibrations: Vec<(usize, Calibration)>,
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            nodes: 2,
            seed: 1,
            camera_hz: 120.0,
            gate_s: None,
            second_gate_s: None,
            missed: 0.02,
            anchor_jitter_us: 1.0,
            skew_ppm: 40.0,
            outages: Vec::new(),
            reboots: Vec::new(),
            sensor: Sensor::lsm6ds3tr_c(),
            errors: Errors::Drawn,
            movement: Movement::Free,
            movement_s: 60.0,
            calibrations: Vec::new(),
        }
    }
}

/// The laboratory.
#[derive(Debug)]
pub struct Lab {
    settings: Settings,
    time_s: f64,
    receiver: Receiver<OUTBOX>,
    receiver_clock: Clock,
    pulses: u32,
    /// Changes of the recording gate to come: when, s, and whether it rises.
    gates: VecDeque<(f64, bool)>,
    nodes: Vec<SimulatedNode>,
    /// Which node is at which place of the receiver.
    places: [Option<usize>; NODES_MAX],
}

impl Lab {
    /// At time 0: everything is switched on. More than six nodes are six.
    pub fn new(settings: Settings) -> Self {
        let mut random = Random::new(settings.seed, STREAM_RECEIVER);
        let receiver_clock = Clock {
            started_s: 0.0,
            offset_us: random.between(1e3, 1e6),
            skew: random.between(-1.0, 1.0) * 1e-6 * settings.skew_ppm,
        };
        let boot = random.between(1.0, 65_535.0) as u16;
        let count = settings.nodes.clamp(1, NODES_MAX);
        let nodes = (0..count)
            .map(|index| {
                SimulatedNode::new(index, &settings, Random::new(settings.seed, STREAM_NODES + index as u64))
            })
            .collect();
        let first = settings.gate_s.map(|gate_s| (gate_s, true));
        let second = settings.second_gate_s.map(|gate_s| [(gate_s - GATE_DOWN_S, false), (gate_s, true)]);
        Lab {
            time_s: 0.0,
            receiver: Receiver::new(boot, receiver_clock.us(0.0)),
            receiver_clock,
            pulses: 0,
            gates: first.into_iter().chain(second.into_iter().flatten()).collect(),
            nodes,
            places: [None; NODES_MAX],
            settings,
        }
    }

    /// The true time, s.
    pub fn time_s(&self) -> f64 {
        self.time_s
    }

    /// Lets time pass.
    pub fn run_to(&mut self, time_s: f64) {
        while self.time_s + STEP_S <= time_s {
            self.step();
        }
    }

    fn step(&mut self) {
        self.time_s += STEP_S;
        let now_s = self.time_s;
        let now_us = self.receiver_clock.us(now_s);
        while let Some((gate_s, up)) = self.gates.front().copied().filter(|(gate_s, _)| now_s >= *gate_s) {
            self.gates.pop_front();
            let before = math_ceil(gate_s * self.settings.camera_hz);
            self.pulses_before(f64::from(before) / self.settings.camera_hz);
            self.receiver.gate(up, self.receiver_clock.us(gate_s), self.pulses);
        }
        self.pulses_before(now_s);
        for node in &mut self.nodes {
            node.step(now_s, &self.settings);
        }
        for index in 0..self.nodes.len() {
            self.link(index, now_s);
        }
        self.receiver.tick(now_us);
    }

    /// All pulses before a time.
    fn pulses_before(&mut self, time_s: f64) {
        while self.pulse_s(self.pulses) < time_s {
            let time_us = self.receiver_clock.us(self.pulse_s(self.pulses));
            self.pulses += 1;
            self.receiver.pulse(time_us, self.pulses);
        }
    }

    fn pulse_s(&self, raw: u32) -> f64 {
        f64::from(raw) / self.settings.camera_hz
    }

    /// Moves what waits at the receiver's serial port to the end of `out`.
    pub fn serial(&mut self, out: &mut Vec<u8>) {
        let length = out.len();
        let waiting = self.receiver.outbox.len();
        out.resize(length + waiting, 0);
        let count = self.receiver.outbox.take(&mut out[length..]);
        out.truncate(length + count);
    }

    /// Bytes from the PC.
    pub fn command(&mut self, bytes: &[u8]) {
        let now_us = self.receiver_clock.us(self.time_s);
        for byte in bytes {
            let Some(to_node) = self.receiver.byte(*byte, now_us) else { continue };
            for (place, index) in self.places.iter().enumerate() {
                let meant = to_node.node == NO_NODE || usize::from(to_node.node) == place;
                if let (true, Some(index)) = (meant, *index) {
                    self.nodes[index].board.commands.push_back(to_node.bytes().to_vec());
                }
            }
        }
    }

    /// Which node is at a place of the receiver.
    pub fn node_at(&self, place: u8) -> Option<usize> {
        self.places.get(usize::from(place)).copied().flatten()
    }

    /// True time of a node's 32-bit stamp, s: the one nearest to `near_s`. None for a boot id that it never had.
    pub fn true_time_s(&self, node: usize, boot: u16, stamp_us: u32, near_s: f64) -> Option<f64> {
        self.nodes.get(node)?.boots.iter().find(|b| b.id == boot).map(|b| b.true_time_s(stamp_us, near_s))
    }

    /// The true frame index of a true time, counted from the gate where there is one: from the second from when that
    /// rises.
    pub fn true_frame(&self, time_s: f64) -> f64 {
        let second = self.settings.second_gate_s.filter(|gate_s| time_s >= *gate_s);
        let gate_s = second.or(self.settings.gate_s);
        let first = gate_s.map_or(0, |gate_s| math_ceil(gate_s * self.settings.camera_hz));
        time_s * self.settings.camera_hz - f64::from(first)
    }

    /// A node's starts.
    pub fn boots(&self, node: usize) -> &[Boot] {
        self.nodes.get(node).map_or(&[], |node| &node.boots)
    }

    /// A node's true attitude.
    pub fn attitude(&self, node: usize, time_s: f64) -> Option<shisei_core::Quaternion> {
        let node = self.nodes.get(node)?;
        Some(node.motion.state(node.movement_time_s(time_s)).world_from_body)
    }

    /// A node's true attitude and position.
    pub fn state(&self, node: usize, time_s: f64) -> Option<crate::motion::State> {
        let node = self.nodes.get(node)?;
        Some(node.motion.state(node.movement_time_s(time_s)))
    }

    /// A node's light is on.
    pub fn light(&self, node: usize) -> bool {
        self.nodes.get(node).is_some_and(|node| node.board.light)
    }

    /// The calibration that a node keeps.
    pub fn calibration(&self, node: usize) -> Option<&Calibration> {
        self.nodes.get(node).and_then(|node| node.device.calibration())
    }

    /// A node's name.
    pub fn name(&self, node: usize) -> &str {
        self.nodes.get(node).map_or("", |node| node.device.name())
    }
}

fn math_ceil(x: f64) -> u32 {
    // A gate right on a pulse counts it.
    -shisei_core::math::floor(1e-6 - x) as u32
}
