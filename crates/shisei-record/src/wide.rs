//! Loops over text, compiled again for processors with wider vectors and more ways to shift; one of the copies is
//! chosen when the program runs. The operations are the same: no number and no byte differs.
#![allow(unsafe_code)] // a copy for AVX2 may be called only where there is AVX2: `Vectors` is the proof

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(not(target_arch = "x86_64"), allow(dead_code))] // others have what they are compiled for
pub(crate) enum Width {
    Plain,
    Avx2,
    Avx512,
    /// With instructions that move bytes.
    Avx512Vbmi2,
}

/// Vectors that this processor has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Vectors(Width);

impl Vectors {
    /// The widest.
    pub fn widest() -> Vectors {
        #[cfg(target_arch = "x86_64")]
        {
            use std::arch::is_x86_feature_detected as has;
            if has!("avx2") && has!("bmi1") && has!("bmi2") && has!("lzcnt") {
                if has!("avx512f") && has!("avx512dq") && has!("avx512vl") && has!("avx512bw") {
                    let bytes =
                        has!("avx512cd") && has!("avx512vbmi") && has!("avx512vbmi2") && has!("popcnt");
                    return Vectors(if bytes { Width::Avx512Vbmi2 } else { Width::Avx512 });
                }
                return Vectors(Width::Avx2);
            }
        }
        Vectors(Width::Plain)
    }

    /// All of them, the narrowest first.
    #[cfg(test)]
    pub fn all() -> impl Iterator<Item = Vectors> {
        let widest = Vectors::widest().0;
        let all = [Width::Plain, Width::Avx2, Width::Avx512, Width::Avx512Vbmi2];
        all.into_iter().filter(move |w| *w <= widest).map(Vectors)
    }

    pub fn width(self) -> Width {
        self.0
    }
}

/// A function of `Vectors` and the arguments, with a copy of its body for every width; what the body calls is inlined
/// into them.
macro_rules! wide {
    ($(#[$doc:meta])* $vis:vis fn $name:ident<$($life:lifetime),*; $($kind:ident: $bound:path),*>
     ($($arg:ident: $type:ty),* $(,)?) $(-> $ret:ty)? $body:block) => {
        $(#[$doc])*
        #[allow(unsafe_code)] // as in `wide`
        $vis fn $name<$($life,)* $($kind: $bound),*>(vectors: $crate::wide::Vectors, $($arg: $type),*) $(-> $ret)? {
            #[inline(always)]
            fn plain<$($life,)* $($kind: $bound),*>($($arg: $type),*) $(-> $ret)? $body

            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx2,bmi1,bmi2,lzcnt")]
            fn avx2<$($life,)* $($kind: $bound),*>($($arg: $type),*) $(-> $ret)? {
                plain($($arg),*)
            }

            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,avx512f,avx512dq,avx512vl,avx512bw")]
            fn avx512<$($life,)* $($kind: $bound),*>($($arg: $type),*) $(-> $ret)? {
                plain($($arg),*)
            }

            match vectors.width() {
                // SAFETY: `Vectors` of these widths are made only where the processor has them.
                #[cfg(target_arch = "x86_64")]
                $crate::wide::Width::Avx2 => unsafe { avx2($($arg),*) },
                // SAFETY: as above.
                #[cfg(target_arch = "x86_64")]
                $crate::wide::Width::Avx512 | $crate::wide::Width::Avx512Vbmi2 => unsafe { avx512($($arg),*) },
                _ => plain($($arg),*),
            }
        }
    };
}
pub(crate) use wide;
