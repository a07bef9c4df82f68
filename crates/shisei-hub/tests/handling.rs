//! Attitude of a simulated node over five minutes of handling, against the truth: what the node computes itself, with
//! and without a calibration that it keeps, and what a PC makes of its samples.

use std::sync::Arc;
use std::time::Instant;

use shisei_core::calibration::gyro_turns::{self, TurnSettings};
use shisei_core::calibration::recording::calibrate_poses;
use shisei_core::estimator::{Estimator, Settings as EstimatorSettings};
use shisei_core::filter::{Complementary, DEFAULT_ALPHA, Filter};
use shisei_core::{Quaternion, STANDARD_GRAVITY_M_S2, calibration, initial, vector};
use shisei_hub::live::input::{Arrival, ToHub};
use shisei_hub::live::scene::Key;
use shisei_hub::live::{self, Board, Hub, Kind, What};
use shisei_hub::{Item, Sample, Session, kept};
use shisei_twin::lab::{Lab, Movement, Settings};
use shisei_twin::simulate::Errors;
use shisei_twin::{Calibration, Correction};
use shisei_wire::frame::FRAME_MAX;
use shisei_wire::message::{self, Command, MESSAGE_MAX};
use shisei_wire::packet::{FilterKind, Start};
use shisei_wire::{AccRange, GyroRange, Message, encode_frame};

/// Handling, s.
const HANDLING_S: f64 = 305.0;
/// The start, which is not judged, s: connection, two seconds at rest, the filter's first second.
const START_S: f64 = 6.0;

