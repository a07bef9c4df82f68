//! A node on a board made of queues.

use std::collections::VecDeque;

use shisei_device::node::{Board, Name, Node, QUEUE, RECORD_BYTES, Reading, Record, step};
use shisei_wire::calibration::{Calibration, Correction};
use shisei_wire::message::Settings;
use shisei_wire::packet::{FilterKind, Start};
use shisei_wire::{AccRange, GyroRange, Packet};

#[derive(Default)]
struct Desk {
    now_us: u64,
    readings: VecDeque<Reading>,
    link: Option<bool>,
    commands: VecDeque<Vec<u8>>,
    packets: Vec<Vec<u8>>,
    room: bool,
    light: bool,
    stored: Vec<Record>,
    ranges: Option<(GyroRange, AccRange)>,
}

impl Board for Desk {
    fn now_us(&self) -> u64 {
        self.now_us
    }
    fn reading(&mut self) -> Option<Reading> {
        self.readings.pop_front()
    }
    fn set_ranges(&mut self, gyro: GyroRange, acc: AccRange) {
        self.ranges = Some((gyro, acc));
    }
    fn link_changed(&mut self) -> Option<bool> {
        self.link.take()
    }
    fn anchor(&mut self) -> Option<(u16, u64)> {
        Some((7, self.now_us))
    }
    fn notify(&mut self, packet: &[u8]) -> bool {
        if self.room {
            self.packets.push(packet.to_vec());
        }
        self.room
    }
    fn command(&mut self, out: &mut [u8]) -> Option<usize> {
        let command = self.commands.pop_front()?;
        out[..command.len()].copy_from_slice(&command);
        Some(command.len())
    }
    fn battery_mv(&mut self) -> u16 {
        3300
    }
    fn light(&mut self, on: bool) {
        self.light = on;
    }
    fn store(&mut self, record: &Record) {
        self.stored.push(*record);
    }
}

impl Desk {
    /// The calibration that is stored.
    fn kept(&self) -> Option<Calibration> {
        self.stored.last().and_then(|record| record.calibration)
    }
}

/// Runs for so many ms with a reading every 1.2 ms.
fn run(node: &mut Node, desk: &mut Desk, ms: u64, reading: Reading) {
    let end_us = desk.now_us + ms * 1000;
    while desk.now_us < end_us {
        desk.now_us += 1200;
        desk.readings.push_back(Reading { time_us: desk.now_us, ..reading });
        step(node, desk);
    }
}

fn level() -> Reading {
    // 1 g on z at ±8 g; 0.7 °/s on x
    Reading { gyro: [10, 0, 0], acc: [0, 0, 4098], temperature_centi_c: Some(2512), ..Reading::default() }
}

fn samples(desk: &Desk) -> Vec<(u16, Start, [f64; 4], bool)> {
    let mut all = Vec::new();
    for bytes in &desk.packets {
        let packet = Packet::decode(bytes).expect("the node's own packet");
        for (k, sample) in packet.samples().enumerate() {
            let h = packet.header;
            all.push((
                h.sequence.wrapping_add(k as u16),
                h.flags.start,
                sample.world_from_body(),
                h.flags.late,
            ));
        }
    }
    all
}

#[test]
fn start_then_attitude_with_the_bias_removed() {
    let (mut node, mut desk) = (Node::new(0xbeef, "左手"), Desk { room: true, ..Desk::default() });
    desk.link = Some(true);
    run(&mut node, &mut desk, 6000, level());
    let found = samples(&desk);
    assert!(found.len() >= 710, "{}", found.len());
    assert!(found.windows(2).all(|two| two[1].0 == two[0].0.wrapping_add(1)));
    assert_eq!((found[100].1, found[700].1), (Start::Running, Start::Done));
    // 0.7 °/s for four seconds would be 2.8°; removed, nothing is left.
    assert!((found[700].2[0] - 1.0).abs() < 1e-4 && found[700].2[1].abs() < 1e-4);
    let packet = Packet::decode(desk.packets.last().unwrap()).unwrap();
    assert_eq!((packet.header.boot, packet.header.temperature_centi_c), (0xbeef, Some(2512)));
    assert!(packet.header.flags.battery_low && packet.header.anchor.is_some());
    // Rates are sent before the bias is removed.
    assert!(packet.samples().all(|sample| sample.gyro == [10, 0, 0] && sample.acc == [0, 0, 4098]));
    assert_eq!(node.status()[..4], [0xe4, 0x0c, 0xd0, 0x09]);
}

