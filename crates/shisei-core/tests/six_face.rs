//! Six-face calibration against made-up sensors whose truth is known.
#![cfg(feature = "alloc")]
#![allow(clippy::disallowed_methods)] // the references here use the platform's mathematics on purpose

use shisei_core::calibration::{FaceState, SixFaceSettings, search_faces, six_face, solve};
use shisei_core::{Error, Face, Kind, Vec3};

struct Noise(u64);

impl Noise {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        let mut x = self.0;
        x ^= x >> 33;
        x = x.wrapping_mul(0xff51_afd7_ed55_8ccd);
        x ^= x >> 33;
        (x >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Sum of twelve uniforms: mean 0, variance 1.
    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }
}

const BIAS: Vec3 = [-0.03, 0.12, 0.2];
const SCALE: Vec3 = [0.99, 1.02, 1.005];
const GYRO_BIAS: Vec3 = [0.01, -0.02, 0.005];
const GRAVITY: f64 = 9.80665;

/// Faces in an unusual order, each five seconds at 100 Hz, tilted a few degrees, turned over between.
fn recording(seed: u64, faces: &[Face], sigma: f64) -> (Vec<Vec3>, Vec<Vec3>) {
    let mut noise = Noise(seed);
    let (mut acc, mut gyro) = (Vec::new(), Vec::new());
    for face in faces {
        let mut direction = face.unit();
        for axis in 0..3 {
            direction[axis] += 0.1 * (noise.uniform() - 0.5);
        }
        let norm = shisei_core::vector::norm(direction);
        for k in 0..650 {
            let shake = if k < 500 { 0.0 } else { 5.0 };
            let mut a = [0.0; 3];
            let mut g = [0.0; 3];
            for axis in 0..3 {
                let truth = direction[axis] / norm * GRAVITY;
                a[axis] = truth / SCALE[axis] + BIAS[axis] + (sigma + shake) * noise.normal();
                g[axis] = GYRO_BIAS[axis] + (0.02 + shake) * noise.normal();
            }
            acc.push(a);
            gyro.push(g);
        }
    }
    (acc, gyro)
}

#[test]
fn the_truth_lies_within_the_predicted_uncertainty() {
    let settings = SixFaceSettings::default();
    let (mut within_one, mut within_three, mut all) = (0, 0, 0);
    for seed in 1..=200 {
        let (acc, gyro) = recording(seed, &Face::ALL, 0.05);
        let found = six_face(&acc, &gyro, 0.01, &settings).unwrap();
        let scale = found.calibration.accelerometer.scale();
        let mut check = |error: f64, variance: f64| {
            all += 1;
            within_one += i32::from(error.abs() <= variance.sqrt());
            within_three += i32::from(error.abs() <= 3.0 * variance.sqrt());
        };
        for axis in 0..3 {
            check(found.calibration.accelerometer.bias[axis] - BIAS[axis], found.acc_covariance[axis][axis]);
            check(scale[axis] - SCALE[axis], found.acc_covariance[3 + axis][3 + axis]);
            check(found.calibration.gyroscope.bias[axis] - GYRO_BIAS[axis], found.gyro_bias_variance[axis]);
        }
    }
    let (one, three) = (f64::from(within_one) / f64::from(all), f64::from(within_three) / f64::from(all));
    assert!((0.60..=0.76).contains(&one), "{one} within one sigma");
    assert!(three >= 0.99, "{three} within three sigma");
}

#[test]
fn without_noise_the_truth_comes_out() {
    let (acc, gyro) = recording(7, &Face::ALL, 0.0);
    let found = six_face(&acc, &gyro, 0.01, &SixFaceSettings::default()).unwrap();
    let scale = found.calibration.accelerometer.scale();
    for axis in 0..3 {
        assert!((found.calibration.accelerometer.bias[axis] - BIAS[axis]).abs() < 1e-12);
        assert!((scale[axis] - SCALE[axis]).abs() < 1e-13);
    }
}

/// Two passes over every window, as the text has it.
fn steadiest_by_hand(
    acc: &[Vec3],
    rows: usize,
    step: usize,
    settings: &SixFaceSettings,
) -> [Option<usize>; 6] {
    let mut best = [None; 6];
    let mut smallest = [f64::INFINITY; 6];
    let mut start = 0;
    while start + rows <= acc.len() {
        let window = &acc[start..start + rows];
        let mean: Vec<f64> =
            (0..3).map(|axis| window.iter().map(|a| a[axis]).sum::<f64>() / rows as f64).collect();
        let variance: Vec<f64> = (0..3)
            .map(|axis| window.iter().map(|a| (a[axis] - mean[axis]).powi(2)).sum::<f64>() / rows as f64)
            .collect();
        let norm = mean.iter().map(|m| m * m).sum::<f64>().sqrt();
        for (k, face) in Face::ALL.iter().enumerate() {
            let unit = face.unit();
            let cos = (0..3).map(|axis| unit[axis] * mean[axis]).sum::<f64>() / norm;
            let sum: f64 = variance.iter().sum();
            let stable = variance.iter().all(|&v| v <= settings.variance_max);
            if cos >= settings.max_tilt_rad.cos() && stable && sum < smallest[k] {
                smallest[k] = sum;
                best[k] = Some(start);
            }
        }
        start += step;
    }
    best
}

