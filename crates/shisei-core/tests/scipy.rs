//! Every quaternion and angle function against SciPy's Rotation on 10,000 cases (`fixtures/scipy`), and the
//! polynomials of the exact step against mpmath (`fixtures/mpmath`).
#![allow(clippy::disallowed_methods)] // the comparison builds its matrices with the platform's mathematics

use std::path::{Path, PathBuf};

use shisei_core::filter::exponential::{cos_sinc, exp_half};
use shisei_core::{Quaternion, Vec3, Ypr, vector};

const COLUMNS: usize = 37;

fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures").join(name)
}

struct Case {
    number: usize,
    q: Quaternion,
    p: Quaternion,
    v: Vec3,
    matrix: [[f64; 3]; 3],
    ypr: Ypr,
    product: Quaternion,
    turned: Vec3,
    rotation_vector: Vec3,
    slerp: Quaternion,
}

fn cases() -> Vec<Case> {
    let bytes = std::fs::read(fixture("scipy/rotations.f64le")).unwrap();
    let numbers: Vec<f64> =
        bytes.chunks_exact(8).map(|b| f64::from_le_bytes(b.try_into().unwrap())).collect();
    assert_eq!(numbers.len(), 10_000 * COLUMNS);
    let three = |row: &[f64], at: usize| [row[at], row[at + 1], row[at + 2]];
    let four = |row: &[f64], at: usize| Quaternion::new(row[at], row[at + 1], row[at + 2], row[at + 3]);
    let case = |(number, row): (usize, &[f64])| Case {
        number,
        q: four(row, 0),
        p: four(row, 4),
        v: three(row, 8),
        matrix: [three(row, 11), three(row, 14), three(row, 17)],
        ypr: Ypr::from_array(three(row, 20)),
        product: four(row, 23),
        turned: three(row, 27),
        rotation_vector: three(row, 30),
        slerp: four(row, 33),
    };
    numbers.chunks_exact(COLUMNS).enumerate().map(case).collect()
}

/// Largest difference of components, the sign of a quaternion left open.
fn quaternion_error(a: Quaternion, b: Quaternion) -> f64 {
    let (a, b) = (a.to_array(), b.to_array());
    let worst = |sign: f64| (0..4).map(|k| (a[k] - sign * b[k]).abs()).fold(0.0, f64::max);
    worst(1.0).min(worst(-1.0))
}

fn vector_error(a: Vec3, b: Vec3) -> f64 {
    vector::norm(vector::sub(a, b))
}

/// Rz(yaw) Ry(pitch) Rx(roll).
fn matrix_of(ypr: Ypr) -> [[f64; 3]; 3] {
    let (sy, cy) = ypr.yaw_rad.sin_cos();
    let (sp, cp) = ypr.pitch_rad.sin_cos();
    let (sr, cr) = ypr.roll_rad.sin_cos();
    [
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
        [-sp, cp * sr, cp * cr],
    ]
}

/// Angle of AᵀB, rad, for nearly equal rotations: the length of its skew part.
fn angle_between(a: &[[f64; 3]; 3], b: &[[f64; 3]; 3]) -> f64 {
    let entry = |i: usize, j: usize| (0..3).map(|k| a[k][i] * b[k][j]).sum::<f64>();
    let skew = [entry(2, 1) - entry(1, 2), entry(0, 2) - entry(2, 0), entry(1, 0) - entry(0, 1)];
    assert!(entry(0, 0) + entry(1, 1) + entry(2, 2) > 2.9);
    0.5 * vector::norm(skew)
}

fn wrapped(angle: f64) -> f64 {
    angle.sin().atan2(angle.cos()).abs()
}

#[test]
fn yaw_pitch_roll() {
    let mut angles_compared = 0;
    for case in cases() {
        let ours = case.q.to_ypr();
        let c = case.matrix[0][0].hypot(case.matrix[1][0]);
        let limit = if c < 1e-3 { 4e-12 } else { 1e-12 };
        let error = angle_between(&case.matrix, &matrix_of(ours));
        assert!(error <= limit, "case {}: {error}", case.number);
        assert!(ours.pitch_rad.abs() <= std::f64::consts::FRAC_PI_2);
        if c > 1e-3 {
            angles_compared += 1;
            for (a, b) in ours.to_array().into_iter().zip(case.ypr.to_array()) {
                assert!(wrapped(a - b) <= 1e-12, "case {}: {a} {b}", case.number);
            }
        }
        let back = angle_between(&case.matrix, &Quaternion::from_ypr(ours).to_matrix());
        assert!(back <= limit, "case {}: {back}", case.number);
        if c > 1e-3 {
            assert!(
                quaternion_error(Quaternion::from_ypr(case.ypr), case.q) <= 1e-12,
                "case {}",
                case.number
            );
        }
    }
    assert!(angles_compared > 7900);
}

