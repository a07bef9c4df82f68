//! What a stranger's file may be like: written on an old Macintosh, packed in an unusual way, in another unit than
//! its kind has, with an axis that is dead or a value that no sensor gives. It opens, or the sentence says what it is.
#![allow(clippy::disallowed_methods)] // numbers to look at; their bits do not matter

use shisei_core::Quaternion;
use shisei_record::calibration::CalibrationFile;
use shisei_record::{
    Input, Lang, Options, Recording, Stream, doubts, doubts_of_attitudes, open, open_stream,
};

const HEADER: &str =
    "time (s),acc_x (m/s^2),acc_y (m/s^2),acc_z (m/s^2),gyr_x (rad/s),gyr_y (rad/s),gyr_z (rad/s)";

fn row(k: usize) -> [f64; 7] {
    let t = k as f64 * 0.01;
    [t, 0.1 + 0.01 * (7.0 * t).sin(), 0.2, 9.8, 0.01 * (3.0 * t).cos(), 0.02, -0.01]
        .map(|x| x + 1e-6 * (k % 13) as f64)
}

fn text(rows: usize, change: impl Fn(usize, &mut [f64; 7])) -> String {
    let mut out = format!("{HEADER}\n");
    for k in 0..rows {
        let mut row = row(k);
        change(k, &mut row);
        out += &(row.map(|x| x.to_string()).join(",") + "\n");
    }
    out
}

fn opened(bytes: &[u8]) -> Recording {
    open(&[Input { name: "a.csv", bytes }], &Options::default()).unwrap_or_else(|error| panic!("{error}"))
}

fn warnings(recording: &Recording) -> Vec<&'static str> {
    recording.warnings.iter().map(|note| note.code).collect()
}

#[test]
fn lines_that_end_as_on_an_old_macintosh() {
    for rows in [50, 60_000] {
        let plain = text(rows, |_, _| {});
        let mac = plain.replace('\n', "\r");
        let expected = opened(plain.as_bytes());
        assert_eq!(opened(mac.as_bytes()).acc_m_s2, expected.acc_m_s2);
        let mut rest = &mac.as_bytes()[10..];
        let stream = Stream {
            name: "a.csv",
            head: mac.as_bytes()[..10].to_vec(),
            rest: &mut rest,
            length: mac.len() as u64,
        };
        let streamed = open_stream(stream, &Options::default()).expect("a recording");
        assert_eq!(streamed.gyro_rad_s, expected.gyro_rad_s);
    }
}

#[test]
fn a_dead_axis_is_said() {
    assert!(!warnings(&opened(text(300, |_, _| {}).as_bytes())).contains(&"dead-axis"));
    let dead = opened(text(300, |_, row| row[5] = 0.0).as_bytes());
    let note = dead.warnings.iter().find(|note| note.code == "dead-axis").expect("a warning");
    assert!(note.sentence(Lang::En).starts_with("gyr_y: the same value throughout"), "{note:?}");
    assert!(note.sentence(Lang::Ja).starts_with("gyr_y は"), "{note:?}");
}

#[test]
fn values_beyond_any_sensor_are_said() {
    for (column, value) in [(2, 1e300), (4, -1e6), (1, 2500.0)] {
        let change = |k: usize, row: &mut [f64; 7]| {
            if k == 200 {
                row[column] = value;
            }
        };
        let found = opened(text(300, change).as_bytes());
        let note = found.warnings.iter().find(|note| note.code == "beyond-any-sensor").expect("a warning");
        assert!(note.sentence(Lang::En).contains("1 sample(s), the first of them number 201"), "{note:?}");
    }
    // 200 g and 4000 deg/s are sold for motion.
    let hard = opened(
        text(300, |k, row| {
            if k == 200 {
                row[3] = 1961.0;
                row[4] = 69.0;
            }
        })
        .as_bytes(),
    );
    assert!(!warnings(&hard).contains(&"beyond-any-sensor"));
}

#[test]
fn one_wrong_stamp_is_pointed_at() {
    for stamp in [700.0, 1e300] {
        let with_wrong = |at| {
            let rows = text(300, |k, row| {
                if k == at {
                    row[0] = stamp;
                }
            });
            opened(rows.as_bytes())
        };
        // One among others is put between its neighbours; the last has only one.
        let found = with_wrong(200);
        assert!(
            found.warnings.iter().any(|note| note.code == "wild-stamps"),
            "{stamp}: {:?}",
            found.findings
        );
        assert!((found.time_s[200] - 2.0).abs() < 1e-4 && found.findings.gap_count == 0, "{stamp}");
        let found = with_wrong(299);
        let note = found.warnings.iter().find(|note| note.code == "one-long-gap");
        let note = note.unwrap_or_else(|| panic!("{stamp}: {:?}", found.findings));
        assert!(note.sentence(Lang::En).contains("before sample 300,"), "{stamp}: {note:?}");
    }
}

#[test]
fn a_spreadsheets_dates_are_days() {
    // 2025-12-09 12:00 as Excel and Calc store it, to ten decimals of a day.
    let header = HEADER.replace("time (s)", "Time");
    let days = text(300, |k, row| row[0] = ((46000.5 + 0.01 * k as f64 / 86400.0) * 1e10).round() / 1e10);
    let found = opened(days.replacen(HEADER, &header, 1).as_bytes());
    assert!((found.findings.rate_hz - 100.0).abs() < 0.2, "{:?}", found.findings.rate_hz);
    assert!((found.findings.duration_s - 2.99).abs() < 1e-3, "{:?}", found.findings.duration_s);
    assert!(found.assumptions.iter().any(|note| note.sentence(Lang::En).contains("taken as days")));
    // A step of a microsecond that is said to be in seconds.
    let fast = opened(text(300, |_, row| row[0] *= 1e-4).as_bytes());
    assert!(warnings(&fast).contains(&"rate-odd"), "{:?}", warnings(&fast));
}

