//! The rate between two samples that do not meet: lost ones, and steps that are longer or shorter than usual.
//!
//! A sample is the mean rate over the usual step before it. Samples that are late leave a time that none stands for;
//! samples that are early stand for some time twice. The mean over such a time is foretold from the means around it as
//! from a random course of known smoothness and unknown mean: ordinary kriging (N. Cressie, "Statistics for Spatial
//! Data", 1993, section 3.2). With C the covariance of the nodes, c theirs with the hole, y their rates and 1 ones,
//!
//! ```text
//! m = 1ᵀC⁻¹y / 1ᵀC⁻¹1      rate = m + cᵀC⁻¹(y − m 1)
//! variance = s² (c₀ − cᵀC⁻¹c + (1 − 1ᵀC⁻¹c)² / 1ᵀC⁻¹1)      s² = (y − m 1)ᵀC⁻¹(y − m 1) / (n − 1)
//! ```
//!
//! The covariance is H. Wendland's compactly supported function of smoothness 6 ("Piecewise polynomial, positive definite
//! and compactly supported radial functions of minimal degree", Adv. Comput. Math. 4 (1995)).

use crate::math;
use crate::vector::Vec3;

/// Samples on each side.
const SIDE: usize = 5;
const NODES: usize = 2 * SIDE;
/// Samples after the newest that are of use.
pub(super) const AHEAD: usize = SIDE - 1;
/// The same where the time is only part of a step.
const AHEAD_OF_PART: usize = 2;
/// From this part of the usual step on samples are lost, not only late.
const LOST: f64 = 0.5;
/// A hole up to this part of the usual step is so short that its two neighbours tell enough.
const SHORT: f64 = 0.002;
/// How far apart rates are still alike, in usual steps; chosen, as the next, on BROAD's even trials at 50 Hz.
const ALIKE_STEPS: f64 = 9.0;
/// In a hole that is longer than the samples beside it tell of they are alike for so many times its length, or the
/// course's bend across it would be no more than a guess.
const ALIKE_HOLES: f64 = 1.5;
/// The variance that is stated, as a multiple of the course's: what the filter makes of an error is more than its turn.
const DOUBT: f64 = 9.0;
/// Share of a rate's variance that it has for itself: keeps C regular where samples are close.
const OWN: f64 = 1e-9;
/// Samples that follow each other within this part of the usual step, or after more than so many, say nothing of the
/// rate's course.
const NEAREST: f64 = 0.25;
const FARTHEST: f64 = 4.5;

/// A time for which no sample stands, or, negative, two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Hole {
    /// Its length, s.
    pub missing_s: f64,
    /// The usual step, s.
    pub usual_s: f64,
}

impl Hole {
    /// Whether samples are lost, not only late or early.
    pub(super) fn is_loss(&self) -> bool {
        self.missing_s > LOST * self.usual_s
    }

    /// How many samples after the one that ends it may still tell more of it.
    pub(super) fn later(&self) -> usize {
        if self.is_loss() { AHEAD } else { AHEAD_OF_PART }
    }
}

/// What the rate was there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Between {
    /// Its mean, rad/s.
    pub rate: Vec3,
    /// The variance of that along each axis, (rad/s)².
    pub variance: Vec3,
}

/// A rate, and the step to it from the one before.
pub(super) type Stepped = (Vec3, f64);

/// The last rates.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Trail {
    last: [Stepped; NODES],
    count: usize,
}

impl Trail {
    pub(super) fn push(&mut self, rate: Vec3, step_s: f64) {
        self.last.rotate_left(1);
        self.last[NODES - 1] = (rate, step_s);
        self.count = (self.count + 1).min(NODES);
    }

    /// Forgets all, as after a gap.
    pub(super) fn restart(&mut self) {
        self.count = 0;
    }

    /// What the rate was in a hole before the sample `after` samples ago (0: the newest), with the rates `ahead` of
    /// the newest where they are known already. None where no sample lies before it.
    pub(super) fn between(&self, hole: Hole, after: usize, ahead: &[Stepped]) -> Option<Between> {
        let last = &self.last[NODES - self.count..];
        let first_after = last.len().checked_sub(after + 1).filter(|&at| at > 0)?;
        let side = if math::abs(hole.missing_s) > SHORT * hole.usual_s { SIDE } else { 1 };
        let middle_s = -0.5 * last[first_after].1;
        let fits = |step: f64| step >= NEAREST * hole.usual_s && step <= FARTHEST * hole.usual_s;
        let mut nodes = Nodes::default();
        let mut time_s = -middle_s;
        for (place, &(rate, step)) in last[first_after..].iter().chain(ahead).take(side).enumerate() {
            if place > 0 {
                if !fits(step) {
                    break;
                }
                time_s += step;
            }
            nodes.push(rate, time_s);
        }
        let mut time_s = middle_s;
        for &(rate, step) in last[..first_after].iter().rev().take(side) {
            nodes.push(rate, time_s);
            if !fits(step) {
                break;
            }
            time_s -= step;
        }
        Some(nodes.between(hole))
    }
}

