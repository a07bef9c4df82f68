//! A text read in pieces, beside the same text read whole: the first byte chooses options and threads, the second the
//! size of the pieces, so that short inputs have many places where pieces meet.
#![no_main]

use libfuzzer_sys::fuzz_target;
use shisei_record::{Input, Options, Stream, open, open_in_pieces};

fuzz_target!(|data: &[u8]| {
    let [choice, size, bytes @ ..] = data else { return };
    let mut options = Options::default();
    options.skip_bad_rows = choice & 1 != 0;
    if choice & 2 != 0 {
        options.rate_hz = Some(100.0);
    }
    options.counts_ok = choice & 4 != 0;
    if choice & 8 != 0 {
        options.keep = vec!["*".into()];
    }
    let threads = 1 + usize::from(choice >> 6);
    let whole = open(&[Input { name: "a.csv", bytes }], &options);
    let (head, mut rest) = bytes.split_at(bytes.len().min(7));
    let stream = Stream { name: "a.csv", head: head.to_vec(), rest: &mut rest, length: bytes.len() as u64 };
    let pieces = open_in_pieces(stream, &options, 1 + usize::from(*size), threads);
    match (whole, pieces) {
        // NaN, of a temperature, is unequal to itself.
        (Ok(whole), Ok(pieces)) => assert_eq!(format!("{whole:?}"), format!("{pieces:?}")),
        (Err(whole), Err(pieces)) => assert_eq!(whole, pieces),
        (whole, pieces) => panic!("{:?} {:?}", whole.err(), pieces.err()),
    }
});
