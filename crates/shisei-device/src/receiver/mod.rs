//! The receiver: links, pulses and the gate in, serial frames out.

mod outbox;
mod slot;

pub use outbox::Outbox;

use shisei_wire::gatt::COMMAND_MAX;
use shisei_wire::message::{self, Command, Data, Event, EventCode, Hello, MESSAGE_MAX, NO_NODE};
use shisei_wire::{Calibration, Deframer, Message, Packet};

use slot::{Continuity, Slot};

/// Nodes at once.
pub const NODES_MAX: usize = 6;
/// Time from hello to hello, µs.
const HELLO_US: u64 = 1_000_000;
/// Time from one word on the nodes to the next, in hellos.
const NODES_EVERY: u32 = 10;
/// What there is to be told of the nodes: two parts a place.
const PARTS: usize = 2 * NODES_MAX;
/// Room for the longest of these parts, bytes; less than a packet of four samples takes, so that those do not take it all.
const ROOM_TO_TELL: usize = 128;
/// So long without a pulse, and they have stopped, µs.
const PULSES_STOPPED_US: u64 = 1_000_000;
/// A seventh node is told no oftener than this, µs.
const FULL_US: u64 = 10_000_000;

/// A command on its way to a node: what is written to [`shisei_wire::gatt::CONTROL`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ToNode {
    /// Which place; [`NO_NODE`]: all that are connected.
    pub node: u8,
    bytes: [u8; COMMAND_MAX],
    length: usize,
}

impl ToNode {
    /// Kind and fields.
    pub fn bytes(&self) -> &[u8] {
        self.bytes.get(..self.length).unwrap_or_default()
    }
}

/// A receiver; `OUT` bytes wait for the PC at most (4096 are half a second of six nodes).
#[derive(Clone, Debug)]
pub struct Receiver<const OUT: usize> {
    boot: u16,
    slots: [Slot; NODES_MAX],
    /// Frames for the PC: the board takes bytes out of it.
    pub outbox: Outbox<OUT>,
    deframer: Deframer,
    /// What the hardware had counted when counting from 0 began.
    base: u32,
    gate_seen: bool,
    gate_up: bool,
    newest_pulse: Option<(u64, u32)>,
    pulses_stopped: bool,
    next_hello_us: u64,
    hellos: u32,
    /// Hello is to be said.
    hello_due: bool,
    /// The next part of what there is to be told of the nodes, two a place: the node, and what it keeps.
    next_part: usize,
    full_told_us: Option<u64>,
}

impl<const OUT: usize> Receiver<OUT> {
    /// A receiver that just started. `boot` is random.
    pub fn new(boot: u16, now_us: u64) -> Self {
        let mut receiver = Receiver {
            boot,
            slots: [Slot::default(); NODES_MAX],
            outbox: Outbox::default(),
            deframer: Deframer::default(),
            base: 0,
            gate_seen: false,
            gate_up: false,
            newest_pulse: None,
            pulses_stopped: false,
            next_hello_us: now_us,
            hellos: 0,
            hello_due: false,
            next_part: PARTS,
            full_told_us: None,
        };
        receiver.event(now_us, EventCode::Started, NO_NODE, u32::from(boot));
        receiver
    }

    /// To be called every few milliseconds: hello, nodes, drops that were not told, pulses that stopped.
    pub fn tick(&mut self, now_us: u64) {
        if let Some(untold) = self.outbox.untold()
            && self.event(now_us, EventCode::Dropped, NO_NODE, untold)
        {
            self.outbox.tell();
        }
        if let Some((time_us, count)) = self.newest_pulse
            && !self.pulses_stopped
            && now_us.saturating_sub(time_us) > PULSES_STOPPED_US
        {
            self.pulses_stopped = true;
            self.event(now_us, EventCode::PulsesStopped, NO_NODE, count);
        }
        if now_us >= self.next_hello_us {
            self.next_hello_us = now_us + HELLO_US;
            self.hello_due = true;
            if self.hellos.is_multiple_of(NODES_EVERY) {
                self.next_part = 0;
            }
            self.hellos = self.hellos.wrapping_add(1);
        }
        self.tell_what_is_due(now_us);
    }

    /// Hello and nodes wait until there is room: a PC that opens the port asks while the outbox is still full of what
    /// came before.
    fn tell_what_is_due(&mut self, now_us: u64) {
        while self.outbox.room() >= ROOM_TO_TELL && (self.hello_due || self.next_part < PARTS) {
            if core::mem::take(&mut self.hello_due) {
                self.hello(now_us);
                continue;
            }
            let (place, kept) = (self.next_part / 2, !self.next_part.is_multiple_of(2));
            self.next_part += 1;
            if kept {
                self.tell_kept(place);
            } else {
                self.tell_node(place);
            }
        }
    }

