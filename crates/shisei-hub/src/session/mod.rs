//! A receiver's bytes, followed.
//!
//! Samples wait until the pulse after them has come, then they leave with their frame index, in the order of each
//! node. The same bytes give the same items, so a recording of the bytes can be processed anew.

mod track;

use shisei_core::clock::{Pulse, PulseTrain};
use shisei_core::{Quaternion, Vec3};
use shisei_wire::frame::FRAME_MAX;
use shisei_wire::message::{Command, Event, EventCode, Hello, MESSAGE_MAX, Node};
use shisei_wire::packet::{FilterKind, Start};
use shisei_wire::{Calibration, Deframer, Message, Packet, encode_frame};

pub use track::Quality;
use track::Track;

/// Places in a receiver that are followed; a byte can say more, but no receiver has more.
pub const PLACES: usize = 16;
/// Pulses that are remembered: 8 s at 1000 Hz, half a minute and more at 240 Hz.
const PULSES: usize = 8192;

/// One sample of one node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// The node's place in the receiver.
    pub node: u8,
    /// Random at every start of the node.
    pub boot: u16,
    /// Sequence number since the session knows this start; a step of more than 1 is a loss.
    pub sequence: i64,
    /// As sent: 16 bits.
    pub raw_sequence: u16,
    /// The node's 32-bit stamp, µs.
    pub stamp_us: u32,
    /// By the receiver's clock, s; none without a pair of the clocks.
    pub time_s: Option<f64>,
    /// Camera frame, a real number; none outside the pulses.
    pub frame: Option<f64>,
    /// The frames count from the recording gate.
    pub from_gate: bool,
    /// The newest pulse when the packet arrived: the simple rule, for comparison.
    pub arrival_frame: Option<u32>,
    /// Rate before bias removal, rad/s, body.
    pub gyro_rad_s: Vec3,
    /// Specific force, m/s², body.
    pub acc_m_s2: Vec3,
    /// The node's own attitude.
    pub world_from_body: Quaternion,
    /// Temperature, °C.
    pub temperature_c: Option<f64>,
    /// Sampled before the present connection was there.
    pub late: bool,
    /// A sensor reading was missed in it.
    pub reading_missed: bool,
    /// How the node's start went.
    pub start: Start,
    /// What made the attitude.
    pub filter: FilterKind,
    /// The attitude is of readings corrected by a calibration that the node keeps; rate and force never are.
    pub calibrated: bool,
}

/// A node's name and state.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NodeInfo {
    /// Its place in the receiver.
    pub node: u8,
    /// It is connected.
    pub connected: bool,
    /// Bluetooth address, as it is written.
    pub address: String,
    /// Its name, without control characters.
    pub name: String,
    /// Voltage of the battery, mV; 0: not known.
    pub battery_mv: u16,
    /// Temperature, 0.01 °C.
    pub temperature_centi_c: Option<i16>,
    /// Version of its logic.
    pub firmware: [u8; 3],
}

/// What a session tells.
#[derive(Clone, Debug, PartialEq)]
pub enum Item {
    /// A sample.
    Sample(Sample),
    /// The receiver says something happened.
    Event(Event),
    /// Samples of a node are missing, as seen here: node, how many.
    Lost(u8, u64),
    /// A node started anew, as seen here: node, its new boot id.
    Rebooted(u8, u16),
    /// The receiver itself started anew: its new boot id.
    ReceiverRebooted(u16),
    /// Pulses are counted anew, from the recording gate: frames before and after have nothing to do with each other.
    CountedAnew,
    /// A node's name and state.
    Node(NodeInfo),
    /// The calibration that a node keeps: node, and what; none where it keeps none.
    Calibration(u8, Option<Calibration>),
    /// The receiver's word.
    Hello(Hello),
    /// An unreadable frame.
    Garbage,
}

/// Counts over a session.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Frames read.
    pub frames: u64,
    /// Frames that could not be read.
    pub garbage: u64,
    /// Pulses.
    pub pulses: u64,
    /// Samples.
    pub samples: u64,
    /// Samples lost.
    pub lost: u64,
}

/// A command as it goes over the line to a receiver; none where a name in it is too long.
pub fn command_bytes(command: Command<'_>) -> Option<Vec<u8>> {
    let (mut bytes, mut frame) = ([0; MESSAGE_MAX], [0; FRAME_MAX]);
    let length = Message::Command(command).encode(&mut bytes).ok()?;
    let length = encode_frame(bytes.get(..length)?, &mut frame).ok()?;
    frame.get(..length).map(<[u8]>::to_vec)
}

/// A receiver's bytes, followed.
#[derive(Debug)]
pub struct Session {
    deframer: Deframer,
    pulses: Box<PulseTrain<PULSES>>,
    from_gate: bool,
    tracks: Vec<Option<Box<Track>>>,
    receiver_boot: Option<u16>,
    newest_us: u64,
    counts: Counts,
}

impl Default for Session {
    fn default() -> Self {
        Session {
            deframer: Deframer::default(),
            pulses: Box::default(),
            from_gate: false,
            tracks: (0..PLACES).map(|_| None).collect(),
            receiver_boot: None,
            newest_us: 0,
            counts: Counts::default(),
        }
    }
}

impl Session {
    /// Takes bytes of the line and adds what they tell.
    pub fn push(&mut self, bytes: &[u8], items: &mut Vec<Item>) {
        let mut deframer = std::mem::take(&mut self.deframer);
        for &byte in bytes {
            let Some(frame) = deframer.push(byte) else { continue };
            if let Ok(message) = frame.and_then(Message::decode) {
                self.counts.frames += 1;
                self.message(&message, items);
            } else {
                self.counts.garbage += 1;
                items.push(Item::Garbage);
            }
        }
        self.deframer = deframer;
    }

