//! The rows of a table into numbers: one pass over the bytes, no copy of the text.

use crate::blocks::{Blocks, SHORT};
use crate::error::{Error, Place, Problem, Result, shorten};
use crate::large_pages;
use crate::number::{self, Cell, Shape};
use crate::sheet::{Delimiter, LINE_LIMIT, Sheet, line_at, split};
use crate::stamp::{self, Cycle};
use crate::wide::{Vectors, wide};
use shisei_core::Vec3;
use std::borrow::Cow;
use std::collections::VecDeque;
use std::sync::{Mutex, mpsc};

/// Slots of a row: time, acc ×3, gyr ×3, temperature, coarse time, gravity ×3.
pub(crate) const SLOTS: usize = 12;
/// Slot of the time column.
pub(crate) const TIME: usize = 0;
/// First slot of the acceleration.
pub(crate) const ACC: usize = 1;
/// First slot of the angular rate.
pub(crate) const GYRO: usize = 4;
/// Slot of the temperature.
pub(crate) const TEMP: usize = 7;
/// Slot of a second, coarser time column.
pub(crate) const COARSE: usize = 8;
/// First slot of a gravity that is added to the acceleration.
pub(crate) const GRAVITY: usize = 9;

/// How cells of a time column are read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum TimeForm {
    /// Plain numbers.
    #[default]
    Number,
    /// Numbers of ten and more digits: read exactly, less this origin.
    Large(i64),
    /// Text stamps; nanoseconds of the first are taken off.
    Text(i64),
}

/// What to read.
#[derive(Clone, Debug, Default)]
pub(crate) struct Wanted {
    /// Column of each slot.
    pub slot: [Option<usize>; SLOTS],
    /// Form of the two time slots.
    pub time_form: TimeForm,
    /// Form of the coarse time.
    pub coarse_form: TimeForm,
    /// Columns kept as text.
    pub keep: Vec<usize>,
    /// Leave bad rows out.
    pub skip_bad: bool,
    /// A blank or text temperature is no error: it becomes NaN.
    pub lenient_temp: bool,
}

/// What was read.
#[derive(Debug, Default)]
pub(crate) struct Body {
    pub rows: usize,
    pub time: Vec<f64>,
    pub coarse: Vec<f64>,
    pub acc: Vec<Vec3>,
    pub gyro: Vec<Vec3>,
    pub temp: Vec<f64>,
    pub keep: Vec<Vec<Box<str>>>,
    /// Bad rows left out because the user said so.
    pub skipped: usize,
    /// Incomplete rows at the start and at the end.
    pub trimmed: usize,
    /// Every acceleration and angular rate is a whole number.
    pub whole_numbers: bool,
}

