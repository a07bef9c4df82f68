//! Filters on a stream of samples: start, gaps, rests, and the watch that starts them anew when what they say
//! can no longer be.

use super::between::{AHEAD, Between, Hole, Stepped, Trail};
use super::engine::{Engine, Sight};
use super::guard::{Checked, Guard, Reading, Sample};
use super::level::Leveller;
use super::model::{Nominal, STATES};
use super::rest::RestFinder;
use super::settings::{Model, Settings};
use super::watch::Watch;
use crate::filter::exponential::exp_half;
use crate::math;
use crate::quaternion::Quaternion;
use crate::vector::{self, Vec3};

/// What became of a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Event {
    /// It was of no use.
    Useless,
    /// It begins the search for the level, at the start or after a gap.
    LevelBegins,
    /// The same while the level was still being found: that ends with what is known of it.
    LevelCut,
    /// It helps to find the level.
    Levelling,
    /// It completes the level: the filters run again.
    Levelled,
    /// It moved the filters.
    Moved,
    /// It moved them and ended an interval.
    Closed,
    /// As `Closed`, and the filters are given up: the next sample begins anew, nothing learnt.
    GivenUp,
}

/// An accelerometer that at rest is off gravity by more than this, m/s², was not calibrated.
const UNCALIBRATED: f64 = 0.15;
/// What giving up adds to the variance of the heading, rad², and the most it can be.
const GIVEN_UP_HEADING: f64 = 1.0;
const LARGEST_HEADING: f64 = core::f64::consts::PI * core::f64::consts::PI;

/// A turn whose standard deviation about each axis is larger, rad, is as good as unknown: what is nearly a gap is one.
const UNKNOWN_TURN: f64 = 0.25;

/// The least share of a filter's standard deviation that a hole's turn is reckoned with: settings may say none.
const LEAST_SHARE: f64 = 0.05;

/// A time over which the filters do not go.
#[derive(Clone, Copy, Debug)]
struct Lost {
    /// The likely turn up to the sample that ends it.
    turn: Quaternion,
    /// What it adds to the variance of the heading, rad².
    variance: f64,
}

/// Holes of which later samples may tell more: one a sample at most.
const OPEN: usize = AHEAD + 1;

/// A hole that the filters went over.
#[derive(Clone, Copy, Debug)]
struct Open {
    hole: Hole,
    between: Between,
    /// The first filter's attitude in its middle.
    world_from_body: Quaternion,
    /// Samples since it ended, the one that did left out.
    after: usize,
    /// Whether the filters were told how well its turn is known.
    doubted: bool,
}

/// E filters of N error states on the same samples.
#[derive(Clone, Copy, Debug)]
pub(super) struct Runner<const N: usize, const E: usize> {
    pub settings: Settings,
    pub engines: [Engine<N>; E],
    pub level: Option<Leveller>,
    /// The rates after the sample to come, corrected, and how many, where they are known already.
    pub ahead: Option<([Stepped; AHEAD], usize)>,
    trail: Trail,
    /// Holes of which later samples may tell more, the newest first.
    open: [Option<Open>; OPEN],
    /// The level that the filters last started from.
    pub last_level: Option<Leveller>,
    pub at_rest: bool,
    guard: Guard,
    rest: RestFinder,
    started: bool,
    given_up: bool,
    /// Variance that gaps have added to the heading, rad².
    pub heading_lost: f64,
    watch: Watch,
    lever_m: f64,
}

impl<const N: usize, const E: usize> Runner<N, E> {
    pub(super) fn new(settings: &Settings, models: [&Model; E], lever_m: f64) -> Self {
        let start = |model: &Model| Self::fresh(settings, model, lever_m);
        Runner {
            settings: *settings,
            engines: models.map(start),
            level: None,
            last_level: None,
            ahead: None,
            trail: Trail::default(),
            open: [None; OPEN],
            at_rest: false,
            guard: Guard::default(),
            rest: RestFinder::default(),
            started: false,
            given_up: false,
            heading_lost: 0.0,
            watch: Watch::new(settings.gravity_m_s2),
            lever_m,
        }
    }