#[test]
fn readings_in_g_under_a_name_of_another_unit() {
    let in_g = text(300, |_, row| {
        for x in &mut row[1..4] {
            *x /= 9.80665;
        }
    });
    let error = open(&[Input { name: "a.csv", bytes: in_g.as_bytes() }], &Options::default()).unwrap_err();
    assert!(error.sentence(Lang::En).contains("--units acc=g"), "{error}");
    assert!(error.sentence(Lang::Ja).contains("--units acc=g"), "{error}");
    let swapped = text(300, |_, row| row[1..7].rotate_left(3));
    let error = open(&[Input { name: "a.csv", bytes: swapped.as_bytes() }], &Options::default()).unwrap_err();
    assert!(error.sentence(Lang::En).contains("other columns were taken for it"), "{error}");
}

/// A calibration whose list has one number too many, of which one is none, is not read as if it were right.
#[test]
fn a_calibration_with_a_hole_is_refused() {
    let file = |bias: &str, matrix: &str| {
        format!(
            r#"{{"format": "shisei-calibration", "version": 1,
            "accelerometer": {{"bias_m_s2": {bias}, "matrix": {matrix}}},
            "gyroscope": {{"bias_rad_s": [0, 0, 0], "matrix": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]}}}}"#
        )
    };
    let unit = "[[1, 0, 0], [0, 1, 0], [0, 0, 1]]";
    assert!(CalibrationFile::from_json(file("[0, 0, 0]", unit).as_bytes()).is_ok());
    for (bias, matrix, word) in [
        ("[null, 0, 0, 0]", unit, "bias_m_s2"),
        ("[0, 0, 0]", "[[1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 0, null]]", "matrix"),
        ("[0, 0, 0]", "[[0, 0, 0], [0, 1, 0], [0, 0, 1]]", "accelerometer.matrix has no inverse"),
    ] {
        let error = CalibrationFile::from_json(file(bias, matrix).as_bytes()).expect_err(word);
        assert!(error.sentence(Lang::En).contains(word), "{}", error.sentence(Lang::En));
        assert!(error.sentence(Lang::Ja).contains("matrix") || word == "bias_m_s2");
    }
}

/// Readings in memory raise the doubts that a file of them would.
#[test]
fn readings_in_memory_are_doubted() {
    let rows = || (0..2000).map(|k| 0.01 * f64::from(k));
    // A slow swing of ±0.8 rad about x: gravity turns in the sensor as the rate says.
    let swing = |t: f64| 0.8 * (1.5 * t).sin();
    let acc: Vec<[f64; 3]> = rows()
        .map(|t| [0.001 * (7.0 * t).sin(), 9.80665 * swing(t).sin(), 9.80665 * swing(t).cos()])
        .collect();
    let gyro: Vec<[f64; 3]> = rows().map(|t| [1.2 * (1.5 * t).cos(), 1e-3 * t, -1e-3 * t]).collect();
    let scaled = |rows: &[[f64; 3]], factor: f64| -> Vec<[f64; 3]> {
        rows.iter().map(|v| v.map(|x| x * factor)).collect()
    };
    let dt_s = vec![0.01; acc.len()];
    let codes = |acc: &[[f64; 3]], gyro: &[[f64; 3]]| -> Vec<&'static str> {
        doubts(acc, gyro, &dt_s).iter().map(|note| note.code).collect()
    };
    assert!(codes(&acc, &gyro).is_empty(), "{:?}", codes(&acc, &gyro));
    assert_eq!(codes(&scaled(&acc, 1.0 / 9.80665), &gyro), ["acc-in-g"]);
    assert_eq!(codes(&acc, &scaled(&gyro, 57.29577951308232)), ["unit-gyro-doubtful"]);
    assert_eq!(codes(&scaled(&gyro, 0.1), &acc)[0], "rest-norm-odd");
}

#[test]
fn attitudes_without_a_heading_and_another_planets_gravity_are_said() {
    let codes = |start: [f64; 4], forward_said, gravity_m_s2| -> Vec<&'static str> {
        let notes = doubts_of_attitudes(Quaternion::from_array(start), forward_said, gravity_m_s2);
        for note in &notes {
            assert!(note.sentence(Lang::En).contains("--") && note.sentence(Lang::Ja).contains("--"));
        }
        notes.iter().map(|note| note.code).collect()
    };
    let (level, upright) = ([1.0, 0.0, 0.0, 0.0], [0.5_f64.sqrt(), 0.0, -(0.5_f64.sqrt()), 0.0]);
    assert!(codes(level, false, 9.798).is_empty());
    assert_eq!(codes(upright, false, 9.798), ["no-forward"]);
    assert!(codes(upright, true, 9.798).is_empty());
    for gravity_m_s2 in [1.0, 98.0] {
        assert_eq!(codes(level, false, gravity_m_s2), ["gravity-odd"]);
    }
}

#[test]
fn what_a_file_is_is_said_in_both_languages() {
    let bytes = text(50, |_, _| {}).replace(',', ";").replace('.', ",");
    let inputs = [Input { name: "a.csv", bytes: bytes.as_bytes() }];
    let found = shisei_record::inspect(&inputs, &Options::default()).expect("a table");
    assert_eq!(found.format(Lang::En), "a table with a header (UTF-8, semicolon, decimal comma)");
    assert_eq!(found.format(Lang::Ja), "見出しのある表 (UTF-8、セミコロン区切り、小数点はコンマ)");
}
