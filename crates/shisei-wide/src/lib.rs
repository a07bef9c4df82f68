//! The core's series over the widest vectors that this processor has.
//!
//! The core is one source for all targets, so that compilers may use only what every x86-64 has. Here its series are
//! compiled again for AVX2 and for AVX-512, and one of the copies is chosen when the program runs. No formula lives
//! here, and no bit differs: the operations are the same in the same order, and none is fused with another.
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

use shisei_core::filter::{Dt, Filter, GyroOnly, Readings, run_gyro_into, run_into, run_many_into};
use shisei_core::orient::Orientation;
use shisei_core::{AttitudeRow, Error, Quaternion, Result, Vec3, relative};

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

/// A method of [`Vectors`] with a copy of its body for every width; what the body calls is inlined into them.
macro_rules! wide {
    ($(#[$doc:meta])* $name:ident$(@$most:ident)?<$($kind:ident: $bound:path),*>($($arg:ident: $type:ty),* $(,)?) -> $ret:ty
     $body:block) => {
        impl Vectors {
            $(#[$doc])*
            #[allow(clippy::inline_always)] // the copies need the body in themselves
            pub fn $name<$($kind: $bound),*>(self, $($arg: $type),*) -> $ret {
                #[inline(always)]
                fn plain<$($kind: $bound),*>($($arg: $type),*) -> $ret $body

                #[cfg(target_arch = "x86_64")]
                #[target_feature(enable = "avx2")]
                fn avx2<$($kind: $bound),*>($($arg: $type),*) -> $ret {
                    plain($($arg),*)
                }

                #[cfg(target_arch = "x86_64")]
                #[target_feature(enable = "avx512f,avx512dq,avx512vl,avx512bw")]
                fn avx512<$($kind: $bound),*>($($arg: $type),*) -> $ret {
                    plain($($arg),*)
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
    /// [`Orientation::ypr_rad`].
    ypr_rad<>(orientation: &Orientation) -> Vec<[f64; 3]> {
        orientation.ypr_rad()
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
    /// [`run_gyro_into`]. The integrator takes its readings one by one into vectors, where AVX-512 has nothing to add.
    run_gyro_into@Avx2<F: GyroOnly, O: AttitudeRow>(
        filter: &mut F,
        gyro_rad_s: &[Vec3],
        dt: Dt<'_>,
        out: &mut [O],
    ) -> Result<()> {
        run_gyro_into(filter, gyro_rad_s, dt, out)
    }
}

wide! {
    /// [`run_many_into`].
    run_many_into<O: AttitudeRow>(recordings: &mut [Readings<'_, O>]) -> std::result::Result<(), (usize, Error)> {
        run_many_into(recordings)
    }
}