    fn fresh(settings: &Settings, model: &Model, lever_m: f64) -> Engine<N> {
        let known = settings.calibration.as_ref();
        let sigma = settings.level_sigma_rad;
        Engine::new(model, settings.gravity_m_s2, known, Quaternion::IDENTITY, sigma, lever_m)
    }

    /// Takes a sample. `rest` stands for the search for rests, which starts anew after it; `sight` is
    /// what the cameras saw at it.
    pub(super) fn take(&mut self, sample: &Sample, rest: Option<bool>, sight: Option<Sight<'_>>) -> Event {
        let ahead = self.ahead.take();
        let (mut reading, gap_s) = match self.guard.check(sample, &self.settings) {
            Checked::Useless => return Event::Useless,
            Checked::Next(reading) => (reading, None),
            Checked::AfterGap(reading, gap_s) => (reading, Some(gap_s)),
        };
        if gap_s.is_some() {
            self.trail.restart();
        }
        if !reading.gyro_known {
            self.trail.restart();
        }
        let bias = self.engines[0].nominal.gyro_bias;
        self.trail.push(
            reading.gyro,
            reading.dt_s,
            &bias,
            !reading.hole().is_some_and(|hole| hole.is_loss()),
        );
        let (rates, count) = ahead.unwrap_or(([([0.0; 3], 0.0); AHEAD], 0));
        let between = reading.hole().and_then(|hole| {
            let between = self.trail.between(hole, 0, &rates[..count], &bias)?;
            Some((hole, self.stated(hole, between)))
        });
        let lost = match (gap_s, between) {
            (Some(gap_s), _) => Some(Lost { turn: Quaternion::IDENTITY, variance: self.turned(gap_s) }),
            (None, Some((hole, between))) => self.lost(hole, &between),
            (None, None) => None,
        };
        if lost.is_some() {
            self.rest.restart();
            self.open = [None; OPEN];
        }
        if lost.is_some() && gap_s.is_none() {
            self.trail.restart();
            self.trail.push(reading.gyro, reading.dt_s, &bias, false);
        }
        self.at_rest = match rest {
            Some(rest) => {
                self.rest.restart();
                rest
            }
            None => self.rest.update(&self.settings.rest, &reading),
        };
        if let Some(lost) = &lost {
            self.heading_lost = (self.heading_lost + lost.variance).min(LARGEST_HEADING);
        }
        let cut = lost.is_some() && self.started && self.finish_level();
        let under_way = self.level.as_mut().filter(|_| gap_s.is_none());
        let begins = match (&lost, under_way) {
            (Some(lost), Some(level)) => {
                level.turn(&lost.turn);
                false
            }
            (Some(_), None) => true,
            (None, level) => self.given_up || (level.is_none() && !self.started),
        };
        if begins {
            let turn = lost.map_or(Quaternion::IDENTITY, |lost| lost.turn);
            let from = self.started.then(|| self.engines[0].nominal.world_from_body.product(turn));
            self.level = Some(Leveller::new(from));
            self.given_up = false;
        }
        if let Some(level) = &mut self.level {
            let nominal = &self.engines[0].nominal;
            level.add(&reading, nominal.rate(reading.gyro), nominal.force(reading.acc));
            let level = *level;
            if level.time_s + 0.5 * reading.dt_s < self.settings.level_s
                && !sight.is_some_and(Sight::tells_attitude)
            {
                return match (begins, cut) {
                    (true, true) => Event::LevelCut,
                    (true, false) => Event::LevelBegins,
                    (false, _) => Event::Levelling,
                };
            }
            self.start(&level, sight);
            return Event::Levelled;
        }
        if let Some((hole, between)) = between {
            self.pass(hole, between, ahead.is_none());
            if hole.is_loss() {
                for engine in &mut self.engines {
                    engine.fill(&reading, between.rate, hole.missing_s);
                }
                reading = Reading { dt_s: hole.usual_s, irregular: 0.0, ..reading };
            } else {
                reading.between = Some(between.rate);
            }
        }
        for engine in &mut self.engines {
            engine.add(&reading);
        }
        self.look_back();
        let time_s = self.engines[0].sums.time_s + 0.5 * reading.dt_s;
        if time_s >= self.settings.update_s { self.close(sight) } else { Event::Moved }
    }

