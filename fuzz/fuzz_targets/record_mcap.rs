//! Any bytes as an MCAP file. Panics inside the decoder are caught by the reader and are no finding; ours are.
#![no_main]

use libfuzzer_sys::fuzz_target;
use shisei_record::{Input, Options, open};
use std::sync::Once;

static HOOK: Once = Once::new();

fuzz_target!(|data: &[u8]| {
    HOOK.call_once(|| {
        std::panic::set_hook(Box::new(|info| {
            if info
                .location()
                .is_some_and(|l| l.file().contains("shisei") || l.file().contains("fuzz_targets"))
            {
                eprintln!("{info}");
                std::process::abort();
            }
        }));
    });
    let mut bytes = data.to_vec();
    if !bytes.starts_with(b"\x89MCAP0\r\n") {
        bytes.splice(0..0, *b"\x89MCAP0\r\n");
    }
    for sensor in [None, Some("0".to_owned())] {
        let options = Options { keep: vec!["*".into()], sensor, ..Options::default() };
        let _ = open(&[Input { name: "a.mcap", bytes: &bytes }], &options);
    }
});
