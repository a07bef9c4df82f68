//! The rows of a table into numbers: one pass over the bytes, no copy of the text.

use crate::blocks::{Blocks, SHORT};
use crate::error::{Error, Place, Problem, Result};
use crate::large_pages;
use crate::number;
use crate::rows::{Looks, Reader, Start, plain_rows};
use crate::sheet::{Delimiter, LINE_LIMIT, Sheet, line_at};
use crate::wide::Vectors;
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
    let reader = Reader::new(vectors, sheet, wanted);
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
    looks: Looks,
}

impl<'a, 's> Joined<'a, 's> {
    fn new(reader: &'a Reader<'a, 's>, length: u64) -> Self {
        let wanted = reader.wanted;
        let mut out = Body::new(wanted);
        reserve(&mut out, reader.sheet, length, wanted);
        Joined {
            reader,
            out,
            line_number: reader.sheet.data_line - 1,
            pending: None,
            looks: Looks::new(reader),
        }
    }

    fn unreadable(&self, error: &std::io::Error) -> Error {
        Error::of_file(self.reader.sheet.name, Problem::Unreadable { detail: error.to_string() })
    }

    fn alone(&mut self, mut blocks: Blocks<'_>) -> Result<()> {
        while let Some(block) = blocks.next().map_err(|e| self.unreadable(&e))? {
            self.looks.trust();
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
                    let mut looks = Looks::new(reader);
                    loop {
                        let job = receive.lock().map_or(None, |jobs| jobs.recv().ok());
                        let Some((block, answer)) = job else { return };
                        // Nobody waits where an earlier row was refused.
                        let _ = answer.send(reader.start(block, &mut looks));
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
        let Joined { reader, out, line_number, pending, looks } = self;
        let wanted = reader.wanted;
        let mut row = [0.0f64; SLOTS];
        loop {
            let rows = out.rows;
            at = plain_rows(reader.vectors, reader, text, at, out, looks);
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
    /// Without rows.
    pub fn new(wanted: &Wanted) -> Body {
        Body { whole_numbers: true, keep: vec![Vec::new(); wanted.keep.len()], ..Body::default() }
    }
}

/// Room for as many rows as the first lines' length suggests in `length` bytes.
pub(crate) fn reserve(out: &mut Body, sheet: &Sheet<'_>, length: u64, wanted: &Wanted) {
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

/// Appends a row.
#[inline(always)]
pub(crate) fn push(out: &mut Body, row: &[f64; SLOTS], wanted: &Wanted) {
    push_rows(out, row.each_ref().map(std::slice::from_ref), wanted);
}

/// Appends rows; there are as many numbers for every slot.
#[inline(always)]
pub(crate) fn push_rows(out: &mut Body, slots: [&[f64]; SLOTS], wanted: &Wanted) {
    out.rows += slots[TIME].len();
    let has = |slot: usize| wanted.slot[slot].is_some();
    if has(TIME) {
        out.time.extend_from_slice(slots[TIME]);
    }
    if has(COARSE) {
        out.coarse.extend_from_slice(slots[COARSE]);
    }
    if has(GRAVITY) {
        let gravity = triples(slots, GRAVITY);
        out.acc.extend(triples(slots, ACC).zip(gravity).map(|(acc, g)| [0, 1, 2].map(|i| acc[i] + g[i])));
    } else if has(ACC) {
        out.acc.extend(triples(slots, ACC));
    }
    if has(GYRO) {
        out.gyro.extend(triples(slots, GYRO));
    }
    if has(TEMP) {
        out.temp.extend_from_slice(slots[TEMP]);
    }
    if out.whole_numbers {
        out.whole_numbers = slots[ACC..GYRO + 3].iter().all(|slot| slot.iter().all(|v| *v == v.trunc()));
    }
}

/// Rows of three neighbouring slots.
#[inline(always)]
fn triples(slots: [&[f64]; SLOTS], first: usize) -> impl ExactSizeIterator<Item = Vec3> + '_ {
    let [x, y, z] = [0, 1, 2].map(|i| slots[first + i].iter());
    x.zip(y).zip(z).map(|((x, y), z)| [*x, *y, *z])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::options::Options;
    use crate::sheet;
    use proptest::prelude::*;

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

    /// Rows of one look, with others among them.
    fn table() -> impl Strategy<Value = String> {
        let number =
            (any::<i32>(), 0usize..7).prop_map(|(n, places)| format!("{:.places$}", f64::from(n) / 1e5));
        let odd = prop_oneof![Just(String::new()), Just("x".to_owned()), Just(" 1".to_owned()), number];
        let change = prop_oneof![
            40 => Just(None),
            1 => (0usize..8, odd).prop_map(Some),
        ];
        let end = prop_oneof![30 => Just("\n"), 1 => Just("\r\n"), 1 => Just(",7\n"), 1 => Just("\n\n")];
        let row = (any::<[i16; 7]>(), change, end).prop_map(|(values, change, end)| {
            let mut cells = values.map(|v| format!("{:.3}", f64::from(v) / 1e3)).to_vec();
            match change {
                Some((7, _)) => drop(cells.pop()),
                Some((place, cell)) => cells[place] = cell,
                None => {}
            }
            cells.join(",") + end
        });
        (proptest::collection::vec(row, 0..300), any::<bool>()).prop_map(|(rows, windows)| {
            let head = "time_s,acc_x,acc_y,acc_z,gyr_x,gyr_y,gyr_z\n0.0,1,2,3,4,5,6\n".to_owned();
            let text = head + &rows.concat();
            if windows { text.replace("\r\n", "\n").replace('\n', "\r\n") } else { text }
        })
    }

    proptest! {
        #[test]
        fn rows_together_are_the_rows_alone(text in table(), skip_bad: bool) {
            let sheet = sheet::sniff("a.csv", text.as_bytes(), &Options::default()).unwrap();
            let slot = std::array::from_fn(|slot| (slot < TEMP).then_some(slot));
            let wanted = Wanted { slot, skip_bad, ..Wanted::default() };
            let rest = || Blocks::of(sheet.text.get(sheet.data_offset..).unwrap());
            let reader = Reader::new(Vectors::widest(), &sheet, &wanted);
            let mut alone = Joined::new(&reader, 0);
            alone.looks.row_by_row();
            let alone = alone.alone(rest()).and_then(|()| alone.finish());
            let together = read_blocks(&sheet, &wanted, rest());
            prop_assert_eq!(format!("{together:?}"), format!("{alone:?}"));
        }
    }
}
