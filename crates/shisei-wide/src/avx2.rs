//! Four numbers in a vector of AVX2.

use core::arch::x86_64::{
    __m256d, _CMP_LT_OQ, _mm256_add_pd, _mm256_blendv_pd, _mm256_cmp_pd, _mm256_div_pd, _mm256_loadu_pd,
    _mm256_movemask_pd, _mm256_mul_pd, _mm256_permute2f128_pd, _mm256_set1_pd, _mm256_sqrt_pd,
    _mm256_storeu_pd, _mm256_sub_pd, _mm256_unpackhi_pd, _mm256_unpacklo_pd,
};
use core::ops::{Add, Div, Mul, Sub};

use shisei_core::lanes::{Lanes, Number};

/// Only copies for AVX2 make these, and they run only where the processor has it: so every instruction below.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Avx2(__m256d);

/// The lower halves of two, and the upper ones.
const LOWER: i32 = 0x20;
const UPPER: i32 = 0x31;

impl Number for Avx2 {
    #[inline(always)]
    fn of(value: f64) -> Self {
        // SAFETY: the processor has AVX2; see the type.
        Avx2(unsafe { _mm256_set1_pd(value) })
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        // SAFETY: as above.
        Avx2(unsafe { _mm256_sqrt_pd(self.0) })
    }

    #[inline(always)]
    fn below(self, limit: Self) -> bool {
        // SAFETY: as above.
        unsafe { _mm256_movemask_pd(_mm256_cmp_pd::<_CMP_LT_OQ>(self.0, limit.0)) == 0b1111 }
    }

    #[inline(always)]
    fn if_below(self, limit: Self, yes: Self, no: Self) -> Self {
        // SAFETY: as above.
        Avx2(unsafe { _mm256_blendv_pd(no.0, yes.0, _mm256_cmp_pd::<_CMP_LT_OQ>(self.0, limit.0)) })
    }
}

impl Lanes<4> for Avx2 {
    #[inline(always)]
    fn from_array(values: [f64; 4]) -> Self {
        // SAFETY: as above; four numbers are read.
        Avx2(unsafe { _mm256_loadu_pd(values.as_ptr()) })
    }

    #[inline(always)]
    fn to_array(self) -> [f64; 4] {
        let mut values = [0.0; 4];
        // SAFETY: as above; four numbers are written.
        unsafe { _mm256_storeu_pd(values.as_mut_ptr(), self.0) };
        values
    }

    #[inline(always)]
    fn columns(rows: [&[f64; 4]; 4]) -> [Self; 3] {
        // SAFETY: as above; every row has the four numbers that are read.
        unsafe {
            let [a, b, c, d] = rows.map(|row| _mm256_loadu_pd(row.as_ptr()));
            // x and z of rows 0 and 1, of rows 2 and 3; y likewise
            let (xz, xz_more) = (_mm256_unpacklo_pd(a, b), _mm256_unpacklo_pd(c, d));
            let (y, y_more) = (_mm256_unpackhi_pd(a, b), _mm256_unpackhi_pd(c, d));
            [
                Avx2(_mm256_permute2f128_pd::<LOWER>(xz, xz_more)),
                Avx2(_mm256_permute2f128_pd::<LOWER>(y, y_more)),
                Avx2(_mm256_permute2f128_pd::<UPPER>(xz, xz_more)),
            ]
        }
    }

    #[inline(always)]
    fn write_rows([w, x, y, z]: [Self; 4], rows: [&mut [f64; 4]; 4]) {
        // SAFETY: as above; every row has room for the four numbers that are written.
        unsafe {
            let (even_wx, even_yz) = (_mm256_unpacklo_pd(w.0, x.0), _mm256_unpacklo_pd(y.0, z.0));
            let (odd_wx, odd_yz) = (_mm256_unpackhi_pd(w.0, x.0), _mm256_unpackhi_pd(y.0, z.0));
            let [row0, row1, row2, row3] = rows;
            _mm256_storeu_pd(row0.as_mut_ptr(), _mm256_permute2f128_pd::<LOWER>(even_wx, even_yz));
            _mm256_storeu_pd(row1.as_mut_ptr(), _mm256_permute2f128_pd::<LOWER>(odd_wx, odd_yz));
            _mm256_storeu_pd(row2.as_mut_ptr(), _mm256_permute2f128_pd::<UPPER>(even_wx, even_yz));
            _mm256_storeu_pd(row3.as_mut_ptr(), _mm256_permute2f128_pd::<UPPER>(odd_wx, odd_yz));
        }
    }
}

instructions! { Avx2: Add add _mm256_add_pd, Sub sub _mm256_sub_pd, Mul mul _mm256_mul_pd, Div div _mm256_div_pd }
