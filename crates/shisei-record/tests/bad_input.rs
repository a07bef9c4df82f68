//! Every kind of bad input has its sentence, with its place, in both languages.
#![allow(clippy::format_collect)] // small test tables

use shisei_record::{Input, Lang, Options, Problem, open};

const HEADER: &str = "Time,Ax[m/s2],Ay[m/s2],Az[m/s2],Gx[rad/s],Gy[rad/s],Gz[rad/s],Temp\n";

fn rows(n: usize) -> String {
    (0..n).map(|i| format!("31:{:04.1},0.1,0.2,9.8,0.01,0.02,0.03,4095\n", 27.8 + i as f64 * 0.01)).collect()
}

fn refused(bytes: &[u8]) -> shisei_record::Error {
    let error = open(&[Input { name: "a.csv", bytes }], &Options::default()).unwrap_err();
    for lang in [Lang::En, Lang::Ja] {
        let sentence = error.sentence(lang);
        assert!(sentence.starts_with("a.csv"), "{sentence}");
        assert!(sentence.len() < 1000, "{sentence}");
    }
    error
}

fn check(bytes: &[u8], wanted: &str, line: Option<usize>, column: Option<usize>) {
    let error = refused(bytes);
    let name = format!("{:?}", error.problem);
    assert!(name.starts_with(wanted), "{name} instead of {wanted}");
    assert_eq!(error.place.line, line, "{error}");
    assert_eq!(error.place.column.as_ref().map(|c| c.0), column, "{error}");
}

#[test]
fn empty_and_header_only() {
    check(b"", "Empty", None, None);
    check(b"\n\n  \n", "Empty", None, None);
    check(HEADER.as_bytes(), "HeaderOnly", None, None);
    check(format!("{HEADER}{}", rows(1)).as_bytes(), "TooFewRows", None, None);
}

#[test]
fn text_and_nan_in_a_number() {
    let text = format!("{HEADER}{}31:27.8,0.1,oops,9.8,0.01,0.02,0.03,4095\n{}", rows(100), rows(3));
    check(text.as_bytes(), "NotANumber", Some(102), Some(3));
    let text = format!("{HEADER}{}31:27.8,0.1,0.2,9.8,0.01,NaN,0.03,4095\n{}", rows(100), rows(3));
    check(text.as_bytes(), "NotFinite", Some(102), Some(6));
    let text = format!("{HEADER}{}31:27.8,0.1,0.2,,0.01,0,0.03,4095\n{}", rows(100), rows(3));
    check(text.as_bytes(), "Blank", Some(102), Some(4));
    let text = format!("{HEADER}{}31:27.8,0.1,0.2\n{}", rows(100), rows(3));
    check(text.as_bytes(), "ShortRow", Some(102), None);
    let text = format!("{HEADER}{}soon,0.1,0.2,9.8,0.01,0,0.03,4095\n{}", rows(100), rows(3));
    check(text.as_bytes(), "BadStamp", Some(102), Some(1));
    let skip = Options { skip_bad_rows: true, ..Options::default() };
    let recording = open(&[Input { name: "a.csv", bytes: text.as_bytes() }], &skip).unwrap();
    assert_eq!((recording.len(), recording.findings.skipped_rows), (103, 1));
}

#[test]
fn a_cut_off_end_is_left_out_and_said() {
    let text = format!("{HEADER}{}31:27.8,0.1,0.", rows(100));
    let recording = open(&[Input { name: "a.csv", bytes: text.as_bytes() }], &Options::default()).unwrap();
    assert_eq!(recording.len(), 100);
    assert!(recording.warnings.iter().any(|w| w.code == "rows-trimmed"));
}

#[test]
fn missing_columns() {
    check(b"Time,Ax,Ay,Gx,Gy,Gz\n0,1,2,3,4,5\n1,1,2,3,4,5\n", "MissingColumn", Some(1), None);
    check(b"time,ax,ay,az\n0,1,2,3\n0.01,1,2,3\n", "NoGyro", None, None);
    check(b"time,gx,gy,gz\n0,1,2,3\n0.01,1,2,3\n", "NoAcc", None, None);
    check(b"a name,price,size\n1,2,3\n3,4,5\n", "NotARecording", None, None);
}

