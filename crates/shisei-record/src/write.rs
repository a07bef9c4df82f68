//! Writing our columns: CSV with the shortest decimals that read back to the same bits, or with a fixed
//! number of decimals.

mod decimal;

use decimal::{Scratch, WINDOW};
use std::collections::VecDeque;
use std::io::{self, Write};
use std::sync::{Mutex, mpsc};

/// How numbers are written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Decimals {
    /// The shortest decimal that reads back to the same f64.
    #[default]
    Shortest,
    /// This many digits after the point (at most 12), correctly rounded to the nearest, ties to even.
    Fixed(u8),
}

/// Appends a number; NaN and infinities as `NaN`, `inf`, `-inf`.
pub fn push_number(out: &mut Vec<u8>, value: f64, decimals: Decimals) {
    let mut page = Page { bytes: std::mem::take(out), length: 0 };
    page.length = page.bytes.len();
    page.number(value, decimals);
    *out = page.text();
}

/// Text that grows; its memory is used again.
#[derive(Default)]
struct Page {
    /// What is written, and room beyond.
    bytes: Vec<u8>,
    length: usize,
}

impl Page {
    fn number(&mut self, value: f64, decimals: Decimals) {
        let mut scratch = Scratch::new();
        match (scratch.number(value, decimals), decimals) {
            (Some(text), _) => self.append(|out| out.extend_from_slice(bare(text, decimals))),
            (None, Decimals::Fixed(places)) => self.append(|out| decimal::long_number(out, value, places)),
            (None, Decimals::Shortest) => {} // always fits
        }
    }

    /// Room for `N` texts of numbers and what parts them.
    #[inline(always)]
    fn room<const N: usize>(&mut self) -> Option<&mut [u8; N]> {
        if self.bytes.len() < self.length + N {
            self.bytes.resize(2 * self.bytes.len() + 2 * N, 0);
        }
        self.bytes.get_mut(self.length..self.length + N)?.try_into().ok()
    }

    #[inline]
    fn byte(&mut self, byte: u8) {
        match self.bytes.get_mut(self.length) {
            Some(place) => *place = byte,
            None => self.bytes.push(byte),
        }
        self.length += 1;
    }

    fn append(&mut self, write: impl FnOnce(&mut Vec<u8>)) {
        self.bytes.truncate(self.length);
        write(&mut self.bytes);
        self.length = self.bytes.len();
    }

    fn text(mut self) -> Vec<u8> {
        self.bytes.truncate(self.length);
        self.bytes
    }
}

/// Without `.0`.
#[inline(always)]
fn bare(text: &[u8], decimals: Decimals) -> &[u8] {
    match decimals {
        Decimals::Shortest => text.strip_suffix(b".0").unwrap_or(text),
        Decimals::Fixed(_) => text,
    }
}

/// One column of a table to write.
#[derive(Clone, Copy)]
pub enum Column<'a> {
    /// Numbers.
    Numbers(&'a [f64]),
    /// One component of vectors or quaternions, row-major with `stride`, starting at `offset`.
    Strided {
        /// All components.
        values: &'a [f64],
        /// Components a row.
        stride: usize,
        /// Which of them.
        offset: usize,
    },
    /// Numbers that are made as they are written.
    Computed {
        /// How many.
        rows: usize,
        /// The number of a row.
        value: &'a (dyn Fn(usize) -> f64 + Sync),
    },
    /// 1 and 0.
    Flags(&'a [bool]),
    /// Text, quoted where needed.
    Texts(&'a [Box<str>]),
}

impl std::fmt::Debug for Column<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let kind = match self {
            Column::Numbers(_) => "Numbers",
            Column::Strided { .. } => "Strided",
            Column::Computed { .. } => "Computed",
            Column::Flags(_) => "Flags",
            Column::Texts(_) => "Texts",
        };
        write!(f, "{kind} × {}", self.len())
    }
}

impl Column<'_> {
    pub(crate) fn len(&self) -> usize {
        match self {
            Column::Numbers(v) => v.len(),
            Column::Strided { values, stride, .. } => values.len() / (*stride).max(1),
            Column::Computed { rows, .. } => *rows,
            Column::Flags(v) => v.len(),
            Column::Texts(v) => v.len(),
        }
    }

    /// The text of a cell, if it is a number or a flag that has room.
    #[inline(always)]
    fn text<'b>(&self, scratch: &'b mut Scratch, row: usize, decimals: Decimals) -> Option<&'b [u8]> {
        let value = match self {
            Column::Numbers(v) => v.get(row).copied(),
            Column::Strided { values, stride, offset } => values.get(row * stride + offset).copied(),
            Column::Computed { rows, value } => (row < *rows).then(|| value(row)),
            Column::Flags(v) => return Some(if v.get(row) == Some(&true) { b"1" } else { b"0" }),
            Column::Texts(_) => return None,
        };
        scratch.number(value.unwrap_or(f64::NAN), decimals)
    }

    /// Any cell.
    fn push(&self, out: &mut Page, row: usize, decimals: Decimals) {
        match self {
            Column::Texts(v) => out.append(|out| push_text(out, v.get(row).map_or("", |t| t))),
            Column::Numbers(v) => out.number(v.get(row).copied().unwrap_or(f64::NAN), decimals),
            Column::Strided { values, stride, offset } => {
                out.number(values.get(row * stride + offset).copied().unwrap_or(f64::NAN), decimals);
            }
            Column::Computed { rows, value } => {
                out.number(if row < *rows { value(row) } else { f64::NAN }, decimals);
            }
            Column::Flags(v) => out.byte(if v.get(row) == Some(&true) { b'1' } else { b'0' }),
        }
    }
}