#[test]
fn the_search_keeps_the_steadiest_windows() {
    for (window_s, step_s) in [(3.0, 0.1), (1.0, 0.37), (2.0, 2.5), (0.01, 0.01)] {
        let (acc, gyro) = recording(3, &Face::ALL, 0.05);
        let settings = SixFaceSettings { window_s, step_s, ..SixFaceSettings::default() };
        let rows = (window_s * 100.0_f64).round() as usize;
        let step = (step_s * 100.0_f64).round() as usize;
        let expected = steadiest_by_hand(&acc, rows, step, &settings);
        let table = search_faces(&acc, &gyro, 0.01, &settings).unwrap();
        for (row, expected) in table.faces.iter().zip(expected) {
            assert_eq!(row.window.filter(|_| row.state == FaceState::Found).map(|w| w.start_row), expected);
        }
    }
}

#[test]
fn a_missing_face_is_named_and_its_best_candidate_shown() {
    let settings = SixFaceSettings::default();
    let (acc, gyro) = recording(1, &Face::ALL[..5], 0.05);
    let table = search_faces(&acc, &gyro, 0.01, &settings).unwrap();
    assert_eq!(table.faces[5].state, FaceState::NeverUp);
    assert_eq!(solve(&table, &settings), Err(Error::FaceMissing { face: Face::ALL[5] }));
    assert_eq!(solve(&table, &settings).unwrap_err().kind(), Kind::Condition);

    // all six, but −z shaken all the time
    let (mut acc, mut gyro) = recording(1, &Face::ALL[..5], 0.05);
    let (shaken, rates) = recording(2, &Face::ALL[5..], 0.3);
    acc.extend_from_slice(&shaken[..500]);
    gyro.extend_from_slice(&rates[..500]);
    let table = search_faces(&acc, &gyro, 0.01, &settings).unwrap();
    let row = table.faces[5];
    assert_eq!(row.state, FaceState::Unsteady);
    let variance = row.window.unwrap().worst_variance();
    assert!((0.05..0.15).contains(&variance), "{variance}");

    // −z up, but tilted by 30° from it
    let (mut acc, mut gyro) = recording(1, &Face::ALL[..5], 0.05);
    acc.extend(std::iter::repeat_n([GRAVITY * 0.5, 0.0, -GRAVITY * 0.8660254], 400));
    gyro.extend(std::iter::repeat_n([0.0; 3], 400));
    let table = search_faces(&acc, &gyro, 0.01, &settings).unwrap();
    assert_eq!(table.faces[5].state, FaceState::Tilted);
    assert!((table.faces[5].window.unwrap().tilt_rad.to_degrees() - 30.0).abs() < 1e-6);
}

#[test]
fn wrong_units_and_hostile_numbers_are_refused() {
    let settings = SixFaceSettings::default();
    let (acc, gyro) = recording(1, &Face::ALL, 0.01);
    let in_g: Vec<Vec3> = acc.iter().map(|&a| shisei_core::vector::scale(a, 1.0 / GRAVITY)).collect();
    assert!(matches!(six_face(&in_g, &gyro, 0.01, &settings), Err(Error::ScaleOutOfBounds { .. })));
    assert!(matches!(six_face(&acc, &gyro[1..], 0.01, &settings), Err(Error::LengthMismatch { .. })));
    assert!(matches!(six_face(&[], &[], 0.01, &settings), Err(Error::Empty)));
    assert!(matches!(six_face(&acc, &gyro, 0.0, &settings), Err(Error::NotPositive { .. })));
    assert!(matches!(six_face(&acc, &gyro, 1e-300, &settings), Err(Error::FaceMissing { .. })));
    let mut bad = acc.clone();
    bad[77][1] = f64::NAN;
    assert_eq!(six_face(&bad, &gyro, 0.01, &settings), Err(Error::NotFinite { row: 77 }));
    let huge: Vec<Vec3> = acc.iter().map(|&a| shisei_core::vector::scale(a, 1e200)).collect();
    assert!(six_face(&huge, &gyro, 0.01, &settings).is_err());
}
