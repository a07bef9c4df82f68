//! Texts of numbers put into place two at a time, where the processor takes any bytes of a vector in any order (AVX-512
//! VBMI) and closes the gaps between those that are kept (VBMI2).
//!
//! All characters that a number may have stand in a slot, from a minus to the byte after it; a mask says which it has.
#![allow(unsafe_code)] // loads and stores of vectors, each of an array as long

use super::WINDOW;
use super::digits::{TILE, ZEROS, eights};
use super::shortest::{FIVES, LEAST, MOST, decimal, decimals_of, is_odd, last_bit, power};
use std::arch::x86_64::{
    __m512i, _mm_loadu_epi64, _mm256_loadu_epi8, _mm256_loadu_epi64, _mm512_castsi256_si512,
    _mm512_inserti64x2, _mm512_inserti64x4, _mm512_loadu_epi64, _mm512_maskz_compress_epi8,
    _mm512_permutex2var_epi64, _mm512_permutexvar_epi8, _mm512_storeu_epi8, _mm512_storeu_epi64,
};

/// Bytes of a slot.
const SLOT: usize = 32;

/// What stands in the slots of two numbers is taken from: the 16 digits of the first and of the second, and eight other
/// characters of each, which are these: a 17th digit (here without its value), and the byte after the number.
const OTHERS: u64 = u64::from_le_bytes(*b"0.0-\0\0\0\0");
const LAST: usize = 32;
const POINT: usize = 33;
const ZERO: usize = 34;
const MINUS: usize = 35;
const AFTER: usize = 36;
/// How much further on the digits and the others of the second are.
const SECOND: [usize; 2] = [16, 8];

/// What stands where in the slot of the first and of the second of two numbers: the minus, the number, and at the end the
/// byte after it. Its place says how many decimals 16 digits have, and whether the first of them is missing.
static LAYOUTS: [[[u8; SLOT]; 64]; 2] = {
    let mut layouts = [[[0; SLOT]; 64]; 2];
    let mut k = 2 * LEAST as usize;
    while k < 2 * (MOST as usize + 1) {
        layouts[0][k] = layout(k / 2, k % 2, [0, 0]);
        layouts[1][k] = layout(k / 2, k % 2, SECOND);
        k += 1;
    }
    layouts
};

const fn layout(decimals: usize, missing: usize, [digits, others]: [usize; 2]) -> [u8; SLOT] {
    let mut layout = [0; SLOT];
    layout[0] = (MINUS + others) as u8;
    layout[SLOT - 1] = (AFTER + others) as u8;
    let (mut digit, mut at) = (missing, 1);
    if decimals + missing >= 16 {
        layout[1] = (ZERO + others) as u8;
        layout[2] = (POINT + others) as u8;
        at = 3;
        while at < 3 + decimals + missing - 16 {
            layout[at] = (ZERO + others) as u8;
            at += 1;
        }
    }
    while digit <= 16 {
        if decimals + missing < 16 && digit == 16 - decimals {
            layout[at] = (POINT + others) as u8;
            at += 1;
        }
        layout[at] = if digit < 16 { digit + digits } else { LAST + others } as u8;
        at += 1;
        digit += 1;
    }
    layout
}

