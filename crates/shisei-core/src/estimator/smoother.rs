//! The smoother: a recording's attitudes from all of its samples, earlier and later ones.
//!
//! A forward pass of the calm filter, then the backward pass. The forward pass is run twice: once to leave a copy
//! of the filter every [`CHUNK`] updates, and again for each chunk, from the last to the first, to have what the
//! backward pass needs of that chunk only. So the memory beside the result hardly grows with the recording, and the
//! result is that of one pass over all of it. While the backward pass goes through one chunk, the forward pass can
//! make the one before: [`Pair`].

use alloc::vec::Vec;

use super::backward::Adjoint;
use super::calibration::Calibration;
use super::covariance::Covariance;
use super::engine::{OpticalNoise, Step};
use super::guard::{Checked, Guard, Sample};
use super::model::{Nominal, PHI, POS, STATES, VEL};
use super::online::{State, check, stated};
use super::rest::RestFinder;
use super::runner::Runner;
use super::segments::{Chunk, Forward, Kind, Recording, Segment};
use super::settings::Settings;
use crate::error::{Error, Result};
use crate::filter::exponential::exp_half;
use crate::filter::{self, Dt};
use crate::quaternion::Quaternion;
use crate::vector::{self, Vec3};

/// Updates of a chunk: about 8 kB each, and two chunks at a time.
pub(super) const CHUNK: usize = 512;
/// How far before its discovery a rest began, as a share of [`super::RestLimits::hold_s`].
const REST_BACK: f64 = 0.7;
/// How long after its end a rest may still seem to be one: the first of a movement must not pass for a bias.
const REST_LATE_S: f64 = 0.2;

/// A step so many times as long as the shortest of its segment goes over a hole; its weight is the square of that, and
/// this at most.
const HOLE_STEPS: f64 = 2.5;
const HOLE_WEIGHT: f64 = 1e4;

/// How two pieces of work are done: [`InTurn`], or side by side by a caller that has threads. The result is the
/// same to the bit.
pub trait Pair {
    /// Does both and returns what `other` returns; `own` is done on the caller's thread.
    fn both<A: Send>(&self, other: impl FnOnce() -> A + Send, own: impl FnOnce()) -> A;
}

/// One after the other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct InTurn;

impl Pair for InTurn {
    fn both<A: Send>(&self, other: impl FnOnce() -> A + Send, own: impl FnOnce()) -> A {
        own();
        other()
    }
}

/// A recording's states, and what was learnt of the sensor.
#[derive(Clone, Debug, PartialEq)]
pub struct Smoothed {
    /// One state a sample.
    pub states: Vec<State>,
    /// The sensor at the end of the recording.
    pub calibration: Calibration,
}

/// Attitudes of a recording: accelerations m/s² and rates rad/s in body axes, and the steps between samples
/// (entry 0: the usual step).
///
/// Unreadable samples are treated as [`super::Estimator::update`] treats them. Refused: unequal lengths, no
/// samples, settings out of range.
pub fn smooth(acc_m_s2: &[Vec3], gyro_rad_s: &[Vec3], dt: Dt<'_>, settings: &Settings) -> Result<Smoothed> {
    let nothing = State::new(Quaternion::IDENTITY, [0.0; 3], [0.0; 3], [[0.0; 3]; 3], false);
    let mut states = alloc::vec![nothing; acc_m_s2.len()];
    let keep = |k: usize, state: &State| states[k] = *state;
    let calibration = smooth_each(acc_m_s2, gyro_rad_s, [0.0; 3], dt, settings, &InTurn, keep)?;
    Ok(Smoothed { states, calibration })
}

