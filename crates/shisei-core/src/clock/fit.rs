//! From pairs of two clocks to offset and skew.
//!
//! `local = a + (1 + s) · remote`. Weighted least squares: [`ClockFit`] forgets with a time constant, as pairs come;
//! [`map_between`] weighs pairs by how near they are on either side, for recordings. Both hold the skew back by what
//! crystals do, so that two close pairs do not make a wild line: a prior of mean 0 and deviation `skew_sigma`.

use crate::math;

/// The same moment by two clocks, s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pair {
    /// By the clock to be translated.
    pub remote_s: f64,
    /// By the clock to translate to.
    pub local_s: f64,
}

/// What is known of the clocks beforehand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// τ, s: pairs older than this count for little. Default 5. Small values follow temperature, large ones average
    /// jitter.
    pub memory_s: f64,
    /// σ, s: deviation of one pair. Default 16e-6. Only its ratio to `skew_sigma` matters.
    pub pair_sigma_s: f64,
    /// Deviation of the skew, 1. Default 50e-6: two crystals of 40 ppm.
    pub skew_sigma: f64,
    /// A pair that is off by more than this is left out, s. Default 1e-3: pairs of the wrong connection event are
    /// off by milliseconds.
    pub gate_s: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Settings { memory_s: 5.0, pair_sigma_s: 16e-6, skew_sigma: 50e-6, gate_s: 1e-3 }
    }
}

impl Settings {
    /// What the prior of the skew weighs, s².
    fn ridge(&self) -> f64 {
        let ratio = self.pair_sigma_s / self.skew_sigma;
        ratio * ratio
    }
}

/// What became of a pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// Used.
    Used,
    /// Left out: not finite, not later than the one before, or beyond the gate.
    LeftOut,
    /// So many in a row were beyond the gate that the clock must have jumped: begun anew with this one.
    Restarted,
}

/// Pairs in a row beyond the gate that mean a jump.
const JUMP_AFTER: u32 = 8;
/// Pairs before the gate closes.
const GATE_FROM: u32 = 8;

/// Offset and skew as pairs come, in constant memory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClockFit {
    settings: Settings,
    weight: f64,
    remote_s: f64,
    difference_s: f64,
    sxx: f64,
    sxy: f64,
    last_remote_s: f64,
    residual_squared: f64,
    pairs: u32,
    left_out_in_row: u32,
}

impl ClockFit {
    /// Without a pair yet.
    pub fn new(settings: Settings) -> Self {
        ClockFit {
            settings,
            weight: 0.0,
            remote_s: 0.0,
            difference_s: 0.0,
            sxx: 0.0,
            sxy: 0.0,
            last_remote_s: f64::NEG_INFINITY,
            residual_squared: 0.0,
            pairs: 0,
            left_out_in_row: 0,
        }
    }

    /// Takes a pair. Pairs come in the order of the remote clock; one that does not is left out.
    pub fn push(&mut self, pair: Pair) -> Outcome {
        let finite = math::abs(pair.remote_s) < 1e15 && math::abs(pair.local_s) < 1e15;
        if !finite || pair.remote_s <= self.last_remote_s {
            return Outcome::LeftOut;
        }
        let residual_s = pair.local_s - self.map(pair.remote_s).unwrap_or(pair.local_s);
        if self.pairs >= GATE_FROM && math::abs(residual_s) > self.settings.gate_s {
            self.left_out_in_row += 1;
            if self.left_out_in_row < JUMP_AFTER {
                return Outcome::LeftOut;
            }
            *self = ClockFit::new(self.settings);
            self.push(pair);
            return Outcome::Restarted;
        }
        self.left_out_in_row = 0;
        let keep = if self.pairs == 0 {
            0.0
        } else {
            math::exp((self.last_remote_s - pair.remote_s) / self.settings.memory_s)
        };
        self.last_remote_s = pair.remote_s;
        self.weight = self.weight * keep + 1.0;
        self.sxx *= keep;
        self.sxy *= keep;
        // The difference of the clocks instead of the local one: it keeps more digits.
        let difference_s = pair.local_s - pair.remote_s;
        let (dx, dy) = (pair.remote_s - self.remote_s, difference_s - self.difference_s);
        if self.pairs == 0 {
            (self.remote_s, self.difference_s) = (pair.remote_s, difference_s);
        } else {
            self.remote_s += dx / self.weight;
            self.difference_s += dy / self.weight;
            self.sxx += dx * (pair.remote_s - self.remote_s);
            self.sxy += dx * (difference_s - self.difference_s);
            let share = 1.0 / self.weight;
            self.residual_squared += share * (residual_s * residual_s - self.residual_squared);
        }
        self.pairs = self.pairs.saturating_add(1);
        Outcome::Used
    }