/// What a PC reads of a laboratory until a time, having said `commands` after a second.
fn run(lab: &mut Lab, duration_s: f64, commands: &[Command<'_>]) -> Vec<Item> {
    let (mut session, mut items, mut told) = (Session::default(), Vec::new(), false);
    let mut bytes = Vec::new();
    while lab.time_s() + 0.005 < duration_s {
        lab.run_to(lab.time_s() + 0.005);
        if lab.time_s() >= 1.0 && !std::mem::replace(&mut told, true) {
            commands.iter().for_each(|command| lab.command(&frame(command)));
        }
        lab.serial(&mut bytes);
        session.push(&bytes, &mut items);
        bytes.clear();
    }
    session.finish(&mut items);
    assert_eq!(session.counts().garbage, 0);
    items
}

fn frame(command: &Command<'_>) -> Vec<u8> {
    let (mut bytes, mut frame) = ([0; MESSAGE_MAX], [0; FRAME_MAX]);
    let length = Message::Command(*command).encode(&mut bytes).expect("a command");
    let framed = encode_frame(&bytes[..length], &mut frame).expect("a frame");
    frame[..framed].to_vec()
}

fn samples(items: &[Item]) -> Vec<&Sample> {
    items
        .iter()
        .filter_map(|item| if let Item::Sample(sample) = item { Some(sample) } else { None })
        .collect()
}

/// Root mean square of the inclination error, degrees, and drift of the heading, degrees a minute.
#[derive(Clone, Copy, Debug, Default)]
struct Judge {
    squares: f64,
    count: f64,
    heading_start_deg: Option<f64>,
    heading_deg: f64,
}

impl Judge {
    fn add(&mut self, estimate: Quaternion, truth: Quaternion) {
        let (tilt_deg, turn_deg) = errors_deg(estimate, truth);
        self.squares += tilt_deg * tilt_deg;
        self.count += 1.0;
        let turned = turn_deg - *self.heading_start_deg.get_or_insert(turn_deg);
        self.heading_deg = turned - 360.0 * shisei_core::math::round(turned / 360.0);
    }

    fn inclination_deg(&self) -> f64 {
        shisei_core::math::sqrt(self.squares / self.count)
    }

    fn drift_deg_min(&self) -> f64 {
        self.heading_deg / ((HANDLING_S - START_S) / 60.0)
    }

    fn text(&self) -> String {
        format!("{:.2}° {:+.2}°/min", self.inclination_deg(), self.drift_deg_min())
    }
}

/// What the node itself computes with a filter.
fn by_node(settings: &Settings, filter: FilterKind, kept: Option<shisei_wire::Calibration>) -> Judge {
    let mut lab = Lab::new(Settings { nodes: 1, ..settings.clone() });
    let configure =
        Command::Configure(0, message::Settings { filter, batch: 4, ..message::Settings::default() });
    let mut commands = vec![configure];
    commands.extend(kept.map(|kept| Command::Keep(0, Some(kept))));
    let items = run(&mut lab, HANDLING_S, &commands);
    let mut judge = Judge::default();
    for sample in samples(&items) {
        let time_s = sample.time_s.expect("a time");
        let truth_s = lab.true_time_s(0, sample.boot, sample.stamp_us, time_s).expect("its boot");
        if truth_s >= START_S {
            assert_eq!(
                (sample.filter, sample.calibrated, sample.start),
                (filter, kept.is_some(), Start::Done)
            );
            judge.add(sample.world_from_body, lab.attitude(0, truth_s).expect("a node"));
        }
    }
    assert!(judge.count > 118.0 * (HANDLING_S - START_S));
    judge
}

/// The calibration of the same part as a user gets it: poses recorded through the receiver, then what
/// `shisei calibrate --method gyro-turns` does with the recording.
fn calibrate(settings: &Settings) -> shisei_wire::Calibration {
    let mut lab = Lab::new(Settings { nodes: 1, movement: Movement::Poses, ..settings.clone() });
    let items = run(&mut lab, 116.0, &[]);
    let all = samples(&items);
    let (first, last) = (all[0].time_s.expect("a time"), all[all.len() - 1].time_s.expect("a time"));
    let dt_s = (last - first) / (all.len() - 1) as f64;
    let acc: Vec<_> = all.iter().map(|sample| sample.acc_m_s2).collect();
    let gyro: Vec<_> = all.iter().map(|sample| sample.gyro_rad_s).collect();
    let poses = calibrate_poses(&acc, &gyro, dt_s, STANDARD_GRAVITY_M_S2, None).expect("poses");
    let accelerometer = poses.calibration.accelerometer;
    let turns = gyro_turns::calibrate(&gyro, dt_s, &poses.segments, &accelerometer, &TurnSettings::default());
    let gyroscope = turns.expect("turns").gyroscope;
    kept::for_node(&calibration::Calibration { accelerometer, gyroscope })
}

/// The node's own light estimator, with a calibration made of the same simulated part's poses: three parts, moved for
/// twenty seconds and laid down for six, again and again, and moved for five minutes without any rest. Beside it the
/// sensor as delivered and the thesis's filter.
#[test]
fn a_nodes_own_attitude_over_five_minutes_of_handling() {
    for seed in 1..=3 {
        for (how, movement_s) in [("with rests", 26.0), ("without rests", 306.0)] {
            let settings = Settings { seed, movement_s, ..Settings::default() };
            let kept = calibrate(&settings);
            let calibrated = by_node(&settings, FilterKind::Estimator, Some(kept));
            println!(
                "part {seed}, {how}: estimator {} (as delivered {}), complementary {} (as delivered {})",
                calibrated.text(),
                by_node(&settings, FilterKind::Estimator, None).text(),
                by_node(&settings, FilterKind::Complementary, Some(kept)).text(),
                by_node(&settings, FilterKind::Complementary, None).text(),
            );
            assert!(calibrated.inclination_deg() <= 1.0, "part {seed}: {}", calibrated.text());
            assert!(calibrated.drift_deg_min().abs() <= 2.0, "part {seed}: {}", calibrated.text());
        }
    }
}

/// Inclination and heading errors, degrees.
fn errors_deg(estimate: Quaternion, truth: Quaternion) -> (f64, f64) {
    let error = estimate.product(truth.conjugate()).normalized();
    let up = error.rotate([0.0, 0.0, 1.0]);
    let heading = 2.0 * shisei_core::math::atan2(error.to_array()[3], error.to_array()[0]);
    (shisei_core::math::acos(up[2].clamp(-1.0, 1.0)).to_degrees(), heading.to_degrees())
}

/// A sensor after a six-face calibration: what is left of its errors. The node's own start finds the gyro bias.
fn calibrated() -> Errors {
    let matrix = |s: f64| [[1.0 + s, 0.001, -0.001], [-0.001, 1.0 - s, 0.001], [0.001, -0.001, 1.0 + s]];
    Errors::Given(Calibration {
        accelerometer: Correction { bias: [0.02, -0.03, 0.025], matrix: matrix(0.001) },
        gyroscope: Correction { bias: [0.02, -0.01, 0.015], matrix: matrix(0.002) },
    })
}

/// What a PC makes of the samples: the estimator and the complementary filter, bias removed by the node's start.
fn by_pc(errors: Errors, movement_s: f64) -> (Judge, Judge) {
    let mut lab = Lab::new(Settings { nodes: 1, movement_s, errors, ..Settings::default() });
    let items = run(&mut lab, HANDLING_S, &[]);
    let all = samples(&items);
    let mut estimator = Estimator::new(&EstimatorSettings::default()).expect("the defaults");
    let (mut bias, mut acc, mut count) = ([0.0; 3], [0.0; 3], 0.0);
    for sample in all.iter().filter(|sample| sample.start == Start::Running) {
        bias = vector::add(bias, sample.gyro_rad_s);
        acc = vector::add(acc, sample.acc_m_s2);
        count += 1.0;
    }
    let bias = vector::scale(bias, 1.0 / count);
    let start = initial::from_mean_acceleration(acc).expect("gravity");
    let mut simple = Complementary::new(start, DEFAULT_ALPHA, STANDARD_GRAVITY_M_S2).expect("the defaults");
    let (mut own, mut thesis) = (Judge::default(), Judge::default());
    let mut previous_s = all[0].time_s.expect("a time") - 1.0 / 120.0;
    for sample in all {
        let time_s = sample.time_s.expect("a time");
        let dt_s = time_s - previous_s;
        previous_s = time_s;
        let rate = vector::sub(sample.gyro_rad_s, bias);
        let estimate = Filter::update(&mut estimator, rate, sample.acc_m_s2, dt_s);
        let by_simple = simple.update(rate, sample.acc_m_s2, dt_s);
        let truth_s = lab.true_time_s(0, sample.boot, sample.stamp_us, time_s).expect("its boot");
        if truth_s >= START_S {
            // The sensor's reading stands for the interval before it: half of it late.
            let truth = lab.attitude(0, truth_s).expect("a node");
            own.add(estimate, truth);
            thesis.add(by_simple, truth);
        }
    }
    (own, thesis)
}

#[test]
fn attitude_by_a_pc_over_five_minutes_of_handling() {
    // Moved for twenty seconds, laid down for six, again and again; and moved without any rest.
    let calibrated = by_pc(calibrated(), 26.0);
    for (which, (own, thesis)) in [
        ("calibrated", calibrated),
        ("calibrated, without rests", by_pc(self::calibrated(), 306.0)),
        ("as delivered", by_pc(Errors::Drawn, 26.0)),
    ] {
        println!("by a PC, {which}: estimator {}, complementary {}", own.text(), thesis.text());
    }
    let (own, thesis) = calibrated;
    assert!(own.inclination_deg() <= 1.0 && own.drift_deg_min().abs() <= 2.0, "{}", own.text());
    assert!(own.inclination_deg() < thesis.inclination_deg());
}

/// What a node is told to be it is after a restart too: name, settings and calibration.
#[test]
fn a_node_that_starts_anew_is_as_it_was_told_to_be() {
    let settings = Settings { nodes: 1, reboots: vec![(0, 8.0)], ..Settings::default() };
    let straight = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let half = shisei_wire::calibration::Correction { bias: [0.01; 3], matrix: straight };
    let told = message::Settings {
        filter: FilterKind::Estimator,
        batch: 2,
        gyro_range: GyroRange::Dps1000,
        acc_range: AccRange::G16,
    };
    let commands = [
        Command::Configure(0, told),
        Command::Keep(0, Some(shisei_wire::Calibration { accelerometer: half, gyroscope: half })),
        Command::Rename(0, "左手"),
    ];
    let mut lab = Lab::new(settings);
    let items = run(&mut lab, 20.0, &commands);
    let again = items.iter().position(|item| matches!(item, Item::Rebooted(0, _))).expect("a restart");
    let after = samples(&items[again..]);
    assert!(after.len() > 1000, "{}", after.len());
    assert!(after.iter().all(|sample| sample.calibrated && sample.filter == FilterKind::Estimator));
    // in counts of ±16 g and ±1000 °/s
    let whole =
        |value: f64, count: f64| (value / count - shisei_core::math::round(value / count)).abs() < 1e-6;
    assert!(after.iter().all(|sample| sample.acc_m_s2.iter().all(|&a| whole(a, AccRange::G16.count_m_s2()))));
    assert!(after.iter().all(|s| s.gyro_rad_s.iter().all(|&w| whole(w, GyroRange::Dps1000.count_rad_s()))));
    let odd = |w: f64| !whole(w, GyroRange::Dps2000.count_rad_s());
    assert!(after.iter().any(|sample| odd(sample.gyro_rad_s[0])));
    let name =
        items.iter().rev().find_map(|item| if let Item::Node(node) = item { Some(&node.name) } else { None });
    assert_eq!(name.map(String::as_str), Some("左手"));
}

/// What the hub shows of a node without a body, over a minute of handling.
fn shown(settings: &Settings, kept: Option<shisei_wire::Calibration>) -> Judge {
    let calibrations = kept.into_iter().map(|kept| (0, kept)).collect();
    let mut lab = Lab::new(Settings { nodes: 1, calibrations, ..settings.clone() });
    let board = Arc::new(Board::new("{}"));
    let mut hub = Hub::new(live::Settings::default(), vec![("lab".into(), Kind::Serial)], Vec::new(), board);
    let (mut session, mut items, port) = (Session::default(), Vec::new(), Arc::from("lab"));
    let mut judge = Judge::default();
    while lab.time_s() < 60.0 {
        lab.run_to(lab.time_s() + 0.005);
        let mut bytes = Vec::new();
        lab.serial(&mut bytes);
        items.clear();
        session.push(&bytes, &mut items);
        let (at, unix_ns, port) = (Instant::now(), (lab.time_s() * 1e9) as u64, Arc::clone(&port));
        hub.push(ToHub::Arrival(Arrival { input: 0, port, at, unix_ns, what: What::Serial(bytes) }));
        let object = hub.scene().objects().find(|object| object.key == Key::Node(0));
        let (Some(sample), Some(shown)) =
            (samples(&items).pop(), object.and_then(|object| object.shown.as_ref()))
        else {
            continue;
        };
        let time_s = sample.time_s.expect("a time");
        let truth_s = lab.true_time_s(0, sample.boot, sample.stamp_us, time_s).expect("its boot");
        // node and receiver have told each other all by then
        if truth_s >= 15.0 {
            judge.add(shown.pose.world_from_body, lab.attitude(0, truth_s).expect("a node"));
        }
    }
    judge
}

/// What is sent is as the sensor gave it; the hub corrects it by the calibration that the node says it keeps.
#[test]
fn the_hub_corrects_the_samples_of_a_node_that_keeps_a_calibration() {
    let (mut all_with, mut all_without) = (0.0, 0.0);
    for seed in 1..=3 {
        let settings = Settings { seed, movement_s: 306.0, ..Settings::default() };
        let (with, without) = (shown(&settings, Some(calibrate(&settings))), shown(&settings, None));
        assert!(with.count > 1000.0 && without.count > 1000.0);
        let (with, without) = (with.inclination_deg(), without.inclination_deg());
        println!("part {seed}, shown live: kept {with:.2}°, as delivered {without:.2}°");
        assert!(with < without, "part {seed}: {with}° and {without}°");
        all_with += with;
        all_without += without;
    }
    assert!(all_with < 0.6 * all_without, "{all_with}° and {all_without}°");
}