#[test]
fn a_lost_link_costs_what_does_not_fit_and_marks_the_rest() {
    let (mut node, mut desk) = (Node::new(1, "a"), Desk { room: true, ..Desk::default() });
    desk.link = Some(true);
    run(&mut node, &mut desk, 1000, level());
    desk.link = Some(false);
    run(&mut node, &mut desk, 3000, level());
    let before = samples(&desk).len();
    desk.link = Some(true);
    run(&mut node, &mut desk, 1000, level());
    let found = samples(&desk);
    let late = found.iter().filter(|sample| sample.3).count();
    assert!((QUEUE - 2..=QUEUE).contains(&late), "{late}");
    let jump = found[before].0 - found[before - 1].0;
    assert!((360 - QUEUE as u16..=362).contains(&jump), "{jump}");
    assert!(found[before..].windows(2).all(|two| two[1].0 == two[0].0 + 1));
}

#[test]
fn a_busy_radio_delays_and_loses_nothing() {
    let (mut node, mut desk) = (Node::new(1, "a"), Desk { room: true, ..Desk::default() });
    desk.link = Some(true);
    for k in 0..10 {
        desk.room = k % 2 == 0;
        run(&mut node, &mut desk, 500, level());
    }
    desk.room = true;
    run(&mut node, &mut desk, 100, level());
    let found = samples(&desk);
    assert!(found.len() > 600 && found.windows(2).all(|two| two[1].0 == two[0].0 + 1));
}

#[test]
fn commands_over_the_air() {
    let (mut node, mut desk) = (Node::new(1, "a"), Desk { room: true, ..Desk::default() });
    desk.link = Some(true);
    run(&mut node, &mut desk, 3000, level());
    assert_eq!(node.start(), Start::Done);
    desk.commands.push_back([&[132], "右足".as_bytes()].concat());
    desk.commands.push_back(vec![130]);
    desk.commands.push_back(vec![133, 1, 8, 2, 0]);
    desk.commands.push_back(vec![99, 1, 2]);
    desk.commands.push_back(vec![]);
    run(&mut node, &mut desk, 4, level());
    assert_eq!(node.name(), "右足");
    assert_eq!(desk.ranges, Some((GyroRange::Dps500, AccRange::G2)));
    let expected = Settings {
        filter: FilterKind::Estimator,
        batch: 8,
        gyro_range: GyroRange::Dps500,
        acc_range: AccRange::G2,
    };
    assert_eq!(node.settings(), expected);
    assert_eq!(node.start(), Start::Running);
    // name and settings are stored as they come
    let stored: Vec<_> = desk.stored.iter().map(|record| (record.name, record.settings)).collect();
    let name = Some(Name::cut("右足"));
    assert_eq!(stored, [(name, Some(Settings { batch: 4, ..Settings::default() })), (name, Some(expected))]);
    let lights: Vec<bool> = (0..8)
        .map(|_| {
            run(&mut node, &mut desk, 125, level());
            desk.light
        })
        .collect();
    assert!(lights.contains(&true) && lights.contains(&false));
    run(&mut node, &mut desk, 3000, Reading { acc: [0, 0, 16393], ..level() });
    assert_eq!(node.start(), Start::Done);
    let packet = Packet::decode(desk.packets.last().unwrap()).unwrap();
    assert_eq!((packet.count(), packet.header.flags.filter), (8, FilterKind::Estimator));
    assert!((packet.samples().last().unwrap().world_from_body()[0].abs() - 1.0).abs() < 1e-3);
}

/// A sensor whose x axis reads 1.7 m/s² too much and whose gyroscope reads a fifth too little about z.
fn wrong_sensor() -> Calibration {
    let straight = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let turned = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.25]];
    Calibration {
        accelerometer: Correction { bias: [1.7, 0.0, 0.0], matrix: straight },
        gyroscope: Correction { bias: [0.0; 3], matrix: turned },
    }
}

/// What the last packet says: the attitude, whether it is of corrected readings, and the counts.
fn newest(desk: &Desk) -> ([f64; 4], bool, [i16; 3], [i16; 3]) {
    let packet = Packet::decode(desk.packets.last().expect("a packet")).expect("the node's own");
    let sample = packet.samples().last().expect("a sample");
    (sample.world_from_body(), packet.header.flags.calibrated, sample.gyro, sample.acc)
}