/// Appends a cell of text, quoted where it holds a separator, a quote or a line end.
pub fn push_text(out: &mut Vec<u8>, text: &str) {
    if text.contains([',', '"', '\n', '\r']) {
        out.push(b'"');
        out.extend_from_slice(text.replace('"', "\"\"").as_bytes());
        out.push(b'"');
    } else {
        out.extend_from_slice(text.as_bytes());
    }
}

/// Rows that are made into text together; the text stays in the processor's cache.
const ROWS: usize = 1024;
/// Cells whose texts are made before they are joined.
const CELLS: usize = 8;
/// Numbers below which a table is written by one thread.
const SMALL: usize = 1 << 18;

/// Writes a table as CSV: a header, then one row a sample. Long tables are made into text by as many threads as
/// there are processors, the same text whatever their number.
pub fn csv(
    sink: &mut dyn Write,
    names: &[&str],
    columns: &[Column<'_>],
    decimals: Decimals,
) -> io::Result<()> {
    let mut header = Vec::new();
    for (i, name) in names.iter().enumerate() {
        if i > 0 {
            header.push(b',');
        }
        push_text(&mut header, name);
    }
    header.push(b'\n');
    sink.write_all(&header)?;
    let rows = columns.iter().map(Column::len).max().unwrap_or(0);
    let table = Table { columns, decimals, rows };
    let threads = if rows * columns.len() < SMALL {
        1
    } else {
        std::thread::available_parallelism().map_or(1, std::num::NonZero::get)
    };
    if threads > 1 {
        return table.parallel(sink, threads);
    }
    let mut page = Page::default();
    for start in (0..rows).step_by(ROWS) {
        table.lines(&mut page, start);
        sink.write_all(page.bytes.get(..page.length).unwrap_or_default())?;
    }
    Ok(())
}

struct Table<'a> {
    columns: &'a [Column<'a>],
    decimals: Decimals,
    rows: usize,
}

