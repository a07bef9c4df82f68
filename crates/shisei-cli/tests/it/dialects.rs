//! A recording in every dialect gives the orientation of the same recording in our own columns, to the digits that
//! the dialect writes.

use shisei_record::dialect::maker;
use shisei_record::{Input, Options, open};

use crate::run::{Desk, example, numbers};

/// Angle between two attitudes after the turn about z that brings the first rows together, rad: a dialect may
/// lose digits that decide the heading of the start.
fn worst_angle(a: &[Vec<f64>], b: &[Vec<f64>]) -> f64 {
    let pairs = a.iter().zip(b);
    pairs
        .map(|(a, b)| {
            let dot: f64 = a[1..5].iter().zip(&b[1..5]).map(|(x, y)| x * y).sum();
            let distance: f64 = a[1..5].iter().zip(&b[1..5]).map(|(x, y)| (x - dot.signum() * y).abs()).sum();
            2.0 * distance
        })
        .fold(0.0, f64::max)
}

#[test]
fn every_dialect_gives_the_same_orientation() {
    let bytes = std::fs::read(example("pelvis.csv")).unwrap();
    let recording = open(&[Input { name: "pelvis.csv", bytes: &bytes }], &Options::default()).unwrap();
    let motion = maker::Motion {
        time_s: &recording.time_s,
        acc_m_s2: &recording.acc_m_s2,
        gyro_rad_s: &recording.gyro_rad_s,
        rate_hz: 100.0,
    };
    let orient = |id: &str| {
        let desk = Desk::new();
        let files = maker::write(id, &motion).unwrap_or_default();
        assert!(!files.is_empty(), "{id} has no writer");
        let mut args = vec!["orient"];
        for (name, bytes) in &files {
            desk.put(name, bytes);
            args.push(name);
        }
        args.extend(["--filter", "mahony", "--no-report", "--forward", "z"]);
        if id == "headerless" {
            args.extend(["--rate", "100"]);
        }
        let ran = desk.run(&args);
        assert_eq!(ran.code, 0, "{id}: {}", ran.stderr);
        let outputs: Vec<String> =
            desk.names().into_iter().filter(|name| name.ends_with(".orientation.csv")).collect();
        assert_eq!(outputs.len(), 1, "{id}: {outputs:?}");
        numbers(&desk.text(&outputs[0])).1
    };
    let own = orient("shisei");
    for id in maker::IDS {
        // Digits written: milliseconds, counts of 1e-5, float32, else nine decimals or more.
        let limit = match *id {
            "metawear" | "android-ms" => 2e-3,
            "gyroflow" | "spresense" => 2e-4,
            _ => 1e-6,
        };
        let rows = orient(id);
        assert_eq!(rows.len(), own.len(), "{id}");
        let worst = worst_angle(&rows, &own);
        assert!(worst < limit, "{id}: {worst:e} rad");
    }
}