    /// The end: what waits is told as it is.
    pub fn finish(&mut self, items: &mut Vec<Item>) {
        self.release(items, true);
    }

    /// Counts so far.
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// A node's link and clock now; none where none was heard of.
    pub fn quality(&self, node: u8) -> Option<Quality> {
        self.tracks.get(usize::from(node))?.as_ref().map(|track| track.quality(self.newest_us))
    }

    /// Places with a node.
    pub fn nodes(&self) -> impl Iterator<Item = u8> + '_ {
        (0_u8..).zip(&self.tracks).filter(|(_, track)| track.is_some()).map(|(place, _)| place)
    }

    /// The newest pulse's count, and whether it counts from the gate.
    pub fn newest_pulse(&self) -> Option<(u32, bool)> {
        self.pulses.newest().map(|pulse| (pulse.count, self.from_gate))
    }

    /// The receiver's newest time, s.
    pub fn time_s(&self) -> f64 {
        self.newest_us as f64 * 1e-6
    }

    fn message(&mut self, message: &Message<'_>, items: &mut Vec<Item>) {
        match *message {
            Message::Hello(hello) => {
                self.receiver(hello.boot, items);
                self.newest_us = self.newest_us.max(hello.time_us);
                items.push(Item::Hello(hello));
            }
            Message::Pulse(pulse) => {
                let time_s = pulse.time_us as f64 * 1e-6;
                // the gate's own message may have been lost on the line
                let smaller = self.pulses.newest().is_some_and(|newest| pulse.count < newest.count);
                if smaller || (pulse.gate_seen && !self.from_gate) {
                    self.count_anew(items);
                }
                self.from_gate = pulse.gate_seen;
                self.counts.pulses += 1;
                self.newest_us = self.newest_us.max(pulse.time_us);
                self.pulses.push(Pulse { time_s, count: pulse.count });
            }
            Message::Data(data) => {
                let Ok(packet) = Packet::decode(data.packet) else {
                    self.counts.garbage += 1;
                    items.push(Item::Garbage);
                    return;
                };
                self.newest_us = self.newest_us.max(data.arrival_us);
                self.data(&data, &packet, items);
            }
            Message::Event(event) => {
                match event.code {
                    EventCode::Started => self.receiver(event.value as u16, items),
                    EventCode::GateUp => self.count_anew(items),
                    _ => {}
                }
                self.newest_us = self.newest_us.max(event.time_us);
                items.push(Item::Event(event));
            }
            Message::Node(node) => items.push(Item::Node(info(&node))),
            Message::Calibration(kept) => items.push(Item::Calibration(kept.node, kept.calibration)),
            // What a PC says is not for a PC.
            Message::Command(_) => {}
        }
        self.release(items, false);
    }

    /// The receiver counts pulses anew. What waits belongs to the old count and is after its last pulse.
    fn count_anew(&mut self, items: &mut Vec<Item>) {
        if self.pulses.newest().is_some() {
            self.release(items, true);
            self.pulses.clear();
            items.push(Item::CountedAnew);
        }
    }

    fn receiver(&mut self, boot: u16, items: &mut Vec<Item>) {
        if self.receiver_boot.replace(boot).is_some_and(|before| before != boot) {
            self.release(items, true);
            self.pulses.clear();
            self.tracks.iter_mut().for_each(|track| *track = None);
            self.newest_us = 0;
            items.push(Item::ReceiverRebooted(boot));
        }
    }

    fn data(&mut self, data: &shisei_wire::message::Data<'_>, packet: &Packet<'_>, items: &mut Vec<Item>) {
        let Some(place) = self.tracks.get_mut(usize::from(data.node)) else {
            self.counts.garbage += 1;
            items.push(Item::Garbage);
            return;
        };
        if let Some(track) = place
            && track.boot() != packet.header.boot
        {
            track.release(&self.pulses, self.from_gate, self.newest_us, true, |sample| {
                self.counts.samples += 1;
                items.push(Item::Sample(sample));
            });
            *place = None;
            items.push(Item::Rebooted(data.node, packet.header.boot));
        }
        let track = place.get_or_insert_with(|| Box::new(Track::new(data.node, packet, data.arrival_us)));
        let lost = track.push(data, packet);
        if lost > 0 {
            self.counts.lost += lost;
            items.push(Item::Lost(data.node, lost));
        }
    }

    fn release(&mut self, items: &mut Vec<Item>, all: bool) {
        for track in self.tracks.iter_mut().flatten() {
            track.release(&self.pulses, self.from_gate, self.newest_us, all, |sample| {
                self.counts.samples += 1;
                items.push(Item::Sample(sample));
            });
        }
    }
}

fn info(node: &Node<'_>) -> NodeInfo {
    let address: Vec<String> = node.address.iter().rev().map(|byte| format!("{byte:02X}")).collect();
    NodeInfo {
        node: node.node,
        connected: node.connected,
        address: address.join(":"),
        // whoever is near can call a node anything
        name: node.name.chars().filter(|c| !c.is_control()).collect(),
        battery_mv: node.battery_mv,
        temperature_centi_c: node.temperature_centi_c,
        firmware: node.firmware,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_cannot_steer_a_terminal() {
        let node = Node {
            node: 0,
            connected: true,
            address: [0; 6],
            boot: 0,
            battery_mv: 0,
            temperature_centi_c: None,
            firmware: [0; 3],
            name: "左\u{1b}[31m\u{9b}手\r\n",
        };
        assert_eq!(info(&node).name, "左[31m手");
    }
}
