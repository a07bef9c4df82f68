//! A row of a table into numbers, or many rows together.

use crate::body::{Body, COARSE, SLOTS, TEMP, TIME, TimeForm, Wanted, push, push_rows, reserve};
use crate::error::{Error, Place, Problem, shorten};
use crate::number::{self, Cell};
use crate::shape::{Shape, scan_like};
use crate::sheet::{Delimiter, LINE_LIMIT, Sheet, split};
use crate::stamp::{self, Cycle};
use crate::tile::{self, Tile};
use crate::wide::{Vectors, wide};
use std::borrow::Cow;

/// The form of a time column, from its first cells.
pub(crate) fn time_form(sheet: &Sheet<'_>, column: usize) -> Option<TimeForm> {
    let cell = sheet.sample.iter().filter_map(|row| row.get(column)).find(|c| !c.trim().is_empty())?;
    let text = cell.trim().as_bytes();
    let digits = text.iter().take_while(|b| b.is_ascii_digit()).count();
    if let (14 | 17, Some(stamp)) = (digits, stamp::parse(text)) {
        return Some(TimeForm::Text(stamp.ns)); // 20240501103127, a date and no count
    }
    match number::cell(text, sheet.decimal) {
        Cell::Number(_) => {
            if (10..=18).contains(&digits) {
                Some(TimeForm::Large(whole(text.get(..digits)?)?))
            } else if digits == 19 {
                whole(text.get(..digits)?).map(TimeForm::Large)
            } else {
                Some(TimeForm::Number)
            }
        }
        Cell::Text => stamp::parse(text).map(|s| match s.cycle {
            Cycle::None => TimeForm::Text(s.ns),
            _ => TimeForm::Text(0),
        }),
        _ => None,
    }
}

fn whole(text: &[u8]) -> Option<i64> {
    text.iter().try_fold(0i64, |n, b| {
        let digit = b.checked_sub(b'0').filter(|d| *d < 10)?;
        n.checked_mul(10)?.checked_add(i64::from(digit))
    })
}

/// Reads a time cell: seconds for text, the raw number else.
fn time_cell(cell: &[u8], form: TimeForm, decimal: u8) -> std::result::Result<f64, Problem> {
    let text = number::trim(cell);
    match form {
        TimeForm::Number => value(cell, decimal),
        TimeForm::Large(origin) => {
            let digits = text.iter().take_while(|b| b.is_ascii_digit()).count();
            match (text.get(..digits).filter(|d| !d.is_empty()).and_then(whole), text.get(digits..)) {
                (Some(n), Some([])) => Ok(n.saturating_sub(origin) as f64),
                (Some(n), Some([sign, fraction @ ..]))
                    if *sign == decimal && fraction.iter().all(u8::is_ascii_digit) =>
                {
                    let part = match number::cell(text.get(digits..).unwrap_or_default(), decimal) {
                        Cell::Number(part) => part,
                        _ => 0.0,
                    };
                    Ok(n.saturating_sub(origin) as f64 + part)
                }
                _ => value(cell, decimal).map(|v| v - origin as f64),
            }
        }
        TimeForm::Text(origin) => match stamp::parse(text) {
            Some(stamp) => Ok(stamp.ns.saturating_sub(origin) as f64 / 1e9),
            None if text.is_empty() => Err(Problem::Blank),
            None => Err(Problem::BadStamp { text: shorten(&String::from_utf8_lossy(text)) }),
        },
    }
}

fn value(cell: &[u8], decimal: u8) -> std::result::Result<f64, Problem> {
    match number::cell(cell, decimal) {
        Cell::Number(value) => Ok(value),
        Cell::Blank => Err(Problem::Blank),
        Cell::NotFinite => {
            Err(Problem::NotFinite { text: shorten(&String::from_utf8_lossy(number::trim(cell))) })
        }
        Cell::Text => {
            Err(Problem::NotANumber { text: shorten(&String::from_utf8_lossy(number::trim(cell))) })
        }
    }
}

/// Why a row is bad: the problem, its column (from 0), and whether the row may be an incomplete end.
pub(crate) struct Bad {
    problem: Problem,
    column: Option<usize>,
    pub incomplete: bool,
}

/// What is read from a column, and into which slot.
#[derive(Clone, Copy, Debug)]
enum Action {
    Skip,
    Number(u8),
    Time(u8, TimeForm),
}

/// Reads rows of a table.
pub(crate) struct Reader<'a, 's> {
    pub sheet: &'a Sheet<'s>,
    pub wanted: &'a Wanted,
    pub vectors: Vectors,
    /// What to do with each column up to the last wanted one.
    action: Vec<Action>,
    /// What stands after the last wanted number of a row.
    after_last: u8,
}