/// As [`smooth`], with less memory: `gyro_bias_rad_s` is taken off every rate first, and `state` receives every
/// sample's number and state, in an order of its own. Returns what was learnt of the sensor, without that bias.
pub fn smooth_each(
    acc_m_s2: &[Vec3],
    gyro_rad_s: &[Vec3],
    gyro_bias_rad_s: Vec3,
    dt: Dt<'_>,
    settings: &Settings,
    pair: &impl Pair,
    mut state: impl FnMut(usize, &State),
) -> Result<Calibration> {
    lengths(acc_m_s2, gyro_rad_s, dt)?;
    check(settings)?;
    let noise = OpticalNoise { attitude_rad: 1.0, position_m: 1.0, lever_m: 0.0 };
    let mut recording = Recording {
        acc: acc_m_s2,
        gyro: gyro_rad_s,
        bias: gyro_bias_rad_s,
        dt,
        rest: &[],
        poses: &[],
        noise,
        points: &[],
        bounds: &[],
        told: &[],
    };
    let rest = rests(&recording, settings);
    recording.rest = &rest;
    let runner = Runner::<STATES, 1>::new(settings, [&settings.calm], 0.0);
    Ok(run(&recording, runner, CHUNK, pair, |k, detail| state(k, &detail.state)))
}

pub(super) fn lengths(acc: &[Vec3], gyro: &[Vec3], dt: Dt<'_>) -> Result<()> {
    filter::same_length(acc.len(), gyro.len())?;
    if acc.is_empty() {
        return Err(Error::Empty);
    }
    match dt {
        Dt::Constant(_) => dt.check(acc.len()),
        Dt::PerSample(steps) => filter::same_length(acc.len(), steps.len()),
    }
}

/// Which samples are at rest: as found while they come, back to where it must have begun, and up to where it may
/// have ended.
pub(super) fn rests(recording: &Recording<'_>, settings: &Settings) -> Vec<bool> {
    let (mut guard, mut finder) = (Guard::default(), RestFinder::default());
    let rows = 0..recording.acc.len();
    let mut rest: Vec<bool> =
        rows.map(|k| rest_found(&mut guard, &mut finder, &recording.sample(k), settings)).collect();
    reach_back(&mut rest, recording.dt, settings);
    rest
}

/// Whether a sample is at rest, as found when it comes.
pub(super) fn rest_found(
    guard: &mut Guard,
    finder: &mut RestFinder,
    sample: &Sample,
    settings: &Settings,
) -> bool {
    let reading = match guard.check(sample, settings) {
        Checked::Useless => return false,
        Checked::AfterGap(reading, _) => {
            finder.restart();
            reading
        }
        Checked::Next(reading) => reading,
    };
    finder.update(&settings.rest, &reading)
}

/// Rests as they were found, back to where they must have begun, and up to where they may have ended.
pub(super) fn reach_back(rest: &mut [bool], dt: Dt<'_>, settings: &Settings) {
    let (mut left_s, mut before_end_s) = (0.0, REST_LATE_S);
    for k in (0..rest.len()).rev() {
        let step = dt.at(k);
        let joined = step > 0.0 && step <= settings.gap_s;
        if rest[k] {
            left_s = REST_BACK * settings.rest.hold_s;
            rest[k] = before_end_s >= REST_LATE_S;
            before_end_s = if joined { before_end_s + step } else { REST_LATE_S };
        } else {
            rest[k] = left_s > 0.0;
            before_end_s = 0.0;
        }
        left_s = if joined { left_s - step } else { 0.0 };
    }
}

/// A sample's state and what only the bridging form tells.
#[derive(Clone, Copy, Debug)]
pub(super) struct Detail {
    pub state: State,
    /// Velocity, m/s, and position of the optical body's point, m, world.
    pub velocity: Vec3,
    pub position: Vec3,
    pub sigma_position: f64,
}

