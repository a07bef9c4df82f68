//! Opening a long text as it is read, so that its bytes are never in memory all at once.

use crate::blocks::{Blocks, Pieces, SHORT};
use crate::encoding::Encoding;
use crate::error::{Error, Problem, Result};
use crate::options::Options;
use crate::recording::Recording;
use crate::sheet::{self, LINE_LIMIT};
use crate::{Input, body, dialect, open};
use std::io::Read;

/// What is looked at to find a text's shape: the shape is told from lines that begin in the first `LINE_LIMIT`
/// bytes, each of them no longer than that.
const HEAD: usize = 2 * LINE_LIMIT + 16;

/// One file that is read from its start to its end.
pub struct Stream<'a> {
    /// Its name, for messages and for the quantity of columns named only x, y, z.
    pub name: &'a str,
    /// Its first bytes, as far as they were read already.
    pub head: Vec<u8>,
    /// The bytes after them.
    pub rest: &'a mut dyn Read,
    /// How many bytes the file is thought to have; 0 where that is not known.
    pub length: u64,
}

impl std::fmt::Debug for Stream<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Stream")
            .field("name", &self.name)
            .field("length", &self.length)
            .finish_non_exhaustive()
    }
}

/// As [`open`](crate::open) of one file, with the same result; a long text is read piece by piece, any other file
/// whole.
pub fn open_stream(stream: Stream<'_>, options: &Options) -> Result<Recording> {
    open_by(stream, options, None)
}

/// As [`open_stream`], but piece by piece however short the text is: in pieces of about `size` bytes, by so many
/// threads. For tests of what happens where pieces meet.
#[doc(hidden)]
pub fn open_in_pieces(
    stream: Stream<'_>,
    options: &Options,
    size: usize,
    threads: usize,
) -> Result<Recording> {
    open_by(stream, options, Some(Pieces { size, threads: Some(threads) }))
}

fn open_by(stream: Stream<'_>, options: &Options, pieces: Option<Pieces>) -> Result<Recording> {
    let Stream { name, mut head, rest, length } = stream;
    let unreadable = |e: std::io::Error| Error::of_file(name, Problem::Unreadable { detail: e.to_string() });
    let missing = HEAD.saturating_sub(head.len()) as u64;
    Read::take(&mut *rest, missing).read_to_end(&mut head).map_err(unreadable)?;
    let ended = head.len() < HEAD;
    if ended && pieces.is_none() || !is_plain_text(&head) {
        rest.read_to_end(&mut head).map_err(unreadable)?;
        return open(&[Input { name, bytes: &head }], options);
    }
    open::unpack(&Input { name, bytes: &head })?;
    let last_end = memchr::memrchr(b'\n', &head).filter(|_| !ended);
    let whole_lines = last_end.map_or(head.len(), |end| end + 1);
    let sheet = sheet::sniff(name, head.get(..whole_lines).unwrap_or_default(), options)?;
    let first_row = whole_lines - sheet.text.len() + sheet.data_offset;
    let rows = head.get(first_row..).unwrap_or_default().chain(rest);
    let length = length.saturating_sub(first_row as u64).max(SHORT);
    let blocks = Blocks::stream(rows, length, pieces.unwrap_or_default());
    let part =
        open::table_part(&sheet, options, false, |sheet, wanted| body::read_blocks(sheet, wanted, blocks))?;
    open::finish(part, options)
}

