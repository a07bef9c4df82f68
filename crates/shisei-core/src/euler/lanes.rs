//! Attitudes to yaw, pitch and roll without branches, so that compilers take several side by side.
//!
//! One attitude alone goes the same way, so that a row's bits do not depend on how many are asked for.

use core::array::from_fn;
use core::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI, TAU};

use super::GIMBAL_LOCK_COS;
use crate::math;
use crate::quaternion::Quaternion;

/// Attitudes taken together in a series: a few kilobytes, which stay in the nearest cache.
pub(crate) const BLOCK: usize = 64;

/// Attitudes with every component by itself, as vectors of processors take them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Components {
    pub(crate) w: [f64; BLOCK],
    pub(crate) x: [f64; BLOCK],
    pub(crate) y: [f64; BLOCK],
    pub(crate) z: [f64; BLOCK],
}

impl Components {
    pub(crate) const IDENTITY: Components =
        Components { w: [1.0; BLOCK], x: [0.0; BLOCK], y: [0.0; BLOCK], z: [0.0; BLOCK] };

    #[inline(always)]
    pub(crate) fn at(&self, i: usize) -> Quaternion {
        Quaternion::new(self.w[i], self.x[i], self.y[i], self.z[i])
    }

    #[inline(always)]
    pub(crate) fn set(&mut self, i: usize, q: Quaternion) {
        [self.w[i], self.x[i], self.y[i], self.z[i]] = q.to_array();
    }

    /// Yaw, pitch and roll of unit quaternions, rad, each by itself.
    #[inline(always)]
    pub(crate) fn ypr(&self) -> [[f64; BLOCK]; 3] {
        let [mut yaw, mut pitch, mut roll] = [[0.0; BLOCK]; 3];
        for i in 0..BLOCK {
            [yaw[i], pitch[i], roll[i]] = ypr(self.at(i));
        }
        [yaw, pitch, roll]
    }
}

/// tan(π/8): up to here the polynomial goes.
const TAN_PI_8: f64 = 0.41421356237309503;

/// (atan t − t)/t³ as a polynomial in t², fitted at Chebyshev points over 0 ≤ t ≤ tan(π/8); the arctangent is right to
/// 6e-17 there.
const ARCTANGENT: [f64; 10] = [
    -0.3333333333333325,
    0.19999999999898407,
    -0.1428571426609662,
    0.11111109636534361,
    -0.09090852557176049,
    0.0769105515839315,
    -0.06649613695291669,
    0.05736332165907643,
    -0.04483334622272886,
    0.02275052699336167,
];

/// `[yaw, pitch, roll]` of unit quaternions given by their components, rad.
#[inline(always)]
pub(crate) fn ypr_lanes<const N: usize>(
    w: &[f64; N],
    x: &[f64; N],
    y: &[f64; N],
    z: &[f64; N],
) -> [[f64; 3]; N] {
    let mut out = [[0.0; 3]; N];
    for i in 0..N {
        out[i] = ypr(Quaternion::new(w[i], x[i], y[i], z[i]));
    }
    out
}

/// `[yaw, pitch, roll]` of a unit quaternion, rad.
#[inline(always)]
pub(super) fn ypr(q: Quaternion) -> [f64; 3] {
    let [w, x, y, z] = q.to_array();
    let [sum_y, sum_x] = [z + x, w - y];
    let [difference_y, difference_x] = [z - x, w + y];
    let sine = 2.0 * (w * y - x * z);
    // The squares of the two half angles' points are 1 ∓ sin(pitch): their product is cos²(pitch), with all its
    // digits near ±π/2.
    let low = sum_y * sum_y + sum_x * sum_x;
    let high = difference_y * difference_y + difference_x * difference_x;
    let cosine = math::sqrt(low * high);
    let [sum, difference, pitch] = atan2([sum_y, difference_y, sine], [sum_x, difference_x, cosine]);
    // Gimbal lock. Nose up: only yaw − roll is determined; nose down: only yaw + roll.
    let locked = cosine < GIMBAL_LOCK_COS;
    let half = either(sine > 0.0, difference, sum);
    let yaw = wrapped(either(locked, 2.0 * half, sum + difference));
    let roll = either(locked, 0.0, wrapped(sum - difference));
    [yaw, pitch, roll]
}

#[inline(always)]
fn either(which: bool, yes: f64, no: f64) -> f64 {
    if which { yes } else { no }
}

/// −2π … 2π to −π … π.
#[inline(always)]
fn wrapped(angle_rad: f64) -> f64 {
    (angle_rad - either(angle_rad > PI, TAU, 0.0)) + either(angle_rad < -PI, TAU, 0.0)
}

/// Angles of the points (x, y), rad in −π … π; 0 of the origin. Within 1e-15 rad.
///
/// All of them a step at a time, so that none waits for another.
#[inline(always)]
fn atan2<const N: usize>(y: [f64; N], x: [f64; N]) -> [f64; N] {
    let (above, beside) = (y.map(math::abs), x.map(math::abs));
    // The angle to the nearer axis, 0 … π/4, and beyond π/8 what it lacks to π/4.
    let low: [f64; N] = from_fn(|i| either(above[i] < beside[i], above[i], beside[i]));
    let high: [f64; N] = from_fn(|i| either(above[i] > beside[i], above[i], beside[i]));
    let far: [bool; N] = from_fn(|i| low[i] > TAN_PI_8 * high[i]);
    let top: [f64; N] = from_fn(|i| low[i] - either(far[i], high[i], 0.0));
    let bottom: [f64; N] = from_fn(|i| high[i] + either(far[i], low[i], 0.0));
    let t: [f64; N] = from_fn(|i| top[i] / (bottom[i] + f64::MIN_POSITIVE));
    let u = t.map(|t| t * t);
    let polynomial = polynomial(u);
    from_fn(|i| {
        let near = (t[i] + t[i] * u[i] * polynomial[i]) + either(far[i], FRAC_PI_4, 0.0);
        let right = either(above[i] > beside[i], FRAC_PI_2 - near, near);
        either(x[i] < 0.0, PI - right, right).copysign(y[i])
    })
}

/// In Estrin's order.
#[inline(always)]
fn polynomial<const N: usize>(u: [f64; N]) -> [f64; N] {
    let c = &ARCTANGENT;
    let u2 = u.map(|u| u * u);
    let u4 = u2.map(|u2| u2 * u2);
    let u8 = u4.map(|u4| u4 * u4);
    let low: [f64; N] = from_fn(|i| (c[0] + c[1] * u[i]) + (c[2] + c[3] * u[i]) * u2[i]);
    let middle: [f64; N] = from_fn(|i| (c[4] + c[5] * u[i]) + (c[6] + c[7] * u[i]) * u2[i]);
    let high: [f64; N] = from_fn(|i| c[8] + c[9] * u[i]);
    from_fn(|i| (low[i] + middle[i] * u4[i]) + high[i] * u8[i])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against libm's, which is right to 1 ulp, over all directions and close to the axes.
    #[test]
    fn atan2_of_all_directions() {
        let mut worst: f64 = 0.0;
        let mut check = |y: f64, x: f64| {
            let [got] = atan2([y], [x]);
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
            assert_eq!(atan2([y], [x])[0].to_bits(), math::atan2(y, x).to_bits(), "{y} {x}");
        }
    }
}
