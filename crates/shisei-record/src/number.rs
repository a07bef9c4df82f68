//! Decimal text to f64, the same bits as `str::parse`, with a fast path.
//!
//! Fast path (Clinger 1990): a decimal of at most 19 digits whose mantissa is below 2^53 and whose power of
//! ten is within 10^±22 is one correctly rounded product or quotient of two exact doubles. Everything else
//! goes to `str::parse`.
//!
//! Columns whose numbers look alike are read faster still: see `shape`.

/// Powers of ten that a double holds exactly.
pub(crate) const TEN: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18,
    1e19, 1e20, 1e21, 1e22,
];

/// Powers of ten of up to eight digits.
const TEN_INTEGER: [u64; 9] = [1, 10, 100, 1_000, 10_000, 100_000, 1_000_000, 10_000_000, 100_000_000];

/// Value of eight digits (0 to 9 a byte) held little-endian in a word: the first digit in the lowest byte.
#[inline(always)]
pub(crate) fn eight_digits(v: u64) -> u64 {
    // Digits into twos, twos into fours, in every part of the word at once; so written they are steps of vectors.
    let twos = (v << 3).wrapping_add(v << 1).wrapping_add(v >> 8) & 0x00FF_00FF_00FF_00FF;
    let fours = (twos & 0x0000_00FF_0000_00FF) * 100 + (twos >> 16 & 0x0000_00FF_0000_00FF);
    (fours & 0xFFFF_FFFF) * 10_000 + (fours >> 32)
}

/// What eight digits more make of a number.
pub(crate) const EIGHT_DIGITS: u64 = TEN_INTEGER[8];

/// The digit 0 in every byte.
pub(crate) const ZEROS: u64 = 0x3030_3030_3030_3030;

/// Not zero where a byte is above 9.
#[inline(always)]
pub(crate) fn not_digits(values: u64) -> u64 {
    (values.wrapping_add(0x0606_0606_0606_0606) | values) & 0xF0F0_F0F0_F0F0_F0F0
}

#[inline]
fn word_at(bytes: &[u8], at: usize) -> Option<u64> {
    let chunk: [u8; 8] = bytes.get(at..at + 8)?.try_into().ok()?;
    Some(u64::from_le_bytes(chunk))
}

/// Reads digits from `at` into `mantissa`; returns the position after them. Up to eight at a time: the
/// digits before the first other byte are moved to the word's end, so that zeros lead.
#[inline]
fn digits(bytes: &[u8], mut at: usize, mantissa: &mut u64) -> usize {
    while let Some(word) = word_at(bytes, at) {
        let values = word ^ ZEROS;
        let count = (not_digits(values).trailing_zeros() / 8) as usize;
        if count == 0 {
            return at;
        }
        let value = eight_digits(values << (64 - 8 * count));
        *mantissa = mantissa.wrapping_mul(TEN_INTEGER[count]).wrapping_add(value);
        at += count;
        if count < 8 {
            return at;
        }
    }
    while let Some(digit) = bytes.get(at).map(|b| b.wrapping_sub(b'0')).filter(|d| *d < 10) {
        *mantissa = mantissa.wrapping_mul(10).wrapping_add(u64::from(digit));
        at += 1;
    }
    at
}

/// Reads a number that starts at `at`; gives it and the position after it, or nothing where there is no
/// plain finite number here.
#[inline]
pub(crate) fn scan(bytes: &[u8], at: usize, decimal: u8) -> Option<(f64, usize)> {
    scan_parts(bytes, at, decimal).map(|(value, end, _)| (value, end))
}

/// [`scan`], and how many digits follow the point.
pub(crate) fn scan_parts(bytes: &[u8], at: usize, decimal: u8) -> Option<(f64, usize, u8)> {
    let first = *bytes.get(at)?;
    let negative = first == b'-';
    let start = at + usize::from(negative || first == b'+');
    let mut mantissa = 0u64;
    let mut end = digits(bytes, start, &mut mantissa);
    let mut count = end - start;
    let mut exponent = 0i64;
    let mut after_point = 0;
    if bytes.get(end) == Some(&decimal) {
        let fraction = end + 1;
        end = digits(bytes, fraction, &mut mantissa);
        after_point = end - fraction;
        exponent = -(after_point as i64);
        count += after_point;
    }
    if count == 0 {
        return None;
    }
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let mut e = end + 1;
        let minus = bytes.get(e) == Some(&b'-');
        if minus || bytes.get(e) == Some(&b'+') {
            e += 1;
        }
        let mut value = 0u64;
        let stop = digits(bytes, e, &mut value);
        if stop == e || stop - e > 4 {
            return None;
        }
        exponent += if minus { -(value as i64) } else { value as i64 };
        end = stop;
    }
    let after_point = u8::try_from(after_point).unwrap_or(u8::MAX);
    let scale = TEN.get(exponent.unsigned_abs() as usize);
    let Some(scale) = scale.filter(|_| count <= 19 && mantissa <= 1 << 53) else {
        return Some((exact(bytes.get(at..end)?, decimal)?, end, after_point));
    };
    let magnitude = mantissa as i64 as f64;
    let value = if exponent >= 0 { magnitude * scale } else { magnitude / scale };
    Some((if negative { -value } else { value }, end, after_point))
}

