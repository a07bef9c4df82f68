//! From bytes to a [`Take`].

use super::error::{Error, Problem, Result};
use super::note;
use super::take::{Column, EXPORTED, Style, Take};
use crate::Input;
use crate::encoding::{self, Encoding};
use crate::number::{self, Cell};
use crate::open::unpack;
use crate::sheet::{Delimiter, line_at, split};

/// The heading ends within so many lines.
const HEADING_LINES: usize = 64;
/// A table must have one cell in so many, or it is refused: memory stays in proportion to the file.
const SPARSEST: usize = 16;

/// Keys of the first row, so that a take's name may hold commas.
const KEYS: &[&str] = &[
    "Format Version",
    "Take Name",
    "Take Notes",
    "Capture Frame Rate",
    "Export Frame Rate",
    "Capture Start Time",
    "Capture Start Frame",
    "Total Frames in Take",
    EXPORTED,
    "Rotation Type",
    "Length Units",
    "Coordinate Space",
];

/// True when the bytes begin like a Motive tracking CSV, or have a row that begins with `Frame` under a heading
/// of `Rigid Body`, `Bone` or `Marker` columns.
pub fn looks_like(bytes: &[u8]) -> bool {
    let (encoding, text) = encoding::detect(bytes.get(..bytes.len().min(1 << 16)).unwrap_or(bytes));
    let mut at = 0;
    for number in 0..HEADING_LINES {
        let Some((line, next)) = line_at(&text, at) else { return false };
        at = next;
        let line = encoding.decode(line);
        if number == 0 && line.trim_start().starts_with("Format Version,1.") {
            return true;
        }
        let kinds = ["Rigid Body", "Bone", "Marker"];
        if line.split(',').any(|cell| kinds.contains(&cell.trim().trim_matches('"'))) {
            return true;
        }
    }
    false
}

/// Reads a take; gzip is unpacked. Refused: no row `Frame`, no frames, text where a number is needed, frame
/// numbers that do not ascend, a table whose cells are nearly all missing. A last row that ends in its middle is left
/// out; [`Take::warnings`] says so, and what else is missing.
pub fn read(input: &Input<'_>) -> Result<Take> {
    let bytes =
        unpack(input).map_err(|error| Error::of_file(input.name, Problem::Bytes(Box::new(error.problem))))?;
    let (encoding, text) = encoding::detect(&bytes);
    let Some(heading) = Heading::find(&text, encoding) else {
        return Err(Error::of_file(input.name, Problem::NotMotive));
    };
    let mut take = heading.take(input.name);
    rows(&mut take, &heading, &text, encoding)?;
    note_missing(&mut take);
    if take.frame.is_empty() {
        return Err(Error::of_file(input.name, Problem::NoFrames));
    }
    Ok(take)
}

/// The rows above the numbers.
struct Heading {
    info: Vec<(String, String)>,
    /// Rows between the first and `Frame`, cells decoded.
    labels: Vec<Vec<String>>,
    /// The row that begins with `Frame`.
    axes: Vec<String>,
    /// Where the rows of numbers begin, and the line before them, from 1.
    data: usize,
    line: usize,
}

impl Heading {
    fn find(text: &[u8], encoding: Encoding) -> Option<Heading> {
        let (mut at, mut rows) = (0, Vec::new());
        for line in 1..=HEADING_LINES {
            let (bytes, next) = line_at(text, at)?;
            at = next;
            let cells = cells(bytes, encoding);
            if cells.first().is_some_and(|cell| cell.eq_ignore_ascii_case("frame")) {
                let info = rows.first().map(|row: &Vec<String>| pairs(row)).unwrap_or_default();
                let skipped = usize::from(!info.is_empty());
                let blank = |row: &Vec<String>| row.iter().all(String::is_empty);
                let labels = rows.into_iter().skip(skipped).filter(|row| !blank(row)).collect();
                return Some(Heading { info, labels, axes: cells, data: at, line });
            }
            rows.push(cells);
        }
        None
    }

    /// Columns that come before the data: `Frame`, the time, the time code.
    fn leading(&self) -> usize {
        let is_time = |cell: &&String| cell.to_lowercase().starts_with("time");
        1 + self.axes.iter().skip(1).take_while(is_time).count()
    }

    fn is_timecode(cell: &str) -> bool {
        cell.to_lowercase().replace(' ', "").starts_with("timecode")
    }

    /// Number of the column with the time, and of that with the time code.
    fn time_columns(&self) -> (Option<usize>, Option<usize>) {
        let leading = self.axes.iter().enumerate().take(self.leading()).skip(1);
        let (mut time, mut code) = (None, None);
        for (number, cell) in leading {
            let place = if Heading::is_timecode(cell) { &mut code } else { &mut time };
            *place = place.or(Some(number));
        }
        (time, code)
    }