#[test]
fn matrices() {
    for case in cases() {
        let ours = case.q.to_matrix();
        for i in 0..3 {
            assert!(vector_error(ours[i], case.matrix[i]) <= 2e-15, "case {}", case.number);
        }
        let back = Quaternion::from_matrix(case.matrix).unwrap();
        assert!(quaternion_error(back, case.q) <= 2e-15, "case {}", case.number);
    }
}

#[test]
fn products_and_turned_vectors() {
    for case in cases() {
        assert!(quaternion_error(case.q.product(case.p), case.product) <= 1e-15, "case {}", case.number);
        let size = vector::norm(case.v);
        assert!(vector_error(case.q.rotate(case.v), case.turned) <= 2e-15 * size, "case {}", case.number);
        let up = case.q.up_body();
        assert!(vector_error(up, case.matrix[2]) <= 2e-15, "case {}", case.number);
    }
}

#[test]
fn rotation_vectors_and_axis_angles() {
    for case in cases() {
        let ours = case.q.to_rotation_vector();
        let size = vector::norm(case.rotation_vector);
        // near half a turn the axis' sign is free
        let error = vector_error(ours, case.rotation_vector);
        let flipped = vector_error(vector::scale(ours, -1.0), case.rotation_vector);
        let error = if size > 3.0 { error.min(flipped) } else { error };
        assert!(error <= 2e-15 * size.max(1e-8), "case {}: {error} of {size}", case.number);
        assert!(
            quaternion_error(Quaternion::from_rotation_vector(case.rotation_vector), case.q) <= 2e-15,
            "case {}",
            case.number
        );
        let half = vector::scale(case.rotation_vector, 0.5);
        assert!(quaternion_error(exp_half(half), case.q) <= 2e-15, "case {}", case.number);
        let (axis, angle) = case.q.to_axis_angle();
        assert!((angle - size).abs() <= 2e-15 * size.max(1e-8), "case {}", case.number);
        let back = Quaternion::from_axis_angle(vector::scale(axis, 7.0), angle).unwrap();
        assert!(quaternion_error(back, case.q) <= 2e-15, "case {}", case.number);
        assert!((case.q.angle() - size).abs() <= 2e-15 * size.max(1e-8), "case {}", case.number);
    }
}

#[test]
fn interpolation() {
    for case in cases() {
        let t = (case.number % 101) as f64 / 100.0;
        let ours = Quaternion::slerp(case.q, case.p, t);
        // SciPy's own way over the rotation vector is good to a few 1e-15
        assert!(quaternion_error(ours, case.slerp) <= 1e-14, "case {}", case.number);
    }
}

#[test]
fn conjugates_undo() {
    for case in cases() {
        let one = case.q.product(case.q.conjugate());
        assert!(quaternion_error(one, Quaternion::IDENTITY) <= 1e-15, "case {}", case.number);
    }
}

#[test]
fn polynomials_of_the_exact_step() {
    let text = std::fs::read_to_string(fixture("mpmath/exponential.csv")).unwrap();
    let mut rows = 0;
    for line in text.lines().skip(1) {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        let (cos, sinc) = cos_sinc(cells[0]);
        // one unit of the last place of numbers in 0.5 … 1
        assert!((cos - cells[1]).abs() <= 1.2e-16 && (sinc - cells[2]).abs() <= 1.2e-16, "{line}");
        rows += 1;
    }
    assert!(rows >= 30);
}

/// On either side of the hand-over the two ways agree.
#[test]
fn the_hand_over_is_smooth() {
    for (below, above) in [(0.5_f64.next_down(), 0.5), (0.4999999999999, 0.5000000000001)] {
        let a = exp_half([below, 0.0, 0.0]);
        let b = exp_half([above, 0.0, 0.0]);
        assert!(quaternion_error(a, b) <= (above - below) + 2e-16);
    }
}