/// Both passes; `sink` receives every sample's number and state.
pub(super) fn run<const N: usize>(
    recording: &Recording<'_>,
    runner: Runner<N, 1>,
    chunk: usize,
    pair: &impl Pair,
    mut sink: impl FnMut(usize, &Detail),
) -> Calibration {
    let settings = runner.settings;
    let model = runner.engines[0].model;
    let rows = recording.acc.len();
    let mut forward = Forward::new(runner);
    let mut points = alloc::vec![forward.clone()];
    let mut count = 0;
    loop {
        let (segment, sampled) = forward.sample(recording);
        count += usize::from(segment.is_some());
        if !sampled {
            break;
        }
        if count >= chunk && forward.is_between() && forward.next < rows {
            points.push(forward.clone());
            count = 0;
        }
    }
    let end = &forward.runner.engines[0];
    let before = settings.calibration.unwrap_or(Calibration::unknown(&model));
    let calibration = before.followed_by(&end.nominal, &end.covariance);

    let mut backward = Backward { recording, settings, adjoint: Adjoint::new() };
    let mut ready: Option<Chunk<N>> = None;
    let mut end = rows;
    while let Some(point) = points.pop() {
        let first = point.next;
        let made = pair.both(
            || Chunk::forward(point, recording, end),
            || {
                if let Some(chunk) = &ready {
                    backward.chunk(chunk, &mut sink);
                }
            },
        );
        ready = Some(made);
        end = first;
    }
    if let Some(chunk) = &ready {
        backward.chunk(chunk, &mut sink);
    }
    calibration
}

/// The backward pass over the last segments of a stream: `sink` receives the samples from the last to the first.
pub(super) fn backward<const N: usize>(
    recording: &Recording<'_>,
    settings: &Settings,
    chunk: &Chunk<N>,
    mut sink: impl FnMut(usize, &Detail),
) {
    let mut backward = Backward { recording, settings: *settings, adjoint: Adjoint::new() };
    backward.chunk(chunk, &mut sink);
}

/// The backward pass under way.
struct Backward<'a, const N: usize> {
    recording: &'a Recording<'a>,
    settings: Settings,
    adjoint: Adjoint<N>,
}

/// What the backward pass knows at an end of a segment.
struct Known<const N: usize> {
    smoothed: Nominal,
    error: [f64; N],
    /// Of the attitude, as stated.
    covariance: [Vec3; 3],
    sigma_position: f64,
}

