//! Motive's tracking CSV in all its versions, as the simulator's own writer makes them, and a real sample.

use shisei_core::frames::{Axes, Pose};
use shisei_core::{Lang, Quaternion, vector};
use shisei_record::Input;
use shisei_record::motive::{LossRule, MarkerKind, Problem, Take, is_ours, looks_like, read, write};
use shisei_record::write::Decimals;
use shisei_twin::motive::{Body, Loss, Style, csv};
use shisei_twin::movements;
use shisei_twin::optics::{Cameras, Frame, Rig, film};

const RATE_HZ: f64 = 120.0;

fn rig() -> Rig {
    Rig {
        body_from_sensor: Quaternion::new(0.8, 0.2, -0.4, 0.4).normalized(),
        sensor_m: [0.03, -0.02, 0.05],
        markers_m: vec![[0.05, 0.0, 0.0], [0.0, 0.06, 0.01], [-0.04, 0.0, 0.03], [0.0, -0.05, 0.0]],
    }
}

/// Two seconds; lost from 0.5 s to 0.75 s, two markers left from 1.0 s to 1.25 s.
fn filmed(seed: u64) -> Vec<Frame> {
    let cameras = Cameras {
        offset_s: 1.0,
        lost_s: vec![(0.5, 0.75)],
        hidden_s: vec![(1.0, 1.25, 2)],
        ..Cameras::new(RATE_HZ, 2.0, seed)
    };
    film(&movements::wander(seed, 0.5, 10.0), &rig(), &cameras)
}

fn tool(frames: &[Frame]) -> Body<'_> {
    Body { name: "Tool", bone: false, parent: "", frames, markers: true }
}

/// What the take is said to lack, in English; there is Japanese too.
fn said(take: &Take) -> Vec<&str> {
    for warning in &take.warnings {
        assert!(warning.sentence(Lang::Ja).starts_with("テイク"), "{}", warning.sentence(Lang::Ja));
    }
    take.warnings.iter().map(|warning| warning.sentence(Lang::En)).collect()
}

fn take_of(text: &str) -> Take {
    let take = read(&Input { name: "take.csv", bytes: text.as_bytes() }).expect("a take");
    assert!(looks_like(text.as_bytes()) && !is_ours(text.as_bytes()));
    assert_eq!(said(&take), [""; 0]);
    take
}

/// The take's poses are the simulator's, to the six digits that are written, lost where they were lost.
fn check_poses(take: &Take, name: &str, frames: &[Frame], length_digits_m: f64) {
    let body = take.body(Some(name)).expect("the body");
    let tracked = take.tracked(&body, LossRule::default());
    assert_eq!(take.len(), frames.len());
    for (row, frame) in frames.iter().enumerate() {
        assert_eq!(tracked[row], frame.pose.is_some(), "row {row}");
        let Some(expected) = frame.pose else { continue };
        let found = take.pose(&body, row).expect("a pose");
        let found = take.axes().to(Axes::ZUp).world_of_pose(found).expect("right-handed");
        let apart = vector::norm(vector::sub(found.position_m, expected.position_m));
        assert!(apart < length_digits_m, "row {row}: {apart}");
        let turned = found.world_from_body.conjugate().product(expected.world_from_body).angle();
        assert!(turned < 3e-6, "row {row}: {turned}");
    }
}

/// Written and read again, everything is the same to the bit, but for the notes, which say that it was us.
fn check_round_trip(take: &Take) {
    let mut bytes = Vec::new();
    write(&mut bytes, take, Decimals::Shortest).expect("memory");
    let again = read(&Input { name: "again.csv", bytes: &bytes }).expect("our own file");
    assert!(is_ours(&bytes));
    let others =
        |take: &Take| take.info.iter().filter(|(key, _)| key != "Take Notes").cloned().collect::<Vec<_>>();
    assert_eq!(others(&again), others(take));
    let sign = format!("written by shisei {}", env!("CARGO_PKG_VERSION"));
    let notes = take.info("Take Notes").filter(|notes| !notes.is_empty());
    let signed = notes.map_or(sign.clone(), |notes| format!("{notes}; {sign}"));
    assert_eq!(again.info("Take Notes"), Some(signed.as_str()));
    assert_eq!(again.style, take.style);
    assert_eq!((&again.frame, &again.timecode), (&take.frame, &take.timecode));
    let bits =
        |values: &[f64]| values.iter().map(|v| if v.is_nan() { 1 } else { v.to_bits() }).collect::<Vec<_>>();
    assert_eq!(bits(&again.stamp_s), bits(&take.stamp_s));
    assert_eq!(again.columns.len(), take.columns.len());
    for (a, b) in again.columns.iter().zip(&take.columns) {
        let head = |c: &shisei_record::motive::Column| {
            [&c.kind, &c.name, &c.id, &c.parent, &c.quantity, &c.axis].map(ToString::to_string)
        };
        assert_eq!(head(a), head(b));
        assert_eq!(bits(&a.cells), bits(&b.cells), "{}", a.name);
    }
}