    fn hello(&mut self, now_us: u64) {
        self.outbox.push(&Message::Hello(Hello {
            boot: self.boot,
            firmware: crate::FIRMWARE,
            gate_seen: self.gate_seen,
            gate_up: self.gate_up,
            time_us: now_us,
            dropped: self.outbox.dropped(),
        }));
    }

    fn tell_node(&mut self, place: usize) {
        let Some(slot) = self.slots.get(place) else { return };
        let Some(address) = slot.address else { return };
        self.outbox.push(&Message::Node(message::Node {
            node: place as u8,
            connected: slot.connected,
            address,
            boot: slot.boot.unwrap_or(0),
            battery_mv: slot.battery_mv,
            temperature_centi_c: slot.temperature_centi_c,
            firmware: slot.firmware,
            name: slot.name(),
        }));
    }

    fn tell_kept(&mut self, place: usize) {
        let Some(slot) = self.slots.get(place).filter(|slot| slot.address.is_some()) else { return };
        let kept = message::NodeCalibration { node: place as u8, calibration: slot.calibration };
        self.outbox.push(&Message::Calibration(kept));
    }

    fn event(&mut self, time_us: u64, code: EventCode, node: u8, value: u32) -> bool {
        self.outbox.push(&Message::Event(Event { time_us, code, node, value }))
    }

    /// A sync pulse; `raw_count` is the hardware's counter after it.
    pub fn pulse(&mut self, time_us: u64, raw_count: u32) {
        let count = raw_count.wrapping_sub(self.base).wrapping_sub(1);
        self.newest_pulse = Some((time_us, count));
        self.pulses_stopped = false;
        let (gate_seen, gate_up) = (self.gate_seen, self.gate_up);
        self.outbox.push(&Message::Pulse(message::Pulse { time_us, count, gate_seen, gate_up }));
    }

    /// The recording gate rose or fell; `raw_count` is the hardware's counter at that moment.
    pub fn gate(&mut self, up: bool, time_us: u64, raw_count: u32) {
        if up == self.gate_up {
            return;
        }
        self.gate_up = up;
        if up {
            self.gate_seen = true;
            self.base = raw_count;
            self.newest_pulse = None;
            self.event(time_us, EventCode::GateUp, NO_NODE, 0);
        } else {
            self.event(time_us, EventCode::GateDown, NO_NODE, raw_count.wrapping_sub(self.base));
        }
    }

    /// A node's advertisement with our service was heard: the place to connect it to, if any. A node that was here
    /// before gets its old place.
    pub fn advertised(&mut self, address: [u8; 6], now_us: u64) -> Option<usize> {
        let known = self.slots.iter().position(|slot| slot.address == Some(address));
        let free = || self.slots.iter().position(|slot| slot.address.is_none());
        let gone = || self.slots.iter().position(|slot| !slot.connected);
        let Some(place) = known.or_else(free).or_else(gone) else {
            if self.full_told_us.is_none_or(|told_us| now_us.saturating_sub(told_us) >= FULL_US) {
                self.full_told_us = Some(now_us);
                self.event(now_us, EventCode::Full, NO_NODE, 0);
            }
            return None;
        };
        let slot = self.slots.get_mut(place)?;
        if slot.connected {
            return None;
        }
        if known.is_none() {
            *slot = Slot::default();
            slot.address = Some(address);
        }
        Some(place)
    }

    /// A node is connected and its packets are subscribed to. `status` is what [`shisei_wire::gatt::STATUS`] reads.
    pub fn connected(&mut self, place: usize, name: &str, status: &[u8], now_us: u64) {
        let Some(slot) = self.slots.get_mut(place) else { return };
        slot.connected = true;
        slot.forget_anchors();
        slot.set_name(name);
        slot.set_status(status);
        self.event(now_us, EventCode::Connected, place as u8, 0);
        self.tell_node(place);
        self.tell_kept(place);
    }

    /// A node's state was read anew.
    pub fn status(&mut self, place: usize, status: &[u8]) {
        if let Some(slot) = self.slots.get_mut(place) {
            slot.set_status(status);
        }
    }

    /// What a node's [`shisei_wire::gatt::CALIBRATION`] reads; empty, or unreadable, where it keeps none. Told where it
    /// is another than before.
    pub fn calibration(&mut self, place: usize, bytes: &[u8]) {
        let calibration = Calibration::decode(bytes).ok();
        let Some(slot) = self.slots.get_mut(place) else { return };
        if core::mem::replace(&mut slot.calibration, calibration) != calibration {
            let kept = message::NodeCalibration { node: place as u8, calibration };
            self.outbox.push(&Message::Calibration(kept));
        }
    }