/// The form of a time column, from its first cells.
pub(crate) fn time_form(sheet: &Sheet<'_>, column: usize) -> Option<TimeForm> {
    let cell = sheet.sample.iter().filter_map(|row| row.get(column)).find(|c| !c.trim().is_empty())?;
    let text = cell.trim().as_bytes();
    match number::cell(text, sheet.decimal) {
        Cell::Number(_) => {
            let digits = text.iter().take_while(|b| b.is_ascii_digit()).count();
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
struct Bad {
    problem: Problem,
    column: Option<usize>,
    incomplete: bool,
}

/// What is read from a column, and into which slot.
#[derive(Clone, Copy, Debug)]
enum Action {
    Skip,
    Number(u8),
    Time(u8, TimeForm),
}

struct Reader<'a, 's> {
    sheet: &'a Sheet<'s>,
    wanted: &'a Wanted,
    /// What to do with each column.
    action: Vec<Action>,
    /// Columns up to the last wanted one.
    needed: usize,
    /// Columns at the start, save the last wanted one, that are all plain numbers.
    plain: usize,
    vectors: Vectors,
}

/// Reads all rows of a text in memory.
pub(crate) fn read(sheet: &Sheet<'_>, wanted: &Wanted) -> Result<Body> {
    read_blocks(sheet, wanted, Blocks::of(sheet.text.get(sheet.data_offset..).unwrap_or_default()))
}

/// Reads all rows; `blocks` starts with the first of them. Long texts are read by as many threads as there are
/// processors; what is read does not depend on their number.
pub(crate) fn read_blocks(sheet: &Sheet<'_>, wanted: &Wanted, blocks: Blocks<'_>) -> Result<Body> {
    read_by(Vectors::widest(), sheet, wanted, blocks)
}

fn read_by(vectors: Vectors, sheet: &Sheet<'_>, wanted: &Wanted, blocks: Blocks<'_>) -> Result<Body> {
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
            *place = if form == TimeForm::Number { Action::Number(slot) } else { Action::Time(slot, form) };
        }
    }
    let plain = action.iter().take(last).take_while(|action| matches!(action, Action::Number(_))).count();
    let reader = Reader { sheet, wanted, action, needed: last + 1, plain, vectors };
    let mut joined = Joined::new(&reader, blocks.length);
    let threads = match blocks.pieces.threads {
        _ if !matches!(sheet.delimiter, Delimiter::Byte(_)) => 1,
        Some(threads) => threads,
        None if blocks.length < SHORT => 1,
        None => std::thread::available_parallelism().map_or(1, std::num::NonZero::get),
    };
    if threads > 1 {
        joined.parallel(blocks, threads)?;
    } else {
        joined.alone(blocks)?;
    }
    joined.finish()
}

/// The rows so far, in the order of the file.
struct Joined<'a, 's> {
    reader: &'a Reader<'a, 's>,
    out: Body,
    line_number: usize,
    /// The first of the incomplete rows that may be the end, and their number.
    pending: Option<(Error, usize)>,
    shape: Vec<Shape>,
}

/// The rows at the start of a block that are plain numbers.
struct Start<'b> {
    block: Cow<'b, [u8]>,
    rows: Body,
    /// Where the row that needs care begins, or the block's end.
    stop: usize,
}

impl<'a, 's> Joined<'a, 's> {
    fn new(reader: &'a Reader<'a, 's>, length: u64) -> Self {
        let wanted = reader.wanted;
        let mut out = Body::new(wanted);
        reserve(&mut out, reader.sheet, length, wanted);
        let shape = vec![Shape::default(); reader.needed];
        Joined { reader, out, line_number: reader.sheet.data_line - 1, pending: None, shape }
    }

    fn unreadable(&self, error: &std::io::Error) -> Error {
        Error::of_file(self.reader.sheet.name, Problem::Unreadable { detail: error.to_string() })
    }

    fn alone(&mut self, mut blocks: Blocks<'_>) -> Result<()> {
        while let Some(block) = blocks.next().map_err(|e| self.unreadable(&e))? {
            self.shape.iter_mut().for_each(Shape::trust);
            self.rest(&block, 0)?;
            blocks.give_back(block);
        }
        Ok(())
    }

    /// Threads read the plain rows of the blocks to come, this one joins them in order and reads the others.
    fn parallel(&mut self, mut blocks: Blocks<'_>, threads: usize) -> Result<()> {
        let reader = self.reader;
        let (send, receive) = mpsc::channel::<(Cow<'_, [u8]>, mpsc::Sender<Start<'_>>)>();
        let receive = Mutex::new(receive);
        std::thread::scope(|scope| {
            for _ in 0..threads {
                scope.spawn(|| {
                    let mut shape = vec![Shape::default(); reader.needed];
                    loop {
                        let job = receive.lock().map_or(None, |jobs| jobs.recv().ok());
                        let Some((block, answer)) = job else { return };
                        // Nobody waits where an earlier row was refused.
                        let _ = answer.send(reader.start(block, &mut shape));
                    }
                });
            }
            let send = send; // dropped at the end: the threads end too
            let mut coming = VecDeque::new();
            let mut ended = false;
            loop {
                while !ended && coming.len() < 2 * threads {
                    match blocks.next().map_err(|e| self.unreadable(&e))? {
                        None => ended = true,
                        Some(block) => {
                            let (answer, result) = mpsc::channel();
                            if send.send((block, answer)).is_ok() {
                                coming.push_back(result);
                            }
                        }
                    }
                }
                let Some(next) = coming.pop_front() else { return Ok(()) };
                let Ok(start) = next.recv() else { return Ok(()) };
                self.join(start.rows)?;
                self.rest(&start.block, start.stop)?;
                blocks.give_back(start.block);
            }
        })
    }

