//! Decimal text to f64, the same bits as `str::parse`, with a fast path.
//!
//! Fast path (Clinger 1990): a decimal of at most 19 digits whose mantissa is below 2^53 and whose power of
//! ten is within 10^±22 is one correctly rounded product or quotient of two exact doubles. Everything else
//! goes to `str::parse`.
//!
//! Cells of a column mostly are as long as the cell above, or at least have as many digits after the point
//! ([`scan_like`]): with that guessed, where the next cell starts does not wait for this one to be understood.

/// Powers of ten that a double holds exactly.
const TEN: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18,
    1e19, 1e20, 1e21, 1e22,
];

/// Powers of ten of up to eight digits.
const TEN_INTEGER: [u64; 9] = [1, 10, 100, 1_000, 10_000, 100_000, 1_000_000, 10_000_000, 100_000_000];

/// Value of eight digits (0 to 9 a byte) held little-endian in a word: the first digit in the lowest byte.
#[inline]
fn eight_digits(mut v: u64) -> u64 {
    v = v.wrapping_mul(10).wrapping_add(v >> 8);
    let low = (v & 0x0000_00FF_0000_00FF).wrapping_mul(0x000F_4240_0000_0064);
    let high = ((v >> 16) & 0x0000_00FF_0000_00FF).wrapping_mul(0x0000_2710_0000_0001);
    low.wrapping_add(high) >> 32
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
        let values = word ^ 0x3030_3030_3030_3030;
        let others = (values.wrapping_add(0x0606_0606_0606_0606) | values) & 0xF0F0_F0F0_F0F0_F0F0;
        let count = (others.trailing_zeros() / 8) as usize;
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

/// Longest guess of the digits after the point.
const GUESS_LIMIT: u8 = 16;
/// Bytes that a guessed number may take, the byte after it included.
const WINDOW: usize = 32;
/// Wrong guesses of a length after which it is guessed no more.
const MISSES: u32 = 2_000;

/// What the numbers of a column look like.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Shape {
    /// Digits after the point.
    places: u8,
    /// Ten to that power.
    scale: f64,
    /// Characters without the sign, at most 16; 0 where that is not guessed.
    length: usize,
    /// How far the first eight characters are moved up, so that the last of them, or those before the last eight of a
    /// longer number, stand in the highest bytes.
    shift: u32,
    first: Part,
    /// The last eight of a number that has more.
    last: Part,
    /// Moves the last digit of the first part into the last one, from which the point was taken; all bits or none.
    carry: u64,
    misses: u32,
}

/// Eight characters, some of them not looked at.
#[derive(Clone, Copy, Debug, Default)]
struct Part {
    /// What is expected: 0 for digits, the point.
    expected: u64,
    /// The point's place.
    point: u64,
    /// Digits after the point.
    after: u64,
    /// Digits before the point.
    before: u64,
}

impl Part {
    /// With characters above `unused` low bytes, the point with `after` bytes above it; 8 for none.
    fn new(unused: usize, after: usize, decimal: u8) -> Part {
        let high = |bytes: usize| if bytes == 0 { 0 } else { u64::MAX << (8 * (8 - bytes.min(8))) };
        let point = if after < 8 { high(after + 1) ^ high(after) } else { 0 };
        let expected =
            (ZEROS & !point | (u64::from(decimal) * 0x0101_0101_0101_0101) & point) & high(8 - unused);
        Part { expected, point, after: high(after), before: !high(after) & !point }
    }

    /// Digit values, and not zero where a character is not what is expected.
    #[inline(always)]
    fn values(&self, text: u64) -> (u64, u64) {
        let values = text ^ self.expected;
        (values, not_digits(values) | values & self.point)
    }

    /// The digits joined where the point was.
    #[inline(always)]
    fn joined(&self, values: u64) -> u64 {
        values & self.after | (values & self.before) << 8
    }
}

