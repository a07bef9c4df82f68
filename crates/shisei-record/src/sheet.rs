//! The shape of a text table: separator, decimal sign, preamble, header, units row, first row of numbers.

use crate::encoding::{self, Encoding};
use crate::error::{Error, Place, Problem, Result};
use crate::names::{self, Quantity};
use crate::number::{self, Cell};
use crate::options::Options;
use crate::stamp;
use crate::units::Unit;
use std::borrow::Cow;

/// A line longer than this is no sample.
pub(crate) const LINE_LIMIT: usize = 1 << 20;
/// Lines and bytes looked at to find the shape.
const LOOK_LINES: usize = 400;
const LOOK_BYTES: usize = 1 << 20;

/// What parts the cells of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Delimiter {
    /// One byte: comma, semicolon, tab, bar.
    Byte(u8),
    /// Any run of blanks.
    Blanks,
}

impl Delimiter {
    /// The separator's name.
    pub fn name(self) -> &'static str {
        match self {
            Delimiter::Byte(b',') => "comma",
            Delimiter::Byte(b';') => "semicolon",
            Delimiter::Byte(b'\t') => "tab",
            Delimiter::Byte(b'|') => "bar",
            Delimiter::Byte(_) => "other",
            Delimiter::Blanks => "space",
        }
    }

    /// Its name in Japanese.
    pub fn name_ja(self) -> &'static str {
        match self {
            Delimiter::Byte(b',') => "コンマ区切り",
            Delimiter::Byte(b';') => "セミコロン区切り",
            Delimiter::Byte(b'\t') => "タブ区切り",
            Delimiter::Byte(b'|') => "縦線区切り",
            Delimiter::Byte(_) => "その他の区切り",
            Delimiter::Blanks => "空白区切り",
        }
    }
}

/// A text table, understood down to its cells but not to their meaning.
#[derive(Debug)]
pub struct Sheet<'a> {
    /// File name as given.
    pub name: &'a str,
    /// How text is decoded.
    pub encoding: Encoding,
    /// Separator.
    pub delimiter: Delimiter,
    /// `.` or `,`.
    pub decimal: u8,
    /// Lines before the header, decoded.
    pub preamble: Vec<String>,
    /// Header cells; empty where the table has no header.
    pub header: Vec<String>,
    /// Cells of rows above the header that name the sensor, joined; as long as `header` or empty.
    pub groups: Vec<String>,
    /// Units row; as long as `header` or empty.
    pub units: Vec<String>,
    /// Decoded cells of the first rows of numbers.
    pub sample: Vec<Vec<String>>,
    /// The text.
    pub text: Cow<'a, [u8]>,
    /// Where the rows of numbers start, and on which line (from 1).
    pub data_offset: usize,
    /// Line of the first row of numbers, from 1.
    pub data_line: usize,
}

impl Sheet<'_> {
    /// Number of columns.
    pub fn columns(&self) -> usize {
        let widest = self.sample.iter().map(Vec::len).max().unwrap_or(0);
        self.header.len().max(widest)
    }

    /// Full names of the columns: group and header joined; `column N` where there is no header.
    pub fn column_names(&self) -> Vec<String> {
        (0..self.columns())
            .map(|i| {
                let head = self.header.get(i).map_or("", String::as_str);
                let group = self.groups.get(i).map_or("", String::as_str);
                match (group.is_empty(), head.is_empty()) {
                    (_, true) => format!("column {}", i + 1),
                    (true, false) => head.to_owned(),
                    (false, false) => format!("{group} {head}"),
                }
            })
            .collect()
    }

    /// True when a header cell equals `text`, case and blanks aside.
    pub fn has_column(&self, text: &str) -> bool {
        self.header.iter().any(|h| h.trim().eq_ignore_ascii_case(text))
    }
}

/// The next line from `at`: its bytes without the line end, and where the next one starts.
pub(crate) fn line_at(text: &[u8], at: usize) -> Option<(&[u8], usize)> {
    let rest = text.get(at..).filter(|r| !r.is_empty())?;
    // A lone \r, as old Macs wrote it, is made \n before.
    let (line, next) = match memchr::memchr(b'\n', rest) {
        Some(end) => (rest.get(..end)?, at + end + 1),
        None => (rest, text.len()),
    };
    Some((line.strip_suffix(b"\r").unwrap_or(line), next))
}

