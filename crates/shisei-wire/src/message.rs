//! Messages between receiver and PC. Byte 0 is the version, byte 1 the kind; the fields follow.

use crate::bytes::{Put, Take};
use crate::calibration::Calibration;
use crate::command;
pub use crate::command::Command;
use crate::gatt::NOTIFICATION_MAX;
use crate::packet::TEMPERATURE_UNKNOWN;
pub use crate::settings::{SETTINGS_BYTES, Settings};
use crate::{Error, Result, VERSION};

/// Longest message: data with the longest notification.
pub const MESSAGE_MAX: usize = 2 + DATA_FIELDS + NOTIFICATION_MAX;
const DATA_FIELDS: usize = 1 + 1 + 8 + 8 + 4;

/// Stands for the receiver itself, or for all nodes, where a node is asked for.
pub const NO_NODE: u8 = 255;

/// What receiver and PC say to each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Message<'a> {
    /// Kind 1, receiver → PC, at the start, once a second, and when asked.
    Hello(Hello),
    /// Kind 2, receiver → PC: a sync pulse.
    Pulse(Pulse),
    /// Kind 3, receiver → PC: a node's packet as it came.
    Data(Data<'a>),
    /// Kind 4, receiver → PC: something happened.
    Event(Event),
    /// Kind 5, receiver → PC: a node's name and state, when connected and every ten seconds.
    Node(Node<'a>),
    /// Kind 6, receiver → PC: the calibration that a node keeps: after kind 5, and when it changed.
    Calibration(NodeCalibration),
    /// Kinds 129 …, PC → receiver.
    Command(Command<'a>),
}

/// 18 bytes: boot u16, firmware version 3 × u8, flags u8 (bit 0: a gate edge was seen; bit 1: the gate is up), time
/// u64, dropped u32.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Hello {
    /// Random at every start of the receiver.
    pub boot: u16,
    /// Major, minor, patch.
    pub firmware: [u8; 3],
    /// A gate edge was seen: pulses count from it, else from the receiver's start.
    pub gate_seen: bool,
    /// The recording gate is up.
    pub gate_up: bool,
    /// Receiver µs.
    pub time_us: u64,
    /// Frames dropped so far because the PC read too slowly.
    pub dropped: u32,
}

/// 13 bytes: time u64, count u32, flags u8 (as in [`Hello`]).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Pulse {
    /// Receiver µs, captured by hardware.
    pub time_us: u64,
    /// 0 for the first pulse after the gate's rising edge, or after the receiver's start.
    pub count: u32,
    /// Counted from a gate edge.
    pub gate_seen: bool,
    /// The gate is up.
    pub gate_up: bool,
}

/// 22 bytes and the packet: node u8, flags u8 (bit 0: anchor valid; bit 1: pulse valid), arrival u64, anchor u64,
/// pulse u32, packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Data<'a> {
    /// The node's place in the receiver, from 0.
    pub node: u8,
    /// When the packet arrived, receiver µs.
    pub arrival_us: u64,
    /// The receiver's own time of the anchor that the packet names, µs.
    pub anchor_us: Option<u64>,
    /// The newest pulse when the packet arrived: advisory, the simple rule. Tagging happens on the PC.
    pub pulse: Option<u32>,
    /// The packet as it came.
    pub packet: &'a [u8],
}

/// What an event is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum EventCode {
    /// The receiver started; value: its boot id.
    Started = 1,
    /// The recording gate rose; pulses count from 0.
    GateUp = 2,
    /// The recording gate fell; value: pulses counted.
    GateDown = 3,
    /// A node is connected; value: its boot id is not known yet, 0.
    Connected = 4,
    /// A node is gone; value: the reason of the link layer.
    Disconnected = 5,
    /// A node started anew; value: the new boot id.
    Rebooted = 6,
    /// Samples are missing; value: how many.
    Lost = 7,
    /// A packet could not be read; value: its length.
    BadPacket = 8,
    /// Frames were dropped because the PC read too slowly; value: how many since the last such event.
    Dropped = 9,
    /// A seventh node wants in.
    Full = 10,
    /// A command could not be read or carried out; value: its kind.
    BadCommand = 11,
    /// No pulse for a second; value: the last count.
    PulsesStopped = 12,
}

impl EventCode {
    /// All, in the order of their codes from 1.
    pub const ALL: [EventCode; 12] = [
        EventCode::Started,
        EventCode::GateUp,
        EventCode::GateDown,
        EventCode::Connected,
        EventCode::Disconnected,
        EventCode::Rebooted,
        EventCode::Lost,
        EventCode::BadPacket,
        EventCode::Dropped,
        EventCode::Full,
        EventCode::BadCommand,
        EventCode::PulsesStopped,
    ];
}

/// 14 bytes: time u64, code u8, node u8, value u32.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Event {
    /// Receiver µs.
    pub time_us: u64,
    /// What happened.
    pub code: EventCode,
    /// Which node; [`NO_NODE`] for the receiver.
    pub node: u8,
    /// See [`EventCode`].
    pub value: u32,
}

/// 17 bytes and the name: node u8, flags u8 (bit 0: connected), address 6 × u8, boot u16, battery mV u16 (0: not
/// known), temperature 0.01 °C i16 (−32768: not known), firmware version 3 × u8, name in UTF-8, at most 20 bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Node<'a> {
    /// The node's place in the receiver, from 0.
    pub node: u8,
    /// It is connected.
    pub connected: bool,
    /// Bluetooth address, least significant byte first.
    pub address: [u8; 6],
    /// Its boot id.
    pub boot: u16,
    /// Battery voltage, mV; 0 where it is not known.
    pub battery_mv: u16,
    /// Temperature, 0.01 °C.
    pub temperature_centi_c: Option<i16>,
    /// Major, minor, patch.
    pub firmware: [u8; 3],
    /// Its name.
    pub name: &'a str,
}