impl Shape {
    /// Guesses that the next number has this many characters without its sign, and digits after the point.
    fn guess(&mut self, length: usize, places: u8, decimal: u8) {
        self.places = places.min(GUESS_LIMIT);
        self.misses += 1;
        let places = usize::from(places);
        // Without a point, of 16 digits not all are below 2^53.
        let longest = if places == 0 { 15 } else { 16 };
        self.length = 0;
        let shortest = if places == 0 { 1 } else { places + 2 };
        if !(shortest..=longest).contains(&length) || self.misses > MISSES {
            return;
        }
        self.length = length;
        self.scale = TEN[usize::from(self.places)];
        // Digits after the point in a part; none of the part's characters is the point where there are eight.
        let after = if places == 0 { 8 } else { places };
        if length <= 8 {
            self.shift = 8 * (8 - length) as u32;
            self.first = Part::new(8 - length, after, decimal);
        } else {
            self.shift = 8 * (16 - length) as u32;
            let in_last = places > 0 && places < 8;
            self.last = Part::new(0, if in_last { places } else { 8 }, decimal);
            // All digits of the first part are before a point in the last one.
            let after = if places == 0 { 8 } else { places.saturating_sub(8) };
            self.first = Part::new(16 - length, after, decimal);
            if in_last {
                self.first =
                    Part { expected: ZEROS & u64::MAX << self.shift, point: 0, after: 0, before: u64::MAX };
            }
            self.carry = if in_last { u64::MAX } else { 0 };
        }
    }

    /// Forgets how often the length was guessed wrong.
    pub(crate) fn trust(&mut self) {
        self.misses = 0;
    }

    /// The number at the window's start if it is as long as guessed and the given byte follows, and where that is.
    #[inline(always)]
    fn read(&self, window: &[u8; WINDOW], after: u8) -> Option<(f64, usize)> {
        let negative = window[0] == b'-';
        let start = usize::from(negative);
        let end = (start + self.length) % WINDOW; // at most 17
        let (values, mut wrong) = self.first.values(word(window, start) << self.shift);
        let mut mantissa = eight_digits(self.first.joined(values));
        if self.length > 8 {
            let (last, bad) = self.last.values(word(window, (end - 8) % 16));
            wrong |= bad;
            let last = self.last.joined(last) | values >> 56 & self.carry;
            mantissa = mantissa * TEN_INTEGER[8] + eight_digits(last);
        }
        if wrong | u64::from(window[end] ^ after) != 0 || self.length == 0 {
            return None;
        }
        let magnitude = mantissa as i64 as f64 / self.scale;
        // Without a branch: a column's signs are anybody's guess.
        let value = f64::from_bits(magnitude.to_bits() | u64::from(negative) << 63);
        Some((value, end))
    }
}

/// As [`scan`], after a blank too, guessing that the number looks as the one before in its column and is followed by
/// `after`; `shape` is set right where the guess was wrong.
#[inline(always)]
pub(crate) fn scan_like(
    bytes: &[u8],
    at: usize,
    decimal: u8,
    after: u8,
    shape: &mut Shape,
) -> Option<(f64, usize)> {
    if let Some(window) = bytes.get(at..).and_then(|rest| rest.first_chunk())
        && let Some((value, end)) = shape.read(window, after)
    {
        return Some((value, at + end));
    }
    other_length(bytes, at, decimal, shape)
}

#[inline(never)]
fn other_length(bytes: &[u8], at: usize, decimal: u8, shape: &mut Shape) -> Option<(f64, usize)> {
    let at = at + usize::from(bytes.get(at) == Some(&b' '));
    let (value, end, places) = match guessed(bytes, at, decimal, shape.places) {
        Some((value, end)) => (value, end, shape.places),
        None => scan_parts(bytes, at, decimal)?,
    };
    let sign = usize::from(matches!(bytes.get(at), Some(b'-' | b'+')));
    shape.guess(end - at - sign, places, decimal);
    Some((value, end))
}

/// The number at `at` if it is `[-]digits[.digits]` with `places` digits after the point and an exact mantissa.
#[inline(always)]
fn guessed(bytes: &[u8], at: usize, decimal: u8, places: u8) -> Option<(f64, usize)> {
    let window: &[u8; WINDOW] = bytes.get(at..at + WINDOW)?.try_into().ok()?;
    let negative = window[0] == b'-';
    let start = usize::from(negative);
    let mut whole = 0u64;
    let mut i = start;
    while i < 10 {
        let digit = window[i].wrapping_sub(b'0');
        if digit > 9 {
            break;
        }
        whole = whole * 10 + u64::from(digit);
        i += 1;
    }
    if i == start {
        return None;
    }
    let places = usize::from(places.min(GUESS_LIMIT));
    let mut mantissa = whole;
    if places > 0 {
        if window[i] != decimal || i - start + places > 19 {
            return None;
        }
        i += 1;
        let mut left = places;
        let mut wrong = 0u64;
        if left > 8 {
            let values = word(window, i) ^ ZEROS;
            wrong = not_digits(values);
            mantissa = mantissa * TEN_INTEGER[8] + eight_digits(values);
            i += 8;
            left -= 8;
        }
        let values = (word(window, i) ^ ZEROS) << (64 - 8 * left);
        if wrong | not_digits(values) != 0 {
            return None;
        }
        mantissa = mantissa * TEN_INTEGER[left] + eight_digits(values);
        i += left;
    }
    let next = window[i];
    if next.is_ascii_digit() || next | 0x20 == b'e' || next == decimal && places == 0 || mantissa > 1 << 53 {
        return None;
    }
    let magnitude = mantissa as i64 as f64 / TEN[places];
    // Without a branch: a column's signs are anybody's guess.
    let value = f64::from_bits(magnitude.to_bits() | u64::from(negative) << 63);
    Some((value, at + i))
}

