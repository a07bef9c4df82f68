//! What the hub gives out live is the causal run on the same samples, bit for bit, however frames and samples arrive;
//! and what that costs in gaps against the smoother, which knows what came after, and against the estimate with a
//! delay, which is recorded.

use std::time::Duration;

use shisei_core::alignment::Alignment;
use shisei_core::estimator::{self, BridgeSettings, LiveBridge, OpticalPose};
use shisei_core::frames::{Axes, Pose};
use shisei_core::fuse::delayed::DelayedSettings;
use shisei_core::fuse::{FuseSettings, Fusion, Inertial, Optical, Source, fuse};
use shisei_core::{Quaternion, Vec3, vector};
use shisei_hub::Sample;
use shisei_hub::live::backlog::backlog;
use shisei_hub::live::lagged::{Lagged, Late, Smoothing};
use shisei_hub::live::merge::{Clocking, Coupling, Merger, Moved, Seen};
use shisei_hub::live::recorder::Record;
use shisei_record::{Input, Options, Recording, open};
use shisei_twin::optics::{Cameras, Rig, film};
use shisei_twin::simulate::{Errors, Settings, simulate};
use shisei_twin::{Motion, Random, Sensor, movements};
use shisei_wire::packet::{FilterKind, Start};

/// As the hub has it.
const OPTICS: BridgeSettings = BridgeSettings { attitude_rad: 0.0075, position_m: 5e-4, lever_m: 0.005 };

/// Frames and samples of one body, and how they belong together.
struct Take {
    frames: Vec<Seen>,
    samples: Vec<Sample>,
    coupling: Coupling,
}

fn sample(k: usize, time_s: f64, gyro_rad_s: Vec3, acc_m_s2: Vec3) -> Sample {
    Sample {
        node: 0,
        boot: 7,
        sequence: k as i64,
        raw_sequence: k as u16,
        stamp_us: (time_s * 1e6).round() as u64 as u32,
        time_s: Some(time_s),
        frame: None,
        from_gate: false,
        arrival_frame: None,
        gyro_rad_s,
        acc_m_s2,
        world_from_body: Quaternion::IDENTITY,
        temperature_c: None,
        late: false,
        reading_missed: false,
        start: Start::Done,
        filter: FilterKind::Complementary,
        calibrated: false,
    }
}

/// The same without queues: each sample looks at all frames at once.
fn causal(take: &Take) -> Vec<(f64, estimator::Bridged)> {
    let Coupling { alignment, step_s, .. } = take.coupling;
    let settings = estimator::Settings { gravity_m_s2: alignment.gravity_m_s2, ..Default::default() };
    let mut bridge = LiveBridge::new(&OPTICS, &settings).expect("settings");
    let time = |seen: &Seen| take.coupling.frame_time_s(seen.number, seen.exposure_s);
    let mut out = Vec::new();
    let (mut last, mut any) = (None::<&Sample>, false);
    for sample in &take.samples {
        let time_s = take.coupling.sample_time_s(sample).expect("a time");
        let dt_s = last.map_or(10.0, |last| f64::from(sample.stamp_us.wrapping_sub(last.stamp_us)) * 1e-6);
        last = Some(sample);
        let gyro_rad_s = alignment.rate(sample.gyro_rad_s);
        let reading = estimator::Sample { gyro_rad_s, acc_m_s2: alignment.force(sample.acc_m_s2), dt_s };
        let newest = take.frames.partition_point(|seen| time(seen) <= time_s).checked_sub(1);
        let pose = newest.and_then(|k| {
            let late_s = time_s - time(&take.frames[k]);
            if late_s > 1.5 * step_s {
                return None;
            }
            let sensor = alignment.sensor(&take.frames[k].pose?);
            if late_s == 0.0 {
                return Some(sensor);
            }
            let rate = vector::sub(gyro_rad_s, bridge.bridged().state.gyro_bias_rad_s);
            let turn = Quaternion::from_rotation_vector(vector::scale(rate, late_s));
            let speed = k.checked_sub(1).and_then(|k| take.frames[k].pose).map_or([0.0; 3], |before| {
                let moved = vector::sub(sensor.position_m, alignment.sensor(&before).position_m);
                vector::scale(moved, 1.0 / (time(&take.frames[k]) - time(&take.frames[k - 1])))
            });
            Some(OpticalPose {
                world_from_body: sensor.world_from_body.product(turn).normalized(),
                position_m: vector::add(sensor.position_m, vector::scale(speed, late_s)),
            })
        });
        let bridged = bridge.update(&reading, pose.as_ref());
        any |= pose.is_some();
        if any {
            out.push((time_s, bridged));
        }
    }
    out
}

