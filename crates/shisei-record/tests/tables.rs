//! What is written reads back to the same bits: CSV and Parquet; kept columns; Parquet of other makers.
#![allow(clippy::disallowed_methods)] // numbers to read back; their own bits do not matter
#![allow(clippy::format_push_string)] // small test tables

use shisei_record::write::{Decimals, recording_csv};
use shisei_record::{Input, Options, Recording, open};

fn sample() -> Recording {
    let mut out = "time_s,acc_x,acc_y,acc_z,gyr_x,gyr_y,gyr_z,temp_c,label\n".to_owned();
    for i in 0..500 {
        let x = f64::from(i) / 7.0;
        out += &format!(
            "{},{},{},{},{},{},{},{},\"step, {}\"\n",
            f64::from(i) / 100.0,
            x.sin() / 3.0,
            -0.1,
            9.8,
            x.cos() / 9.0,
            1e-17,
            -0.3,
            20.5,
            i % 4
        );
    }
    let options = Options { keep: vec!["label".into()], ..Options::default() };
    open(&[Input { name: "a.csv", bytes: out.as_bytes() }], &options).unwrap()
}

fn same(a: &Recording, b: &Recording) {
    assert_eq!(a.time_s, b.time_s);
    assert_eq!(a.acc_m_s2, b.acc_m_s2);
    assert_eq!(a.gyro_rad_s, b.gyro_rad_s);
    assert_eq!(a.temp_c, b.temp_c);
    assert_eq!(a.extra, b.extra);
}

fn again(name: &str, bytes: &[u8]) -> Recording {
    let options = Options { keep: vec!["label".into()], ..Options::default() };
    open(&[Input { name, bytes }], &options).unwrap()
}

#[test]
fn csv_reads_back_to_the_same_bits() {
    let recording = sample();
    assert_eq!(recording.extra[0].cells[3].as_ref(), "step, 3");
    let mut bytes = Vec::new();
    recording_csv(&mut bytes, &recording, Decimals::Shortest).unwrap();
    same(&recording, &again("b.csv", &bytes));
}

#[cfg(feature = "parquet")]
mod parquet {
    use super::*;
    use shisei_record::Problem;
    use shisei_record::parquet_write::recording_parquet;

    #[test]
    fn parquet_reads_back_to_the_same_bits() {
        let recording = sample();
        let mut bytes = Vec::new();
        recording_parquet(&mut bytes, &recording).unwrap();
        same(&recording, &again("b.parquet", &bytes));
    }

    #[test]
    fn damaged_parquet_is_refused() {
        let mut bytes = Vec::new();
        recording_parquet(&mut bytes, &sample()).unwrap();
        for cut in [4, 8, 50, 1000, bytes.len() - 1] {
            let input = [Input { name: "b.parquet", bytes: &bytes[..cut] }];
            let error = open(&input, &Options::default()).unwrap_err();
            assert!(matches!(error.problem, Problem::Damaged { .. }), "{cut}: {error}");
        }
        for at in 0..bytes.len().min(3000) {
            let mut bad = bytes.clone();
            bad[at] ^= 0x55;
            let end = bad.len() - 1 - at.min(1500);
            bad[end] ^= 0x11;
            let _ = open(&[Input { name: "b.parquet", bytes: &bad }], &Options::default());
        }
    }

    #[test]
    fn our_files_are_known_by_their_footer() {
        use shisei_record::parquet_write::is_ours;
        use std::io::Cursor;
        let mut bytes = Vec::new();
        recording_parquet(&mut bytes, &sample()).unwrap();
        assert!(is_ours(&mut Cursor::new(&bytes)));
        for other in [fixture("text.parquet"), bytes[..bytes.len() - 1].to_vec(), b"PAR1".to_vec()] {
            assert!(!is_ours(&mut Cursor::new(&other)));
        }
        for at in 0..bytes.len() {
            let mut bad = bytes.clone();
            bad[at] ^= 0x55;
            let _ = is_ours(&mut Cursor::new(&bad));
        }
    }

    fn fixture(name: &str) -> Vec<u8> {
        let folder = std::path::PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/parquet");
        std::fs::read(folder.join(name)).unwrap()
    }

    #[test]
    fn another_compression_is_no_damage() {
        let bytes = fixture("brotli.parquet");
        let error = open(&[Input { name: "b.parquet", bytes: &bytes }], &Options::default()).unwrap_err();
        assert_eq!(error.problem, Problem::Compression { codec: "brotli".into() });
        for lang in [shisei_record::Lang::En, shisei_record::Lang::Ja] {
            assert!(error.sentence(lang).contains("brotli"), "{}", error.sentence(lang));
        }
    }

    #[test]
    fn numbers_as_text_are_numbers() {
        let bytes = fixture("text.parquet");
        let recording = open(&[Input { name: "b.parquet", bytes: &bytes }], &Options::default()).unwrap();
        assert_eq!(recording.len(), 60);
        assert_eq!(recording.acc_m_s2[0], [0.1, 0.2, 9.8]);
        assert_eq!(recording.gyro_rad_s[0], [0.01, 0.02, 0.03]);
    }

    #[test]
    fn polars_files_open() {
        let root = std::env::var_os("SHISEI_DATA").map_or_else(
            || std::path::PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data"),
            Into::into,
        );
        let path = root.join("broad/02_undisturbed_slow_rotation_B.parquet");
        let Ok(bytes) = std::fs::read(&path) else {
            eprintln!("skipped: no {}", path.display());
            return;
        };
        let options = Options { keep: vec!["opt_q_w".into(), "movement".into()], ..Options::default() };
        let recording = open(&[Input { name: "02.parquet", bytes: &bytes }], &options).unwrap();
        // Rows and rate as pyarrow and ORIGIN.txt give them.
        assert_eq!(recording.len(), 53_240);
        assert!((recording.findings.rate_hz - 285.714).abs() < 0.01);
        assert!((recording.findings.rest_norm - 9.81).abs() < 0.1);
        assert_eq!(recording.extra.len(), 2);
    }
}