const ZEROS: u64 = 0x3030_3030_3030_3030;

#[inline(always)]
fn word(window: &[u8; WINDOW], at: usize) -> u64 {
    // at most 11 + 8 of 32
    let mut bytes = [0u8; 8];
    bytes.copy_from_slice(&window[at..at + 8]);
    u64::from_le_bytes(bytes)
}

/// Not zero where a byte is above 9.
#[inline(always)]
fn not_digits(values: u64) -> u64 {
    (values.wrapping_add(0x0606_0606_0606_0606) | values) & 0xF0F0_F0F0_F0F0_F0F0
}

/// Reads a number that starts at `at`; gives it and the position after it, or nothing where there is no
/// plain finite number here.
#[inline]
pub(crate) fn scan(bytes: &[u8], at: usize, decimal: u8) -> Option<(f64, usize)> {
    scan_parts(bytes, at, decimal).map(|(value, end, _)| (value, end))
}

/// [`scan`], and how many digits follow the point.
fn scan_parts(bytes: &[u8], at: usize, decimal: u8) -> Option<(f64, usize, u8)> {
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

/// Blanks, quotes and a leading apostrophe taken off both ends.
pub(crate) fn trim(cell: &[u8]) -> &[u8] {
    let mut cell = cell;
    while let [b' ' | b'\t' | b'"' | b'\r' | b'\'' | 0xA0, rest @ ..] = cell {
        cell = rest;
    }
    while let [rest @ .., b' ' | b'\t' | b'"' | b'\r' | b'\'' | 0xA0] = cell {
        cell = rest;
    }
    cell
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

    /// Lengths and digits after the point.
    fn guesses() -> impl Iterator<Item = (usize, u8)> {
        (0..=17).flat_map(|length| (0..=17).map(move |places| (length, places)))
    }

    fn same(text: &str) {
        let expected: f64 = text.parse().unwrap();
        assert_eq!(cell(text.as_bytes(), b'.'), Cell::Number(expected), "{text}");
        let Cell::Number(got) = cell(text.as_bytes(), b'.') else { unreachable!() };
        assert_eq!(got.to_bits(), expected.to_bits(), "{text}");
        // among other cells, under every guess
        for (length, places) in guesses().filter(|_| text.len() <= 64) {
            let row = format!("{text},-12.25,7.125,0.5,99999999999999999");
            let mut shape = Shape::default();
            shape.guess(length, places, b'.');
            let (got, end) = scan_like(row.as_bytes(), 0, b'.', b',', &mut shape).unwrap();
            assert_eq!((got.to_bits(), end), (expected.to_bits(), text.len()), "{text}: {length} {places}");
            // and once more, now that its shape is known
            let (got, end) = scan_like(row.as_bytes(), 0, b'.', b',', &mut shape).unwrap();
            assert_eq!((got.to_bits(), end), (expected.to_bits(), text.len()), "{text}: {shape:?}");
        }
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

        /// What is no number to std is none to the guess, or ends where the number does.
        #[test]
        fn anything(text in "[-+0-9.,eE ]{0,40}", length in 0usize..20, places in 0u8..20) {
            let mut shape = Shape::default();
            shape.guess(length, places, b'.');
            let found = scan_like(text.as_bytes(), 0, b'.', b',', &mut shape);
            let start = usize::from(text.starts_with(' '));
            prop_assert_eq!(found, scan(text.as_bytes(), start, b'.'));
            if let Some((value, end)) = found {
                prop_assert_eq!(text[start..end].parse::<f64>().unwrap().to_bits(), value.to_bits());
            }
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
