//! Six-face calibration against the truth, and whether its own uncertainty tells the truth.

use core::f64::consts::PI;

use shisei_core::Vec3;
use shisei_core::calibration::{SixFace, SixFaceSettings, six_face};
use shisei_core::math::sqrt;
use shisei_twin::{Errors, Path, Random, Sensor, Settings, Simulation, movements, recordings, simulate};

const RATE_HZ: f64 = 100.0;

/// Six rests of 5 s, each tilted its own way by up to 8°.
fn faces(seed: u64) -> Path {
    let tilts_rad = movements::random_tilts(&mut Random::new(seed, 0x7469_6c74), 8.0 / 180.0 * PI);
    movements::six_faces(5.0, 1.0, &tilts_rad)
}

fn calibrate(simulation: &Simulation) -> SixFace {
    let (acc, gyro) = (simulation.acc_m_s2(), simulation.gyro_rad_s());
    six_face(&acc, &gyro, 1.0 / RATE_HZ, &SixFaceSettings::default()).unwrap()
}

/// (found − true) / predicted deviation of accelerometer bias, accelerometer scale and gyroscope bias.
fn errors_in_sigmas(found: &SixFace, simulation: &Simulation) -> [f64; 9] {
    let (calibration, truth) = (&found.calibration, &simulation.calibration);
    let diagonal = |m: &[[f64; 3]; 3]| -> Vec3 { [m[0][0], m[1][1], m[2][2]] };
    let scale = diagonal(&calibration.accelerometer.matrix);
    let true_scale = diagonal(&truth.accelerometer.matrix);
    let mut errors = [0.0; 9];
    for axis in 0..3 {
        let acc_sigma = |i: usize| sqrt(found.acc_covariance[i][i]);
        errors[axis] =
            (calibration.accelerometer.bias[axis] - truth.accelerometer.bias[axis]) / acc_sigma(axis);
        errors[3 + axis] = (scale[axis] - true_scale[axis]) / acc_sigma(3 + axis);
        errors[6 + axis] = (calibration.gyroscope.bias[axis] - truth.gyroscope.bias[axis])
            / sqrt(found.gyro_bias_variance[axis]);
    }
    errors
}

/// Share of errors within 1 and within 3 of their predicted deviations.
fn coverage(errors: &[f64]) -> (f64, f64) {
    let share = |limit: f64| errors.iter().filter(|e| e.abs() <= limit).count() as f64 / errors.len() as f64;
    (share(1.0), share(3.0))
}

/// 200 sensors with errors of their own, white noise, counts and range; no misalignment, which six faces
/// cannot see, and no walk of the bias, which no single calibration can know.
#[test]
fn predicted_uncertainty_covers_the_truth() {
    for mut sensor in [Sensor::mu_01_like(), Sensor::lsm6ds3tr_c()] {
        sensor.accelerometer.bias_walk = 0.0;
        sensor.gyroscope.bias_walk = 0.0;
        let errors: Vec<[f64; 9]> = (0..200)
            .map(|seed| {
                let settings = Settings { errors: Errors::DrawnAligned, ..Settings::new(RATE_HZ, seed) };
                let simulation = simulate(&faces(seed), &sensor, &settings);
                errors_in_sigmas(&calibrate(&simulation), &simulation)
            })
            .collect();
        let (one, three) = coverage(errors.as_flattened());
        println!("{}: {:.1} % within 1 sigma, {:.2} % within 3", sensor.name, 100.0 * one, 100.0 * three);
        assert!((0.60..=0.76).contains(&one) && three >= 0.99, "{}: {one} {three}", sensor.name);
        // Each kind of parameter by itself: 600 values, so 68.3 % to within 6 % (three deviations).
        for (kind, name) in ["accelerometer bias", "accelerometer scale", "gyroscope bias"].iter().enumerate()
        {
            let of_kind: Vec<f64> = errors.iter().flat_map(|e| e[3 * kind..3 * kind + 3].to_vec()).collect();
            let (one, three) = coverage(&of_kind);
            println!("  {name}: {:.1} %, {:.2} %", 100.0 * one, 100.0 * three);
            assert!((0.60..=0.76).contains(&one) && three >= 0.985, "{} {name}: {one} {three}", sensor.name);
        }
    }
}

/// The committed recording, found to within four of the predicted deviations.
#[test]
fn the_example_calibrates_to_its_truth() {
    let simulation = recordings::six_face();
    let errors = errors_in_sigmas(&calibrate(&simulation), &simulation);
    println!("{errors:.2?}");
    assert!(errors.iter().all(|e| e.abs() < 4.0), "{errors:?}");
}
