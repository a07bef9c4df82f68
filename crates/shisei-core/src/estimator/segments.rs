//! The forward pass over a recording, segment by segment, with what the backward pass needs of each.

use alloc::vec::Vec;
use core::ops::Range;

use super::between::{AHEAD, Stepped};
use super::covariance::Covariance;
use super::engine::{OpticalNoise, OpticalPose, Points, Sight, Step, Told};
use super::guard::Sample;
use super::model::Nominal;
use super::runner::{Event, Runner};
use super::settings::Settings;
use crate::filter::Dt;
use crate::quaternion::Quaternion;
use crate::vector::{self, Vec3};

/// What a segment is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// From one update to the next.
    Interval,
    /// The rest of an interval that a gap cut off: no update.
    Tail,
    /// The level after a gap: only the heading and the sensor are those of before.
    Level,
    /// A start anew from a motion that was told from later on: only the sensor is that of before.
    Anew,
    /// The level at the start, or after the filter was given up: nothing is.
    Start,
}

/// A segment.
#[derive(Clone, Debug)]
pub(super) struct Segment {
    pub samples: Range<usize>,
    pub kind: Kind,
    /// The state at its end, before the measurements.
    pub before: Nominal,
    /// The state after them.
    pub nominal: Nominal,
    /// Variance that gaps have added to the heading, rad².
    pub heading_lost: f64,
}

/// What the forward pass has after a sample, for the backward pass to correct.
#[derive(Clone, Copy, Debug)]
pub(super) struct Passing {
    pub world_from_body: Quaternion,
    pub velocity: Vec3,
    pub position: Vec3,
}

impl Passing {
    fn of(state: &Nominal) -> Self {
        Passing { world_from_body: state.world_from_body, velocity: state.velocity, position: state.position }
    }
}

/// The recording.
#[derive(Clone, Copy, Debug)]
pub(super) struct Recording<'a> {
    pub acc: &'a [Vec3],
    pub gyro: &'a [Vec3],
    /// Taken off every rate, rad/s.
    pub bias: Vec3,
    pub dt: Dt<'a>,
    pub rest: &'a [bool],
    /// Optical poses, one a sample, or none at all.
    pub poses: &'a [Option<OpticalPose>],
    pub noise: OpticalNoise,
    /// Markers seen where there is no pose, one row a sample, or none at all.
    pub points: &'a [Points],
    /// How strongly the motion is bounded without a pose, 0 … 1, one a sample, or none at all.
    pub bounds: &'a [f64],
    /// Where to start anew after a hole, by ascending samples.
    pub told: &'a [Told],
}

impl Recording<'_> {
    pub(super) fn rate(&self, k: usize) -> Vec3 {
        vector::sub(self.gyro[k], self.bias)
    }

    pub(super) fn sample(&self, k: usize) -> Sample {
        Sample { gyro_rad_s: self.rate(k), acc_m_s2: self.acc[k], dt_s: self.dt.at(k) }
    }

    /// What the cameras saw at sample k.
    fn sight(&self, k: usize) -> Option<Sight<'_>> {
        if let Some(Some(pose)) = self.poses.get(k) {
            let started = self.told.partition_point(|told| told.seen <= k);
            let noise = match started.checked_sub(1).and_then(|place| self.told.get(place)) {
                Some(told) => told.noise(k, &self.noise),
                None => self.noise,
            };
            return Some(Sight::Pose(pose, noise));
        }
        if let Ok(place) = self.told.binary_search_by_key(&k, |told| told.sample) {
            return Some(Sight::Told(&self.told[place]));
        }
        self.points.get(k).filter(|points| points[0].is_some()).map(Sight::Points)
    }

    /// The rates from sample k on, as far as they are readable and before a gap, and how many.
    fn ahead(&self, k: usize, settings: &Settings) -> ([Stepped; AHEAD], usize) {
        let mut ahead = [([0.0; 3], 0.0); AHEAD];
        for place in 0..AHEAD {
            let Some(next) = self.stepped(k + place, settings) else { return (ahead, place) };
            ahead[place] = next;
        }
        (ahead, AHEAD)
    }

    /// The rate of sample k, corrected, and the step to it; none where it is unreadable or past a gap.
    fn stepped(&self, k: usize, settings: &Settings) -> Option<Stepped> {
        if k >= self.gyro.len() {
            return None;
        }
        let (raw, dt) = (self.rate(k), self.dt.at(k));
        let readable = raw.iter().all(|x| x.abs() <= settings.gyro_limit_rad_s);
        let usable = dt > 0.0 && dt <= settings.gap_s;
        if !(readable && usable) {
            return None;
        }
        Some((settings.calibration.as_ref().map_or(raw, |known| known.correct_gyro(raw)), dt))
    }
}