#[test]
fn a_kept_calibration_corrects_the_attitude_and_not_what_is_sent() {
    for filter in [0, 1] {
        let (mut node, mut desk) = (Node::new(1, "a"), Desk { room: true, ..Desk::default() });
        desk.link = Some(true);
        desk.commands.push_back(vec![133, filter, 4, 4, 2]);
        // At rest and level, but the accelerometer says 9.81 up and 1.7 to the side: 10° (710 counts of 0.244 mg).
        let at_rest = Reading { acc: [710, 0, 4098], ..level() };
        run(&mut node, &mut desk, 5000, at_rest);
        let (world_from_body, calibrated, ..) = newest(&desk);
        assert!(!calibrated && (world_from_body[0] - 0.9963).abs() < 1e-3, "{world_from_body:?}");

        let sent = wrong_sensor();
        desk.commands.push_back([&[134], sent.encode().unwrap().as_slice()].concat());
        run(&mut node, &mut desk, 5000, at_rest);
        assert_eq!((node.calibration(), desk.kept()), (Some(&sent), Some(sent)));
        assert_eq!(node.start(), Start::Done);
        let (world_from_body, calibrated, gyro, acc) = newest(&desk);
        assert!(calibrated && (world_from_body[0] - 1.0).abs() < 1e-5, "{world_from_body:?}");
        assert_eq!((gyro, acc), ([10, 0, 0], [710, 0, 4098]));

        // 72 °/s by its own count for a second are 90°: cos 45°.
        run(&mut node, &mut desk, 1000, Reading { gyro: [10, 0, 1029], ..at_rest });
        let (turned, ..) = newest(&desk);
        let angle_deg = 2.0 * shisei_core::math::acos(turned[0]).to_degrees();
        assert!((angle_deg - 90.0).abs() < 4.0, "{angle_deg}");

        // Kept at the next start by the board; then forgotten.
        let mut again = Node::new(2, "a");
        again.restore(desk.stored.last().expect("a record"));
        assert_eq!(again.calibration(), Some(&sent));
        desk.commands.push_back(vec![134]);
        run(&mut node, &mut desk, 5000, at_rest);
        assert_eq!((node.calibration(), desk.kept()), (None, None));
        assert!(!newest(&desk).1);
    }
}

#[test]
fn a_nonsense_calibration_is_refused() {
    let (mut node, mut desk) = (Node::new(1, "a"), Desk { room: true, ..Desk::default() });
    desk.link = Some(true);
    let good = wrong_sensor().encode().unwrap();
    let mut damaged = good;
    damaged[7] ^= 1;
    desk.commands.push_back([&[134], damaged.as_slice()].concat());
    desk.commands.push_back([&[134], &good[..98]].concat());
    desk.commands.push_back([&[134], [0; 99].as_slice()].concat());
    run(&mut node, &mut desk, 10, level());
    assert!(node.calibration().is_none() && desk.stored.is_empty());
}

#[test]
fn a_node_that_starts_anew_is_as_it_was_left() {
    let (mut node, mut desk) = (Node::new(1, "a"), Desk { room: true, ..Desk::default() });
    desk.link = Some(true);
    desk.commands.push_back([&[132], "左手".as_bytes()].concat());
    desk.commands.push_back([&[134], wrong_sensor().encode().unwrap().as_slice()].concat());
    desk.commands.push_back(vec![133, 1, 8, 2, 0]);
    run(&mut node, &mut desk, 10, level());
    let writes = desk.stored.len();
    // what is so already costs no write
    desk.commands.push_back(vec![133, 1, 8, 2, 0]);
    run(&mut node, &mut desk, 10, level());
    assert_eq!((writes, desk.stored.len()), (3, 3));

    let memory = desk.stored.last().expect("a record").encode();
    let (mut again, mut desk) = (Node::new(2, "b"), Desk { room: true, ..Desk::default() });
    again.restore(&Record::decode(&memory));
    assert_eq!((again.name(), again.settings()), ("左手", node.settings()));
    assert_eq!(again.calibration(), node.calibration());
    desk.link = Some(true);
    run(&mut again, &mut desk, 4000, Reading { acc: [0, 0, 16393], ..level() });
    let flags = Packet::decode(desk.packets.last().unwrap()).unwrap().header.flags;
    assert_eq!((flags.filter, flags.gyro_range), (FilterKind::Estimator, GyroRange::Dps500));
    assert!(flags.calibrated && flags.acc_range == AccRange::G2 && flags.start == Start::Done);
    assert!(desk.stored.is_empty());

    // a memory that was never written
    let mut first = Node::new(3, "c");
    first.restore(&Record::decode(&[0xFF; RECORD_BYTES]));
    assert_eq!((first.name(), first.settings()), ("c", Node::new(4, "d").settings()));
}
