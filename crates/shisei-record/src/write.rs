//! Writing our columns: CSV with the shortest decimals that read back to the same bits, or with a fixed
//! number of decimals.

#[cfg(target_arch = "x86_64")]
mod compress;
mod decimal;
mod digits;
mod page;
mod shortest;
mod table;

use crate::wide::Vectors;
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
        Decimals::Shortest => shortest::odd(value, out),
        Decimals::Fixed(places) => decimal::push(value, places, out),
    }
}

/// Bytes that the text of a number made ready may touch; it takes less.
const WINDOW: usize = 40;

/// A way of writing numbers: some are made ready together, then put into place one by one.
trait Style: Default + Send {
    /// Writes numbers, each with the byte after it, and gives the length of the text; nothing where they are to be made
    /// ready first.
    #[inline(always)]
    fn put_all(
        _: Vectors,
        _values: &[f64; digits::TILE],
        _after: &[u8; digits::TILE],
        _out: &mut [u8; digits::TILE * WINDOW],
    ) -> Option<usize> {
        None
    }

    /// Makes numbers ready.
    fn prepare(&mut self, values: &[f64; digits::TILE]);

    /// Writes the k-th of them, which is `value`, and gives the length of its text; 0 where it goes the long way.
    fn put(&self, k: usize, value: f64, out: &mut [u8; WINDOW]) -> usize;

    /// The long way.
    fn odd(value: f64, out: &mut Vec<u8>);
}

/// Eight bytes of a text, the first in the lowest byte.
#[inline(always)]
fn store(out: &mut [u8; WINDOW], at: usize, text: u64) {
    out[at..at + 8].copy_from_slice(&text.to_le_bytes());
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
        /// Fills in the numbers of as many rows as there are places, from the given one on.
        fill: &'a (dyn Fn(usize, &mut [f64]) + Sync),
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

    /// The numbers of some rows from `start` on, NaN beyond the last; `None` for flags and texts.
    pub(crate) fn fill(&self, start: usize, out: &mut [f64]) -> Option<()> {
        let known = self.len().saturating_sub(start).min(out.len());
        let (known, beyond) = out.split_at_mut(known);
        beyond.fill(f64::NAN);
        match self {
            Column::Numbers(values) => known.copy_from_slice(values.get(start..start + known.len())?),
            Column::Strided { values, stride, offset } => {
                let values = values.get(start * stride + offset..)?.iter().step_by((*stride).max(1));
                for (to, value) in known.iter_mut().zip(values) {
                    *to = *value;
                }
            }
            Column::Computed { fill, .. } => fill(start, known),
            Column::Flags(_) | Column::Texts(_) => return None,
        }
        Some(())
    }
}

/// Appends a cell of text, quoted where it holds a separator, a quote or a line end.
pub fn push_text(out: &mut Vec<u8>, text: &str) {
    if text.contains([',', '"', '\n', '\r']) {
        push_quoted(out, text);
    } else {
        out.extend_from_slice(text.as_bytes());
    }
}

fn push_quoted(out: &mut Vec<u8>, text: &str) {
    out.push(b'"');
    out.extend_from_slice(text.replace('"', "\"\"").as_bytes());
    out.push(b'"');
}

/// Numbers that are made as the table is written.
pub struct Made<'a> {
    /// How many rows.
    pub rows: usize,
    /// How many numbers a row.
    pub columns: usize,
    /// Fills in the next rows, in ascending order, by the caller's thread: `columns` numbers at the beginning of each
    /// part of the given length, of which the last may be shorter.
    pub next: &'a mut dyn FnMut(&mut [f64], usize),
}

impl std::fmt::Debug for Made<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Made {} × {}", self.columns, self.rows)
    }
}

