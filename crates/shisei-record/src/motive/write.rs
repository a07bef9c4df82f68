//! From a [`Take`] to the text that Motive writes.

use std::io::{self, Write};

use super::take::{Column, EXPORTED, Take};
use crate::write::{Decimals, push_number, push_text};

/// Written in blocks of about this size.
const BLOCK: usize = 1 << 16;
/// Digits of the time column, as Motive's.
const TIME_DIGITS: u8 = 6;

/// The key of a take's notes.
const NOTES: &str = "Take Notes";
/// What they say where we wrote the file, before the version.
const MAKER: &str = "written by shisei ";

/// True for the first bytes of a file that [`write()`] wrote.
pub fn is_ours(head: &[u8]) -> bool {
    let line = String::from_utf8_lossy(head.split(|&byte| byte == b'\n').next().unwrap_or_default());
    line.split_once(NOTES).is_some_and(|(_, rest)| rest.contains(MAKER))
}

/// The first row's keys and values; the notes say that it was us.
fn signed(take: &Take) -> Vec<(String, String)> {
    let mut info = take.info.clone();
    let sign = format!("{MAKER}{}", env!("CARGO_PKG_VERSION"));
    match info.iter_mut().find(|(key, _)| key.eq_ignore_ascii_case(NOTES)) {
        Some((_, notes)) if notes.contains(MAKER) => {}
        Some((_, notes)) if notes.trim().is_empty() => *notes = sign,
        Some((_, notes)) => *notes = format!("{notes}; {sign}"),
        None => info.push((NOTES.to_owned(), sign)),
    }
    info
}

/// Writes a take in its own layout: UTF-8, CRLF line ends; its notes say that it was us. With [`Decimals::Shortest`] it
/// reads back to the same bits, but for Total Exported Frames, which says how many rows are written. Time stamps get six digits after the point, or the shortest that read back where they have more.
pub fn write(sink: &mut dyn Write, take: &Take, decimals: Decimals) -> io::Result<()> {
    let mut out = Vec::with_capacity(BLOCK + 4096);
    let rows = take.len().to_string();
    for (number, (key, value)) in signed(take).iter().enumerate() {
        let value = if key.eq_ignore_ascii_case(EXPORTED) { &rows } else { value };
        if number > 0 {
            out.push(b',');
        }
        push_text(&mut out, key);
        out.push(b',');
        push_text(&mut out, value);
    }
    out.extend_from_slice(b"\r\n\r\n");
    heading(&mut out, take);
    for row in 0..take.len() {
        values(&mut out, take, row, decimals);
        if out.len() >= BLOCK {
            sink.write_all(&out)?;
            out.clear();
        }
    }
    sink.write_all(&out)
}

fn leading(take: &Take) -> usize {
    1 + usize::from(!take.style.time_heading.is_empty())
        + usize::from(!take.style.timecode_heading.is_empty())
}

/// A row above the numbers and what it says of a column.
type Label = (&'static str, fn(&Column) -> &str);

fn heading(out: &mut Vec<u8>, take: &Take) {
    let (style, leading) = (&take.style, leading(take));
    let mut labels: Vec<Label> = vec![("Type", |c| &c.kind), ("Name", |c| &c.name), ("ID", |c| &c.id)];
    if style.has_parents {
        labels.push(("Parent", |c| &c.parent));
    }
    labels.push(("", |c| &c.quantity));
    for (word, text) in labels {
        for cell in 0..leading {
            if cell > 0 {
                out.push(b',');
            }
            if style.word_cell == Some(cell) {
                push_text(out, word);
            }
        }
        for column in &take.columns {
            out.push(b',');
            push_text(out, text(column));
        }
        out.extend_from_slice(b"\r\n");
    }
    out.extend_from_slice(b"Frame");
    for cell in [&style.time_heading, &style.timecode_heading] {
        if !cell.is_empty() {
            out.push(b',');
            push_text(out, cell);
        }
    }
    for column in &take.columns {
        out.push(b',');
        push_text(out, &column.axis);
    }
    out.extend_from_slice(b"\r\n");
}

fn values(out: &mut Vec<u8>, take: &Take, row: usize, decimals: Decimals) {
    out.extend_from_slice(take.frame.get(row).copied().unwrap_or_default().to_string().as_bytes());
    if !take.style.time_heading.is_empty() {
        out.push(b',');
        stamp(out, take.stamp_s.get(row).copied().unwrap_or(f64::NAN));
    }
    if !take.style.timecode_heading.is_empty() {
        out.push(b',');
        push_text(out, take.timecode.get(row).map_or("", |code| code));
    }
    for column in &take.columns {
        out.push(b',');
        let value = column.cells.get(row).copied().unwrap_or(f64::NAN);
        if value == 0.0 && value.is_sign_negative() && decimals == Decimals::Shortest {
            // Motive writes -0.000000 for very small numbers
            out.extend_from_slice(b"-0");
        } else if value.is_finite() {
            push_number(out, value, decimals);
        }
    }
    out.extend_from_slice(b"\r\n");
}

fn stamp(out: &mut Vec<u8>, value: f64) {
    if !value.is_finite() {
        return;
    }
    let start = out.len();
    push_number(out, value, Decimals::Fixed(TIME_DIGITS));
    let back = out.get(start..).and_then(|text| std::str::from_utf8(text).ok()?.parse::<f64>().ok());
    if back != Some(value) {
        out.truncate(start);
        push_number(out, value, Decimals::Shortest);
    }
}
