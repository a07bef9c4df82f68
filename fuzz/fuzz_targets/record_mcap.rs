//! Any bytes as an MCAP file.
#![no_main]

use libfuzzer_sys::fuzz_target;
use shisei_record::{Input, Options, open};

fuzz_target!(|data: &[u8]| {
    shisei_fuzz::only_ours_count();
    let mut bytes = data.to_vec();
    if !bytes.starts_with(b"\x89MCAP0\r\n") {
        bytes.splice(0..0, *b"\x89MCAP0\r\n");
    }
    for sensor in [None, Some("0".to_owned())] {
        let options = Options { keep: vec!["*".into()], sensor, ..Options::default() };
        let _ = open(&[Input { name: "a.mcap", bytes: &bytes }], &options);
    }
});
