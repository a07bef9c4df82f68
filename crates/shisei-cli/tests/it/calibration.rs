//! `shisei calibrate`, `shisei apply` and `--calibration`.

use serde_json::Value;

use crate::run::{Desk, example, numbers};

fn values(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(items) => items.iter().flat_map(values).collect(),
        other => other.as_f64().into_iter().collect(),
    }
}

#[test]
fn six_faces_are_found_and_lie_near_the_truth() {
    let desk = Desk::new();
    let ran = desk.run(&["calibrate", &example("six-face.csv"), "--sensor-id", "MU-01 #7"]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    let found: Value = serde_json::from_str(&desk.text("six-face.calibration.json")).unwrap();
    let truth: Value =
        serde_json::from_str(&std::fs::read_to_string(example("six-face.truth.json")).unwrap()).unwrap();
    assert_eq!(found["format"], "shisei-calibration");
    assert_eq!(found["sensor"], "MU-01 #7");
    let sigma = &found["sigma"];
    for (part, key) in
        [("accelerometer", "bias_m_s2"), ("accelerometer", "matrix"), ("gyroscope", "bias_rad_s")]
    {
        let (f, t, s) = (values(&found[part][key]), values(&truth[part][key]), values(&sigma[part][key]));
        assert_eq!(f.len(), t.len(), "{part}.{key}");
        for ((f, t), s) in f.iter().zip(&t).zip(&s) {
            // A diagonal result: what lies beside has no error of its own here.
            assert!((f - t).abs() <= 4.0 * s + 1e-12 || *s == 0.0, "{part}.{key}: {f} is not {t} ± {s}");
        }
    }
}

#[test]
fn applying_is_bias_then_matrix_and_orient_takes_the_file() {
    let desk = Desk::new();
    desk.run(&["calibrate", &example("six-face.csv"), "-o", "cal.json"]);
    let ran =
        desk.run(&["apply", &example("six-face.csv"), "--calibration", "cal.json", "-o", "corrected.csv"]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    let cal: Value = serde_json::from_str(&desk.text("cal.json")).unwrap();
    let (bias, matrix) =
        (values(&cal["accelerometer"]["bias_m_s2"]), values(&cal["accelerometer"]["matrix"]));
    let (header, rows) = numbers(&desk.text("corrected.csv"));
    assert_eq!(header[..4], ["time_s", "acc_x", "acc_y", "acc_z"]);
    let raw = std::fs::read_to_string(example("six-face.csv")).unwrap();
    let first: Vec<f64> =
        raw.lines().nth(1).unwrap().split(',').skip(1).filter_map(|c| c.parse().ok()).collect();
    for axis in 0..3 {
        let expected = (first[axis] - bias[axis]) * matrix[4 * axis];
        assert!((rows[0][axis + 1] - expected).abs() < 1e-12, "axis {axis}");
    }
    // A corrected recording is a recording; our own earlier output may be overwritten, the input may not.
    assert_eq!(
        desk.run(&["apply", &example("six-face.csv"), "--calibration", "cal.json", "-o", "corrected.csv"])
            .code,
        0
    );
    assert_eq!(desk.run(&["orient", &example("pelvis.csv"), "--calibration", "cal.json"]).code, 0);
}

#[test]
fn a_missing_face_is_named_with_how_far_it_was() {
    let desk = Desk::new();
    let all = std::fs::read_to_string(example("six-face.csv")).unwrap();
    // The rests follow one another; without the last third some faces are gone.
    let part: String = all.lines().take(6000).map(|line| format!("{line}\n")).collect();
    desk.put("part.csv", part);
    let ran = desk.run(&["calibrate", "part.csv"]);
    assert_eq!(ran.code, 1, "{}", ran.stderr);
    assert!(ran.stderr.contains("never up") || ran.stderr.contains("tilted"), "{}", ran.stderr);
    let ja = desk.run(&["calibrate", "part.csv", "--lang", "ja"]);
    assert!(ja.stderr.contains("6 面がそろっていません"), "{}", ja.stderr);
    assert_eq!(desk.names(), ["part.csv"]);
}

#[test]
fn a_wrong_calibration_file_is_refused() {
    let desk = Desk::new();
    for text in [
        "",
        "{}",
        r#"{"format":"shisei-calibration","version":9}"#,
        "{\"format\":\"shisei-calibration\",\"version\":1}",
    ] {
        desk.put("cal.json", text);
        let ran = desk.run(&["orient", &example("pelvis.csv"), "--calibration", "cal.json"]);
        assert_eq!(ran.code, 2, "{text}");
        assert!(ran.stderr.starts_with("cal.json: "), "{}", ran.stderr);
    }
    assert_eq!(desk.names(), ["cal.json"]);
}
