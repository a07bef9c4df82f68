//! Any bytes as the Spresense sketch's binary stream, whole and in pieces: the same frames, no panic.
#![no_main]

use libfuzzer_sys::fuzz_target;
use shisei_record::spresense_stream::Splitter;

fuzz_target!(|data: &[u8]| {
    let (mut whole, mut pieces) = (Splitter::default(), Splitter::default());
    let frames = whole.push(data);
    let again: Vec<_> = data.chunks(7).flat_map(|piece| pieces.push(piece)).collect();
    assert_eq!(frames, again);
    assert_eq!(whole.damaged, pieces.damaged);
});
