//! Numbers to decimal text. Each is made in a scratch of its own, so that its copying need not wait for it.

use super::Decimals;
use std::io::Write;

/// Room that the text of a number may take; longer ones go another way.
pub(super) const WINDOW: usize = 32;

/// Where the text of one number is made.
pub(super) struct Scratch {
    shortest: zmij::Buffer,
    fixed: [u8; WINDOW],
}

impl Scratch {
    pub fn new() -> Self {
        Scratch { shortest: zmij::Buffer::new(), fixed: [0; WINDOW] }
    }

    /// The text, with `.0` at the end of whole numbers in their shortest form; nothing where there is no room for it.
    /// NaN and infinities are `NaN`, `inf`, `-inf`.
    #[inline(always)]
    pub fn number(&mut self, value: f64, decimals: Decimals) -> Option<&[u8]> {
        if !value.is_finite() {
            return Some(special(value));
        }
        match decimals {
            Decimals::Shortest if value == 0.0 => Some(b"0"),
            Decimals::Shortest => Some(self.shortest.format_finite(value).as_bytes()),
            Decimals::Fixed(places) => {
                let length = fixed(&mut self.fixed, value, places)?;
                self.fixed.get(..length)
            }
        }
    }
}

/// Copies a text to the start of the window, with moves of fixed size that may overlap; gives its length.
#[inline(always)]
pub(super) fn put(window: &mut [u8; WINDOW], text: &[u8]) -> usize {
    let n = text.len().min(WINDOW);
    match n {
        16.. => {
            window[..16].copy_from_slice(&text[..16]);
            window[n - 16..n].copy_from_slice(&text[n - 16..n]);
        }
        8.. => {
            window[..8].copy_from_slice(&text[..8]);
            window[n - 8..n].copy_from_slice(&text[n - 8..n]);
        }
        4.. => {
            window[..4].copy_from_slice(&text[..4]);
            window[n - 4..n].copy_from_slice(&text[n - 4..n]);
        }
        _ => {
            for (to, from) in window.iter_mut().zip(text) {
                *to = *from;
            }
        }
    }
    n
}

/// What [`Scratch::number`] left: ties, large numbers.
#[cold]
pub(super) fn long_number(out: &mut Vec<u8>, value: f64, places: u8) {
    let places = usize::from(places.min(12));
    // Writing to memory does not fail.
    let _ = write!(out, "{value:.places$}");
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

#[inline(always)]
fn fixed(window: &mut [u8; WINDOW], value: f64, places: u8) -> Option<usize> {
    match places {
        0 => fixed_to::<0>(window, value),
        1 => fixed_to::<1>(window, value),
        2 => fixed_to::<2>(window, value),
        3 => fixed_to::<3>(window, value),
        4 => fixed_to::<4>(window, value),
        5 => fixed_to::<5>(window, value),
        6 => fixed_to::<6>(window, value),
        7 => fixed_to::<7>(window, value),
        8 => fixed_to::<8>(window, value),
        9 => fixed_to::<9>(window, value),
        10 => fixed_to::<10>(window, value),
        11 => fixed_to::<11>(window, value),
        _ => fixed_to::<12>(window, value),
    }
}

/// Added to a smaller number it rounds it to a whole one, which stands in the sum's last bits.
const TWO_52: f64 = 4_503_599_627_370_496.0;

/// With a constant number of decimals divisions become multiplications.
#[inline(always)]
fn fixed_to<const PLACES: usize>(window: &mut [u8; WINDOW], value: f64) -> Option<usize> {
    let scale = TEN[PLACES];
    let scaled = value.abs() * scale as f64;
    // Below 2^39 the rounding of the product is less than 4e-5.
    if scaled >= 549_755_813_888.0 {
        return None;
    }
    let rounded = scaled + TWO_52;
    let n = rounded.to_bits() & ((1 << 52) - 1);
    let rest = scaled - (rounded - TWO_52);
    // So near to a half the exact product decides.
    if !(-0.4999..=0.4999).contains(&rest) {
        return None;
    }
    let (whole, fraction) = (n / scale, n % scale);
    window[0] = b'-';
    // Without branches: a column's signs are anybody's guess.
    let mut at = (value.to_bits() >> 63) as usize & usize::from(n > 0);
    if whole < 10 {
        window[at] = b'0' + whole as u8;
        at += 1;
    } else {
        at = integer(window, at, whole);
    }
    if PLACES > 0 {
        window[at] = b'.';
        at += 1;
        if PLACES <= 8 {
            eight(window, at, fraction * TEN[8 - PLACES.min(8)]);
        } else {
            let last = TEN[PLACES.max(8) - 8];
            eight(window, at, fraction / last);
            eight(window, at + 8, fraction % last * TEN[16usize.saturating_sub(PLACES).min(12)]);
        }
        at += PLACES;
    }
    Some(at)
}

/// Writes a number below 10^8 with eight digits: halves, quarters and single digits side by side in one word.
#[inline(always)]
fn eight(window: &mut [u8; WINDOW], at: usize, n: u64) {
    let fours = (n / 10_000) | (n % 10_000) << 32;
    let hundreds = ((fours * 10_486) >> 20) & 0x0000_007F_0000_007F;
    let twos = hundreds | (fours - 100 * hundreds) << 16;
    let tens = ((twos * 103) >> 10) & 0x000F_000F_000F_000F;
    let ones = tens | (twos - 10 * tens) << 8;
    window[at..at + 8].copy_from_slice(&(ones | 0x3030_3030_3030_3030).to_le_bytes());
}

/// Writes an integer of up to 12 digits; gives the place after it.
#[inline]
fn integer(window: &mut [u8; WINDOW], at: usize, mut n: u64) -> usize {
    if n < 100 {
        window[at] = b'0' + (n / 10) as u8;
        window[at + 1] = b'0' + (n % 10) as u8;
        return at + 2;
    }
    let mut digits = [0u8; 16];
    let mut first = digits.len();
    while n > 0 && first > 0 {
        first -= 1;
        digits[first] = b'0' + (n % 10) as u8;
        n /= 10;
    }
    let end = at + digits.len() - first;
    window[at..end].copy_from_slice(&digits[first..]);
    end
}