/// Splits a line into cells; quotes hide separators.
pub(crate) fn split(line: &[u8], delimiter: Delimiter) -> Vec<&[u8]> {
    let mut cells = Vec::new();
    let mut start = 0;
    let mut quoted = false;
    match delimiter {
        Delimiter::Byte(separator) => {
            for (i, byte) in line.iter().enumerate() {
                if *byte == b'"' {
                    quoted = !quoted;
                } else if *byte == separator && !quoted {
                    cells.push(line.get(start..i).unwrap_or_default());
                    start = i + 1;
                }
            }
            cells.push(line.get(start..).unwrap_or_default());
        }
        Delimiter::Blanks => {
            for piece in line.split(|b| matches!(b, b' ' | b'\t')) {
                if !piece.is_empty() {
                    cells.push(piece);
                }
            }
        }
    }
    cells
}

/// How much a line looks like a row of numbers.
struct Look {
    numbers: usize,
    texts: usize,
    cells: usize,
}

impl Look {
    fn is_row(&self) -> bool {
        self.numbers >= 2 && self.numbers >= self.texts
    }
}

fn look(line: &[u8], delimiter: Delimiter, decimal: u8) -> Look {
    let mut out = Look { numbers: 0, texts: 0, cells: 0 };
    let cells = split(line, delimiter);
    out.cells = cells.len();
    if cells.last().is_some_and(|c| number::trim(c).is_empty()) {
        out.cells -= 1;
    }
    for cell in cells {
        match number::cell(cell, decimal) {
            Cell::Number(_) | Cell::NotFinite => out.numbers += 1,
            Cell::Blank => {}
            Cell::Text if stamp::looks_like(number::trim(cell)) => out.numbers += 1,
            Cell::Text => out.texts += 1,
        }
    }
    out
}

/// Finds the shape of a text.
pub fn sniff<'a>(name: &'a str, bytes: &'a [u8], options: &Options) -> Result<Sheet<'a>> {
    let fail = |problem| Error::of_file(name, problem);
    let (encoding, text) = encoding::detect(bytes);
    let lines = head_lines(&text, name)?;
    if lines.iter().all(|(line, _)| number::trim(line).is_empty()) {
        return Err(fail(Problem::Empty));
    }
    if is_binary(&text) {
        return Err(fail(Problem::NotText));
    }
    let declared = lines.iter().take(3).find_map(|(line, _)| declared_separator(line));
    let (delimiter, decimal) = separators(&lines, declared, options);
    let first = first_row(&lines, delimiter, decimal);
    let Some(first) = first else {
        return Err(fail(without_rows(&lines, delimiter, encoding)));
    };
    let mut sheet = Sheet {
        name,
        encoding,
        delimiter,
        decimal,
        preamble: Vec::new(),
        header: Vec::new(),
        groups: Vec::new(),
        units: Vec::new(),
        sample: Vec::new(),
        data_offset: lines.get(first).map_or(0, |(_, at)| *at),
        data_line: first + 1,
        text: Cow::Borrowed(&[]),
    };
    if decimal == b','
        && let Some(text) = grouped(lines.get(first..).unwrap_or_default(), delimiter)
    {
        return Err(fail(Problem::Grouped { text }));
    }
    let above = headings(&lines, first, delimiter, decimal);
    name_columns(&mut sheet, &lines, above.clone());
    for (line, _) in lines.get(..above.start).unwrap_or_default() {
        sheet.preamble.push(encoding.decode(line).trim().to_owned());
    }
    for (line, _) in lines.iter().skip(first).filter(|(l, _)| !number::trim(l).is_empty()).take(64) {
        let cells = split(line, delimiter);
        sheet.sample.push(cells.iter().map(|c| encoding.decode(number::trim(c)).into_owned()).collect());
    }
    row_names(&mut sheet);
    sheet.text = text;
    Ok(sheet)
}

