//! Bridging with a delay: [`super::bridge`] over the last seconds of a stream.
//!
//! The samples of the last `lag_s` and a quarter more are kept, with a copy of the filter as it was at their
//! beginning. Whenever the quarter is full, forward and backward pass run over all that is kept: the samples of that
//! quarter are given out and the filter is moved on behind them. So every sample has been seen by at least `lag_s` of
//! later ones, a gap that is shorter comes out held at both ends, and a second of the stream costs about ten seconds
//! of filtering, whatever the lag. Rests reach back as in a recording; how strongly the motion is bounded follows from
//! how long a gap has lasted so far, as live.

use alloc::vec::Vec;

use super::bridge::{UPDATE_S, bound};
use super::engine::{OpticalNoise, OpticalPose};
use super::guard::{Guard, Sample};
use super::live_bridge::LiveBridge;
use super::model::STATES_WITH_LEVER;
use super::online::{State, check};
use super::rest::RestFinder;
use super::runner::Runner;
use super::segments::{Chunk, Forward, Kind, Recording, Segment};
use super::settings::Settings;
use super::smoother::{backward, reach_back, rest_found};
use super::{BridgeSettings, Bridged};
use crate::error::{Error, Result};
use crate::filter::Dt;
use crate::quaternion::Quaternion;
use crate::vector::{self, Vec3};

/// Longest lag, s.
const LONGEST_S: f64 = 10.0;
/// States come out in bunches of this share of the lag.
const BUNCH_SHARE: f64 = 0.25;
/// Samples that are kept at most, whatever their steps say.
const ROWS_MAX: usize = 16_384;

/// The delayed bridge. Memory: about 9 kB an update ([`Settings::update_s`], at most 35 ms) of lag while it computes,
/// 150 bytes a sample of lag otherwise.
#[derive(Clone, Debug)]
pub struct FixedLagBridge {
    /// The filter before the first sample that is kept.
    point: Forward<STATES_WITH_LEVER, 1>,
    noise: OpticalNoise,
    lag_s: f64,
    guard: Guard,
    finder: RestFinder,
    /// The first position seen: what the filter's positions count from, m.
    origin_m: Option<Vec3>,
    /// The position before the first sample that is kept follows from one that was seen.
    placed: bool,
    unseen_s: f64,
    rows: Rows,
    /// Length of what is kept, and of what came since the last pass, s.
    kept_s: f64,
    new_s: f64,
    ahead: Vec<Bridged>,
}

/// What is kept: one row a sample.
#[derive(Clone, Debug, Default)]
struct Rows {
    acc: Vec<Vec3>,
    gyro: Vec<Vec3>,
    dt_s: Vec<f64>,
    rest: Vec<bool>,
    poses: Vec<Option<OpticalPose>>,
    bounds: Vec<f64>,
}

impl Rows {
    fn push(&mut self, sample: &Sample, rest: bool, pose: Option<OpticalPose>, bound: f64) {
        self.acc.push(sample.acc_m_s2);
        self.gyro.push(sample.gyro_rad_s);
        self.dt_s.push(sample.dt_s);
        self.rest.push(rest);
        self.poses.push(pose);
        self.bounds.push(bound);
    }

    fn len(&self) -> usize {
        self.acc.len()
    }

    fn drop_first(&mut self, count: usize) {
        self.acc.drain(..count);
        self.gyro.drain(..count);
        self.dt_s.drain(..count);
        self.rest.drain(..count);
        self.poses.drain(..count);
        self.bounds.drain(..count);
    }
}

impl FixedLagBridge {
    /// A delay of `lag_s`, s, 0 … 10; useful ones are 0.5 to 3. Starts with the first sample that has a pose.
    /// Refused: as [`LiveBridge::new`], and a delay out of range.
    pub fn new(optics: &BridgeSettings, settings: &Settings, lag_s: f64) -> Result<Self> {
        check(settings)?;
        let noise = optics.noise()?;
        let settings =
            Settings { update_s: settings.update_s.min(UPDATE_S), heading_sigma_share: 1.0, ..*settings };
        let runner = Runner::new(&settings, [&settings.bridge], optics.lever_m);
        Self::of(Forward::new(runner), noise, lag_s)
    }