/// Writes a table as CSV: a header, then one row a sample. Long tables are made into text by as many threads as
/// there are processors, the same text whatever their number.
pub fn csv(
    sink: &mut dyn Write,
    names: &[&str],
    columns: &[Column<'_>],
    decimals: Decimals,
) -> io::Result<()> {
    with_kept(sink, (names, &[]), columns, decimals)
}

/// As [`csv`]; the last columns are kept from an input, and theirs are the second names.
fn with_kept(
    sink: &mut dyn Write,
    names: (&[&str], &[String]),
    columns: &[Column<'_>],
    decimals: Decimals,
) -> io::Result<()> {
    let mut made = Made { rows: 0, columns: 0, next: &mut |_, _| {} };
    csv_made(sink, names, (columns, &mut made, &[]), decimals)
}

/// What a receiver's recordings have beside the canonical columns.
const RECEIVERS: [&str; 5] = ["node", "boot", "seq", "frame", "from_gate"];

/// As [`csv`], with numbers that are made as they are written between columns before and after them. The second names
/// are those of the columns kept from an input; save the receiver's they are quoted, which tells our files from those made
/// by hand.
pub fn csv_made(
    sink: &mut dyn Write,
    (names, kept): (&[&str], &[String]),
    columns: (&[Column<'_>], &mut Made<'_>, &[Column<'_>]),
    decimals: Decimals,
) -> io::Result<()> {
    let mut header = Vec::new();
    for name in names {
        push_text(&mut header, name);
        header.push(b',');
    }
    let push_kept = if kept == RECEIVERS { push_text } else { push_quoted };
    for name in kept {
        push_kept(&mut header, name);
        header.push(b',');
    }
    header.pop();
    header.push(b'\n');
    table::write(Vectors::widest(), sink, &header, columns, decimals)
}

/// Names under which kept columns are written beside `ours`: their own, with `_kept` after it where it is taken.
pub fn kept_names(ours: &[&str], extra: &[crate::recording::Extra]) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for column in extra {
        let mut name = column.name.clone();
        let given = ours.iter().copied().chain(names.iter().map(String::as_str));
        let taken = given.clone().any(|other| other.eq_ignore_ascii_case(&name));
        let all = given.chain(extra.iter().map(|column| column.name.as_str()));
        while taken && all.clone().any(|other| other.eq_ignore_ascii_case(&name)) {
            name += "_kept";
        }
        names.push(name);
    }
    names
}

/// Writes a recording's canonical columns (INTERFACES): `time_s, acc_x … gyr_z[, temp_c]`, then kept ones.
pub fn recording_csv(
    sink: &mut dyn Write,
    recording: &crate::Recording,
    decimals: Decimals,
) -> io::Result<()> {
    with_columns(recording, |names, columns| with_kept(sink, names, columns, decimals))
}

/// Names of a recording's canonical columns.
pub fn recording_names(recording: &crate::Recording) -> &'static [&'static str] {
    let all = &["time_s", "acc_x", "acc_y", "acc_z", "gyr_x", "gyr_y", "gyr_z", "temp_c"];
    if recording.temp_c.is_some() { all } else { &all[..7] }
}

/// The canonical columns of a recording and the kept ones, and their names.
pub(crate) fn with_columns<T>(
    recording: &crate::Recording,
    write: impl FnOnce((&[&str], &[String]), &[Column<'_>]) -> T,
) -> T {
    let names = recording_names(recording);
    let kept = kept_names(names, &recording.extra);
    let mut columns = vec![Column::Numbers(&recording.time_s)];
    for values in [recording.acc_m_s2.as_flattened(), recording.gyro_rad_s.as_flattened()] {
        for offset in 0..3 {
            columns.push(Column::Strided { values, stride: 3, offset });
        }
    }
    if let Some(temp) = &recording.temp_c {
        columns.push(Column::Numbers(temp));
    }
    columns.extend(recording.extra.iter().map(|extra| Column::Texts(&extra.cells)));
    write((names, &kept), &columns)
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

    fn random() -> impl FnMut() -> u64 {
        let mut seed = 1u64;
        move || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            seed >> 11
        }
    }

    /// Every width writes the text that is made number by number.
    fn the_same_text(numbers: &[f64], decimals: Decimals) {
        let mut expected = String::new();
        for number in numbers {
            expected += &text(*number, decimals);
            expected.push('\n');
        }
        for vectors in Vectors::all() {
            let mut out = Vec::new();
            let mut made = Made { rows: 0, columns: 0, next: &mut |_, _| {} };
            let columns: (&[Column<'_>], _, &[Column<'_>]) = (&[Column::Numbers(numbers)], &mut made, &[]);
            table::write(vectors, &mut out, b"", columns, decimals).unwrap();
            assert!(out == expected.as_bytes(), "{vectors:?} {decimals:?}");
        }
    }

    /// Numbers of every size, sign and length, and some that go the long way, in as many rows as do not fill a tile.
    #[test]
    fn every_width_writes_the_same_text() {
        let mut random = random();
        let numbers: Vec<f64> = (0..5_003)
            .map(|k| match k % 7 {
                0 => f64::from_bits(random() << 11 | random() & 0x7FF),
                1 => (random() % 1_000_000) as f64 * -1e-6,
                2 => 1.0 / (1u64 << (k % 40)) as f64,
                _ => (random() as f64 / 9e15 - 0.5) * [1.0, 1e-3, 1e5, 7.0][k % 4],
            })
            .collect();
        for decimals in [Decimals::Shortest, Decimals::Fixed(3), Decimals::Fixed(6), Decimals::Fixed(9)] {
            the_same_text(&numbers, decimals);
        }
    }

    /// Numbers of all sizes that go together, with as many digits as there can be and with few.
    #[test]
    fn whole_tiles_of_usual_numbers() {
        let mut random = random();
        for tile in 0..2_000u64 {
            let numbers: Vec<f64> = (0..digits::TILE as u64)
                .map(|k| {
                    let exponent = 1007 + random() % 40;
                    let bits = (random() & ((1 << 52) - 1)) | 1 | exponent << 52 | random() << 63;
                    let number = f64::from_bits(bits);
                    let unit = 10u64.pow((tile % 12) as u32) as f64;
                    let few = (number * unit).trunc() / unit;
                    let usual = (1.0 / 65_536.0..16_777_216.0).contains(&few.abs());
                    if k % 3 == 0 && usual && few.to_bits() << 12 != 0 { few } else { number }
                })
                .collect();
            the_same_text(&numbers, Decimals::Shortest);
        }
    }

    /// Numbers made on the way stand where they belong, by one thread and by several.
    #[test]
    fn numbers_that_are_made_as_they_are_written() {
        for rows in [3, 1024, table::SMALL / 4 + 5] {
            let first: Vec<f64> = (0..rows).map(|k| k as f64).collect();
            let flags: Vec<bool> = (0..rows).map(|k| k % 3 == 0).collect();
            let mut row = 0;
            let mut next = |out: &mut [f64], length: usize| {
                for out in out.chunks_mut(length) {
                    out[..2].copy_from_slice(&[f64::from(row) + 0.5, -f64::from(row)]);
                    row += 1;
                }
            };
            let mut made = Made { rows, columns: 2, next: &mut next };
            let mut out = Vec::new();
            let columns: (&[Column<'_>], _, &[Column<'_>]) =
                (&[Column::Numbers(&first)], &mut made, &[Column::Flags(&flags)]);
            csv_made(&mut out, (&["a", "b", "c", "d"], &[]), columns, Decimals::Fixed(1)).unwrap();
            let mut expected = "a,b,c,d\n".to_owned();
            for k in 0..rows {
                let c = if k == 0 { "0.0".into() } else { format!("-{k}.0") };
                expected += &format!("{k}.0,{k}.5,{c},{}\n", u8::from(k % 3 == 0));
            }
            assert!(out == expected.into_bytes(), "{rows}");
        }
    }

    /// A table long enough for several threads, against the plain way of making it.
    #[test]
    fn a_long_table_as_std_writes_it() {
        let rows = table::SMALL / 3;
        let numbers: Vec<f64> = (0..rows).map(|k| k as f64 / 3.0 - 1000.0).collect();
        let flags: Vec<bool> = (0..rows).map(|k| k % 7 == 0).collect();
        let texts: Vec<Box<str>> = (0..rows).map(|k| format!("a \"{k}\"").into()).collect();
        let half = |k: usize| k as f64 * 0.5;
        let halves = |start: usize, out: &mut [f64]| {
            for (k, value) in out.iter_mut().enumerate() {
                *value = half(start + k);
            }
        };
        let columns = [
            Column::Numbers(&numbers),
            Column::Computed { rows: rows - 1, fill: &halves },
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

        /// Numbers made ready together: as short as std finds it can be, reading back to the same bits, and nothing
        /// nearer of that length.
        #[test]
        fn shortest_in_a_table(bits in proptest::collection::vec(any::<u64>(), 70), exponent in 1000u64..1060) {
            let numbers: Vec<f64> = bits
                .iter()
                .enumerate()
                .map(|(k, bits)| match k % 4 {
                    0 => (*bits % 100_000_000) as f64 / 8192.0,
                    1 => (*bits % 10_000_000) as f64 / 1000.0,
                    2 => (*bits % 1_000_000_000) as f64 * if bits >> 63 == 1 { -1e-6 } else { 1e-7 },
                    _ => f64::from_bits(bits & 0x800F_FFFF_FFFF_FFFF | (exponent + bits % 5) << 52),
                })
                .collect();
            let mut out = Vec::new();
            csv(&mut out, &["a"], &[Column::Numbers(&numbers)], Decimals::Shortest).unwrap();
            let out = String::from_utf8(out).unwrap();
            for (line, value) in out.lines().skip(1).zip(numbers) {
                prop_assert_eq!(line.parse::<f64>().unwrap(), value);
                // std's shortest digits are the nearest too; of two as near it takes the greater, we the even one.
                let std = format!("{value}");
                let exact = format!("{value:.70}");
                let exact = exact.trim_end_matches('0');
                let tie = exact.len() == line.len() + 1 && exact.ends_with('5') && exact.starts_with(line);
                let small = line.contains('e'); // std writes no exponents
                prop_assert!(small || line == std || tie && line.len() == std.len() && line.ends_with('2'), "{} {}", line, std);
            }
        }

        #[test]
        fn fixed_in_a_table(
            values in proptest::collection::vec((-1e9f64..1e9, 0usize..12), 70),
            places in 0u8..=12,
        ) {
            let numbers: Vec<f64> = values.iter().map(|(v, scale)| v / (1..=*scale).fold(1.0, |power, _| power * 10.0)).collect();
            let mut out = Vec::new();
            csv(&mut out, &["a"], &[Column::Numbers(&numbers)], Decimals::Fixed(places)).unwrap();
            let out = String::from_utf8(out).unwrap();
            for (line, value) in out.lines().skip(1).zip(numbers) {
                let expected = format!("{value:.0$}", usize::from(places));
                let zero = expected.bytes().all(|b| matches!(b, b'-' | b'0' | b'.'));
                prop_assert_eq!(line, if zero { expected.trim_start_matches('-') } else { &expected });
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
