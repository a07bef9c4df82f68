//! What a hurried or careless user does: pipes that end, names that collide, options that mean nothing, numbers that
//! are none. Each is said in one sentence, and no result is lost or wrong in silence.

use std::process::{Command, Stdio};

use crate::run::{Desk, example};

/// Refused with exit 2 and these words, in English and in Japanese one line, and nothing is written.
fn check_refused(args: &[&str], words: &[&str]) {
    let desk = Desk::new();
    desk.put("in.csv", std::fs::read(example("pelvis.csv")).expect("the example"));
    for lang in ["en", "ja"] {
        let ran = desk.run(&[args, &["--lang", lang]].concat());
        assert_eq!(ran.code, 2, "{args:?}: {}", ran.stderr);
        for word in words.iter().filter(|word| lang == "en" || word.starts_with('-')) {
            assert!(ran.stderr.contains(word), "{args:?} says {word}: {}", ran.stderr);
        }
        if lang == "ja" {
            assert_eq!(ran.stderr.trim_end().lines().count(), 1, "{args:?}: {}", ran.stderr);
        }
        assert_eq!(desk.names(), ["in.csv"], "{args:?}");
    }
}

#[cfg(unix)]
fn shell(desk: &Desk, line: &str) -> (Option<i32>, String) {
    let program = env!("CARGO_BIN_EXE_shisei");
    let ran = Command::new("sh")
        .args(["-c", line, program])
        .current_dir(desk.path())
        .env("LC_ALL", "C.UTF-8")
        .stdin(Stdio::null())
        .output()
        .expect("a shell");
    (ran.status.code(), String::from_utf8_lossy(&ran.stderr).into_owned())
}

#[cfg(unix)]
#[test]
fn standard_output_on_a_full_disk_is_no_fault_of_ours() {
    let desk = Desk::new();
    desk.put("in.csv", std::fs::read(example("pelvis.csv")).expect("the example"));
    for command in ["info in.csv", "orient in.csv --json --no-report", "--help", "convert in.csv -o -"] {
        let (code, said) = shell(&desk, &format!("\"$0\" {command} > /dev/full"));
        assert_eq!(code, Some(2), "{command}: {said}");
        assert!(
            said.contains("could not be written: the disk is full") && !said.contains("panicked"),
            "{said}"
        );
    }
    assert_eq!(desk.names(), ["in.csv", "in.orientation.csv"], "what was computed is there");
}

#[cfg(unix)]
#[test]
fn a_reader_that_goes_away_is_no_error() {
    let desk = Desk::new();
    desk.put("in.csv", std::fs::read(example("pelvis.csv")).expect("the example"));
    for command in [
        "info in.csv in.csv in.csv",
        "orient in.csv --no-report -o -",
        "convert in.csv -o -",
        "orient --help",
    ] {
        // The status is that of shisei, not that of the reader, which ends before anything is written.
        let line = format!("{{ \"$0\" {command}; echo $? > status; }} | true");
        let (_, said) = shell(&desk, &line);
        assert_eq!(desk.text("status"), "0\n", "{command}: {said}");
        assert!(!said.contains("panicked") && !said.contains("Broken pipe"), "{command}: {said}");
    }
    // Nobody reads what is said either.
    let (code, _) = shell(&desk, "\"$0\" orient in.csv 2> /dev/full");
    assert_eq!(code, Some(0));
}

#[test]
fn two_results_never_go_to_one_file() {
    check_refused(&["orient", "in.csv", "--report", "x.html", "--plot", "./x.html"], &[".html"]);
    check_refused(&["orient", "in.csv", "-o", "-", "--report", "-"], &["two results"]);
    check_refused(&["allan", "in.csv", "-o", "x.csv", "--report", "x.csv"], &[".html"]);
    check_refused(&["fuse", "in.csv", "in.csv", "-o", "x.csv", "-o", "./x.csv"], &["two results"]);
}