/// A forward pass under way; a copy of it is a point to go on from. The segments are those of the first filter.
#[derive(Clone, Debug)]
pub(super) struct Forward<const N: usize, const E: usize> {
    pub runner: Runner<N, E>,
    /// The sample to come.
    pub next: usize,
    /// The first sample of the segment under way.
    start: usize,
    started: bool,
    given_up: bool,
}

impl<const N: usize, const E: usize> Forward<N, E> {
    pub(super) fn new(runner: Runner<N, E>) -> Self {
        Forward { runner, next: 0, start: 0, started: false, given_up: false }
    }

    /// Goes on from filters that have run elsewhere.
    #[must_use]
    pub(super) fn resumed(runner: Runner<N, E>) -> Self {
        let started = runner.last_level.is_some();
        Forward { started, ..Forward::new(runner) }
    }

    /// Samples are counted anew from here on, those of a segment under way too.
    pub(super) fn count_anew(&mut self) {
        (self.next, self.start) = (0, 0);
    }

    /// Takes a sample; gives the segment that it ends, of which [`Forward::step`] and [`Forward::covariance`]
    /// tell the rest.
    pub(super) fn push(
        &mut self,
        sample: &Sample,
        rest: Option<bool>,
        sight: Option<Sight<'_>>,
    ) -> Option<Segment> {
        let k = self.next;
        self.next += 1;
        let lost_before = self.runner.heading_lost;
        match self.runner.take(sample, rest, sight) {
            Event::Useless | Event::Levelling | Event::Moved => None,
            Event::LevelBegins => {
                if !self.started || self.start >= k {
                    return None;
                }
                let before = self.runner.engines[0].nominal;
                let mut segment = self.end(k, Kind::Tail, before);
                segment.heading_lost = lost_before;
                Some(segment)
            }
            Event::LevelCut => {
                if self.start >= k {
                    return None;
                }
                let mut segment = self.levelled(k);
                segment.heading_lost = lost_before;
                Some(segment)
            }
            Event::Levelled => {
                let mut segment = self.levelled(k + 1);
                if matches!(sight, Some(Sight::Told(..))) {
                    segment.kind = Kind::Anew;
                }
                Some(segment)
            }
            Event::Closed => Some(self.end(k + 1, Kind::Interval, self.step().before)),
            Event::GivenUp => {
                self.given_up = true;
                let mut segment = self.end(k + 1, Kind::Tail, self.step().before);
                segment.nominal = segment.before;
                Some(segment)
            }
        }
    }

    /// What the end of the last interval did.
    pub(super) fn step(&self) -> &Step {
        &self.runner.engines[0].step
    }

    /// The covariance after the last segment.
    pub(super) fn covariance(&self) -> &Covariance<N> {
        &self.runner.engines[0].covariance
    }

    /// The state as the filter has it after the last sample, which ended this segment, if any; while the level is
    /// being found the attitude is that which the gyroscope carries.
    pub(super) fn passing(&self, segment: Option<&Segment>) -> Passing {
        let nominal = &self.runner.engines[0].nominal;
        match (segment, &self.runner.level) {
            (Some(segment), _) if segment.samples.end == self.next => Passing::of(&segment.before),
            (_, Some(level)) => Passing { world_from_body: level.carried, ..Passing::of(nominal) },
            (_, None) => Passing::of(nominal),
        }
    }

