//! Pieces of a text that end where lines end, from memory or as they are read.

use std::borrow::Cow;
use std::io::{self, Read};

/// Bytes of a piece: it and its numbers stay in the processor's cache.
pub(crate) const BLOCK: usize = 1 << 19;

/// Texts shorter than this are read by one thread.
pub(crate) const SHORT: u64 = 1 << 22;

/// What is left of a text.
pub(crate) struct Blocks<'a> {
    kind: Kind<'a>,
    /// Bytes left at the start, as far as is known.
    pub length: u64,
    pub pieces: Pieces,
}

/// How a text is cut and read.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pieces {
    /// Bytes of a piece.
    pub size: usize,
    /// Threads; where that is not said it follows from the text's length.
    pub threads: Option<usize>,
}

impl Default for Pieces {
    fn default() -> Self {
        Pieces { size: BLOCK, threads: None }
    }
}

enum Kind<'a> {
    Memory(&'a [u8]),
    Stream {
        rest: Box<dyn Read + 'a>,
        /// What was read and not yet given.
        carry: Vec<u8>,
        /// Buffers to use again.
        spare: Vec<Vec<u8>>,
        ended: bool,
    },
}

impl<'a> Blocks<'a> {
    pub fn of(text: &'a [u8]) -> Self {
        Blocks { kind: Kind::Memory(text), length: text.len() as u64, pieces: Pieces::default() }
    }

    /// `length` is how many bytes `rest` is thought to have.
    pub fn stream(rest: impl Read + 'a, length: u64, pieces: Pieces) -> Self {
        let kind = Kind::Stream { rest: Box::new(rest), carry: Vec::new(), spare: Vec::new(), ended: false };
        Blocks { kind, length, pieces }
    }

    /// The next piece; it ends after a line end, or with the text, or is a line longer than a piece and goes on.
    pub fn next(&mut self) -> io::Result<Option<Cow<'a, [u8]>>> {
        let size = self.pieces.size.max(1);
        match &mut self.kind {
            Kind::Memory(text) => {
                if text.is_empty() {
                    return Ok(None);
                }
                let cut = cut(text, size).unwrap_or(text.len());
                let (block, rest) = text.split_at(cut);
                *text = rest;
                Ok(Some(Cow::Borrowed(block)))
            }
            Kind::Stream { rest, carry, spare, ended } => {
                let mut block = std::mem::replace(carry, spare.pop().unwrap_or_default());
                carry.clear();
                let mut wanted = size;
                while !*ended {
                    if block.len() < wanted {
                        let missing = (wanted - block.len()) as u64;
                        *ended = rest.by_ref().take(missing).read_to_end(&mut block)? < missing as usize;
                    }
                    if let Some(end) = memchr::memrchr(b'\n', &block).filter(|_| !*ended) {
                        carry.extend_from_slice(block.get(end + 1..).unwrap_or_default());
                        block.truncate(end + 1);
                        break;
                    }
                    if block.len() > crate::sheet::LINE_LIMIT + 2 {
                        break;
                    }
                    wanted += size;
                }
                Ok(if block.is_empty() { None } else { Some(Cow::Owned(block)) })
            }
        }
    }

    /// Takes a piece back, so that its memory is used again.
    pub fn give_back(&mut self, block: Cow<'a, [u8]>) {
        if let (Kind::Stream { spare, .. }, Cow::Owned(mut block)) = (&mut self.kind, block) {
            block.clear();
            spare.push(block);
        }
    }
}

/// Where a piece of about `size` bytes ends: after the last line end in it, or the first one beyond.
fn cut(text: &[u8], size: usize) -> Option<usize> {
    let head = text.get(..size)?;
    if let Some(end) = memchr::memrchr(b'\n', head) {
        return Some(end + 1);
    }
    memchr::memchr(b'\n', text.get(size..)?).map(|end| size + end + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn collect(mut blocks: Blocks<'_>) -> Vec<Vec<u8>> {
        let mut out = Vec::new();
        while let Some(block) = blocks.next().unwrap() {
            out.push(block.to_vec());
            blocks.give_back(block);
        }
        out
    }

    #[test]
    fn pieces_join_to_the_text_and_end_at_lines() {
        let mut text = Vec::new();
        for k in 0..200_000u32 {
            text.extend_from_slice(format!("{k},{}\n", k * 7).as_bytes());
        }
        text.extend_from_slice(b"the end without a line end");
        let memory = collect(Blocks::of(&text));
        assert_eq!(memory.concat(), text);
        // a reader that gives little at a time
        let (start, rest) = text.split_at(1000);
        let stream = collect(Blocks::stream(start.chain(rest), 0, Pieces::default()));
        assert_eq!(stream.concat(), text);
        for pieces in [&memory, &stream] {
            assert!(pieces.len() > 3 && pieces.iter().all(|p| p.len() <= BLOCK));
            assert!(pieces.iter().rev().skip(1).all(|p| p.ends_with(b"\n")));
        }
    }

    #[test]
    fn a_line_longer_than_a_piece() {
        let text = [vec![b'7'; 700_000], b"\n1,2\n".to_vec()].concat();
        assert_eq!(collect(Blocks::stream(text.as_slice(), 0, Pieces::default())).concat(), text);
        assert_eq!(collect(Blocks::of(&text)).concat(), text);
        let endless = vec![b'7'; 3 << 20];
        let first = Blocks::stream(endless.as_slice(), 0, Pieces::default()).next().unwrap().unwrap();
        assert!(first.len() > crate::sheet::LINE_LIMIT && first.len() < 2 << 20);
    }
}