    /// Goes on from what a live bridge has learnt: the next sample is the one after its last. Refused: a delay out of
    /// range.
    pub fn after(live: &LiveBridge, lag_s: f64) -> Result<Self> {
        let (runner, noise, origin_m, placed) = live.parts();
        let bridge = Self::of(Forward::resumed(runner), noise, lag_s)?;
        Ok(FixedLagBridge { origin_m, placed, ..bridge })
    }

    fn of(point: Forward<STATES_WITH_LEVER, 1>, noise: OpticalNoise, lag_s: f64) -> Result<Self> {
        if !(0.0..=LONGEST_S).contains(&lag_s) {
            return Err(Error::OutOfRange { rule: "0 <= lag <= 10 s", value: lag_s });
        }
        Ok(FixedLagBridge {
            point,
            noise,
            lag_s,
            guard: Guard::default(),
            finder: RestFinder::default(),
            origin_m: None,
            placed: false,
            unseen_s: 0.0,
            rows: Rows::default(),
            kept_s: 0.0,
            new_s: 0.0,
            ahead: Vec::new(),
        })
    }

    /// Takes a sample and, where the cameras saw the sensor then, its pose, as [`LiveBridge::update`]; appends the
    /// states that have waited long enough to `out`, in order, one a sample. Before the first pose nothing is known
    /// and nothing waited for: `sigma_position_m` is infinite, as it is where a hole in the samples has cut the
    /// position off from all poses.
    pub fn update(&mut self, sample: &Sample, pose: Option<&OpticalPose>, out: &mut Vec<Bridged>) {
        let pose = pose.and_then(|pose| pose.counted_from(&mut self.origin_m));
        if self.origin_m.is_none() {
            out.push(unknown());
            return;
        }
        let step_s = if sample.dt_s > 0.0 && sample.dt_s < f64::INFINITY { sample.dt_s } else { 0.0 };
        self.unseen_s = if pose.is_some() { 0.0 } else { self.unseen_s + step_s };
        let rest = rest_found(&mut self.guard, &mut self.finder, sample, &self.point.runner.settings);
        self.rows.push(sample, rest, pose, bound(self.unseen_s));
        self.kept_s += step_s;
        self.new_s += step_s;
        let bunch_s = BUNCH_SHARE * self.lag_s;
        let due = self.new_s + 1e-9 >= bunch_s && self.kept_s + 1e-9 >= self.lag_s + bunch_s;
        if due || self.rows.len() >= ROWS_MAX {
            self.new_s = 0.0;
            self.pass(out);
        }
    }

    /// What the last pass says of the samples that still wait, oldest first: not the last word on them. Only the
    /// samples that came after that pass are missing at its end.
    pub fn ahead(&self) -> &[Bridged] {
        &self.ahead
    }

    /// Appends the states that still wait, at the end of the samples.
    pub fn finish(mut self, out: &mut Vec<Bridged>) {
        if self.rows.len() > 0 {
            self.smooth();
            out.append(&mut self.ahead);
        }
    }

    /// Smooths all that is kept, gives out what has waited long enough.
    fn pass(&mut self, out: &mut Vec<Bridged>) {
        self.smooth();
        let mut later_s = 0.0;
        let mut due = self.rows.len();
        while due > 0 && later_s + 1e-9 < self.lag_s {
            due -= 1;
            let step_s = self.rows.dt_s[due];
            later_s += if step_s > 0.0 && step_s < f64::INFINITY { step_s } else { 0.0 };
        }
        let count = self.go_on(due);
        out.extend(self.ahead.drain(..count));
        self.rows.drop_first(count);
        self.kept_s = self.rows.dt_s.iter().filter(|&&step_s| step_s > 0.0 && step_s < f64::INFINITY).sum();
    }

