//! The smoother: a recording's attitudes from all of its samples, earlier and later ones.
//!
//! A forward pass of the calm filter, then the backward pass. The forward pass is run twice: once to leave a copy
//! of the filter every [`CHUNK`] updates, and again for each chunk, from the last to the first, to have what the
//! backward pass needs of that chunk only. So the memory beside the result does not grow with the recording (about
//! 25 MB), and the result is that of one pass over all of it.

use alloc::vec::Vec;

use super::backward::Adjoint;
use super::calibration::Calibration;
use super::engine::OpticalNoise;
use super::guard::{Checked, Guard};
use super::lag::back;
use super::model::{Nominal, POS, STATES, VEL};
use super::online::{State, check, stated};
use super::rest::RestFinder;
use super::runner::Runner;
use super::segments::{Forward, Kind, Recording, Segment};
use super::settings::Settings;
use crate::error::{Error, Result};
use crate::filter::exponential::exp_half;
use crate::filter::{self, Dt};
use crate::quaternion::Quaternion;
use crate::vector::{self, Vec3};

/// Updates of a chunk: about 12 kB each.
pub(super) const CHUNK: usize = 2048;
/// How far before its discovery a rest began, as a share of [`super::RestLimits::hold_s`].
const REST_BACK: f64 = 0.7;

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
    lengths(acc_m_s2, gyro_rad_s, dt)?;
    check(settings)?;
    let rest = rests(acc_m_s2, gyro_rad_s, dt, settings);
    let noise = OpticalNoise { attitude_rad: 1.0, position_m: 1.0, lever_m: 0.0 };
    let recording =
        Recording { acc: acc_m_s2, gyro: gyro_rad_s, dt, rest: &rest, poses: &[], noise, bounds: &[] };
    let runner = Runner::<STATES, 1>::new(settings, [&settings.calm], 0.0);
    let (details, calibration) = run(&recording, runner, CHUNK);
    Ok(Smoothed { states: details.into_iter().map(|detail| detail.state).collect(), calibration })
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

