//! Calibrations of real recordings against published results.

mod support;

use shisei_core::calibration::SensorModel;
use shisei_core::calibration::gyro_turns::{self, TurnSettings};
use shisei_core::calibration::known_turns::{self, Part, Parts, TurnAngle};
use shisei_core::calibration::recording::calibrate_poses;
use shisei_core::{STANDARD_GRAVITY_M_S2, Vec3};

fn mikoff(file: &str) -> Option<(Vec<Vec3>, Vec<Vec3>)> {
    let text = support::recording(&format!("calib_mikoff_mpu9150/{file}"))?;
    let rows = support::table(&text, ' ');
    let triple = |at: usize| rows.iter().map(|r| [r[at], r[at + 1], r[at + 2]]).collect();
    Some((triple(0), triple(3)))
}

#[test]
fn mikoff_by_many_poses() {
    // imu0: the bias its authors publish
    let published = [("imu0.log", Some([0.1026, 0.0971, 0.3439])), ("imu1.log", None)];
    for (file, bias) in published {
        let Some((acc, gyro)) = mikoff(file) else { return };
        let found = calibrate_poses(&acc, &gyro, 0.01, STANDARD_GRAVITY_M_S2, None).unwrap();
        let c = &found.calibration;
        println!(
            "{file}: {} poses, bias {:?}, residual {:.5}, held out {:.5} m/s²",
            found.segments.len(),
            c.accelerometer.bias,
            c.residual_rms,
            c.held_out_rms
        );
        if let Some(bias) = bias {
            for i in 0..3 {
                assert!((c.accelerometer.bias[i] - bias[i]).abs() < 0.002, "{:?}", c.accelerometer);
            }
        }
        assert!(c.held_out.iter().all(|v| v.is_finite()));
        assert!(c.held_out_rms <= 0.005, "{}", c.held_out_rms);
        let turns =
            gyro_turns::calibrate(&gyro, 0.01, &found.segments, &c.accelerometer, &TurnSettings::default())
                .unwrap();
        println!(
            "{file}: turns, residual {:.2}° held out {:.2}°",
            turns.residual_rms_rad.to_degrees(),
            turns.held_out_rms_rad.to_degrees()
        );
        // without the calibration the same turns miss by more than a degree
        assert!(turns.held_out_rms_rad < 0.01, "{}", turns.held_out_rms_rad);
    }
}

#[test]
fn imucal_six_faces_and_three_turns() {
    let Some(text) = support::recording("calib_imucal_ferraris/annotated_session.csv") else { return };
    let Some(expected) = support::recording("calib_imucal_ferraris/expected_annotated_session.json") else {
        return;
    };
    let rows = |label: &str| -> (Vec<Vec3>, Vec<Vec3>) {
        text.lines()
            .filter(|l| l.split(',').next() == Some(label))
            .map(|l| {
                let v: Vec<f64> = l.split(',').skip(2).map(|c| c.parse().unwrap()).collect();
                ([v[0], v[1], v[2]], [v[3], v[4], v[5]])
            })
            .unzip()
    };
    let data: Vec<_> =
        ["x_p", "y_p", "z_p", "x_a", "y_a", "z_a", "x_rot", "y_rot", "z_rot"].map(rows).into_iter().collect();
    let part = |i: usize| Part { acc: &data[i].0, gyro: &data[i].1 };
    let parts = Parts {
        up: [part(0), part(1), part(2)],
        down: [part(3), part(4), part(5)],
        turn: [part(6), part(7), part(8)],
    };
    // the reference was made with g = 9.81 and turns of −360°
    let turn = TurnAngle::Signed(-core::f64::consts::TAU);
    let found = known_turns::calibrate(&parts, 1.0 / 204.8, turn, 9.81).unwrap();

    let numbers = |key: &str| -> Vec<f64> {
        let at = expected.find(&format!("\"{key}\"")).unwrap() + key.len() + 2;
        let tail = &expected[at..];
        let end = tail.find('"').unwrap_or(tail.len());
        tail[..end]
            .split(|c: char| !(c.is_ascii_digit() || "+-.eE".contains(c)))
            .filter_map(|t| t.parse().ok())
            .collect()
    };
    let product = |k: &[f64], r: &[f64]| -> Vec<f64> {
        (0..9).map(|i| (0..3).map(|l| k[3 * (i / 3) + l] * r[3 * l + i % 3]).sum()).collect()
    };
    let degree = core::f64::consts::PI / 180.0;
    for (affine, k, r, b, unit) in
        [(&found.accelerometer, "K_a", "R_a", "b_a", 1.0), (&found.gyroscope, "K_g", "R_g", "b_g", degree)]
    {
        let sensitivity = product(&numbers(k), &numbers(r));
        let bias = numbers(b);
        // matrix · sensitivity must be the unit matrix (times the unit), to 0.1 %
        for i in 0..3 {
            for j in 0..3 {
                let m: f64 = (0..3).map(|l| affine.matrix[i][l] * sensitivity[3 * l + j]).sum();
                let e = if i == j { unit } else { 0.0 };
                assert!((m - e).abs() < 1e-6 * unit, "{k} {i} {j}: {m}");
            }
            assert!((affine.bias[i] / bias[i] - 1.0).abs() < 1e-9);
        }
    }
    let kga = numbers("K_ga");
    for i in 0..9 {
        assert!((found.gyro_per_acceleration[i / 3][i % 3] - kga[i]).abs() < 1e-6);
    }
    // with the size only, the turns' direction comes from the reading: the same, unreversed
    let plain = known_turns::calibrate(&parts, 1.0 / 204.8, TurnAngle::Size(core::f64::consts::TAU), 9.81);
    let plain: SensorModel = plain.unwrap().gyroscope;
    for i in 0..3 {
        assert!(plain.matrix[i][i] > 0.0);
        assert!((plain.matrix[i][i] + found.gyroscope.matrix[i][i]).abs() < 1e-9);
    }
}
