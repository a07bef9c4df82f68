//! Directories and several files.

use crate::run::{Desk, example};

#[test]
fn a_directory_goes_on_past_bad_files() {
    let desk = Desk::new();
    let pelvis = std::fs::read(example("pelvis.csv")).unwrap();
    std::fs::create_dir(desk.file("in")).unwrap();
    for k in 0..10 {
        desk.put(&format!("in/walk{k}.csv"), &pelvis);
    }
    desk.put("in/bad.csv", "x,y\n1,2\n");
    desk.put("in/empty.csv", "");
    let ran = desk.run(&["orient", "in", "-o", "out", "--no-report"]);
    assert_eq!(ran.code, 2, "{}", ran.stderr);
    assert!(ran.stderr.contains("10 done, 2 failed"), "{}", ran.stderr);
    assert!(ran.stderr.contains("bad.csv") && ran.stderr.contains("empty.csv"), "{}", ran.stderr);
    assert_eq!(std::fs::read_dir(desk.file("out")).unwrap().count(), 10);
    // Results beside the recordings are not taken for recordings.
    std::fs::remove_file(desk.file("in/bad.csv")).unwrap();
    std::fs::remove_file(desk.file("in/empty.csv")).unwrap();
    for _ in 0..2 {
        let ran = desk.run(&["orient", "in", "-o", "in", "--no-report"]);
        assert_eq!(ran.code, 0, "{}", ran.stderr);
        assert!(ran.stderr.contains("10 done, 0 failed"), "{}", ran.stderr);
    }
}

#[test]
fn a_thousand_recordings_with_twenty_bad_ones() {
    let desk = Desk::new();
    std::fs::create_dir(desk.file("in")).unwrap();
    let pelvis = std::fs::read_to_string(example("pelvis.csv")).unwrap();
    let short: String = pelvis.lines().take(400).map(|line| format!("{line}\n")).collect();
    for k in 0..1000 {
        let text = if k % 50 == 7 { "Time,Ax[m/s2]\n0,oops\n" } else { &short };
        desk.put(&format!("in/r{k:04}.csv"), text);
    }
    let ran = desk.run(&["orient", "in", "-o", "out", "--no-report", "--json"]);
    assert_eq!(ran.code, 2);
    let summary: serde_json::Value = serde_json::from_str(&ran.stdout).expect("one JSON object");
    assert_eq!(summary["results"].as_array().map(Vec::len), Some(980));
    assert_eq!(summary["failed"].as_array().map(Vec::len), Some(20));
    assert_eq!(std::fs::read_dir(desk.file("out")).unwrap().count(), 980);
    let sentences = ran
        .stderr
        .lines()
        .filter(|line| line.contains("r0") && line.contains("in/") && !line.contains(" Hz "))
        .count();
    assert_eq!(sentences, 20, "{}", ran.stderr);
    #[cfg(target_os = "linux")]
    assert!(desk.peak_memory_kb(&["orient", "in", "-o", "out", "--no-report"]) < 100_000);
}

#[test]
fn a_directory_without_recordings_is_said() {
    let desk = Desk::new();
    std::fs::create_dir(desk.file("in")).unwrap();
    desk.put("in/notes.md", "nothing");
    let ran = desk.run(&["orient", "in"]);
    assert_eq!(ran.code, 2);
    assert!(ran.stderr.contains("no recordings"), "{}", ran.stderr);
    assert_eq!(desk.names(), ["in"]);
}

