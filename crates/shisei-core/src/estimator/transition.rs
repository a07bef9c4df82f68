//! The transition Φ of the error states over an interval, and its products with matrices of N rows.
//!
//! Only attitude, velocity and position move; with the sums of the interval
//!
//! ```text
//! turn = A bg + AM M          push = B ba + Bs s
//! φ ← φ + turn
//! v ← v + push − [F]× (φ + turn/2)
//! p ← (p + T v)(1 − T/τp) + push T/2 − [F]× (φ T/2 + turn T/6)
//! ```
//!
//! Written so, a product with Φ takes half the work of the nine rows of Φ multiplied out, zeros left out.

use super::model::{BA, BG, Interval, MG, MOVING, PHI, POS, SA, VEL};
use crate::vector::Vec3;

/// Rows that belong to the three axes of a vector.
pub(super) type Three<const W: usize> = [[f64; W]; 3];

/// Φ of an interval.
#[derive(Clone, Copy, Debug)]
pub(super) struct Transition {
    by_bias: [Vec3; 3],
    by_matrix: [[Vec3; 3]; 3],
    by_acc_bias: [Vec3; 3],
    by_scale: [Vec3; 3],
    force: Vec3,
    time_s: f64,
    /// The share of the position that is kept, 1 − T/τp.
    keep: f64,
}

/// `out += m x`. Kept out of line: unrolled into its callers it would not fit into a processor's nearest cache.
#[inline(never)]
pub(super) fn add_product<const W: usize>(out: &mut Three<W>, m: &[Vec3; 3], x: &Three<W>) {
    for k in 0..W {
        for j in 0..3 {
            out[j][k] += (m[j][0] * x[0][k] + m[j][1] * x[1][k]) + m[j][2] * x[2][k];
        }
    }
}

fn transposed(m: &[Vec3; 3]) -> [Vec3; 3] {
    [[m[0][0], m[1][0], m[2][0]], [m[0][1], m[1][1], m[2][1]], [m[0][2], m[1][2], m[2][2]]]
}

/// The three rows of x from `first`, a multiple of three, on.
#[inline(always)]
pub(super) fn three<const N: usize, const W: usize>(x: &[[f64; W]; N], first: usize) -> &Three<W> {
    &x.as_chunks::<3>().0[first / 3]
}

#[inline(always)]
pub(super) fn three_mut<const N: usize, const W: usize>(
    x: &mut [[f64; W]; N],
    first: usize,
) -> &mut Three<W> {
    &mut x.as_chunks_mut::<3>().0[first / 3]
}

/// `out += factor · [f]× x`.
#[inline(never)]
fn add_cross<const W: usize>(out: &mut Three<W>, f: Vec3, factor: f64, x: &Three<W>) {
    let f = [f[0] * factor, f[1] * factor, f[2] * factor];
    for k in 0..W {
        out[0][k] += f[1] * x[2][k] - f[2] * x[1][k];
        out[1][k] += f[2] * x[0][k] - f[0] * x[2][k];
        out[2][k] += f[0] * x[1][k] - f[1] * x[0][k];
    }
}

/// `out = a x + b y`.
#[inline(never)]
fn mix<const W: usize>(out: &mut Three<W>, a: f64, x: &Three<W>, b: f64, y: &Three<W>) {
    for j in 0..3 {
        for k in 0..W {
            out[j][k] = a * x[j][k] + b * y[j][k];
        }
    }
}

impl Transition {
    /// Over an interval in which a share `keep` of the position is kept.
    pub(super) fn new(sums: &Interval, keep: f64) -> Self {
        Transition {
            by_bias: sums.attitude_by_bias,
            by_matrix: sums.attitude_by_matrix,
            by_acc_bias: sums.velocity_by_bias,
            by_scale: sums.velocity_by_scale,
            force: sums.force,
            time_s: sums.time_s,
            keep,
        }
    }

    /// Nothing moves.
    pub(super) fn none() -> Self {
        Transition::new(&Interval::default(), 1.0)
    }

    /// The moving rows of Φ x.
    pub(super) fn moved<const N: usize, const W: usize>(&self, x: &[[f64; W]; N]) -> [[f64; W]; MOVING] {
        let t = self.time_s;
        let mut turn = [[0.0; W]; 3];
        add_product(&mut turn, &self.by_bias, three(x, BG));
        for (l, m) in self.by_matrix.iter().enumerate() {
            add_product(&mut turn, m, three(x, MG + 3 * l));
        }
        let mut push = [[0.0; W]; 3];
        add_product(&mut push, &self.by_acc_bias, three(x, BA));
        add_product(&mut push, &self.by_scale, three(x, SA));
        let (phi, v, p) = (three(x, PHI), three(x, VEL), three(x, POS));
        let mut out = [[0.0; W]; MOVING];
        let mut leant = [[0.0; W]; 3];
        mix(three_mut(&mut out, PHI), 1.0, phi, 1.0, &turn);
        mix(three_mut(&mut out, VEL), 1.0, v, 1.0, &push);
        mix(&mut leant, 1.0, phi, 0.5, &turn);
        add_cross(three_mut(&mut out, VEL), self.force, -1.0, &leant);
        mix(three_mut(&mut out, POS), self.keep, p, t * self.keep, v);
        mix(&mut leant, 0.5, phi, 1.0 / 6.0, &turn);
        add_cross(three_mut(&mut out, POS), self.force, -t, &leant);
        for (out, push) in three_mut(&mut out, POS).iter_mut().zip(&push) {
            for k in 0..W {
                out[k] += 0.5 * t * push[k];
            }
        }
        out
    }

