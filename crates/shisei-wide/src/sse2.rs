//! Two numbers in a vector of SSE2.

use core::arch::x86_64::{
    __m128d, _mm_add_pd, _mm_and_pd, _mm_andnot_pd, _mm_cmplt_pd, _mm_div_pd, _mm_loadu_pd, _mm_movemask_pd,
    _mm_mul_pd, _mm_or_pd, _mm_set1_pd, _mm_sqrt_pd, _mm_storeu_pd, _mm_sub_pd, _mm_unpackhi_pd,
    _mm_unpacklo_pd,
};
use core::ops::{Add, Div, Mul, Sub};

use shisei_core::lanes::{Lanes, Number};

/// Every x86-64 has these instructions.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sse2(__m128d);

impl Number for Sse2 {
    #[inline(always)]
    fn of(value: f64) -> Self {
        // SAFETY: SSE2 belongs to every x86-64.
        Sse2(unsafe { _mm_set1_pd(value) })
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        // SAFETY: as above.
        Sse2(unsafe { _mm_sqrt_pd(self.0) })
    }

    #[inline(always)]
    fn below(self, limit: Self) -> bool {
        // SAFETY: as above.
        unsafe { _mm_movemask_pd(_mm_cmplt_pd(self.0, limit.0)) == 0b11 }
    }

    #[inline(always)]
    fn if_below(self, limit: Self, yes: Self, no: Self) -> Self {
        // SAFETY: as above.
        unsafe {
            let below = _mm_cmplt_pd(self.0, limit.0);
            Sse2(_mm_or_pd(_mm_and_pd(below, yes.0), _mm_andnot_pd(below, no.0)))
        }
    }
}

impl Lanes<2> for Sse2 {
    #[inline(always)]
    fn from_array(values: [f64; 2]) -> Self {
        // SAFETY: as above; two numbers are read.
        Sse2(unsafe { _mm_loadu_pd(values.as_ptr()) })
    }

    #[inline(always)]
    fn to_array(self) -> [f64; 2] {
        let mut values = [0.0; 2];
        // SAFETY: as above; two numbers are written.
        unsafe { _mm_storeu_pd(values.as_mut_ptr(), self.0) };
        values
    }

    #[inline(always)]
    fn columns(rows: [&[f64; 4]; 2]) -> [Self; 3] {
        // SAFETY: as above; every row has twice the two numbers that are read.
        unsafe {
            let [xy0, xy1] = rows.map(|row| _mm_loadu_pd(row.as_ptr()));
            let [z0, z1] = rows.map(|row| _mm_loadu_pd(row.as_ptr().add(2)));
            [Sse2(_mm_unpacklo_pd(xy0, xy1)), Sse2(_mm_unpackhi_pd(xy0, xy1)), Sse2(_mm_unpacklo_pd(z0, z1))]
        }
    }

    #[inline(always)]
    fn write_rows([w, x, y, z]: [Self; 4], [row0, row1]: [&mut [f64; 4]; 2]) {
        // SAFETY: as above; every row has room for twice two numbers.
        unsafe {
            _mm_storeu_pd(row0.as_mut_ptr(), _mm_unpacklo_pd(w.0, x.0));
            _mm_storeu_pd(row0.as_mut_ptr().add(2), _mm_unpacklo_pd(y.0, z.0));
            _mm_storeu_pd(row1.as_mut_ptr(), _mm_unpackhi_pd(w.0, x.0));
            _mm_storeu_pd(row1.as_mut_ptr().add(2), _mm_unpackhi_pd(y.0, z.0));
        }
    }
}

instructions! { Sse2: Add add _mm_add_pd, Sub sub _mm_sub_pd, Mul mul _mm_mul_pd, Div div _mm_div_pd }
