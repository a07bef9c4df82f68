//! The exact turn for a constant rate, and a renormalisation without square root or division.
//!
//! With h = ½ ω dt the turn is `exp(h) = (cos |h|, h sin|h|/|h|)`. For |h|² < 0.25 (1 rad a sample) both
//! are polynomials in |h|², 1 at zero and right to 3e-17; beyond, the maths doorway. A unit quaternion that is off by
//! rounding, |q|² = 1 + δ, is mended by the factor r = 1.5 − 0.5 |q|², which is right to 0.4 δ² (1e-31). It takes the
//! place of the polynomials' 1: of the rest, which is below 0.13, it would change less than 1e-17.

use crate::lanes::Number;
use crate::math;
use crate::quaternion::Quaternion;
use crate::vector::{self, Vec3};

/// |h|² from which on sine and cosine come from the maths doorway.
pub const POLYNOMIAL_LIMIT: f64 = 0.25;

/// (cos √x − 1)/x as a polynomial in x, fitted at Chebyshev points over 0 ≤ x ≤ 0.25.
const COS: [f64; 6] = [
    -0.5,
    0.041666666666666276,
    -0.0013888888888705666,
    2.4801586988836374e-05,
    -2.7557077887523167e-07,
    2.0790894217124703e-09,
];

/// (sin √x/√x − 1)/x, fitted so that x times its error is least.
const SINC: [f64; 5] = [
    -0.1666666666666628,
    0.008333333333114734,
    -0.00019841269438726467,
    2.7556995673807836e-06,
    -2.4934013608591106e-08,
];

/// cos |h| and sin|h|/|h| from x = |h|² < 0.25.
#[inline(always)]
pub fn cos_sinc(x: f64) -> (f64, f64) {
    polynomials(1.0, x)
}

/// [`cos_sinc`] times r, in Estrin's order: three levels instead of six.
#[inline(always)]
pub(super) fn polynomials<T: Number>(r: T, x: T) -> (T, T) {
    let x2 = x * x;
    let x4 = x2 * x2;
    let c = COS.map(T::of);
    let s = SINC.map(T::of);
    let cos = ((r + c[0] * x) + (c[1] + c[2] * x) * x2) + ((c[3] + c[4] * x) + c[5] * x2) * x4;
    let sinc = ((r + s[0] * x) + (s[1] + s[2] * x) * x2) + (s[3] + s[4] * x) * x4;
    (cos, sinc)
}

/// r.
#[inline(always)]
pub(super) fn correction<T: Number>([w, x, y, z]: [T; 4]) -> T {
    T::of(1.5) - T::of(0.5) * ((w * w + z * z) + (x * x + y * y))
}

/// `(c, s, h)` with r exp(h₀) = (c, s h). The turn of an h₀ that is not finite is none.
#[inline(always)]
fn turn(r: f64, h: Vec3) -> (f64, f64, Vec3) {
    let x = vector::dot(h, h);
    if x < POLYNOMIAL_LIMIT {
        let (c, s) = polynomials(r, x);
        (c, s, h)
    } else {
        let (cos, h) = large_turn(h);
        (r * cos, r, h)
    }
}

/// (cos |h|, h sin|h|/|h|).
#[cold]
fn large_turn(h: Vec3) -> (f64, Vec3) {
    let none = (1.0, [0.0; 3]);
    let largest = h[0].abs().max(h[1].abs()).max(h[2].abs());
    if !vector::is_finite(h) || largest == 0.0 {
        return none;
    }
    // scaled, so that no square overflows
    let unscaled = [h[0] / largest, h[1] / largest, h[2] / largest];
    let length = vector::norm(unscaled);
    let angle = length * largest;
    if !angle.is_finite() {
        return none;
    }
    let (sin, cos) = math::sin_cos(angle);
    (cos, vector::scale(unscaled, sin / length))
}

/// exp(h), h = half the rotation vector; of unit norm to rounding. No turn where h is not finite.
#[inline]
pub fn exp_half(h: Vec3) -> Quaternion {
    let (c, s, h) = turn(1.0, h);
    Quaternion::new(c, s * h[0], s * h[1], s * h[2])
}

/// `q ⊗ exp(h)`, renormalised. The factor is computed from q while h is under way, so that it adds nothing to the
/// chain from q to the result.
#[inline(always)]
pub(crate) fn advance(q: Quaternion, h: Vec3) -> Quaternion {
    let q = q.to_array();
    let (c, s, h) = turn(correction(q), h);
    Quaternion::from_array(turned(q, c, s, h))
}

/// `q ⊗ (c, s h)`; q ⊗ (0, h) beside the polynomials.
#[inline(always)]
pub(super) fn turned<T: Number>([w, x, y, z]: [T; 4], c: T, s: T, h: [T; 3]) -> [T; 4] {
    let minus_uw = (x * h[0] + y * h[1]) + z * h[2];
    let ux = (w * h[0] + y * h[2]) - z * h[1];
    let uy = (w * h[1] + z * h[0]) - x * h[2];
    let uz = (w * h[2] + x * h[1]) - y * h[0];
    [w * c - minus_uw * s, x * c + ux * s, y * c + uy * s, z * c + uz * s]
}

/// Direction and length of a vector without over- or underflow; the direction is zero where the vector is
/// zero or not finite.
#[inline(always)]
pub(super) fn direction(a: Vec3) -> (Vec3, f64) {
    let (b, length, norm) = sized(a);
    (vector::scale(b, 1.0 / length), norm)
}

/// `(b, |b|, |a|)` with b in the direction of a and of a size that can be squared; b and |a| are zero where a is zero or
/// not finite.
#[inline(always)]
pub(super) fn sized(a: Vec3) -> (Vec3, f64, f64) {
    let square = vector::dot(a, a);
    if is_ordinary(square) {
        let length = math::sqrt(square);
        (a, length, length)
    } else {
        let (unit, length) = extreme_direction(a);
        (unit, 1.0, length)
    }
}

/// Whether a square is that of a finite vector, and its root good to the last bit.
#[inline(always)]
#[allow(clippy::needless_bitwise_bool)] // no branch, so that compilers take several at once
pub(super) fn is_ordinary<T: Number>(square: T) -> bool {
    T::of(1e-200).below(square) & square.below(T::of(1e200))
}

#[cold]
fn extreme_direction(a: Vec3) -> (Vec3, f64) {
    let largest = a[0].abs().max(a[1].abs()).max(a[2].abs());
    if !vector::is_finite(a) || largest == 0.0 {
        return ([0.0; 3], 0.0);
    }
    let b = [a[0] / largest, a[1] / largest, a[2] / largest];
    let length = vector::norm(b);
    ([b[0] / length, b[1] / length, b[2] / length], length * largest)
}
