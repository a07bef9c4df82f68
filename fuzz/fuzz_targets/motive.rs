//! Any bytes as a Motive take: read, used, changed, written and read again.
#![no_main]

use libfuzzer_sys::fuzz_target;
use shisei_record::Input;
use shisei_record::motive::{LossRule, read, write};
use shisei_record::write::Decimals;

fuzz_target!(|data: &[u8]| {
    let Ok(mut take) = read(&Input { name: "a.csv", bytes: data }) else { return };
    assert!(take.columns.iter().all(|column| column.cells.len() == take.len()));
    let _ = (take.time_s(), take.axes(), take.total_frames());
    let last = take.len() - 1;
    for marker in take.markers().unwrap_or_default() {
        let _ = take.marker_m(&marker, last);
    }
    for body in take.bodies().unwrap_or_default() {
        assert_eq!(take.tracked(&body, LossRule::default()).len(), take.len());
        if let Some(pose) = take.pose(&body, 0) {
            take.set_pose(&body, last, &pose);
        }
    }
    let mut bytes = Vec::new();
    write(&mut bytes, &take, Decimals::Shortest).expect("memory");
    if take.columns.iter().all(|column| !column.axis.to_lowercase().starts_with("time")) {
        let again = read(&Input { name: "b.csv", bytes: &bytes }).expect("what we wrote");
        assert_eq!(again.frame, take.frame);
    }
});
