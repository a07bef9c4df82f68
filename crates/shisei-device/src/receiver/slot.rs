//! What the receiver knows of one node.

use shisei_wire::Calibration;
use shisei_wire::gatt::NAME_MAX;
use shisei_wire::packet::Header;

/// Anchor points that are remembered: almost a second at 15 ms.
const ANCHORS: usize = 64;

#[derive(Clone, Copy, Debug, Default)]
struct Anchor {
    event: u16,
    time_us: u64,
}

/// What a packet says about those before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Continuity {
    /// The first of this node, or right after the one before.
    Fine,
    /// So many samples are missing.
    Lost(u32),
    /// The node started anew.
    Rebooted,
}

/// A node's place.
#[derive(Clone, Copy, Debug)]
pub struct Slot {
    pub address: Option<[u8; 6]>,
    pub connected: bool,
    pub boot: Option<u16>,
    pub battery_mv: u16,
    pub temperature_centi_c: Option<i16>,
    pub firmware: [u8; 3],
    pub calibration: Option<Calibration>,
    name: [u8; NAME_MAX],
    name_length: usize,
    next_sequence: u16,
    anchors: [Anchor; ANCHORS],
    newest: usize,
    known: usize,
}

impl Default for Slot {
    fn default() -> Self {
        Slot {
            address: None,
            connected: false,
            boot: None,
            battery_mv: 0,
            temperature_centi_c: None,
            firmware: [0; 3],
            calibration: None,
            name: [0; NAME_MAX],
            name_length: 0,
            next_sequence: 0,
            anchors: [Anchor { event: 0, time_us: 0 }; ANCHORS],
            newest: 0,
            known: 0,
        }
    }
}

impl Slot {
    pub fn set_name(&mut self, name: &str) {
        if let Some(place) = self.name.get_mut(..name.len()) {
            place.copy_from_slice(name.as_bytes());
            self.name_length = name.len();
        }
    }

    pub fn name(&self) -> &str {
        self.name.get(..self.name_length).and_then(|bytes| core::str::from_utf8(bytes).ok()).unwrap_or("")
    }

    /// Takes over what [`shisei_wire::gatt::STATUS`] read; less than its fixed bytes is nothing.
    pub fn set_status(&mut self, status: &[u8]) {
        if let [b0, b1, t0, t1, major, minor, patch, ..] = *status {
            self.battery_mv = u16::from_le_bytes([b0, b1]);
            let temperature = i16::from_le_bytes([t0, t1]);
            self.temperature_centi_c = (temperature != i16::MIN).then_some(temperature);
            self.firmware = [major, minor, patch];
        }
    }

    /// A new connection counts its events anew.
    pub fn forget_anchors(&mut self) {
        self.known = 0;
    }

    pub fn anchor(&mut self, event: u16, time_us: u64) {
        self.newest = (self.newest + 1) % ANCHORS;
        if let Some(place) = self.anchors.get_mut(self.newest) {
            *place = Anchor { event, time_us };
        }
        self.known = (self.known + 1).min(ANCHORS);
    }

    pub fn find_anchor(&self, event: u16) -> Option<u64> {
        (0..self.known)
            .filter_map(|back| self.anchors.get((self.newest + ANCHORS - back) % ANCHORS))
            .find(|anchor| anchor.event == event)
            .map(|anchor| anchor.time_us)
    }

    /// Takes note of a packet's header.
    pub fn follow(&mut self, header: &Header, count: u16) -> Continuity {
        let expected = core::mem::replace(&mut self.next_sequence, header.sequence.wrapping_add(count));
        if header.temperature_centi_c.is_some() {
            self.temperature_centi_c = header.temperature_centi_c;
        }
        match self.boot.replace(header.boot) {
            None => Continuity::Fine,
            Some(boot) if boot != header.boot => Continuity::Rebooted,
            Some(_) if header.sequence == expected => Continuity::Fine,
            Some(_) => Continuity::Lost(u32::from(header.sequence.wrapping_sub(expected))),
        }
    }
}