    /// True between segments: the last sample ended one, and none begins before the next sample.
    pub(super) fn is_between(&self) -> bool {
        self.start == self.next
    }

    /// Ends the segment under way, with the recording.
    pub(super) fn finish(&mut self) -> Option<Segment> {
        let rows = self.next;
        if self.start >= rows {
            return None;
        }
        if self.runner.finish_level() {
            return Some(self.levelled(rows));
        }
        let rest = self.runner.at_rest;
        let engine = &mut self.runner.engines[0];
        let before = engine.nominal;
        let kind = if engine.sums.time_s > 0.0 { Kind::Interval } else { Kind::Tail };
        engine.close(rest, None);
        Some(self.end(rows, kind, before))
    }

    fn levelled(&mut self, end: usize) -> Segment {
        let carried = self.runner.last_level.map_or(Quaternion::IDENTITY, |level| level.carried);
        let carried = Nominal { world_from_body: carried, ..self.runner.engines[0].nominal };
        let kind = if self.started && !self.given_up { Kind::Level } else { Kind::Start };
        self.started = true;
        self.given_up = false;
        self.end(end, kind, carried)
    }

    fn end(&mut self, end: usize, kind: Kind, before: Nominal) -> Segment {
        let samples = self.start..end;
        self.start = end;
        let nominal = self.runner.engines[0].nominal;
        Segment { samples, kind, before, nominal, heading_lost: self.runner.heading_lost }
    }
}

impl<const N: usize> Forward<N, 1> {
    /// The next sample of a recording, or its end: the segment that this ends, and whether there was a sample.
    #[inline]
    pub(super) fn sample(&mut self, recording: &Recording<'_>) -> (Option<Segment>, bool) {
        let k = self.next;
        if k >= recording.acc.len() {
            return (self.finish(), false);
        }
        if let Some(&bound) = recording.bounds.get(k) {
            let model = &mut self.runner.engines[0].model;
            let density = if bound > 0.0 { 1.0 / bound } else { 0.0 };
            (model.speed_floor, model.position_spread) = (density, density);
        }
        let sight = recording.sight(k);
        let sample = recording.sample(k);
        if self.runner.looks_ahead(sample.dt_s) {
            self.runner.ahead = Some(recording.ahead(k + 1, &self.runner.settings));
        }
        (self.push(&sample, Some(recording.rest[k]), sight), true)
    }
}

/// Segments one after another, each with what the backward pass needs of it.
#[derive(Clone, Debug)]
pub(super) struct Chunk<const N: usize> {
    /// The covariance before the first segment.
    pub before: Covariance<N>,
    pub segments: Vec<Segment>,
    pub steps: Vec<Step>,
    pub covariances: Vec<Covariance<N>>,
    /// The first sample, and the filter's states from there on.
    pub first: usize,
    pub passing: Vec<Passing>,
}

impl<const N: usize> Chunk<N> {
    /// The segments from where `forward` is up to the sample `end`, or to the end of the recording with it.
    pub(super) fn forward(mut forward: Forward<N, 1>, recording: &Recording<'_>, end: usize) -> Self {
        let mut chunk = Chunk {
            before: *forward.covariance(),
            segments: Vec::new(),
            steps: Vec::new(),
            covariances: Vec::new(),
            first: forward.next,
            passing: Vec::with_capacity(end - forward.next),
        };
        let whole = end == recording.acc.len();
        while forward.next < end || whole {
            let (segment, sampled) = forward.sample(recording);
            if sampled {
                chunk.passing.push(forward.passing(segment.as_ref()));
            }
            if let Some(segment) = segment {
                chunk.segments.push(segment);
                chunk.steps.push(*forward.step());
                chunk.covariances.push(*forward.covariance());
            }
            if !sampled {
                break;
            }
        }
        chunk
    }
}