fn check(style: &Style) -> Take {
    let frames = filmed(3);
    let text = csv(&[tool(&frames)], RATE_HZ, style);
    let take = take_of(&text);
    let digits = 2e-6 / if style.units == "Meters" { 1.0 } else { 10.0 };
    check_poses(&take, "Tool", &frames, digits);
    assert_eq!(take.version(), style.version);
    for (row, time) in take.time_s().expect("a rate").into_iter().enumerate() {
        let expected = (style.first_frame + row as i64) as f64 / RATE_HZ;
        assert!((time - expected).abs() < 1e-12);
    }
    check_round_trip(&take);
    take
}

#[test]
fn every_version_and_form() {
    for version in ["1.21", "1.22", "1.23", "1.24", "1.25"] {
        for euler in [false, true] {
            for units in ["Meters", "Centimeters", "Millimeters"] {
                for z_up in [false, true] {
                    let take = check(&Style { version, euler, units, z_up, ..Style::default() });
                    assert_eq!(take.style.has_parents, version == "1.25");
                    assert_eq!(take.style.word_cell.is_none(), version == "1.21");
                }
            }
        }
    }
}

#[test]
fn a_time_code_shifts_all_columns() {
    for version in ["1.21", "1.24", "1.25"] {
        let take = check(&Style { version, timecode: true, ..Style::default() });
        assert_eq!(take.timecode.len(), take.len());
        assert_eq!(&*take.timecode[31], "10:00:01:01.0");
    }
}

#[test]
fn time_cut_to_milliseconds_is_not_used() {
    let take = check(&Style { time_digits: 3, first_frame: 17, ..Style::default() });
    assert_eq!(take.stamp_s[1], 0.15);
    assert!((take.time_s().expect("a rate")[1] - 18.0 / 120.0).abs() < 1e-15);
}

#[test]
fn frozen_poses_are_lost() {
    let frames = filmed(3);
    let style = Style { loss: Loss::Frozen, ..Style::default() };
    let take = take_of(&csv(&[tool(&frames)], RATE_HZ, &style));
    check_poses(&take, "Tool", &frames, 2e-6);
    let body = take.body(None).expect("one body");
    assert!(take.tracked(&body, LossRule { frozen_run: None }).iter().all(|tracked| *tracked));
    // as long as the run is shorter than the rule's
    let lost = frames.iter().filter(|frame| frame.pose.is_none()).count();
    let seen = take.tracked(&body, LossRule { frozen_run: Some(32) });
    assert!(lost > 32 && seen.iter().all(|tracked| *tracked));
}

#[test]
fn solved_markers_stay_filled_and_seen_ones_go_blank() {
    for version in ["1.21", "1.25"] {
        let frames = filmed(3);
        let take = take_of(&csv(&[tool(&frames)], RATE_HZ, &Style { version, ..Style::default() }));
        let markers = take.markers().expect("units");
        let count = |kind| markers.iter().filter(|marker| marker.kind == kind).count();
        assert_eq!((count(MarkerKind::Solved), count(MarkerKind::Labeled)), (4, 4));
        for (row, frame) in frames.iter().enumerate() {
            let of = |kind| {
                markers
                    .iter()
                    .filter(move |marker| marker.kind == kind)
                    .map(|marker| take.marker_m(marker, row))
            };
            assert!(of(MarkerKind::Solved).all(|place| place.is_some()));
            for (found, expected) in of(MarkerKind::Labeled).zip(&frame.markers_m) {
                assert_eq!(found.is_some(), expected.is_some(), "row {row}");
                if let (Some(found), Some(expected)) = (found, expected) {
                    let found = Axes::YUp.to(Axes::ZUp).vector(found);
                    assert!(vector::norm(vector::sub(found, *expected)) < 2e-6);
                }
            }
        }
        assert_eq!(count(MarkerKind::Single), 1);
        let body = take.body(None).expect("one body");
        assert!((take.marker_error_m(&body, 0).expect("an error") - 0.00012).abs() < 1e-9);
    }
}