#[test]
fn an_ending_that_lies_is_refused() {
    for args in [
        ["orient", "in.csv", "-o", "x.xlsx"],
        ["convert", "in.csv", "-o", "x.xlsx"],
        ["convert", "in.csv", "-o", "x.csv.gz"],
        ["motion", "in.csv", "-o", "x.parquet"],
        ["orient", "in.csv", "--plot", "x.jpg"],
        ["orient", "in.csv", "--report", "x.pdf"],
        ["orient", "in.csv", "--save-calibration", "x.csv"],
    ] {
        check_refused(&args, &["ends in"]);
    }
}

/// Before the recording is read, so that an hour of it is not computed in vain.
#[test]
fn a_place_that_is_not_there_is_refused_at_once() {
    check_refused(&["orient", "no.csv", "-o", "results/"], &["results/ is a directory"]);
    check_refused(&["orient", "no.csv", "-o", "results/x.csv"], &["results/x.csv", "no such directory"]);
    check_refused(&["motion", "no.csv", "--report", "results/x.html"], &["no such directory"]);
}

#[test]
fn options_without_a_meaning_are_refused() {
    check_refused(&["motion", "in.csv", "--scheme", "euler"], &["--scheme", "rest-to-rest"]);
    check_refused(&["motion", "in.csv", "--mode", "naive", "--closed"], &["--closed", "naive"]);
    check_refused(&["calibrate", "in.csv", "--turns", "360"], &["--turns", "six-face"]);
    check_refused(
        &["calibrate", "in.csv", "--method", "multi-pose", "--window", "2"],
        &["--window", "multi-pose"],
    );
    for option in [["-o", "x.csv"], ["--directions", "3"], ["--seconds", "9"], ["--baud", "9600"]] {
        check_refused(&["earth", "in.csv", option[0], option[1]], &["--serial"]);
    }
    check_refused(&["orient", "in.csv", "in.csv", "--save-calibration", "x.json"], &["--save-calibration"]);
}

#[test]
fn numbers_that_are_none_are_named() {
    for (args, words) in [
        (["orient", "in.csv", "--rate", "0"], ["--rate", "greater than 0"]),
        (["orient", "in.csv", "--rate", "-5"], ["--rate", "greater than 0"]),
        (["orient", "in.csv", "--rate", "nan"], ["--rate", "finite"]),
        (["calibrate", "in.csv", "--window", "-1"], ["greater than 0", "--window"]),
        (["calibrate", "in.csv", "--gravity", "inf"], ["--gravity", "finite"]),
        (["earth", "in.csv", "--latitude", "95"], ["--latitude 95", "less than 90"]),
        (["earth", "in.csv", "--latitude", "90"], ["--latitude 90", "at a pole"]),
    ] {
        check_refused(&args, &words);
    }
    check_refused(&["orient", "in.csv", "--filter", "mahony", "--kp", "-1"], &["kp is -1"]);
    let limits = ["orient", "in.csv", "--filter", "mahony-adaptive", "--accel-limits", "9,2,3,4"];
    check_refused(&limits, &["--accel-limits LE < LS"]);
    check_refused(&["orient", "in.csv", "--filter", "mahony", "--kp", "nan"], &["--kp", "finite"]);
}

#[test]
fn what_was_assumed_is_said_by_every_command() {
    let desk = Desk::new();
    let text = std::fs::read_to_string(example("pelvis.csv")).expect("the example");
    let bare = text.replacen(
        "Time,Ax[m/s2],Ay[m/s2],Az[m/s2],Gx[rad/s],Gy[rad/s],Gz[rad/s],Temp",
        "-,ax,ay,az,gx,gy,gz,-",
        1,
    );
    desk.put("bare.csv", bare);
    desk.put(
        "one.json",
        r#"{"format": "shisei-calibration", "version": 1,
        "accelerometer": {"bias_m_s2": [0, 0, 0], "matrix": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]},
        "gyroscope": {"bias_rad_s": [0, 0, 0], "matrix": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]}}"#,
    );
    for args in [
        vec!["orient", "bare.csv"],
        vec!["motion", "bare.csv"],
        vec!["allan", "bare.csv"],
        vec!["convert", "bare.csv", "-o", "converted.csv"],
        vec!["apply", "bare.csv", "--calibration", "one.json", "-o", "applied.csv"],
    ] {
        let ran = desk.run(&[args.as_slice(), &["--rate", "100", "--lang", "en"]].concat());
        assert_eq!(ran.code, 0, "{args:?}: {}", ran.stderr);
        assert!(
            ran.stderr.contains("assumed: the angular rate has no unit: taken as rad/s"),
            "{args:?}: {}",
            ran.stderr
        );
    }
}