    fn join(&mut self, mut rows: Body) -> Result<()> {
        if rows.rows == 0 {
            return Ok(());
        }
        if let Some((error, _)) = self.pending.take() {
            return Err(error);
        }
        let out = &mut self.out;
        self.line_number += rows.rows;
        out.rows += rows.rows;
        out.time.append(&mut rows.time);
        out.coarse.append(&mut rows.coarse);
        out.acc.append(&mut rows.acc);
        out.gyro.append(&mut rows.gyro);
        out.temp.append(&mut rows.temp);
        for (kept, more) in out.keep.iter_mut().zip(&mut rows.keep) {
            kept.append(more);
        }
        out.whole_numbers &= rows.whole_numbers;
        Ok(())
    }

    /// Reads the rows of a block from `at` on.
    fn rest(&mut self, text: &[u8], mut at: usize) -> Result<()> {
        let Joined { reader, out, line_number, pending, shape } = self;
        let wanted = reader.wanted;
        let mut row = [0.0f64; SLOTS];
        loop {
            let rows = out.rows;
            at = plain_rows(reader.vectors, reader, text, at, out, shape);
            *line_number += out.rows - rows;
            if out.rows > rows
                && let Some((error, _)) = pending.take()
            {
                return Err(error);
            }
            let Some((line, next)) = line_at(text, at) else { break };
            *line_number += 1;
            let start = at;
            at = next;
            if line.len() > LINE_LIMIT {
                let place =
                    Place { file: reader.sheet.name.to_owned(), line: Some(*line_number), column: None };
                return Err(Error::at(Problem::LineTooLong { limit: LINE_LIMIT }, place));
            }
            if number::trim(line).is_empty() {
                continue;
            }
            match reader.slow(line, &mut row) {
                Ok(()) => {
                    if let Some((error, _)) = pending.take() {
                        return Err(error);
                    }
                    push(out, &row, wanted);
                    if !wanted.keep.is_empty() {
                        reader.keep(text.get(start..next).unwrap_or_default(), out);
                    }
                }
                Err(_) if wanted.skip_bad => out.skipped += 1,
                Err(bad) => {
                    let error = reader.error(&bad, *line_number);
                    if !bad.incomplete {
                        return Err(pending.take().map_or(error, |(first, _)| first));
                    }
                    if out.rows == 0 {
                        out.trimmed += 1;
                        // A table that never gets complete: the first reason is the one to tell.
                        if out.trimmed > 1000 {
                            return Err(error);
                        }
                    } else {
                        let count = pending.as_ref().map_or(0, |(_, n)| *n) + 1;
                        let first = pending.take().map_or(error, |(first, _)| first);
                        if count > 1000 {
                            return Err(first);
                        }
                        *pending = Some((first, count));
                    }
                }
            }
        }
        Ok(())
    }

    fn finish(self) -> Result<Body> {
        let Joined { mut out, pending, reader, .. } = self;
        if let Some((error, count)) = pending {
            if out.rows == 0 {
                return Err(error);
            }
            out.trimmed += count;
        }
        if out.rows < 2 {
            return Err(Error::of_file(reader.sheet.name, Problem::TooFewRows { rows: out.rows }));
        }
        Ok(out)
    }
}

impl Body {
    fn new(wanted: &Wanted) -> Body {
        Body { whole_numbers: true, keep: vec![Vec::new(); wanted.keep.len()], ..Body::default() }
    }
}

