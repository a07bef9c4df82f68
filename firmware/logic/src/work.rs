//! A node at work, the same on every machine: readings at 833 Hz, two seconds at rest, then movement with pauses;
//! packets are taken as they come. `look` is called before and after every reading.

use shisei_device::node::{Node, Reading};
use shisei_wire::message::{Command, NO_NODE, Settings};
use shisei_wire::packet::{FilterKind, PACKET_MAX};

/// Readings: 8 s at 833 Hz.
pub const READINGS: u64 = 6_664;
/// The sensor's interval, µs.
const INTERVAL_US: u64 = 1_200;
/// The start is over by then.
pub const STARTED: u64 = 2_000;

/// D. Knuth's MMIX generator.
struct Random(u64);

impl Random {
    /// −2^`bits` … 2^`bits`.
    fn counts(&mut self, bits: u32) -> i16 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> (63 - bits)) as i32 - (1 << bits)) as i16
    }
}

/// Runs a node with a filter; returns FNV-1a over all packets, and how many samples they had.
pub fn run(filter: FilterKind, mut look: impl FnMut(u64, bool)) -> (u64, u64) {
    let mut node = Node::new(4711, "node");
    let settings = Settings { filter, batch: 4, ..Settings::default() };
    node.command(&Command::Configure(NO_NODE, settings), 0);
    node.link(true, 0);
    let mut random = Random(7);
    let (mut hash, mut count) = (0xcbf2_9ce4_8422_2325_u64, 0);
    let mut packet = [0; PACKET_MAX];
    for k in 0..READINGS {
        // A second of movement, half a second of rest.
        let moved = k > STARTED && k % 1_250 < 833;
        let (turn, push) = if moved { (11, 10) } else { (1, 3) };
        let mut three = |bits: u32| [random.counts(bits), random.counts(bits), random.counts(bits)];
        let (gyro, [x, y, z]) = (three(turn), three(push));
        let reading = Reading {
            time_us: (k + 1) * INTERVAL_US,
            gyro,
            acc: [x, y, z.saturating_add(4_098)],
            temperature_centi_c: Some(2_500),
        };
        look(k, true);
        node.reading(&reading);
        look(k, false);
        while let Some((length, samples)) = node.packet(&mut packet) {
            for byte in packet.iter().take(length) {
                hash = (hash ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3);
            }
            node.sent(samples);
            count += samples as u64;
        }
    }
    (hash, count)
}