#[test]
fn a_calibration_of_something_else_is_noticed() {
    let desk = Desk::new();
    // A scale as for readings in mg, given to readings in m/s².
    desk.put("other.json", r#"{"format": "shisei-calibration", "version": 1,
        "accelerometer": {"bias_m_s2": [0, 0, 0], "matrix": [[0.00980665, 0, 0], [0, 0.00980665, 0], [0, 0, 0.00980665]]},
        "gyroscope": {"bias_rad_s": [0, 0, 0], "matrix": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]}}"#);
    let ran = desk.run(&["orient", &example("pelvis.csv"), "--calibration", "other.json", "--lang", "en"]);
    assert!(ran.stderr.contains("with the calibration |a| is mostly 9.5971e-2"), "{}", ran.stderr);
    let ran = desk.run(&["orient", &example("pelvis.csv"), "--gravity", "98", "--lang", "en"]);
    assert!(ran.stderr.contains("--gravity 98 is not found on the Earth"), "{}", ran.stderr);
}

/// What the manual shows of the first result is what the command prints.
#[test]
fn the_first_result_in_the_manual_is_what_is_printed() {
    let top = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");
    for lang in ["en", "ja"] {
        let page = std::fs::read_to_string(format!("{top}/docs/{lang}/first-result.md")).expect("the manual");
        let shown =
            page.split("```text\n").nth(1).and_then(|rest| rest.split("```").next()).expect("a listing");
        let desk = Desk::new();
        std::fs::create_dir(desk.file("examples")).expect("a directory");
        desk.put("examples/pelvis.csv", std::fs::read(example("pelvis.csv")).expect("the example"));
        let ran = desk.run(&["orient", "examples/pelvis.csv", "--forward", "z", "--lang", lang]);
        assert_eq!(ran.stderr, shown, "docs/{lang}/first-result.md");
    }
}

#[test]
fn many_recordings_say_their_warnings_once() {
    let desk = Desk::new();
    for name in ["a.csv", "b.csv", "c.csv"] {
        desk.put(name, std::fs::read(example("pelvis.csv")).expect("the example"));
    }
    let ran = desk.run(&["orient", ".", "--no-report", "--lang", "en"]);
    assert_eq!(ran.stderr.matches("--forward").count(), 1, "{}", ran.stderr);
    assert!(ran.stderr.contains("warning (3): the sensor's x axis"), "{}", ran.stderr);
    let ran = desk.run(&["orient", ".", "--no-report", "--lang", "ja"]);
    assert!(ran.stderr.contains("注意 (3 件)：開始時にセンサの x 軸"), "{}", ran.stderr);
}

#[test]
fn the_noise_of_a_sensor_that_moved_is_doubted() {
    let desk = Desk::new();
    let ran = desk.run(&["allan", &example("pelvis.csv"), "--no-report", "--lang", "en"]);
    assert!(ran.stderr.contains("the sensor lay still in one attitude for 3"), "{}", ran.stderr);
    assert!(!ran.stderr.contains(" 0.0 s"), "{}", ran.stderr);
    let ran = desk.run(&["allan", &example("six-face.csv"), "--no-report", "--lang", "ja"]);
    assert!(ran.stderr.contains("センサが同じ姿勢で静止していたのは"), "{}", ran.stderr);
    desk.run(&["allan", &example("pelvis.csv"), "--report", "a.html", "--lang", "en"]);
    assert!(
        desk.text("a.html").contains("the sensor lay still in one attitude for 3"),
        "the report says it too"
    );
}

