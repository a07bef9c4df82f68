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

/// The delayed estimator. Memory: about 8 kB an update ([`Settings::update_s`]) of delay.
#[derive(Clone, Debug)]
pub struct FixedLag {
    forward: Forward<STATES, 2>,
    lag_s: f64,
    state: State,
    /// Samples not yet given out: state as known at once, attitude of the quick filter, step, s.
    waiting: VecDeque<(State, Quaternion, f64)>,
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
        let later: f64 =
            self.waiting.iter().skip(oldest.segment.samples.len()).map(|(_, _, step)| step).sum();
        later + 1e-9 >= self.lag_s
    }

    /// Gives out the samples of the oldest segment.
    fn release(&mut self, out: &mut Vec<State>) {
        let mut adjoint = Adjoint::new();
        for later in self.segments.iter().skip(1).rev() {
            back(&mut adjoint, later.segment.kind, &later.step, &later.covariance);
        }
        let Some(kept) = self.segments.pop_front() else { return };
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
        let count = segment.samples.len();
        for place in 0..count {
            let Some((state, quick, _)) = self.waiting.pop_front() else { break };
            let share = (place as f64 + 1.0) / count as f64;
            let turn = vector::add(vector::scale(start_turn, 1.0 - share), vector::scale(end_turn, share));
            let q = exp_half(vector::scale(turn, 0.5)).product(quick);
            let q = heading_between(state.world_from_body, q).product(q).normalized();
            let covariance = stated(tilt, settings.quick_sigma_share, state.covariance_rad2[2][2]);
            out.push(State::new(q, state.rate_rad_s, state.gyro_bias_rad_s, covariance, state.rest));
        }
        self.before = Some(kept);
    }
}