/// Rates at times from the middle of a hole.
#[derive(Default)]
struct Nodes {
    rates: [Vec3; NODES],
    times_s: [f64; NODES],
    count: usize,
}

/// Columns of what Cholesky's root makes of the nodes' rates, of ones, and of their covariance with the hole.
const ONES: usize = 3;
const HOLE: usize = 4;

impl Nodes {
    fn push(&mut self, rate: Vec3, time_s: f64) {
        (self.rates[self.count], self.times_s[self.count]) = (rate, time_s);
        self.count += 1;
    }

    fn between(&self, hole: Hole) -> Between {
        let n = self.count;
        let per_s = 1.0 / (ALIKE_STEPS * hole.usual_s).max(ALIKE_HOLES * hole.missing_s);
        // a mean over another length than a sample's differs from that by the course's bend
        let longer = (hole.missing_s * hole.missing_s - hole.usual_s * hole.usual_s) * per_s * per_s / 24.0;
        let mut root = [[0.0; NODES]; NODES];
        let mut white = [[0.0; 5]; NODES];
        for i in 0..n {
            let away = per_s * self.times_s[i];
            let rate = &self.rates[i];
            let mut row = [rate[0], rate[1], rate[2], 1.0, alike(away) + longer * alike_bend(away)];
            let mut own = 1.0 + OWN;
            for j in 0..i {
                let mut shared = alike(per_s * (self.times_s[i] - self.times_s[j]));
                for k in 0..j {
                    shared -= root[i][k] * root[j][k];
                }
                root[i][j] = shared / root[j][j];
                own -= root[i][j] * root[i][j];
                for (x, y) in row.iter_mut().zip(&white[j]) {
                    *x -= root[i][j] * y;
                }
            }
            root[i][i] = math::sqrt(own.max(OWN));
            white[i] = row.map(|x| x / root[i][i]);
        }
        let dot = |a: usize, b: usize| white[..n].iter().map(|row| row[a] * row[b]).sum::<f64>();
        let ones = dot(ONES, ONES);
        let missing = 1.0 - dot(HOLE, ONES);
        let own = 1.0 + longer * (2.0 * alike_bend(0.0) + longer * BEND_OF_BEND);
        let unknown = own - dot(HOLE, HOLE) + missing * missing / ones;
        let mut between = Between { rate: [0.0; 3], variance: [0.0; 3] };
        for axis in 0..3 {
            let mean = dot(axis, ONES) / ones;
            between.rate[axis] = dot(axis, HOLE) + mean * missing;
            let spread = (dot(axis, axis) - mean * mean * ones).max(0.0) / (n as f64 - 1.0);
            between.variance[axis] = DOUBT * spread * unknown.max(0.0);
        }
        between
    }
}

/// The fourth derivative of [`alike`] at 0.
const BEND_OF_BEND: f64 = 1008.0;

/// Correlation of the rates at two times: Wendland's function, of the distance as a part of the farthest.
fn alike(distance: f64) -> f64 {
    let r = math::abs(distance).min(1.0);
    let left = 1.0 - r;
    let cube = left * left * left;
    cube * cube * left * (((21.0 * r + 19.0) * r + 7.0) * r + 1.0)
}