/// The first number whose comma stands between thousands, where every comma may do so and something tells that it does:
/// decimal points, or commas that part the cells.
fn grouped(rows: &[(&[u8], usize)], delimiter: Delimiter) -> Option<String> {
    let (mut first, mut points) = (None, false);
    for (row, _) in rows {
        for cell in split(row, delimiter).into_iter().map(number::trim) {
            if cell.contains(&b',') && matches!(number::cell(cell, b','), Cell::Number(_)) {
                let digits = cell.strip_prefix(b"-").unwrap_or(cell);
                let mut groups = digits.split(|b| *b == b',');
                let head = groups.next().unwrap_or_default();
                let thousands = (1..=3).contains(&head.len()) && head.first() != Some(&b'0');
                if !thousands || !groups.all(|group| group.len() == 3 && group.iter().all(u8::is_ascii_digit))
                {
                    return None;
                }
                first = first.or_else(|| Some(String::from_utf8_lossy(cell).into_owned()));
            }
            points |= cell.contains(&b'.') && matches!(number::cell(cell, b'.'), Cell::Number(_));
        }
    }
    first.filter(|_| points || delimiter == Delimiter::Byte(b','))
}

/// An empty name for row names that have none: rows have one cell more than the header, and the first counts them.
fn row_names(sheet: &mut Sheet<'_>) {
    let width = sheet.header.len() + 1;
    let counts = |start: usize| {
        let mut rows = sheet.sample.iter().enumerate();
        rows.all(|(k, row)| {
            row.len() == width
                && row.last().is_some_and(|cell| !cell.is_empty())
                && row.first().is_some_and(|cell| cell.parse() == Ok(start + k))
        })
    };
    let named =
        sheet.header.first().is_some_and(|name| names::meaning(name, "").quantity == Quantity::Counter);
    if sheet.sample.len() > 1 && !sheet.header.is_empty() && !named && (counts(0) || counts(1)) {
        for names in [&mut sheet.header, &mut sheet.groups, &mut sheet.units] {
            if !names.is_empty() {
                names.insert(0, String::new());
            }
        }
    }
}

/// The first lines and where they start.
fn head_lines<'t>(text: &'t [u8], name: &str) -> Result<Vec<(&'t [u8], usize)>> {
    let mut lines = Vec::new();
    let mut at = 0;
    while lines.len() < LOOK_LINES && at < LOOK_BYTES {
        // A file that is one endless line is found out after LINE_LIMIT bytes.
        let window = text.get(at..text.len().min(at + LINE_LIMIT + 1)).unwrap_or_default();
        if window.len() > LINE_LIMIT && memchr::memchr(b'\n', window).is_none() {
            let problem =
                if is_binary(text) { Problem::NotText } else { Problem::LineTooLong { limit: LINE_LIMIT } };
            let place = Place { file: name.to_owned(), line: Some(lines.len() + 1), column: None };
            return Err(Error::at(problem, place));
        }
        let Some((line, next)) = line_at(text, at) else { break };
        lines.push((line, at));
        at = next;
    }
    Ok(lines)
}

/// Control bytes in the first 4 KiB, more than one in a hundred, or any NUL.
fn is_binary(text: &[u8]) -> bool {
    let head = text.get(..text.len().min(4096)).unwrap_or(text);
    let control = head.iter().filter(|b| **b < 9 || (14..32).contains(*b) || **b == 127).count();
    head.contains(&0) || control * 100 > head.len()
}

/// `sep=;`
fn declared_separator(line: &[u8]) -> Option<Delimiter> {
    let line = number::trim(line);
    let rest = line.get(..4).filter(|h| h.eq_ignore_ascii_case(b"sep=")).and(line.get(4..))?;
    match rest {
        b"\\t" | b"" => Some(Delimiter::Byte(b'\t')),
        [b, ..] => Some(Delimiter::Byte(*b)),
    }
}

