//! The rate between two samples that do not meet: lost ones, and steps that are longer or shorter than usual.
//!
//! A sample is the mean rate over the usual step before it. Samples that are late leave a time that none stands for;
//! samples that are early stand for some time twice. The mean over such a time is that of the polynomial through the
//! means around it: with means as nodes, a missing mean of the same length is the polynomial itself, one of another
//! length differs by its bend. How well it is known is told by what polynomials through fewer of the nodes say.

use crate::vector::{self, Vec3};

/// Samples on each side.
pub(super) const SIDE: usize = 5;
/// Samples after the newest that are of use.
pub(super) const AHEAD: usize = SIDE - 1;
/// The same where the time is only part of a step.
const SIDE_OF_PART: usize = 3;
/// From this part of the usual step on samples are lost, not only late.
pub(super) const LOST: f64 = 0.5;
/// How many times the difference between polynomials the error is taken for; chosen on BROAD's even trials at 50 Hz.
const ERRORS_PER_DIFFERENCE: f64 = 2.5;
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
    last: [Stepped; 2 * SIDE],
    count: usize,
}

impl Trail {
    pub(super) fn push(&mut self, rate: Vec3, step_s: f64) {
        self.last.rotate_left(1);
        self.last[2 * SIDE - 1] = (rate, step_s);
        self.count = (self.count + 1).min(2 * SIDE);
    }

    /// Forgets all, as after a gap.
    pub(super) fn restart(&mut self) {
        self.count = 0;
    }

    /// What the rate was in a hole before the sample `after` samples ago (0: the newest), with the rates `ahead` of
    /// the newest where they are known already. None where no sample lies before it.
    pub(super) fn between(&self, hole: Hole, after: usize, ahead: &[Stepped]) -> Option<Between> {
        let last = &self.last[2 * SIDE - self.count..];
        let first_after = last.len().checked_sub(after + 1).filter(|&at| at > 0)?;
        let side = if hole.missing_s > LOST * hole.usual_s { SIDE } else { SIDE_OF_PART };
        let middle_s = -0.5 * last[first_after].1;
        let fits = |step: f64| step >= NEAREST * hole.usual_s && step <= FARTHEST * hole.usual_s;
        let mut nodes = Nodes::new();
        let mut time_s = -middle_s;
        for &(rate, step) in last[first_after..].iter().chain(ahead) {
            if nodes.later == side || !fits(step) {
                break;
            }
            time_s += if nodes.later == 0 { 0.0 } else { step };
            nodes.add_later(rate, time_s);
        }
        if nodes.later == 0 {
            nodes.add_later(last[first_after].0, time_s);
        }
        let mut time_s = middle_s;
        // one more of before than of after at most: farther ones would say too much
        let side = side.min(nodes.later + 1);
        for &(rate, step) in last[..first_after].iter().rev() {
            nodes.add_earlier(rate, time_s);
            time_s -= step;
            if nodes.earlier == side || !fits(step) {
                break;
            }
        }
        Some(nodes.between(hole))
    }
}

/// Rates at times from the middle of a hole, in order; those before it are filled in from the middle outwards.
struct Nodes {
    rates: [Vec3; 2 * SIDE],
    times_s: [f64; 2 * SIDE],
    earlier: usize,
    later: usize,
}

impl Nodes {
    fn new() -> Self {
        Nodes { rates: [[0.0; 3]; 2 * SIDE], times_s: [0.0; 2 * SIDE], earlier: 0, later: 0 }
    }

    fn add_later(&mut self, rate: Vec3, time_s: f64) {
        (self.rates[SIDE + self.later], self.times_s[SIDE + self.later]) = (rate, time_s);
        self.later += 1;
    }

    fn add_earlier(&mut self, rate: Vec3, time_s: f64) {
        self.earlier += 1;
        (self.rates[SIDE - self.earlier], self.times_s[SIDE - self.earlier]) = (rate, time_s);
    }

