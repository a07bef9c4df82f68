//! Two files given together, parted at the first form feed.
#![no_main]

use libfuzzer_sys::fuzz_target;
use shisei_record::{Input, Options, open};

fuzz_target!(|data: &[u8]| {
    let middle = data.iter().position(|b| *b == 0x0C).unwrap_or(data.len());
    let (first, second) = data.split_at(middle);
    let inputs = [
        Input { name: "Accelerometer.csv", bytes: first },
        Input { name: "Gyroscope.csv", bytes: second.get(1..).unwrap_or_default() },
    ];
    if let Ok(recording) = open(&inputs, &Options::default()) {
        assert_eq!(recording.acc_m_s2.len(), recording.gyro_rad_s.len());
        assert!(recording.dt_s.iter().all(|dt| *dt > 0.0));
    }
});