#[test]
fn several_bodies_and_a_skeleton() {
    let (tool_frames, hand, lamp) = (filmed(3), filmed(4), filmed(5));
    let bodies = [
        tool(&tool_frames),
        Body { name: "佐藤:RHand", bone: true, parent: "佐藤:RFArm", frames: &hand, markers: false },
        Body { name: "Lamp, left ム", bone: false, parent: "", frames: &lamp, markers: true },
    ];
    for version in ["1.21", "1.24", "1.25"] {
        let take = take_of(&csv(&bodies, RATE_HZ, &Style { version, ..Style::default() }));
        check_poses(&take, "Tool", &tool_frames, 2e-6);
        check_poses(&take, "佐藤:RHand", &hand, 2e-6);
        check_poses(&take, "lamp, LEFT ム", &lamp, 2e-6);
        check_round_trip(&take);
        let names: Vec<String> = take.bodies().expect("units").into_iter().map(|body| body.name).collect();
        assert_eq!(names, ["Tool", "佐藤:RHand", "Lamp, left ム"]);
        let bone = take.body(Some("佐藤:RHand")).expect("the bone");
        assert!(bone.is_bone);
        assert_eq!(bone.parent, if version == "1.25" { "佐藤:RFArm" } else { "" });
        assert!(
            matches!(take.body(None).expect_err("three").problem, Problem::ManyBodies { names } if names.len() == 3)
        );
        let error = take.body(Some("Tol")).expect_err("no such body");
        assert!(error.sentence(Lang::En).contains("Tool, 佐藤:RHand"), "{error}");
    }
}

#[test]
fn text_that_is_not_ascii_in_any_encoding() {
    let frames = filmed(3);
    let style =
        Style {
            start_time: "2026-01-05 03.49.50.755 午後", take_name: "発表, 一回目", ..Style::default()
        };
    let text = csv(&[tool(&frames)], RATE_HZ, &style);
    let (shift_jis, _, _) = encoding_rs::SHIFT_JIS.encode(&text);
    let with_bom = format!("\u{feff}{text}");
    for bytes in [text.as_bytes(), &shift_jis, with_bom.as_bytes()] {
        let take = read(&Input { name: "take.csv", bytes }).expect("a take");
        assert_eq!(take.info("Capture Start Time"), Some("2026-01-05 03.49.50.755 午後"));
        assert_eq!(take.info("Take Name"), Some("発表,一回目"));
        assert_eq!(take.total_frames(), Some(241));
        check_poses(&take, "Tool", &frames, 2e-6);
    }
}

#[test]
fn a_filled_take_reads_as_it_was_filled() {
    let frames = filmed(3);
    for style in [
        Style::default(),
        Style { euler: true, units: "Millimeters", ..Style::default() },
        Style { euler: true, z_up: true, version: "1.21", ..Style::default() },
    ] {
        let mut take = take_of(&csv(&[tool(&frames)], RATE_HZ, &style));
        let body = take.body(None).expect("one body");
        let change = Axes::ZUp.to(take.axes());
        for (row, frame) in frames.iter().enumerate().filter(|(_, frame)| frame.pose.is_none()) {
            let pose = change.world_of_pose(frame.truth).expect("right-handed");
            take.set_pose(&body, row, &pose);
        }
        let mut bytes = Vec::new();
        write(&mut bytes, &take, Decimals::Shortest).expect("memory");
        let again = read(&Input { name: "again.csv", bytes: &bytes }).expect("our own file");
        let filled: Vec<Frame> =
            frames.iter().map(|f| Frame { pose: f.pose.or(Some(f.truth)), ..f.clone() }).collect();
        check_poses(&again, "Tool", &filled, 2e-6);
    }
}

