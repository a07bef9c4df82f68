//! The discrete Fourier transform of 2ⁿ complex numbers: X_k = Σ x_j exp(∓2πi jk/N).
//!
//! Radix 2, in place, decimation in time. Source: J. W. Cooley, J. W. Tukey, Math. Comp. 19, 297 (1965).

use alloc::vec::Vec;

use crate::error::{Error, Result};
use crate::math;

/// Real and imaginary part.
pub type Complex = [f64; 2];

/// a b.
#[inline]
pub fn times(a: Complex, b: Complex) -> Complex {
    [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]]
}

/// A transform of one length, with its roots of unity.
#[derive(Clone, Debug)]
pub struct Fourier {
    /// exp(−2πi k/N) for k < N/2.
    roots: Vec<Complex>,
    length: usize,
}

impl Fourier {
    /// Of the least power of two that is not below `length`; refused when `length` is 0 or above 2²⁸.
    pub fn new(length: usize) -> Result<Self> {
        if length == 0 {
            return Err(Error::Empty);
        }
        if length > 1 << 28 {
            return Err(Error::OutOfRange { rule: "length <= 2^28", value: length as f64 });
        }
        let length = length.next_power_of_two();
        let turn = -2.0 * core::f64::consts::PI / length as f64;
        let root = |k: usize| {
            let (sin, cos) = math::sin_cos(turn * k as f64);
            [cos, sin]
        };
        Ok(Fourier { roots: (0..length / 2).map(root).collect(), length })
    }

    /// Numbers it transforms.
    pub fn len(&self) -> usize {
        self.length
    }

    /// Never true.
    pub fn is_empty(&self) -> bool {
        self.length == 0
    }

    /// Transforms in place. Refused: another length than [`Fourier::len`].
    pub fn forward(&self, x: &mut [Complex]) -> Result<()> {
        let n = self.length;
        if x.len() != n {
            return Err(Error::LengthMismatch { first: n, second: x.len() });
        }
        let mut j = 0;
        for i in 1..n {
            let mut bit = n >> 1;
            while j & bit != 0 {
                j ^= bit;
                bit >>= 1;
            }
            j |= bit;
            if i < j {
                x.swap(i, j);
            }
        }
        let mut half = 1;
        while half < n {
            let stride = n / (2 * half);
            for block in x.chunks_exact_mut(2 * half) {
                let (low, high) = block.split_at_mut(half);
                for (k, (a, b)) in low.iter_mut().zip(high).enumerate() {
                    let t = times(*b, self.roots[k * stride]);
                    *b = [a[0] - t[0], a[1] - t[1]];
                    *a = [a[0] + t[0], a[1] + t[1]];
                }
            }
            half *= 2;
        }
        Ok(())
    }

    /// The inverse, divided by N.
    pub fn inverse(&self, x: &mut [Complex]) -> Result<()> {
        for value in x.iter_mut() {
            value[1] = -value[1];
        }
        self.forward(x)?;
        let scale = 1.0 / self.length as f64;
        for value in x.iter_mut() {
            *value = [value[0] * scale, -value[1] * scale];
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By the definition.
    fn slow(x: &[Complex]) -> Vec<Complex> {
        let n = x.len();
        (0..n)
            .map(|k| {
                x.iter().enumerate().fold([0.0; 2], |sum, (j, value)| {
                    let angle = -2.0 * core::f64::consts::PI * ((j * k) % n) as f64 / n as f64;
                    let (sin, cos) = math::sin_cos(angle);
                    let term = times(*value, [cos, sin]);
                    [sum[0] + term[0], sum[1] + term[1]]
                })
            })
            .collect()
    }

    #[test]
    fn equals_the_definition_and_returns() {
        let fourier = Fourier::new(50).unwrap();
        assert_eq!(fourier.len(), 64);
        let x: Vec<Complex> = (0..64).map(|j| [f64::from(j * j % 17), f64::from(j % 5) - 2.0]).collect();
        let mut y = x.clone();
        fourier.forward(&mut y).unwrap();
        let near = |a: &[Complex], b: &[Complex]| {
            a.iter().zip(b).all(|(a, b)| (a[0] - b[0]).abs() < 1e-11 && (a[1] - b[1]).abs() < 1e-11)
        };
        assert!(near(&y, &slow(&x)));
        fourier.inverse(&mut y).unwrap();
        assert!(near(&y, &x));
        assert!(fourier.forward(&mut y[1..]).is_err() && Fourier::new(0).is_err());
    }
}
