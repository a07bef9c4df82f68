//! Recordings of a receiver (`shisei record`) in the other commands: several nodes in one take, orientation, gaps of an
//! optical take of the same movement.

use shisei_core::frames::Axes;
use shisei_core::vector::{norm, sub};
use shisei_core::{Quaternion, math};
use shisei_twin::motive::{Body, Style, csv};
use shisei_twin::optics::{Cameras, Frame, Rig, film};
use shisei_twin::{Motion, Path, movements};

use crate::run::{Desk, numbers};

const CAMERA_HZ: f64 = 120.0;
/// The recording gate, s: frame 0.
const GATE_S: f64 = 4.0;

/// The movement of a node of `shisei simulate lab` with its default seed.
fn movement(node: u64) -> Path {
    movements::wander(64 + node, 3.0, 54.0)
}

/// A desk with `take.mcap`: two nodes for 50 s.
fn recorded() -> Desk {
    let desk = Desk::new();
    let ran = desk.run(&["simulate", "lab", "--for", "50", "--gate", "4", "-o", "lab.bin"]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    let ran = desk.run(&["record", "lab.bin", "-o", "take.mcap"]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    desk
}

/// What the cameras saw of the body that carries a node, lost twice.
fn filmed(node: u64) -> Vec<Frame> {
    let rig = Rig {
        body_from_sensor: Quaternion::from_rotation_vector([0.5, -1.2, 0.8]),
        sensor_m: [0.03, -0.02, 0.05],
        markers_m: Vec::new(),
    };
    let cameras = Cameras {
        offset_s: GATE_S,
        lost_s: vec![(12.0, 13.0), (25.0, 27.0)],
        // as long as the recording after the gate: 5520 frames
        ..Cameras::new(CAMERA_HZ, 46.0 - 1.0 / CAMERA_HZ, 9)
    };
    film(&movement(node), &rig, &cameras)
}

#[test]
fn several_nodes_are_named_and_one_is_chosen() {
    let desk = recorded();
    desk.put(
        "optical.csv",
        csv(
            &[Body { name: "Tool", bone: false, parent: "", frames: &filmed(1), markers: false }],
            CAMERA_HZ,
            &Style::default(),
        ),
    );
    for (lang, word) in [("en", "choose one with --sensor"), ("ja", "--sensor")] {
        for command in [
            &["orient", "take.mcap"][..],
            &["calibrate", "take.mcap"],
            &["motion", "take.mcap"],
            &["convert", "take.mcap", "-o", "x.csv"],
            &["fuse", "optical.csv", "take.mcap"],
        ] {
            let ran = desk.run(&[command, &["--lang", lang]].concat());
            let named = ["node 0", "node 1", word].iter().all(|word| ran.stderr.contains(word));
            assert!(ran.code == 2 && named, "{command:?}: {} {}", ran.code, ran.stderr);
        }
        // A recording is no fused take, though shisei wrote both.
        desk.put("other.mcap", std::fs::read(desk.file("take.mcap")).expect("recorded"));
        let ran = desk.run(&["fuse", "optical.csv", "take.mcap", "-o", "other.mcap", "--lang", lang]);
        assert!(ran.code == 2 && ran.stderr.contains("--force"), "{}", ran.stderr);
        std::fs::remove_file(desk.file("other.mcap")).expect("put there");
        // To list them is what info is for.
        let ran = desk.run(&["info", "take.mcap", "--lang", lang]);
        assert!(ran.code == 0 && ran.stdout.contains(" node 0, node 1\n"), "{} {}", ran.stdout, ran.stderr);
        let ran = desk.run(&["orient", "take.mcap", "--sensor", "5", "--lang", lang]);
        assert!(ran.code == 2 && ran.stderr.contains("node 0, node 1"), "{}", ran.stderr);
    }
    assert_eq!(desk.names(), ["lab.bin", "optical.csv", "take.mcap"]);
}

#[test]
fn a_nodes_orientation_is_that_of_its_movement() {
    let desk = recorded();
    for node in [0, 1] {
        let sensor = node.to_string();
        let args = ["orient", "take.mcap", "--sensor", &sensor, "--keep", "--no-report", "-o", "o.csv"];
        let ran = desk.run(&args);
        assert_eq!(ran.code, 0, "{}", ran.stderr);
        let text = desk.text("o.csv");
        let header: Vec<&str> = text.lines().next().expect("a header").split(',').collect();
        let column = |name: &str| header.iter().position(|found| *found == name).expect(name);
        let (q, frame, gate) =
            (["q_w", "q_x", "q_y", "q_z"].map(column), column("frame"), column("from_gate"));
        let motion = movement(node);
        let (mut squares, mut count) = (0.0, 0.0);
        for line in text.lines().skip(1) {
            let cells: Vec<&str> = line.split(',').collect();
            let (Ok(frame), "true") = (cells[frame].parse::<f64>(), cells[gate]) else { continue };
            let [w, x, y, z] = q.map(|column| cells[column].parse::<f64>().expect("a number"));
            let truth = motion.state(GATE_S + frame / CAMERA_HZ).world_from_body;
            let error = Quaternion::new(w, x, y, z).product(truth.conjugate()).rotate([0.0, 0.0, 1.0]);
            let tilt_deg = math::acos(error[2].clamp(-1.0, 1.0)).to_degrees();
            squares += tilt_deg * tilt_deg;
            count += 1.0;
        }
        let rms_deg = math::sqrt(squares / count);
        println!("node {node}: {count} rows, inclination {rms_deg:.2}°");
        assert!(count > 5_000.0, "{count}");
        // a sensor as delivered; that of the other node's movement is off by 60° and more
        assert!(rms_deg < 4.0, "node {node}: {rms_deg}");
    }
}

#[test]
fn gaps_of_a_take_are_filled_from_the_node_on_the_body() {
    let desk = recorded();
    let frames = filmed(1);
    let bodies = [Body { name: "Tool", bone: false, parent: "", frames: &frames, markers: false }];
    desk.put("optical.csv", csv(&bodies, CAMERA_HZ, &Style::default()));
    for sync in ["rates", "sequence"] {
        let args = ["fuse", "optical.csv", "take.mcap", "--sensor", "node 1", "--sync", sync, "-o", "f.csv"];
        let ran = desk.run(&[&args[..], &["--no-report", "--json"]].concat());
        assert_eq!(ran.code, 0, "{sync}: {}", ran.stderr);
        let told: serde_json::Value = serde_json::from_str(&ran.stdout).expect("JSON");
        assert_eq!(told["gaps"].as_array().map(Vec::len), Some(2), "{told}");
        let text = desk.text("f.csv").replace("optical", "1").replace("bridged", "2").replace("y-up", "0");
        let filled: String = text.lines().map(|line| line.replace(",,", ",0,") + "\n").collect();
        let (_, rows) = numbers(&filled);
        assert_eq!(rows.len(), frames.len());
        let (mut worst_m, mut bridged) = (0.0_f64, 0);
        for (row, frame) in rows.iter().zip(&frames) {
            let truth = Axes::ZUp.to(Axes::YUp).vector(frame.truth.position_m);
            worst_m = worst_m.max(norm(sub([row[2], row[3], row[4]], truth)));
            bridged += usize::from(frame.pose.is_none());
        }
        println!("{sync}: {bridged} frames bridged, off by {:.1} mm at most", 1e3 * worst_m);
        assert_eq!(bridged, 360);
        assert!(worst_m < 0.05, "{sync}: {worst_m} m");
    }
    // the node that is on something else
    let ran = desk.run(&["fuse", "optical.csv", "take.mcap", "--sensor", "0", "-o", "wrong.csv"]);
    assert_eq!(ran.code, 1, "{}", ran.stderr);
    println!("{}", ran.stderr);
    assert!(!desk.names().contains(&"wrong.csv".to_owned()));
}
