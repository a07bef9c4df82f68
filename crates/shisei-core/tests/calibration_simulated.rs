//! Stated errors of the calibrations against simulated truth.

#![allow(clippy::disallowed_methods)] // the truth of a simulation may use std's mathematics

mod support;

use shisei_core::calibration::SensorModel;
use shisei_core::calibration::gyro_turns::{self, TurnSettings};
use shisei_core::calibration::known_turns::{self, Part, Parts, TurnAngle};
use shisei_core::calibration::multi_pose::{self, PARAMETERS, Pose, SigmaSource};
use shisei_core::calibration::recording::find_parts;
use shisei_core::calibration::still::{StillSegment, StillSettings, still_segments};
use shisei_core::{Error, Quaternion, STANDARD_GRAVITY_M_S2 as G, Vec3};
use support::Random;

const TRUTH: SensorModel = SensorModel {
    bias: [0.2, -0.15, 0.3],
    matrix: [[1.01, 0.004, -0.006], [0.0, 0.99, 0.003], [0.0, 0.0, 1.005]],
};

fn poses(random: &mut Random, count: usize, sigma: f64) -> Vec<Pose> {
    (0..count)
        .map(|_| {
            let up = random.direction();
            let raw = TRUTH.unapply([G * up[0], G * up[1], G * up[2]]).unwrap();
            let n = random.normal3(sigma);
            Pose { mean: [raw[0] + n[0], raw[1] + n[1], raw[2] + n[2]], mean_variance: sigma * sigma }
        })
        .collect()
}

fn truth() -> [f64; PARAMETERS] {
    let m = TRUTH.matrix;
    let b = TRUTH.bias;
    [b[0], b[1], b[2], m[0][0], m[0][1], m[0][2], m[1][1], m[1][2], m[2][2]]
}

fn parameters(a: &SensorModel) -> [f64; PARAMETERS] {
    let (m, b) = (a.matrix, a.bias);
    [b[0], b[1], b[2], m[0][0], m[0][1], m[0][2], m[1][1], m[1][2], m[2][2]]
}

#[test]
fn exact_readings_give_the_exact_calibration() {
    let found = multi_pose::calibrate(&poses(&mut Random(1), 15, 0.0), G).unwrap();
    for (a, b) in parameters(&found.accelerometer).iter().zip(truth()) {
        assert!((a - b).abs() < 1e-9, "{found:?}");
    }
}

#[test]
fn one_sigma_covers_sixty_eight_percent() {
    let mut random = Random(7);
    for count in [9, 14, 30] {
        let (mut inside, mut total) = (0.0, 0.0);
        for _ in 0..400 {
            let Ok(found) = multi_pose::calibrate(&poses(&mut random, count, 0.003), G) else { continue };
            assert_eq!(found.sigma_source == SigmaSource::MeanNoise, count == 9);
            let p = parameters(&found.accelerometer);
            for i in 0..PARAMETERS {
                total += 1.0;
                inside += f64::from((p[i] - truth()[i]).abs() < found.sigma[i]);
            }
        }
        println!("{count} poses: {:.1} % of {total}", 100.0 * inside / total);
        assert!((0.60..0.76).contains(&(inside / total)), "{count} {}", inside / total);
    }
}

#[test]
fn a_suggested_pose_beats_a_random_one() {
    let mut random = Random(3);
    // upper half only: the suggestions must look below
    let mut upper = poses(&mut random, 40, 0.003);
    upper.retain(|p| p.mean[2] > 1.0);
    let found = multi_pose::calibrate(&upper, G).unwrap();
    let suggestion = found.suggest(1)[0];
    assert!(suggestion.up_body[2] < -0.5, "{suggestion:?}");
    assert!(suggestion.worst_sigma_after < 0.5 * suggestion.sigma_now);
}

#[test]
fn poses_that_do_not_suffice_are_refused() {
    let mut random = Random(5);
    let eight = poses(&mut random, 8, 0.003);
    assert_eq!(multi_pose::calibrate(&eight, G).unwrap_err(), Error::TooFewPoints { given: 8, needed: 9 });
    let same: Vec<Pose> = (0..12).map(|_| eight[0]).collect();
    assert!(multi_pose::calibrate(&same, G).is_err());
    // all in one plane
    let flat: Vec<Pose> = (0..24)
        .map(|i| {
            let (s, c) = (f64::from(i) * 0.26).sin_cos();
            Pose { mean: [G * c, G * s, 0.001 * random.normal()], mean_variance: 1e-6 }
        })
        .collect();
    assert!(multi_pose::calibrate(&flat, G).is_err());
    let mut hole = poses(&mut random, 12, 0.003);
    hole[4].mean[1] = f64::NAN;
    assert_eq!(multi_pose::calibrate(&hole, G).unwrap_err(), Error::NotFinite { row: 4 });
}