/// What arrives.
#[derive(Clone, Copy)]
enum Arrival {
    Frame(usize),
    Sample(usize),
}

/// Frames and samples with their own delays, in the order in which they then arrive.
fn arrivals(take: &Take, seed: u64, frame_late: (f64, f64), sample_late: (f64, f64)) -> Vec<Arrival> {
    let mut random = Random::new(seed, 99);
    let mut all = Vec::new();
    for (k, seen) in take.frames.iter().enumerate() {
        let late = random.between(frame_late.0, frame_late.1);
        all.push((take.coupling.frame_time_s(seen.number, seen.exposure_s) + late, Arrival::Frame(k)));
    }
    let mut newest = 0.0_f64;
    for (k, sample) in take.samples.iter().enumerate() {
        let late = random.between(sample_late.0, sample_late.1);
        // samples of a node come in their order
        newest = newest.max(take.coupling.sample_time_s(sample).expect("a time") + late);
        all.push((newest, Arrival::Sample(k)));
    }
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    all.into_iter().map(|(_, arrival)| arrival).collect()
}

fn live(take: &Take, order: &[Arrival]) -> Vec<Moved> {
    let mut merger = Merger::new(take.coupling, &OPTICS).expect("settings");
    let mut out = Vec::new();
    for arrival in order {
        match *arrival {
            Arrival::Frame(k) => merger.frame(take.frames[k], &mut out),
            Arrival::Sample(k) => merger.sample(&take.samples[k], &mut out),
        }
    }
    merger.release(&mut out);
    out
}

/// The estimate with a delay, of the same arrivals; begun after so many of them.
fn late(take: &Take, order: &[Arrival], lag_s: f64, from: usize) -> Vec<Late> {
    let mut merger = Merger::new(take.coupling, &OPTICS).expect("settings");
    let settings = DelayedSettings { lag_s, optics: OPTICS, ..DelayedSettings::default() };
    let (mut lagged, mut moved, mut out) = (None, Vec::new(), Vec::new());
    for (count, arrival) in order.iter().enumerate() {
        if count == from {
            lagged = Some(Lagged::after(&merger, &settings).expect("settings"));
            merger.keep_taken(true);
        }
        match *arrival {
            Arrival::Frame(k) => merger.frame(take.frames[k], &mut moved),
            Arrival::Sample(k) => merger.sample(&take.samples[k], &mut moved),
        }
        let taken = merger.taken();
        if let Some(lagged) = &mut lagged {
            taken.iter().for_each(|one| lagged.push(one, 0, &mut out));
        }
    }
    merger.release(&mut moved);
    let mut lagged = lagged.expect("enough arrivals");
    merger.taken().iter().for_each(|one| lagged.push(one, 0, &mut out));
    lagged.finish(&mut out);
    out
}

/// The thread of a recording makes the same of it.
fn recorded(take: &Take, order: &[Arrival], expected: &[Late]) {
    let mut merger = Merger::new(take.coupling, &OPTICS).expect("settings");
    let settings = DelayedSettings { optics: OPTICS, ..DelayedSettings::default() };
    let (records, recorded) = backlog();
    let smoothing = Smoothing::start(records);
    smoothing.begin(3, "Tool".into(), Lagged::after(&merger, &settings).expect("settings"));
    merger.keep_taken(true);
    let mut moved = Vec::new();
    for (count, arrival) in order.iter().enumerate() {
        match *arrival {
            Arrival::Frame(k) => merger.frame(take.frames[k], &mut moved),
            Arrival::Sample(k) => merger.sample(&take.samples[k], &mut moved),
        }
        assert!(smoothing.taken(3, merger.taken(), count as u64));
    }
    merger.release(&mut moved);
    assert!(smoothing.taken(3, merger.taken(), order.len() as u64));
    smoothing.end();
    let expected: Vec<&Late> = expected.iter().filter(|late| late.frame.pose.is_some()).collect();
    let recorded: Vec<Record> = std::iter::from_fn(|| recorded.take(Duration::ZERO).ok()).collect();
    assert_eq!(recorded.len(), expected.len());
    let mut last_ns = 0;
    for (record, late) in recorded.into_iter().zip(expected) {
        let Record::Smoothed(path, shown, came_ns) = record else { panic!("{record:?}") };
        assert_eq!((path.as_str(), Some(shown.pose)), ("Tool", late.frame.pose));
        assert_eq!((shown.time_s, shown.source), (late.time_s, late.frame.source));
        assert!(shown.placed == (shown.source != Source::Inertial) && came_ns >= last_ns);
        last_ns = came_ns;
    }
}

