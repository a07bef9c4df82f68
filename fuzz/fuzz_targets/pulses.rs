//! Any bytes as a pulse file, its times as those of samples of a short take.
#![no_main]

use libfuzzer_sys::fuzz_target;
use shisei_record::Input;
use shisei_record::motive::{read, read_pulses};

const TAKE: &[u8] = b"Format Version,1.24,Export Frame Rate,120,Total Frames in Take,4\n\n,Type\n,Name\n,ID\n\nFrame,Time\n0,0\n3,0.025\n";

fuzz_target!(|data: &[u8]| {
    let Ok(pulses) = read_pulses(&Input { name: "pulses.csv", bytes: data }) else { return };
    assert!(pulses.len() >= 2 && pulses.windows(2).all(|pair| pair[0] < pair[1]));
    let take = read(&Input { name: "take.csv", bytes: TAKE }).expect("a take");
    if let Ok(times) = take.pulses_s(&pulses, &pulses) {
        assert_eq!(times.len(), 4);
        assert!(times.iter().all(|time| time.is_finite()));
    }
});
