//! The shortest decimal that reads back to the same f64, of those the nearest.
//!
//! For usual numbers by exact arithmetic in 128 bits, after Schubfach (R. Giulietti 2020) and its form in which one
//! product gives the shorter candidates and what is left of it the last digit (Żmij, V. Zverovich 2025). For others,
//! and for powers of two, whose neighbours are not equally far, by the crate `zmij`.

use super::digits::{TILE, ZEROS, eights};
use super::{Style, WINDOW, store};

/// A number's last bit is worth 2^-s: of the least number that is written here, 2^-16 (smaller ones have an exponent) …
const S_MOST: usize = 68;
/// … and of those below the greatest, 2^24.
const S_LEAST: usize = 29;

/// For the worth 2^-s of a last bit: the greatest k with 10^-k above it, and 10^k 2^(64-s), both exact.
const SCALES: [(u64, u32); S_MOST + 1] = {
    let mut scales = [(0, 0); S_MOST + 1];
    let mut s = 1;
    while s <= S_MOST {
        let mut power = 1u128;
        let mut k = 0;
        while power * 10 < 1 << s {
            power *= 10;
            k += 1;
        }
        // 10^k has k factors of two: nothing is lost.
        scales[s] = (if s > 64 { power >> (s - 64) } else { power << (64 - s) } as u64, k);
        s += 1;
    }
    scales
};

/// What is known of a number beside its first 16 digits.
#[derive(Clone, Copy, Default)]
struct Known {
    /// Decimals of the first 16 digits; 0 where the number goes another way.
    decimals: u8,
    /// A 17th digit.
    last: u8,
    /// Whether it is needed.
    long: bool,
}

/// Numbers in their shortest form, made ready.
pub(super) struct Shortest {
    known: [Known; TILE],
    high: [u64; TILE],
    low: [u64; TILE],
}

impl Default for Shortest {
    fn default() -> Self {
        Shortest { known: [Known::default(); TILE], high: [0; TILE], low: [0; TILE] }
    }
}

/// The 15 or 16 digits of the number as a whole one, and what else is known.
#[inline(always)]
fn decimal(value: f64) -> Option<(u64, Known)> {
    let bits = value.to_bits();
    let fraction = bits & ((1 << 52) - 1);
    let s = 1075u64.wrapping_sub(bits >> 52 & 0x7FF) as usize;
    if s < S_LEAST || fraction == 0 {
        return None;
    }
    let &(power, decimals) = SCALES.get(s)?;
    let mantissa = fraction | 1 << 52;
    let product = u128::from(mantissa) * u128::from(power);
    let (whole, rest) = ((product >> 64) as u64, product as u64);
    // Half of the last bit; the ends belong to even numbers. It is less than a half, so one whole number at most is
    // so near.
    let near = (power >> 1) + (1 - (mantissa & 1));
    let up = rest.overflowing_add(near).1;
    let down = near > rest;
    // One digit more, to the nearest: of two as near (it is a 5 after 2 or 7) to the even one.
    let half = (1 << 63) - u64::from(rest == 1 << 62);
    let last = (u128::from(rest) * 10 + u128::from(half)) >> 64;
    Some((whole + u64::from(up), Known { decimals: decimals as u8, last: last as u8, long: !(up | down) }))
}

impl Style for Shortest {
    fn prepare(&mut self, values: &[f64; TILE]) {
        let (mut high, mut low) = ([0u32; TILE], [0u32; TILE]);
        for (((value, known), high), low) in values.iter().zip(&mut self.known).zip(&mut high).zip(&mut low) {
            let (whole, found) = decimal(*value).unwrap_or_default();
            *known = found;
            *high = (whole / 100_000_000) as u32;
            *low = (whole % 100_000_000) as u32;
        }
        eights(&high, &mut self.high);
        eights(&low, &mut self.low);
    }

    #[inline(always)]
    fn put(&self, k: usize, value: f64, out: &mut [u8; WINDOW]) -> usize {
        let Known { decimals, last, long } = self.known[k];
        let decimals = usize::from(decimals);
        if decimals == 0 {
            return 0;
        }
        let (high, low) = (self.high[k], self.low[k]);
        // Zeros at the end are left out, unless a 17th digit follows.
        let digits = u128::from(low) << 64 | u128::from(high) | u128::from(long) << 127;
        let zeros = digits.leading_zeros() as usize / 8;
        let missing = usize::from(high.trailing_zeros() >= 8); // of 16 digits
        out[0] = b'-';
        let at = (value.to_bits() >> 63) as usize;
        let (high, low) = (high | ZEROS, low | ZEROS);
        if missing + decimals >= 16 {
            // Below 1. The place of a missing first digit is that of a 0 or of the point.
            let start = at + decimals - 14;
            store(out, at, ZEROS);
            store(out, start, high);
            store(out, start + 8, low);
            out[at + 1] = b'.';
            out[start + 16] = b'0' + last;
            return start + 16 - zeros + usize::from(long);
        }
        // The digits with one place more before them are right from the point on; the whole part, of eight digits
        // at most and mostly of one, is put over them.
        let whole = 16 - missing - decimals;
        let start = at + 1 - missing;
        store(out, start, high);
        store(out, start + 8, low);
        out[start + 16] = b'0' + last;
        let first = (u128::from(low) << 64 | u128::from(high)) >> (8 * missing);
        let first = first as u64;
        let mask = u64::MAX >> (8 * (8 - whole.min(8)));
        if whole < 8 {
            let point = u64::from(b'.') << (8 * whole);
            store(out, at, first & mask | point | (first & !mask) << 8);
        } else {
            store(out, at, first);
            out[at + 8] = b'.';
        }
        if zeros >= decimals { at + whole } else { start + 16 - zeros + usize::from(long) }
    }

    #[cold]
    fn odd(value: f64, out: &mut Vec<u8>) {
        odd(value, out);
    }
}

/// Any number, the long way; NaN and infinities are `NaN`, `inf`, `-inf`.
pub(super) fn odd(value: f64, out: &mut Vec<u8>) {
    if value == 0.0 {
        return out.push(b'0');
    }
    let mut buffer = zmij::Buffer::new();
    let text = buffer.format(value).as_bytes();
    out.extend_from_slice(text.strip_suffix(b".0").unwrap_or(text));
}
