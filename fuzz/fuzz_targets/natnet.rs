//! NatNet packets of any version: decoded, carried over to the hub's coordinates; what decodes, encodes to what decodes
//! to the same.
#![no_main]

use libfuzzer_sys::fuzz_target;
use shisei_core::frames::Axes;
use shisei_hub::live::{Command, optics};
use shisei_hub::natnet::{Stream, Told, Version, read, write};

const VERSIONS: [Version; 4] =
    [Version { major: 3, minor: 0 }, Version { major: 3, minor: 1 }, Version::V4_0, Version::V4_1];

fuzz_target!(|bytes: &[u8]| {
    let Some((first, rest)) = bytes.split_first() else { return };
    let version = VERSIONS[usize::from(*first) % VERSIONS.len()];
    if let Ok(frame) = read::frame(rest, version) {
        let again = write::frame(&frame, version);
        let (_, payload) = read::packet(&again).expect("our own packet");
        let frame_again = read::frame(payload, version).expect("our own frame");
        // numbers that are not are not equal to themselves
        assert_eq!(format!("{frame:?}"), format!("{frame_again:?}"));
        let _ = optics::frame(&frame, 1 + u64::from(*first), Axes::YUp);
    }
    if let Ok(model) = read::model(rest, version) {
        let again = write::model(&model, version);
        let (_, payload) = read::packet(&again).expect("our own packet");
        let model_again = read::model(payload, version).expect("our own model");
        assert_eq!(format!("{model:?}"), format!("{model_again:?}"));
        let _ = optics::bodies(&model);
    }
    let mut stream = Stream::default();
    for packet in rest.chunks(300) {
        if let Ok(Told::Frame(frame)) = stream.push(packet) {
            let _ = optics::frame(&frame, 0, Axes::ZUp);
        }
    }
    if let Ok(text) = std::str::from_utf8(rest) {
        let _ = Command::parse(text);
    }
});