/// Text that is neither packed, nor a dialect of its own, nor converted whole for its encoding or its line
/// ends.
fn is_plain_text(head: &[u8]) -> bool {
    !head.starts_with(b"\x1F\x8B")
        && !head.starts_with(b"PAR1")
        && dialect::whole_file(head).is_none()
        && !crate::encoding::ends_lines_with_cr(head)
        && crate::encoding::detect(head).0 != Encoding::Utf16
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A long recording with things that need care: quotes, blank lines, numbers of many digits, an incomplete end.
    fn text(rows: usize, odd: impl Fn(usize) -> Option<String>) -> Vec<u8> {
        let mut out =
            "\u{feff}# a logger's own line\ntime_s,note,acc_x,acc_y,acc_z,gyr_x,gyr_y,gyr_z\n".to_owned();
        for k in 0..rows {
            let t = k as f64 * 0.01;
            let plain = format!(
                "{t:.3},n{k},0.1,{:.6},9.8{k},{},-0.5,1e-3\n",
                shisei_core::math::sin(t * 3.0),
                t / 3.0
            );
            out.push_str(&odd(k).unwrap_or(plain));
        }
        out.push_str("12.5,cut");
        out.into_bytes()
    }

    fn same(bytes: &[u8], options: &Options) -> std::result::Result<Recording, String> {
        let whole = open(&[Input { name: "a.csv", bytes }], options);
        let mut rest = bytes.get(5..).unwrap_or_default();
        let head = bytes.get(..5).unwrap_or_default().to_vec();
        let length = bytes.len() as u64;
        let streamed = open_stream(Stream { name: "a.csv", head, rest: &mut rest, length }, options);
        match (whole, streamed) {
            (Ok(whole), Ok(streamed)) => {
                assert_eq!(format!("{whole:?}"), format!("{streamed:?}"));
                Ok(streamed)
            }
            (Err(whole), Err(streamed)) => {
                assert_eq!(whole, streamed);
                Err(streamed.to_string())
            }
            (whole, streamed) => panic!("{:?} {:?}", whole.err(), streamed.err()),
        }
    }

    #[test]
    fn a_stream_gives_what_the_whole_file_gives() {
        let quoted = |k: usize| match k % 5000 {
            17 => Some(format!("\"{:.3}\",\"a,b\",0.1,0.2,9.8,0.3,-0.5,0.001\r\n", k as f64 * 0.01)),
            18 => Some("\n".to_owned()),
            _ => None,
        };
        let options = Options { keep: vec!["note".into()], ..Options::default() };
        let recording = same(&text(120_000, quoted), &options).unwrap();
        assert_eq!(recording.len(), 120_000 - 24);
        assert_eq!(recording.extra[0].cells[99_999].as_ref(), "n100020");
        same(&text(100, quoted), &options).unwrap();
    }

    /// Every place where pieces can meet: sizes from 1 byte on, one thread and three.
    #[test]
    fn pieces_may_meet_anywhere() {
        let odd = |k: usize| match k {
            3 => Some("\n".to_owned()),
            5 => Some("\"0.050\",\"a,b\",0.1,0.2,9.8,0.3,-0.5,0.001\r\n".to_owned()),
            9 => Some("0.090,n,0.1,0.2,9.8,0.3,-0.5,0.001,and,more,cells\r\n".to_owned()),
            11 => Some("0.110,n\n".to_owned()),
            _ => None,
        };
        for rows in [1, 2, 14] {
            let bytes = text(rows, odd);
            for (k, size) in (1..bytes.len() + 2).enumerate() {
                pieces_same(
                    &bytes,
                    &Options { skip_bad_rows: k % 2 == 0, ..Options::default() },
                    size,
                    1 + k % 3,
                );
            }
        }
    }

    fn pieces_same(bytes: &[u8], options: &Options, size: usize, threads: usize) {
        let whole = open(&[Input { name: "a.csv", bytes }], options);
        let mut rest = bytes;
        let stream = Stream { name: "a.csv", head: Vec::new(), rest: &mut rest, length: 0 };
        let pieces = open_in_pieces(stream, options, size, threads);
        // NaN is unequal to itself
        assert_eq!(format!("{whole:?}"), format!("{pieces:?}"), "pieces of {size}");
    }

    proptest! {
        /// Rows of any kind, line ends of any kind, in pieces of any size.
        #[test]
        fn pieces_of_any_size(
            rows in proptest::collection::vec(
                "(-?[0-9]{1,3}(\\.[0-9]{0,8})?,){6}-?[0-9]{1,2}\\.[0-9]{1,18}(e-?[0-9])?(,x)?|[0-9.,\" x]{0,12}",
                0..40,
            ),
            ends in proptest::collection::vec(0usize..4, 40),
            size in 1usize..400,
            threads in 1usize..4,
            skip_bad_rows in any::<bool>(),
        ) {
            let mut bytes = b"time_s,acc_x,acc_y,acc_z,gyr_x,gyr_y,gyr_z\n".to_vec();
            for (k, (row, end)) in rows.iter().zip(ends).enumerate() {
                if k % 5 > 0 {
                    bytes.extend_from_slice(format!("{k},").as_bytes());
                }
                bytes.extend_from_slice(row.as_bytes());
                bytes.extend_from_slice(["\n", "\r\n", "\n\n", "\n,"][end].as_bytes());
            }
            pieces_same(&bytes, &Options { skip_bad_rows, ..Options::default() }, size, threads);
        }
    }

    #[test]
    fn refusals_name_the_same_line() {
        let bad = |at: usize| move |k: usize| (k == at).then(|| "0.1,n,0.1,x,9.8,1,2,3\n".to_owned());
        for at in [40_000, 119_998] {
            let sentence = same(&text(120_000, bad(at)), &Options::default()).unwrap_err();
            assert!(sentence.contains(&format!("line {}", at + 3)), "{sentence}");
        }
        let options = Options { skip_bad_rows: true, ..Options::default() };
        assert_eq!(same(&text(120_000, bad(40_000)), &options).unwrap().len(), 119_999);
        let short = |k: usize| (k == 50_000).then(|| "0.1,n\n".to_owned());
        assert!(same(&text(120_000, short), &Options::default()).is_err());
    }
}
