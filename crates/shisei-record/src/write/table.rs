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
    cells.extend((0..made.columns).map(|_| Cell::Made));
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
    /// A number that is made.
    Made,
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
}

/// Some rows on their way to text.
#[derive(Default)]
struct Job {
    start: usize,
    rows: usize,
    /// The numbers, row after row; at the end so many more that all are parts of tiles.
    values: Vec<f64>,
    page: Page,
}

struct Table<'a> {
    cells: &'a [Cell<'a>],
    rows: usize,
    vectors: Vectors,
}

impl<'a> Table<'a> {
    fn write<S: Style>(&self, pieces: &mut Pieces<'_>, made: &mut Made<'_>) -> io::Result<()> {
        let threads = if self.rows * self.cells.len() < SMALL {
            1
        } else {
            std::thread::available_parallelism().map_or(1, std::num::NonZero::get)
        };
        if threads > 1 {
            return self.parallel::<S>(pieces, made, threads);
        }
        let (mut job, mut style) = (Job::default(), S::default());
        for start in (0..self.rows).step_by(ROWS) {
            self.begin(&mut job, start, made);
            lines(self.vectors, self, &mut job, &mut style);
            job.page = pieces.write(job.page)?;
        }
        Ok(())
    }

    /// The cells with numbers.
    fn numbers(&self) -> impl Iterator<Item = &Cell<'a>> {
        self.cells.iter().filter(|cell| matches!(cell, Cell::Number(_) | Cell::Made))
    }

    /// Begins a job with the rows from `start` on, and the numbers of them that are made; NaN beyond the last.
    fn begin(&self, job: &mut Job, start: usize, made: &mut Made<'_>) {
        job.start = start;
        job.rows = ROWS.min(self.rows - start);
        let columns = self.numbers().count();
        job.values.resize((job.rows * columns).next_multiple_of(TILE), 0.0);
        let Some(offset) = self.numbers().position(|cell| matches!(cell, Cell::Made)) else { return };
        let known = columns * made.rows.saturating_sub(start).min(job.rows);
        let (known, beyond) = job.values.split_at_mut(known);
        beyond.fill(f64::NAN);
        if let Some(known) = known.get_mut(offset..) {
            (made.next)(known, columns);
        }
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
                    let mut style = S::default();
                    loop {
                        let next = receive.lock().map_or(None, |jobs| jobs.recv().ok());
                        let Some((mut job, answer)) = next else { return };
                        lines(self.vectors, self, &mut job, &mut style);
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
                    self.begin(&mut job, start, made);
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

wide! {
    /// The text of a job's rows.
    fn lines<; S: Style>(table: &Table<'_>, job: &mut Job, style: &mut S) {
        job.page.clear();
        let columns = table.numbers().count();
        for (offset, cell) in table.numbers().enumerate() {
            if let Cell::Number(column) = cell {
                take(column, job, columns, offset);
            }
        }
        if columns == table.cells.len() {
            number_rows(table.vectors, job, columns, style);
        } else {
            mixed_rows(table, job, style);
        }
    }
}

/// Takes the numbers of a column.
#[inline(always)]
fn take(column: &Column<'_>, job: &mut Job, columns: usize, offset: usize) {
    let mut values = [0.0; TILE];
    for (k, rows) in job.values.chunks_mut(TILE * columns).enumerate() {
        // A column of numbers has them.
        let _ = column.fill(job.start + k * TILE, &mut values);
        for (row, value) in rows.chunks_mut(columns).zip(values) {
            if let Some(place) = row.get_mut(offset) {
                *place = value;
            }
        }
    }
}

/// Rows of nothing but numbers.
#[inline(always)]
fn number_rows<S: Style>(vectors: Vectors, job: &mut Job, columns: usize, style: &mut S) {
    let mut row = Row::of(columns);
    let mut left = job.rows * columns;
    for values in job.values.as_chunks::<TILE>().0 {
        job.page.numbers(vectors, style, values, left.min(TILE), &mut row);
        left = left.saturating_sub(TILE);
    }
}

/// Rows with flags and texts between the numbers.
#[inline(always)]
fn mixed_rows<S: Style>(table: &Table<'_>, job: &mut Job, style: &mut S) {
    let mut cell = 0;
    for row in job.start..job.start + job.rows {
        for kind in table.cells {
            match kind {
                Cell::Flags(flags) => {
                    job.page.byte(if flags.get(row) == Some(&true) { b'1' } else { b'0' });
                    job.page.byte(b',');
                }
                Cell::Texts(texts) => {
                    job.page.odd(|out| {
                        push_text(out, texts.get(row).map_or("", |t| t));
                        out.push(b',');
                    });
                }
                Cell::Number(_) | Cell::Made => {
                    if let Some(values) = job.values.as_chunks::<TILE>().0.get(cell / TILE) {
                        if cell % TILE == 0 {
                            style.prepare(values);
                        }
                        job.page.number(style, cell % TILE, values[cell % TILE], b',');
                    }
                    cell += 1;
                }
            }
        }
        job.page.end_line();
    }
}
