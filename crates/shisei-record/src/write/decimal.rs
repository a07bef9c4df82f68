//! A fixed number of decimals, correctly rounded.

use super::digits::{TILE, ZEROS, eight, eights};
use super::{Style, WINDOW, store};
use std::io::Write;

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

/// Added to a smaller number it rounds it to a whole one, which stands in the sum's last bits.
const TWO_52: f64 = 4_503_599_627_370_496.0;

/// Below 2^39 the rounding of the product with a power of ten is less than 4e-5.
const LIMIT: f64 = 549_755_813_888.0;

/// In place of a number of units where the product's rounding could decide, or which is too large.
const ODD: u64 = u64::MAX;

/// Numbers with `PLACES` digits after the point, made ready: how many units of the last digit they are, and the
/// digits of that. With a constant number of decimals divisions become multiplications.
pub(super) struct Fixed<const PLACES: usize> {
    units: [u64; TILE],
    digits: [u64; TILE],
}

impl<const PLACES: usize> Default for Fixed<PLACES> {
    fn default() -> Self {
        Fixed { units: [0; TILE], digits: [0; TILE] }
    }
}

impl<const PLACES: usize> Fixed<PLACES> {
    /// How many units of the last digit a number is, rounded.
    #[inline(always)]
    fn units(value: f64) -> u64 {
        let scaled = value.abs() * TEN[PLACES] as f64;
        let rounded = scaled + TWO_52;
        let rest = scaled - (rounded - TWO_52);
        // So near to a half the exact product decides. False for NaN.
        let clear = (scaled < LIMIT) & (rest.abs() <= 0.4999);
        if clear { rounded.to_bits() & ((1 << 52) - 1) } else { ODD }
    }

    /// Writes a number of units, whose digits are known where it is below 10^8.
    #[inline(always)]
    fn text(units: u64, digits: u64, value: f64, out: &mut [u8; WINDOW]) -> usize {
        out[0] = b'-';
        // Without branches: a column's signs are anybody's guess.
        let mut at = (value.to_bits() >> 63) as usize & usize::from(units > 0);
        if PLACES < 8 {
            let whole = 8 - PLACES;
            let text;
            if units < 100_000_000 {
                // Zeros before the whole part's last digit are left out.
                let zeros = (digits | 1 << (8 * (whole - 1))).trailing_zeros() / 8;
                text = digits | ZEROS;
                store(out, at, text >> (8 * zeros));
                at += whole - zeros as usize;
            } else if units == ODD {
                return 0;
            } else {
                let digits = eight(units / 100_000_000);
                let zeros = digits.trailing_zeros() / 8;
                store(out, at, (digits | ZEROS) >> (8 * zeros));
                at += 8 - zeros as usize;
                text = eight(units % 100_000_000) | ZEROS;
                store(out, at, text);
                at += whole;
            }
            if PLACES > 0 {
                store(out, at, text >> (8 * (whole % 8)) << 8 | u64::from(b'.'));
                at += 1 + PLACES;
            }
            return at;
        }
        if units == ODD {
            return 0;
        }
        // below 5498 for eight decimals
        let (whole, fraction) = (units / TEN[PLACES], units % TEN[PLACES]);
        let last = TEN[PLACES.max(8) - 8];
        let digits = eight(whole);
        let zeros = (digits | 1 << 56).trailing_zeros() / 8;
        store(out, at, (digits | ZEROS) >> (8 * zeros));
        at += 8 - zeros as usize;
        out[at] = b'.';
        store(out, at + 1, eight(fraction / last) | ZEROS);
        store(out, at + 9, eight(fraction % last * TEN[16usize.saturating_sub(PLACES).min(8)]) | ZEROS);
        at + 1 + PLACES
    }
}

impl<const PLACES: usize> Style for Fixed<PLACES> {
    #[inline(always)]
    fn prepare(&mut self, values: &[f64; TILE]) {
        for (value, units) in values.iter().zip(&mut self.units) {
            *units = Self::units(*value);
        }
        if PLACES < 8 {
            let mut low = [0u32; TILE];
            for (units, low) in self.units.iter().zip(&mut low) {
                *low = *units as u32;
            }
            eights(&low, &mut self.digits);
        }
    }

    #[inline(always)]
    fn put(&self, k: usize, value: f64, out: &mut [u8; WINDOW]) -> usize {
        Self::text(self.units[k], self.digits[k], value, out)
    }

    #[cold]
    fn odd(value: f64, out: &mut Vec<u8>) {
        odd(value, PLACES, out);
    }
}

/// Any number, the long way; NaN and infinities are `NaN`, `inf`, `-inf`.
pub(super) fn odd(value: f64, places: usize, out: &mut Vec<u8>) {
    let start = out.len();
    // Writing to memory does not fail.
    let _ = write!(out, "{value:.places$}");
    // Nothing is written as -0.
    if let Some([b'-', digits @ ..]) = out.get(start..)
        && digits.iter().all(|b| matches!(b, b'0' | b'.'))
    {
        out.remove(start);
    }
}
/// Appends one number.
pub(super) fn push(value: f64, places: u8, out: &mut Vec<u8>) {
    let write = match places {
        0 => one::<0>,
        1 => one::<1>,
        2 => one::<2>,
        3 => one::<3>,
        4 => one::<4>,
        5 => one::<5>,
        6 => one::<6>,
        7 => one::<7>,
        8 => one::<8>,
        9 => one::<9>,
        10 => one::<10>,
        11 => one::<11>,
        _ => one::<12>,
    };
    write(value, out);
}

fn one<const PLACES: usize>(value: f64, out: &mut Vec<u8>) {
    let mut window = [0; WINDOW];
    let units = Fixed::<PLACES>::units(value);
    let digits = if units < 100_000_000 { eight(units) } else { 0 };
    let length = Fixed::<PLACES>::text(units, digits, value, &mut window);
    if length == 0 {
        return odd(value, PLACES, out);
    }
    out.extend_from_slice(window.get(..length).unwrap_or_default());
}