#[test]
fn gravity_removed() {
    let header = "time (s),Linear Acceleration x (m/s^2),Linear Acceleration y (m/s^2),Linear Acceleration z (m/s^2),\
                  gx (rad/s),gy (rad/s),gz (rad/s)\n";
    let body: String =
        (0..300).map(|i| format!("{},0.01,0.02,-0.01,0,0,0\n", f64::from(i) / 100.0)).collect();
    check(format!("{header}{body}").as_bytes(), "GravityRemoved", None, None);
    // The same without saying so.
    let header = "time (s),ax (m/s^2),ay (m/s^2),az (m/s^2),gx (rad/s),gy (rad/s),gz (rad/s)\n";
    check(format!("{header}{body}").as_bytes(), "GravityRemoved", None, None);
}

#[test]
fn counts_ask_for_a_scale() {
    let body: String =
        (0..300).map(|i| format!("{},-600,14700,{},140,-53\n", 2500 + i % 7, -430 + i % 3)).collect();
    let text = format!("Fs,100\nax,ay,az,gx,gy,gz\n{body}");
    check(text.as_bytes(), "RawCounts", None, None);
    let scale = Some(shisei_record::Scale::parse("acc=16384,gyr=131").unwrap());
    let options = Options { scale, ..Options::default() };
    let recording = open(&[Input { name: "a.csv", bytes: text.as_bytes() }], &options).unwrap();
    assert_eq!(recording.findings.rate_hz, 100.0);
    // 14700 / 16384 g and 140 / 131 deg/s.
    assert!((recording.acc_m_s2[0][2] - 8.798_5).abs() < 1e-3);
    assert!((recording.gyro_rad_s[0][1] - 0.018_652).abs() < 1e-5);
    let options = Options { counts_ok: true, ..Options::default() };
    assert!(open(&[Input { name: "a.csv", bytes: text.as_bytes() }], &options).unwrap().counts);
}

#[test]
fn rate_needed() {
    let body: String = (0..300).map(|i| format!("0.1,0.{},9.8,0,0.01,0\n", i % 9)).collect();
    let text = format!("ax,ay,az,gx,gy,gz\n{body}");
    check(text.as_bytes(), "RateNeeded", None, None);
    let options = Options { rate_hz: Some(50.0), ..Options::default() };
    let recording = open(&[Input { name: "a.csv", bytes: text.as_bytes() }], &options).unwrap();
    assert_eq!((recording.findings.rate_hz, recording.time_s[5]), (50.0, 0.1));
}

#[test]
fn binary_garbage() {
    let mut garbage = Vec::new();
    let mut state = 12_345u32;
    for _ in 0..100_000 {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        garbage.push((state >> 24) as u8);
    }
    check(&garbage, "NotText", None, None);
    check(b"PK\x03\x04.....", "OtherFormat", None, None);
    check(b"\x1f\x8b\x08\x00\x00", "Damaged", None, None);
}

/// Found by fuzzing: 2.5 kB whose dictionary says that it has 1.5 billion values; the decoder took memory for them. The
/// number is longer than it was, so that the pages behind it are not where they should be.
#[test]
fn a_parquet_dictionary_said_to_be_long() {
    let path =
        concat!(env!("CARGO_MANIFEST_DIR"), "/../../fuzz/seeds/record_parquet/dictionary_said_to_be_long");
    let error = refused(&std::fs::read(path).expect("the fuzz target's seed"));
    assert!(matches!(error.problem, Problem::Damaged { .. }), "{error}");
}

#[test]
fn one_endless_line() {
    let line = vec![b'7'; 64 << 20];
    check(&line, "LineTooLong", Some(1), None);
    // After good rows, too.
    let mut text = format!("{HEADER}{}", rows(500)).into_bytes();
    text.extend(std::iter::repeat_n(b'7', 4 << 20));
    check(&text, "LineTooLong", Some(502), None);
}

#[test]
fn options_that_do_not_fit() {
    let text = format!("{HEADER}{}", rows(10));
    let input = [Input { name: "a.csv", bytes: text.as_bytes() }];
    let columns = Some(shisei_record::Columns::parse("acc_x=Foo").unwrap());
    let error = open(&input, &Options { columns, ..Options::default() }).unwrap_err();
    assert!(matches!(error.problem, Problem::NoSuchColumn { .. }));
    let error = open(&input, &Options { sensor: Some("left".into()), ..Options::default() }).unwrap_err();
    assert!(matches!(error.problem, Problem::NoSuchSensor { .. }));
}
