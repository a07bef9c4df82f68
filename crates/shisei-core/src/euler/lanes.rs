//! Several attitudes to yaw, pitch and roll at once: no branches, so that compilers take them side by side.
//!
//! One attitude alone goes the same way, so that a row's bits do not depend on how many are asked for.

use core::array;
use core::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI, TAU};

use super::GIMBAL_LOCK_COS;
use crate::math;
use crate::quaternion::Quaternion;

/// Attitudes taken together in a series.
pub(crate) const LANES: usize = 4;

/// tan(π/8): up to here the polynomial goes.
const TAN_PI_8: f64 = 0.41421356237309503;

/// (atan t − t)/t³ as a polynomial in t², fitted at Chebyshev points over 0 ≤ t ≤ tan(π/8); it is right to 2e-17
/// there.
const ARCTANGENT: [f64; 12] = [
    -0.33333333333333304,
    0.1999999999998446,
    -0.14285714283334022,
    0.11111110942473049,
    -0.09090902431886747,
    0.07692146306604492,
    -0.06664137183983336,
    0.05856070059267024,
    -0.050815410000958405,
    0.03942490403205619,
    -0.020369454265471636,
    0.0018902934535572071,
];

/// Yaw, pitch and roll of unit quaternions, `[yaw, pitch, roll]` a row, rad.
#[inline(always)]
pub(super) fn ypr<const N: usize>(q: &[Quaternion; N]) -> [[f64; 3]; N] {
    let half_sum: [_; N] = array::from_fn(|i| [q[i].z + q[i].x, q[i].w - q[i].y]);
    let half_difference: [_; N] = array::from_fn(|i| [q[i].z - q[i].x, q[i].w + q[i].y]);
    let sine: [_; N] = array::from_fn(|i| 2.0 * (q[i].w * q[i].y - q[i].x * q[i].z));
    // The squares of the two half angles' points are 1 ∓ sin(pitch): their product is cos²(pitch), with all its
    // digits near ±π/2.
    let square = |p: [f64; 2]| p[0] * p[0] + p[1] * p[1];
    let cosine: [_; N] = array::from_fn(|i| math::sqrt(square(half_sum[i]) * square(half_difference[i])));
    let pitch: [f64; N] = atan2(array::from_fn(|i| [sine[i], cosine[i]]));
    let (sum, difference): ([f64; N], [f64; N]) = (atan2(half_sum), atan2(half_difference));
    array::from_fn(|i| {
        // Gimbal lock. Nose up: only yaw − roll is determined; nose down: only yaw + roll.
        let locked = cosine[i] < GIMBAL_LOCK_COS;
        let half = either(sine[i] > 0.0, difference[i], sum[i]);
        let yaw = wrapped(either(locked, 2.0 * half, sum[i] + difference[i]));
        let roll = either(locked, 0.0, wrapped(sum[i] - difference[i]));
        [yaw, pitch[i], roll]
    })
}

#[inline(always)]
fn either(which: bool, yes: f64, no: f64) -> f64 {
    if which { yes } else { no }
}

/// −2π … 2π to −π … π.
#[inline(always)]
fn wrapped(angle_rad: f64) -> f64 {
    let down = either(angle_rad > PI, angle_rad - TAU, angle_rad);
    either(angle_rad < -PI, angle_rad + TAU, down)
}

/// Angles of the points `[y, x]`, rad in −π … π; 0 of the origin. Within 1e-15 rad.
#[inline(always)]
fn atan2<const N: usize>(point: [[f64; 2]; N]) -> [f64; N] {
    array::from_fn(|i| {
        let [y, x] = point[i];
        let (above, beside) = (math::abs(y), math::abs(x));
        // The angle to the nearer axis, 0 … π/4, and beyond π/8 what it lacks to π/4.
        let steep = above > beside;
        let (low, high) = (either(steep, beside, above), either(steep, above, beside));
        let far = low > TAN_PI_8 * high;
        let top = either(far, low - high, low);
        let bottom = either(far, low + high, high);
        let t = top / either(bottom > 0.0, bottom, 1.0);
        let u = t * t;
        let near = t + t * u * polynomial(u);
        let near = either(far, FRAC_PI_4 + near, near);
        let right = either(steep, FRAC_PI_2 - near, near);
        either(x < 0.0, PI - right, right).copysign(y)
    })
}

/// In Estrin's order.
#[inline(always)]
fn polynomial(u: f64) -> f64 {
    let c = &ARCTANGENT;
    let u2 = u * u;
    let u4 = u2 * u2;
    let u8 = u4 * u4;
    let low = (c[0] + c[1] * u) + (c[2] + c[3] * u) * u2;
    let middle = (c[4] + c[5] * u) + (c[6] + c[7] * u) * u2;
    let high = (c[8] + c[9] * u) + (c[10] + c[11] * u) * u2;
    (low + middle * u4) + high * u8
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against libm's, which is right to 1 ulp, over all directions and close to the axes.
    #[test]
    fn atan2_of_all_directions() {
        let mut worst: f64 = 0.0;
        let mut check = |y: f64, x: f64| {
            let [got] = atan2([[y, x]]);
            worst = worst.max((got - math::atan2(y, x)).abs());
        };
        for k in 0..400_000 {
            let angle = f64::from(k) * (TAU / 400_000.0) - PI;
            let (s, c) = math::sin_cos(angle);
            let size = 1.0 + f64::from(k % 7);
            check(s * size, c * size);
            check(s * 1e-9, c * size);
            check(s * size, c * 1e-9);
        }
        assert!(worst <= 1e-15, "{worst:e}");
        for (y, x) in [(0.0, 1.0), (-0.0, 1.0), (0.0, 0.0), (-0.0, 0.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0)]
        {
            assert_eq!(atan2([[y, x]])[0].to_bits(), math::atan2(y, x).to_bits(), "{y} {x}");
        }
    }
}