#[test]
fn what_the_report_of_a_motion_doubts_is_said_in_the_terminal_too() {
    let desk = Desk::new();
    let text = std::fs::read_to_string(example("pelvis.csv")).expect("the example");
    desk.put("cut.csv", text.lines().take(700).map(|line| format!("{line}\n")).collect::<String>());
    let ran = desk.run(&["motion", "cut.csv", "--lang", "en"]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    let sentence = "The recording does not end at rest";
    assert!(ran.stderr.contains(sentence), "{}", ran.stderr);
    assert!(desk.text("cut.motion.html").contains(sentence));
}

#[test]
fn live_for_less_than_no_time_or_with_a_sensor_in_two_places() {
    check_refused(&["live", "--demo", "--for", "-1"], &["--for"]);
    check_refused(&["live", "--demo", "--pair", "node 0=Wand", "--pair", "node 0=Board"], &["--pair", "two"]);
}

#[test]
fn a_recording_is_not_recorded_as_bytes() {
    let desk = Desk::new();
    desk.put("take.mcap", b"\x89MCAP0\r\n and more");
    let ran = desk.run(&["record", "take.mcap", "-o", "again.mcap", "--lang", "en"]);
    assert!(ran.code == 2 && ran.stderr.contains("a recording already"), "{}", ran.stderr);
    assert_eq!(desk.names(), ["take.mcap"]);
}

#[test]
fn a_motion_says_what_it_cannot_know() {
    let desk = Desk::new();
    let six = std::fs::read_to_string(example("six-face.csv")).expect("the example");
    let rows: Vec<&str> = six.lines().collect();
    let with = |at: usize, value: &str| {
        let mut fields: Vec<&str> = rows[at].split(',').collect();
        fields[3] = value;
        let mut rows: Vec<String> = rows.iter().map(|&row| row.to_owned()).collect();
        rows[at] = fields.join(",");
        rows.join("\n")
    };
    let end = |name: &str| {
        let ran = desk.run(&["motion", name, "--no-report", "--json", "--lang", "en"]);
        assert_eq!(ran.code, 0, "{}", ran.stderr);
        let found: serde_json::Value = serde_json::from_str(&ran.stdout).expect("JSON");
        let end: Vec<f64> =
            found["end_m"].as_array().expect("three").iter().map(|x| x.as_f64().expect("finite")).collect();
        let off = shisei_core::vector::norm([end[0], end[1], end[2]]);
        (off, found["sigma_end_m"].as_f64().expect("finite"), ran.stderr)
    };
    desk.put("six.csv", &six);
    let (whole, _, _) = end("six.csv");
    for (at, value) in [(799, "1e300"), (799, "1e6"), (1499, "5000")] {
        desk.put("wild.csv", with(at, value));
        let (off, sigma, said) = end("wild.csv");
        assert!((off - whole).abs() < 3.0 * sigma && sigma < 0.5, "{off} {whole} {sigma}");
        assert!(said.contains("1 sample(s) are no readings"), "{said}");
        let ran = desk.run(&["motion", "wild.csv", "--no-report", "--lang", "ja"]);
        assert!(ran.stderr.contains("1 個のサンプルは計測値ではない"), "{}", ran.stderr);
    }
    for (lang, words) in [("en", "insist with --force"), ("ja", "--force で続行")] {
        let ran = desk.run(&["motion", "six.csv", "--end", "5,0,0", "-o", "no.csv", "--lang", lang]);
        assert!(ran.code == 1 && ran.stderr.contains(words), "{}", ran.stderr);
        let ran = desk.run(&["motion", "six.csv", "--end", "1e30,0,0", "-o", "no.csv", "--lang", lang]);
        assert!(ran.code == 1 && ran.stderr.contains(words), "{}", ran.stderr);
    }
    let cut: Vec<&str> = [&rows[..700], &rows[1000..]].concat();
    desk.put("cut.csv", cut.join("\n"));
    for (lang, words) in [("en", "insist with --force"), ("ja", "--force で続行")] {
        let ran = desk.run(&["motion", "cut.csv", "-o", "no.csv", "--lang", lang]);
        assert!(ran.code == 1 && ran.stderr.contains(words) && ran.stderr.contains("0.5 "), "{}", ran.stderr);
        let ran = desk.run(&["calibrate", "six.csv", "--gravity", "1", "--lang", lang]);
        assert!(ran.code == 1 && ran.stderr.contains("--gravity"), "{}", ran.stderr);
        assert!(!ran.stderr.contains("AccScale"), "{}", ran.stderr);
    }
    assert!(!desk.names().contains(&"no.csv".to_owned()));
}