/// Writes numbers in their shortest form, each with the byte after it, and gives the length of the text; nothing where
/// one of them goes another way.
#[target_feature(enable = "avx512f,avx512dq,avx512vl,avx512bw,avx512cd,avx512vbmi,avx512vbmi2,bmi2,popcnt")]
pub(super) fn shortest(
    values: &[f64; TILE],
    after: &[u8; TILE],
    out: &mut [u8; TILE * WINDOW],
) -> Option<usize> {
    if values.iter().fold(false, |odd, value| odd | is_odd(*value)) {
        return None;
    }
    let decimals = values.map(|value| decimals_of(last_bit(value)));
    let fives = fives(&decimals);
    let (mut high, mut low) = ([0u32; TILE], [0u32; TILE]);
    let (mut last, mut long) = ([0u64; TILE], [0u64; TILE]);
    for k in 0..TILE {
        let power = power(fives[k], decimals[k], last_bit(values[k]));
        ([high[k], low[k]], last[k], long[k]) = decimal(values[k].to_bits(), power);
    }
    let (mut high_digits, mut low_digits) = ([0; TILE], [0; TILE]);
    eights(&high, &mut high_digits);
    eights(&low, &mut low_digits);

    let (mut digits, mut others) = ([[0; 2]; TILE], [0; TILE]);
    let (mut layout, mut kept) = ([0; TILE], [0; TILE]);
    for k in 0..TILE {
        let (high, low, decimals) = (high_digits[k], low_digits[k], decimals[k]);
        let missing = u64::from(high.trailing_zeros() >= 8);
        // Zeros at the end are left out, unless a 17th digit follows; with all decimals the point.
        let zeros = if low == 0 { 64 + high.leading_zeros() } else { low.leading_zeros() } / 8;
        let zeros = u64::from(zeros);
        let left_out = if zeros >= decimals { decimals + 2 } else { zeros + 1 };
        let left_out = if long[k] == 0 { left_out } else { 0 };
        let all = if decimals + missing >= 16 { decimals + 3 } else { 18 - missing };
        let characters = (1u64 << ((all - left_out) % 64)) - 1;
        kept[k] = (1 << (SLOT - 1) | characters << 1 | values[k].to_bits() >> 63) as u32;
        layout[k] = (2 * decimals + missing) as u8;
        digits[k] = [high | ZEROS, low | ZEROS];
        others[k] = OTHERS | last[k] | u64::from(after[k]) << (8 * (AFTER - LAST));
    }
    Some(put((&digits, &others), &layout, &kept, out))
}

/// 5 to these powers.
#[target_feature(enable = "avx512f")]
#[inline]
fn fives(powers: &[u64; TILE]) -> [u64; TILE] {
    let mut out = [0; TILE];
    let [first, second] = FIVES.as_chunks::<8>().0 else { return out };
    let (first, second) = (eight(first), eight(second));
    for (powers, out) in powers.as_chunks::<8>().0.iter().zip(out.as_chunks_mut::<8>().0) {
        let places = powers.map(|power| power.wrapping_sub(LEAST));
        let fives = _mm512_permutex2var_epi64(first, eight(&places), second);
        // SAFETY: eight numbers are written.
        unsafe { _mm512_storeu_epi64(out.as_mut_ptr().cast(), fives) };
    }
    out
}

/// Eight numbers.
#[target_feature(enable = "avx512f")]
#[inline]
fn eight(numbers: &[u64; 8]) -> __m512i {
    // SAFETY: eight numbers are read.
    unsafe { _mm512_loadu_epi64(numbers.as_ptr().cast()) }
}

/// Puts slots one after the other, without what is not kept of them.
#[target_feature(enable = "avx512f,avx512dq,avx512vl,avx512bw,avx512vbmi,avx512vbmi2,popcnt")]
#[inline]
fn put(
    (digits, others): (&[[u64; 2]; TILE], &[u64; TILE]),
    layout: &[u8; TILE],
    kept: &[u32; TILE],
    out: &mut [u8; TILE * WINDOW],
) -> usize {
    let (digits, others) = (digits.as_chunks::<2>().0, others.as_chunks::<2>().0);
    let (layout, kept) = (layout.as_chunks::<2>().0, kept.as_chunks::<2>().0);
    let mut at = 0;
    for k in 0..TILE / 2 {
        let [first, second] = [0, 1].map(|part| &LAYOUTS[part][usize::from(layout[k][part]) % 64]);
        // SAFETY: so many bytes are read.
        let (first, second, digits, others) = unsafe {
            (
                _mm256_loadu_epi8(first.as_ptr().cast()),
                _mm256_loadu_epi8(second.as_ptr().cast()),
                _mm256_loadu_epi64(digits[k].as_ptr().cast()),
                _mm_loadu_epi64(others[k].as_ptr().cast()),
            )
        };
        let places = _mm512_inserti64x4::<1>(_mm512_castsi256_si512(first), second);
        let characters = _mm512_inserti64x2::<2>(_mm512_castsi256_si512(digits), others);
        let text = _mm512_permutexvar_epi8(places, characters);
        let kept = u64::from(kept[k][0]) | u64::from(kept[k][1]) << 32;
        let text = _mm512_maskz_compress_epi8(kept, text);
        let Some(room) = out.get_mut(at..).and_then(|out| out.first_chunk_mut::<{ 2 * SLOT }>()) else {
            break;
        };
        // SAFETY: there is room for what is written.
        unsafe { _mm512_storeu_epi8(room.as_mut_ptr().cast(), text) };
        at += kept.count_ones() as usize;
    }
    at
}