/// Rests and turns: raw gyro rows and segments, noise of the raw gyro in rad/s.
fn turns(
    random: &mut Random,
    truth: &SensorModel,
    count: usize,
    noise: f64,
) -> (Vec<Vec3>, Vec<StillSegment>) {
    let dt = 0.01;
    let mut q = Quaternion::IDENTITY;
    let (mut gyro, mut segments) = (Vec::new(), Vec::new());
    for _ in 0..=count {
        let start = gyro.len();
        for _ in 0..200 {
            let n = random.normal3(noise);
            let raw = truth.unapply([0.0; 3]).unwrap();
            gyro.push([raw[0] + n[0], raw[1] + n[1], raw[2] + n[2]]);
        }
        let mut segment = StillSegment::of(&[], &gyro, start, gyro.len());
        let up = q.up_body();
        let a = random.normal3(0.002);
        segment.acc_mean = [G * up[0] + a[0], G * up[1] + a[1], G * up[2] + a[2]];
        segments.push(segment);
        let (axis, angle) = (random.direction(), 1.0 + 1.5 * random.uniform());
        for k in 0..150 {
            let shape = (core::f64::consts::PI * (f64::from(k) + 0.5) / 150.0).sin();
            let speed = angle * shape * core::f64::consts::PI / 300.0 / dt;
            let rate = [axis[0] * speed, axis[1] * speed, axis[2] * speed];
            let raw = truth.unapply(rate).unwrap();
            let n = random.normal3(noise);
            gyro.push([raw[0] + n[0], raw[1] + n[1], raw[2] + n[2]]);
            q = q.product(Quaternion::from_rotation_vector([rate[0] * dt, rate[1] * dt, rate[2] * dt]));
        }
    }
    (gyro, segments)
}

#[test]
fn gyroscope_from_turns_with_right_errors() {
    let mut random = Random(11);
    let degree = core::f64::consts::PI / 180.0;
    for unit in [1.0, degree / 131.0] {
        let truth = SensorModel {
            bias: [0.01 / unit, -0.02 / unit, 0.03 / unit],
            matrix: [[1.02, 0.01, -0.004], [-0.006, 0.985, 0.003], [0.008, -0.002, 1.01]]
                .map(|r| r.map(|v| v * unit)),
        };
        let (mut inside, mut total) = (0.0, 0.0);
        for _ in 0..60 {
            let (gyro, segments) = turns(&mut random, &truth, 20, 0.002 / unit);
            let found = gyro_turns::calibrate(
                &gyro,
                0.01,
                &segments,
                &SensorModel::IDENTITY,
                &TurnSettings::default(),
            )
            .unwrap();
            for i in 0..9 {
                let error = found.gyroscope.matrix[i / 3][i % 3] - truth.matrix[i / 3][i % 3];
                assert!(error.abs() < 0.005 * unit);
                total += 1.0;
                inside += f64::from(error.abs() < found.sigma[i]);
            }
        }
        println!("gyro turns: {:.1} % of {total}", 100.0 * inside / total);
        assert!((0.60..0.76).contains(&(inside / total)), "{}", inside / total);
    }
}

/// Six faces, 2 s each, and on the three upper ones a turn of 360° in 3 s; raw counts.
#[test]
fn known_turns_are_found_without_labels() {
    let mut random = Random(21);
    let acc_truth = SensorModel {
        bias: [20.0, -50.0, 30.0],
        matrix: [[1.01, 0.01, -0.02], [0.02, 0.98, 0.01], [0.0, 0.01, 1.0]]
            .map(|r| r.map(|v| v * G / 2048.0)),
    };
    let scale = core::f64::consts::PI / 180.0 / 16.4;
    let gyro_truth = SensorModel {
        bias: [5.0, -8.0, 3.0],
        matrix: [[1.02, 0.01, 0.0], [-0.01, 0.99, 0.02], [0.01, 0.0, 1.01]].map(|r| r.map(|v| v * scale)),
    };
    let (mut acc, mut gyro) = (Vec::new(), Vec::new());
    let mut push = |a: Vec3, w: Vec3| {
        let (x, y) = (acc_truth.unapply(a).unwrap(), gyro_truth.unapply(w).unwrap());
        let (n, m) = (random.normal3(3.0), random.normal3(1.0));
        acc.push([x[0] + n[0], x[1] + n[1], x[2] + n[2]]);
        gyro.push([y[0] + m[0], y[1] + m[1], y[2] + m[2]]);
    };
    for axis in 0..3 {
        for sign in [1.0, -1.0] {
            let mut up = [0.0; 3];
            up[axis] = sign * G;
            let turn = if sign > 0.0 { 300 } else { 0 };
            for k in 0..200 + turn + if turn > 0 { 200 } else { 0 } {
                let mut rate = [0.0; 3];
                if turn > 0 && (200..500).contains(&k) {
                    // one whole period of 1 − cos: starts and ends at rest
                    let phase = core::f64::consts::TAU * (f64::from(k - 200) + 0.5) / 300.0;
                    rate[axis] = -core::f64::consts::TAU / 3.0 * (1.0 - phase.cos());
                }
                push(up, rate);
            }
            for k in 0..100 {
                // on to the next face: tumbling, nothing the search may take for a rest
                let t = f64::from(k) * 0.3;
                push([G * t.sin(), G * t.cos(), 3.0 * (2.0 * t).sin()], [t.sin(), 2.0 * t.cos(), -t.sin()]);
            }
        }
    }
    let segments = still_segments(&acc, &gyro, 0.01, &StillSettings::default()).unwrap();
    let parts = find_parts(&acc, &gyro, &segments).unwrap();
    let found = known_turns::calibrate(&parts, 0.01, TurnAngle::Size(core::f64::consts::TAU), G).unwrap();
    for i in 0..3 {
        assert!((found.accelerometer.bias[i] - acc_truth.bias[i]).abs() < 2.0);
        assert!((found.gyroscope.bias[i] - gyro_truth.bias[i]).abs() < 0.5);
        for j in 0..3 {
            let (a, g) = (found.accelerometer.matrix[i][j], found.gyroscope.matrix[i][j]);
            assert!((a - acc_truth.matrix[i][j]).abs() < 0.002 * G / 2048.0, "{i} {j} {a}");
            assert!((g - gyro_truth.matrix[i][j]).abs() < 0.003 * scale, "{i} {j} {g}");
        }
    }
    // without one of the turns it is refused
    let some: Vec<StillSegment> = segments.iter().copied().filter(|s| s.acc_mean[2] < 1000.0).collect();
    assert!(find_parts(&acc, &gyro, &some).is_err());
}

