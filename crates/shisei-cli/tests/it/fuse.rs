//! `shisei fuse` on simulated takes: the simulator's Motive writer and its sensor.

use shisei_core::frames::Axes;
use shisei_core::{Quaternion, vector};
use shisei_twin::motive::{Body, Style, csv};
use shisei_twin::optics::{Cameras, Frame, Rig, film};
use shisei_twin::simulate::{Errors, Settings, simulate};
use shisei_twin::{Sensor, Simulation, movements};

use crate::run::Desk;

/// A tool that is lost twice, and the recording of its sensor.
fn take(seed: u64) -> (Vec<Frame>, Simulation) {
    let rig = Rig {
        body_from_sensor: Quaternion::from_rotation_vector([0.5, -1.2, 0.8]),
        sensor_m: [0.03, -0.02, 0.05],
        markers_m: Vec::new(),
    };
    let motion = movements::wander(seed, 3.0, 32.0);
    let settings = Settings { errors: Errors::DrawnAligned, ..Settings::new(200.0, seed) };
    let cameras = Cameras {
        offset_s: 2.3,
        lost_s: vec![(10.0, 11.0), (18.0, 20.0)],
        ..Cameras::new(120.0, 32.0, seed)
    };
    (film(&motion, &rig, &cameras), simulate(&motion, &Sensor::lsm6ds3tr_c(), &settings))
}

fn motive(frames: &[Frame], style: &Style) -> String {
    csv(&[Body { name: "Tool", bone: false, parent: "", frames, markers: false }], 120.0, style)
}

fn imu(simulation: &Simulation, frame: impl Fn(f64) -> f64) -> String {
    let mut text = String::from("time_s,acc_x,acc_y,acc_z,gyr_x,gyr_y,gyr_z,frame\n");
    for sample in &simulation.samples {
        let ([ax, ay, az], [gx, gy, gz]) = (sample.acc_m_s2, sample.gyro_rad_s);
        let frame = frame(sample.time_s);
        text.push_str(&format!("{},{ax},{ay},{az},{gx},{gy},{gz},{frame}\n", sample.time_s));
    }
    text
}

/// Frames from 0 at 2.3 s; nothing before the gate opens or after it closes.
fn gate(time_s: f64) -> f64 {
    let frame = (time_s - 2.3) * 120.0;
    if (0.0..=3840.0).contains(&frame) { frame } else { f64::NAN }
}

fn desk(frames: &[Frame], simulation: &Simulation) -> Desk {
    let desk = Desk::new();
    desk.put("take.csv", motive(frames, &Style::default()));
    desk.put("imu.csv", imu(simulation, gate).replace("NaN", ""));
    desk
}