impl Table<'_> {
    /// The text of the rows from `start` on, as many as are made together.
    fn lines(&self, page: &mut Page, start: usize) {
        page.length = 0;
        let mut scratch: [Scratch; CELLS] = std::array::from_fn(|_| Scratch::new());
        for row in start..self.rows.min(start + ROWS) {
            for columns in self.columns.chunks(CELLS) {
                if !self.cells(page, row, columns, &mut scratch) {
                    for column in columns {
                        column.push(page, row, self.decimals);
                        page.byte(b',');
                    }
                }
            }
            page.length = page.length.saturating_sub(1); // the last comma
            page.byte(b'\n');
        }
    }

    /// Appends up to [`CELLS`] cells and a comma after each; not where one of them is a long text.
    #[inline(always)]
    fn cells(
        &self,
        page: &mut Page,
        row: usize,
        columns: &[Column<'_>],
        scratch: &mut [Scratch; CELLS],
    ) -> bool {
        let mut texts: [&[u8]; CELLS] = [b""; CELLS];
        for ((text, scratch), column) in texts.iter_mut().zip(scratch).zip(columns) {
            match column.text(scratch, row, self.decimals) {
                Some(made) => *text = made,
                None => return false,
            }
        }
        let Some(room) = page.room::<{ CELLS * (WINDOW + 1) }>() else { return false };
        let mut at = 0;
        for text in texts.iter().take(columns.len()) {
            let Some(window) = room.get_mut(at..).and_then(|rest| rest.first_chunk_mut()) else {
                return false;
            };
            at += decimal::put(window, bare(text, self.decimals));
            if let Some(place) = room.get_mut(at) {
                *place = b',';
            }
            at += 1;
        }
        page.length += at;
        true
    }

    /// Threads make the text, this one writes it in order.
    fn parallel(&self, sink: &mut dyn Write, threads: usize) -> io::Result<()> {
        let (send, receive) = mpsc::channel::<(usize, Page, mpsc::Sender<Page>)>();
        let receive = Mutex::new(receive);
        std::thread::scope(|scope| {
            for _ in 0..threads {
                scope.spawn(|| {
                    loop {
                        let job = receive.lock().map_or(None, |jobs| jobs.recv().ok());
                        let Some((start, mut page, answer)) = job else { return };
                        self.lines(&mut page, start);
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
                sink.write_all(page.bytes.get(..page.length).unwrap_or_default())?;
                spare.push(page);
            }
        })
    }
}

/// Writes a recording's canonical columns (INTERFACES): `time_s, acc_x … gyr_z[, temp_c]`, then kept ones.
pub fn recording_csv(
    sink: &mut dyn Write,
    recording: &crate::Recording,
    decimals: Decimals,
) -> io::Result<()> {
    with_columns(recording, |names, columns| csv(sink, names, columns, decimals))
}

/// The canonical columns of a recording and their names.
pub(crate) fn with_columns<T>(
    recording: &crate::Recording,
    write: impl FnOnce(&[&str], &[Column<'_>]) -> T,
) -> T {
    let mut names = vec!["time_s", "acc_x", "acc_y", "acc_z", "gyr_x", "gyr_y", "gyr_z"];
    let mut columns = vec![Column::Numbers(&recording.time_s)];
    for values in [recording.acc_m_s2.as_flattened(), recording.gyro_rad_s.as_flattened()] {
        for offset in 0..3 {
            columns.push(Column::Strided { values, stride: 3, offset });
        }
    }
    if let Some(temp) = &recording.temp_c {
        names.push("temp_c");
        columns.push(Column::Numbers(temp));
    }
    for extra in &recording.extra {
        names.push(&extra.name);
        columns.push(Column::Texts(&extra.cells));
    }
    write(&names, &columns)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn text(value: f64, decimals: Decimals) -> String {
        let mut out = Vec::new();
        push_number(&mut out, value, decimals);
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn numbers() {
        assert_eq!(text(0.1, Decimals::Shortest), "0.1");
        assert_eq!(text(-2.0, Decimals::Shortest), "-2");
        assert_eq!(text(0.0, Decimals::Fixed(3)), "0.000");
        assert_eq!(text(-0.0004, Decimals::Fixed(3)), "0.000");
        assert_eq!(text(12.3456, Decimals::Fixed(2)), "12.35");
        assert_eq!(text(f64::NAN, Decimals::Fixed(2)), "NaN");
        assert_eq!(text(7.0, Decimals::Fixed(0)), "7");
        for (value, expected) in [
            (-0.0, "0"),
            (123456789.0, "123456789"),
            (9007199254740993.0, "9007199254740992"),
            (-1e15, "-1000000000000000"),
            (1e16, "1e+16"),
            (1e300, "1e+300"),
            (-9223372036854775808.0, "-9.223372036854776e+18"),
        ] {
            assert_eq!(text(value, Decimals::Shortest), expected);
        }
        assert_eq!(text(0.9999999, Decimals::Fixed(6)), "1.000000");
        assert_eq!(text(-123456.75, Decimals::Fixed(1)), "-123456.8");
        assert_eq!(text(1e300, Decimals::Fixed(12)), format!("{:.12}", 1e300));
        assert_eq!(text(f64::NEG_INFINITY, Decimals::Shortest), "-inf");
        let mut out = b"kept,".to_vec();
        push_number(&mut out, 2.5, Decimals::Shortest);
        assert_eq!(out, b"kept,2.5");
    }

    /// A table long enough for several threads, against the plain way of making it.
    #[test]
    fn a_long_table_as_std_writes_it() {
        let rows = SMALL / 3;
        let numbers: Vec<f64> = (0..rows).map(|k| k as f64 / 3.0 - 1000.0).collect();
        let flags: Vec<bool> = (0..rows).map(|k| k % 7 == 0).collect();
        let texts: Vec<Box<str>> = (0..rows).map(|k| format!("a \"{k}\"").into()).collect();
        let half = |k: usize| k as f64 * 0.5;
        let columns = [
            Column::Numbers(&numbers),
            Column::Computed { rows: rows - 1, value: &half },
            Column::Flags(&flags),
            Column::Texts(&texts),
        ];
        let mut out = Vec::new();
        csv(&mut out, &["a", "b,c", "d", "e"], &columns, Decimals::Fixed(3)).unwrap();
        let mut expected = "a,\"b,c\",d,e\n".to_owned();
        for k in 0..rows {
            let b = if k + 1 < rows { format!("{:.3}", half(k)) } else { "NaN".into() };
            expected += &format!("{:.3},{b},{},\"a \"\"{k}\"\"\"\n", numbers[k], u8::from(flags[k]));
        }
        assert!(out == expected.into_bytes());
    }

    proptest! {
        #[test]
        fn shortest_reads_back(bits in any::<u64>()) {
            let value = f64::from_bits(bits);
            if value.is_finite() {
                prop_assert_eq!(text(value, Decimals::Shortest).parse::<f64>().unwrap(), value);
            }
        }

        #[test]
        fn fixed_as_std(value in -1e7f64..1e7, places in 0u8..10) {
            let expected = format!("{value:.0$}", usize::from(places));
            let got = text(value, Decimals::Fixed(places));
            let zero = expected.bytes().all(|b| matches!(b, b'-' | b'0' | b'.'));
            prop_assert_eq!(got, if zero { expected.trim_start_matches('-').to_owned() } else { expected });
        }
    }
}
