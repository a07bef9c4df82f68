//! Each bad input has its sentence and its exit code, in both languages, and leaves no file.

use crate::run::{Desk, Ran, example};

fn pelvis() -> String {
    std::fs::read_to_string(example("pelvis.csv")).unwrap()
}

/// The example with one cell changed: `row` from 1 below the header, `column` from 0.
fn with_cell(row: usize, column: usize, text: &str) -> String {
    let changed = |line: &str| {
        let mut cells: Vec<&str> = line.split(',').collect();
        cells[column] = text;
        cells.join(",")
    };
    pelvis()
        .lines()
        .enumerate()
        .map(|(k, line)| if k == row { changed(line) } else { line.to_owned() } + "\n")
        .collect()
}

fn check(what: &str, bytes: &[u8], code: i32, words: &[&str]) {
    check_with(&[], what, bytes, code, words);
}

fn check_with(more: &[&str], what: &str, bytes: &[u8], code: i32, words: &[&str]) {
    let desk = Desk::new();
    desk.put("in.csv", bytes);
    for lang in ["en", "ja"] {
        let ran = desk.run(&[&["orient", "in.csv", "--lang", lang, "--plot", "p.png"], more].concat());
        assert_eq!(ran.code, code, "{what}: {}", ran.stderr);
        assert!(ran.stderr.contains("in.csv"), "{what} names the file: {}", ran.stderr);
        assert_eq!(ran.stderr.trim_end().lines().count(), 1, "{what} is one sentence: {}", ran.stderr);
        if lang == "en" {
            for word in words {
                assert!(ran.stderr.contains(word), "{what} says {word}: {}", ran.stderr);
            }
        } else {
            assert!(
                ran.stderr.contains("ください") || ran.stderr.contains("です"),
                "{what} in Japanese: {}",
                ran.stderr
            );
        }
        assert_eq!(ran.stdout, "", "{what}");
        assert_eq!(desk.names(), ["in.csv"], "{what} leaves no file");
    }
}

#[test]
fn empty_and_header_only() {
    check("an empty file", b"", 2, &["empty"]);
    check("a header only", pelvis().lines().next().unwrap().as_bytes(), 2, &["header"]);
}

#[test]
fn text_and_nan_and_missing_numbers() {
    check("text in a number", with_cell(500, 2, "oops").as_bytes(), 2, &["line 501", "column 3", "oops"]);
    check("NaN", with_cell(500, 5, "NaN").as_bytes(), 2, &["line 501", "column 6"]);
    check("a blank", with_cell(500, 5, "").as_bytes(), 2, &["line 501", "column 6"]);
}

#[test]
fn missing_column() {
    let without: String = pelvis()
        .lines()
        .map(|line| {
            line.split(',').enumerate().filter(|(k, _)| *k != 6).map(|(_, c)| c).collect::<Vec<_>>().join(",")
                + "\n"
        })
        .collect();
    check("a missing column", without.as_bytes(), 2, &["gyr_z"]);
}

#[test]
fn gravity_removed() {
    let mut text = String::from(
        "time_s,acc_x [m/s2],acc_y [m/s2],acc_z [m/s2],gyr_x [rad/s],gyr_y [rad/s],gyr_z [rad/s]\n",
    );
    for k in 0..1000 {
        let s = f64::from(k % 7) * 0.01;
        text.push_str(&format!("{},{s},{},{s},0.01,0.0{},0.01\n", f64::from(k) / 100.0, -s, k % 3));
    }
    check("gravity removed", text.as_bytes(), 1, &["gravity"]);
}

#[test]
fn no_rest() {
    // Rows 400 to 1400 of the example are all movement.
    let moving: String = pelvis()
        .lines()
        .enumerate()
        .filter(|(k, _)| *k == 0 || (400..1400).contains(k))
        .map(|(_, l)| format!("{l}\n"))
        .collect();
    check_with(&["--filter", "mahony"], "no rest", moving.as_bytes(), 1, &["--rest none"]);
    let desk = Desk::new();
    desk.put("in.csv", moving);
    assert_eq!(desk.run(&["orient", "in.csv", "--filter", "mahony", "--rest", "none"]).code, 0);
    // The estimator starts in motion.
    assert_eq!(desk.run(&["orient", "in.csv", "--force"]).code, 0);
}

#[test]
fn binary_garbage() {
    let mut state = 1_u32;
    let garbage: Vec<u8> = (0..100_000)
        .map(|_| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 24) as u8
        })
        .collect();
    check("binary garbage", &garbage, 2, &[]);
}

#[test]
fn a_line_of_a_gigabyte_is_refused_at_once() {
    let desk = Desk::new();
    let Ran { code, stderr, .. } = desk.pipe(&["orient", "-"], &vec![b'1'; 1 << 20], 1024);
    assert_eq!(code, 2, "{stderr}");
    assert!(stderr.contains("1 MiB"), "{stderr}");
    assert!(desk.names().is_empty());
}

#[test]
fn unreadable_paths() {
    let desk = Desk::new();
    let ran = desk.run(&["orient", "nowhere.csv"]);
    assert_eq!(ran.code, 2);
    assert!(ran.stderr.contains("nowhere.csv") && ran.stderr.contains("no such file"), "{}", ran.stderr);
    let into = desk.run(&["orient", &example("pelvis.csv"), "-o", "nowhere/out.csv"]);
    assert_eq!(into.code, 2, "{}", into.stderr);
    assert!(desk.names().is_empty());
}

#[cfg(unix)]
#[test]
fn a_full_disk_is_said() {
    let desk = Desk::new();
    for args in [["-o", "/dev/full"], ["--report", "/dev/full"], ["--plot", "/dev/full"]] {
        let ran = desk.run(&[&["orient", &example("pelvis.csv"), "--lang", "en"][..], &args[..]].concat());
        assert_eq!(ran.code, 2, "{args:?}");
        assert!(ran.stderr.contains("/dev/full"), "{}", ran.stderr);
        assert!(desk.names().is_empty(), "{args:?}");
    }
}