/// Room for as many rows as the first lines' length suggests in `length` bytes.
fn reserve(out: &mut Body, sheet: &Sheet<'_>, length: u64, wanted: &Wanted) {
    let rest = sheet.text.get(sheet.data_offset..).unwrap_or_default();
    let head = rest.get(..rest.len().min(1 << 16)).unwrap_or(rest);
    let lines = memchr::memchr_iter(b'\n', head).count().max(1);
    let length = length.min(1 << 36) as usize;
    let rows = (length as f64 / (head.len().max(1) as f64 / lines as f64) * 1.02) as usize + 16;
    // Never more than the text could hold: two bytes a cell.
    let rows = rows.min(length / 4 + 16);
    let has = |slot: usize| wanted.slot.get(slot).is_some_and(Option::is_some);
    if has(TIME) {
        make_room(&mut out.time, rows);
    }
    if has(ACC) {
        make_room(&mut out.acc, rows);
    }
    if has(GYRO) {
        make_room(&mut out.gyro, rows);
    }
    if has(TEMP) {
        make_room(&mut out.temp, rows);
    }
}

fn make_room<T>(series: &mut Vec<T>, rows: usize) {
    series.reserve_exact(rows);
    large_pages::ask_for(series);
}

#[inline(always)]
pub(crate) fn push(out: &mut Body, row: &[f64; SLOTS], wanted: &Wanted) {
    out.rows += 1;
    if wanted.slot[TIME].is_some() {
        out.time.push(row[TIME]);
    }
    if wanted.slot[COARSE].is_some() {
        out.coarse.push(row[COARSE]);
    }
    if wanted.slot[GRAVITY].is_some() {
        out.acc.push([0, 1, 2].map(|i| row[ACC + i] + row[GRAVITY + i]));
    } else if wanted.slot[ACC].is_some() {
        out.acc.push([row[ACC], row[ACC + 1], row[ACC + 2]]);
    }
    if wanted.slot[GYRO].is_some() {
        out.gyro.push([row[GYRO], row[GYRO + 1], row[GYRO + 2]]);
    }
    if wanted.slot[TEMP].is_some() {
        out.temp.push(row[TEMP]);
    }
    if out.whole_numbers {
        out.whole_numbers = row[ACC..GYRO + 3].iter().all(|v| *v == v.trunc());
    }
}

wide! {
    /// Reads the plain rows from `at` on; gives where the row begins that needs care, or the text's end. `shape` has
    /// what each column's number in the row before looked like.
    fn plain_rows<'a, 's; >(
        reader: &Reader<'a, 's>,
        text: &[u8],
        at: usize,
        out: &mut Body,
        shape: &mut [Shape],
    ) -> usize {
        let mut row = [0.0f64; SLOTS];
        let mut at = at;
        while at < text.len()
            && let Some(next) = reader.fast(text, at, &mut row, shape)
        {
            push(out, &row, reader.wanted);
            if !reader.wanted.keep.is_empty() {
                reader.keep(text.get(at..next).unwrap_or_default(), out);
            }
            at = next;
        }
        at
    }
}