#[test]
fn what_a_take_lacks_is_said() {
    let frames = filmed(3);
    let text = csv(&[tool(&frames)], RATE_HZ, &Style::default());
    let read_text = |text: &str| read(&Input { name: "take.csv", bytes: text.as_bytes() }).expect("a take");
    // cut off in the time of frame 121, in its frame number, in its last cell, and between two rows
    let row = text.find("\r\n121,1.008333,").expect("the row") + 2;
    let row_end = row + text[row..].find('\r').expect("its end");
    for (end, warnings) in [(row + 6, 2), (row + 2, 2), (row_end - 1, 2), (row, 1)] {
        let take = read_text(&text[..end]);
        assert_eq!((take.frame.last(), take.len()), (Some(&120), 121));
        let said = said(&take);
        assert_eq!(said.len(), warnings, "{said:?}");
        assert!(said[warnings - 1].contains("has 121 frames, and its first row says 241"), "{said:?}");
        assert!(warnings == 1 || said[0].contains("(line 129) ends in its middle"), "{said:?}");
        // what is written says how much it is, and is whole
        let mut bytes = Vec::new();
        write(&mut bytes, &take, Decimals::Shortest).expect("memory");
        let again = read(&Input { name: "again.csv", bytes: &bytes }).expect("our own file");
        assert_eq!((again.exported_frames(), again.total_frames()), (Some(121), Some(241)));
        assert_eq!((again.len(), again.warnings.len()), (121, 0));
        assert!(again.stamp_s.is_sorted());
    }
    // two rows left out
    let after = row_end + 2 + text[row_end + 2..].find('\n').expect("a row") + 1;
    let take = read_text(&format!("{}{}", &text[..row], &text[after..]));
    assert_eq!((take.len(), take.frame[120], take.frame[121]), (239, 120, 123));
    let said_of = said(&take);
    assert!(
        said_of.len() == 2 && said_of[0].contains("239 frames") && said_of[0].contains("241"),
        "{said_of:?}"
    );
    assert!(said_of[1].contains("2 frame numbers are missing") && said_of[1].contains("after frame 120"));
    // every second frame is no loss
    let heading = text.find("\r\n0,0.000000,").expect("the first row") + 2;
    let half: String = text[heading..].split_inclusive('\n').step_by(2).collect();
    let half = format!("{}{half}", text[..heading].replacen("Exported Frames,241", "Exported Frames,121", 1));
    assert_eq!(said(&read_text(&half)), [""; 0]);
    // a time that goes back is none
    let take = read_text(&text.replacen("\r\n130,1.083333,", "\r\n130,1.0,", 1));
    assert!(
        take.stamp_s[130].is_nan()
            && said(&take)
                == [
                    "the take's time column goes back at frame 130 (1 in all); those cells are taken as blank, and time is counted by frame numbers"
                ],
        "{:?}",
        said(&take)
    );
}

/// Every refusal says what and where, in both languages.
fn refused(text: &str) -> shisei_record::motive::Error {
    let error = read(&Input { name: "take.csv", bytes: text.as_bytes() }).expect_err("refused");
    for lang in [Lang::En, Lang::Ja] {
        assert!(error.sentence(lang).starts_with("take.csv"), "{}", error.sentence(lang));
    }
    error
}

#[test]
fn bad_takes_are_refused_with_their_place() {
    let frames = filmed(3);
    let text = csv(&[tool(&frames)], RATE_HZ, &Style::default());
    assert_eq!(refused("time,acc\n1,2\n").problem, Problem::NotMotive);
    assert!(matches!(refused("").problem, Problem::Bytes(_)));
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(refused(&lines[..7].join("\n")).problem, Problem::NoFrames);
    let swapped = [&lines[..9], &[lines[10], lines[9], ""]].concat().join("\n");
    let error = refused(&swapped);
    assert_eq!((&error.problem, error.place.line), (&Problem::FrameOrder { before: 3, now: 2 }, Some(11)));
    let error = refused(&text.replacen("\r\n2,0.016667,", "\r\n2,0.016667,oops", 1));
    assert_eq!((error.place.line, error.place.column.as_ref().map(|c| c.0)), (Some(10), Some(3)), "{error}");
    assert!(matches!(error.problem, Problem::NotANumber { .. }));

    let changed = |from: &str, to: &str| take_of(&text.replacen(from, to, 1));
    let error = changed("Units,Meters", "Units,Furlongs").bodies().expect_err("unit");
    assert!(matches!(error.problem, Problem::LengthUnit { .. }));
    let error = changed("Type,Quaternion", "Type,Rotor").bodies().expect_err("type");
    assert!(matches!(error.problem, Problem::RotationType { .. }));
    let silent = changed("Capture Frame Rate,120.000000,Export Frame Rate,120.000000", "Take Notes,");
    assert!((silent.rate_hz().expect("from the time column") - 120.0).abs() < 1e-3);
    let hand = Body { name: "S:Hand", bone: true, parent: "", frames: &frames, markers: false };
    let local = csv(&[hand], RATE_HZ, &Style::default()).replacen("Space,Global", "Space,Local", 1);
    assert_eq!(take_of(&local).body(None).expect_err("local").problem, Problem::LocalBones);
}