/// What stands after a column's cell in the first row: the separator, or the line's end.
fn after_cell(sheet: &Sheet<'_>, column: usize) -> u8 {
    let Delimiter::Byte(separator) = sheet.delimiter else { return b'\n' };
    let rest = sheet.text.get(sheet.data_offset..).unwrap_or_default();
    let line = rest.split_inclusive(|b| *b == b'\n').next().unwrap_or_default();
    if memchr::memchr_iter(separator, line).count() > column {
        separator
    } else if line.ends_with(b"\r\n") {
        b'\r'
    } else {
        b'\n'
    }
}

/// The rows at the start of a block that are plain numbers.
pub(crate) struct Start<'b> {
    pub block: Cow<'b, [u8]>,
    pub rows: Body,
    /// Where the row that needs care begins, or the block's end.
    pub stop: usize,
}

/// What is kept from row to row while a text is read.
pub(crate) struct Looks {
    /// What each column's number in the row before looked like.
    shapes: Vec<Shape>,
    /// Where every column holds plain numbers.
    tile: Option<Tile>,
}

impl Looks {
    pub fn new(reader: &Reader<'_, '_>) -> Looks {
        let columns = reader.action.len();
        let plain = reader.action.iter().all(|action| matches!(action, Action::Number(_)));
        let tile = match reader.sheet.delimiter {
            Delimiter::Byte(separator) if plain && reader.wanted.keep.is_empty() => {
                Some(Tile::new(columns, separator, reader.after_last))
            }
            _ => None,
        };
        Looks { shapes: vec![Shape::default(); columns], tile }
    }

    /// Reads every row alone from here on.
    #[cfg(test)]
    pub fn row_by_row(&mut self) {
        self.tile = None;
    }

    /// Forgets wrong guesses.
    pub fn trust(&mut self) {
        self.shapes.iter_mut().for_each(Shape::trust);
        self.tile.iter_mut().for_each(Tile::trust);
    }
}

wide! {
    /// Reads the plain rows from `at` on; gives where the row begins that needs care, or the text's end.
    pub(crate) fn plain_rows<'a, 's; >(
        reader: &Reader<'a, 's>,
        text: &[u8],
        at: usize,
        out: &mut Body,
        looks: &mut Looks,
    ) -> usize {
        let mut row = [0.0f64; SLOTS];
        let mut at = at;
        while at < text.len() {
            if let Some(next) = reader.tile(text, at, out, looks) {
                at = next;
                continue;
            }
            let Some(next) = reader.fast(text, at, &mut row, &mut looks.shapes) else { break };
            push(out, &row, reader.wanted);
            if !reader.wanted.keep.is_empty() {
                reader.keep(text.get(at..next).unwrap_or_default(), out);
            }
            at = next;
        }
        at
    }
}

impl<'a, 's> Reader<'a, 's> {
    /// For a table and what is wanted of it.
    pub fn new(vectors: Vectors, sheet: &'a Sheet<'s>, wanted: &'a Wanted) -> Self {
        let last = wanted.slot.iter().flatten().copied().max().unwrap_or(0);
        let mut action = vec![Action::Skip; last + 1];
        for (slot, column) in wanted.slot.iter().enumerate() {
            let form = match slot {
                TIME => wanted.time_form,
                COARSE => wanted.coarse_form,
                _ => TimeForm::Number,
            };
            if let Some(place) = column.and_then(|c| action.get_mut(c)) {
                let slot = slot as u8;
                *place =
                    if form == TimeForm::Number { Action::Number(slot) } else { Action::Time(slot, form) };
            }
        }
        Reader { sheet, wanted, vectors, action, after_last: after_cell(sheet, last) }
    }