#[test]
fn known_turns_state_their_errors_rightly() {
    let mut random = Random(33);
    let acc_truth = SensorModel {
        bias: [20.0, -50.0, 30.0],
        matrix: [[1.01, 0.01, -0.02], [0.02, 0.98, 0.01], [0.0, 0.01, 1.0]]
            .map(|r| r.map(|v| v * G / 2048.0)),
    };
    let scale = core::f64::consts::PI / 180.0 / 16.4;
    let gyro_truth = SensorModel {
        bias: [5.0, -8.0, 3.0],
        matrix: [[1.02, 0.01, 0.0], [-0.01, 0.99, 0.02], [0.01, 0.0, 1.01]].map(|r| r.map(|v| v * scale)),
    };
    let (mut acc_inside, mut gyro_inside, mut total) = (0.0, 0.0, 0.0);
    for _ in 0..80 {
        // nine parts: axis up, axis down, a turn of 360° about the axis pointing up
        let mut parts: Vec<(Vec<Vec3>, Vec<Vec3>)> = Vec::new();
        for kind in 0..3 {
            for axis in 0..3 {
                let mut up = [0.0; 3];
                up[axis] = if kind == 1 { -G } else { G };
                let rows = if kind == 2 { 150 } else { 60 + 30 * axis };
                let (mut acc, mut gyro) = (Vec::new(), Vec::new());
                for k in 0..rows {
                    let mut rate = [0.0; 3];
                    if kind == 2 {
                        let phase = core::f64::consts::TAU * (k as f64 + 0.5) / 150.0;
                        rate[axis] = core::f64::consts::TAU / 1.5 * (1.0 - phase.cos());
                    }
                    let (x, y) = (acc_truth.unapply(up).unwrap(), gyro_truth.unapply(rate).unwrap());
                    let (n, m) = (random.normal3(5.0), random.normal3(4.0));
                    acc.push([x[0] + n[0], x[1] + n[1], x[2] + n[2]]);
                    gyro.push([y[0] + m[0], y[1] + m[1], y[2] + m[2]]);
                }
                parts.push((acc, gyro));
            }
        }
        let part = |k: usize| Part { acc: &parts[k].0, gyro: &parts[k].1 };
        let parts = Parts {
            up: [part(0), part(1), part(2)],
            down: [part(3), part(4), part(5)],
            turn: [part(6), part(7), part(8)],
        };
        let angle = TurnAngle::Signed(core::f64::consts::TAU);
        let found = known_turns::calibrate(&parts, 0.01, angle, G).unwrap();
        for i in 0..3 {
            for j in 0..3 {
                total += 1.0;
                let error = found.gyroscope.matrix[i][j] - gyro_truth.matrix[i][j];
                gyro_inside += f64::from(error.abs() < found.gyro_matrix_sigma[i][j]);
                let error = found.accelerometer.matrix[i][j] - acc_truth.matrix[i][j];
                acc_inside += f64::from(error.abs() < found.acc_matrix_sigma[i][j]);
            }
        }
    }
    let (acc, gyro) = (acc_inside / total, gyro_inside / total);
    println!("known turns: gyroscope {:.1} %, accelerometer {:.1} % of {total}", 100.0 * gyro, 100.0 * acc);
    assert!((0.60..0.76).contains(&gyro) && (0.60..0.76).contains(&acc), "{gyro} {acc}");
}
