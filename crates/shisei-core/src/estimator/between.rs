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
//!
//! That is for a few steps, in which the neighbours tell the course. A longer hole is foretold by what the movement was
//! like before it: the rates' mean square gives the course's variance, and with that of their slopes the time for which
//! rates are alike, whatever the sample rate; the mean is the gyroscope's bias (simple kriging).
//! The means over the hole are exact, for it may be longer than that time; then nothing but the variance is left.

use crate::math;
use crate::vector::{self, Vec3};

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
/// The variance that is stated, as a multiple of the course's: what the filter makes of an error is more than its turn.
const DOUBT: f64 = 9.0;
/// Share of a rate's variance that it has for itself: keeps C regular where samples are close.
const OWN: f64 = 1e-9;
/// Samples that follow each other within this part of the usual step, or after more than so many, say nothing of the
/// rate's course.
const NEAREST: f64 = 0.25;
const FARTHEST: f64 = 4.5;

/// From so many usual steps on a hole is long. This and the next three chosen on BROAD's odd trials at 50 to 286 Hz.
const LONG_STEPS: f64 = 4.5;
/// The time for which rates are alike, as a multiple of their root mean square over that of their slopes.
const ALIKE_LONG: f64 = 3.2;
/// [`OWN`] of long holes: the course is smooth but for this.
const OWN_LONG: f64 = 3e-4;
/// The variance that is stated of a long hole's rate, as a multiple of the course's: people do not move evenly.
const DOUBT_LONG: f64 = 2.0;
/// The time over which the movement before a hole counts, s.
const COURSE_S: f64 = 2.0;
/// The time over which slopes are taken, s: long against the noise, short against the movement.
const SLOPE_S: f64 = 0.01;
/// The most that one sample counts, s: that after a hole says no more than others.
const STEP_WEIGHT_S: f64 = 0.1;

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

    /// Whether it is too long for its neighbours to tell its course.
    pub(super) fn is_long(&self) -> bool {
        self.missing_s > LONG_STEPS * self.usual_s
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

/// What a movement is like.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Course {
    /// Mean square of each axis' rate, (rad/s)².
    rate_squared: Vec3,
    /// Mean square of the rate's slope, (rad/s²)².
    slope_squared: f64,
    /// How much of it is known of each, s.
    time_s: f64,
    slope_time_s: f64,
}

impl Course {
    /// The time for which rates are alike, as far as it matters to a hole of this length, s.
    fn alike_s(&self, missing_s: f64) -> f64 {
        // beyond these its mean is the bias, or its neighbours', to within rounding
        let (least, most) = (1e-3 * missing_s, 1e3 * missing_s);
        let squared = self.rate_squared[0] + self.rate_squared[1] + self.rate_squared[2];
        if squared <= 0.0 || self.slope_squared <= 0.0 {
            return most;
        }
        (ALIKE_LONG * math::sqrt(squared / self.slope_squared)).clamp(least, most)
    }

    /// Variance of the mean rate along each axis over a time of which nothing else is known, (rad/s)².
    fn variance(&self, missing_s: f64) -> Vec3 {
        if missing_s <= 0.0 {
            return [0.0; 3];
        }
        let share = alike_with_itself(missing_s / self.alike_s(missing_s));
        self.rate_squared.map(|squared| DOUBT_LONG * squared * share)
    }
}

/// The last rates.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Trail {
    last: [Stepped; NODES],
    count: usize,
    course: Course,
}

impl Trail {
    /// Takes the next rate; `bias` is what it is at rest, `joined` whether no sample is lost before it.
    pub(super) fn push(&mut self, rate: Vec3, step_s: f64, bias: &Vec3, joined: bool) {
        self.last.rotate_left(1);
        self.last[NODES - 1] = (rate, step_s);
        self.count = (self.count + 1).min(NODES);
        let weight_s = step_s.min(STEP_WEIGHT_S);
        let share = |known_s: &mut f64| {
            *known_s = (*known_s + weight_s).min(COURSE_S);
            weight_s / *known_s
        };
        let turning = vector::sub(rate, *bias);
        let course = &mut self.course;
        let part = share(&mut course.time_s);
        for (squared, rate) in course.rate_squared.iter_mut().zip(turning) {
            *squared += part * (rate * rate - *squared);
        }
        if !joined {
            return;
        }
        let mut passed_s = 0.0;
        for back in 1..self.count {
            let (before, after) = (&self.last[NODES - 1 - back], &self.last[NODES - back]);
            if after.1 > 2.0 * step_s {
                return;
            }
            passed_s += after.1;
            if passed_s >= SLOPE_S || back == NODES - 1 {
                let change = vector::scale(vector::sub(rate, before.0), 1.0 / passed_s);
                let squared = vector::dot(change, change);
                course.slope_squared += share(&mut course.slope_time_s) * (squared - course.slope_squared);
                return;
            }
        }
    }

    /// Variance of the mean rate along each axis over a time of which nothing is known, (rad/s)².
    pub(super) fn variance(&self, missing_s: f64) -> Vec3 {
        self.course.variance(missing_s)
    }

    /// Forgets the rates, as after a gap; not what the movement was like.
    pub(super) fn restart(&mut self) {
        self.count = 0;
    }