    /// Moves the filter on to the last end of an interval at or before sample `due`; the number of samples passed.
    fn go_on(&mut self, due: usize) -> usize {
        let (mut at, mut best) = (self.point.clone(), None);
        let mut placed = self.placed;
        // all that is kept must never be too much
        let full = self.rows.len() >= ROWS_MAX;
        let due = if full { self.rows.len() } else { due };
        let rest = self.rows.rest(&at.runner.settings);
        let recording = self.rows.recording(&rest, self.noise);
        while at.next < due {
            let (segment, _) = at.sample(&recording);
            if let Some(segment) = segment {
                placed = (placed && !starts(&segment)) || self.rows.sees(&segment);
            }
            if at.is_between() || (full && at.next == due) {
                best = Some((at.clone(), placed));
            }
        }
        let Some((mut point, placed)) = best else { return 0 };
        let count = point.next;
        point.count_anew();
        (self.point, self.placed) = (point, placed);
        count
    }

    /// Both passes over all that is kept, into `ahead`.
    fn smooth(&mut self) {
        let settings = self.point.runner.settings;
        let rest = self.rows.rest(&settings);
        let recording = self.rows.recording(&rest, self.noise);
        let chunk = Chunk::forward(self.point.clone(), &recording, self.rows.len());
        let origin_m = self.origin_m.unwrap_or([0.0; 3]);
        self.ahead.clear();
        self.ahead.resize(self.rows.len(), unknown());
        let ahead = &mut self.ahead;
        backward(&recording, &settings, &chunk, |k, detail| {
            ahead[k] = Bridged {
                state: detail.state,
                velocity_m_s: detail.velocity,
                position_m: vector::add(detail.position, origin_m),
                sigma_position_m: detail.sigma_position,
            };
        });
        self.cut_off(&chunk.segments);
    }

    /// Between two starts anew the position follows from the poses there, earlier and later ones; without any, and
    /// while the level was being found, it does not.
    fn cut_off(&mut self, segments: &[Segment]) {
        let mut first = 0;
        let mut placed = self.placed;
        while first < segments.len() {
            let more = segments.iter().skip(first + 1).position(starts);
            let end = more.map_or(segments.len(), |more| first + 1 + more);
            let stretch = &segments[first..end];
            placed |= stretch.iter().any(|segment| self.rows.sees(segment));
            for segment in stretch {
                let last = segment.samples.end;
                let unplaced = match starts(segment) {
                    true if self.rows.sees(segment) => segment.samples.start..last - 1,
                    false if placed => last..last,
                    _ => segment.samples.clone(),
                };
                for row in unplaced {
                    self.ahead[row].sigma_position_m = f64::INFINITY;
                }
            }
            (first, placed) = (end, false);
        }
    }
}

impl Rows {
    fn recording<'a>(&'a self, rest: &'a [bool], noise: OpticalNoise) -> Recording<'a> {
        Recording {
            acc: &self.acc,
            gyro: &self.gyro,
            bias: [0.0; 3],
            dt: Dt::PerSample(&self.dt_s),
            rest,
            poses: &self.poses,
            noise,
            points: &[],
            bounds: &self.bounds,
            told: &[],
        }
    }

    /// Rests, back to where they must have begun.
    fn rest(&self, settings: &Settings) -> Vec<bool> {
        let mut rest = self.rest.clone();
        reach_back(&mut rest, Dt::PerSample(&self.dt_s), settings);
        rest
    }

    /// A pose was measured at the end of this segment.
    fn sees(&self, segment: &Segment) -> bool {
        let last = segment.samples.end.checked_sub(1).and_then(|last| self.poses.get(last));
        segment.kind != Kind::Tail && last.is_some_and(Option::is_some)
    }
}

/// The filter was started anew in this segment.
fn starts(segment: &Segment) -> bool {
    matches!(segment.kind, Kind::Level | Kind::Anew | Kind::Start)
}

/// Nothing is known.
fn unknown() -> Bridged {
    let all = core::f64::consts::PI * core::f64::consts::PI;
    let covariance = [[all, 0.0, 0.0], [0.0, all, 0.0], [0.0, 0.0, all]];
    Bridged {
        state: State::new(Quaternion::IDENTITY, [0.0; 3], [0.0; 3], covariance, false),
        velocity_m_s: [0.0; 3],
        position_m: [0.0; 3],
        sigma_position_m: f64::INFINITY,
    }
}
