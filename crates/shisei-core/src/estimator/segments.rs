//! The forward pass over a recording, segment by segment, with what the backward pass needs of each.

use super::covariance::Covariance;
use super::engine::{Engine, OpticalNoise, OpticalPose, Step};
use super::guard::Sample;
use super::model::Nominal;
use super::runner::{Event, Runner};
use super::settings::Settings;
use crate::filter::Dt;
use crate::quaternion::Quaternion;
use crate::vector::Vec3;
use core::ops::Range;

/// What a segment is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// From one update to the next.
    Interval,
    /// The rest of an interval that a gap cut off: no update.
    Tail,
    /// The level after a gap: only the heading and the sensor are those of before.
    Level,
    /// The level at the start, or after the filter was given up: nothing is.
    Start,
}

/// A segment and the filter after it.
#[derive(Clone, Debug)]
pub(super) struct Segment<const N: usize> {
    pub samples: Range<usize>,
    pub kind: Kind,
    /// The state at its end, before the measurements.
    pub before: Nominal,
    /// The state after them.
    pub nominal: Nominal,
    pub covariance: Covariance<N>,
    pub step: Step<N>,
    /// Variance that gaps have added to the heading, rad².
    pub heading_lost: f64,
}

/// The recording.
#[derive(Clone, Copy, Debug)]
pub(super) struct Recording<'a> {
    pub acc: &'a [Vec3],
    pub gyro: &'a [Vec3],
    pub dt: Dt<'a>,
    pub rest: &'a [bool],
    /// Optical poses, one a sample, or none at all.
    pub poses: &'a [Option<OpticalPose>],
    pub noise: OpticalNoise,
    /// How strongly the motion is bounded without a pose, 0 … 1, one a sample, or none at all.
    pub bounds: &'a [f64],
}

impl Recording<'_> {
    pub(super) fn sample(&self, k: usize) -> Sample {
        Sample { gyro_rad_s: self.gyro[k], acc_m_s2: self.acc[k], dt_s: self.dt.at(k) }
    }

    /// The rate of sample k, corrected, and the step to it; none where it is unreadable or past a gap.
    fn ahead(&self, k: usize, settings: &Settings) -> Option<(Vec3, f64)> {
        let raw = *self.gyro.get(k)?;
        let dt = self.dt.at(k);
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
    next: usize,
    /// The first sample of the segment under way.
    start: usize,
    started: bool,
    given_up: bool,
    /// What the end of the last interval did.
    step: Step<N>,
}

impl<const N: usize, const E: usize> Forward<N, E> {
    pub(super) fn new(runner: Runner<N, E>) -> Self {
        Forward { runner, next: 0, start: 0, started: false, given_up: false, step: Step::empty() }
    }

    /// Takes a sample; gives the state as the filter has it (while the level is being found, the attitude as the
    /// gyroscope carries it), and the segment that it ends.
    pub(super) fn push(
        &mut self,
        sample: &Sample,
        rest: Option<bool>,
        pose: Option<(&OpticalPose, &OpticalNoise)>,
    ) -> (Nominal, Option<Segment<N>>) {
        let k = self.next;
        self.next += 1;
        let carried = |runner: &Runner<N, E>| match &runner.level {
            Some(level) => Nominal { world_from_body: level.carried, ..runner.engines[0].nominal },
            None => runner.engines[0].nominal,
        };
        let lost_before = self.runner.heading_lost;
        match self.runner.take(sample, rest, pose, Some(&mut self.step)) {
            Event::Useless | Event::Levelling => (carried(&self.runner), None),
            Event::LevelBegins => {
                let q = carried(&self.runner);
                if !self.started || self.start >= k {
                    return (q, None);
                }
                let samples = self.start..k;
                self.start = k;
                let heading_lost = lost_before;
                let Engine { nominal, covariance, .. } = self.runner.engines[0];
                (
                    q,
                    Some(Segment {
                        samples,
                        kind: Kind::Tail,
                        before: nominal,
                        nominal,
                        covariance,
                        step: self.step,
                        heading_lost,
                    }),
                )
            }
            Event::Levelled => {
                let segment = self.levelled(k + 1);
                (segment.before, Some(segment))
            }
            Event::Moved => (self.runner.engines[0].nominal, None),
            Event::Closed => {
                let segment = self.end(k + 1, Kind::Interval, self.step.before);
                (segment.before, Some(segment))
            }
            Event::GivenUp => {
                self.given_up = true;
                let mut segment = self.end(k + 1, Kind::Tail, self.step.before);
                segment.nominal = segment.before;
                (segment.before, Some(segment))
            }
        }
    }

    /// Ends the segment under way, with the recording.
    pub(super) fn finish(&mut self) -> Option<Segment<N>> {
        let rows = self.next;
        if self.start >= rows {
            return None;
        }
        if self.runner.finish_level() {
            return Some(self.levelled(rows));
        }
        let rest = self.runner.at_rest;
        let engine = &mut self.runner.engines[0];
        self.step.before = engine.nominal;
        let kind = if engine.sums.time_s > 0.0 { Kind::Interval } else { Kind::Tail };
        engine.close(rest, None, Some(&mut self.step));
        Some(self.end(rows, kind, self.step.before))
    }

    fn levelled(&mut self, end: usize) -> Segment<N> {
        let carried = self.runner.last_level.map_or(Quaternion::IDENTITY, |level| level.carried);
        let carried = Nominal { world_from_body: carried, ..self.runner.engines[0].nominal };
        let kind = if self.started && !self.given_up { Kind::Level } else { Kind::Start };
        self.started = true;
        self.given_up = false;
        self.end(end, kind, carried)
    }

    fn end(&mut self, end: usize, kind: Kind, before: Nominal) -> Segment<N> {
        let samples = self.start..end;
        self.start = end;
        let engine = &self.runner.engines[0];
        Segment {
            samples,
            kind,
            before,
            nominal: engine.nominal,
            covariance: engine.covariance,
            step: self.step,
            heading_lost: self.runner.heading_lost,
        }
    }
}

impl<const N: usize> Forward<N, 1> {
    /// The next segment of a recording; `state` receives each sample's state as the filter has it.
    pub(super) fn segment(
        &mut self,
        recording: &Recording<'_>,
        mut state: impl FnMut(usize, &Nominal),
    ) -> Option<Segment<N>> {
        while self.next < recording.acc.len() {
            let k = self.next;
            if let Some(&bound) = recording.bounds.get(k) {
                let model = &mut self.runner.engines[0].model;
                let density = if bound > 0.0 { 1.0 / bound } else { 0.0 };
                (model.speed_floor, model.position_spread) = (density, density);
            }
            let pose = recording.poses.get(k).and_then(Option::as_ref).map(|pose| (pose, &recording.noise));
            self.runner.ahead = recording.ahead(k + 1, &self.runner.settings);
            let (nominal, segment) = self.push(&recording.sample(k), Some(recording.rest[k]), pose);
            state(k, &nominal);
            if segment.is_some() {
                return segment;
            }
        }
        self.finish()
    }
}
