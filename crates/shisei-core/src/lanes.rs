//! Numbers side by side: one formula for one number and for many.
//!
//! What is written over [`Number`] runs on one `f64`, and on several of them as vectors of processors take them. Only
//! what every target rounds correctly belongs here, so that each number gets the bits that it gets alone.

use core::array::from_fn;
use core::ops::{Add, Div, Mul, Sub};

use crate::math;

/// One number, or several side by side.
pub trait Number:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    /// The same number for all.
    fn of(value: f64) -> Self;

    /// Square root.
    fn sqrt(self) -> Self;

    /// Whether all are below those of `limit`; never where one is not a number.
    fn below(self, limit: Self) -> bool;

    /// `yes` where a number is below that of `limit`, `no` elsewhere.
    fn if_below(self, limit: Self, yes: Self, no: Self) -> Self;
}

/// `N` numbers side by side.
pub trait Lanes<const N: usize>: Number {
    /// One for each.
    fn from_array(values: [f64; N]) -> Self;

    /// Each by itself.
    fn to_array(self) -> [f64; N];

    /// The first three columns of rows; what stands in the fourth plays no part.
    fn columns(rows: [&[f64; 4]; N]) -> [Self; 3];

    /// Writes four columns as rows.
    fn write_rows(columns: [Self; 4], rows: [&mut [f64; 4]; N]);
}

impl Number for f64 {
    #[inline(always)]
    fn of(value: f64) -> Self {
        value
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        math::sqrt(self)
    }

    #[inline(always)]
    fn below(self, limit: Self) -> bool {
        self < limit
    }

    #[inline(always)]
    fn if_below(self, limit: Self, yes: Self, no: Self) -> Self {
        if self < limit { yes } else { no }
    }
}

/// What every target can do.
#[derive(Clone, Copy, Debug)]
pub struct Portable<const N: usize>([f64; N]);

impl<const N: usize> Number for Portable<N> {
    #[inline(always)]
    fn of(value: f64) -> Self {
        Portable([value; N])
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Portable(self.0.map(math::sqrt))
    }

    #[inline(always)]
    #[allow(clippy::needless_bitwise_bool)] // no branch, so that compilers take several at once
    fn below(self, limit: Self) -> bool {
        (0..N).fold(true, |all, i| all & (self.0[i] < limit.0[i]))
    }

    #[inline(always)]
    fn if_below(self, limit: Self, yes: Self, no: Self) -> Self {
        Portable(from_fn(|i| self.0[i].if_below(limit.0[i], yes.0[i], no.0[i])))
    }
}

impl<const N: usize> Lanes<N> for Portable<N> {
    #[inline(always)]
    fn from_array(values: [f64; N]) -> Self {
        Portable(values)
    }

    #[inline(always)]
    fn to_array(self) -> [f64; N] {
        self.0
    }

    #[inline(always)]
    fn columns(rows: [&[f64; 4]; N]) -> [Self; 3] {
        from_fn(|column| Portable(from_fn(|i| rows[i][column])))
    }

    #[inline(always)]
    fn write_rows(columns: [Self; 4], rows: [&mut [f64; 4]; N]) {
        for (i, row) in rows.into_iter().enumerate() {
            *row = columns.map(|column| column.0[i]);
        }
    }
}

macro_rules! each_by_itself {
    ($($operation:ident $method:ident $sign:tt;)*) => {$(
        impl<const N: usize> $operation for Portable<N> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Portable(from_fn(|i| self.0[i] $sign other.0[i]))
            }
        }
    )*};
}

each_by_itself! {
    Add add +;
    Sub sub -;
    Mul mul *;
    Div div /;
}
