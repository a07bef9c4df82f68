//! The estimator with a delay: each state waits for the samples of the next second or so, which say more about its
//! tilt than all samples before.
//!
//! The quick filter runs forward; at every update the backward pass goes from the newest to the oldest update that
//! is kept, and the samples of the oldest are given out. Heading, rates and bias are those of the calm filter.

use alloc::collections::VecDeque;
use alloc::vec::Vec;

use super::backward::Adjoint;
use super::covariance::Covariance;
use super::engine::Step;
use super::guard::Sample;
use super::model::{PHI, STATES};
use super::online::{State, check, compose, stated};
use super::runner::{Runner, heading_between};
use super::segments::{Forward, Kind, Segment};
use super::settings::Settings;
use super::smoother::back;
use crate::error::{Error, Result};
use crate::filter::exponential::exp_half;
use crate::quaternion::Quaternion;
use crate::vector;

/// Longest delay, s.
const LONGEST_S: f64 = 10.0;
/// Samples that wait at most, whatever their steps say.
const ROWS_MAX: usize = 16_384;

/// The delayed estimator. Memory: about 8 kB an update ([`Settings::update_s`]) of delay, and 220 bytes a sample, of
/// which fewer than 16,384 wait: beyond that the oldest is given out, whatever its delay.
#[derive(Clone, Debug)]
pub struct FixedLag {
    forward: Forward<STATES, 2>,
    lag_s: f64,
    state: State,
    /// Samples not yet given out: state as known at once, attitude of the quick filter, step, s.
    waiting: VecDeque<(State, Quaternion, f64)>,
    /// Samples given out, which is the number of the first that waits.
    given: usize,
    segments: VecDeque<Kept>,
    /// The last segment given out.
    before: Option<Kept>,
}

/// A segment with what the backward pass needs of it.
#[derive(Clone, Debug)]
struct Kept {
    segment: Segment,
    step: Step,
    covariance: Covariance<STATES>,
}

impl FixedLag {
    /// A delay of `lag_s`, s, 0 … 10; useful ones are 0.5 to 3. States come out in bunches of
    /// [`Settings::update_s`]. Refused as [`super::Estimator::new`], and for a delay out of range.
    pub fn new(settings: &Settings, lag_s: f64) -> Result<Self> {
        check(settings)?;
        if !(0.0..=LONGEST_S).contains(&lag_s) {
            return Err(Error::OutOfRange { rule: "0 <= lag <= 10 s", value: lag_s });
        }
        let runner = Runner::new(settings, [&settings.quick, &settings.calm], 0.0);
        let state = State::new(Quaternion::IDENTITY, [0.0; 3], [0.0; 3], [[0.0; 3]; 3], false);
        Ok(FixedLag {
            forward: Forward::new(runner),
            lag_s,
            state,
            waiting: VecDeque::new(),
            given: 0,
            segments: VecDeque::new(),
            before: None,
        })
    }

    /// Takes a sample and appends the states that have waited long enough to `out`, in order, one a sample.
    pub fn update(&mut self, sample: &Sample, out: &mut Vec<State>) {
        let segment = self.forward.push(sample, None, None);
        let passing = self.forward.passing(segment.as_ref());
        self.state = compose(&self.forward.runner, sample, self.state.rate_rad_s);
        let step = if sample.dt_s > 0.0 && sample.dt_s < f64::INFINITY { sample.dt_s } else { 0.0 };
        self.waiting.push_back((self.state, passing.world_from_body, step));
        if let Some(segment) = segment {
            self.keep(segment);
            while self.oldest_has_waited() {
                self.release(out);
            }
        }
        while self.waiting.len() >= ROWS_MAX {
            self.release(out);
        }
    }

    /// Appends the states that still wait, at the end of the samples.
    pub fn finish(mut self, out: &mut Vec<State>) {
        if let Some(segment) = self.forward.finish() {
            self.keep(segment);
        }
        while !self.segments.is_empty() {
            self.release(out);
        }
    }

    fn keep(&mut self, segment: Segment) {
        let (step, covariance) = (*self.forward.step(), *self.forward.covariance());
        self.segments.push_back(Kept { segment, step, covariance });
    }

    fn oldest_has_waited(&self) -> bool {
        let Some(oldest) = self.segments.front() else { return false };
        let own = oldest.segment.samples.end - self.given;
        let later: f64 = self.waiting.iter().skip(own).map(|(_, _, step)| step).sum();
        later + 1e-9 >= self.lag_s
    }

