//! Rows of nothing but plain numbers, many at a time: first where each number ends, one after the other, then what they
//! are, a column at a time in vectors.

use crate::shape::{Shape, Taken};

/// Rows that are read together.
pub(crate) const ROWS: usize = 32;
/// Fewer are not worth it.
const FEW: usize = 4;
/// Rows that are left to others after a tile that was none; twice as many after the next.
const PAUSE: usize = 64;

/// Some rows, column by column.
pub(crate) struct Tile {
    columns: Vec<Column>,
    /// Rows to be left to others.
    left: usize,
    pause: usize,
}

/// A column's numbers in the rows at hand.
struct Column {
    /// The byte after each.
    after: u8,
    low: [u64; ROWS],
    high: [u64; ROWS],
    length: [u64; ROWS],
    negative: [u64; ROWS],
    values: [f64; ROWS],
}

impl Tile {
    /// For tables of so many columns, with these bytes after a number and after a row's last.
    pub fn new(columns: usize, separator: u8, after_last: u8) -> Tile {
        let none = |k| Column {
            after: if k + 1 < columns { separator } else { after_last },
            low: [0; ROWS],
            high: [0; ROWS],
            length: [0; ROWS],
            negative: [0; ROWS],
            values: [0.0; ROWS],
        };
        Tile { columns: (0..columns).map(none).collect(), left: 0, pause: PAUSE }
    }

    /// Forgets tiles that were none.
    pub fn trust(&mut self) {
        (self.left, self.pause) = (0, PAUSE);
    }

    /// The values of a column.
    #[inline(always)]
    pub fn values(&self, column: usize) -> Option<&[f64; ROWS]> {
        self.columns.get(column).map(|column| &column.values)
    }

    /// Reads rows from `at` on as long as they look as guessed: how many, and where the next begins. Nothing where a row
    /// is to be read otherwise. `next_line` gives where the next row begins, of the place after a row's last number.
    #[inline(always)]
    pub fn read(
        &mut self,
        text: &[u8],
        at: usize,
        shapes: &mut [Shape],
        next_line: impl Fn(&[u8], usize) -> Option<usize>,
    ) -> Option<(usize, usize)> {
        if self.left > 0 {
            self.left -= 1;
            return None;
        }
        let (mut rows, mut next) = (0, at);
        while rows < ROWS
            && let Some(end) = self.take(text, next, rows, shapes)
            && let Some(start) = next_line(text, end)
        {
            rows += 1;
            next = start;
        }
        let mut wrong = 0;
        for (column, shape) in self.columns.iter_mut().zip(shapes) {
            wrong |= column.understand(shape, rows);
        }
        if wrong != 0 || rows < FEW {
            self.left = self.pause;
            self.pause = self.pause.saturating_mul(2);
            return None;
        }
        self.pause = PAUSE;
        Some((rows, next))
    }

    /// Takes the numbers of a row; gives the place after the last.
    #[inline(always)]
    fn take(&mut self, text: &[u8], at: usize, row: usize, shapes: &mut [Shape]) -> Option<usize> {
        let mut end = at.wrapping_sub(1);
        for (column, shape) in self.columns.iter_mut().zip(shapes) {
            let (taken, after) = shape.take(text, end.wrapping_add(1), column.after)?;
            column.keep(row, &taken);
            end = after;
        }
        Some(end)
    }
}

impl Column {
    #[inline(always)]
    fn keep(&mut self, row: usize, taken: &Taken) {
        let row = row % ROWS;
        self.low[row] = taken.low;
        self.high[row] = taken.high;
        self.length[row] = taken.length;
        self.negative[row] = taken.negative;
    }

    /// Not zero where a number of the first `rows` is not what it seemed.
    #[inline(always)]
    fn understand(&mut self, shape: &Shape, rows: usize) -> u64 {
        let shape = *shape;
        let mut all = 0;
        for row in 0..ROWS {
            let taken = Taken {
                low: self.low[row],
                high: self.high[row],
                length: self.length[row],
                negative: self.negative[row],
            };
            let (value, wrong) = shape.value(&taken);
            self.values[row] = value;
            all |= if row < rows { wrong } else { 0 };
        }
        all
    }
}