/// The separator and decimal sign under which the lines look most like rows of numbers.
fn separators(lines: &[(&[u8], usize)], declared: Option<Delimiter>, options: &Options) -> (Delimiter, u8) {
    let candidates: Vec<Delimiter> = match options.delimiter.or(declared) {
        Some(given) => vec![given],
        None => vec![
            Delimiter::Byte(b','),
            Delimiter::Byte(b';'),
            Delimiter::Byte(b'\t'),
            Delimiter::Byte(b'|'),
            Delimiter::Blanks,
        ],
    };
    let mut best = (Delimiter::Byte(b','), b'.');
    let mut best_score = 0.0;
    let step = (lines.len() / 60).max(1);
    for delimiter in candidates {
        for decimal in [b'.', b','] {
            if delimiter == Delimiter::Byte(b',') && decimal == b',' && !any_quoted_comma(lines) {
                continue;
            }
            let mut score = 0.0;
            for (line, _) in lines.iter().rev().step_by(step) {
                let seen = look(line, delimiter, decimal);
                if seen.is_row() {
                    let fraction = seen.numbers as f64 / (seen.numbers + seen.texts) as f64;
                    score += seen.numbers as f64 * fraction * fraction;
                }
            }
            if score > best_score * 1.0001 {
                best_score = score;
                best = (delimiter, decimal);
            }
        }
    }
    if best_score == 0.0
        && let Some(given) = options.delimiter.or(declared)
    {
        best.0 = given;
    }
    best
}

/// A cell such as "1,25" in quotes.
fn any_quoted_comma(lines: &[(&[u8], usize)]) -> bool {
    lines.iter().rev().take(3).any(|(line, _)| {
        split(line, Delimiter::Byte(b',')).iter().any(|c| {
            c.starts_with(b"\"") && c.contains(&b',') && matches!(number::cell(c, b','), Cell::Number(_))
        })
    })
}

/// The first line from which on (three lines, or to the end) every line is a row of numbers.
fn first_row(lines: &[(&[u8], usize)], delimiter: Delimiter, decimal: u8) -> Option<usize> {
    let looks: Vec<Option<Look>> = lines
        .iter()
        .map(
            |(line, _)| {
                if number::trim(line).is_empty() { None } else { Some(look(line, delimiter, decimal)) }
            },
        )
        .collect();
    (0..looks.len()).find(|first| {
        let Some(Some(here)) = looks.get(*first) else { return false };
        if !here.is_row() {
            return false;
        }
        let mut following = looks.iter().skip(first + 1).flatten().take(3);
        following.all(|l| l.is_row() && l.cells.abs_diff(here.cells) <= 1 || l.cells * 2 < here.cells)
            || (here.numbers >= 4 && looks.iter().skip(first + 1).flatten().take(3).any(Look::is_row))
    })
}

/// Why there are no rows of numbers: header only, or no table.
fn without_rows(lines: &[(&[u8], usize)], delimiter: Delimiter, encoding: Encoding) -> Problem {
    for candidate in
        [delimiter, Delimiter::Byte(b','), Delimiter::Byte(b';'), Delimiter::Byte(b'\t'), Delimiter::Blanks]
    {
        for (line, _) in lines {
            let cells = split(line, candidate);
            let known = cells.iter().filter(|c| known_name(&encoding.decode(number::trim(c)), "")).count();
            if known >= 3 {
                return Problem::HeaderOnly;
            }
        }
    }
    Problem::NoTable
}

/// A name that says something about motion.
fn known_name(name: &str, unit: &str) -> bool {
    !matches!(names::meaning(name, unit).quantity, Quantity::Other | Quantity::Counter)
}

/// The lines right above the first row that have its width: header, units, groups.
fn headings(
    lines: &[(&[u8], usize)],
    first: usize,
    delimiter: Delimiter,
    decimal: u8,
) -> std::ops::Range<usize> {
    let width = cells_of(lines, first, delimiter, decimal);
    let mut start = first;
    while start > 0 && first - start < 5 {
        let Some((line, _)) = lines.get(start - 1) else { break };
        let seen = look(line, delimiter, decimal);
        if is_aside(line, seen.cells, width) {
            // One line without names is passed between header and rows.
            if start == first {
                start -= 1;
                continue;
            }
            break;
        }
        let wide = seen.cells + 2 >= width && seen.cells >= 2 || seen.cells * 4 >= width * 3;
        if !wide || seen.is_row() && seen.texts == 0 || declared_separator(line).is_some() {
            break;
        }
        start -= 1;
    }
    start..first
}