/// Which samples are at rest: as found while they come, and back to where it must have begun.
pub(super) fn rests(acc: &[Vec3], gyro: &[Vec3], dt: Dt<'_>, settings: &Settings) -> Vec<bool> {
    let (mut guard, mut finder) = (Guard::default(), RestFinder::default());
    let mut rest: Vec<bool> = Vec::with_capacity(acc.len());
    for k in 0..acc.len() {
        let sample = super::guard::Sample { gyro_rad_s: gyro[k], acc_m_s2: acc[k], dt_s: dt.at(k) };
        let reading = match guard.check(&sample, settings) {
            Checked::Useless => {
                rest.push(false);
                continue;
            }
            Checked::AfterGap(reading, _) => {
                finder.restart();
                reading
            }
            Checked::Next(reading) => reading,
        };
        rest.push(finder.update(&settings.rest, &reading));
    }
    let mut left_s = 0.0;
    for k in (0..rest.len()).rev() {
        if rest[k] {
            left_s = REST_BACK * settings.rest.hold_s;
        } else if left_s > 0.0 {
            rest[k] = true;
        }
        let step = dt.at(k);
        left_s = if step > 0.0 && step <= settings.gap_s { left_s - step } else { 0.0 };
    }
    rest
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

impl Detail {
    /// Keeps what the forward pass had, for the backward pass to correct.
    fn keep(&mut self, now: &Nominal) {
        self.state.world_from_body = now.world_from_body;
        self.velocity = now.velocity;
        self.position = now.position;
    }
}

/// A segment whose filter state is smoothed, and whose samples wait for the segment before.
struct Pending<const N: usize> {
    segment: Segment<N>,
    smoothed: Nominal,
    error: [f64; N],
    covariance: [Vec3; 3],
    sigma_position: f64,
}

/// Both passes.
pub(super) fn run<const N: usize>(
    recording: &Recording<'_>,
    runner: Runner<N, 1>,
    chunk: usize,
) -> (Vec<Detail>, Calibration) {
    let settings = runner.settings;
    let model = runner.engines[0].model;
    let mut forward = Forward::new(runner);
    let mut points = alloc::vec![forward.clone()];
    let mut segments: Vec<Segment<N>> = Vec::new();
    let rows = recording.acc.len();
    let nothing = State::new(Quaternion::IDENTITY, [0.0; 3], [0.0; 3], [[0.0; 3]; 3], false);
    let blank = Detail { state: nothing, velocity: [0.0; 3], position: [0.0; 3], sigma_position: 0.0 };
    let mut out = alloc::vec![blank; rows];
    let mut count = 0;
    while forward.segment(recording, |_, _| {}).is_some() {
        count += 1;
        if count % chunk == 0 {
            points.push(forward.clone());
        }
    }
    let end = &forward.runner.engines[0];
    let before = settings.calibration.unwrap_or(Calibration::unknown(&model));
    let calibration = before.followed_by(&end.nominal, &end.covariance);

    let mut adjoint = Adjoint::new(true);
    let mut pending: Option<Pending<N>> = None;
    for point in points.iter_mut().rev() {
        segments.clear();
        while segments.len() < chunk {
            let Some(segment) = point.segment(recording, |k, now| out[k].keep(now)) else {
                break;
            };
            segments.push(segment);
        }
        while let Some(segment) = segments.pop() {
            let error = adjoint.error(&segment.covariance);
            let smoothed = segment.nominal.moved(&error);
            if let Some(later) = pending.take() {
                finish(&mut out, recording, &settings, &later, Some(&error));
            }
            let covariance = adjoint.attitude_covariance(&segment.covariance);
            let sigma_position = if N > STATES {
                let sum: f64 = (0..3).map(|j| adjoint.variance(&segment.covariance, POS + j)).sum();
                crate::math::sqrt(sum)
            } else {
                0.0
            };
            back(&mut adjoint, &segment);
            pending = Some(Pending { segment, smoothed, error, covariance, sigma_position });
        }
    }
    if let Some(first) = pending {
        finish(&mut out, recording, &settings, &first, None);
    }
    (out, calibration)
}

/// Corrects the samples of a segment: by what is known at its end, and within an interval by the mean of that and
/// what is known at its start, weighted by time.
fn finish<const N: usize>(
    out: &mut [Detail],
    recording: &Recording<'_>,
    settings: &Settings,
    pending: &Pending<N>,
    start: Option<&[f64; N]>,
) {
    let Pending { segment, smoothed, error, covariance, sigma_position } = pending;
    // where poses are seen all noise is what it is said to be
    let covariance = if N > STATES {
        *covariance
    } else {
        let share = settings.heading_sigma_share;
        let heading = covariance[2][2] * share * share + segment.heading_lost;
        stated(*covariance, settings.smooth_sigma_share, heading)
    };
    let end_turn = match segment.kind {
        Kind::Tail => [error[0], error[1], error[2]],
        _ => {
            smoothed.world_from_body.product(segment.before.world_from_body.conjugate()).to_rotation_vector()
        }
    };
    let start_turn = match (segment.kind, start) {
        (Kind::Interval, Some(start)) => [start[0], start[1], start[2]],
        _ => end_turn,
    };
    let three = |e: &[f64; N], at: usize| [e[at], e[at + 1], e[at + 2]];
    let (end_place, end_speed) = match segment.kind {
        Kind::Tail => (three(error, POS), three(error, VEL)),
        _ => (
            vector::sub(smoothed.position, segment.before.position),
            vector::sub(smoothed.velocity, segment.before.velocity),
        ),
    };
    let (start_place, start_speed) = match (segment.kind, start) {
        (Kind::Interval, Some(start)) => (three(start, POS), three(start, VEL)),
        _ => (end_place, end_speed),
    };
    let count = segment.samples.len() as f64;
    for (place, k) in segment.samples.clone().enumerate() {
        let share = (place as f64 + 1.0) / count;
        let turn = vector::add(vector::scale(start_turn, 1.0 - share), vector::scale(end_turn, share));
        let q = exp_half(vector::scale(turn, 0.5)).product(out[k].state.world_from_body).normalized();
        let raw = recording.gyro[k];
        let readable = raw.iter().all(|x| x.abs() <= settings.gyro_limit_rad_s);
        let rate = match (&settings.calibration, readable) {
            (_, false) => [0.0; 3],
            (Some(calibration), true) => smoothed.rate(calibration.correct_gyro(raw)),
            (None, true) => smoothed.rate(raw),
        };
        out[k].state = State::new(q, rate, smoothed.gyro_bias, covariance, recording.rest[k]);
        let between = |a: Vec3, b: Vec3| vector::add(vector::scale(a, 1.0 - share), vector::scale(b, share));
        let own = vector::add(out[k].position, between(start_place, end_place));
        out[k].position = vector::add(own, q.rotate(smoothed.lever));
        out[k].velocity = vector::add(out[k].velocity, between(start_speed, end_speed));
        out[k].sigma_position = *sigma_position;
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

    #[test]
    fn chunks_change_no_bit() {
        let (acc, gyro, dt) = recording();
        let settings = Settings::default();
        let dt = Dt::PerSample(&dt);
        let rest = rests(&acc, &gyro, dt, &settings);
        let noise = OpticalNoise { attitude_rad: 1.0, position_m: 1.0, lever_m: 0.0 };
        let recording = Recording { acc: &acc, gyro: &gyro, dt, rest: &rest, poses: &[], noise, bounds: &[] };
        let runner = Runner::<STATES, 1>::new(&settings, [&settings.calm], 0.0);
        let whole = run(&recording, runner, 1_000_000).0;
        let parts = run(&recording, runner, 7).0;
        assert!(whole.iter().zip(&parts).all(|(a, b)| a.state == b.state));
        assert!(whole.iter().all(|detail| detail.state.world_from_body.is_finite()));
    }

    #[test]
    fn rests_reach_back_to_where_they_began() {
        let (acc, gyro, dt) = recording();
        let rest = rests(&acc, &gyro, Dt::PerSample(&dt), &Settings::default());
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