#[test]
fn a_table_of_nothing_is_refused_before_it_fills_the_memory() {
    let wide = "X,".repeat(100_000);
    let tall: String = (0..100_000).map(|row| format!("{row}\n")).collect();
    let text = format!("Format Version,1.24\n\n,Type,{wide}\nFrame,Time,{wide}\n{tall}");
    assert!(matches!(refused(&text).problem, Problem::Sparse { .. }));
}

/// Three points of the sample, checked by hand against its text.
#[test]
fn the_real_sample_reads_right_and_writes_back() {
    let root = std::env::var_os("SHISEI_DATA").map_or_else(
        || concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data").into(),
        std::path::PathBuf::from,
    );
    let file = root.join("motive/v1.21_quat_m_120Hz_rb_markers__hmv-s16.csv");
    let Ok(bytes) = std::fs::read(&file) else {
        eprintln!("skipped: the Motive sample is absent (SHISEI_DATA)");
        return;
    };
    let take = read(&Input { name: "sample.csv", bytes: &bytes }).expect("the sample");
    assert_eq!((take.len(), take.version(), take.total_frames()), (250, "1.21", Some(250)));
    assert_eq!(said(&take), [""; 0]);
    assert_eq!(take.info("Take Name"), Some("Take 2016-01-05 03.49.50 PM"));
    assert_eq!(take.rate_hz(), Ok(120.0));
    assert_eq!((take.axes(), take.style.time_heading.as_str()), (Axes::YUp, "Time"));
    let body = take.body(None).expect("one body");
    assert_eq!((body.name.as_str(), body.id.as_str()), ("Rigid Body 1", "CF5107FCB3ED11E565670A50E6808782"));
    let near = |pose: Pose, p: [f64; 3], xyzw: [f64; 4]| {
        let q = Quaternion::new(xyzw[3], xyzw[0], xyzw[1], xyzw[2]).normalized();
        pose.position_m == p && pose.world_from_body.conjugate().product(q).angle() < 1e-9
    };
    let pose = |row| take.pose(&body, row).expect("tracked");
    assert!(near(pose(0), [0.060002, 0.019150, 0.076611], [0.000035, 0.000016, -0.000030, -1.0]));
    assert!(near(pose(1), [0.060004, 0.019161, 0.076594], [-0.000008, 0.000024, 0.000029, -1.0]));
    assert!(near(pose(249), [0.060349, 0.019146, 0.076408], [-0.000041, -0.000154, 0.000022, -1.0]));
    assert!(take.tracked(&body, LossRule::default()).iter().all(|tracked| *tracked));
    let markers = take.markers().expect("units");
    let marker = |name: &str| markers.iter().find(|marker| marker.name == name).expect("the marker");
    assert_eq!(marker("Rigid Body 1_1").kind, MarkerKind::Solved);
    assert_eq!(take.marker_m(marker("Rigid Body 1:Marker2"), 0), Some([0.009910, 0.019217, 0.210209]));
    assert_eq!(take.marker_m(marker("Unlabeled:106"), 0), None);
    check_round_trip(&take);
}