    /// Variance of the heading that a gap of this length adds, rad²: by what the rate may have been, and by what it was.
    fn turned(&self, gap_s: f64) -> f64 {
        let rate = self.settings.gap_rate_rad_s;
        gap_s * gap_s * (rate * rate).max(self.of_heading(self.trail.variance(gap_s)))
    }

    /// What of a rate's variance is the heading's: that along the vertical, and no less than one axis' part, for a large
    /// turn mixes them.
    fn of_heading(&self, variance: Vec3) -> f64 {
        let up = self.engines[0].nominal.world_from_body.to_matrix()[2];
        let along = up[0] * up[0] * variance[0] + up[1] * up[1] * variance[1] + up[2] * up[2] * variance[2];
        along.max((variance[0] + variance[1] + variance[2]) / 3.0)
    }

    /// What of a filter's standard deviation of the heading is stated.
    fn sigma_share(&self) -> f64 {
        // where poses are seen all noise is what it is said to be
        if N > STATES { 1.0 } else { self.settings.heading_sigma_share.max(LEAST_SHARE) }
    }

    /// The rate in a hole with the variance that the filters are told. In a long one it may have been anything to a
    /// degree that reaches that of a gap with the gap's length.
    fn stated(&self, hole: Hole, mut between: Between) -> Between {
        if hole.is_long() {
            let part = hole.missing_s / self.settings.gap_s;
            let anything = self.settings.gap_rate_rad_s * part * part;
            let share = self.sigma_share();
            let known = self.of_heading(between.variance);
            // about all axes alike: what a tilt tells of a heading is not to be trusted where turns may be large
            between.variance = [(known + anything * anything) / (share * share); 3];
        }
        between
    }

    /// Whether the turn in a hole is known too badly for filters that take it for small. Optical poses tell it.
    fn lost(&self, hole: Hole, between: &Between) -> Option<Lost> {
        let length = self.sigma_share() * hole.missing_s;
        let variance = length * length * between.variance[0];
        if N > STATES || !hole.is_long() || variance < UNKNOWN_TURN * UNKNOWN_TURN {
            return None;
        }
        let nominal = &self.engines[0].nominal;
        let turn = |rate: Vec3, time_s: f64| exp_half(vector::scale(nominal.rate(rate), 0.5 * time_s));
        let step = self.guard.last_rate().map_or(Quaternion::IDENTITY, |rate| turn(rate, hole.usual_s));
        Some(Lost { turn: turn(between.rate, hole.missing_s).product(step), variance })
    }

    /// Notes a hole that begins now; `open`, if later samples may tell more of it.
    fn pass(&mut self, hole: Hole, between: Between, open: bool) {
        let turn = vector::scale(between.rate, 0.5 * hole.missing_s);
        let before = self.engines[0].nominal.world_from_body;
        let world_from_body = before.product(exp_half(vector::scale(turn, 0.5)));
        let mut passed = Open { hole, between, world_from_body, after: 0, doubted: false };
        if open {
            self.open.rotate_right(1);
            self.open[0] = Some(passed);
        } else {
            self.doubt(&mut passed);
        }
    }

    /// Corrects the turns in holes by the samples that came after them.
    fn look_back(&mut self) {
        let bias = self.engines[0].nominal.gyro_bias;
        for place in 0..self.open.len() {
            let Some(mut open) = self.open[place].take() else { continue };
            if open.after > 0
                && let Some(between) = self.trail.between(open.hole, open.after, &[], &bias)
            {
                let between = self.stated(open.hole, between);
                let off = vector::scale(vector::sub(between.rate, open.between.rate), open.hole.missing_s);
                let now_from_then = self.since(&open);
                let turn = exp_half(vector::scale(now_from_then.rotate(off), 0.5));
                for engine in &mut self.engines {
                    engine.nominal.world_from_body = engine.nominal.world_from_body.product(turn);
                }
                open.between = between;
            }
            open.after += 1;
            if open.after <= open.hole.later() {
                self.open[place] = Some(open);
            } else {
                self.doubt(&mut open);
            }
        }
    }