/// A number of many digits, or far from 1.
fn exact(text: &[u8], decimal: u8) -> Option<f64> {
    let mut buffer = [0u8; 64];
    let text = if decimal == b'.' {
        text
    } else {
        let copy = buffer.get_mut(..text.len())?;
        for (to, from) in copy.iter_mut().zip(text) {
            *to = if *from == decimal { b'.' } else { *from };
        }
        &*copy
    };
    if text.len() > 64 {
        return None;
    }
    std::str::from_utf8(text).ok()?.parse().ok().filter(|value: &f64| value.is_finite())
}

/// What a cell holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Cell {
    /// A finite number.
    Number(f64),
    /// NaN or an infinity.
    NotFinite,
    /// Nothing but blanks.
    Blank,
    /// Other text.
    Text,
}

/// Blanks, quotes and a leading apostrophe taken off both ends; of blanks that do not break, those of UTF-8 and, where it
/// is not the end of a longer letter, that of Windows-1252.
pub(crate) fn trim(cell: &[u8]) -> &[u8] {
    let mut cell = cell;
    while let [b' ' | b'\t' | b'"' | b'\r' | b'\'' | 0xA0, rest @ ..] | [0xC2, 0xA0, rest @ ..] = cell {
        cell = rest;
    }
    loop {
        cell = match cell {
            [rest @ .., b' ' | b'\t' | b'"' | b'\r' | b'\''] | [rest @ .., 0xC2, 0xA0] => rest,
            [rest @ .., 0xA0] if rest.last().is_none_or(u8::is_ascii) => rest,
            _ => return cell,
        }
    }
}

/// Reads a whole cell.
pub(crate) fn cell(bytes: &[u8], decimal: u8) -> Cell {
    let text = trim(bytes);
    if text.is_empty() {
        return Cell::Blank;
    }
    if let Some((value, end)) = scan(text, 0, decimal)
        && end == text.len()
    {
        return Cell::Number(value);
    }
    slow(text, decimal)
}

#[cold]
fn slow(text: &[u8], decimal: u8) -> Cell {
    if text.len() > 400 {
        return Cell::Text;
    }
    let mut buffer = [0u8; 400];
    for (to, from) in buffer.iter_mut().zip(text) {
        *to = if *from == decimal { b'.' } else { *from };
    }
    let Some(Ok(text)) = buffer.get(..text.len()).map(std::str::from_utf8) else {
        return Cell::Text;
    };
    match text.replace('\u{2212}', "-").parse::<f64>() {
        Ok(value) if value.is_finite() => Cell::Number(value),
        Ok(_) => Cell::NotFinite,
        Err(_) if text.to_ascii_lowercase().contains("nan") && text.len() < 12 => Cell::NotFinite,
        Err(_) if ["null", "none", "na", "n/a", "-"].contains(&text.to_ascii_lowercase().as_str()) => {
            Cell::Blank
        }
        Err(_) => Cell::Text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn same(text: &str) {
        let expected: f64 = text.parse().unwrap();
        assert_eq!(cell(text.as_bytes(), b'.'), Cell::Number(expected), "{text}");
        let Cell::Number(got) = cell(text.as_bytes(), b'.') else { unreachable!() };
        assert_eq!(got.to_bits(), expected.to_bits(), "{text}");
    }

    #[test]
    fn same_bits_as_std() {
        for text in [
            "0",
            "-0",
            "+1",
            "1.",
            ".5",
            "-.5",
            "0.1",
            "1e22",
            "1e23",
            "-1.5E-3",
            "9007199254740993",
            "123456789.123456789",
            "0.000000000000000000000001",
            "4.9e-324",
            "1.7976931348623157e308",
            "12345678901234567890123.5",
            "4.270000000000000000e+02",
            "-6.522334815286109366e-01",
        ] {
            same(text);
        }
    }

    proptest! {
        #[test]
        fn any_double_reads_back(bits in any::<u64>()) {
            let value = f64::from_bits(bits);
            if value.is_finite() {
                same(&format!("{value:e}"));
                same(&format!("{value}"));
            }
        }

        #[test]
        fn any_decimal(text in "[-+]?[0-9]{1,12}\\.[0-9]{0,14}(e[-+]?[0-9]{1,2})?") {
            same(&text);
        }

        #[test]
        fn any_plain_decimal(text in "-?[0-9]{1,10}(\\.[0-9]{1,18})?") {
            same(&text);
        }
    }

    #[test]
    fn cells() {
        assert_eq!(cell(b" 1,5 ", b','), Cell::Number(1.5));
        assert_eq!(cell(b"\"2.5\"", b'.'), Cell::Number(2.5));
        assert_eq!(cell(b"  ", b'.'), Cell::Blank);
        assert_eq!(cell(b"NaN", b'.'), Cell::NotFinite);
        assert_eq!(cell(b"inf", b'.'), Cell::NotFinite);
        assert_eq!(cell(b"1.2.3", b'.'), Cell::Text);
        assert_eq!(cell(b"abc", b'.'), Cell::Text);
        assert_eq!(cell(b"-", b'.'), Cell::Blank);
    }
}