/// Its second derivative.
fn alike_bend(distance: f64) -> f64 {
    let r = math::abs(distance).min(1.0);
    let left = 1.0 - r;
    let square = left * left;
    18.0 * square * square * left * (((105.0 * r + 13.0) * r - 5.0) * r - 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vector;

    const USUAL_S: f64 = 0.02;

    /// A rate that is a polynomial of the time: its mean from one time to another.
    fn mean(powers: &[f64], from: f64, to: f64) -> Vec3 {
        let whole = |t: f64| {
            let mut power = 1.0;
            let mut sum = 0.0;
            for (n, factor) in powers.iter().enumerate() {
                power *= t;
                sum += factor * power / (n as f64 + 1.0);
            }
            sum
        };
        let x = (whole(to) - whole(from)) / (to - from);
        [x, -2.0 * x, 0.5]
    }

    fn off(found: &Between, truth: Vec3) -> f64 {
        vector::norm(vector::sub(found.rate, truth))
    }

    /// What is found in the hole before the sample `hole` of samples at these times, and the truth; the samples after it
    /// are told `ahead` of time, or have come.
    fn between(powers: &[f64], times: &[f64], hole: usize, ahead: bool) -> (Between, Vec3) {
        let stepped: alloc::vec::Vec<Stepped> = (1..times.len())
            .map(|k| (mean(powers, times[k] - USUAL_S, times[k]), times[k] - times[k - 1]))
            .collect();
        let mut trail = Trail::default();
        let upto = if ahead { hole } else { stepped.len() };
        stepped[..upto].iter().for_each(|&(rate, step)| trail.push(rate, step));
        let missing_s = times[hole] - times[hole - 1] - USUAL_S;
        let told = if ahead { &stepped[upto..] } else { &[] };
        let after = if ahead { 0 } else { stepped.len() - hole };
        let found = trail.between(Hole { missing_s, usual_s: USUAL_S }, after, told).unwrap();
        (found, mean(powers, times[hole - 1], times[hole] - USUAL_S))
    }

    #[test]
    fn an_even_rate_is_known_in_holes_of_every_length() {
        for missing in [0.02, 0.04, 0.013, 0.006, -0.004, 1e-5] {
            let mut times = alloc::vec![0.0, 0.021, 0.039, 0.060, 0.081];
            for step in [USUAL_S + missing, 0.019, 0.02, 0.022] {
                times.push(times[times.len() - 1] + step);
            }
            let (told, truth) = between(&[1.5], &times, 5, true);
            assert!(off(&told, truth) < 1e-9 && told.variance.iter().all(|v| *v < 1e-16), "{told:?}");
            let (seen, _) = between(&[1.5], &times, 5, false);
            assert_eq!(told, seen, "what is told is what is seen later");
        }
    }

    /// 3 Hz sampled at 50 Hz; the straight line between the neighbours is off by more than 1 rad/s in the lost sample.
    #[test]
    fn a_course_is_followed_in_holes_of_every_length() {
        let omega = 2.0 * core::f64::consts::PI * 3.0;
        let powers: alloc::vec::Vec<f64> = {
            // 20 sin(ω t + 1) as its Taylor series: exact to rounding within the 0.2 s used here
            let (s, c) = math::sin_cos(1.0);
            let mut term = 20.0;
            (0..40)
                .map(|n| {
                    let value = term * [s, c, -s, -c][n % 4];
                    term *= omega / (n as f64 + 1.0);
                    value
                })
                .collect()
        };
        for (missing, most) in [(0.02, 0.15), (0.04, 0.5), (0.013, 0.1), (0.006, 0.15), (-0.004, 0.1)] {
            let mut times = alloc::vec![-0.1, -0.08, -0.061, -0.04, -0.021, 0.0];
            for step in [USUAL_S + missing, 0.019, 0.02, 0.022, 0.02] {
                times.push(times[times.len() - 1] + step);
            }
            let (found, truth) = between(&powers, &times, 6, true);
            assert!(off(&found, truth) < most, "{missing}: {found:?} {truth:?}");
            let sigma = math::sqrt(found.variance[0]);
            assert!((found.rate[0] - truth[0]).abs() < sigma && sigma < 6.0, "{missing}: {sigma}");
        }
    }

    #[test]
    fn two_samples_tell_their_mean_and_doubt_it() {
        let (found, truth) = between(&[1.0, 10.0], &[-0.02, 0.0, 0.04], 2, true);
        assert!(off(&found, truth) < 1e-12);
        // they are 0.4 rad/s apart
        assert!(found.variance[0] > 0.16 / 12.0, "{found:?}");
    }

    #[test]
    fn the_bend_is_the_second_derivative() {
        for r in [-0.9, -0.3, 0.0, 0.1, 0.5, 0.95, 1.2] {
            let h = 1e-4;
            let differences = (alike(r + h) - 2.0 * alike(r) + alike(r - h)) / (h * h);
            assert!((alike_bend(r) - differences).abs() < 1e-6, "{r}");
        }
        let h = 1e-4;
        let differences = (alike_bend(h) - 2.0 * alike_bend(0.0) + alike_bend(-h)) / (h * h);
        assert!((BEND_OF_BEND / differences - 1.0).abs() < 1e-2, "{differences}");
    }
}
