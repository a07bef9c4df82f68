//! Numbers that look like the one above them in their column: with as many digits after the point, and mostly as long.
//!
//! With that guessed, where the next cell starts does not wait for this one to be understood, and the numbers of many
//! rows are understood together.

use crate::number::{self, EIGHT_DIGITS, TEN, ZEROS, eight_digits, not_digits};

/// Characters of a number that are looked at: its last ones.
const MOST: usize = 16;
/// Bytes of a window before the place it is taken for: as many as are looked at end with the shortest number.
const BEFORE: usize = MOST;
/// Bytes of a window: what is before, a minus, any length below twice the most (so that no place in it need be checked),
/// and the byte after.
const WINDOW: usize = BEFORE + 2 * MOST + 8;
/// Wrong guesses after which a column is not guessed any more.
const MISSES: u32 = 100;

/// What the numbers of a column look like.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Shape {
    /// Characters without the sign, at most [`MOST`]; 0 where that is not guessed.
    length: usize,
    /// The least and the greatest length of such numbers.
    lengths: (usize, usize),
    /// Digits after the point.
    places: usize,
    /// Ten to that power.
    scale: f64,
    /// The last eight characters, and the eight before them.
    low: Part,
    high: Part,
    /// Moves the last digit of the high part into the low one, from which the point was taken; all bits or none.
    carry: u64,
    misses: u32,
}

/// Eight characters.
#[derive(Clone, Copy, Debug, Default)]
struct Part {
    /// What makes digits of them and 0 of the point.
    zeros: u64,
    /// The point's place.
    point: u64,
    /// Places of digits after the point.
    after: u64,
    /// Places of digits before the point.
    before: u64,
}

impl Part {
    /// With the point before the last `after` characters; eight and more for none.
    fn new(after: usize, decimal: u8) -> Part {
        let last =
            |characters: usize| if characters == 0 { 0 } else { u64::MAX << (8 * (8 - characters.min(8))) };
        let point = last(after + 1) ^ last(after);
        let zeros = ZEROS & !point | (u64::from(decimal) * 0x0101_0101_0101_0101) & point;
        Part { zeros, point, after: last(after), before: !last(after + 1) }
    }

    /// The digits of the `used` characters, and not zero where one is not what is expected.
    #[inline(always)]
    fn values(&self, text: u64, used: u64) -> (u64, u64) {
        let values = (text ^ self.zeros) & used;
        (values, not_digits(values) | values & self.point)
    }

    /// The digits joined where the point was.
    #[inline(always)]
    fn joined(&self, values: u64) -> u64 {
        values & self.after | (values & self.before) << 8
    }
}

/// A number that is not understood yet.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Taken {
    /// The last eight characters, and the eight before them.
    pub low: u64,
    pub high: u64,
    /// Characters without the sign.
    pub length: u64,
    /// 1 with a minus, else 0.
    pub negative: u64,
}

impl Shape {
    /// Guesses that the next number has this many characters without its sign, and digits after the point.
    fn guess(&mut self, length: usize, places: usize, decimal: u8) {
        self.misses += 1;
        if self.misses > MISSES {
            self.length = 0;
            return;
        }
        // Without a point, of 16 digits not all are below 2^53.
        self.lengths = if places == 0 { (1, MOST - 1) } else { (places + 2, MOST) };
        let (least, most) = self.lengths;
        if length < least || length > most {
            self.length = 0;
            return;
        }
        self.length = length;
        self.places = places;
        self.scale = TEN[places];
        let in_low = places > 0 && places < 8;
        self.low = Part::new(if in_low { places } else { 8 }, decimal);
        self.high = match places {
            0 => Part::new(8, decimal),
            1..8 => Part { zeros: ZEROS, point: 0, after: 0, before: u64::MAX },
            _ => Part::new(places - 8, decimal),
        };
        self.carry = if in_low { u64::MAX } else { 0 };
    }

    /// Forgets how often a guess was wrong.
    pub fn trust(&mut self) {
        self.misses = 0;
    }

    /// Characters without the sign that are guessed.
    #[inline(always)]
    fn length(&self) -> usize {
        self.length % (2 * MOST)
    }

    /// The number at `at`, if the given byte follows where it is guessed to end, and that place. It may still be
    /// anything.
    #[inline(always)]
    pub fn take(&mut self, text: &[u8], at: usize, after: u8) -> Option<(Taken, usize)> {
        let window = window(text, at).filter(|_| self.length > 0)?;
        let negative = usize::from(window[BEFORE] == b'-');
        if window[BEFORE + negative + self.length()] != after && !self.measure(text, at, after) {
            return None;
        }
        let end = BEFORE + negative + self.length();
        Some((self.taken(window, end, negative as u64), at - BEFORE + end))
    }

    /// A number that ends at `end` in a window.
    #[inline(always)]
    fn taken(&self, window: &[u8; WINDOW], end: usize, negative: u64) -> Taken {
        let (low, high) = (word(window, end - 8), word(window, end - 16));
        Taken { low, high, length: self.length as u64, negative }
    }

