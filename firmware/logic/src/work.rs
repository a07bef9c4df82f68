//! A node at work, the same on every machine: readings at 833 Hz, two seconds at rest, then movement with pauses;
//! packets are taken as they come.

use shisei_device::node::{Attitude, Node, Rates, Reading, Ticker};
use shisei_wire::calibration::{Calibration, Correction};
use shisei_wire::message::{Command, NO_NODE, Settings};
use shisei_wire::packet::{FilterKind, PACKET_MAX};
use shisei_wire::{AccRange, GyroRange};

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

/// Reading k: a second of movement, half a second of rest.
fn reading(random: &mut Random, k: u64) -> Reading {
    let moved = k > STARTED && k % 1_250 < 833;
    let (turn, push) = if moved { (11, 10) } else { (1, 3) };
    let mut three = |bits: u32| [random.counts(bits), random.counts(bits), random.counts(bits)];
    let (gyro, [x, y, z]) = (three(turn), three(push));
    let acc = [x, y, z.saturating_add(4_098)];
    Reading { time_us: (k + 1) * INTERVAL_US, gyro, acc, temperature_centi_c: Some(2_500) }
}

/// What runs: name, filter, and whether the node keeps a calibration.
pub const CASES: [(&str, FilterKind, bool); 3] = [
    ("complementary", FilterKind::Complementary, false),
    ("estimator", FilterKind::Estimator, false),
    ("calibrated", FilterKind::Estimator, true),
];

/// A calibration with nothing in it that is 0 or 1.
fn calibration() -> Calibration {
    let half = |bias: f32| Correction {
        bias: [bias, -0.5 * bias, 0.75 * bias],
        matrix: [[1.01, 0.002, -0.003], [0.001, 0.99, 0.004], [-0.002, 0.005, 1.003]],
    };
    Calibration { accelerometer: half(0.3), gyroscope: half(0.02) }
}

/// Runs a node with a filter; returns FNV-1a over all packets, and how many samples they had. `look` is called before
/// (true) and after each reading with its number.
pub fn run(filter: FilterKind, calibrated: bool, mut look: impl FnMut(u64, bool)) -> (u64, u64) {
    let mut node = Node::new(4711, "node");
    let settings = Settings { filter, batch: 4, ..Settings::default() };
    node.command(&Command::Configure(NO_NODE, settings), 0);
    if calibrated {
        node.keep(Some(calibration()));
    }
    node.link(true, 0);
    let mut random = Random(7);
    let (mut hash, mut count) = (0xcbf2_9ce4_8422_2325_u64, 0);
    let mut packet = [0; PACKET_MAX];
    for k in 0..READINGS {
        let reading = reading(&mut random, k);
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

/// The same readings through ticks and the filter alone; `look` is called before and after each update of the filter
/// with the number of its reading.
pub fn filter(kind: FilterKind, mut look: impl FnMut(u64, bool)) -> shisei_core::Quaternion {
    let mut attitude = Attitude::begin(kind, shisei_core::Quaternion::IDENTITY, None);
    let (mut ticker, mut random) = (Ticker::default(), Random(7));
    let mut world_from_body = shisei_core::Quaternion::IDENTITY;
    for k in 0..READINGS {
        let reading = reading(&mut random, k);
        let rates = Rates {
            time_us: reading.time_us,
            gyro_rad_s: reading.gyro.map(|count| f64::from(count) * GyroRange::default().count_rad_s()),
            acc_m_s2: reading.acc.map(|count| f64::from(count) * AccRange::default().count_m_s2()),
        };
        ticker.push(&rates, |tick| {
            look(k, true);
            world_from_body = attitude.update(tick.gyro_rad_s, tick.acc_m_s2, tick.dt_s);
            look(k, false);
        });
    }
    world_from_body
}