    /// Gives out the samples of the oldest segment; of one that is still under way its oldest, as it is known at once.
    fn release(&mut self, out: &mut Vec<State>) {
        let Some(kept) = self.segments.pop_front() else {
            if let Some((state, ..)) = self.waiting.pop_front() {
                self.given += 1;
                out.push(state);
            }
            return;
        };
        let mut adjoint = Adjoint::new();
        for later in self.segments.iter().rev() {
            back(&mut adjoint, later.segment.kind, &later.step, &later.covariance);
        }
        let Kept { segment, step, covariance } = &kept;
        let error = adjoint.error(covariance);
        let smoothed = segment.nominal.moved(&error).world_from_body;
        let tilt = adjoint.covariance(covariance, PHI);
        let end_turn = match segment.kind {
            Kind::Tail => [error[0], error[1], error[2]],
            _ => smoothed.product(segment.before.world_from_body.conjugate()).to_rotation_vector(),
        };
        back(&mut adjoint, segment.kind, step, covariance);
        let start_turn = match (segment.kind, &self.before) {
            (Kind::Interval, Some(before)) => {
                let error = adjoint.error(&before.covariance);
                [error[0], error[1], error[2]]
            }
            _ => end_turn,
        };
        let settings = &self.forward.runner.settings;
        let count = segment.samples.len() as f64;
        for place in self.given.saturating_sub(segment.samples.start)..segment.samples.len() {
            let Some((state, quick, _)) = self.waiting.pop_front() else { break };
            self.given += 1;
            let share = (place as f64 + 1.0) / count;
            let turn = vector::add(vector::scale(start_turn, 1.0 - share), vector::scale(end_turn, share));
            let q = exp_half(vector::scale(turn, 0.5)).product(quick);
            let q = heading_between(state.world_from_body, q).product(q).normalized();
            let covariance = stated(tilt, settings.quick_sigma_share, state.covariance_rad2[2][2]);
            out.push(State::new(q, state.rate_rad_s, state.gyro_bias_rad_s, covariance, state.rest));
        }
        self.before = Some(kept);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// What the steps and readings of a stretch are.
    #[derive(Clone, Copy, Debug)]
    enum Stretch {
        Good,
        /// No step is a positive number.
        Step(f64),
        /// Time hardly passes.
        Slow,
        /// Nothing that the sensor reads is a number.
        Unreadable,
    }

    fn stretch() -> impl Strategy<Value = Stretch> {
        let step = prop_oneof![Just(f64::NAN), Just(f64::INFINITY), Just(0.0), Just(-0.01)];
        prop_oneof![
            Just(Stretch::Good),
            step.prop_map(Stretch::Step),
            Just(Stretch::Slow),
            Just(Stretch::Unreadable),
        ]
    }

    /// Sample k of a slow turn about x, 100 a second.
    fn sample(k: usize, stretch: Stretch) -> Sample {
        let angle = 0.002 * k as f64;
        let acc = [0.0, 9.8 * crate::math::sin(angle), 9.8 * crate::math::cos(angle)];
        let good = Sample { gyro_rad_s: [0.2, 0.0, 0.0], acc_m_s2: acc, dt_s: 0.01 };
        match stretch {
            Stretch::Good => good,
            Stretch::Step(dt_s) => Sample { dt_s, ..good },
            Stretch::Slow => Sample { dt_s: 1e-12, ..good },
            Stretch::Unreadable => Sample { gyro_rad_s: [f64::NAN; 3], acc_m_s2: [f64::INFINITY; 3], ..good },
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(12))]
        /// Whatever the steps say, so many samples wait and no more; each comes out once.
        #[test]
        fn so_many_wait_and_no_more(
            stretches in prop::collection::vec((stretch(), 1..2 * ROWS_MAX), 1..4), lag_s in 0.0..3.0,
        ) {
            let mut lag = FixedLag::new(&Settings::default(), lag_s).expect("settings");
            let (mut out, mut count) = (Vec::new(), 0);
            for (stretch, length) in stretches {
                for _ in 0..length {
                    lag.update(&sample(count, stretch), &mut out);
                    count += 1;
                    prop_assert!(lag.waiting.len() < ROWS_MAX && out.len() + lag.waiting.len() == count);
                    prop_assert!(lag.segments.len() < 32, "{} segments", lag.segments.len());
                }
            }
            lag.finish(&mut out);
            prop_assert_eq!(out.len(), count);
            prop_assert!(out.iter().all(|state| state.world_from_body.is_finite() && state.sigma_tilt_rad.is_finite()));
        }
    }

    /// Steps that are no numbers hold nothing up for good: what comes after them is smoothed as ever.
    #[test]
    fn what_follows_is_smoothed_as_ever() {
        let mut lag = FixedLag::new(&Settings::default(), 0.5).expect("settings");
        let mut out = Vec::new();
        let bad = 300..300 + 2 * ROWS_MAX;
        for k in 0..bad.end + 1000 {
            // the sensor turns on only where time passes
            let at = if k < bad.end { k.min(bad.start) } else { bad.start + k - bad.end };
            let stretch = if bad.contains(&k) { Stretch::Step(f64::NAN) } else { Stretch::Good };
            lag.update(&sample(at, stretch), &mut out);
        }
        lag.finish(&mut out);
        assert_eq!(out.len(), bad.end + 1000);
        for (k, state) in out[bad.end..].iter().enumerate() {
            let acc = state.world_from_body.rotate(sample(bad.start + k, Stretch::Good).acc_m_s2);
            let tilt = crate::math::atan2(crate::math::hypot(acc[0], acc[1]), acc[2]).to_degrees();
            assert!(tilt < 0.5, "{k}: {tilt} degrees");
        }
    }
}