    /// `x ← Φᵀ x`.
    pub(super) fn back<const N: usize, const W: usize>(&self, x: &mut [[f64; W]; N]) {
        let t = self.time_s;
        let (v, p) = (three(x, VEL), three(x, POS));
        let (mut push, mut leant, mut velocity) = ([[0.0; W]; 3], [[0.0; W]; 3], [[0.0; W]; 3]);
        mix(&mut push, 1.0, v, 0.5 * t, p);
        mix(&mut leant, 0.5, v, t / 6.0, p);
        mix(&mut velocity, 1.0, v, t * self.keep, p);
        let mut turn = *three(x, PHI);
        add_cross(&mut turn, self.force, 1.0, &leant);
        add_product(three_mut(x, BG), &transposed(&self.by_bias), &turn);
        for (l, m) in self.by_matrix.iter().enumerate() {
            add_product(three_mut(x, MG + 3 * l), &transposed(m), &turn);
        }
        add_product(three_mut(x, BA), &transposed(&self.by_acc_bias), &push);
        add_product(three_mut(x, SA), &transposed(&self.by_scale), &push);
        add_cross(three_mut(x, PHI), self.force, 1.0, &push);
        *three_mut(x, VEL) = velocity;
        if self.keep != 1.0 {
            for row in three_mut(x, POS) {
                *row = row.map(|value| self.keep * value);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::model::STATES;
    use super::*;

    fn interval() -> Interval {
        let mut k = 0.0;
        let mut next = || {
            k += 1.0;
            crate::math::sin(k)
        };
        let mut three = || [[next(), next(), next()], [next(), next(), next()], [next(), next(), next()]];
        Interval {
            attitude_by_bias: three(),
            attitude_by_matrix: [three(), three(), three()],
            velocity_by_bias: three(),
            velocity_by_scale: three(),
            force: [0.3, -0.2, 0.7],
            time_s: 0.07,
            ..Interval::default()
        }
    }

    /// The rows of Φ by the equations above, one error state at a time.
    fn by_hand(sums: &Interval, keep: f64, x: &[f64; STATES]) -> [f64; MOVING] {
        use crate::vector::{add, cross, dot, scale, sub};
        let at = |first: usize| [x[first], x[first + 1], x[first + 2]];
        let times = |m: &[Vec3; 3], v: Vec3| [dot(m[0], v), dot(m[1], v), dot(m[2], v)];
        let mut turn = times(&sums.attitude_by_bias, at(BG));
        for l in 0..3 {
            turn = add(turn, times(&sums.attitude_by_matrix[l], at(MG + 3 * l)));
        }
        let push = add(times(&sums.velocity_by_bias, at(BA)), times(&sums.velocity_by_scale, at(SA)));
        let (phi, v, p, t) = (at(PHI), at(VEL), at(POS), sums.time_s);
        let velocity = sub(add(v, push), cross(sums.force, add(phi, scale(turn, 0.5))));
        let place = add(scale(add(p, scale(v, t)), keep), scale(push, 0.5 * t));
        let leant = cross(sums.force, add(scale(phi, 0.5 * t), scale(turn, t / 6.0)));
        let (a, b, c) = (add(phi, turn), velocity, sub(place, leant));
        [a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2]]
    }

    #[test]
    fn products_with_the_transition_are_those_of_its_equations() {
        let sums = interval();
        let transition = Transition::new(&sums, 0.9);
        let mut unit = [[0.0; STATES]; STATES];
        for k in 0..STATES {
            unit[k][k] = 1.0;
        }
        let moved = transition.moved(&unit);
        let mut transposed = unit;
        transition.back(&mut transposed);
        for (k, x) in unit.iter().enumerate() {
            let expected = by_hand(&sums, 0.9, x);
            for j in 0..MOVING {
                assert!((moved[j][k] - expected[j]).abs() < 1e-15, "{j} {k}");
                assert!((transposed[k][j] - expected[j]).abs() < 1e-15, "{j} {k}");
            }
            for j in MOVING..STATES {
                assert_eq!(transposed[k][j], unit[k][j]);
            }
        }
    }
}
