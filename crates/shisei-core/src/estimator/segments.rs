//! The forward pass over a recording, segment by segment, with what the backward pass needs of each.

use super::covariance::Covariance;
use super::engine::{OpticalNoise, OpticalPose, Step};
use super::guard::Sample;
use super::model::Nominal;
use super::runner::{Event, Runner};
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
    /// Attitude at its end, before the measurements.
    pub before: Quaternion,
    /// The state after them.
    pub nominal: Nominal,
    pub covariance: Covariance<N>,
    pub step: Step<N>,
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
}

impl Recording<'_> {
    pub fn sample(&self, k: usize) -> Sample {
        Sample { gyro_rad_s: self.gyro[k], acc_m_s2: self.acc[k], dt_s: self.dt.at(k) }
    }
}

/// A forward pass under way; a copy of it is a point to go on from.
#[derive(Clone, Debug)]
pub(super) struct Forward<const N: usize> {
    pub runner: Runner<N, 1>,
    next: usize,
    start: usize,
    started: bool,
    waiting: Option<Kind>,
}

impl<const N: usize> Forward<N> {
    pub fn new(runner: Runner<N, 1>) -> Self {
        Forward { runner, next: 0, start: 0, started: false, waiting: None }
    }

    /// The next segment; `attitude` receives each sample's attitude as the filter had it.
    pub fn segment(
        &mut self,
        recording: &Recording<'_>,
        mut attitude: impl FnMut(usize, Quaternion),
    ) -> Option<Segment<N>> {
        let mut step = Step::empty();
        while self.next < recording.acc.len() {
            let k = self.next;
            let before = self.runner.engines[0];
            let pose = recording.poses.get(k).and_then(Option::as_ref).map(|pose| (pose, &recording.noise));
            let event =
                self.runner.take(&recording.sample(k), Some(recording.rest[k]), pose, Some(&mut step));
            self.next += 1;
            match event {
                Event::Useless | Event::Levelling => {
                    let level = self.runner.level.map(|level| level.carried);
                    attitude(k, level.unwrap_or(before.nominal.world_from_body));
                }
                Event::LevelBegins => {
                    let carried = self.runner.level.map_or(Quaternion::IDENTITY, |level| level.carried);
                    attitude(k, carried);
                    if self.started && self.start < k {
                        let samples = self.start..k;
                        self.start = k;
                        let covariance = before.covariance;
                        let nominal = before.nominal;
                        let q = nominal.world_from_body;
                        return Some(Segment {
                            samples,
                            kind: Kind::Tail,
                            before: q,
                            nominal,
                            covariance,
                            step,
                        });
                    }
                }
                Event::Levelled => return Some(self.levelled(k, step, attitude)),
                Event::Moved => attitude(k, self.runner.engines[0].nominal.world_from_body),
                Event::Closed => {
                    attitude(k, step.before);
                    return Some(self.end(k + 1, Kind::Interval, step.before, step));
                }
                Event::GivenUp => {
                    attitude(k, step.before);
                    self.waiting = Some(Kind::Start);
                    let mut segment = self.end(k + 1, Kind::Tail, step.before, step);
                    segment.nominal.world_from_body = step.before;
                    return Some(segment);
                }
            }
        }
        self.last(recording.acc.len(), step, attitude)
    }

    /// What is left at the end of the recording.
    fn last(
        &mut self,
        rows: usize,
        mut step: Step<N>,
        attitude: impl FnMut(usize, Quaternion),
    ) -> Option<Segment<N>> {
        if self.start >= rows {
            return None;
        }
        if self.runner.finish_level() {
            return Some(self.levelled(rows - 1, step, attitude));
        }
        let engine = &mut self.runner.engines[0];
        step.before = engine.nominal.world_from_body;
        let kind = if engine.sums.time_s > 0.0 { Kind::Interval } else { Kind::Tail };
        let rest = self.runner.at_rest;
        engine.close(rest, None, Some(&mut step));
        Some(self.end(rows, kind, step.before, step))
    }

    fn levelled(
        &mut self,
        k: usize,
        step: Step<N>,
        mut attitude: impl FnMut(usize, Quaternion),
    ) -> Segment<N> {
        let carried = self.runner.last_level.map_or(Quaternion::IDENTITY, |level| level.carried);
        attitude(k, carried);
        let kind = if self.started { self.waiting.take().unwrap_or(Kind::Level) } else { Kind::Start };
        self.started = true;
        self.end(k + 1, kind, carried, step)
    }

    fn end(&mut self, end: usize, kind: Kind, before: Quaternion, step: Step<N>) -> Segment<N> {
        let samples = self.start..end;
        self.start = end;
        let engine = &self.runner.engines[0];
        Segment { samples, kind, before, nominal: engine.nominal, covariance: engine.covariance, step }
    }
}
