//! Numbers to decimal text, into a window of fixed size, so that copies are single moves.

use super::Decimals;
use std::io::Write;

/// Room that a number may take; longer ones go another way.
pub(super) const WINDOW: usize = 32;

/// Writes a number at the start of the window and tells its length; nothing where it may not fit. NaN and
/// infinities are `NaN`, `inf`, `-inf`.
#[inline]
pub(super) fn number(window: &mut [u8; WINDOW], value: f64, decimals: Decimals) -> Option<usize> {
    if !value.is_finite() {
        let text = special(value);
        window[..text.len()].copy_from_slice(text);
        return Some(text.len());
    }
    match decimals {
        Decimals::Shortest => Some(shortest(window, value)),
        Decimals::Fixed(places) => fixed(window, value, places.min(12)),
    }
}

/// What [`number`] left: ties, large numbers.
#[cold]
pub(super) fn long_number(out: &mut Vec<u8>, value: f64, places: u8) {
    let places = usize::from(places.min(12));
    // Writing to memory does not fail.
    let _ = write!(out, "{value:.places$}");
}

#[inline]
fn shortest(window: &mut [u8; WINDOW], value: f64) -> usize {
    let whole = value as i64;
    let mut buffer = zmij::Buffer::new();
    let text = if whole as f64 == value {
        let size = whole.unsigned_abs();
        if size < 10_000_000_000_000 {
            window[0] = b'-';
            let at = usize::from(whole < 0);
            return if size == 0 { digit(window, 0, 0) } else { integer(window, at, size) };
        }
        let text = buffer.format_finite(value).as_bytes();
        text.strip_suffix(b".0").unwrap_or(text)
    } else {
        buffer.format_finite(value).as_bytes()
    };
    let n = text.len();
    // Two moves that overlap instead of one of unknown length.
    if n >= 16 {
        window[..16].copy_from_slice(&text[..16]);
        window[n - 16..n].copy_from_slice(&text[n - 16..]);
    } else if n >= 8 {
        window[..8].copy_from_slice(&text[..8]);
        window[n - 8..n].copy_from_slice(&text[n - 8..]);
    } else {
        for (to, from) in window.iter_mut().zip(text) {
            *to = *from;
        }
    }
    n
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

#[inline]
fn fixed(window: &mut [u8; WINDOW], value: f64, places: u8) -> Option<usize> {
    let places = usize::from(places);
    let scale = TEN[places];
    let size = if value < 0.0 { -value } else { value };
    let scaled = size * scale as i64 as f64;
    if scaled >= 4.5e12 {
        return None;
    }
    let below = scaled as i64 as u64;
    let rest = scaled - below as i64 as f64;
    // Exact product with room to spare: the rounding of the product cannot move it over a half.
    if (0.4999..=0.5001).contains(&rest) {
        return None;
    }
    let n = below + u64::from(rest > 0.5);
    let mut whole = size as i64 as u64;
    let mut fraction = n - whole * scale;
    if fraction >= scale {
        whole += 1;
        fraction -= scale;
    }
    window[0] = b'-';
    let mut at = usize::from(value < 0.0 && n > 0);
    if whole < 10 {
        at = digit(window, at, whole);
    } else {
        at = integer(window, at, whole);
    }
    if places > 0 {
        window[at] = b'.';
        let twelve = fraction * TEN[12 - places];
        let (first, last) = ((twelve / 10_000) as u32, (twelve % 10_000) as u32);
        let (a, b) = (first / 10_000, first % 10_000);
        four(window, at + 1, a);
        four(window, at + 5, b);
        if places > 8 {
            four(window, at + 9, last);
        }
        at += 1 + places;
    }
    Some(at)
}

/// Two digits of every number below 100.
const PAIRS: [[u8; 2]; 100] = {
    let mut table = [[0u8; 2]; 100];
    let mut i = 0;
    while i < 100 {
        table[i] = [b'0' + (i / 10) as u8, b'0' + (i % 10) as u8];
        i += 1;
    }
    table
};

/// Writes a number below 10,000 with four digits.
#[inline(always)]
fn four(window: &mut [u8; WINDOW], at: usize, n: u32) {
    let ([a, b], [c, d]) = (PAIRS[(n / 100) as usize % 100], PAIRS[(n % 100) as usize]);
    window[at..at + 4].copy_from_slice(&[a, b, c, d]);
}

/// Writes one digit; gives the place after it.
#[inline(always)]
fn digit(window: &mut [u8; WINDOW], at: usize, n: u64) -> usize {
    window[at] = b'0' + n as u8;
    at + 1
}

/// Writes an integer of up to 13 digits; gives the place after it.
fn integer(window: &mut [u8; WINDOW], at: usize, mut n: u64) -> usize {
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