    /// The heading rows by what they say: type, name, ID, parent, quantity.
    fn named(&self) -> ([Option<&Vec<String>>; 5], Option<usize>) {
        let leading = self.leading();
        let word_of = |row: &Vec<String>| {
            row.iter().take(leading).enumerate().find_map(|(cell, text)| {
                let words = ["type", "name", "id", "parent"];
                let kind = words.iter().position(|word| text.eq_ignore_ascii_case(word))?;
                Some((kind, cell))
            })
        };
        let mut rows: [Option<&Vec<String>>; 5] = [None; 5];
        let mut word_cell = None;
        for row in &self.labels {
            if let Some((kind, cell)) = word_of(row) {
                rows[kind] = rows[kind].or(Some(row));
                word_cell = Some(cell);
            } else {
                // the row right above `Frame`
                rows[4] = Some(row);
            }
        }
        if word_cell.is_none() {
            // 1.21 has no words: type, name, ID and the quantity, from the bottom
            let mut labels = self.labels.iter().rev();
            rows[4] = labels.next();
            let rest: Vec<&Vec<String>> = labels.rev().collect();
            for (place, row) in rows.iter_mut().zip(rest) {
                *place = Some(row);
            }
        }
        (rows, word_cell)
    }

    fn take(&self, file: &str) -> Take {
        let (rows, word_cell) = self.named();
        let leading = self.leading();
        let labels = self.labels.iter().map(Vec::len).max().unwrap_or(0);
        let width = labels.max(self.axes.len()).max(leading);
        let text = |row: Option<&Vec<String>>, number: usize| -> Box<str> {
            row.and_then(|row| row.get(number)).map_or("", String::as_str).into()
        };
        let columns = (leading..width).map(|number| Column {
            kind: text(rows[0], number),
            name: text(rows[1], number),
            id: text(rows[2], number),
            parent: text(rows[3], number),
            quantity: text(rows[4], number),
            axis: text(Some(&self.axes), number),
            cells: Vec::new(),
        });
        let (time, code) = self.time_columns();
        let heading = |number: Option<usize>| {
            number.and_then(|number| self.axes.get(number)).cloned().unwrap_or_default()
        };
        let mut take = Take {
            file: file.to_owned(),
            info: self.info.clone(),
            style: Style {
                word_cell,
                has_parents: rows[3].is_some(),
                time_heading: heading(time),
                timecode_heading: heading(code),
            },
            frame: Vec::new(),
            stamp_s: Vec::new(),
            timecode: Vec::new(),
            columns: columns.collect(),
            warnings: Vec::new(),
        };
        // commas at the end of every row make columns of nothing
        let is_nothing = |c: &Column| [&c.kind, &c.name, &c.quantity, &c.axis].iter().all(|t| t.is_empty());
        while take.columns.last().is_some_and(is_nothing) {
            take.columns.pop();
        }
        take
    }
}

/// The cells of a row, decoded, without quotes and blanks around them.
fn cells(line: &[u8], encoding: Encoding) -> Vec<String> {
    split(line, Delimiter::Byte(b',')).into_iter().map(|cell| text(cell, encoding)).collect()
}

fn text(cell: &[u8], encoding: Encoding) -> String {
    let decoded = encoding.decode(cell);
    let trimmed = decoded.trim();
    match trimmed.strip_prefix('"').and_then(|rest| rest.strip_suffix('"')) {
        Some(inner) => inner.replace("\"\"", "\"").trim().to_owned(),
        None => trimmed.to_owned(),
    }
}

/// Keys and values of the first row; empty where it is none.
fn pairs(row: &[String]) -> Vec<(String, String)> {
    let known = |cell: &String| KEYS.iter().any(|key| cell.eq_ignore_ascii_case(key));
    if !row.first().is_some_and(known) {
        return Vec::new();
    }
    let mut out: Vec<(String, String)> = Vec::new();
    let mut cells = row.iter().peekable();
    while let Some(key) = cells.next() {
        if key.is_empty() {
            continue;
        }
        let mut value = cells.next().cloned().unwrap_or_default();
        if key.to_ascii_lowercase().starts_with("take n") {
            // a name with commas that was not quoted
            while let Some(more) = cells.next_if(|cell| !known(cell)) {
                value.push(',');
                value.push_str(more);
            }
        }
        out.push((key.clone(), value));
    }
    out
}

