//! Rows of a table into text: numbers are made ready together, then put into place row by row.

use super::digits::TILE;
use super::{Column, Decimals, Style, WINDOW, decimal::Fixed, push_text, shortest::Shortest};
use std::collections::VecDeque;
use std::io::{self, Write};
use std::sync::{Mutex, mpsc};

/// Rows that are made into text together; the text stays in the processor's cache.
const ROWS: usize = 1024;
/// Rows whose numbers are made ready together.
const BLOCK: usize = 64;
/// Numbers below which a table is written by one thread.
pub(super) const SMALL: usize = 1 << 18;

/// Writes the rows. Long tables are made into text by as many threads as there are processors, the same text
/// whatever their number.
pub(super) fn write(sink: &mut dyn Write, columns: &[Column<'_>], decimals: Decimals) -> io::Result<()> {
    let rows = columns.iter().map(Column::len).max().unwrap_or(0);
    let table = Table { columns, rows };
    match decimals {
        Decimals::Shortest => table.write::<Shortest>(sink),
        Decimals::Fixed(0) => table.write::<Fixed<0>>(sink),
        Decimals::Fixed(1) => table.write::<Fixed<1>>(sink),
        Decimals::Fixed(2) => table.write::<Fixed<2>>(sink),
        Decimals::Fixed(3) => table.write::<Fixed<3>>(sink),
        Decimals::Fixed(4) => table.write::<Fixed<4>>(sink),
        Decimals::Fixed(5) => table.write::<Fixed<5>>(sink),
        Decimals::Fixed(6) => table.write::<Fixed<6>>(sink),
        Decimals::Fixed(7) => table.write::<Fixed<7>>(sink),
        Decimals::Fixed(8) => table.write::<Fixed<8>>(sink),
        Decimals::Fixed(9) => table.write::<Fixed<9>>(sink),
        Decimals::Fixed(10) => table.write::<Fixed<10>>(sink),
        Decimals::Fixed(11) => table.write::<Fixed<11>>(sink),
        Decimals::Fixed(_) => table.write::<Fixed<12>>(sink),
    }
}

/// Text that grows; its memory is used again.
#[derive(Default)]
struct Page {
    /// What is written, and room beyond.
    bytes: Vec<u8>,
    length: usize,
    /// Where a text of any length is made.
    odd: Vec<u8>,
}

impl Page {
    /// Room for the text of a number and what parts it from the next.
    #[inline(always)]
    fn room(&mut self) -> Option<&mut [u8; WINDOW]> {
        if self.bytes.len() < self.length + WINDOW {
            self.grow();
        }
        self.bytes.get_mut(self.length..)?.first_chunk_mut()
    }

    #[cold]
    fn grow(&mut self) {
        self.bytes.resize(2 * self.bytes.len() + (1 << 16), 0);
    }

    #[inline]
    fn byte(&mut self, byte: u8) {
        if let Some(room) = self.room() {
            room[0] = byte;
            self.length += 1;
        }
    }

    /// Appends a text of any length.
    fn odd(&mut self, write: impl FnOnce(&mut Vec<u8>)) {
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

    fn text(&self) -> &[u8] {
        self.bytes.get(..self.length).unwrap_or_default()
    }
}

/// Numbers of some rows, made ready.
struct Ready<'a, S> {
    /// Their columns.
    numbers: Vec<&'a Column<'a>>,
    tiles: Vec<([f64; TILE], S)>,
}

impl<S: Style> Ready<'_, S> {
    /// Takes the numbers of `rows` rows from `start` on, row after row.
    fn take(&mut self, start: usize, rows: usize) {
        let mut column_values = [0.0; BLOCK];
        let values = column_values.get_mut(..rows).unwrap_or_default();
        for (offset, column) in self.numbers.iter().enumerate() {
            if column.fill(start, values).is_none() {
                values.fill(f64::NAN);
            }
            let mut cell = offset;
            for value in values.iter() {
                if let Some((tile, _)) = self.tiles.get_mut(cell / TILE) {
                    tile[cell % TILE] = *value;
                }
                cell += self.numbers.len();
            }
        }
        for (values, style) in self.tiles.iter_mut().take((rows * self.numbers.len()).div_ceil(TILE)) {
            style.prepare(values);
        }
    }
}

struct Table<'a> {
    columns: &'a [Column<'a>],
    rows: usize,
}