/// 1 byte, then the calibration, or nothing where the node keeps none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NodeCalibration {
    /// The node's place in the receiver, from 0.
    pub node: u8,
    /// What it keeps.
    pub calibration: Option<Calibration>,
}

impl<'a> Message<'a> {
    /// Writes a message; returns its length. Refused: a buffer too short, a name, packet or batch too long.
    pub fn encode(&self, out: &mut [u8]) -> Result<usize> {
        let mut put = Put::new(out);
        put.u8(VERSION)?;
        match self {
            Message::Hello(hello) => {
                put.u8(1)?;
                put.u16(hello.boot)?;
                put.bytes(&hello.firmware)?;
                put.u8(two_bits(hello.gate_seen, hello.gate_up))?;
                put.u64(hello.time_us)?;
                put.u32(hello.dropped)?;
            }
            Message::Pulse(pulse) => {
                put.u8(2)?;
                put.u64(pulse.time_us)?;
                put.u32(pulse.count)?;
                put.u8(two_bits(pulse.gate_seen, pulse.gate_up))?;
            }
            Message::Data(data) => {
                if data.packet.len() > NOTIFICATION_MAX {
                    return Err(Error::TooLong);
                }
                put.u8(3)?;
                put.u8(data.node)?;
                put.u8(two_bits(data.anchor_us.is_some(), data.pulse.is_some()))?;
                put.u64(data.arrival_us)?;
                put.u64(data.anchor_us.unwrap_or(0))?;
                put.u32(data.pulse.unwrap_or(0))?;
                put.bytes(data.packet)?;
            }
            Message::Event(event) => {
                put.u8(4)?;
                put.u64(event.time_us)?;
                put.u8(event.code as u8)?;
                put.u8(event.node)?;
                put.u32(event.value)?;
            }
            Message::Node(node) => {
                put.u8(5)?;
                put.u8(node.node)?;
                put.u8(u8::from(node.connected))?;
                put.bytes(&node.address)?;
                put.u16(node.boot)?;
                put.u16(node.battery_mv)?;
                put.i16(node.temperature_centi_c.unwrap_or(TEMPERATURE_UNKNOWN))?;
                put.bytes(&node.firmware)?;
                command::put_name(&mut put, node.name)?;
            }
            Message::Calibration(kept) => {
                put.u8(6)?;
                put.u8(kept.node)?;
                command::put_calibration(&mut put, kept.calibration.as_ref())?;
            }
            Message::Command(command) => {
                put.u8(command.kind())?;
                command::put(&mut put, command)?;
            }
        }
        Ok(put.done())
    }

    /// Refused: another version, an unknown kind, another length, a field without meaning.
    pub fn decode(bytes: &'a [u8]) -> Result<Self> {
        let mut take = Take(bytes);
        let version = take.u8()?;
        if version != VERSION {
            return Err(Error::Version(version));
        }
        let message = match take.u8()? {
            1 => {
                let (boot, firmware) = (take.u16()?, [take.u8()?, take.u8()?, take.u8()?]);
                let (gate_seen, gate_up) = from_two_bits(take.u8()?);
                let (time_us, dropped) = (take.u64()?, take.u32()?);
                Message::Hello(Hello { boot, firmware, gate_seen, gate_up, time_us, dropped })
            }
            2 => {
                let (time_us, count) = (take.u64()?, take.u32()?);
                let (gate_seen, gate_up) = from_two_bits(take.u8()?);
                Message::Pulse(Pulse { time_us, count, gate_seen, gate_up })
            }
            3 => {
                let node = take.u8()?;
                let (has_anchor, has_pulse) = from_two_bits(take.u8()?);
                let (arrival_us, anchor, pulse) = (take.u64()?, take.u64()?, take.u32()?);
                let packet = core::mem::take(&mut take.0);
                if packet.len() > NOTIFICATION_MAX {
                    return Err(Error::TooLong);
                }
                let (anchor_us, pulse) = (has_anchor.then_some(anchor), has_pulse.then_some(pulse));
                Message::Data(Data { node, arrival_us, anchor_us, pulse, packet })
            }
            4 => {
                let (time_us, code, node, value) = (take.u64()?, take.u8()?, take.u8()?, take.u32()?);
                let place = usize::from(code).checked_sub(1).ok_or(Error::Value)?;
                let code = *EventCode::ALL.get(place).ok_or(Error::Value)?;
                Message::Event(Event { time_us, code, node, value })
            }
            5 => {
                let (node, flags, address, boot) = (take.u8()?, take.u8()?, take.six()?, take.u16()?);
                let (battery_mv, temperature) = (take.u16()?, take.i16()?);
                let firmware = [take.u8()?, take.u8()?, take.u8()?];
                Message::Node(Node {
                    node,
                    connected: flags & 1 == 1,
                    address,
                    boot,
                    battery_mv,
                    temperature_centi_c: (temperature != TEMPERATURE_UNKNOWN).then_some(temperature),
                    firmware,
                    name: command::take_name(&mut take)?,
                })
            }
            6 => {
                let node = take.u8()?;
                Message::Calibration(NodeCalibration {
                    node,
                    calibration: command::take_calibration(&mut take)?,
                })
            }
            kind => {
                let node = if command::FOR_NODES.contains(&kind) { take.u8()? } else { NO_NODE };
                Message::Command(command::take(kind, node, &mut take)?)
            }
        };
        take.end()?;
        Ok(message)
    }
}

fn two_bits(low: bool, high: bool) -> u8 {
    u8::from(low) | u8::from(high) << 1
}

fn from_two_bits(bits: u8) -> (bool, bool) {
    (bits & 1 == 1, bits & 2 == 2)
}
