//! Eight numbers in a vector of AVX-512.

use core::arch::x86_64::{
    __m512d, _CMP_LT_OQ, _mm256_loadu_pd, _mm256_storeu_pd, _mm512_add_pd, _mm512_castpd256_pd512,
    _mm512_castpd512_pd256, _mm512_cmp_pd_mask, _mm512_div_pd, _mm512_extractf64x4_pd, _mm512_insertf64x4,
    _mm512_loadu_pd, _mm512_mask_blend_pd, _mm512_mul_pd, _mm512_permutex2var_pd, _mm512_set1_pd,
    _mm512_setr_epi64, _mm512_shuffle_f64x2, _mm512_sqrt_pd, _mm512_storeu_pd, _mm512_sub_pd,
    _mm512_unpackhi_pd, _mm512_unpacklo_pd,
};
use core::ops::{Add, Div, Mul, Sub};

use shisei_core::lanes::{Lanes, Number};

/// Only copies for AVX-512 make these, and they run only where the processor has it: so every instruction below.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Avx512(__m512d);

impl Number for Avx512 {
    #[inline(always)]
    fn of(value: f64) -> Self {
        // SAFETY: the processor has AVX-512; see the type.
        Avx512(unsafe { _mm512_set1_pd(value) })
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        // SAFETY: as above.
        Avx512(unsafe { _mm512_sqrt_pd(self.0) })
    }

    #[inline(always)]
    fn below(self, limit: Self) -> bool {
        // SAFETY: as above.
        unsafe { _mm512_cmp_pd_mask::<_CMP_LT_OQ>(self.0, limit.0) == 0xff }
    }

    #[inline(always)]
    fn if_below(self, limit: Self, yes: Self, no: Self) -> Self {
        // SAFETY: as above.
        unsafe {
            let below = _mm512_cmp_pd_mask::<_CMP_LT_OQ>(self.0, limit.0);
            Avx512(_mm512_mask_blend_pd(below, no.0, yes.0))
        }
    }
}

impl Lanes<8> for Avx512 {
    #[inline(always)]
    fn from_array(values: [f64; 8]) -> Self {
        // SAFETY: as above; eight numbers are read.
        Avx512(unsafe { _mm512_loadu_pd(values.as_ptr()) })
    }

    #[inline(always)]
    fn to_array(self) -> [f64; 8] {
        let mut values = [0.0; 8];
        // SAFETY: as above; eight numbers are written.
        unsafe { _mm512_storeu_pd(values.as_mut_ptr(), self.0) };
        values
    }

    #[inline(always)]
    fn columns(rows: [&[f64; 4]; 8]) -> [Self; 3] {
        // SAFETY: as above; every row has the four numbers that are read.
        unsafe {
            let two = |a: usize, b: usize| {
                let (a, b) = (_mm256_loadu_pd(rows[a].as_ptr()), _mm256_loadu_pd(rows[b].as_ptr()));
                _mm512_insertf64x4::<1>(_mm512_castpd256_pd512(a), b)
            };
            let [a, b, c, d] = [two(0, 2), two(1, 3), two(4, 6), two(5, 7)];
            // x and z of rows 0 to 3, of rows 4 to 7; y likewise
            let (xz, xz_more) = (_mm512_unpacklo_pd(a, b), _mm512_unpacklo_pd(c, d));
            let (y, y_more) = (_mm512_unpackhi_pd(a, b), _mm512_unpackhi_pd(c, d));
            [
                Avx512(_mm512_shuffle_f64x2::<0b10_00_10_00>(xz, xz_more)),
                Avx512(_mm512_shuffle_f64x2::<0b10_00_10_00>(y, y_more)),
                Avx512(_mm512_shuffle_f64x2::<0b11_01_11_01>(xz, xz_more)),
            ]
        }
    }

    #[inline(always)]
    fn write_rows([w, x, y, z]: [Self; 4], rows: [&mut [f64; 4]; 8]) {
        // SAFETY: as above; every row has room for the four numbers that are written.
        unsafe {
            let (even_wx, even_yz) = (_mm512_unpacklo_pd(w.0, x.0), _mm512_unpacklo_pd(y.0, z.0));
            let (odd_wx, odd_yz) = (_mm512_unpackhi_pd(w.0, x.0), _mm512_unpackhi_pd(y.0, z.0));
            let first = _mm512_setr_epi64(0, 1, 8, 9, 2, 3, 10, 11);
            let last = _mm512_setr_epi64(4, 5, 12, 13, 6, 7, 14, 15);
            let [row0, row1, row2, row3, row4, row5, row6, row7] = rows;
            for (two, front, back) in [
                (_mm512_permutex2var_pd(even_wx, first, even_yz), row0, row2),
                (_mm512_permutex2var_pd(odd_wx, first, odd_yz), row1, row3),
                (_mm512_permutex2var_pd(even_wx, last, even_yz), row4, row6),
                (_mm512_permutex2var_pd(odd_wx, last, odd_yz), row5, row7),
            ] {
                _mm256_storeu_pd(front.as_mut_ptr(), _mm512_castpd512_pd256(two));
                _mm256_storeu_pd(back.as_mut_ptr(), _mm512_extractf64x4_pd::<1>(two));
            }
        }
    }
}

instructions! { Avx512: Add add _mm512_add_pd, Sub sub _mm512_sub_pd, Mul mul _mm512_mul_pd, Div div _mm512_div_pd }