#[test]
fn camera_pulses_give_the_samples_their_frames() {
    use shisei_record::motive::read_pulses;
    let take = "Format Version,1.24,Export Frame Rate,100,Total Frames in Take,5\n\n,Type\n,Name\n,ID\n\nFrame,Time\n0,0\n4,0.04\n";
    let take = shisei_record::motive::read(&Input { name: "take", bytes: take.as_bytes() }).expect("a take");
    let pulses = |text: &str| read_pulses(&Input { name: "pulses", bytes: text.as_bytes() });
    // 100 Hz by the cameras' clock; the sensor's runs 1 % fast and began 2 s before
    let all =
        pulses("time_s\n# middle of the exposure\n2.0\n2.0101\n2.0202\n\n2.0303\n2.0404\n").expect("five");
    assert_eq!(all, [2.0, 2.0101, 2.0202, 2.0303, 2.0404]);
    let times = take.pulses_s(&all, &[1.9, 2.0, 2.00505, 2.0404, 2.05]).expect("as many as frames");
    assert!(times[0].is_nan() && times[4].is_nan());
    for (found, expected) in times[1..4].iter().zip([0.0, 0.005, 0.04]) {
        assert!((found - expected).abs() < 1e-12, "{times:?}");
    }
    let refused = |pulses: &[f64]| take.pulses_s(pulses, &[2.0]).expect_err("refused").to_string();
    assert!(refused(&all[..4]).contains("4 pulses and the take has 5 frames"));
    let missing = [2.0, 2.0101, 2.0303, 2.0404, 2.0505];
    assert!(refused(&missing).contains("pulse 3 comes 20.200 ms") && refused(&missing).contains("missing"));
    assert!(refused(&[2.0, 2.0101, 2.012, 2.0202, 2.0303]).contains("one too many"));
    assert!(refused(&[2.0]).contains("too few"));
    // in ms in place of s
    let thousandfold: Vec<f64> = all.iter().map(|pulse_s| pulse_s * 1e3).collect();
    let none = take.pulses_s(&thousandfold, &[1.9, 2.0, 2.05]).expect_err("no sample between");
    assert!(
        none.sentence(Lang::En).contains("no sample lies between")
            && none.sentence(Lang::En).contains("in seconds")
    );
    assert!(none.sentence(Lang::Ja).contains("2000.000〜2040.400 秒"), "{}", none.sentence(Lang::Ja));
    for (text, word) in [
        ("", "empty"),
        ("1\n", "too few"),
        ("1\nx\n", "\"x\" is not a number"),
        ("2\n1\n", "not later"),
        ("a\nb\n", "not a number"),
    ] {
        let error = pulses(text).expect_err(text).to_string();
        assert!(error.contains(word), "{error}");
    }
    assert!(pulses("1\nnan\n").is_err() && pulses("1\ninf\n").is_err());
}

#[test]
fn a_bodys_own_markers_are_those_that_the_cameras_saw() {
    let frames = filmed(3);
    let stick = Body { name: "Tool2", ..tool(&frames) };
    let style = Style { units: "Centimeters", ..Style::default() };
    let mut take = take_of(&csv(&[tool(&frames), stick], RATE_HZ, &style));
    let body = take.body(Some("Tool")).expect("the body");
    let markers = take.markers_of(&body).expect("units");
    // not the solved ones, not the other body's, not the one without a name
    let names: Vec<&str> = markers.iter().map(|marker| marker.name.as_str()).collect();
    assert_eq!(names, ["Tool:Marker1", "Tool:Marker2", "Tool:Marker3", "Tool:Marker4"]);
    let to_z_up = take.axes().to(Axes::ZUp);
    for (index, marker) in markers.iter().enumerate() {
        let seen = take.sightings(marker, LossRule::default());
        for (found, frame) in seen.iter().zip(&frames) {
            let expected = frame.markers_m[index];
            assert_eq!(found.is_some(), expected.is_some());
            if let (Some(found), Some(expected)) = (found, expected) {
                let apart = vector::norm(vector::sub(to_z_up.vector(*found), expected));
                assert!(apart < 1e-7, "{apart}");
            }
        }
    }
    // five frames to the bit as the first of them
    let columns: Vec<usize> =
        (0..take.columns.len()).filter(|&k| take.columns[k].name.as_ref() == "Tool:Marker1").collect();
    for k in columns {
        let still = take.columns[k].cells[20];
        take.columns[k].cells[20..25].fill(still);
    }
    let seen = take.sightings(&markers[0], LossRule::default());
    assert!(seen[20].is_some() && seen[25].is_some() && seen[21..25].iter().all(Option::is_none));
    assert!(take.sightings(&markers[0], LossRule { frozen_run: None })[20..25].iter().all(Option::is_some));
}