impl<const N: usize> Backward<'_, N> {
    fn chunk(&mut self, chunk: &Chunk<N>, sink: &mut impl FnMut(usize, &Detail)) {
        for place in (0..chunk.segments.len()).rev() {
            let segment = &chunk.segments[place];
            let covariance = &chunk.covariances[place];
            let end = self.known(segment, covariance);
            back(&mut self.adjoint, segment.kind, &chunk.steps[place], covariance);
            let start = (segment.kind == Kind::Interval).then(|| {
                let before = if place == 0 { &chunk.before } else { &chunk.covariances[place - 1] };
                self.adjoint.error(before)
            });
            self.finish(chunk, segment, &end, start.as_ref(), sink);
        }
    }

    fn known(&self, segment: &Segment, p: &Covariance<N>) -> Known<N> {
        let error = self.adjoint.error(p);
        let attitude = self.adjoint.covariance(p, PHI);
        let bridging = N > STATES;
        let mut sigma_position = 0.0;
        if bridging {
            let place = self.adjoint.covariance(p, POS);
            sigma_position = crate::math::sqrt(place[0][0] + place[1][1] + place[2][2]);
        }
        // where poses are seen all noise is what it is said to be
        let covariance = if bridging {
            attitude
        } else {
            let share = self.settings.heading_sigma_share;
            let heading = attitude[2][2] * share * share + segment.heading_lost;
            stated(attitude, self.settings.smooth_sigma_share, heading)
        };
        Known { smoothed: segment.nominal.moved(&error), error, covariance, sigma_position }
    }

    /// How much of what a segment's correction changes from its start to its end comes in with each sample: alike, but
    /// for steps over a hole, of which bridging must not put the error on the samples around it.
    fn weights(&self, segment: &Segment) -> impl Iterator<Item = f64> + Clone {
        let dt = self.recording.dt;
        let steps = segment.samples.clone().map(move |k| dt.at(k));
        let usual = steps.clone().filter(|step| *step > 0.0).fold(f64::INFINITY, f64::min);
        steps.map(move |step| {
            let long = step / usual;
            if N > STATES && long > HOLE_STEPS { (long * long).min(HOLE_WEIGHT) } else { 1.0 }
        })
    }

    /// Corrects the samples of a segment: by what is known at its end, and within an interval by the mean of that
    /// and what is known at its start, weighted by [`Backward::weights`].
    fn finish(
        &self,
        chunk: &Chunk<N>,
        segment: &Segment,
        end: &Known<N>,
        start: Option<&[f64; N]>,
        sink: &mut impl FnMut(usize, &Detail),
    ) {
        let Known { smoothed, error, covariance, sigma_position } = end;
        let three = |e: &[f64; N], at: usize| [e[at], e[at + 1], e[at + 2]];
        let before = &segment.before;
        let (end_turn, end_place, end_speed) = match segment.kind {
            Kind::Tail => (three(error, PHI), three(error, POS), three(error, VEL)),
            _ => (
                smoothed.world_from_body.product(before.world_from_body.conjugate()).to_rotation_vector(),
                vector::sub(smoothed.position, before.position),
                vector::sub(smoothed.velocity, before.velocity),
            ),
        };
        let (start_turn, start_place, start_speed) = match start {
            Some(start) => (three(start, PHI), three(start, POS), three(start, VEL)),
            None => (end_turn, end_place, end_speed),
        };
        let blank = State::new(Quaternion::IDENTITY, [0.0; 3], smoothed.gyro_bias, *covariance, false);
        let shares = self.weights(segment);
        let all: f64 = shares.clone().sum();
        let mut so_far = 0.0;
        // while a start anew is sought the position follows from nothing
        let unplaced = matches!(segment.kind, Kind::Level | Kind::Anew);
        for ((place, k), weight) in segment.samples.clone().enumerate().zip(shares) {
            let passing = &chunk.passing[k - chunk.first];
            so_far += weight;
            let share = so_far / all;
            let between =
                |a: Vec3, b: Vec3| vector::add(vector::scale(a, 1.0 - share), vector::scale(b, share));
            let turn = between(start_turn, end_turn);
            let q = exp_half(vector::scale(turn, 0.5)).product(passing.world_from_body).normalized();
            let raw = self.recording.rate(k);
            let readable = raw.iter().all(|x| x.abs() <= self.settings.gyro_limit_rad_s);
            let rate = match (&self.settings.calibration, readable) {
                (_, false) => [0.0; 3],
                (Some(calibration), true) => smoothed.rate(calibration.correct_gyro(raw)),
                (None, true) => smoothed.rate(raw),
            };
            let rest = self.recording.rest[k];
            let state = State { world_from_body: q, rate_rad_s: rate, rest, ..blank };
            let own = vector::add(passing.position, between(start_place, end_place));
            let detail = Detail {
                state,
                velocity: vector::add(passing.velocity, between(start_speed, end_speed)),
                position: vector::add(own, q.rotate(smoothed.lever)),
                sigma_position: if unplaced && place + 1 < segment.samples.len() {
                    f64::INFINITY
                } else {
                    *sigma_position
                },
            };
            sink(k, &detail);
        }
    }
}

