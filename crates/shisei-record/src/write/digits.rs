//! Eight decimal digits at a time.

/// Numbers whose digits are made together.
pub(super) const TILE: usize = 64;

/// The digit 0 in every byte.
pub(super) const ZEROS: u64 = 0x3030_3030_3030_3030;

/// The digits (0 to 9 a byte, the first in the lowest byte) of a number below 10^8: halves, quarters and single
/// digits side by side in one word.
#[inline(always)]
pub(super) fn eight(n: u64) -> u64 {
    // quotient + 2^32 remainder of n by 10^4, and so on: the first part goes up, the rest stays
    let fours = n + ((1 << 32) - 10_000) * ((n * 109_951_163) >> 40);
    let twos = fours + ((1 << 16) - 100) * (((fours * 5_243) >> 19) & 0x0000_007F_0000_007F);
    let ones = twos + ((1 << 8) - 10) * (((twos * 103) >> 10) & 0x000F_000F_000F_000F);
    ones.swap_bytes()
}

/// As [`eight`] of every number; what is made of one that is not below 10^8 means nothing. The loops are plain, so
/// that they are compiled to vectors of 16-bit lanes.
#[inline(always)]
pub(super) fn eights(numbers: &[u32; TILE], digits: &mut [u64; TILE]) {
    let mut fours = [0u16; 2 * TILE];
    for (n, pair) in numbers.iter().zip(fours.as_chunks_mut::<2>().0) {
        let first = ((u64::from(*n) * 109_951_163) >> 40) as u32;
        *pair = [first as u16, n.wrapping_sub(first.wrapping_mul(10_000)) as u16];
    }
    let mut twos = [0u16; 4 * TILE];
    for (n, pair) in fours.iter().zip(twos.as_chunks_mut::<2>().0) {
        let first = ((u32::from(*n) * 5_243) >> 16) as u16 >> 3;
        *pair = [first, n.wrapping_sub(first.wrapping_mul(100))];
    }
    let mut ones = [0u16; 4 * TILE];
    for (n, pair) in twos.iter().zip(&mut ones) {
        let first = ((u32::from(*n) * 6_554) >> 16) as u16;
        // first + 256 (n - 10 first)
        *pair = (n << 8).wrapping_sub(first.wrapping_mul(2_559));
    }
    for ([a, b, c, d], word) in ones.as_chunks::<4>().0.iter().zip(digits) {
        *word = u64::from(*a) | u64::from(*b) << 16 | u64::from(*c) << 32 | u64::from(*d) << 48;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn as_std_writes_them() {
        let mut numbers = [0u32; TILE];
        for round in 0..2_000u32 {
            for (k, n) in numbers.iter_mut().enumerate() {
                *n = (round * TILE as u32 + k as u32).wrapping_mul(2_654_435_761) % 100_000_000;
            }
            numbers[..4].copy_from_slice(&[0, 9_999, 10_000, 99_999_999]);
            let mut digits = [0; TILE];
            eights(&numbers, &mut digits);
            for (n, word) in numbers.iter().zip(digits) {
                assert_eq!((word | ZEROS).to_le_bytes().as_slice(), format!("{n:08}").as_bytes());
                assert_eq!(word, eight(u64::from(*n)));
            }
        }
    }
}