impl Reader<'_, '_> {
    /// Reads the plain rows at the start of a block.
    fn start<'b>(&self, block: Cow<'b, [u8]>, shape: &mut [Shape]) -> Start<'b> {
        shape.iter_mut().for_each(Shape::trust);
        let mut rows = Body::new(self.wanted);
        reserve(&mut rows, self.sheet, block.len() as u64, self.wanted);
        let stop = plain_rows(self.vectors, self, &block, 0, &mut rows, shape);
        Start { block, rows, stop }
    }

    /// Reads a row of plain numbers; gives the start of the next line, or nothing where the row needs care.
    /// `shape` has what each column's number in the row before looked like.
    #[inline(always)]
    fn fast(&self, text: &[u8], start: usize, row: &mut [f64; SLOTS], shape: &mut [Shape]) -> Option<usize> {
        let Delimiter::Byte(separator) = self.sheet.delimiter else { return None };
        let decimal = self.sheet.decimal;
        let mut at = start;
        let last = self.needed - 1;
        // Numbers with the separator after them, then the others.
        let (plain, others) = self.action.split_at_checked(self.plain)?;
        let (plain_shapes, shapes) = shape.split_at_mut_checked(self.plain)?;
        for (action, shape) in plain.iter().zip(plain_shapes) {
            let Action::Number(slot) = action else { return None };
            let (value, end) = number::scan_like(text, at, decimal, separator, shape)?;
            *row.get_mut(usize::from(*slot))? = value;
            if text.get(end) != Some(&separator) {
                return None;
            }
            at = end + 1;
        }
        for ((column, action), shape) in (self.plain..).zip(others).zip(shapes) {
            let end = match action {
                Action::Number(slot) => {
                    let place = row.get_mut(usize::from(*slot))?;
                    let after = if column == last { b'\n' } else { separator };
                    let (value, end) = number::scan_like(text, at, decimal, after, shape)?;
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
            match text.get(end) {
                Some(b) if *b == separator => at = end + 1,
                Some(b'\n') if column == last => return Some(end + 1),
                Some(b'\r') if column == last && text.get(end + 1) == Some(&b'\n') => return Some(end + 2),
                None if column == last => return Some(end),
                _ => return None,
            }
        }
        // More cells follow on the line.
        match memchr::memchr(b'\n', text.get(at..)?) {
            Some(end) if end <= LINE_LIMIT => Some(at + end + 1),
            None if text.len() - at <= LINE_LIMIT => Some(text.len()),
            _ => None,
        }
    }

    fn slow(&self, line: &[u8], row: &mut [f64; SLOTS]) -> std::result::Result<(), Bad> {
        let cells = split(line, self.sheet.delimiter);
        let decimal = self.sheet.decimal;
        let numbers = cells.iter().filter(|c| matches!(number::cell(c, decimal), Cell::Number(_))).count();
        if cells.len() < self.needed {
            let problem = Problem::ShortRow { cells: cells.len(), needed: self.needed };
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

    fn keep(&self, line: &[u8], out: &mut Body) {
        let cells = split(line.trim_ascii_end(), self.sheet.delimiter);
        for (column, kept) in self.wanted.keep.iter().zip(&mut out.keep) {
            let cell = cells.get(*column).copied().unwrap_or_default();
            kept.push(self.sheet.encoding.decode(number::trim(cell)).into());
        }
    }

    fn error(&self, bad: &Bad, line: usize) -> Error {
        let column = bad.column.map(|c| (c + 1, self.sheet.header.get(c).cloned().unwrap_or_default()));
        let place = Place { file: self.sheet.name.to_owned(), line: Some(line), column };
        Error::at(bad.problem.clone(), place)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::options::Options;
    use crate::sheet;

    /// Every way of writing numbers, in lines of several kinds.
    #[test]
    fn every_width_reads_the_same_numbers() {
        let mut text = "time_s,acc_x,acc_y,acc_z,gyr_x,gyr_y,gyr_z\n".to_owned();
        let mut expected = Vec::new();
        for k in 0..3_000u32 {
            let (a, b) = (f64::from(k) * 0.01, f64::from(k.wrapping_mul(2_654_435_761)) / 1e9 - 2.0);
            let cells = match k % 50 {
                7 => [format!("{a:e}"), format!("{b}")],
                8 => [format!("+{a}"), format!(" {b:.17}")],
                _ => [format!("{a:.3}"), format!("{b:.6}")],
            };
            expected.push(cells.each_ref().map(|cell| cell.trim().parse::<f64>().unwrap()));
            let [a, b] = cells;
            text += &format!("{a},{b},0.25,9.81,{b},-1,{b}{}", if k % 50 == 9 { "\r\n" } else { "\n" });
        }
        let sheet = sheet::sniff("a.csv", text.as_bytes(), &Options::default()).unwrap();
        let wanted =
            Wanted { slot: std::array::from_fn(|slot| (slot < TEMP).then_some(slot)), ..Wanted::default() };
        for vectors in Vectors::all() {
            let blocks = Blocks::of(sheet.text.get(sheet.data_offset..).unwrap());
            let body = read_by(vectors, &sheet, &wanted, blocks).unwrap();
            let bits = |v: f64| v.to_bits();
            assert!(
                body.time.iter().map(|v| bits(*v)).eq(expected.iter().map(|v| bits(v[0]))),
                "{vectors:?}"
            );
            assert!(
                body.acc.iter().map(|v| bits(v[0])).eq(expected.iter().map(|v| bits(v[1]))),
                "{vectors:?}"
            );
            assert!(
                body.gyro.iter().map(|v| bits(v[2])).eq(expected.iter().map(|v| bits(v[1]))),
                "{vectors:?}"
            );
        }
    }
}
