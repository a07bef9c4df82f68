//! Every dialect: a file made in it reads back to the motion it was made from, to the digits written; and
//! the sample of each in `fixtures/dialects/` opens as itself.
#![allow(clippy::disallowed_methods)] // numbers to read back; their own bits do not matter

use shisei_record::dialect::{ALL, maker};
use shisei_record::{Input, Options, Recording, open};
use std::path::PathBuf;

/// A body that tilts and turns: gravity moves as the gyroscope says.
struct Sample {
    time_s: Vec<f64>,
    acc: Vec<[f64; 3]>,
    gyro: Vec<[f64; 3]>,
}

fn motion(rows: usize, rate_hz: f64) -> Sample {
    let mut out = Sample { time_s: Vec::new(), acc: Vec::new(), gyro: Vec::new() };
    for i in 0..rows {
        let t = i as f64 / rate_hz;
        // Roll by 0.6 sin(1.5 t) after a still second.
        let u = (t - 1.0).max(0.0);
        let (angle, rate) = (0.6 * (1.5 * u).sin(), if t > 1.0 { 0.9 * (1.5 * u).cos() } else { 0.0 });
        let noise = ((i * 37 % 101) as f64 - 50.0) * 2e-5;
        out.time_s.push(t);
        out.acc.push([noise, 9.80665 * angle.sin(), 9.80665 * angle.cos()]);
        out.gyro.push([rate + noise, 0.002, -noise]);
    }
    out
}

fn read(files: &[maker::File]) -> Recording {
    let inputs: Vec<Input<'_>> = files.iter().map(|(name, bytes)| Input { name, bytes }).collect();
    open(&inputs, &Options::default()).unwrap_or_else(|e| panic!("{e}"))
}

fn check(id: &str, sample: &Sample, files: &[maker::File]) {
    let recording = read(files);
    assert_eq!(recording.dialect, id);
    assert_eq!(recording.len(), sample.time_s.len(), "{id}");
    let start = if recording.start_unix_s.is_some() || id == "spresense" || id == "android-ms" {
        sample.time_s[0]
    } else {
        recording.time_s[0]
    };
    // Digits written: milliseconds, counts of 1e-5, float32, else nine decimals.
    let time_digits = match id {
        "metawear" | "android-ms" => 1e-3,
        _ => 1e-6,
    };
    let (acc_digits, gyro_digits) = match id {
        "gyroflow" => (6e-5, 6e-6),
        "spresense" => (1e-6, 1e-7),
        _ => (2e-8, 2e-8),
    };
    for i in 0..recording.len() {
        let t = recording.time_s[i] - recording.time_s[0];
        assert!(
            (t - (sample.time_s[i] - start.min(sample.time_s[0]))).abs() <= time_digits,
            "{id} row {i}: {t}"
        );
        for k in 0..3 {
            let (a, g) =
                (recording.acc_m_s2[i][k] - sample.acc[i][k], recording.gyro_rad_s[i][k] - sample.gyro[i][k]);
            assert!(a.abs() <= acc_digits, "{id} row {i}: acc {a:e}");
            assert!(g.abs() <= gyro_digits, "{id} row {i}: gyro {g:e}");
        }
    }
    let rate = recording.findings.rate_hz;
    assert!((rate - 100.0).abs() < 0.2, "{id} {rate}");
}

#[test]
fn a_file_in_every_dialect_reads_back() {
    let sample = motion(1500, 100.0);
    let made = maker::Motion {
        time_s: &sample.time_s,
        acc_m_s2: &sample.acc,
        gyro_rad_s: &sample.gyro,
        rate_hz: 100.0,
    };
    for id in maker::IDS {
        check(id, &sample, &maker::write(id, &made).unwrap());
    }
    for dialect in ALL.iter().filter(|d| d.id != "generic") {
        assert!(maker::IDS.contains(&dialect.id), "no writer for {}", dialect.id);
    }
}

/// The samples of `fixtures/dialects/`, one folder a dialect; the first row of each is known.
#[test]
fn the_sample_of_every_dialect_opens() {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/dialects");
    for id in maker::IDS {
        let folder = root.join(id);
        let mut names: Vec<PathBuf> = std::fs::read_dir(&folder)
            .unwrap_or_else(|e| panic!("{}: {e}", folder.display()))
            .map(|f| f.unwrap().path())
            .collect();
        names.sort();
        let files: Vec<maker::File> = names
            .iter()
            .map(|p| (p.file_name().unwrap().to_string_lossy().into_owned(), std::fs::read(p).unwrap()))
            .collect();
        let recording = read(&files);
        assert_eq!(recording.dialect, *id);
        assert_eq!(recording.len(), 40, "{id}");
        let [x, y, z] = recording.acc_m_s2[7];
        assert!(
            (x - 0.07).abs() < 1e-4 && (y + 0.2).abs() < 1e-4 && (z - 9.8).abs() < 1e-4,
            "{id} {x} {y} {z}"
        );
        let [x, y, z] = recording.gyro_rad_s[7];
        assert!(
            (x - 0.1).abs() < 1e-5 && (y + 0.2).abs() < 1e-5 && (z - 0.037).abs() < 1e-5,
            "{id} {x} {y} {z}"
        );
        assert!((recording.findings.rate_hz - 100.0).abs() < 1.5, "{id} {}", recording.findings.rate_hz);
    }
}

/// Writes the samples anew: `cargo test -p shisei-record --test dialects -- --ignored`.
#[test]
#[ignore = "writes fixtures"]
fn write_the_samples() {
    let time_s: Vec<f64> = (0..40).map(|i| f64::from(i) / 100.0).collect();
    let acc: Vec<[f64; 3]> = (0..40).map(|i| [0.01 * f64::from(i), -0.2, 9.8]).collect();
    let gyro: Vec<[f64; 3]> = (0..40).map(|i| [0.1, -0.2, 0.03 + 0.001 * f64::from(i)]).collect();
    let made = maker::Motion { time_s: &time_s, acc_m_s2: &acc, gyro_rad_s: &gyro, rate_hz: 100.0 };
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/dialects");
    for id in maker::IDS {
        std::fs::create_dir_all(root.join(id)).unwrap();
        for (name, bytes) in maker::write(id, &made).unwrap() {
            std::fs::write(root.join(id).join(name), bytes).unwrap();
        }
    }
}
