//! The shortest decimal that reads back to the same f64, of those the nearest.
//!
//! For usual numbers by exact arithmetic in 128 bits, after Schubfach (R. Giulietti 2020) and its form in which one
//! product gives the shorter candidates and what is left of it the last digit (Żmij, V. Zverovich 2025). For others,
//! and for powers of two, whose neighbours are not equally far, by the crate `zmij`.

use super::digits::{TILE, ZEROS, eights};
use super::{Style, WINDOW, store};
#[cfg(target_arch = "x86_64")]
use crate::wide::{Vectors, Width};

/// A number's last bit is worth 2^-s: of the least number that is written here, 2^-16 (smaller ones have an exponent) …
const S_MOST: u64 = 68;
/// … and of those below the greatest, 2^24.
const S_LEAST: u64 = 29;

/// The decimals that the first 16 digits may have.
pub(super) const LEAST: u64 = decimals_of(S_LEAST);
pub(super) const MOST: u64 = decimals_of(S_MOST);

/// 5^k for those decimals; the others are there so that any four bits are a place.
pub(super) const FIVES: [u64; 16] = {
    let mut fives = [0; 16];
    let mut k = LEAST;
    while k <= MOST {
        fives[(k - LEAST) as usize] = 5u64.pow(k as u32);
        k += 1;
    }
    fives
};

/// The s of a number.
#[inline(always)]
pub(super) fn last_bit(value: f64) -> u64 {
    1075u64.wrapping_sub(value.to_bits() >> 52 & 0x7FF)
}

/// Whether a number goes another way. Powers of two have neighbours that are not equally far.
#[inline(always)]
pub(super) fn is_odd(value: f64) -> bool {
    (last_bit(value).wrapping_sub(S_LEAST) > S_MOST - S_LEAST) | (value.to_bits() << 12 == 0)
}

/// The greatest k with 10^-k above 2^-s.
#[inline(always)]
pub(super) const fn decimals_of(s: u64) -> u64 {
    s.wrapping_mul(1_233) >> 12 // log10 of 2, near enough for all s from 1 to 68
}

/// 10^k 2^(64-s), exact, of 5^k. 10^k has k factors of two: nothing is lost.
#[inline(always)]
pub(super) fn power(five: u64, k: u64, s: u64) -> u64 {
    five << (64u64.wrapping_add(k).wrapping_sub(s) % 64)
}

/// Numbers in their shortest form, made ready.
pub(super) struct Shortest {
    /// Decimals of the first 16 digits; 0 where the number goes another way.
    decimals: [u8; TILE],
    /// A 17th digit …
    last: [u64; TILE],
    /// … and whether it is needed: the highest bit of a word.
    long: [u64; TILE],
    /// The digits.
    high: [u64; TILE],
    low: [u64; TILE],
}

impl Default for Shortest {
    fn default() -> Self {
        Shortest { decimals: [0; TILE], last: [0; TILE], long: [0; TILE], high: [0; TILE], low: [0; TILE] }
    }
}

const LOW: u64 = u32::MAX as u64;

/// The product of the lower halves of two words; so written it is one step of a vector.
#[inline(always)]
fn halves(a: u64, b: u64) -> u64 {
    (a & LOW) * (b & LOW)
}