/// Back through a segment of any kind.
pub(super) fn back<const N: usize>(adjoint: &mut Adjoint<N>, kind: Kind, step: &Step, p: &Covariance<N>) {
    match kind {
        Kind::Interval => adjoint.back(step, p),
        Kind::Tail => {}
        Kind::Level => adjoint.restart(),
        Kind::Anew => adjoint.restart_all(),
        Kind::Start => adjoint.forget(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math;

    /// Swings about two axes, with a rest at the start, a gap in the middle and one unreadable sample.
    fn recording() -> (Vec<Vec3>, Vec<Vec3>, Vec<f64>) {
        let mut acc = Vec::new();
        let mut gyro = Vec::new();
        let mut dt = Vec::new();
        let mut q = Quaternion::IDENTITY;
        for k in 0..3000 {
            let t = f64::from(k) * 0.01;
            let size = if t < 3.0 { 0.0 } else { 1.0 };
            let rate = [size * math::sin(2.0 * t), size * 0.7 * math::cos(3.0 * t), 0.2 * size];
            q = q.product(exp_half(vector::scale(rate, 0.005))).normalized();
            gyro.push(vector::add(rate, [0.01, -0.01, 0.005]));
            acc.push(q.conjugate().rotate([0.3 * size * math::sin(5.0 * t), 0.0, 9.80665]));
            dt.push(if k == 1700 { 0.8 } else { 0.01 });
        }
        acc[900][1] = f64::NAN;
        (acc, gyro, dt)
    }

    fn plain<'a>(acc: &'a [Vec3], gyro: &'a [Vec3], dt: Dt<'a>) -> Recording<'a> {
        let noise = OpticalNoise { attitude_rad: 1.0, position_m: 1.0, lever_m: 0.0 };
        Recording {
            acc,
            gyro,
            bias: [0.0; 3],
            dt,
            rest: &[],
            poses: &[],
            noise,
            points: &[],
            bounds: &[],
            told: &[],
        }
    }

    #[test]
    fn chunks_change_no_bit() {
        let (acc, gyro, dt) = recording();
        let settings = Settings::default();
        let dt = Dt::PerSample(&dt);
        let mut recording = plain(&acc, &gyro, dt);
        let rest = rests(&recording, &settings);
        recording.rest = &rest;
        let states = |chunk: usize| {
            let runner = Runner::<STATES, 1>::new(&settings, [&settings.calm], 0.0);
            let mut out = alloc::vec![None; acc.len()];
            run(&recording, runner, chunk, &InTurn, |k, detail| out[k] = Some(detail.state));
            out
        };
        let whole = states(1_000_000);
        for chunk in 1..8 {
            assert_eq!(whole, states(chunk), "{chunk}");
        }
        assert!(whole.iter().all(|state| state.is_some_and(|state| state.world_from_body.is_finite())));
    }

    extern crate std;

    /// On two threads.
    struct SideBySide;

    impl Pair for SideBySide {
        fn both<A: Send>(&self, other: impl FnOnce() -> A + Send, own: impl FnOnce()) -> A {
            std::thread::scope(|scope| {
                let other = scope.spawn(other);
                own();
                other.join().unwrap()
            })
        }
    }

    #[test]
    fn threads_change_no_bit() {
        let (acc, gyro, dt) = recording();
        let (dt, settings) = (Dt::PerSample(&dt), Settings::default());
        let mut recording = plain(&acc, &gyro, dt);
        let rest = rests(&recording, &settings);
        recording.rest = &rest;
        let whole = smooth(&acc, &gyro, dt, &settings).unwrap();
        let runner = Runner::<STATES, 1>::new(&settings, [&settings.calm], 0.0);
        let mut seen = 0;
        let calibration = run(&recording, runner, 10, &SideBySide, |k, detail| {
            assert_eq!(detail.state, whole.states[k]);
            seen += 1;
        });
        assert_eq!((seen, calibration), (acc.len(), whole.calibration));
    }

    #[test]
    fn rests_reach_back_to_where_they_began() {
        let (acc, gyro, dt) = recording();
        let rest = rests(&plain(&acc, &gyro, Dt::PerSample(&dt)), &Settings::default());
        let first = rest.iter().position(|&r| r).unwrap();
        assert!((25..40).contains(&first), "{first}");
        assert!(!rest[310..].iter().any(|&r| r));
    }

    #[test]
    fn one_sample_is_enough_and_none_is_refused() {
        let one = smooth(&[[0.0, 0.0, 9.8]], &[[0.0; 3]], Dt::Constant(0.01), &Settings::default()).unwrap();
        assert!(one.states[0].world_from_body.angle() < 1e-12);
        assert_eq!(smooth(&[], &[], Dt::Constant(0.01), &Settings::default()), Err(Error::Empty));
    }
}