/// Cells of a line.
fn cells_of(lines: &[(&[u8], usize)], line: usize, delimiter: Delimiter, decimal: u8) -> usize {
    lines.get(line).map_or(0, |(line, _)| look(line, delimiter, decimal).cells)
}

/// A blank line, or a remark that does not have the table's width.
fn is_aside(line: &[u8], cells: usize, width: usize) -> bool {
    let line = number::trim(line);
    line.is_empty() || cells * 2 < width && matches!(line, [b'#' | b'%', ..] | [b'/', b'/', ..])
}

/// Tells header, units row and group rows apart.
fn name_columns(sheet: &mut Sheet<'_>, lines: &[(&[u8], usize)], range: std::ops::Range<usize>) {
    let encoding = sheet.encoding;
    let width = cells_of(lines, range.end, sheet.delimiter, sheet.decimal);
    let mut rows: Vec<Vec<String>> = lines
        .get(range)
        .unwrap_or_default()
        .iter()
        .map(|(line, _)| (line, split(line, sheet.delimiter)))
        .filter(|(line, cells)| !is_aside(line, cells.len(), width))
        .map(|(_, cells)| cells.iter().map(|c| encoding.decode(number::trim(c)).trim().to_owned()).collect())
        .collect();
    for row in &mut rows {
        if let Some(cell) = row.first_mut() {
            let bare = cell.trim_start_matches(['#', '%', '/', ' ']).to_owned();
            // A lone comment sign before a blank-separated header is no column of its own.
            if bare.is_empty() && !cell.is_empty() {
                row.remove(0);
            } else {
                *cell = bare;
            }
        }
    }
    let filled = |row: &Vec<String>| row.iter().filter(|c| !c.is_empty()).count().max(1);
    let units = |row: &Vec<String>| row.iter().filter(|c| Unit::parse(c).is_some()).count();
    let grades = |row: &Vec<String>| {
        row.iter().filter(|c| ["cal", "raw", "uncal"].contains(&c.to_lowercase().as_str())).count()
    };
    let is_units = |row: &Vec<String>| {
        units(row) * 2 > filled(row)
            && row
                .iter()
                .filter(|c| matches!(Unit::parse(c), Some(Unit::Acceleration(..) | Unit::AngularRate(..))))
                .count()
                > 0
            && !row.iter().any(|c| c.len() > 1 && known_name(c, "") && Unit::parse(c).is_none())
    };
    let mut grade_row = Vec::new();
    let mut named: Vec<Vec<String>> = Vec::new();
    for row in rows {
        if sheet.units.is_empty() && !named.is_empty() && is_units(&row) {
            sheet.units = row;
        } else if grades(&row) * 2 > filled(&row) {
            grade_row = row;
        } else {
            named.push(row);
        }
    }
    // The header is the row with the most known names; rows above it name the sensor.
    let score = |row: &Vec<String>| row.iter().filter(|c| known_name(c, "")).count();
    let Some(best) = (0..named.len()).max_by_key(|i| (named.get(*i).map_or(0, score), *i)) else { return };
    let mut header = named.get(best).cloned().unwrap_or_default();
    for (i, cell) in header.iter_mut().enumerate() {
        if let Some(grade) = grade_row.get(i).filter(|g| !g.is_empty()) {
            cell.push(' ');
            cell.push_str(grade);
        }
    }
    let mut groups = vec![String::new(); header.len()];
    for row in named.get(..best).unwrap_or_default() {
        let mut last = "";
        for (i, group) in groups.iter_mut().enumerate() {
            let cell = row.get(i).map_or("", String::as_str);
            last = if cell.is_empty() { last } else { cell };
            if !last.is_empty() {
                if !group.is_empty() {
                    group.push(' ');
                }
                group.push_str(last);
            }
        }
    }
    if groups.iter().any(|g| !g.is_empty()) {
        sheet.groups = groups;
    }
    while header.last().is_some_and(String::is_empty) {
        header.pop();
    }
    sheet.header = header;
}
