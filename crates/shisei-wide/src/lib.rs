//! The core's series over the widest vectors that this processor has.
//!
//! The core is one source for all targets, so that compilers may use only what every x86-64 has. Here its series are
//! compiled again for AVX2 and for AVX-512, and one of the copies is chosen when the program runs; where compilers do not
//! find out by themselves what can go side by side, the core's [`Number`](shisei_core::lanes::Number) is a vector. No
//! formula lives here, and no bit differs: the operations are the same in the same order, and none is fused with
//! another.
//!
//! ```
//! use shisei_wide::Vectors;
//!
//! let quaternions = [[1.0, 0.0, 0.0, 0.0]; 100];
//! let mut ypr_rad = [[1.0; 3]; 100];
//! Vectors::widest().convert_series(&quaternions, &mut ypr_rad)?;
//! assert_eq!(ypr_rad, [[0.0; 3]; 100]);
//! # Ok::<(), shisei_core::Error>(())
//! ```
#![warn(missing_docs)]
#![allow(unsafe_code)] // a copy for AVX2 may be called only where there is AVX2: `Vectors` is the proof

/// Operators that are an instruction each.
#[cfg(target_arch = "x86_64")]
macro_rules! instructions {
    ($vector:ident: $($operation:ident $method:ident $instruction:ident),*) => {$(
        impl $operation for $vector {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                // SAFETY: the processor has the instructions of the type; see there.
                $vector(unsafe { $instruction(self.0, other.0) })
            }
        }
    )*};
}

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
#[cfg(target_arch = "x86_64")]
mod sse2;

#[cfg(target_arch = "x86_64")]
use self::{avx2::Avx2, avx512::Avx512, sse2::Sse2 as Plain};
use shisei_core::filter::{
    Dt, Filter, GyroOnly, Readings, run_gyro_in_lanes, run_gyro_into, run_into, run_many_in_lanes,
};
#[cfg(not(target_arch = "x86_64"))]
use shisei_core::lanes::Portable;
use shisei_core::orient::{self, Relative};
use shisei_core::{AttitudeRow, Error, Quaternion, Result, Vec3, relative};

#[cfg(not(target_arch = "x86_64"))]
type Plain = Portable<PLAIN>;

/// Numbers side by side in what every processor of this kind has.
const PLAIN: usize = if cfg!(target_arch = "x86_64") { 2 } else { 4 };

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(not(target_arch = "x86_64"), allow(dead_code))] // others have what they are compiled for
enum Width {
    Plain,
    Avx2,
    Avx512,
}

/// Vectors that this processor has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Vectors(Width);

impl Vectors {
    /// What every processor of this kind has.
    pub const PLAIN: Vectors = Vectors(Width::Plain);

    /// The widest.
    pub fn widest() -> Vectors {
        #[cfg(target_arch = "x86_64")]
        {
            use std::arch::is_x86_feature_detected as has;
            if has!("avx512f") && has!("avx512dq") && has!("avx512vl") && has!("avx512bw") {
                return Vectors(Width::Avx512);
            }
            if has!("avx2") {
                return Vectors(Width::Avx2);
            }
        }
        Vectors::PLAIN
    }

    /// All of them, the narrowest first.
    pub fn all() -> impl Iterator<Item = Vectors> {
        let widest = Vectors::widest().0;
        let has = move |width: &Width| *width <= widest;
        [Width::Plain, Width::Avx2, Width::Avx512].into_iter().filter(has).map(Vectors)
    }
}

/// A method of [`Vectors`] with a copy of its body for every width; what the body calls is inlined into them. In a body
/// `N` numbers are a `Vector`.
macro_rules! wide {
    ($(#[$doc:meta])* $name:ident$(@$most:ident)?<$($kind:ident: $bound:path),*>($($arg:ident: $type:ty),* $(,)?) -> $ret:ty
     $body:block) => {
        impl Vectors {
            $(#[$doc])*
            #[allow(dead_code)] // some bodies leave it to the compiler how many numbers go side by side
            pub fn $name<$($kind: $bound),*>(self, $($arg: $type),*) -> $ret {
                fn plain<$($kind: $bound),*>($($arg: $type),*) -> $ret {
                    type Vector = Plain;
                    const N: usize = PLAIN;
                    $body
                }

                #[cfg(target_arch = "x86_64")]
                #[target_feature(enable = "avx2")]
                fn avx2<$($kind: $bound),*>($($arg: $type),*) -> $ret {
                    type Vector = Avx2;
                    const N: usize = 4;
                    $body
                }

                #[cfg(target_arch = "x86_64")]
                #[target_feature(enable = "avx512f,avx512dq,avx512vl,avx512bw")]
                fn avx512<$($kind: $bound),*>($($arg: $type),*) -> $ret {
                    type Vector = Avx512;
                    const N: usize = 8;
                    $body
                }

                match self.0 $(.min(Width::$most))? {
                    // SAFETY: `Vectors` of these widths are made only where the processor has them.
                    #[cfg(target_arch = "x86_64")]
                    Width::Avx2 => unsafe { avx2($($arg),*) },
                    // SAFETY: as above.
                    #[cfg(target_arch = "x86_64")]
                    Width::Avx512 => unsafe { avx512($($arg),*) },
                    _ => plain($($arg),*),
                }
            }
        }
    };
}

wide! {
    /// [`relative::convert_series`].
    convert_series<O: AttitudeRow>(quaternions: &[[f64; 4]], out: &mut [O]) -> Result<()> {
        relative::convert_series(quaternions, out)
    }
}

wide! {
    /// [`relative::body_series`].
    body_series<O: AttitudeRow>(current: &[[f64; 4]], initial: Quaternion, out: &mut [O]) -> Result<()> {
        relative::body_series(current, initial, out)
    }
}

wide! {
    /// [`relative::world_series`].
    world_series<O: AttitudeRow>(current: &[[f64; 4]], initial: Quaternion, out: &mut [O]) -> Result<()> {
        relative::world_series(current, initial, out)
    }
}

wide! {
    /// [`orient::ypr_rad`].
    ypr_rad<>(world_from_body: &[Quaternion], start: Quaternion, relative: Relative) -> Vec<[f64; 3]> {
        orient::ypr_rad(world_from_body, start, relative)
    }
}

wide! {
    /// [`run_into`].
    run_into<F: Filter, O: AttitudeRow>(
        filter: &mut F,
        gyro_rad_s: &[Vec3],
        acc_m_s2: &[Vec3],
        dt: Dt<'_>,
        out: &mut [O],
    ) -> Result<()> {
        run_into(filter, gyro_rad_s, acc_m_s2, dt, out)
    }
}

wide! {
    /// [`run_gyro_into`]. For AVX-512 the parts that go together would be twice as
    /// long, and memory is faster in short ones.
    run_gyro_into@Avx2<F: GyroOnly, O: AttitudeRow>(
        filter: &mut F,
        gyro_rad_s: &[Vec3],
        dt: Dt<'_>,
        out: &mut [O],
    ) -> Result<()> {
        if cfg!(target_arch = "x86_64") {
            run_gyro_in_lanes::<N, Vector, F, O>(filter, gyro_rad_s, dt, out)
        } else {
            run_gyro_into(filter, gyro_rad_s, dt, out)
        }
    }
}

wide! {
    /// [`run_many_into`](shisei_core::filter::run_many_into).
    run_many_into<O: AttitudeRow>(recordings: &mut [Readings<'_, O>]) -> std::result::Result<(), (usize, Error)> {
        run_many_in_lanes::<N, Vector, O>(recordings)
    }
}
