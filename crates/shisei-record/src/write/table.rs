//! Rows of a table into text: numbers are made ready together, then put into place row by row.

use super::digits::TILE;
use super::page::{Page, Pieces, Row};
use super::{Column, Decimals, Made, Style, decimal::Fixed, push_text, shortest::Shortest};
use crate::wide::{Vectors, wide};
use std::collections::VecDeque;
use std::io::{self, Write};
use std::sync::{Mutex, mpsc};

/// Rows that are made into text together; the text stays in the processor's cache.
const ROWS: usize = 1024;
/// Rows whose numbers are made ready together: as many tiles as there are columns of numbers.
const BLOCK: usize = TILE;
/// Numbers below which a table is written by one thread.
pub(super) const SMALL: usize = 1 << 18;

/// Writes the rows after `header`. Long tables are made into text by as many threads as there are processors, the same
/// text whatever their number.
pub(super) fn write(
    vectors: Vectors,
    sink: &mut dyn Write,
    header: &[u8],
    (before, made, after): (&[Column<'_>], &mut Made<'_>, &[Column<'_>]),
    decimals: Decimals,
) -> io::Result<()> {
    let rows = before.iter().chain(after).map(Column::len).max().unwrap_or(0).max(made.rows);
    let mut cells: Vec<Cell<'_>> = before.iter().map(Cell::of).collect();
    cells.extend((0..made.columns).map(Cell::Made));
    cells.extend(after.iter().map(Cell::of));
    let table = Table { cells: &cells, rows, vectors };
    let mut pieces = Pieces::new(sink, header);
    let write = match decimals {
        Decimals::Shortest => Table::write::<Shortest>,
        Decimals::Fixed(0) => Table::write::<Fixed<0>>,
        Decimals::Fixed(1) => Table::write::<Fixed<1>>,
        Decimals::Fixed(2) => Table::write::<Fixed<2>>,
        Decimals::Fixed(3) => Table::write::<Fixed<3>>,
        Decimals::Fixed(4) => Table::write::<Fixed<4>>,
        Decimals::Fixed(5) => Table::write::<Fixed<5>>,
        Decimals::Fixed(6) => Table::write::<Fixed<6>>,
        Decimals::Fixed(7) => Table::write::<Fixed<7>>,
        Decimals::Fixed(8) => Table::write::<Fixed<8>>,
        Decimals::Fixed(9) => Table::write::<Fixed<9>>,
        Decimals::Fixed(10) => Table::write::<Fixed<10>>,
        Decimals::Fixed(11) => Table::write::<Fixed<11>>,
        Decimals::Fixed(_) => Table::write::<Fixed<12>>,
    };
    write(&table, &mut pieces, made)?;
    pieces.finish()
}

/// What stands at one place of every row.
#[derive(Clone, Copy)]
enum Cell<'a> {
    Number(&'a Column<'a>),
    /// A column of the numbers that are made.
    Made(usize),
    Flags(&'a [bool]),
    Texts(&'a [Box<str>]),
}

impl<'a> Cell<'a> {
    fn of(column: &'a Column<'a>) -> Self {
        match column {
            Column::Flags(flags) => Cell::Flags(flags),
            Column::Texts(texts) => Cell::Texts(texts),
            Column::Numbers(_) | Column::Strided { .. } | Column::Computed { .. } => Cell::Number(column),
        }
    }

    fn is_number(&self) -> bool {
        matches!(self, Cell::Number(_) | Cell::Made(_))
    }
}

/// Some rows on their way to text.
#[derive(Default)]
struct Job {
    start: usize,
    /// The numbers that are made, column after column, each of `made_rows`.
    made: Vec<f64>,
    made_rows: usize,
    page: Page,
}

/// Numbers of some rows, made ready.
struct Ready<S> {
    /// Row after row.
    values: Vec<f64>,
    styles: Vec<S>,
}

struct Table<'a> {
    cells: &'a [Cell<'a>],
    rows: usize,
    vectors: Vectors,
}

impl Table<'_> {
    fn write<S: Style>(&self, pieces: &mut Pieces<'_>, made: &mut Made<'_>) -> io::Result<()> {
        let threads = if self.rows * self.cells.len() < SMALL {
            1
        } else {
            std::thread::available_parallelism().map_or(1, std::num::NonZero::get)
        };
        if threads > 1 {
            return self.parallel::<S>(pieces, made, threads);
        }
        let (mut job, mut ready) = (Job::default(), self.ready::<S>());
        for start in (0..self.rows).step_by(ROWS) {
            job.make(start, made);
            lines(self.vectors, self, &mut job, &mut ready);
            job.page = pieces.write(job.page)?;
        }
        Ok(())
    }

    fn ready<S: Style>(&self) -> Ready<S> {
        let numbers = self.cells.iter().filter(|cell| cell.is_number()).count();
        let mut styles = Vec::new();
        styles.resize_with(numbers, S::default);
        Ready { values: vec![0.0; numbers * TILE], styles }
    }

    /// Threads make the text, this one makes what is made row after row and writes the text in order.
    fn parallel<S: Style>(
        &self,
        pieces: &mut Pieces<'_>,
        made: &mut Made<'_>,
        threads: usize,
    ) -> io::Result<()> {
        let (send, receive) = mpsc::channel::<(Job, mpsc::Sender<Job>)>();
        let receive = Mutex::new(receive);
        std::thread::scope(|scope| {
            for _ in 0..threads {
                scope.spawn(|| {
                    let mut ready = self.ready::<S>();
                    loop {
                        let next = receive.lock().map_or(None, |jobs| jobs.recv().ok());
                        let Some((mut job, answer)) = next else { return };
                        lines(self.vectors, self, &mut job, &mut ready);
                        // Nobody waits where writing failed.
                        let _ = answer.send(job);
                    }
                });
            }
            let send = send; // dropped at the end: the threads end too
            let mut spare: Vec<Job> = Vec::new();
            let mut coming = VecDeque::new();
            let mut starts = (0..self.rows).step_by(ROWS);
            loop {
                while coming.len() < 4 * threads
                    && let Some(start) = starts.next()
                {
                    let (answer, result) = mpsc::channel();
                    let mut job = spare.pop().unwrap_or_default();
                    job.make(start, made);
                    if send.send((job, answer)).is_ok() {
                        coming.push_back(result);
                    }
                }
                let Some(next) = coming.pop_front() else { return Ok(()) };
                let Ok(mut job) = next.recv() else { return Ok(()) };
                job.page = pieces.write(job.page)?;
                spare.push(job);
            }
        })
    }
}

impl Job {
    /// Makes the numbers that are made, of the rows from `start` on.
    fn make(&mut self, start: usize, made: &mut Made<'_>) {
        self.start = start;
        self.made_rows = made.rows.saturating_sub(start).min(ROWS);
        self.made.resize(made.columns * self.made_rows, 0.0);
        if !self.made.is_empty() {
            (made.next)(&mut self.made);
        }
    }

    /// The numbers of a cell in some rows from `first` on; NaN beyond the last.
    #[inline(always)]
    fn numbers(&self, cell: &Cell<'_>, first: usize, out: &mut [f64]) {
        let filled = match cell {
            Cell::Number(column) => column.fill(first, out),
            Cell::Made(k) => {
                let offset = first - self.start;
                let rows = self.made_rows.saturating_sub(offset).min(out.len());
                let from = k * self.made_rows + offset;
                let (known, beyond) = out.split_at_mut(rows);
                beyond.fill(f64::NAN);
                self.made.get(from..from + rows).map(|values| known.copy_from_slice(values))
            }
            Cell::Flags(_) | Cell::Texts(_) => None,
        };
        if filled.is_none() {
            out.fill(f64::NAN);
        }
    }
}

wide! {
    /// The text of a job's rows.
    fn lines<; S: Style>(table: &Table<'_>, job: &mut Job, ready: &mut Ready<S>) {
        job.page.clear();
        let end = table.rows.min(job.start + ROWS);
        let all_numbers = ready.styles.len() == table.cells.len();
        for first in (job.start..end).step_by(BLOCK) {
            let rows = BLOCK.min(end - first);
            take(table, job, ready, first, rows);
            if all_numbers {
                number_rows(&mut job.page, ready, rows);
            } else {
                mixed_rows(table, &mut job.page, ready, first, rows);
            }
        }
    }
}

/// Takes the numbers of `rows` rows from `first` on, row after row, and makes them ready.
#[inline(always)]
fn take<S: Style>(table: &Table<'_>, job: &Job, ready: &mut Ready<S>, first: usize, rows: usize) {
    let columns = ready.styles.len();
    let mut column = [0.0; BLOCK];
    let numbers = table.cells.iter().filter(|cell| cell.is_number());
    for (offset, cell) in numbers.enumerate() {
        job.numbers(cell, first, column.get_mut(..rows).unwrap_or_default());
        let places = ready.values.get_mut(offset..).unwrap_or_default().iter_mut().step_by(columns);
        for (place, value) in places.zip(column) {
            *place = value;
        }
    }
    let tiles = (rows * columns).div_ceil(TILE);
    for (values, style) in ready.values.as_chunks::<TILE>().0.iter().zip(&mut ready.styles).take(tiles) {
        style.prepare(values);
    }
}

/// Rows of nothing but numbers.
#[inline(always)]
fn number_rows<S: Style>(page: &mut Page, ready: &Ready<S>, rows: usize) {
    let mut row = Row::of(ready.styles.len());
    let mut left = rows * ready.styles.len();
    for (values, style) in ready.values.as_chunks::<TILE>().0.iter().zip(&ready.styles) {
        page.numbers(style, values, left.min(TILE), &mut row);
        left = left.saturating_sub(TILE);
    }
}

/// Rows with flags and texts between the numbers.
#[inline(always)]
fn mixed_rows<S: Style>(table: &Table<'_>, page: &mut Page, ready: &Ready<S>, first: usize, rows: usize) {
    let mut cell = 0;
    for row in first..first + rows {
        for kind in table.cells {
            match kind {
                Cell::Flags(flags) => {
                    page.byte(if flags.get(row) == Some(&true) { b'1' } else { b'0' });
                    page.byte(b',');
                }
                Cell::Texts(texts) => {
                    page.odd(|out| {
                        push_text(out, texts.get(row).map_or("", |t| t));
                        out.push(b',');
                    });
                }
                Cell::Number(_) | Cell::Made(_) => {
                    if let (Some(style), Some(value)) =
                        (ready.styles.get(cell / TILE), ready.values.get(cell))
                    {
                        page.number(style, cell % TILE, *value, b',');
                    }
                    cell += 1;
                }
            }
        }
        page.end_line();
    }
}