/// The first 15 or 16 digits of a number as a whole one, in two halves of eight; the 17th digit, and the highest bit
/// where it is needed.
#[inline(always)]
pub(super) fn decimal(bits: u64, power: u64) -> ([u32; 2], u64, u64) {
    let mantissa = bits & ((1 << 52) - 1) | 1 << 52;
    // The product of 53 and 64 bits.
    let (low, high) = (halves(mantissa, power), halves(mantissa >> 32, power >> 32));
    let (inner, outer) = (halves(mantissa, power >> 32), halves(mantissa >> 32, power));
    let middle = (low >> 32) + (inner & LOW) + outer;
    let rest = middle << 32 | low & LOW;
    let whole = high + (inner >> 32) + (middle >> 32);
    // Half of the last bit; the ends belong to even numbers. It is less than a half, so one whole number at most is
    // so near.
    let near = (power >> 1) + (1 - (mantissa & 1));
    let up = rest.wrapping_add(near) < rest;
    let down = near > rest;
    // One digit more, to the nearest: of two as near (it is a 5 after 2 or 7) to the even one.
    let half = (1 << 63) - u64::from(rest == 1 << 62);
    let tenfold_low = halves(rest, 10);
    let tenfold_high = halves(rest >> 32, 10) + (tenfold_low >> 32);
    let fraction = tenfold_high << 32 | tenfold_low & LOW;
    let last = (tenfold_high >> 32) + u64::from(fraction.wrapping_add(half) < fraction);
    let whole = whole + u64::from(up);
    // Below 2^53: the quotient by 10^8 from the upper bits is right or one too small.
    let quotient = halves(whole >> 22, 2_882_303_761) >> 36;
    let remainder = whole - halves(quotient, 100_000_000);
    let more = u64::from(remainder >= 100_000_000);
    let eights = [(quotient + more) as u32, (remainder - more * 100_000_000) as u32];
    (eights, last, u64::from(!(up | down)) << 63)
}

impl Style for Shortest {
    #[inline(always)]
    #[cfg(target_arch = "x86_64")]
    #[allow(unsafe_code)] // as in `wide`
    fn put_all(
        vectors: Vectors,
        values: &[f64; TILE],
        after: &[u8; TILE],
        out: &mut [u8; TILE * WINDOW],
    ) -> Option<usize> {
        // SAFETY: `Vectors` of this width are made only where the processor has these instructions.
        (vectors.width() == Width::Avx512Vbmi2)
            .then(|| unsafe { super::compress::shortest(values, after, out) })
            .flatten()
    }

    #[inline(always)]
    fn prepare(&mut self, values: &[f64; TILE]) {
        let mut powers = [0u64; TILE];
        for ((value, place), decimals) in values.iter().zip(&mut powers).zip(&mut self.decimals) {
            let s = last_bit(*value);
            let k = decimals_of(s);
            let five = FIVES[(k.wrapping_sub(LEAST) % 16) as usize];
            *place = power(five, k, s);
            *decimals = if is_odd(*value) { 0 } else { k as u8 };
        }
        let (mut high, mut low) = ([0u32; TILE], [0u32; TILE]);
        for k in 0..TILE {
            ([high[k], low[k]], self.last[k], self.long[k]) = decimal(values[k].to_bits(), powers[k]);
        }
        eights(&high, &mut self.high);
        eights(&low, &mut self.low);
    }

    #[inline(always)]
    fn put(&self, k: usize, value: f64, out: &mut [u8; WINDOW]) -> usize {
        let decimals = usize::from(self.decimals[k]);
        if decimals == 0 {
            return 0;
        }
        let (high, low, last, long) = (self.high[k], self.low[k], self.last[k], self.long[k]);
        // Zeros at the end are left out, unless a 17th digit follows.
        let digits = u128::from(low | long) << 64 | u128::from(high);
        let long = (long >> 63) as usize;
        let zeros = digits.leading_zeros() as usize / 8;
        let missing = usize::from(high.trailing_zeros() >= 8); // of 16 digits
        out[0] = b'-';
        let at = (value.to_bits() >> 63) as usize;
        let (high, low) = (high | ZEROS, low | ZEROS);
        if missing + decimals >= 16 {
            // Below 1. The place of a missing first digit is that of a 0 or of the point.
            let start = (at + decimals - 14) % 16; // at most 7
            store(out, at, ZEROS);
            store(out, start, high);
            store(out, start + 8, low);
            out[at + 1] = b'.';
            out[start + 16] = b'0' + last as u8;
            return start + 16 - zeros + long;
        }
        // The digits with one place more before them are right from the point on; the whole part, of eight digits
        // at most and mostly of one, is put over them.
        let whole = 16 - missing - decimals;
        let start = (at + 1 - missing) % 4;
        store(out, start, high);
        store(out, start + 8, low);
        out[start + 16] = b'0' + last as u8;
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
        if zeros >= decimals { at + whole } else { start + 16 - zeros + long }
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