/// Reads the rows of numbers.
fn rows(take: &mut Take, heading: &Heading, text: &[u8], encoding: Encoding) -> Result<()> {
    let (leading, (time, code)) = (heading.leading(), heading.time_columns());
    let (mut at, mut line, mut filled) = (heading.data, heading.line, 0_usize);
    let mut width = 0;
    while let Some((bytes, next)) = line_at(text, at) {
        at = next;
        line += 1;
        if bytes.iter().all(|byte| matches!(byte, b',' | b' ' | b'\t' | b'"')) {
            continue;
        }
        let place = |take: &Take, column: usize, problem: Problem| {
            let name = column.checked_sub(leading).and_then(|index| take.columns.get(index));
            let name = name.map_or_else(|| "Frame".to_owned(), |c| format!("{} {}", c.name, c.axis));
            Error::at(&take.file, Some(line), Some((column + 1, name)), problem)
        };
        let cells = split(bytes, Delimiter::Byte(b','));
        if next == text.len() && is_cut(text, cells.len(), width, take) {
            take.warnings.push(note::cut_row(line));
            break;
        }
        width = cells.len();
        let number_in = |take: &Take, column: usize| -> Result<f64> {
            let Some(cell) = cells.get(column) else { return Ok(f64::NAN) };
            match number::cell(cell, b'.') {
                Cell::Number(value) => Ok(value),
                Cell::Blank | Cell::NotFinite => Ok(f64::NAN),
                Cell::Text => {
                    let text = self::text(cell, encoding);
                    Err(place(take, column, Problem::NotANumber { text }))
                }
            }
        };
        let frame = number_in(take, 0)?;
        if frame.is_nan() || frame.abs() > 9e15 || frame.fract() != 0.0 {
            let text = cells.first().map(|cell| self::text(cell, encoding)).unwrap_or_default();
            return Err(place(take, 0, Problem::NotANumber { text }));
        }
        let frame = frame as i64;
        if let Some(&before) = take.frame.last().filter(|before| **before >= frame) {
            return Err(place(take, 0, Problem::FrameOrder { before, now: frame }));
        }
        if let Some(column) = time {
            let stamp = number_in(take, column)?;
            take.stamp_s.push(stamp);
        }
        if let Some(column) = code {
            let code = cells.get(column).map(|cell| self::text(cell, encoding)).unwrap_or_default();
            take.timecode.push(code.into());
        }
        let needed = take.columns.len();
        filled += cells.len();
        let rows = take.frame.len() + 1;
        if rows > 64 && filled.saturating_mul(SPARSEST) < rows.saturating_mul(needed) {
            let problem = Problem::Sparse { rows, columns: needed };
            return Err(Error::of_file(&take.file, problem));
        }
        for index in 0..needed {
            let value = number_in(take, leading + index)?;
            if let Some(column) = take.columns.get_mut(index) {
                column.cells.push(value);
            }
        }
        take.frame.push(frame);
    }
    Ok(())
}

/// Whether the last row ends in its middle: it is short of cells, or the file ends within it and rows are missing.
fn is_cut(text: &[u8], cells: usize, width: usize, take: &Take) -> bool {
    let rows = take.len() as u64 + 1;
    let missing = take.exported_frames().is_some_and(|told| rows < told);
    cells < width || (missing && text.last() != Some(&b'\n'))
}

/// Says what is missing: rows, frame numbers, times.
fn note_missing(take: &mut Take) {
    let rows = take.len();
    if let Some(told) = take.exported_frames().filter(|told| *told != rows as u64) {
        take.warnings.push(note::count(rows, told));
    }
    // a take may be exported at a part of its rate: the usual step counts
    let steps = take.frame.windows(2).map(|pair| (pair[0], pair[1].abs_diff(pair[0])));
    let usual = steps.clone().map(|(_, step)| step).min().unwrap_or(1).max(1);
    let missing = steps.filter(|(_, step)| *step > usual).map(|(after, step)| (after, step / usual - 1));
    let frames: u64 = missing.clone().map(|(_, count)| count).fold(0, u64::saturating_add);
    if let Some((after, _)) = missing.clone().find(|(_, count)| *count > 0) {
        take.warnings.push(note::missing(frames, after));
    }
    let (mut last, mut back) = (f64::NEG_INFINITY, Vec::new());
    for (row, stamp) in take.stamp_s.iter_mut().enumerate() {
        if *stamp < last {
            *stamp = f64::NAN;
            back.push(row);
        } else if stamp.is_finite() {
            last = *stamp;
        }
    }
    if let Some(frame) = back.first().and_then(|row| take.frame.get(*row)) {
        take.warnings.push(note::time_back(back.len(), *frame));
    }
}