    /// The turn from a hole's middle to now: from the body's axes then to those now.
    fn since(&self, open: &Open) -> Quaternion {
        self.engines[0].nominal.world_from_body.conjugate().product(open.world_from_body)
    }

    /// Tells all filters how well the turn in a hole is known, once.
    fn doubt(&mut self, open: &mut Open) {
        if open.doubted {
            return;
        }
        open.doubted = true;
        let now_from_then = self.since(open);
        for engine in &mut self.engines {
            let then = engine.nominal.world_from_body.product(now_from_then);
            engine.sums.doubt(then, open.between.variance, open.hole.missing_s);
        }
    }

    /// The newest rate that the filters took, corrected by what was known of the sensor beforehand, rad/s.
    pub(super) fn last_rate(&self) -> Option<Vec3> {
        self.guard.last_rate()
    }

    /// Whether rates ahead can be of use for a sample after this step.
    pub(super) fn looks_ahead(&self, dt_s: f64) -> bool {
        !self.guard.is_usual(dt_s)
    }

    /// Ends a level that is still being found; false where there is none.
    pub(super) fn finish_level(&mut self) -> bool {
        let Some(level) = self.level else { return false };
        self.start(&level, None);
        true
    }

    /// Ends the level: all filters go on from there, each with its own heading.
    fn start(&mut self, level: &Leveller, sight: Option<Sight<'_>>) {
        let sigma = level.sigma(self.settings.level_sigma_rad, self.settings.gravity_m_s2);
        let off = if self.started { 0.0 } else { level.off_gravity(self.settings.gravity_m_s2) };
        let first = self.engines[0].nominal.world_from_body;
        for engine in &mut self.engines {
            let own = heading_between(engine.nominal.world_from_body, first);
            let mut q = own.product(level.attitude()).normalized();
            if let Some(pose) = sight.and_then(Sight::pose) {
                q = pose.world_from_body;
            }
            if let Some(Sight::Told(told)) = sight {
                engine.restart_told(told);
                continue;
            }
            engine.restart(q, sigma);
            if off > UNCALIBRATED {
                engine.doubt_accelerometer(1.5 * off);
            }
            let lever = engine.nominal.lever;
            let (place, arm) = match sight {
                Some(Sight::Pose(pose, _)) => (pose.position_m, lever),
                Some(Sight::Points([Some(point), ..])) => (point.position_m, vector::add(lever, point.arm_m)),
                _ => continue,
            };
            engine.nominal.position = vector::sub(place, q.rotate(arm));
        }
        self.level = None;
        self.last_level = Some(*level);
        self.started = true;
        self.watch = Watch::new(self.settings.gravity_m_s2);
    }

    fn close(&mut self, sight: Option<Sight<'_>>) -> Event {
        let mut open = core::mem::take(&mut self.open);
        open.iter_mut().flatten().for_each(|open| self.doubt(open));
        // what was seen has corrected the turns already
        self.open = if sight.is_some() { [None; OPEN] } else { open };
        let sums = &self.engines[0].sums;
        let strange = sums.blind_force_s == 0.0 && self.watch.update(sums.force, sums.time_s);
        for engine in &mut self.engines {
            engine.close(self.at_rest, sight);
        }
        if !strange && self.engines.iter().all(Engine::is_sound) {
            return Event::Closed;
        }
        for engine in &mut self.engines {
            let q = engine.nominal.world_from_body;
            let mut fresh = Self::fresh(&self.settings, &engine.model, self.lever_m);
            fresh.nominal = Nominal::new(if q.is_finite() { q } else { Quaternion::IDENTITY });
            fresh.step = engine.step;
            *engine = fresh;
        }
        self.given_up = true;
        self.open = [None; OPEN];
        self.heading_lost = (self.heading_lost + GIVEN_UP_HEADING).min(LARGEST_HEADING);
        Event::GivenUp
    }
}

/// The turn about the world's z that brings the heading of `from` nearest to that of `to`.
pub(crate) fn heading_between(to: Quaternion, from: Quaternion) -> Quaternion {
    let d = to.product(from.conjugate());
    let n = math::hypot(d.w, d.z);
    if n < 1e-9 {
        return Quaternion::IDENTITY;
    }
    Quaternion::new(d.w / n, 0.0, 0.0, d.z / n)
}
