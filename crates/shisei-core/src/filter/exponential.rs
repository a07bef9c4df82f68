//! The exact turn for a constant rate, and a renormalisation without square root or division.
//!
//! With h = ½ ω dt the turn is `exp(h) = (cos |h|, h sin|h|/|h|)`. For |h|² < 0.25 (1 rad a sample) both
//! are polynomials in |h|²: the Taylor series up to |h|¹⁴, whose first left-out terms are below 1e-18 there;
//! beyond, the maths doorway. A unit quaternion that is off by rounding, |q|² = 1 + δ, is mended by the
//! factor 1.5 − 0.5 |q|², which is right to 0.4 δ² (1e-31).

use crate::math;
use crate::quaternion::Quaternion;
use crate::vector::{self, Vec3};

/// |h|² from which on sine and cosine come from the maths doorway.
pub const POLYNOMIAL_LIMIT: f64 = 0.25;

/// (−1)ᵏ/(2k)!
const COS: [f64; 8] = [
    1.0,
    -1.0 / 2.0,
    1.0 / 24.0,
    -1.0 / 720.0,
    1.0 / 40_320.0,
    -1.0 / 3_628_800.0,
    1.0 / 479_001_600.0,
    -1.0 / 87_178_291_200.0,
];

/// (−1)ᵏ/(2k + 1)!
const SINC: [f64; 8] = [
    1.0,
    -1.0 / 6.0,
    1.0 / 120.0,
    -1.0 / 5_040.0,
    1.0 / 362_880.0,
    -1.0 / 39_916_800.0,
    1.0 / 6_227_020_800.0,
    -1.0 / 1_307_674_368_000.0,
];

/// cos |h| and sin|h|/|h| from x = |h|² < 0.25, in Estrin's order: three levels instead of seven.
#[inline(always)]
pub fn cos_sinc(x: f64) -> (f64, f64) {
    let x2 = x * x;
    let x4 = x2 * x2;
    let poly = |c: &[f64; 8]| {
        let low = (c[0] + c[1] * x) + (c[2] + c[3] * x) * x2;
        let high = (c[4] + c[5] * x) + (c[6] + c[7] * x) * x2;
        low + high * x4
    };
    (poly(&COS), poly(&SINC))
}

/// `(c, s, h)` with exp(h₀) = (c, s h). The turn of an h₀ that is not finite is none.
#[inline(always)]
pub(crate) fn turn(h: Vec3) -> (f64, f64, Vec3) {
    let x = vector::dot(h, h);
    if x < POLYNOMIAL_LIMIT {
        let (c, s) = cos_sinc(x);
        (c, s, h)
    } else {
        large_turn(h)
    }
}

#[cold]
fn large_turn(h: Vec3) -> (f64, f64, Vec3) {
    let none = (1.0, 1.0, [0.0; 3]);
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
    (cos, 1.0, vector::scale(unscaled, sin / length))
}

/// exp(h), h = half the rotation vector; of unit norm to rounding. No turn where h is not finite.
#[inline]
pub fn exp_half(h: Vec3) -> Quaternion {
    let (c, s, h) = turn(h);
    Quaternion::new(c, s * h[0], s * h[1], s * h[2])
}

/// `q ⊗ exp(h)`, renormalised. The factor is computed from q while the polynomials are under way, so that
/// the only chain from q to the result is the product.
#[inline(always)]
pub(crate) fn advance(q: Quaternion, h: Vec3) -> Quaternion {
    advance_by(q, turn(h))
}

/// [`advance`] by what [`turn`] gives.
#[inline(always)]
pub(super) fn advance_by(q: Quaternion, (c, s, h): (f64, f64, Vec3)) -> Quaternion {
    let r = 1.5 - 0.5 * q.norm_squared();
    let (w, x, y, z) = (q.w * r, q.x * r, q.y * r, q.z * r);
    // p ⊗ (0, h), beside the polynomials
    let uw = -(x * h[0] + y * h[1] + z * h[2]);
    let ux = w * h[0] + y * h[2] - z * h[1];
    let uy = w * h[1] + z * h[0] - x * h[2];
    let uz = w * h[2] + x * h[1] - y * h[0];
    Quaternion::new(w * c + uw * s, x * c + ux * s, y * c + uy * s, z * c + uz * s)
}

/// Direction and length of a vector without over- or underflow; the direction is zero where the vector is
/// zero or not finite.
#[inline(always)]
pub(crate) fn direction(a: Vec3) -> (Vec3, f64) {
    let square = vector::dot(a, a);
    if is_ordinary(square) { ordinary_direction(a, square) } else { extreme_direction(a) }
}

/// Whether a square is that of a finite vector, and its root good to the last bit.
#[inline(always)]
#[allow(clippy::needless_bitwise_bool)] // no branch, so that compilers take several at once
pub(crate) fn is_ordinary(square: f64) -> bool {
    (square > 1e-200) & (square < 1e200)
}

/// [`direction`] of a vector whose square [is ordinary](is_ordinary).
#[inline(always)]
pub(crate) fn ordinary_direction(a: Vec3, square: f64) -> (Vec3, f64) {
    let length = math::sqrt(square);
    (vector::scale(a, 1.0 / length), length)
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