impl Table<'_> {
    fn write<S: Style>(&self, sink: &mut dyn Write) -> io::Result<()> {
        let threads = if self.rows * self.columns.len() < SMALL {
            1
        } else {
            std::thread::available_parallelism().map_or(1, std::num::NonZero::get)
        };
        if threads > 1 {
            return self.parallel::<S>(sink, threads);
        }
        let (mut page, mut ready) = (Page::default(), self.ready::<S>());
        for start in (0..self.rows).step_by(ROWS) {
            self.lines(&mut page, &mut ready, start);
            sink.write_all(page.text())?;
        }
        Ok(())
    }

    fn ready<S: Style>(&self) -> Ready<'_, S> {
        let is_number = |column: &&Column<'_>| !matches!(column, Column::Flags(_) | Column::Texts(_));
        let numbers: Vec<&Column<'_>> = self.columns.iter().filter(is_number).collect();
        let mut tiles = Vec::new();
        tiles.resize_with((BLOCK * numbers.len()).div_ceil(TILE), || ([0.0; TILE], S::default()));
        Ready { numbers, tiles }
    }

    /// The text of the rows from `start` on, as many as are made together.
    fn lines<S: Style>(&self, page: &mut Page, ready: &mut Ready<'_, S>, start: usize) {
        page.length = 0;
        let end = self.rows.min(start + ROWS);
        for first in (start..end).step_by(BLOCK) {
            let rows = BLOCK.min(end - first);
            ready.take(first, rows);
            if ready.numbers.len() == self.columns.len() {
                plain(page, ready, rows);
            } else {
                self.mixed(page, ready, first, rows);
            }
        }
    }

    /// Rows with flags and texts between the numbers.
    fn mixed<S: Style>(&self, page: &mut Page, ready: &Ready<'_, S>, first: usize, rows: usize) {
        let mut cell = 0;
        for row in first..first + rows {
            for column in self.columns {
                match column {
                    Column::Flags(flags) => {
                        page.byte(if flags.get(row) == Some(&true) { b'1' } else { b'0' });
                    }
                    Column::Texts(texts) => {
                        page.odd(|out| push_text(out, texts.get(row).map_or("", |t| t)));
                    }
                    _ => {
                        if let Some((values, style)) = ready.tiles.get(cell / TILE) {
                            number(page, style, cell % TILE, values[cell % TILE]);
                        }
                        cell += 1;
                    }
                }
                page.byte(b',');
            }
            end_line(page);
        }
    }

    /// Threads make the text, this one writes it in order.
    fn parallel<S: Style>(&self, sink: &mut dyn Write, threads: usize) -> io::Result<()> {
        let (send, receive) = mpsc::channel::<(usize, Page, mpsc::Sender<Page>)>();
        let receive = Mutex::new(receive);
        std::thread::scope(|scope| {
            for _ in 0..threads {
                scope.spawn(|| {
                    let mut ready = self.ready::<S>();
                    loop {
                        let job = receive.lock().map_or(None, |jobs| jobs.recv().ok());
                        let Some((start, mut page, answer)) = job else { return };
                        self.lines(&mut page, &mut ready, start);
                        // Nobody waits where writing failed.
                        let _ = answer.send(page);
                    }
                });
            }
            let send = send; // dropped at the end: the threads end too
            let mut spare = Vec::new();
            let mut coming = VecDeque::new();
            let mut starts = (0..self.rows).step_by(ROWS);
            loop {
                while coming.len() < 4 * threads
                    && let Some(start) = starts.next()
                {
                    let (answer, result) = mpsc::channel();
                    if send.send((start, spare.pop().unwrap_or_default(), answer)).is_ok() {
                        coming.push_back(result);
                    }
                }
                let Some(next) = coming.pop_front() else { return Ok(()) };
                let Ok(page) = next.recv() else { return Ok(()) };
                sink.write_all(page.text())?;
                spare.push(page);
            }
        })
    }
}

/// Rows of nothing but numbers.
fn plain<S: Style>(page: &mut Page, ready: &Ready<'_, S>, rows: usize) {
    let columns = ready.numbers.len();
    let mut left = columns;
    let mut cells = rows * columns;
    for (values, style) in &ready.tiles {
        for (k, value) in values.iter().enumerate().take(cells) {
            left -= 1;
            let after = if left == 0 { b'\n' } else { b',' };
            if left == 0 {
                left = columns;
            }
            let Some(room) = page.room() else { return };
            let length = style.put(k, *value, room);
            if length > 0 {
                room[length] = after;
                page.length += length + 1;
            } else {
                odd::<S>(page, *value);
                page.byte(after);
            }
        }
        cells = cells.saturating_sub(TILE);
    }
}

#[inline(always)]
fn number<S: Style>(page: &mut Page, style: &S, k: usize, value: f64) {
    let Some(room) = page.room() else { return };
    let length = style.put(k, value, room);
    if length > 0 {
        page.length += length;
    } else {
        odd::<S>(page, value);
    }
}

#[cold]
fn odd<S: Style>(page: &mut Page, value: f64) {
    page.odd(|out| S::odd(value, out));
}

/// In place of the last comma.
fn end_line(page: &mut Page) {
    page.length = page.length.saturating_sub(1);
    page.byte(b'\n');
}
