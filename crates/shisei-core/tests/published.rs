//! Printed numbers of other people's documents (`fixtures/published`) come out within their printed digits.
#![cfg(feature = "alloc")]

use std::path::Path;

use shisei_core::calibration::Calibration;
use shisei_core::earth::sidereal_day_s;
use shisei_core::filter::{Dt, Filter, Mahony, run};
use shisei_core::sphere::{fit_circle, fit_sphere};
use shisei_core::{Quaternion, STANDARD_GRAVITY_M_S2, Vec3};

/// The numbers of a fixture, a row a line, without the first column.
fn fixture(name: &str) -> Vec<Vec<f64>> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/published").join(name);
    let text = std::fs::read_to_string(&path).unwrap();
    let rows = text.lines().skip(1);
    rows.map(|line| line.split(',').skip(1).map(|cell| cell.parse().unwrap()).collect()).collect()
}

fn three(row: &[f64], at: usize) -> Vec3 {
    [row[at], row[at + 1], row[at + 2]]
}

/// Half a unit of the last printed digit of w, x and y, which are printed with six significant digits.
const HALF_UNIT: Vec3 = [5e-7, 5e-7, 5e-6];

/// Largest |difference| from the printed w, x, y in half units of print, over all rows, at the best start
/// within the rounding of the printed start.
fn worst_over_best_start(step: impl Fn(Quaternion, Vec3, Vec3) -> Quaternion) -> f64 {
    let rows = fixture("pelvis_rows.csv");
    assert_eq!(rows.len(), 15);
    let printed_start = three(&rows[0], 6);
    let printed_z = 0.673724;
    let mut best = f64::INFINITY;
    let grid = || (-10..=10).map(|k| f64::from(k) / 10.0);
    for a in grid() {
        for b in grid() {
            for c in grid() {
                let w = printed_start[0] + a * HALF_UNIT[0];
                let x = printed_start[1] + b * HALF_UNIT[1];
                let y = printed_start[2] + c * HALF_UNIT[2];
                let z = (1.0 - w * w - x * x - y * y).sqrt();
                if (z - printed_z).abs() > 5e-7 {
                    continue;
                }
                let mut q = Quaternion::new(w, x, y, z);
                let mut worst = 0.0_f64;
                for row in &rows[1..] {
                    q = step(q, three(row, 3), three(row, 0));
                    let printed = three(row, 6);
                    for (value, k) in [(q.w, 0), (q.x, 1), (q.y, 2)] {
                        worst = worst.max((value - printed[k]).abs() / HALF_UNIT[k]);
                    }
                    if worst > best {
                        break;
                    }
                }
                best = best.min(worst);
            }
        }
    }
    best
}

#[test]
fn mahony_gives_the_printed_quaternions() {
    let worst =
        worst_over_best_start(|q, gyro, acc| Mahony::new(q, 2.0, 0.0).unwrap().update(gyro, acc, 0.01));
    assert!(worst <= 1.0, "{worst} half units of print");
}

/// The comparison can fail: dividing the acceleration by gravity instead of its norm does.
#[test]
fn dividing_by_gravity_does_not_give_the_printed_quaternions() {
    let worst = worst_over_best_start(|q, gyro, acc| {
        let kp = 2.0 * shisei_core::vector::norm(acc) / STANDARD_GRAVITY_M_S2;
        Mahony::new(q, kp, 0.0).unwrap().update(gyro, acc, 0.01)
    });
    assert!(worst > 1.0, "{worst} half units of print");
}

#[test]
fn the_series_function_gives_the_same_as_the_single_steps() {
    let rows = fixture("pelvis_rows.csv");
    let start = Quaternion::new(rows[0][6], rows[0][7], rows[0][8], 0.673724);
    let gyro: Vec<Vec3> = rows[1..].iter().map(|row| three(row, 3)).collect();
    let acc: Vec<Vec3> = rows[1..].iter().map(|row| three(row, 0)).collect();
    let mut filter = Mahony::new(start, 2.0, 0.0).unwrap();
    let out: Vec<[f64; 4]> = run(&mut filter, &gyro, &acc, Dt::Constant(0.01)).unwrap();
    for (q, row) in out.iter().zip(&rows[1..]) {
        for k in 0..3 {
            // the printed start's own rounding included
            assert!((q[k] - row[6 + k]).abs() <= 2.0 * HALF_UNIT[k], "{q:?}");
        }
    }
}

#[test]
fn the_printed_calibration_gives_the_printed_rows() {
    let calibration = Calibration::from_twelve([
        -0.0272, -0.07121, 0.106377, 0.999356, 0.999585, 0.999567, 0.006784, 0.009346, 0.008648, 1.0, 1.0,
        1.0,
    ]);
    let rows = fixture("calibrated_rows.csv");
    assert_eq!(rows.len(), 10);
    for row in &rows {
        let acc = calibration.accelerometer.apply(three(row, 0));
        let gyro = calibration.gyroscope.apply(three(row, 3));
        for k in 0..3 {
            assert!((acc[k] - row[6 + k]).abs() <= 1.1e-5, "{acc:?} {row:?}");
            assert!((gyro[k] - row[9 + k]).abs() <= 1.1e-5, "{gyro:?} {row:?}");
        }
    }
}

/// The sphere's condition number and the circle's radius are from a NumPy evaluation of the same table.
#[test]
fn the_eight_directions_give_the_printed_day() {
    let points: Vec<Vec3> = fixture("earth_directions.csv").iter().map(|row| three(row, 0)).collect();
    assert_eq!(points.len(), 8);
    let sphere = fit_sphere(&points).unwrap();
    assert!((sphere.radius - 7.657707e-5).abs() <= 5e-11, "{}", sphere.radius);
    assert!((sphere.radius - 7.657709e-5).abs() <= 5e-12, "{}", sphere.radius);
    let hours = sidereal_day_s(sphere.radius).unwrap() / 3600.0;
    assert!((hours - 22.8).abs() < 0.05, "{hours}");
    assert!((sphere.condition - 334.0).abs() < 1.0, "{}", sphere.condition);
    assert!(sphere.is_nearly_flat());
    let circle = fit_circle(&points).unwrap();
    assert!((circle.radius - 6.3769e-5).abs() < 5e-10, "{}", circle.radius);
}