#[test]
fn a_take_is_filled_and_written_in_every_format() {
    let (frames, simulation) = take(1);
    let desk = desk(&frames, &simulation);
    let ran = desk.run(&[
        "fuse",
        "take.csv",
        "imu.csv",
        "--json",
        "-o",
        "a.csv",
        "-o",
        "a.parquet",
        "-o",
        "a.sto",
        "-o",
        "a.mot",
        "-o",
        "a.glb",
        "-o",
        "a.mcap",
        "--motive",
        "filled.csv",
    ]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    let json: serde_json::Value = serde_json::from_str(&ran.stdout).expect("one object");
    assert_eq!(json["gaps"].as_array().map(Vec::len), Some(2));
    assert_eq!((json["none"].as_u64(), json["inertial"].as_u64()), (Some(0), Some(0)));
    // the readings count for the step before them: half a step of 5 ms
    let offset_s = json["offset_s"].as_f64().expect("a number");
    assert!((offset_s - (2.3 - 0.0025)).abs() < 5e-4, "{offset_s}");

    let text = desk.text("a.csv");
    let mut lines = text.lines();
    assert_eq!(
        lines.next(),
        Some("frame,time_s,p_x,p_y,p_z,q_w,q_x,q_y,q_z,source,gap_s,sigma_deg,sigma_mm,axes")
    );
    for (line, frame) in lines.zip(&frames) {
        let cells: Vec<&str> = line.split(',').collect();
        let p = [2, 3, 4].map(|k| cells[k].parse::<f64>().expect("a number"));
        let truth = Axes::ZUp.to(Axes::YUp).vector(frame.truth.position_m);
        assert!(vector::norm(vector::sub(p, truth)) < 0.02, "{line}");
        assert_eq!(cells[9], if frame.pose.is_some() { "optical" } else { "bridged" });
        assert_eq!(cells[13], "y-up");
    }
    let sto = desk.text("a.sto");
    assert!(sto.starts_with("DataRate=120.000000\nDataType=Quaternion\nversion=3\n"), "{sto:.200}");
    assert_eq!(sto.lines().skip_while(|line| *line != "endheader").count(), frames.len() + 2);
    assert!(sto.contains("\ntime\tTool\n0\t"));
    let mot = desk.text("a.mot");
    assert!(mot.contains(&format!("nRows={}\nnColumns=7\n", frames.len())), "{mot:.200}");
    let glb = std::fs::read(desk.file("a.glb")).expect("written");
    assert!(glb.starts_with(b"glTF") && glb.len().is_multiple_of(4));
    let mcap = std::fs::read(desk.file("a.mcap")).expect("written");
    assert!(mcap.starts_with(b"\x89MCAP0\r\n") && mcap.ends_with(b"\x89MCAP0\r\n"));
    assert!(std::fs::read(desk.file("a.parquet")).expect("written").starts_with(b"PAR1"));
    assert!(desk.text("take.fused.html").contains("<html"));

    // the filled take has no holes and can be fused again
    let bytes = std::fs::read(desk.file("filled.csv")).expect("written");
    let take =
        shisei_record::motive::read(&shisei_record::Input { name: "filled", bytes: &bytes }).expect("a take");
    let body = take.body(None).expect("one body");
    assert!((0..take.len()).all(|row| take.pose(&body, row).is_some()));
    let again = desk.run(&["fuse", "take.csv", "imu.csv", "--motive", "filled.csv"]);
    assert_eq!(again.code, 0, "our own take is overwritten: {}", again.stderr);
    desk.put("motives.csv", motive(&frames, &Style::default()));
    let other = desk.run(&["fuse", "take.csv", "imu.csv", "--motive", "motives.csv"]);
    assert_eq!(other.code, 2, "Motive's own is not: {}", other.stderr);
    for name in ["a.csv", "a.sto", "a.mot", "a.glb", "a.mcap", "a.parquet"] {
        let again = desk.run(&["fuse", "take.csv", "imu.csv", "-o", name]);
        assert_eq!(again.code, 0, "{name}: {}", again.stderr);
    }
}

#[test]
fn the_world_can_be_chosen_and_japanese_is_spoken() {
    let (frames, simulation) = take(2);
    let desk = desk(&frames, &simulation);
    let ran = desk.run(&[
        "--lang",
        "ja",
        "fuse",
        "take.csv",
        "imu.csv",
        "--axes",
        "z-up",
        "-o",
        "z.csv",
        "--no-report",
    ]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    assert!(ran.stderr.contains("欠落 フレーム 1200"), "{}", ran.stderr);
    let text = desk.text("z.csv");
    let cells: Vec<&str> = text.lines().nth(1).expect("a row").split(',').collect();
    for (axis, expected) in frames[0].truth.position_m.iter().enumerate() {
        assert!((cells[2 + axis].parse::<f64>().expect("a number") - expected).abs() < 0.002);
    }
    assert_eq!(cells[13], "z-up");
}

#[test]
fn the_receivers_sequence_is_used_and_checked() {
    let (frames, simulation) = take(3);
    let desk = desk(&frames, &simulation);
    let fuse =
        |imu: &str| desk.run(&["fuse", "take.csv", imu, "--sync", "sequence", "--no-report", "-o", "a.csv"]);
    let ran = fuse("imu.csv");
    assert_eq!(ran.code, 0, "{}", ran.stderr);

    let reset: fn(f64) -> f64 = |time| if time > 15.0 { gate(time) - 1000.0 } else { gate(time) };
    let short: fn(f64) -> f64 = |time| 0.9 * gate(time);
    let late: fn(f64) -> f64 = |time| gate(time - 2.0 / 120.0);
    let cases =
        [("reset.csv", reset, "goes back"), ("short.csv", short, "counted"), ("late.csv", late, "off by")];
    for (name, frame, word) in cases {
        desk.put(name, imu(&simulation, frame).replace("NaN", ""));
        let ran = fuse(name);
        assert_eq!(ran.code, 1, "{name}: {}", ran.stderr);
        assert!(ran.stderr.contains(word) && ran.stderr.contains("--sync rates"), "{}", ran.stderr);
    }
    // the same checks stand behind a file of pulses
    let pulses = |count: i32, skip: i32| -> String {
        let times = (0..count).filter(|k| *k != skip).map(|k| format!("{:.6}\n", 2.3 + f64::from(k) / 120.0));
        std::iter::once("pulse_s\n".to_owned()).chain(times).collect()
    };
    let fuse_by = |file: &str, more: &[&str]| {
        let mut words = vec!["fuse", "take.csv", "imu.csv", "--no-report", "-o", "a.csv", "--pulses", file];
        words.extend(more);
        desk.run(&words)
    };
    for (name, text, word) in [
        ("few.csv", pulses(3000, -1), "3000 pulses and the take has 3841 frames"),
        ("missing.csv", pulses(3842, 1700), "pulses are missing"),
    ] {
        desk.put(name, text);
        let ran = fuse_by(name, &["--sync", "pulse-file"]);
        assert_eq!(ran.code, 1, "{name}: {}", ran.stderr);
        assert!(ran.stderr.contains(word), "{}", ran.stderr);
    }
    // as many as there are frames, but two frames late: the rotation tells
    let late: String = (2..3843).map(|k| format!("{:.6}\n", 2.3 + f64::from(k) / 120.0)).collect();
    desk.put("late-pulses.csv", late);
    let ran = fuse_by("late-pulses.csv", &["--sync", "pulse-file"]);
    assert_eq!(ran.code, 1, "{}", ran.stderr);
    assert!(ran.stderr.contains("off by"), "{}", ran.stderr);
    desk.put("pulses.csv", pulses(3841, -1));
    let ran = fuse_by("pulses.csv", &["--sync", "pulse-file"]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    assert_eq!(fuse_by("pulses.csv", &[]).code, 2);
    desk.put("none.csv", imu(&simulation, gate).replace("frame", "other"));
    let ran = fuse("none.csv");
    assert_eq!(ran.code, 2);
    assert!(ran.stderr.contains("no column frame"), "{}", ran.stderr);
}

#[test]
fn what_does_not_belong_together_is_refused_and_leaves_nothing() {
    let (frames, _) = take(4);
    let (_, stranger) = take(5);
    let desk = desk(&frames, &stranger);
    let before = desk.names();
    let ran = desk.run(&["fuse", "take.csv", "imu.csv"]);
    assert_eq!(ran.code, 1, "{}", ran.stderr);
    assert!(ran.stderr.contains("no common motion") && ran.stderr.contains("same object"), "{}", ran.stderr);
    let ran = desk.run(&["fuse", "imu.csv", "imu.csv"]);
    assert_eq!(ran.code, 2);
    assert!(ran.stderr.contains("Motive"), "{}", ran.stderr);
    let ran = desk.run(&["fuse", "take.csv", "imu.csv", "--body", "Hand"]);
    assert_eq!(ran.code, 2);
    assert!(ran.stderr.contains("Tool"), "{}", ran.stderr);
    let ran = desk.run(&["fuse", "take.csv", "imu.csv", "-o", "a.xyz"]);
    assert_eq!(ran.code, 2);
    assert_eq!(desk.names(), before);
}

#[test]
fn a_tool_in_a_hand_is_placed_by_its_sensor() {
    // the hand is filmed as a bone; what turns is the tool, which no camera sees
    let (hand, tool) = (movements::wander(8, 3.0, 20.0), movements::wander(9, 3.0, 20.0));
    let rig = Rig { body_from_sensor: Quaternion::IDENTITY, sensor_m: [0.0; 3], markers_m: Vec::new() };
    let cameras = Cameras { lost_s: vec![(7.5, 9.0)], ..Cameras::new(120.0, 20.0, 8) };
    let frames = film(&hand, &rig, &cameras);
    let settings = Settings { errors: Errors::DrawnAligned, ..Settings::new(200.0, 9) };
    let simulation = simulate(&tool, &Sensor::lsm6ds3tr_c(), &settings);
    let desk = Desk::new();
    let body = Body { name: "Anna:RHand", bone: true, parent: "Anna:RArm", frames: &frames, markers: false };
    desk.put("take.csv", csv(&[body], 120.0, &Style::default()));
    let gate = |time_s: f64| if time_s <= 20.0 { time_s * 120.0 } else { f64::NAN };
    desk.put("imu.csv", imu(&simulation, gate).replace("NaN", ""));
    let words = ["fuse", "take.csv", "imu.csv", "--mode", "relative", "--parent", "anna:rhand", "--json"];
    let with = |more: &[&str]| {
        let mut all = words.to_vec();
        all.extend(more);
        desk.run(&all)
    };
    let ran = with(&[
        "--sync",
        "sequence",
        "--grip",
        "-0.05,0.02,0.1,90,0,0",
        "--reference",
        "240",
        "-o",
        "tool.csv",
    ]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    let json: serde_json::Value = serde_json::from_str(&ran.stdout).expect("one object");
    assert_eq!((json["parent"].as_str(), json["reference_frame"].as_i64()), (Some("Anna:RHand"), Some(240)));
    let lost = json["none"].as_u64().expect("a count");
    assert_eq!((json["inertial"].as_u64(), lost), (Some(frames.len() as u64 - lost), 180));
    assert!(ran.stderr.contains("1.51 s, 180 none: the parent is lost\n"), "{}", ran.stderr);
    let text = desk.text("tool.csv");
    let to = Axes::ZUp.to(Axes::YUp);
    for (line, frame) in text.lines().skip(1).zip(&frames) {
        let cells: Vec<&str> = line.split(',').collect();
        if frame.pose.is_none() {
            assert_eq!(cells[9], "none");
            continue;
        }
        let number = |k: usize| cells[k].parse::<f64>().expect("a number");
        let truth = to.world_of_pose(frame.truth).expect("right-handed");
        let place = vector::add(truth.position_m, truth.world_from_body.rotate([-0.05, 0.02, 0.1]));
        assert!(vector::norm(vector::sub([2, 3, 4].map(number), place)) < 2e-3, "{line}");
        if frame.number == 240 {
            // turned by 90° about the hand's z
            let q = Quaternion::new(number(5), number(6), number(7), number(8));
            let turned = truth.world_from_body.conjugate().product(q).to_rotation_vector();
            assert!((turned[2].to_degrees() - 90.0).abs() < 0.2 && turned[0].abs() < 0.005, "{turned:?}");
        }
    }
    for (more, word) in [
        (vec!["--sync", "rates"], "--sync sequence"),
        (vec!["--sync", "sequence", "--grip", "1,2"], "YAW"),
        (vec!["--sync", "sequence", "--reference", "99999"], "no frame 99999"),
        (
            vec!["--sync", "sequence", "--reference", "960"],
            "--reference 960: in the reference frame the parent is lost",
        ),
        (vec!["--sync", "pulse-file"], "--pulses"),
        (vec!["--sync", "sequence", "--motive", "a.csv"], "--motive"),
    ] {
        let ran = with(&more);
        assert_eq!(ran.code, 2, "{more:?}: {}", ran.stderr);
        assert!(ran.stderr.contains(word), "{}", ran.stderr);
    }
    let ran = with(&["--sync", "sequence", "--reference", "960", "--lang", "ja"]);
    assert!(ran.stderr.contains("--reference 960：基準フレームで親が失われています"), "{}", ran.stderr);
    let ran = desk.run(&["fuse", "take.csv", "imu.csv", "--parent", "Anna:RHand"]);
    assert_eq!(ran.code, 2, "{}", ran.stderr);
}

#[test]
fn what_is_missing_is_said_frame_by_frame() {
    let (frames, mut simulation) = take(6);
    // 0.3 s without samples in the second gap, which lasts from 18 to 20 s
    simulation.samples.retain(|sample| !(18.5..18.8).contains(&(sample.time_s - 2.3)));
    let desk = desk(&frames, &simulation);
    let text = desk.text("take.csv");
    let cut = text.find("\r\n3601,").expect("the row") + 10;
    desk.put("cut.csv", &text[..cut]);
    let words =
        ["fuse", "cut.csv", "imu.csv", "--no-report", "-o", "a.csv", "--motive", "filled.csv", "--force"];
    let ran = desk.run(&words);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    for part in [
        "warning: the take's last row (line 3609) ends in its middle",
        "has 3601 frames, and its first row says 3841",
        "gap at frame 1200: 1.01 s, 120 bridged, up to ",
        "gap at frame 2160: 2.01 s, ",
        " inertial: attitude only to be trusted, up to ",
        " none: no inertial samples\n",
    ] {
        assert!(ran.stderr.contains(part), "{part}: {}", ran.stderr);
    }
    let mut sources = std::collections::BTreeMap::new();
    for line in desk.text("a.csv").lines().skip(2161).take(240) {
        *sources.entry(line.split(',').nth(9).expect("a source").to_owned()).or_insert(0) += 1;
    }
    let count = |source: &str| sources.get(source).copied().unwrap_or(0);
    assert!((36..=40).contains(&count("none")) && count("inertial") == 240 - count("none"), "{sources:?}");
    let filled = desk.text("filled.csv");
    assert!(filled.contains("Total Exported Frames,3601,") && filled.contains("\n3600,"), "{filled:.400}");
    let ran = desk.run(&[&words[..], &["--lang", "ja"]].concat());
    assert!(
        ran.stderr.contains("テイクの最後の行 (3609 行目)")
            && ran.stderr.contains(" フレーム なし: 慣性センサ"),
        "{}",
        ran.stderr
    );
}

#[test]
fn a_marker_that_is_still_seen_holds_the_body() {
    let rig = Rig {
        body_from_sensor: Quaternion::from_rotation_vector([0.5, -1.2, 0.8]),
        sensor_m: [0.03, -0.02, 0.05],
        markers_m: vec![[0.05, 0.0, 0.01], [0.0, 0.06, 0.02], [-0.04, 0.0, 0.03], [0.0, -0.05, 0.0]],
    };
    let motion = movements::wander(5, 3.0, 32.0);
    let settings = Settings { errors: Errors::DrawnAligned, ..Settings::new(200.0, 5) };
    let cameras = Cameras { offset_s: 2.3, hidden_s: vec![(12.0, 24.0, 1)], ..Cameras::new(120.0, 32.0, 5) };
    let frames = film(&motion, &rig, &cameras);
    let simulation = simulate(&motion, &Sensor::lsm6ds3tr_c(), &settings);
    let desk = desk(&frames, &simulation);
    let body = Body { name: "Tool", bone: false, parent: "", frames: &frames, markers: true };
    desk.put("marked.csv", csv(&[body], 120.0, &Style { units: "Millimeters", ..Style::default() }));
    let fused = |take: &str| {
        let ran = desk.run(&["fuse", take, "imu.csv", "--json", "-o", "a.csv", "--no-report", "--force"]);
        assert_eq!(ran.code, 0, "{}", ran.stderr);
        let json: serde_json::Value = serde_json::from_str(&ran.stdout).expect("one object");
        let mut most_mm = 0.0_f64;
        for (line, frame) in desk.text("a.csv").lines().skip(1).zip(&frames) {
            let cells: Vec<&str> = line.split(',').collect();
            let p = [2, 3, 4].map(|k| cells[k].parse::<f64>().expect("a number"));
            let truth = Axes::ZUp.to(Axes::YUp).vector(frame.truth.position_m);
            most_mm = most_mm.max(1e3 * vector::norm(vector::sub(p, truth)));
            assert_eq!(cells[9], if frame.pose.is_some() { "optical" } else { "bridged" });
        }
        (json, most_mm, ran.stderr)
    };
    let (bare, bare_mm, _) = fused("take.csv");
    let (json, most_mm, told) = fused("marked.csv");
    assert!(most_mm < 2.0 && bare_mm > 10.0, "{most_mm} {bare_mm}");
    assert_eq!(
        (bare["markers"].as_array().map(Vec::len), bare["held_by_markers"].as_u64()),
        (Some(0), Some(0))
    );
    assert_eq!(json["markers"][1]["name"].as_str(), Some("Tool:Marker2"));
    let at_m = json["markers"][1]["at_m"].as_array().expect("placed");
    assert!((at_m[1].as_f64().expect("a number") - 0.06).abs() < 1e-4, "{at_m:?}");
    let held = json["held_by_markers"].as_u64().expect("a count");
    assert!((1430..=1440).contains(&held) && told.contains("4 of 4 sit on the body"), "{held} {told}");
    assert!(json["gaps"][0]["sigma_mm"].as_f64() < Some(3.0));
}
