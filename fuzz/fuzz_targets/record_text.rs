//! Any bytes as one file: text of every dialect, hexadecimal logs, gzip. The first byte chooses options.
#![no_main]

use libfuzzer_sys::fuzz_target;
use shisei_record::{AxisMap, Input, Lang, Options, Scale, inspect};

fuzz_target!(|data: &[u8]| {
    let Some((choice, bytes)) = data.split_first() else { return };
    let mut options = Options::default();
    if choice & 1 != 0 {
        options.skip_bad_rows = true;
    }
    if choice & 2 != 0 {
        options.rate_hz = Some(100.0);
    }
    if choice & 4 != 0 {
        options.scale = Scale::parse("16384,131").ok();
    }
    if choice & 8 != 0 {
        options.axes = AxisMap::parse("x,-y,-z").ok();
    }
    if choice & 16 != 0 {
        options.keep = vec!["*".into()];
    }
    if choice & 32 != 0 {
        options.counts_ok = true;
    }
    let name = if choice & 64 != 0 { "Gyroscope.csv" } else { "a.csv" };
    match inspect(&[Input { name, bytes }], &options) {
        Ok(seen) => {
            if let Some(recording) = seen.recording {
                let rows = recording.len();
                assert!(rows >= 2);
                assert_eq!(recording.time_s.len(), rows);
                assert_eq!(recording.gyro_rad_s.len(), rows);
                assert!(recording.dt_s.iter().all(|dt| *dt > 0.0));
                assert!(recording.time_s.windows(2).all(|w| w[1] > w[0]));
                assert!(
                    recording.acc_m_s2.iter().chain(&recording.gyro_rad_s).flatten().all(|v| v.is_finite())
                );
            }
        }
        Err(error) => assert!(!error.sentence(Lang::Ja).is_empty()),
    }
});
