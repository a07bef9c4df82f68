//! A take of which the beginning was not seen by the cameras, against the simulator's truth.

use shisei_core::estimator::{BridgeSettings, OpticalPose, Settings, bridge};
use shisei_core::filter::Dt;
use shisei_core::{Quaternion, math, vector};
use shisei_twin::simulate::{self, Errors, simulate};
use shisei_twin::{Motion as _, Sensor, movements};

const RATE_HZ: f64 = 120.0;

/// RMS attitude error, degrees, before the first pose and within 2 s after it; the heading's error halfway to it, as a
/// multiple of what was stated. The optical world is turned by `yaw_deg` against the sensor's first heading.
fn errors(seed: u64, unseen_s: f64, yaw_deg: f64) -> [f64; 3] {
    let motion = movements::wander(seed, 4.0, 40.0);
    let settings =
        simulate::Settings { errors: Errors::DrawnAligned, ..simulate::Settings::new(RATE_HZ, seed) };
    let simulation = simulate(&motion, &Sensor::lsm6ds3tr_c(), &settings);
    let (time_s, acc, gyro) = (simulation.time_s(), simulation.acc_m_s2(), simulation.gyro_rad_s());
    let start_rad = motion.state(time_s[0]).world_from_body.to_ypr().yaw_rad;
    let turn = Quaternion::from_rotation_vector([0.0, 0.0, yaw_deg.to_radians() - start_rad]);
    let pose = |t: &f64| {
        let state = motion.state(*t);
        let world_from_body = turn.product(state.world_from_body).normalized();
        OpticalPose { world_from_body, position_m: turn.rotate(state.position_m) }
    };
    let truth: Vec<OpticalPose> = time_s.iter().map(pose).collect();
    let poses: Vec<Option<OpticalPose>> =
        truth.iter().zip(&time_s).map(|(pose, &t)| (t >= unseen_s).then_some(*pose)).collect();
    let optics = BridgeSettings { lever_m: 0.005, ..BridgeSettings::default() };
    let dt = Dt::Constant(1.0 / RATE_HZ);
    let (found, _) = bridge(&acc, &gyro, dt, &poses, &optics, &Settings::default()).expect("it is sound");
    let first = poses.iter().position(Option::is_some).expect("it is seen");
    let rms_deg = |rows: std::ops::Range<usize>| {
        let count = rows.len() as f64;
        let square = |k: usize| {
            let off = found[k].state.world_from_body.conjugate().product(truth[k].world_from_body);
            let deg = off.angle().to_degrees();
            deg * deg
        };
        (rows.map(square).sum::<f64>() / count).sqrt()
    };
    for (bridged, pose) in found.iter().zip(&truth).skip(first) {
        let off_m = vector::norm(vector::sub(bridged.position_m, pose.position_m));
        assert!(off_m < 0.002, "seed {seed}, {unseen_s} s, {yaw_deg} degrees: {off_m} m where it is seen");
    }
    let halfway = &found[first / 2].state;
    let off = halfway.world_from_body.product(truth[first / 2].world_from_body.conjugate());
    let heading_rad = 2.0 * math::atan2(off.z, off.w);
    let turns = (heading_rad / std::f64::consts::TAU).round();
    let sigmas = (heading_rad - turns * std::f64::consts::TAU) / halfway.sigma_heading_rad;
    [rms_deg(0..first), rms_deg(first..first + 2 * RATE_HZ as usize), sigmas]
}

#[test]
fn where_the_cameras_x_axis_points_is_no_matter() {
    for unseen_s in [3.0, 10.0] {
        for seed in [1, 2, 3] {
            let expected = errors(seed, unseen_s, 0.0);
            println!("seed {seed}, {unseen_s} s unseen: {expected:.3?}");
            let [unseen, seen, sigmas] = expected;
            assert!(unseen < 1.0 && seen < 1.0 && sigmas.abs() < 5.0, "{expected:?}");
            for yaw_deg in [30.0, 180.0] {
                let found = errors(seed, unseen_s, yaw_deg);
                let same = found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-3);
                assert!(same, "{found:?} {expected:?}");
            }
        }
    }
}