fn assert_same(expected: &[(f64, estimator::Bridged)], found: &[Moved], what: &str) {
    assert_eq!(expected.len(), found.len(), "{what}");
    for ((time_s, bridged), moved) in expected.iter().zip(found) {
        assert_eq!(time_s.to_bits(), moved.time_s.to_bits(), "{what}");
        let bits = |b: &estimator::Bridged| {
            let q = b.state.world_from_body.to_array().map(f64::to_bits);
            let numbers =
                [b.position_m, b.velocity_m_s, b.state.gyro_bias_rad_s].map(|v| v.map(f64::to_bits));
            (q, numbers, b.sigma_position_m.to_bits())
        };
        assert_eq!(bits(bridged), bits(&moved.bridged), "{what}, {time_s} s");
    }
}

/// Errors in degrees and mm, root mean square.
#[derive(Default)]
struct Errors2 {
    deg2: f64,
    mm2: f64,
    count: f64,
}

impl Errors2 {
    fn add(&mut self, pose: &Pose, truth: &Pose) {
        let turned = pose.world_from_body.conjugate().product(truth.world_from_body).angle().to_degrees();
        let apart = vector::norm(vector::sub(pose.position_m, truth.position_m)) * 1e3;
        self.deg2 += turned * turned;
        self.mm2 += apart * apart;
        self.count += 1.0;
    }

    fn rms(&self) -> (f64, f64) {
        ((self.deg2 / self.count).sqrt(), (self.mm2 / self.count).sqrt())
    }
}

/// Poses with their times.
fn moved_poses(moved: &[Moved]) -> Vec<(f64, Pose)> {
    moved.iter().map(|moved| (moved.time_s, moved.pose)).collect()
}

fn late_poses(late: &[Late]) -> Vec<(f64, Pose)> {
    late.iter().filter_map(|late| Some((late.time_s, late.frame.pose?))).collect()
}

/// The pose at a time between two samples.
fn at(poses: &[(f64, Pose)], time_s: f64) -> Option<Pose> {
    let next = poses.partition_point(|(then_s, _)| *then_s < time_s);
    let ((a_s, a), (b_s, b)) = (*poses.get(next.checked_sub(1)?)?, *poses.get(next)?);
    let u = (time_s - a_s) / (b_s - a_s);
    let step = vector::sub(b.position_m, a.position_m);
    Some(Pose {
        position_m: vector::add(a.position_m, vector::scale(step, u)),
        world_from_body: Quaternion::slerp(a.world_from_body, b.world_from_body, u).normalized(),
    })
}

/// Errors of poses in frames, root mean square: degrees and mm.
fn errors(poses: &[(f64, Pose)], frames: impl Iterator<Item = (f64, Pose)>) -> (f64, f64) {
    let mut errors = Errors2::default();
    frames.for_each(|(time_s, truth)| errors.add(&at(poses, time_s).expect("bridged"), &truth));
    errors.rms()
}

fn coupling(fusion: &Fusion, step_s: f64) -> Coupling {
    let alignment = Alignment::found(
        &fusion.sync,
        fusion.lever.as_ref(),
        [0.0, 0.0, 1.0],
        shisei_core::STANDARD_GRAVITY_M_S2,
    );
    let clocking = Clocking::Times { offset_s: fusion.sync.offset_s, skew: fusion.sync.skew };
    Coupling { alignment, clocking, step_s }
}

