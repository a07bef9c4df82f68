//! A simulated laboratory at a pseudo-terminal, recorded; unplugged, named.

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;
use shisei_hub::Item;

use crate::run::Desk;

/// A laboratory and the name of its port.
pub struct Lab {
    child: Child,
    pub port: String,
}

impl Lab {
    pub fn start(args: &[&str]) -> Self {
        let mut command = Command::new(env!("CARGO_BIN_EXE_shisei"));
        command.args(["simulate", "lab"]).args(args).stdout(Stdio::piped()).stderr(Stdio::null());
        let mut child = command.spawn().expect("the laboratory");
        let mut line = String::new();
        BufReader::new(child.stdout.take().expect("piped")).read_line(&mut line).expect("the port's name");
        Lab { child, port: line.trim().to_owned() }
    }

    /// Until so many nodes are connected.
    fn wait_for(&self, desk: &Desk, nodes: usize) {
        let connected = || {
            let ran = desk.run(&["devices", &self.port, "--json"]);
            let told: Option<Value> = serde_json::from_str(&ran.stdout).ok();
            let all = told.as_ref().and_then(|told| told["receivers"][0]["nodes"].as_array());
            all.map_or(0, |all| all.iter().filter(|node| node["connected"] == true).count())
        };
        let begun = Instant::now();
        while connected() < nodes {
            assert!(begun.elapsed() < Duration::from_secs(60), "not all nodes are connected");
        }
    }
}

