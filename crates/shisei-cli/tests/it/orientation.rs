//! `shisei orient` and `shisei info` on the example recording.

use crate::run::{Desk, example, numbers};

const RAD: f64 = std::f64::consts::PI / 180.0;

/// Angle between two attitudes, w x y z.
fn angle_between(a: &[f64], b: &[f64]) -> f64 {
    let dot: f64 = a.iter().zip(b).map(|(x, y)| x * y).sum();
    2.0 * shisei_core::math::acos(dot.abs().min(1.0))
}

#[test]
fn pelvis_is_within_a_degree_of_the_truth() {
    for filter in ["mahony", "shisei", "shisei-online"] {
        check_pelvis(filter);
    }
}

fn check_pelvis(filter: &str) {
    let desk = Desk::new();
    let ran = desk.run(&["orient", &example("pelvis.csv"), "--filter", filter, "--forward", "+z"]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    assert_eq!(desk.names(), ["pelvis.html", "pelvis.orientation.csv"]);
    let (header, rows) = numbers(&desk.text("pelvis.orientation.csv"));
    assert_eq!(header[..8], ["time_s", "q_w", "q_x", "q_y", "q_z", "yaw_rad", "pitch_rad", "roll_rad"]);
    let certainty: &[&str] =
        if filter == "mahony" { &[] } else { &["sigma_tilt_rad", "sigma_heading_rad", "rest"] };
    assert_eq!(header[8..], *certainty);
    let truth = std::fs::read_to_string(example("pelvis.truth.csv")).unwrap();
    let (truth_header, truth) = numbers(&truth);
    assert_eq!(truth_header[..5], header[..5]);
    assert_eq!(rows.len(), truth.len());
    // A live estimate is still finding its level in the first second, and does not know its bias before the rest is found.
    let skip = if filter == "shisei-online" { 120 } else { 0 };
    let (rows, truth) = (&rows[skip..], &truth[skip..]);
    let worst = rows
        .iter()
        .zip(truth)
        .map(|(row, true_row)| angle_between(&row[1..5], &true_row[1..5]))
        .fold(0.0, f64::max);
    assert!(worst < RAD, "{filter}: largest error {:.3}°", worst / RAD);
    // The angles themselves: where the truth bends, pitch; where it leans, roll; and they do not mix.
    for axis in 5..8 {
        let worst = rows.iter().zip(truth).map(|(row, t)| (row[axis] - t[axis]).abs()).fold(0.0, f64::max);
        assert!(worst < 1.2 * RAD, "{filter}, column {axis}: largest error {:.3}°", worst / RAD);
    }
}

#[test]
fn without_forward_the_warning_appears_in_both_languages() {
    let desk = Desk::new();
    let english = desk.run(&["orient", &example("pelvis.csv")]);
    assert!(english.stderr.contains("--forward"), "{}", english.stderr);
    let japanese = desk.run(&["orient", &example("pelvis.csv"), "--lang", "ja"]);
    assert!(japanese.stderr.contains("注意") && japanese.stderr.contains("--forward"), "{}", japanese.stderr);
    let with = desk.run(&["orient", &example("pelvis.csv"), "--forward", "z"]);
    assert!(!with.stderr.contains("warning"), "{}", with.stderr);
}

#[test]
fn degrees_and_radians_agree() {
    let desk = Desk::new();
    let pelvis = example("pelvis.csv");
    desk.run(&["orient", &pelvis, "--no-report", "-o", "rad.csv"]);
    desk.run(&["orient", &pelvis, "--no-report", "-o", "deg.csv", "--degrees"]);
    let ((_, rad), (header, deg)) = (numbers(&desk.text("rad.csv")), numbers(&desk.text("deg.csv")));
    assert_eq!(
        header[5..],
        ["yaw_deg", "pitch_deg", "roll_deg", "sigma_tilt_deg", "sigma_heading_deg", "rest"]
    );
    for (r, d) in rad.iter().zip(&deg) {
        for k in 5..10 {
            assert!((r[k] / RAD - d[k]).abs() < 1e-10);
        }
    }
}

#[test]
fn relative_angles_start_at_zero_and_q_does_not_depend_on_them() {
    let desk = Desk::new();
    let pelvis = example("pelvis.csv");
    let of = |relative: &str| {
        let name = format!("{relative}.csv");
        let ran = desk.run(&["orient", &pelvis, "--no-report", "-o", &name, "--relative", relative]);
        assert_eq!(ran.code, 0, "{}", ran.stderr);
        numbers(&desk.text(&name)).1
    };
    let (world, body, none) = (of("world"), of("body"), of("none"));
    for k in 0..world.len() {
        assert_eq!(world[k][..5], body[k][..5]);
        assert_eq!(world[k][..5], none[k][..5]);
    }
    assert!(world[0][5..].iter().chain(&body[0][5..]).all(|angle| angle.abs() < RAD));
    // x up: the attitude itself has pitch near −90°
    assert!((none[0][6] + 90.0 * RAD).abs() < 10.0 * RAD, "{:?}", none[0]);
}

#[test]
fn every_filter_runs_and_says_its_settings() {
    for (filter, more) in [
        ("shisei", vec!["--save-calibration", "learnt.json"]),
        ("shisei-online", vec![]),
        ("mahony", vec!["--kp", "2", "--ki", "0.1"]),
        ("mahony-adaptive", vec!["--kp-min", "0.1", "--accel-limits", "4,9,10.5,15"]),
        ("complementary", vec!["--alpha", "0.95"]),
        ("gyro", vec![]),
        ("gyro-rk4", vec![]),
    ] {
        let desk = Desk::new();
        let pelvis = example("pelvis.csv");
        let mut args = vec!["orient", &pelvis, "--no-report", "--filter", filter];
        args.extend(&more);
        let ran = desk.run(&args);
        assert_eq!(ran.code, 0, "{filter}: {}", ran.stderr);
        assert!(ran.stderr.contains(filter), "{}", ran.stderr);
        assert_eq!(numbers(&desk.text("pelvis.orientation.csv")).1.len(), 1671);
    }
    let ran = Desk::new().run(&["orient", &example("pelvis.csv"), "--filter", "gyro", "--kp", "1"]);
    assert_eq!(ran.code, 2);
    assert!(ran.stderr.contains("--kp"), "{}", ran.stderr);
}

#[test]
fn what_was_learnt_of_a_sensor_is_given_to_the_next_recording() {
    let desk = Desk::new();
    let pelvis = example("pelvis.csv");
    let first = desk.run(&["orient", &pelvis, "--no-report", "--save-calibration", "learnt.json"]);
    assert_eq!(first.code, 0, "{}", first.stderr);
    for filter in ["shisei", "shisei-online", "mahony"] {
        let ran =
            desk.run(&["orient", &pelvis, "--no-report", "--calibration", "learnt.json", "--filter", filter]);
        assert_eq!(ran.code, 0, "{filter}: {}", ran.stderr);
    }
    let refused = desk.run(&["orient", &pelvis, "--filter", "gyro", "--save-calibration", "x.json"]);
    assert_eq!(refused.code, 2);
    assert!(refused.stderr.contains("--save-calibration"), "{}", refused.stderr);
}

#[test]
fn standard_output_carries_only_the_result() {
    let desk = Desk::new();
    let ran = desk.run(&["orient", &example("pelvis.csv"), "-o", "-", "--no-report"]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    assert_eq!(numbers(&ran.stdout).1.len(), 1671);
    let json = desk.run(&["orient", &example("pelvis.csv"), "--json", "--no-report"]);
    let value: serde_json::Value = serde_json::from_str(&json.stdout).expect("one JSON object");
    assert_eq!(value["samples"], 1671);
    let info = desk.run(&["info", &example("pelvis.csv"), "--json"]);
    let value: serde_json::Value = serde_json::from_str(&info.stdout).expect("one JSON object");
    assert_eq!(value["dialect"], "mu-01");
    assert!((value["rate_hz"].as_f64().unwrap() - 100.0).abs() < 1e-9);
    assert!(value["rests"].as_array().is_some_and(|rests| !rests.is_empty()));
}

#[test]
fn a_given_rest_is_used_and_none_is_allowed() {
    let desk = Desk::new();
    let pelvis = example("pelvis.csv");
    let ran = desk.run(&["orient", &pelvis, "--no-report", "--rest", "0.5:2.5", "--json"]);
    let value: serde_json::Value = serde_json::from_str(&ran.stdout).expect("one JSON object");
    assert_eq!((value["rest"]["start_s"].as_f64(), value["rest"]["end_s"].as_f64()), (Some(0.5), Some(2.5)));
    let ran = desk.run(&["orient", &pelvis, "--no-report", "--rest", "none", "--json"]);
    let value: serde_json::Value = serde_json::from_str(&ran.stdout).expect("one JSON object");
    assert!(value["rest"].is_null() && value["gyro_bias_rad_s"][0] == 0.0, "{value}");
    assert_eq!(desk.run(&["orient", &pelvis, "--rest", "400:500"]).code, 1);
    assert_eq!(desk.run(&["orient", &pelvis, "--rest", "soon"]).code, 2);
}

#[test]
fn our_own_output_is_overwritten_and_nothing_else() {
    let desk = Desk::new();
    let pelvis = example("pelvis.csv");
    let plot = ["orient", &pelvis, "--plot", "p.png"];
    assert_eq!(desk.run(&plot).code, 0);
    let again = desk.run(&plot);
    assert_eq!(again.code, 0, "{}", again.stderr);
    assert!(std::fs::read(desk.file("p.png")).unwrap().starts_with(b"\x89PNG"));
    for name in ["pelvis.orientation.csv", "pelvis.html", "p.png"] {
        let desk = Desk::new();
        desk.put(name, "dear diary\n");
        let ran = desk.run(&plot);
        assert_eq!(ran.code, 2, "{name}");
        assert!(ran.stderr.contains(name) && ran.stderr.contains("--force"), "{}", ran.stderr);
        assert_eq!(desk.names(), [name]);
        assert_eq!(desk.text(name), "dear diary\n");
        let forced = desk.run(&[&plot[..], &["--force"]].concat());
        assert_eq!(forced.code, 0, "{}", forced.stderr);
    }
    desk.put("own.csv", std::fs::read(&pelvis).unwrap());
    let ran = desk.run(&["orient", "own.csv", "-o", "own.csv", "--force"]);
    assert_eq!(ran.code, 2, "an input is never overwritten");
    assert_eq!(desk.text("own.csv"), std::fs::read_to_string(&pelvis).unwrap());
}

#[test]
fn converted_to_parquet_and_back_the_orientation_is_the_same() {
    let desk = Desk::new();
    let pelvis = example("pelvis.csv");
    assert_eq!(desk.run(&["orient", &pelvis, "--no-report", "-o", "a.csv"]).code, 0);
    for name in ["own.csv", "own.parquet"] {
        let ran = desk.run(&["convert", &pelvis, "-o", name]);
        assert_eq!(ran.code, 0, "{}", ran.stderr);
        let ran = desk.run(&["orient", name, "--no-report", "-o", "b.csv"]);
        assert_eq!(ran.code, 0, "{}", ran.stderr);
        // Steps are now differences of written times: the same to rounding.
        let (a, b) = (numbers(&desk.text("a.csv")).1, numbers(&desk.text("b.csv")).1);
        let worst =
            a.iter().flatten().zip(b.iter().flatten()).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max);
        assert!(worst < 1e-12, "{name}: {worst}");
    }
    let ran = desk.run(&["orient", &pelvis, "--no-report", "-o", "a.parquet"]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    assert!(std::fs::read(desk.file("a.parquet")).unwrap().starts_with(b"PAR1"));
}

#[test]
fn help_exists_in_both_languages() {
    let desk = Desk::new();
    for command in [
        &["--help"][..],
        &["orient", "--help"],
        &["info", "--help"],
        &["calibrate", "--help"],
        &["apply", "--help"],
    ] {
        let english = desk.run(command);
        let japanese = desk.run(&[command, &["--lang", "ja"]].concat());
        assert_eq!((english.code, japanese.code), (0, 0));
        assert!(english.stdout.is_ascii() || !english.stdout.contains("です"), "{}", english.stdout);
        assert!(japanese.stdout.contains("使い方"), "{}", japanese.stdout);
    }
    assert!(
        desk.run(&["orient", "x.csv", "--flter", "gyro", "--lang=ja"])
            .stderr
            .contains("オプション --flter はありません")
    );
}
