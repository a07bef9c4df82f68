//! Any bytes as a Parquet file.
#![no_main]

use libfuzzer_sys::fuzz_target;
use shisei_record::{Input, Options, open};

fuzz_target!(|data: &[u8]| {
    shisei_fuzz::only_ours_count();
    let mut bytes = data.to_vec();
    if !bytes.starts_with(b"PAR1") {
        bytes.splice(0..0, *b"PAR1");
    }
    let _ = open(
        &[Input { name: "a.parquet", bytes: &bytes }],
        &Options { keep: vec!["*".into()], ..Options::default() },
    );
});