    /// What the rate was in a hole before the sample `after` samples ago (0: the newest), with the rates `ahead` of
    /// the newest where they are known already; `bias` is what the rate is at rest. None where no sample lies before it.
    pub(super) fn between(
        &self,
        hole: Hole,
        after: usize,
        ahead: &[Stepped],
        bias: &Vec3,
    ) -> Option<Between> {
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
        Some(if hole.is_long() { nodes.long(hole, &self.course, bias) } else { nodes.between(hole) })
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

    /// Rates off `mean`, ones, and covariances with the hole, divided by the root of the nodes' covariance.
    fn whitened(
        &self,
        per_s: f64,
        own: f64,
        mean: &Vec3,
        with_hole: impl Fn(f64) -> f64,
    ) -> [[f64; 5]; NODES] {
        let n = self.count;
        let mut root = [[0.0; NODES]; NODES];
        let mut white = [[0.0; 5]; NODES];
        for i in 0..n {
            let away = per_s * self.times_s[i];
            let rate = vector::sub(self.rates[i], *mean);
            let mut row = [rate[0], rate[1], rate[2], 1.0, with_hole(away)];
            let mut left = 1.0 + own;
            for j in 0..i {
                let mut shared = alike(per_s * (self.times_s[i] - self.times_s[j]));
                for k in 0..j {
                    shared -= root[i][k] * root[j][k];
                }
                root[i][j] = shared / root[j][j];
                left -= root[i][j] * root[i][j];
                for (x, y) in row.iter_mut().zip(&white[j]) {
                    *x -= root[i][j] * y;
                }
            }
            root[i][i] = math::sqrt(left.max(own));
            white[i] = row.map(|x| x / root[i][i]);
        }
        white
    }

    fn between(&self, hole: Hole) -> Between {
        let n = self.count;
        let per_s = 1.0 / (ALIKE_STEPS * hole.usual_s);
        // a mean over another length than a sample's differs from that by the course's bend
        let longer = (hole.missing_s * hole.missing_s - hole.usual_s * hole.usual_s) * per_s * per_s / 24.0;
        let with_hole = |away: f64| alike(away) + longer * alike_bend(away);
        let white = self.whitened(per_s, OWN, &[0.0; 3], with_hole);
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

    /// The same of a long hole.
    fn long(&self, hole: Hole, course: &Course, bias: &Vec3) -> Between {
        let per_s = 1.0 / course.alike_s(hole.missing_s).max(ALIKE_STEPS * hole.usual_s);
        let length = hole.missing_s * per_s;
        let with_hole = |away: f64| alike_with_mean(away, length);
        let white = self.whitened(per_s, OWN_LONG, bias, with_hole);
        let white = &white[..self.count];
        let dot = |a: usize, b: usize| white.iter().map(|row| row[a] * row[b]).sum::<f64>();
        let unknown = (alike_with_itself(length) - dot(HOLE, HOLE)).max(0.0);
        let mut between = Between { rate: [0.0; 3], variance: [0.0; 3] };
        for axis in 0..3 {
            between.rate[axis] = bias[axis] + dot(axis, HOLE);
            let seen = dot(axis, axis) / self.count as f64;
            between.variance[axis] = DOUBT_LONG * course.rate_squared[axis].max(seen) * unknown;
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

/// Its integral from a distance, 0 to 1, on.
fn alike_beyond(distance: f64) -> f64 {
    let l = 1.0 - distance;
    let square = l * l;
    let fourth = square * square;
    fourth * fourth * (6.0 - l * (12.0 - l * (8.2 - l * (21.0 / 11.0))))
}

/// The integral of that from a distance, 0 to 1, on.
fn alike_twice_beyond(distance: f64) -> f64 {
    let l = 1.0 - distance;
    let square = l * l;
    let fourth = square * square;
    fourth * fourth * l * (2.0 / 3.0 - l * (1.2 - l * (8.2 / 11.0 - l * (21.0 / 132.0))))
}

/// Its mean over distances from `away` within half the length.
fn alike_with_mean(away: f64, length: f64) -> f64 {
    let upto = |x: f64| {
        let part = alike_beyond(0.0) - alike_beyond(math::abs(x).min(1.0));
        if x < 0.0 { -part } else { part }
    };
    (upto(away + 0.5 * length) - upto(away - 0.5 * length)) / length
}

/// The mean of the correlations of all times within a length: the variance of their mean.
fn alike_with_itself(length: f64) -> f64 {
    let near = alike_twice_beyond(0.0) - alike_twice_beyond(length.min(1.0));
    2.0 * (length * alike_beyond(0.0) - near) / (length * length)
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
        stepped[..upto]
            .iter()
            .for_each(|&(rate, step)| trail.push(rate, step, &[0.0; 3], step < 1.5 * USUAL_S));
        let missing_s = times[hole] - times[hole - 1] - USUAL_S;
        let told = if ahead { &stepped[upto..] } else { &[] };
        let after = if ahead { 0 } else { stepped.len() - hole };
        let found = trail.between(Hole { missing_s, usual_s: USUAL_S }, after, told, &[0.0; 3]).unwrap();
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

    /// Sums over a fine grid.
    #[test]
    fn means_over_a_hole_are_those_of_its_parts() {
        for length in [0.01, 0.3, 1.0, 2.7, 40.0] {
            let parts = 2000;
            let at = |k: i32| length * ((f64::from(k) + 0.5) / f64::from(parts) - 0.5);
            for away in [-30.0, -1.1, -0.4, 0.0, 0.2, 0.9, 3.0] {
                let sum: f64 = (0..parts).map(|k| alike(away + at(k))).sum();
                let mean = alike_with_mean(away, length);
                assert!((mean - sum / f64::from(parts)).abs() < 1e-5, "{length} {away}");
            }
            let sum: f64 = (0..parts).map(|k| alike_with_mean(at(k), length)).sum();
            assert!((alike_with_itself(length) - sum / f64::from(parts)).abs() < 1e-5, "{length}");
        }
        assert!(
            (alike_with_itself(1e-3) - 1.0).abs() < 1e-5 && (alike_with_mean(0.0, 1e-3) - 1.0).abs() < 1e-5
        );
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
