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
    assert_eq!(ran.code, 1, "{}", ran.stderr);
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
    assert_eq!(ran.code, 1);
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
    let ran = desk.run(&["orient", "walk/Accelerometer.csv", "walk/Gyroscope.csv", "--no-report"]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    assert_eq!(desk.names(), ["walk", "walk.orientation.csv"]);
}