    /// Measures the number at `at`, which is not as long as the one above. False where it cannot be guessed.
    #[inline(never)]
    fn measure(&mut self, text: &[u8], at: usize, after: u8) -> bool {
        let (least, most) = self.lengths;
        let start = at + usize::from(text.get(at) == Some(&b'-'));
        let rest = text.get(start..).unwrap_or_default();
        let found = (least..=most).find(|length| rest.get(*length) == Some(&after));
        let Some(length) = found.filter(|length| self.length > 0 && *length != self.length) else {
            return false;
        };
        self.length = length;
        true
    }

    /// What a number is, and not zero where it does not look as guessed.
    #[inline(always)]
    pub fn value(&self, taken: &Taken) -> (f64, u64) {
        let length = taken.length;
        let used_low = u64::MAX << ((8 * (8 - length.min(8))) & 63);
        let used_high = if length > 8 { u64::MAX << ((8 * (16 - length)) & 63) } else { 0 };
        let (low, low_wrong) = self.low.values(taken.low, used_low);
        let (high, high_wrong) = self.high.values(taken.high, used_high);
        let low = eight_digits(self.low.joined(low) | high >> 56 & self.carry);
        let mantissa = eight_digits(self.high.joined(high)) * EIGHT_DIGITS + low;
        let magnitude = mantissa as i64 as f64 / self.scale;
        // Without a branch: a column's signs are anybody's guess.
        (f64::from_bits(magnitude.to_bits() | taken.negative << 63), low_wrong | high_wrong)
    }
}

/// The bytes around the place `at`.
#[inline(always)]
fn window(text: &[u8], at: usize) -> Option<&[u8; WINDOW]> {
    text.get(at.checked_sub(BEFORE)?..)?.first_chunk()
}

#[inline(always)]
fn word(window: &[u8; WINDOW], at: usize) -> u64 {
    let mut bytes = [0u8; 8];
    bytes.copy_from_slice(&window[at..at + 8]);
    u64::from_le_bytes(bytes)
}

/// As [`number::scan`], after a blank too, guessing that the number looks as the one before in its column and is
/// followed by `after`; `shape` is set right where the guess was wrong.
#[inline(always)]
pub(crate) fn scan_like(
    bytes: &[u8],
    at: usize,
    decimal: u8,
    after: u8,
    shape: &mut Shape,
) -> Option<(f64, usize)> {
    if let Some((taken, end)) = shape.take(bytes, at, after) {
        let (value, wrong) = shape.value(&taken);
        if wrong == 0 {
            return Some((value, end));
        }
    }
    other_shape(bytes, at, decimal, shape)
}

#[inline(never)]
fn other_shape(bytes: &[u8], at: usize, decimal: u8, shape: &mut Shape) -> Option<(f64, usize)> {
    let at = at + usize::from(bytes.get(at) == Some(&b' '));
    let (value, end, places) = number::scan_parts(bytes, at, decimal)?;
    let sign = usize::from(matches!(bytes.get(at), Some(b'-' | b'+')));
    shape.guess(end - at - sign, usize::from(places), decimal);
    Some((value, end))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Every guess of a length and of digits after the point.
    fn guesses() -> impl Iterator<Item = Shape> {
        (0..=17).flat_map(|length| {
            (0..=17).map(move |places| {
                let mut shape = Shape::default();
                shape.guess(length, places, b'.');
                shape
            })
        })
    }

    /// A cell among others, read as the scalar way reads it.
    fn same(text: &str, mut shape: Shape) {
        let row = format!("77777777777777777,{text},-12.25,7.125,0.5,99999999999999999");
        let at = row.find(',').unwrap() + 1;
        let start = at + usize::from(text.starts_with(' '));
        let expected = number::scan(row.as_bytes(), start, b'.').map(|(value, end)| (value.to_bits(), end));
        let before = shape;
        // and once more, now that its shape is known
        for _ in 0..2 {
            let found = scan_like(row.as_bytes(), at, b'.', b',', &mut shape);
            assert_eq!(found.map(|(value, end)| (value.to_bits(), end)), expected, "{text}: {before:?}");
        }
    }

    #[test]
    fn numbers_of_all_lengths_under_every_guess() {
        for text in
            ["0", "-0", "1.", ".5", "-.5", "0.1", "-12.345678", "123456789.123456", "9007199254740993"]
        {
            guesses().for_each(|shape| same(text, shape));
        }
        for length in 1..=20 {
            for point in 0..=length {
                let digits = &"90817263544536271809"[..length];
                let (whole, part) = digits.split_at(point);
                guesses().for_each(|shape| same(&format!("-{whole}.{part}"), shape));
            }
        }
    }

    proptest! {
        #[test]
        fn any_plain_decimal(text in "-?[0-9]{1,10}(\\.[0-9]{1,16})?", length in 0usize..20, places in 0usize..20) {
            let mut shape = Shape::default();
            shape.guess(length, places, b'.');
            same(&text, shape);
        }

        /// What is no number to the scalar way is none here, or ends where the number does.
        #[test]
        fn anything(text in "[-+0-9.,eE ]{0,40}", length in 0usize..20, places in 0usize..20) {
            let mut shape = Shape::default();
            shape.guess(length, places, b'.');
            same(&text, shape);
        }
    }
}
