//! Writing our columns: CSV with the shortest decimals that read back to the same bits, or with a fixed
//! number of decimals.

use std::io::{self, Write};

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
    match decimals {
        Decimals::Shortest => shortest(out, value),
        Decimals::Fixed(places) => fixed(out, value, places.min(12)),
    }
}

fn shortest(out: &mut Vec<u8>, value: f64) {
    if value == 0.0 {
        out.push(b'0');
        return;
    }
    if !value.is_finite() {
        out.extend_from_slice(special(value));
        return;
    }
    let mut buffer = zmij::Buffer::new();
    let text = buffer.format_finite(value);
    out.extend_from_slice(text.strip_suffix(".0").unwrap_or(text).as_bytes());
}

fn special(value: f64) -> &'static [u8] {
    if value.is_nan() {
        b"NaN"
    } else if value > 0.0 {
        b"inf"
    } else {
        b"-inf"
    }
}

/// Powers of ten, exact.
const TEN: [u64; 13] = [
    1,
    10,
    100,
    1_000,
    10_000,
    100_000,
    1_000_000,
    10_000_000,
    100_000_000,
    1_000_000_000,
    10_000_000_000,
    100_000_000_000,
    1_000_000_000_000,
];

fn fixed(out: &mut Vec<u8>, value: f64, places: u8) {
    let places = usize::from(places);
    let scale = TEN.get(places).copied().unwrap_or(1);
    let size = if value < 0.0 { -value } else { value };
    let scaled = size * scale as f64;
    // Exact product with room to spare: the rounding of the product cannot move it over a half.
    let whole = scaled.trunc();
    let rest = scaled - whole;
    let clear = !(0.4999..=0.5001).contains(&rest);
    if !(scaled < 4.5e12 && clear) {
        if value.is_finite() {
            // Rare: ties, large numbers.
            let _ = write!(out, "{value:.places$}");
        } else {
            out.extend_from_slice(special(value));
        }
        return;
    }
    let n = whole as u64 + u64::from(rest > 0.5);
    if value < 0.0 && n > 0 {
        out.push(b'-');
    }
    push_integer(out, n / scale, 1);
    if places > 0 {
        out.push(b'.');
        push_integer(out, n % scale, places);
    }
}

/// Two digits of every number below 100.
const PAIRS: [u8; 200] = {
    let mut table = [0u8; 200];
    let mut i = 0;
    while i < 100 {
        table[2 * i] = b'0' + (i / 10) as u8;
        table[2 * i + 1] = b'0' + (i % 10) as u8;
        i += 1;
    }
    table
};

/// Appends an integer with at least `width` digits.
fn push_integer(out: &mut Vec<u8>, mut n: u64, width: usize) {
    let mut buffer = [b'0'; 20];
    let mut at = 20;
    while n >= 100 {
        let pair = (n % 100) as usize * 2;
        n /= 100;
        at -= 2;
        buffer[at] = PAIRS[pair];
        buffer[at + 1] = PAIRS[pair + 1];
    }
    if n >= 10 {
        at -= 2;
        buffer[at] = PAIRS[n as usize * 2];
        buffer[at + 1] = PAIRS[n as usize * 2 + 1];
    } else {
        at -= 1;
        buffer[at] = b'0' + n as u8;
    }
    at = at.min(20usize.saturating_sub(width));
    out.extend_from_slice(&buffer[at..]);
}

/// One column of a table to write.
#[derive(Clone, Copy, Debug)]
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
    /// 1 and 0.
    Flags(&'a [bool]),
    /// Text, quoted where needed.
    Texts(&'a [Box<str>]),
}

impl Column<'_> {
    pub(crate) fn len(&self) -> usize {
        match self {
            Column::Numbers(v) => v.len(),
            Column::Strided { values, stride, .. } => values.len() / (*stride).max(1),
            Column::Flags(v) => v.len(),
            Column::Texts(v) => v.len(),
        }
    }

    #[inline]
    fn push(&self, out: &mut Vec<u8>, row: usize, decimals: Decimals) {
        match self {
            Column::Numbers(v) => push_number(out, v.get(row).copied().unwrap_or(f64::NAN), decimals),
            Column::Strided { values, stride, offset } => {
                push_number(out, values.get(row * stride + offset).copied().unwrap_or(f64::NAN), decimals);
            }
            Column::Flags(v) => out.push(if v.get(row) == Some(&true) { b'1' } else { b'0' }),
            Column::Texts(v) => push_text(out, v.get(row).map_or("", |t| t)),
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

/// Writes a table as CSV: a header, then one row a sample, in blocks of about 64 KiB.
pub fn csv(
    sink: &mut dyn Write,
    names: &[&str],
    columns: &[Column<'_>],
    decimals: Decimals,
) -> io::Result<()> {
    const BLOCK: usize = 1 << 16;
    let mut out = Vec::with_capacity(BLOCK + 4096);
    for (i, name) in names.iter().enumerate() {
        if i > 0 {
            out.push(b',');
        }
        push_text(&mut out, name);
    }
    out.push(b'\n');
    let rows = columns.iter().map(Column::len).max().unwrap_or(0);
    for row in 0..rows {
        for (i, column) in columns.iter().enumerate() {
            if i > 0 {
                out.push(b',');
            }
            column.push(&mut out, row, decimals);
        }
        out.push(b'\n');
        if out.len() >= BLOCK {
            sink.write_all(&out)?;
            out.clear();
        }
    }
    sink.write_all(&out)
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