#[test]
fn a_simulated_take_in_any_order_of_arrival() {
    let motion = movements::wander(5, 4.0, 42.0);
    let rig = Rig {
        body_from_sensor: Quaternion::from_rotation_vector([0.7, -1.1, 0.4]),
        sensor_m: [0.03, -0.02, 0.05],
        markers_m: Vec::new(),
    };
    let lost_s: Vec<(f64, f64)> = (0..6).map(|k| 8.0 + 6.0 * f64::from(k)).map(|s| (s, s + 1.0)).collect();
    let cameras =
        Cameras { offset_s: 1.0, skew: 3e-5, lost_s: lost_s.clone(), ..Cameras::new(240.0, 45.0, 5) };
    let filmed = film(&motion, &rig, &cameras);
    let settings = Settings { errors: Errors::DrawnAligned, ..Settings::new(120.0, 5) };
    let simulation = simulate(&motion, &Sensor::lsm6ds3tr_c(), &settings);
    let (sensor_s, acc, gyro) = (simulation.time_s(), simulation.acc_m_s2(), simulation.gyro_rad_s());
    let optical_s: Vec<f64> = filmed.iter().map(|frame| frame.time_s).collect();
    let poses: Vec<Option<Pose>> = filmed.iter().map(|frame| frame.pose).collect();
    let fusion = fuse(
        &Optical { time_s: &optical_s, poses: &poses },
        &Inertial { time_s: &sensor_s, acc_m_s2: &acc, gyro_rad_s: &gyro },
        &FuseSettings { axes: Axes::ZUp, ..FuseSettings::default() },
    )
    .expect("a good take");
    let take = Take {
        frames: filmed
            .iter()
            .map(|frame| Seen { number: frame.number, exposure_s: frame.time_s, pose: frame.pose })
            .collect(),
        samples: (0..sensor_s.len()).map(|k| sample(k, sensor_s[k], gyro[k], acc[k])).collect(),
        coupling: coupling(&fusion, 1.0 / 240.0),
    };
    let expected = causal(&take);
    assert!(expected.len() > 5000, "{}", expected.len());
    for (what, frame_late, sample_late) in [
        ("as in a laboratory", (0.004, 0.006), (0.01, 0.045)),
        ("frames late", (0.03, 0.035), (0.0, 0.001)),
        ("frames out of their order", (0.004, 0.014), (0.0, 0.03)),
        ("samples very late", (0.0, 0.004), (0.5, 0.9)),
    ] {
        for seed in 0..3 {
            let found = live(&take, &arrivals(&take, seed, frame_late, sample_late));
            assert_same(&expected, &found, what);
        }
    }
    // the estimate with a delay does not depend on arrivals either
    let order = arrivals(&take, 1, (0.004, 0.006), (0.01, 0.045));
    let delayed = late(&take, &order, 2.0, 0);
    assert_eq!(delayed.len(), take.samples.len());
    let other = late(&take, &arrivals(&take, 2, (0.03, 0.035), (0.0, 0.001)), 2.0, 0);
    let from = delayed.partition_point(|late| late.frame.pose.is_none());
    assert!(from < 200 && delayed[from..] == other[from..]);
    recorded(&take, &order, &delayed);
    // what the delay of knowledge costs
    let hidden = || {
        let hidden = |time_s: f64| lost_s.iter().any(|(from, to)| (*from..*to).contains(&time_s));
        filmed.iter().enumerate().filter(move |(_, frame)| hidden(frame.time_s))
    };
    let truth = || hidden().map(|(_, frame)| (frame.time_s, frame.truth));
    let live_rms = errors(&moved_poses(&live(&take, &order)), truth());
    let late_rms = errors(&late_poses(&delayed), truth());
    let mut smoothed = Errors2::default();
    hidden().for_each(|(k, frame)| smoothed.add(&fusion.frames[k].pose.expect("filled"), &frame.truth));
    let smooth_rms = smoothed.rms();
    println!(
        "gaps of 1 s, RMS degrees and mm: live {live_rms:.3?}, 2 s later {late_rms:.3?}, smoother {smooth_rms:.3?}"
    );
    assert!(live_rms.0 < 0.3 && live_rms.1 < 30.0, "{live_rms:?}");
    assert!(
        late_rms.0 <= 1.5 * smooth_rms.0 && late_rms.1 <= 1.5 * smooth_rms.1,
        "{late_rms:?} {smooth_rms:?}"
    );
    assert!(motion.duration_s() > 45.0);
}

fn column(recording: &Recording, name: &str) -> Vec<f64> {
    let extra = recording.extra.iter().find(|extra| extra.name == name).expect("an optical column");
    extra.cells.iter().map(|cell| cell.parse().unwrap_or(f64::NAN)).collect()
}

