//! Text that is made and written in pieces.

use super::digits::TILE;
use super::{Style, WINDOW};
use crate::wide::Vectors;
use std::io::{self, IoSlice, Write};

/// What is written at once is a multiple of this, so that the system takes large pages of memory for the file.
const PIECE: usize = 1 << 16;

/// Text that grows; its memory is used again.
#[derive(Default)]
pub(super) struct Page {
    /// What is written, and room beyond.
    bytes: Vec<u8>,
    length: usize,
    /// Where a text of any length is made.
    odd: Vec<u8>,
}

impl Page {
    pub fn clear(&mut self) {
        self.length = 0;
    }

    /// Room for the text of a number and what parts it from the next.
    #[inline(always)]
    fn room(&mut self) -> Option<&mut [u8; WINDOW]> {
        if self.bytes.len() < self.length + WINDOW {
            self.grow();
        }
        self.bytes.get_mut(self.length..)?.first_chunk_mut()
    }

    #[cold]
    #[inline(never)]
    fn grow(&mut self) {
        self.bytes.resize(2 * self.bytes.len() + (1 << 16), 0);
    }

    /// Appends the k-th of the numbers made ready, which is `value`, and a byte after it.
    #[inline(always)]
    pub fn number<S: Style>(&mut self, style: &S, k: usize, value: f64, after: u8) {
        let Some(room) = self.room() else { return };
        let length = style.put(k, value, room);
        if length > 0 {
            room[length] = after;
            self.length += length + 1;
        } else {
            self.odd_number::<S>(value, after);
        }
    }

    /// Appends the first `count` of some numbers, each with the byte that `row` puts after it.
    #[inline(always)]
    pub fn numbers<S: Style>(
        &mut self,
        vectors: Vectors,
        style: &mut S,
        values: &[f64; TILE],
        count: usize,
        row: &mut Row,
    ) {
        while self.bytes.len() < self.length + TILE * WINDOW {
            self.grow();
        }
        let after = row.pass(count);
        if count == TILE
            && let Some(out) = self.bytes.get_mut(self.length..).and_then(|out| out.first_chunk_mut())
            && let Some(length) = S::put_all(vectors, values, after, out)
        {
            self.length += length;
            return;
        }
        style.prepare(values);
        let mut k = 0;
        while k < count {
            while self.bytes.len() < self.length + TILE * WINDOW {
                self.grow();
            }
            let out = self.bytes.get_mut(self.length..).unwrap_or_default();
            let (mut at, mut odd) = (0, false);
            // What goes the long way is kept out of this loop.
            while k < count
                && let Some(room) = out.get_mut(at..).and_then(|out| out.first_chunk_mut())
            {
                let length = style.put(k, values[k], room);
                odd = length == 0;
                if odd {
                    break;
                }
                room[length] = after[k];
                at += length + 1;
                k += 1;
            }
            self.length += at;
            if odd {
                self.odd_number::<S>(values[k], after[k]);
                k += 1;
            }
        }
    }

    #[cold]
    #[inline(never)]
    fn odd_number<S: Style>(&mut self, value: f64, after: u8) {
        self.odd(|out| {
            S::odd(value, out);
            out.push(after);
        });
    }

    #[inline(always)]
    pub fn byte(&mut self, byte: u8) {
        if let Some(room) = self.room() {
            room[0] = byte;
            self.length += 1;
        }
    }

    /// Appends a text of any length.
    #[cold]
    #[inline(never)]
    pub fn odd(&mut self, write: impl FnOnce(&mut Vec<u8>)) {
        self.odd.clear();
        write(&mut self.odd);
        while self.bytes.len() < self.length + self.odd.len() {
            self.grow();
        }
        if let Some(room) = self.bytes.get_mut(self.length..self.length + self.odd.len()) {
            room.copy_from_slice(&self.odd);
            self.length += self.odd.len();
        }
    }

    /// In place of the last comma.
    #[inline(always)]
    pub fn end_line(&mut self) {
        self.length = self.length.saturating_sub(1);
        self.byte(b'\n');
    }

    pub fn text(&self) -> &[u8] {
        self.bytes.get(..self.length).unwrap_or_default()
    }
}

/// Where in a row of numbers the next one stands.
pub(super) struct Row {
    columns: usize,
    column: usize,
    /// The bytes after the numbers of a row, and of as many more as are made ready together.
    after: Vec<u8>,
}

impl Row {
    pub fn of(columns: usize) -> Self {
        let after = |k: usize| if (k + 1).is_multiple_of(columns) { b'\n' } else { b',' };
        Row { columns, column: 0, after: (0..columns + TILE).map(after).collect() }
    }

    /// Goes past some numbers; gives the bytes after them.
    #[inline(always)]
    fn pass(&mut self, count: usize) -> &[u8; TILE] {
        let after = self.after.get(self.column..).and_then(|after| after.first_chunk());
        self.column = (self.column + count) % self.columns;
        after.unwrap_or(&[b','; TILE])
    }
}

/// Pages on their way to a file: they are written one after the other in multiples of [`PIECE`], without being copied.
pub(super) struct Pieces<'a> {
    sink: &'a mut dyn Write,
    /// A page whose text is written up to `written`.
    last: Page,
    written: usize,
}

impl<'a> Pieces<'a> {
    /// `start` is text before that of all pages.
    pub fn new(sink: &'a mut dyn Write, start: &[u8]) -> Self {
        let mut last = Page::default();
        last.odd(|out| out.extend_from_slice(start));
        Pieces { sink, last, written: 0 }
    }

    /// Takes a page; gives one to use again.
    pub fn write(&mut self, page: Page) -> io::Result<Page> {
        let left = self.last.text().get(self.written..).unwrap_or_default();
        let length = left.len() + page.length;
        if length < PIECE {
            self.last.odd(|out| out.extend_from_slice(page.text()));
            return Ok(page);
        }
        let taken = (length / PIECE * PIECE).saturating_sub(left.len());
        write_both(self.sink, left, page.text().get(..taken).unwrap_or_default())?;
        self.written = taken;
        Ok(std::mem::replace(&mut self.last, page))
    }

    /// Writes what is left.
    pub fn finish(self) -> io::Result<()> {
        self.sink.write_all(self.last.text().get(self.written..).unwrap_or_default())
    }
}

/// Writes two texts, together where the sink can.
fn write_both(sink: &mut dyn Write, mut first: &[u8], mut second: &[u8]) -> io::Result<()> {
    while !first.is_empty() {
        match sink.write_vectored(&[IoSlice::new(first), IoSlice::new(second)]) {
            Ok(0) => return Err(io::ErrorKind::WriteZero.into()),
            Ok(count) => {
                second = second.get(count.saturating_sub(first.len())..).unwrap_or_default();
                first = first.get(count..).unwrap_or_default();
            }
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    sink.write_all(second)
}