    /// The skew: how much more the local clock advances, 1 (1e-6 is 1 ppm). Zero before the second pair.
    pub fn skew(&self) -> f64 {
        self.sxy / (self.sxx + self.settings.ridge())
    }

    /// Translates a time of the remote clock; none before the first pair.
    pub fn map(&self, remote_s: f64) -> Option<f64> {
        let moved_s = self.skew() * (remote_s - self.remote_s);
        (self.pairs > 0).then_some(remote_s + (self.difference_s + moved_s))
    }

    /// How far pairs were off before they were used: root mean square over the memory, s. None before the second.
    pub fn residual_s(&self) -> Option<f64> {
        (self.pairs > 1).then(|| math::sqrt(self.residual_squared))
    }

    /// Pairs used since the start or the last jump.
    pub fn pairs(&self) -> u32 {
        self.pairs
    }
}

/// Translates a time by the pairs around it, for recordings: a line through all pairs within twice the memory on
/// either side, weighed by (1 − (d/2τ)²)²; none where there is no pair so near. The pairs ascend by remote time;
/// pairs of the wrong event must have been left out ([`ClockFit::push`] says which).
pub fn map_between(pairs: &[Pair], remote_s: f64, settings: &Settings) -> Option<f64> {
    let reach_s = 2.0 * settings.memory_s;
    let start = pairs.partition_point(|pair| pair.remote_s <= remote_s - reach_s);
    let (mut weight, mut mean_x, mut mean_y) = (0.0, 0.0, 0.0);
    let (mut sxx, mut sxy) = (0.0, 0.0);
    for pair in pairs.get(start..)? {
        let x = pair.remote_s - remote_s;
        if x >= reach_s {
            break;
        }
        let u = x / reach_s;
        let v = 1.0 - u * u;
        let w = v * v;
        if w <= 0.0 {
            continue;
        }
        let y = pair.local_s - pair.remote_s;
        weight += w;
        let (dx, dy) = (x - mean_x, y - mean_y);
        mean_x += dx * (w / weight);
        mean_y += dy * (w / weight);
        sxx += w * (dx * (x - mean_x));
        sxy += w * (dx * (y - mean_y));
    }
    if weight > 0.0 {
        let skew = sxy / (sxx + settings.ridge());
        Some(remote_s + (mean_y - skew * mean_x))
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_found() {
        let mut fit = ClockFit::new(Settings { memory_s: 1e9, skew_sigma: 1.0, ..Settings::default() });
        assert_eq!(fit.map(1.0), None);
        for k in 0..200 {
            let remote_s = 0.1 * f64::from(k);
            let pair = Pair { remote_s, local_s: 100.0 + remote_s * (1.0 + 40e-6) };
            assert_eq!(fit.push(pair), Outcome::Used);
        }
        assert!((fit.skew() - 40e-6).abs() < 1e-12, "{}", fit.skew());
        assert!((fit.map(50.0).unwrap() - (150.0 + 50.0 * 40e-6)).abs() < 1e-9);
        assert_eq!(fit.pairs(), 200);
    }

    #[test]
    fn a_pair_of_the_wrong_event_is_left_out_and_a_jump_is_followed() {
        let mut fit = ClockFit::new(Settings::default());
        let pair =
            |k: i32, off: f64| Pair { remote_s: f64::from(k) * 0.03, local_s: f64::from(k) * 0.03 + off };
        for k in 0..100 {
            fit.push(pair(k, 5.0));
        }
        assert_eq!(fit.push(pair(100, 5.015)), Outcome::LeftOut);
        assert!((fit.map(3.0).unwrap() - 8.0).abs() < 1e-9);
        let outcomes: [Outcome; 8] = core::array::from_fn(|k| fit.push(pair(101 + k as i32, 9.0)));
        assert_eq!(outcomes[6], Outcome::Restarted);
        assert_eq!(outcomes[7], Outcome::Used);
        assert!((fit.map(4.0).unwrap() - 13.0).abs() < 1e-9);
        assert_eq!(fit.push(pair(3, 9.0)), Outcome::LeftOut);
        assert_eq!(fit.push(Pair { remote_s: f64::NAN, local_s: 0.0 }), Outcome::LeftOut);
    }

    #[test]
    fn two_close_pairs_do_not_make_a_wild_line() {
        let mut fit = ClockFit::new(Settings::default());
        fit.push(Pair { remote_s: 0.0, local_s: 0.0 });
        fit.push(Pair { remote_s: 0.015, local_s: 0.015 + 32e-6 });
        assert!(fit.skew().abs() < 50e-6, "{}", fit.skew());
    }
}