impl Drop for Lab {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// The port's bytes in a recording.
pub fn raw(path: &Path) -> Vec<u8> {
    let mut bytes = Vec::new();
    let file = std::fs::read(path).expect("the recording");
    shisei_hub::read::raw(&file, |_, _, more| bytes.extend_from_slice(more)).expect("readable");
    bytes
}

#[test]
fn an_unplugged_port_is_said_and_what_was_recorded_is_there() {
    let desk = Desk::new();
    let lab = Lab::start(&["--for", "4"]);
    let ran = desk.run(&["record", &lab.port, "-o", "take.mcap", "--wait", "0.1", "--json"]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    assert!(ran.stderr.contains("the port is gone"), "{}", ran.stderr);
    let told: Value = serde_json::from_str(&ran.stdout).expect("JSON");
    assert!(told["samples"].as_u64().is_some_and(|samples| samples > 300), "{told}");
    assert!(raw(&desk.file("take.mcap")).len() > 10_000);
    // A recording is never overwritten unasked.
    desk.put("bytes.bin", [0xA5; 64]);
    let again = desk.run(&["record", "bytes.bin", "-o", "take.mcap"]);
    assert_eq!(again.code, 2);
    assert!(again.stderr.contains("--force"), "{}", again.stderr);
}

#[test]
fn nodes_are_listed_and_named() {
    let desk = Desk::new();
    let lab = Lab::start(&["--for", "120"]);
    lab.wait_for(&desk, 2);
    let named = desk.run(&["devices", &lab.port, "--rename", "0=left", "--identify", "all"]);
    assert_eq!(named.code, 0, "{}", named.stderr);
    assert!(named.stdout.contains("left") && named.stdout.contains("node 1"), "{}", named.stdout);
    // the shortest recording has the names, too
    let ran = desk.run(&["record", &lab.port, "-o", "short.mcap", "--for", "2"]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    let (mut session, mut items) = (shisei_hub::Session::default(), Vec::new());
    session.push(&raw(&desk.file("short.mcap")), &mut items);
    let named = |item: &Item| matches!(item, Item::Node(node) if node.name == "left");
    assert!(items.iter().any(named), "no name in the recording");
    let wrong = desk.run(&["devices", &lab.port, "--identify", "5"]);
    assert_eq!(wrong.code, 1, "{}", wrong.stderr);
    let wrong = desk.run(&["devices", &lab.port, "--configure", "0=best,4,2000,8"]);
    assert_eq!(wrong.code, 2, "{}", wrong.stderr);
    let none = desk.run(&["devices", "no-such-port"]);
    assert_eq!(none.code, 2, "{}", none.stderr);
}

#[test]
fn a_file_of_bytes_is_recorded_like_a_port() {
    let desk = Desk::new();
    assert_eq!(desk.run(&["simulate", "lab", "-o", "bytes.bin", "--for", "8", "--reboot", "1:5"]).code, 0);
    let ran = desk.run(&["record", "bytes.bin", "-o", "take.mcap", "--lang", "ja"]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    assert!(ran.stderr.contains("サンプル"), "{}", ran.stderr);
    assert_eq!(raw(&desk.file("take.mcap")), std::fs::read(desk.file("bytes.bin")).expect("the bytes"));
    assert_eq!(desk.run(&["simulate", "lab", "--nodes", "7", "-o", "x"]).code, 2);
    // its own earlier file is written anew, another is not
    assert_eq!(desk.run(&["simulate", "lab", "-o", "bytes.bin", "--for", "1"]).code, 0);
    std::fs::write(desk.file("thesis.txt"), "years of work").expect("written");
    let ran = desk.run(&["simulate", "lab", "-o", "thesis.txt", "--for", "1"]);
    assert!(ran.code == 2 && ran.stderr.contains("thesis.txt exists"), "{}", ran.stderr);
    assert_eq!(std::fs::read(desk.file("thesis.txt")).expect("there"), b"years of work");
    // two nodes, so there is no third to be restarted or taken out of reach
    for wrong in [["--reboot", "2:3"], ["--outage", "2:1:3"], ["--outage", "1:3:1"]] {
        let ran = desk.run(&[&["simulate", "lab", "-o", "x"][..], &wrong].concat());
        assert!(ran.code == 2 && ran.stderr.contains(wrong[0]), "{wrong:?}: {}", ran.stderr);
    }
}

/// From a recording of poses to a node that corrects its own readings.
#[test]
fn a_node_is_given_its_calibration() {
    let desk = Desk::new();
    let part = ["--nodes", "1", "--seed", "12"];
    let fine = |args: &[&str]| {
        let ran = desk.run(args);
        assert_eq!(ran.code, 0, "{args:?}: {}", ran.stderr);
        ran
    };
    let poses = ["--movement", "poses", "--for", "116", "-o", "poses.bin"];
    fine(&[&["simulate", "lab"], &part[..], &poses].concat());
    fine(&["record", "poses.bin", "-o", "poses.mcap"]);
    fine(&["calibrate", "poses.mcap", "--method", "gyro-turns", "-o", "cal.json", "--no-report"]);

    let lab = Lab::start(&[&part[..], &["--for", "120"]].concat());
    lab.wait_for(&desk, 1);
    let told = fine(&["devices", &lab.port, "--store-calibration", "0=cal.json", "--json"]).stdout;
    let told: Value = serde_json::from_str(&told).expect("JSON");
    let kept = &told["receivers"][0]["nodes"][0]["calibration"];
    let file: Value = serde_json::from_str(&desk.text("cal.json")).expect("JSON");
    for (sensor, bias) in [("accelerometer", "bias_m_s2"), ("gyroscope", "bias_rad_s")] {
        let numbers = |value: &Value| -> Vec<f64> {
            let rows = value[sensor]["matrix"].as_array().expect("a matrix").iter();
            let all = rows.chain([&value[sensor][bias]]).flat_map(|row| row.as_array().expect("a row"));
            all.map(|number| number.as_f64().expect("a number")).collect()
        };
        let (kept, given) = (numbers(kept), numbers(&file));
        assert_eq!(kept.len(), 12);
        assert!(kept.iter().zip(&given).all(|(a, b)| (a - b).abs() < 1e-7), "{kept:?} {given:?}");
    }
    let id = kept["id"].as_str().expect("a number").to_owned();
    // kept, and told to whoever asks next; then taken away
    let listed = fine(&["devices", &lab.port, "--lang", "ja"]).stdout;
    assert!(listed.contains(&format!("キャリブレーション済み ({id})")), "{listed}");
    let listed = fine(&["devices", &lab.port, "--store-calibration", "all=none"]).stdout;
    assert!(listed.contains("node 0") && !listed.contains("calibrated"), "{listed}");
    let absent = desk.run(&["devices", &lab.port, "--store-calibration", "3=cal.json"]);
    assert_eq!(absent.code, 1, "{}", absent.stderr);

    // a laboratory whose node keeps it from the start says so in every packet
    let kept = ["--calibration", "0=cal.json", "--for", "4", "-o", "kept.bin"];
    fine(&[&["simulate", "lab"], &part[..], &kept].concat());
    let (mut session, mut items) = (shisei_hub::Session::default(), Vec::new());
    session.push(&std::fs::read(desk.file("kept.bin")).expect("the bytes"), &mut items);
    let calibrated = |item: &shisei_hub::Item| match item {
        shisei_hub::Item::Sample(sample) => Some(sample.calibrated),
        _ => None,
    };
    assert!(items.iter().filter_map(calibrated).count() > 300);
    assert!(items.iter().filter_map(calibrated).all(|calibrated| calibrated));
}

#[test]
fn a_calibration_that_cannot_be_one_is_refused() {
    let desk = Desk::new();
    // in g
    let sensor = r#"{"bias_m_s2": [0, 0, 0], "bias_rad_s": [0, 0, 0], "matrix": [[0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]]}"#;
    desk.put(
        "g.json",
        format!(r#"{{"format": "shisei-calibration", "version": 1, "accelerometer": {sensor}, "gyroscope": {sensor}}}"#),
    );
    for (lang, word) in [("en", "identity"), ("ja", "単位行列")] {
        let ran = desk.run(&["devices", "no-such-port", "--store-calibration", "0=g.json", "--lang", lang]);
        assert!(ran.code == 2 && ran.stderr.contains(word), "{} {}", ran.code, ran.stderr);
        let lab = ["simulate", "lab", "--calibration", "0=g.json", "-o", "x", "--lang", lang];
        let ran = desk.run(&lab);
        assert!(ran.code == 2 && ran.stderr.contains(word), "{} {}", ran.code, ran.stderr);
    }
    for (value, word) in [("0", "CAL.json"), ("x=g.json", "CAL.json"), ("0=absent.json", "absent.json")] {
        let ran = desk.run(&["devices", "no-such-port", "--store-calibration", value]);
        assert!(ran.code == 2 && ran.stderr.contains(word), "{value}: {} {}", ran.code, ran.stderr);
    }
    assert_eq!(desk.names(), ["g.json"]);
}