    /// A link is gone, and why (the link layer's reason).
    pub fn disconnected(&mut self, place: usize, reason: u8, now_us: u64) {
        if let Some(slot) = self.slots.get_mut(place) {
            slot.connected = false;
        }
        self.event(now_us, EventCode::Disconnected, place as u8, u32::from(reason));
    }

    /// An anchor point of a link, by this side's clock.
    pub fn anchor(&mut self, place: usize, event: u16, time_us: u64) {
        if let Some(slot) = self.slots.get_mut(place) {
            slot.anchor(event, time_us);
        }
    }

    /// A node's notification: passed on as it is, with what this side knows.
    pub fn notification(&mut self, place: usize, bytes: &[u8], now_us: u64) {
        let Some(slot) = self.slots.get_mut(place) else { return };
        let node = place as u8;
        let Ok(packet) = Packet::decode(bytes) else {
            self.event(now_us, EventCode::BadPacket, node, bytes.len() as u32);
            return;
        };
        let continuity = slot.follow(&packet.header, packet.count());
        let anchor_us = packet.header.anchor.and_then(|anchor| slot.find_anchor(anchor.event));
        match continuity {
            Continuity::Fine => {}
            Continuity::Lost(count) => {
                self.event(now_us, EventCode::Lost, node, count);
            }
            Continuity::Rebooted => {
                self.event(now_us, EventCode::Rebooted, node, u32::from(packet.header.boot));
            }
        }
        let pulse = self.newest_pulse.map(|(_, count)| count);
        self.outbox.push(&Message::Data(Data { node, arrival_us: now_us, anchor_us, pulse, packet: bytes }));
    }

    /// A byte from the PC; a command for a node is returned.
    pub fn byte(&mut self, byte: u8, now_us: u64) -> Option<ToNode> {
        let mut copy = [0; MESSAGE_MAX];
        let message = self.deframer.push(byte)?.and_then(|bytes| {
            let place = copy.get_mut(..bytes.len()).ok_or(shisei_wire::Error::TooLong)?;
            place.copy_from_slice(bytes);
            Ok(&*place)
        });
        let (kind, to_node) = match message {
            Ok(bytes) => (bytes.get(1).copied().unwrap_or(0), read_command(bytes)),
            Err(_) => (0, None),
        };
        match to_node {
            None => {
                self.event(now_us, EventCode::BadCommand, NO_NODE, u32::from(kind));
                None
            }
            Some(Asked::Hello) => {
                (self.hello_due, self.next_part) = (true, 0);
                self.tell_what_is_due(now_us);
                None
            }
            Some(Asked::Node(command)) => {
                let known = command.node == NO_NODE
                    || self.slots.get(usize::from(command.node)).is_some_and(|slot| slot.connected);
                if known {
                    if let Ok(Message::Command(Command::Rename(node, name))) =
                        message.and_then(Message::decode)
                        && let Some(slot) = self.slots.get_mut(usize::from(node))
                    {
                        slot.set_name(name);
                    }
                    return Some(command);
                }
                self.event(now_us, EventCode::BadCommand, command.node, u32::from(kind));
                None
            }
        }
    }

    /// A command did not find its way to a node, or the node refused it; `kind` is that of [`Command`].
    pub fn not_carried_out(&mut self, node: u8, kind: u8, now_us: u64) {
        self.event(now_us, EventCode::BadCommand, node, u32::from(kind));
    }

    /// Addresses of connected nodes by place, for boards that scan.
    pub fn is_connected(&self, place: usize) -> bool {
        self.slots.get(place).is_some_and(|slot| slot.connected)
    }
}

enum Asked {
    Hello,
    Node(ToNode),
}

fn read_command(message: &[u8]) -> Option<Asked> {
    let Ok(Message::Command(command)) = Message::decode(message) else { return None };
    if command == Command::Ask {
        return Some(Asked::Hello);
    }
    // version, kind, node, fields → kind, fields
    let mut to_node = ToNode { node: command.node(), bytes: [0; COMMAND_MAX], length: message.len() - 2 };
    let content = message.get(1..2)?.iter().chain(message.get(3..)?);
    for (place, byte) in to_node.bytes.iter_mut().zip(content) {
        *place = *byte;
    }
    (to_node.length <= to_node.bytes.len()).then_some(Asked::Node(to_node))
}
