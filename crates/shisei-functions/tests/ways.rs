//! One result by several ways: a sheet that steps row by row, one that takes the whole series at once, and the command
//! line's angles of the same attitudes. All give the same bits, save that the exact turns of a series are multiplied up
//! in blocks of sixteen (`GyroIntegrator`).

#![allow(clippy::disallowed_methods)] // any data do; the platform's mathematics may make them

use shisei_core::Quaternion;
use shisei_core::orient::{self, Relative};
use shisei_functions::{Input, Output, Range, find};

const ROWS: usize = 5000;
const DT_S: Input = Input::Number(0.01);
/// kp, then ki.
const FIXED: [Input; 2] = [Input::Number(0.5), Input::Number(0.0)];
/// kpMax, kpMin, the limits of the acceleration's size, ki.
const ADAPTIVE: [Input; 7] = [
    Input::Number(2.0),
    Input::Number(0.1),
    Input::Number(10.3),
    Input::Number(12.0),
    Input::Number(9.3),
    Input::Number(7.0),
    Input::Number(0.0),
];

/// A tumbling sensor: rates up to 6 rad/s, accelerations between 0.3 and 2 g.
fn tumbling() -> (Vec<f64>, Vec<f64>) {
    let times = || (0..ROWS).map(|k| k as f64 * 0.01);
    let gyro = times().flat_map(|t| [6.0 * (0.9 * t).sin(), 3.0 * (1.7 * t).cos(), 0.4]);
    let acc = times().flat_map(|t| {
        let size = 5.5 + 4.0 * (0.7 * t).sin();
        [t.sin() * size, (1.3 * t).cos() * size, (1.0 + 0.5 * (2.1 * t).sin()) * size]
    });
    (gyro.collect(), acc.collect())
}

fn rows(data: &[f64], cols: usize) -> Input<'_> {
    Input::Range(Range::new(data, data.len() / cols, cols).unwrap())
}

fn call(name: &str, inputs: &[Input<'_>]) -> Vec<f64> {
    let Output::Numbers { data, .. } = find(name).unwrap().call(inputs).unwrap() else { panic!("{name}") };
    data
}

/// Fails at the first number that is another.
fn assert_same(a: &[f64], b: &[f64], what: &str) {
    assert_eq!(a.len(), b.len(), "{what}");
    for (k, (a, b)) in a.iter().zip(b).enumerate() {
        assert_eq!(a.to_bits(), b.to_bits(), "{what}: number {k} is {a:?} or {b:?}");
    }
}

/// Names of a single step and of the series, and what follows their data.
fn steps() -> [(&'static str, &'static str, bool, &'static [Input<'static>]); 4] {
    [
        ("UpdateQuatByGyro", "UpdateQuatsByGyro", false, &[]),
        ("UpdateQuatByGyroRK4", "UpdateQuatsByGyroRK4", false, &[]),
        ("UpdateQuatByMahony", "UpdateQuatsByMahony", true, &FIXED),
        ("UpdateQuatByMahonyAdaptive", "UpdateQuatsByMahonyAdaptive", true, &ADAPTIVE),
    ]
}

fn series(name: &str, start: &[f64], acc: Option<&[f64]>, gyro: &[f64], settings: &[Input<'_>]) -> Vec<f64> {
    let mut inputs = vec![rows(start, 4), rows(gyro, 3)];
    inputs.extend(acc.map(|acc| rows(acc, 3)));
    inputs.push(DT_S);
    inputs.extend(settings);
    call(name, &inputs)
}

#[test]
fn row_by_row_or_all_at_once() {
    let (gyro, acc) = tumbling();
    let start = [0.5, -0.5, 0.1, 0.7];
    for (single, whole, takes_acc, settings) in steps() {
        let whole = series(whole, &start, takes_acc.then_some(&acc), &gyro, settings);
        // A single step of plain Mahony has no integral.
        let settings = if single == "UpdateQuatByMahony" { &settings[..1] } else { settings };
        let mut q = start.to_vec();
        for k in 0..ROWS {
            let row = 3 * k..3 * k + 3;
            q = series(single, &q, takes_acc.then_some(&acc[row.clone()]), &gyro[row], settings);
            if single == "UpdateQuatByGyro" {
                let off = q.iter().zip(&whole[4 * k..]).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                assert!(off < 1e-13, "{single}, row {}: {off}", k + 1);
                continue;
            }
            assert_same(&q, &whole[4 * k..4 * k + 4], &format!("{single}, row {}", k + 1));
        }
    }
}

#[test]
fn attitudes_and_then_angles_or_angles_at_once() {
    let (gyro, acc) = tumbling();
    let start = [0.5, -0.5, 0.1, 0.7];
    for (_, whole, takes_acc, settings) in steps() {
        let acc = takes_acc.then_some(acc.as_slice());
        let attitudes = series(whole, &start, acc, &gyro, settings);
        let angles = series(&whole.replace("Quats", "Yprs"), &start, acc, &gyro, settings);
        assert_same(&call("Quats2Yprs", &[rows(&attitudes, 4)]), &angles, whole);
        let first = Quaternion::new(attitudes[0], attitudes[1], attitudes[2], attitudes[3]);
        let attitudes_of_core: Vec<Quaternion> =
            attitudes.as_chunks().0.iter().map(|q| Quaternion::from_array(*q)).collect();
        for (seen_from, relative) in [("Body", Relative::Body), ("World", Relative::World)] {
            let sheet = [rows(&attitudes, 4), rows(&attitudes[..4], 4)];
            let angles = call(&format!("Quats2{seen_from}Yprs"), &sheet);
            let in_two = call(&format!("Quats2{seen_from}Quats"), &sheet);
            assert_same(
                &call("Quats2Yprs", &[rows(&in_two, 4)]),
                &angles,
                &format!("{whole}, {seen_from}, in two"),
            );
            let command_line = orient::ypr_rad(&attitudes_of_core, first, relative);
            assert_same(command_line.as_flattened(), &angles, &format!("{whole}, {seen_from}"));
        }
    }
}