#[test]
fn files_of_the_same_name_do_not_overwrite_each_other() {
    let desk = Desk::new();
    for folder in ["a", "b"] {
        std::fs::create_dir(desk.file(folder)).unwrap();
        desk.put(&format!("{folder}/walk.csv"), std::fs::read(example("pelvis.csv")).unwrap());
    }
    let ran = desk.run(&["orient", "a/walk.csv", "b/walk.csv", "--no-report"]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    assert_eq!(desk.names(), ["a", "a-walk.orientation.csv", "b", "b-walk.orientation.csv"]);
}

#[test]
fn an_accelerometer_file_and_a_gyroscope_file_make_one_recording() {
    let desk = Desk::new();
    let pelvis = std::fs::read_to_string(example("pelvis.csv")).unwrap();
    let (mut acc, mut gyro) = (
        String::from("\"Time (s)\",\"X (m/s^2)\",\"Y (m/s^2)\",\"Z (m/s^2)\"\n"),
        String::from("\"Time (s)\",\"X (rad/s)\",\"Y (rad/s)\",\"Z (rad/s)\"\n"),
    );
    for (k, line) in pelvis.lines().skip(1).enumerate() {
        let c: Vec<&str> = line.split(',').collect();
        let t = k as f64 / 100.0;
        acc.push_str(&format!("{t},{},{},{}\n", c[1], c[2], c[3]));
        gyro.push_str(&format!("{t},{},{},{}\n", c[4], c[5], c[6]));
    }
    std::fs::create_dir(desk.file("walk")).unwrap();
    desk.put("walk/Accelerometer.csv", acc);
    desk.put("walk/Gyroscope.csv", gyro);
    let pair = ["walk/Gyroscope.csv", "walk/Accelerometer.csv"];
    let ran = desk.run(&[&["orient", "--no-report"][..], &pair].concat());
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    assert_eq!(desk.names(), ["walk", "walk.orientation.csv"]);
    // It has all that one recording has.
    let ran =
        desk.run(&[&["orient", "-o", "-", "--report", "w.html", "--plot", "w.png"][..], &pair].concat());
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    assert_eq!(ran.stdout, desk.text("walk.orientation.csv"));
    assert_eq!(desk.names(), ["w.html", "w.png", "walk", "walk.orientation.csv"]);
    let ran = desk.run(&[&["info", "--json"][..], &pair].concat());
    let report: serde_json::Value = serde_json::from_str(&ran.stdout).expect("one JSON object");
    assert_eq!(report["is_recording"], true, "{report}");
    // In a directory it is one of many.
    let ran = desk.run(&["orient", "walk", "-o", "out", "--no-report", "--lang", "en"]);
    assert!(ran.stderr.contains("1 done, 0 failed"), "{}", ran.stderr);
}

#[test]
fn a_batch_ends_with_the_worst_exit_code() {
    let desk = Desk::new();
    let pelvis = std::fs::read(example("pelvis.csv")).unwrap();
    desk.put("walk.csv", &pelvis);
    desk.put("empty.csv", "");
    for (files, expected) in [
        (&["walk.csv", "walk.csv"][..], 0),
        (&["walk.csv", "empty.csv"], 2),
        (&["empty.csv", "no.csv"], 2),
        (&["no.csv"], 2),
    ] {
        for command in [&["orient", "--no-report"][..], &["info"]] {
            let ran = desk.run(&[command, files].concat());
            assert_eq!(ran.code, expected, "{command:?} {files:?}: {}", ran.stderr);
        }
    }
    // No rest of 400 s is a condition that is not met; with a file that is none beside it, the input is bad.
    let rest = ["orient", "--no-report", "--rest", "400:500", "walk.csv"];
    assert_eq!(desk.run(&[&rest[..], &["walk.csv"]].concat()).code, 1);
    assert_eq!(desk.run(&[&rest[..], &["no.csv"]].concat()).code, 2);
}

#[test]
fn what_was_assumed_is_said_of_many_and_in_json() {
    let desk = Desk::new();
    let pelvis = std::fs::read_to_string(example("pelvis.csv")).unwrap();
    let bare = pelvis.replacen("Gx[rad/s],Gy[rad/s],Gz[rad/s]", "gx,gy,gz", 1);
    for name in ["a.csv", "b.csv"] {
        desk.put(name, &bare);
    }
    for (lang, words) in [("en", "assumed (2): "), ("ja", "仮定 (2 件)：")] {
        let ran = desk.run(&["orient", "a.csv", "b.csv", "--no-report", "--json", "--lang", lang]);
        assert_eq!(ran.code, 0, "{}", ran.stderr);
        assert!(ran.stderr.contains(words), "{}", ran.stderr);
        let all: serde_json::Value = serde_json::from_str(&ran.stdout).expect("one JSON object");
        for result in all["results"].as_array().expect("results") {
            let one = desk.run(&["info", "a.csv", "--json", "--lang", lang]);
            let one: serde_json::Value = serde_json::from_str(&one.stdout).expect("one JSON object");
            assert!(result["assumptions"].as_array().is_some_and(|all| !all.is_empty()), "{result}");
            assert_eq!(result["assumptions"], one["assumptions"]);
        }
    }
}
