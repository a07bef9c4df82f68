//! Clocks, mounting and lever arm of a simulated sensor that cameras film.

use shisei_core::frames::Pose;
use shisei_core::sync::gyro_path::Stamp;
use shisei_core::sync::lever::lever_arm;
use shisei_core::sync::rates::{RatesSettings, Start, Sync, synchronise};
use shisei_core::{Error, Quaternion, Result, Vec3, vector};
use shisei_twin::optics::{Cameras, Frame, Rig, film};
use shisei_twin::simulate::{Errors, Settings, simulate};
use shisei_twin::{Motion, Random, Sensor, Simulation, movements};

const DEG: f64 = core::f64::consts::PI / 180.0;

fn rig(seed: u64) -> Rig {
    let mut random = Random::new(seed, 9);
    let turn = vector::scale(random.direction(), random.between(0.0, 3.1));
    Rig {
        body_from_sensor: Quaternion::from_rotation_vector(turn),
        sensor_m: [0.03, -0.02, 0.05],
        markers_m: Vec::new(),
    }
}

/// The simulator reads rates at an instant.
fn instant() -> RatesSettings {
    RatesSettings { stamp: Stamp::Instant, ..RatesSettings::default() }
}

/// 40 s of movement, read at 100 Hz with 2 % lost, by a sensor with bias, scales, misalignment and noise.
fn recording(seed: u64) -> (impl Motion, Simulation) {
    let motion = movements::wander(seed, 4.0, 32.0);
    let settings = Settings { lost: 0.02, errors: Errors::DrawnAligned, ..Settings::new(100.0, seed) };
    let simulation = simulate(&motion, &Sensor::lsm6ds3tr_c(), &settings);
    (motion, simulation)
}

/// 30 s at 120 Hz, lost now and then.
fn cameras(seed: u64) -> Cameras {
    let mut random = Random::new(seed, 10);
    Cameras {
        offset_s: random.between(1.0, 8.0),
        skew: random.between(-1e-4, 1e-4),
        lost: 0.02,
        lost_s: vec![(8.0, 9.5), (20.0, 20.4)],
        ..Cameras::new(120.0, 30.0, seed)
    }
}

fn find(frames: &[Frame], simulation: &Simulation, settings: &RatesSettings) -> Result<Sync> {
    let time_s: Vec<f64> = frames.iter().map(|frame| frame.time_s).collect();
    let attitude: Vec<Option<Quaternion>> =
        frames.iter().map(|frame| frame.pose.map(|pose| pose.world_from_body)).collect();
    synchronise(&time_s, &attitude, &simulation.time_s(), &simulation.gyro_rad_s(), settings)
}

/// Offset within 0.5 ms, skew within 2 ppm, mounting within 0.3°; and the errors are as large as it says.
#[test]
fn clocks_and_mounting_of_simulated_takes() {
    let (mut offsets, mut skews, mut turns) = (0.0, 0.0, 0.0);
    let seeds = 1..=8;
    let count = seeds.clone().count() as f64;
    for seed in seeds {
        let (motion, simulation) = recording(seed);
        let (rig, cameras) = (rig(seed), cameras(seed));
        let frames = film(&motion, &rig, &cameras);
        let sync = find(&frames, &simulation, &instant()).expect("common motion");
        let at = sync.middle_s;
        let offset = sync.sensor_time_s(at) - cameras.motion_time_s(at);
        let skew = sync.skew - cameras.skew;
        let turned = sync.body_from_sensor.conjugate().product(rig.body_from_sensor).angle();
        println!(
            "{seed}: offset {:.1} ± {:.1} µs, skew {:.2} ± {:.2} ppm, mounting {:.4} ± {:.4}°, explained {:.5}",
            offset * 1e6,
            sync.sigma_offset_s * 1e6,
            skew * 1e6,
            sync.sigma_skew * 1e6,
            turned / DEG,
            vector::norm(sync.sigma_mounting_rad) / DEG,
            sync.explained
        );
        assert!((sync.offset_s - cameras.offset_s).abs() < 5e-4 && offset.abs() < 5e-4, "{sync:?}");
        assert!(skew.abs() < 2e-6, "{sync:?}");
        assert!(turned < 0.3 * DEG, "{sync:?}");
        assert!(sync.explained > 0.99 && sync.axis_ratio > 0.3, "{sync:?}");
        offsets += (offset / sync.sigma_offset_s) * (offset / sync.sigma_offset_s) / count;
        skews += (skew / sync.sigma_skew) * (skew / sync.sigma_skew) / count;
        turns += turned / vector::norm(sync.sigma_mounting_rad) / count;
    }
    // mean squares of eight normal deviates are in 0.17 … 2.9 but for one in a hundred
    println!("in deviations: offset² {offsets:.2}, skew² {skews:.2}, mounting {turns:.2}");
    assert!((0.1..4.0).contains(&offsets) && (0.1..4.0).contains(&skews), "{offsets} {skews}");
    assert!((0.2..3.0).contains(&turns), "{turns}");
}