    fn between(&self, hole: Hole) -> Between {
        let bend = (hole.missing_s * hole.missing_s - hole.usual_s * hole.usual_s) / 12.0;
        let (a, b) = (self.earlier, self.later);
        let rate = self.mean(a, b, bend);
        if a + b < 3 {
            // anywhere between the two
            let change = vector::sub(self.rates[SIDE], self.rates[SIDE - 1]);
            return Between { rate, variance: change.map(|x| x * x / 12.0) };
        }
        let fewer = self.mean(if a > 1 { a - 1 } else { a }, if b > 1 { b - 1 } else { b }, bend);
        let mut squares = vector::sub(rate, fewer).map(|x| x * x);
        if a > 1 && b > 1 {
            let off = vector::sub(self.mean(a, b - 1, bend), self.mean(a - 1, b, bend));
            squares = vector::add(squares, off.map(|x| x * x));
        }
        let variance = vector::scale(squares, ERRORS_PER_DIFFERENCE * ERRORS_PER_DIFFERENCE);
        Between { rate, variance }
    }

    /// The polynomial through `earlier` and `later` nodes at time 0, with `bend` times half its second derivative.
    fn mean(&self, earlier: usize, later: usize, bend: f64) -> Vec3 {
        let nodes = SIDE - earlier..SIDE + later;
        let mut mean = [0.0; 3];
        for i in nodes.clone() {
            // the polynomial that is 1 at this node and 0 at the others, up to its second power
            let (mut c0, mut c1, mut c2, mut at_node) = (1.0, 0.0, 0.0, 1.0);
            for j in nodes.clone().filter(|&j| j != i) {
                let t = self.times_s[j];
                c2 = c1 - t * c2;
                c1 = c0 - t * c1;
                c0 *= -t;
                at_node *= self.times_s[i] - t;
            }
            let weight = (c0 + bend * c2) / at_node;
            mean = vector::add(mean, vector::scale(self.rates[i], weight));
        }
        mean
    }
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

    fn near(found: Between, truth: Vec3) {
        let off = vector::norm(vector::sub(found.rate, truth));
        assert!(off < 1e-9, "{off}");
        assert!(found.variance.iter().all(|variance| *variance < 1e-16), "{found:?}");
    }

    #[test]
    fn cubic_rates_are_known_in_holes_of_every_length() {
        let powers = [1.0, -20.0, 300.0, -4000.0];
        for missing in [0.02, 0.04, 0.013, 0.006, -0.004] {
            let mut times = alloc::vec![0.0, 0.021, 0.039, 0.060, 0.081];
            for step in [USUAL_S + missing, 0.019, 0.02, 0.022] {
                times.push(times[times.len() - 1] + step);
            }
            let (told, truth) = between(&powers, &times, 5, true);
            near(told, truth);
            let (seen, _) = between(&powers, &times, 5, false);
            assert_eq!(told, seen, "what is told is what is seen later");
        }
    }

    #[test]
    fn a_lost_sample_is_the_polynomial_through_its_neighbours() {
        let powers = [0.3, 5.0, -80.0, 900.0, -2e4, 1e5];
        let times: alloc::vec::Vec<f64> = (0..12).filter(|k| *k != 6).map(|k| 0.02 * f64::from(k)).collect();
        let (found, truth) = between(&powers, &times, 6, true);
        assert!(vector::norm(vector::sub(found.rate, truth)) < 1e-9);
    }

    #[test]
    fn two_samples_tell_a_line_and_doubt_it() {
        let (found, truth) = between(&[1.0, 10.0], &[-0.02, 0.0, 0.04], 2, true);
        assert!(vector::norm(vector::sub(found.rate, truth)) < 1e-12);
        // uniform between the two: a change of 0.4 rad/s
        assert!((found.variance[0] - 0.16 / 12.0).abs() < 1e-12, "{found:?}");
    }
}