#[test]
fn broad_as_live_streams_with_occlusions() {
    let root = std::env::var_os("SHISEI_DATA").map_or_else(
        || concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data").into(),
        std::path::PathBuf::from,
    );
    for name in ["06_undisturbed_fast_rotation_A", "16_undisturbed_fast_translation_B"] {
        let Ok(bytes) = std::fs::read(root.join("broad").join(name).with_extension("parquet")) else {
            eprintln!("skipped: BROAD trial {name} is absent (SHISEI_DATA)");
            continue;
        };
        let options = Options { keep: vec!["*".into()], ..Options::default() };
        let recording = open(&[Input { name: "trial.parquet", bytes: &bytes }], &options).expect("a trial");
        let q = ["opt_q_w", "opt_q_x", "opt_q_y", "opt_q_z"].map(|name| column(&recording, name));
        let p = ["opt_p_x", "opt_p_y", "opt_p_z"].map(|name| column(&recording, name));
        let truth: Vec<Option<Pose>> = (0..recording.len())
            .map(|k| {
                let position_m = [p[0][k], p[1][k], p[2][k]];
                let q = Quaternion::new(q[0][k], q[1][k], q[2][k], q[3][k]).try_normalized().ok()?;
                vector::is_finite(position_m).then_some(Pose { position_m, world_from_body: q })
            })
            .collect();
        let time_s = &recording.time_s;
        let step_s = (time_s[time_s.len() - 1] - time_s[0]) / (time_s.len() - 1) as f64;
        // a second in every five is hidden, from half a minute on
        let hidden = |k: usize| time_s[k] > 30.0 && time_s[k].rem_euclid(5.0) < 1.0;
        let poses: Vec<Option<Pose>> =
            truth.iter().enumerate().map(|(k, pose)| pose.filter(|_| !hidden(k))).collect();
        let fusion = fuse(
            &Optical { time_s, poses: &poses },
            &Inertial { time_s, acc_m_s2: &recording.acc_m_s2, gyro_rad_s: &recording.gyro_rad_s },
            &FuseSettings { axes: Axes::ZUp, ..FuseSettings::default() },
        )
        .expect("one object");
        let take = Take {
            frames: (0..recording.len())
                .map(|k| Seen { number: k as i64, exposure_s: time_s[k], pose: poses[k] })
                .collect(),
            samples: (0..recording.len())
                .map(|k| sample(k, time_s[k], recording.gyro_rad_s[k], recording.acc_m_s2[k]))
                .collect(),
            coupling: coupling(&fusion, step_s),
        };
        let most = take.samples.partition_point(|s| s.time_s < Some(240.0));
        let short = Take {
            frames: take.frames[..most].to_vec(),
            samples: take.samples[..most].to_vec(),
            coupling: take.coupling,
        };
        let order = arrivals(&short, 1, (0.004, 0.012), (0.01, 0.045));
        let found = live(&short, &order);
        assert_same(&causal(&short), &found, name);
        let known = |k: usize| Some((k, (time_s[k], truth[k]?)));
        let rows: Vec<(usize, (f64, Pose))> =
            (0..most - 10).filter(|k| hidden(*k)).filter_map(known).collect();
        assert!(rows.len() > 1000);
        let frames = || rows.iter().map(|(_, frame)| *frame);
        let live_rms = errors(&moved_poses(&found), frames());
        let mut smoothed = Errors2::default();
        for (k, (_, truth)) in &rows {
            smoothed.add(&fusion.frames[*k].pose.expect("filled"), truth);
        }
        let smooth_rms = smoothed.rms();
        println!("{name}, gaps of 1 s, RMS degrees and mm: live {live_rms:.2?}, smoother {smooth_rms:.2?}");
        // the smoother knows both ends: live is worse, and must still be a pose
        assert!(live_rms.0 < 1.0 && live_rms.1 < 100.0, "{live_rms:?}");
        for lag_s in [0.5, 1.0, 2.0] {
            // begun as a recording is: in the middle of things, here 20 s after the start
            let late = late(&short, &order, lag_s, order.len() / 12);
            let late_rms = errors(&late_poses(&late), frames());
            println!("  {lag_s} s later: {late_rms:.2?}");
            if lag_s >= 2.0 {
                let well = late_rms.0 <= 1.5 * smooth_rms.0 && late_rms.1 <= 1.5 * smooth_rms.1;
                assert!(well, "{lag_s} s: {late_rms:?}, smoother {smooth_rms:?}");
            }
        }
    }
}