    /// Reads the plain rows at the start of a block.
    pub fn start<'b>(&self, block: Cow<'b, [u8]>, looks: &mut Looks) -> Start<'b> {
        looks.trust();
        let mut rows = Body::new(self.wanted);
        reserve(&mut rows, self.sheet, block.len() as u64, self.wanted);
        let stop = plain_rows(self.vectors, self, &block, 0, &mut rows, looks);
        Start { block, rows, stop }
    }

    /// Reads many rows of plain numbers; gives the start of the line after them, or nothing where the next row is to
    /// be read alone.
    #[inline(always)]
    fn tile(&self, text: &[u8], at: usize, out: &mut Body, looks: &mut Looks) -> Option<usize> {
        let tile = looks.tile.as_mut()?;
        let (rows, next) = tile.read(text, at, &mut looks.shapes, |text, end| self.next_line(text, end))?;
        let mut slots = [[0.0; tile::ROWS].get(..rows)?; SLOTS];
        for (column, action) in self.action.iter().enumerate() {
            if let Action::Number(slot) = action
                && let Some(place) = slots.get_mut(usize::from(*slot))
            {
                *place = tile.values(column)?.get(..rows)?;
            }
        }
        push_rows(out, slots, self.wanted);
        Some(next)
    }

    /// Where the next line begins, of the end of a row's last wanted number.
    #[inline(always)]
    fn next_line(&self, text: &[u8], end: usize) -> Option<usize> {
        match text.get(end) {
            Some(b'\n') => Some(end + 1),
            Some(b'\r') if text.get(end + 1) == Some(&b'\n') => Some(end + 2),
            None => Some(end),
            // More cells follow on the line.
            Some(b) if Delimiter::Byte(*b) == self.sheet.delimiter => {
                let rest = text.get(end + 1..)?;
                match memchr::memchr(b'\n', rest) {
                    Some(length) if length <= LINE_LIMIT => Some(end + length + 2),
                    None if rest.len() <= LINE_LIMIT => Some(text.len()),
                    _ => None,
                }
            }
            Some(_) => None,
        }
    }

    /// Reads a row of plain numbers; gives the start of the next line, or nothing where the row needs care.
    /// `shape` has what each column's number in the row before looked like.
    #[inline(always)]
    fn fast(&self, text: &[u8], start: usize, row: &mut [f64; SLOTS], shape: &mut [Shape]) -> Option<usize> {
        let Delimiter::Byte(separator) = self.sheet.delimiter else { return None };
        let decimal = self.sheet.decimal;
        let mut at = start;
        let last = self.action.len().checked_sub(1)?;
        for ((column, action), shape) in self.action.iter().enumerate().zip(shape) {
            let end = match action {
                Action::Number(slot) => {
                    let place = row.get_mut(usize::from(*slot))?;
                    let after = if column == last { self.after_last } else { separator };
                    let (value, end) = scan_like(text, at, decimal, after, shape)?;
                    *place = value;
                    end
                }
                Action::Skip => {
                    let rest = text.get(at..)?;
                    let end = rest.iter().position(|b| *b == separator || *b == b'\n' || *b == b'"')?;
                    if rest.get(end) != Some(&separator) {
                        return None;
                    }
                    at += end + 1;
                    continue;
                }
                Action::Time(slot, form) => {
                    at += usize::from(text.get(at) == Some(&b' '));
                    let rest = text.get(at..)?;
                    let length = rest.iter().position(|b| *b == separator || *b == b'\n')?;
                    *row.get_mut(usize::from(*slot))? =
                        time_cell(rest.get(..length)?, *form, decimal).ok()?;
                    at + length
                }
            };
            if column == last {
                return self.next_line(text, end);
            }
            if text.get(end) != Some(&separator) {
                return None;
            }
            at = end + 1;
        }
        None
    }

    /// Reads any row.
    pub fn slow(&self, line: &[u8], row: &mut [f64; SLOTS]) -> std::result::Result<(), Bad> {
        let cells = split(line, self.sheet.delimiter);
        let decimal = self.sheet.decimal;
        let numbers = cells.iter().filter(|c| matches!(number::cell(c, decimal), Cell::Number(_))).count();
        if cells.len() < self.action.len() {
            let problem = Problem::ShortRow { cells: cells.len(), needed: self.action.len() };
            return Err(Bad { problem, column: None, incomplete: true });
        }
        for (column, action) in self.action.iter().enumerate() {
            let cell = cells.get(column).copied().unwrap_or_default();
            let (slot, read) = match action {
                Action::Skip => continue,
                Action::Time(slot, form) => (slot, time_cell(cell, *form, decimal)),
                Action::Number(slot) if usize::from(*slot) == TEMP && self.wanted.lenient_temp => {
                    (slot, Ok(value(cell, decimal).unwrap_or(f64::NAN)))
                }
                Action::Number(slot) => (slot, value(cell, decimal)),
            };
            match read {
                Ok(value) => {
                    if let Some(place) = row.get_mut(usize::from(*slot)) {
                        *place = value;
                    }
                }
                Err(problem) => {
                    let incomplete = problem == Problem::Blank || numbers == 0;
                    return Err(Bad { problem, column: Some(column), incomplete });
                }
            }
        }
        Ok(())
    }

    /// Keeps the cells of a row that are kept as text.
    pub fn keep(&self, line: &[u8], out: &mut Body) {
        let cells = split(line.trim_ascii_end(), self.sheet.delimiter);
        for (column, kept) in self.wanted.keep.iter().zip(&mut out.keep) {
            let cell = cells.get(*column).copied().unwrap_or_default();
            kept.push(self.sheet.encoding.decode(number::trim(cell)).into());
        }
    }

    /// What to say of a bad row.
    pub fn error(&self, bad: &Bad, line: usize) -> Error {
        let column = bad.column.map(|c| (c + 1, self.sheet.header.get(c).cloned().unwrap_or_default()));
        let place = Place { file: self.sheet.name.to_owned(), line: Some(line), column };
        Error::at(bad.problem.clone(), place)
    }
}