#[test]
fn a_clock_that_runs_far_off_is_found() {
    let (motion, simulation) = recording(3);
    let cameras = Cameras { skew: 0.01, ..cameras(3) };
    let frames = film(&motion, &rig(3), &cameras);
    let sync = find(&frames, &simulation, &instant()).expect("common motion");
    assert!((sync.skew - 0.01).abs() < 2e-6, "{sync:?}");
    assert!((sync.offset_s - cameras.offset_s).abs() < 5e-4);
}

#[test]
fn a_known_start_is_refined() {
    let (motion, simulation) = recording(3);
    let cameras = cameras(3);
    let frames = film(&motion, &rig(3), &cameras);
    let near = RatesSettings { start: Start::Near(cameras.offset_s + 0.04), ..instant() };
    let sync = find(&frames, &simulation, &near).expect("common motion");
    assert!((sync.offset_s - cameras.offset_s).abs() < 5e-4, "{sync:?}");
}

/// Taken for the mean of the step before it, a reading comes half a step too late.
#[test]
fn a_stamp_at_the_end_of_the_step_moves_the_offset_by_half_a_step() {
    let (motion, simulation) = recording(3);
    let cameras = cameras(3);
    let frames = film(&motion, &rig(3), &cameras);
    let sync = find(&frames, &simulation, &RatesSettings::default()).expect("common motion");
    assert!((sync.offset_s + 0.005 - cameras.offset_s).abs() < 5e-4, "{sync:?}");
    assert!((sync.skew - cameras.skew).abs() < 2e-6, "{sync:?}");
}

#[test]
fn strangers_are_refused() {
    let (_, simulation) = recording(1);
    let (other, _) = recording(2);
    let frames = film(&other, &rig(1), &cameras(1));
    let error = find(&frames, &simulation, &instant()).expect_err("two objects");
    assert!(matches!(error, Error::NoCommonMotion { explained } if explained < 0.8), "{error}");
    // still cameras: noise only
    let still = shisei_twin::Path::still(40.0);
    let frames = film(&still, &rig(1), &cameras(1));
    let error = find(&frames, &simulation, &instant()).expect_err("no motion");
    assert!(matches!(error, Error::NoCommonMotion { .. }), "{error}");
}

#[test]
fn motion_about_one_axis_is_refused() {
    let mut motion = movements::wander(5, 4.0, 32.0);
    motion.turns.truncate(1);
    let settings = Settings { errors: Errors::DrawnAligned, ..Settings::new(100.0, 5) };
    let simulation = simulate(&motion, &Sensor::lsm6ds3tr_c(), &settings);
    let frames = film(&motion, &rig(5), &cameras(5));
    let error = find(&frames, &simulation, &instant()).expect_err("one axis");
    assert!(matches!(error, Error::OneAxisOnly { ratio } if ratio < 0.05), "{error}");
}

#[test]
fn too_little_is_refused() {
    let (motion, simulation) = recording(1);
    let mut frames = film(&motion, &rig(1), &cameras(1));
    frames.truncate(40);
    let error = find(&frames, &simulation, &instant()).expect_err("too few");
    assert!(matches!(error, Error::TooFewPoints { .. }), "{error}");
}

#[test]
fn the_lever_arm_and_up_are_found() {
    for seed in 1..=4 {
        let (motion, simulation) = recording(seed);
        let (rig, cameras) = (rig(seed), cameras(seed));
        let frames = film(&motion, &rig, &cameras);
        let optical_s: Vec<f64> = frames.iter().map(|frame| frame.time_s).collect();
        // y up, as a lab has it
        let turn = Quaternion::from_rotation_vector([-90.0 * DEG, 0.0, 0.0]);
        let poses: Vec<Option<Pose>> = frames
            .iter()
            .map(|frame| {
                frame.pose.map(|pose| Pose {
                    position_m: turn.rotate(pose.position_m),
                    world_from_body: turn.product(pose.world_from_body),
                })
            })
            .collect();
        let sensor_s: Vec<f64> =
            simulation.time_s().iter().map(|time| (time - cameras.offset_s) / (1.0 + cameras.skew)).collect();
        let found =
            lever_arm(&optical_s, &poses, &sensor_s, &simulation.acc_m_s2(), rig.body_from_sensor, 9.80665)
                .expect("enough");
        let apart = vector::norm(vector::sub(found.sensor_m, rig.sensor_m));
        println!("{seed}: {:.2} mm ± {:?} {found:?}", apart * 1e3, found.sigma_m);
        assert!(apart < 0.004, "{found:?}");
        assert!(
            vector::norm(found.sigma_m) < 0.004 && apart < 4.0 * vector::norm(found.sigma_m),
            "{found:?}"
        );
        let lean = vector::norm(vector::cross(found.up, [0.0, 1.0, 0.0]));
        assert!(lean < 1.0 * DEG && found.up[1] > 0.0, "{found:?}");
        assert!((found.gravity_m_s2 - 9.80665).abs() < 0.2, "{found:?}");
    }
    let nothing: [Vec3; 0] = [];
    assert!(lever_arm(&[], &[], &[], &nothing, Quaternion::IDENTITY, 9.8).is_err());
}
