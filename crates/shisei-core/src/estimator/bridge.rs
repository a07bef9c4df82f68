//! Bridging: the smoother with an optical system that sees the sensor most of the time.
//!
//! Where a pose is seen it is measured (attitude, and position with an unknown lever arm); where it is not, the
//! inertial model carries on from both ends. In long gaps the motion is held near the last positions by a bound
//! that comes in with the gap's length, for there double integration runs away.

use alloc::vec::Vec;

use super::calibration::Calibration;
use super::engine::{OpticalNoise, OpticalPose, Point, Points};
use super::guard::Sample;
use super::model::{PHI, STATES_WITH_LEVER};
use super::online::{Estimator, State, check};
use super::runner::{Runner, heading_between};
use super::segments::Recording;
use super::settings::Settings;
use super::smoother::{CHUNK, InTurn, lengths, rests, run};
use super::told::told;
use crate::error::Result;
use crate::filter::{self, Dt, positive};
use crate::quaternion::Quaternion;
use crate::vector::{self, Vec3};

/// How well the optical system sees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BridgeSettings {
    /// Standard deviation of an optical attitude, rad: 0.0075 (0.43°), more than cameras scatter, because their errors
    /// last from frame to frame. Large values let gravity decide the tilt.
    pub attitude_rad: f64,
    /// Standard deviation of an optical position, m: 0.0005. In a gap it decides how well the
    /// velocity at its ends is known.
    pub position_m: f64,
    /// Standard deviation of the lever arm from sensor to the body's point, m, about zero: 0.02.
    pub lever_m: f64,
}

impl Default for BridgeSettings {
    fn default() -> Self {
        BridgeSettings { attitude_rad: 0.0075, position_m: 5e-4, lever_m: 0.02 }
    }
}

/// A sample's state with the optical body's motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bridged {
    /// Attitude in the optical world, rates and uncertainty.
    pub state: State,
    /// Velocity of the sensor, m/s.
    pub velocity_m_s: Vec3,
    /// Position of the optical body's point, m.
    pub position_m: Vec3,
    /// Its standard deviation, all axes together, m; infinite after a hole in the samples until the filter has started
    /// anew, for there it follows from nothing.
    pub sigma_position_m: f64,
}

/// Attitude and position of a recording of which some samples have an optical pose: the attitude must be the
/// sensor's (apply its mounting before), in a world with z up, on the sensor's clock.
///
/// Refused: as [`super::smooth`], another number of poses than samples, poses that are not finite, noise that is
/// not positive.
pub fn bridge(
    acc_m_s2: &[Vec3],
    gyro_rad_s: &[Vec3],
    dt: Dt<'_>,
    poses: &[Option<OpticalPose>],
    optics: &BridgeSettings,
    settings: &Settings,
) -> Result<(Vec<Bridged>, Calibration)> {
    bridge_by_points(acc_m_s2, gyro_rad_s, dt, poses, &[], optics, settings)
}

/// As [`bridge`], with the markers that are seen where there is no pose: one row a sample, or none at all.
pub(crate) fn bridge_by_points(
    acc_m_s2: &[Vec3],
    gyro_rad_s: &[Vec3],
    dt: Dt<'_>,
    poses: &[Option<OpticalPose>],
    points: &[Points],
    optics: &BridgeSettings,
    settings: &Settings,
) -> Result<(Vec<Bridged>, Calibration)> {
    lengths(acc_m_s2, gyro_rad_s, dt)?;
    filter::same_length(acc_m_s2.len(), poses.len())?;
    check(settings)?;
    let noise = optics.noise()?;
    for (row, pose) in poses.iter().enumerate() {
        if let Some(pose) = pose {
            pose.world_from_body.try_normalized().map_err(|error| error.at_row(row))?;
            filter::check_rows(&[pose.position_m], row)?;
        }
    }
    let sample = |k: usize| Sample { gyro_rad_s: gyro_rad_s[k], acc_m_s2: acc_m_s2[k], dt_s: dt.at(k) };
    let (optics_from_start, start_sigma_rad) = start_heading(sample, poses, settings)?;
    let start_from_optics = optics_from_start.conjugate();
    let centre = centre(poses);
    let place = |position_m: Vec3| start_from_optics.rotate(vector::sub(position_m, centre));
    let poses: Vec<Option<OpticalPose>> = poses
        .iter()
        .map(|pose| {
            pose.map(|pose| OpticalPose {
                world_from_body: start_from_optics.product(pose.world_from_body).normalized(),
                position_m: place(pose.position_m),
            })
        })
        .collect();
    let turned = |point: Point| Point { position_m: place(point.position_m), ..point };
    let points: Vec<Points> = points.iter().map(|row| row.map(|point| point.map(turned))).collect();
    let bounds = bounds(&poses, &points, dt);
    let told = told(acc_m_s2, gyro_rad_s, dt, &poses, settings);
    // the sample that ends a hole only ends what was before it: the next one is where the filter starts anew
    let ends_hole = |k: usize| k > 0 && dt.at(k) > settings.gap_s;
    let poses: Vec<_> = poses.iter().enumerate().map(|(k, pose)| pose.filter(|_| !ends_hole(k))).collect();
    let points: Vec<Points> = points
        .iter()
        .enumerate()
        .map(|(k, row)| if ends_hole(k) { Points::default() } else { *row })
        .collect();
    let mut recording = Recording {
        acc: acc_m_s2,
        gyro: gyro_rad_s,
        bias: [0.0; 3],
        dt,
        rest: &[],
        poses: &poses,
        noise,
        points: &points,
        bounds: &bounds,
        told: &told,
    };
    let rest = rests(&recording, settings);
    recording.rest = &rest;
    let settings =
        Settings { update_s: settings.update_s.min(UPDATE_S), heading_sigma_share: 1.0, ..*settings };
    let mut runner = Runner::<STATES_WITH_LEVER, 1>::new(&settings, [&settings.bridge], optics.lever_m);
    runner.engines[0].covariance.0[HEADING][HEADING] += start_sigma_rad * start_sigma_rad;
    let nothing = State::new(Quaternion::IDENTITY, [0.0; 3], [0.0; 3], [[0.0; 3]; 3], false);
    let blank =
        Bridged { state: nothing, velocity_m_s: [0.0; 3], position_m: [0.0; 3], sigma_position_m: 0.0 };
    let mut bridged = alloc::vec![blank; acc_m_s2.len()];
    let calibration = run(&recording, runner, CHUNK, &InTurn, |k, detail| {
        bridged[k] = Bridged {
            state: detail.state.turned(optics_from_start),
            velocity_m_s: optics_from_start.rotate(detail.velocity),
            position_m: vector::add(optics_from_start.rotate(detail.position), centre),
            sigma_position_m: detail.sigma_position,
        };
    });
    Ok((bridged, calibration))
}

/// The turn about z from the world in which the sensor's heading is zero at the start to that of the optics, and how
/// well it is known, rad: where the sensor is not seen from the start it is carried to its first pose.
fn start_heading(
    sample: impl Fn(usize) -> Sample,
    poses: &[Option<OpticalPose>],
    settings: &Settings,
) -> Result<(Quaternion, f64)> {
    let seen = poses.iter().enumerate().find_map(|(k, pose)| pose.map(|pose| (k, pose)));
    let Some((first, pose)) = seen.filter(|(first, _)| *first > 0) else {
        return Ok((Quaternion::IDENTITY, 0.0));
    };
    let mut estimator = Estimator::new(settings)?;
    (0..first).for_each(|k| {
        estimator.update(&sample(k));
    });
    let carried = estimator.update(&sample(first));
    Ok((heading_between(pose.world_from_body, carried.world_from_body), carried.sigma_heading_rad))
}

/// Longest time between updates, s: each takes one pose.
pub(super) const UPDATE_S: f64 = 0.035;

/// The error state of the heading.
const HEADING: usize = PHI + 2;

/// Gaps from this length on have their motion bounded, and fully from the second, s.
const BOUND_FROM_S: f64 = 3.0;
const BOUND_FULL_S: f64 = 30.0;

/// How strongly the motion is bounded in a gap of this length, 0 … 1.
pub(super) fn bound(length_s: f64) -> f64 {
    ((length_s - BOUND_FROM_S) / (BOUND_FULL_S - BOUND_FROM_S)).clamp(0.0, 1.0)
}

impl BridgeSettings {
    /// Refused: noise that is not positive.
    pub(super) fn noise(&self) -> Result<OpticalNoise> {
        positive("attitude_rad", self.attitude_rad)?;
        positive("position_m", self.position_m)?;
        positive("lever_m", self.lever_m)?;
        let BridgeSettings { attitude_rad, position_m, lever_m } = *self;
        Ok(OpticalNoise { attitude_rad, position_m, lever_m })
    }
}

/// Mean of the positions seen.
fn centre(poses: &[Option<OpticalPose>]) -> Vec3 {
    let (mut sum, mut count) = ([0.0; 3], 0.0);
    for pose in poses.iter().flatten() {
        count += 1.0;
        // a running mean: no sum that could overflow
        sum = vector::add(sum, vector::scale(vector::sub(pose.position_m, sum), 1.0 / count));
    }
    sum
}

/// How strongly the motion is bounded at each sample: by the length of the gap it lies in.
fn bounds(poses: &[Option<OpticalPose>], points: &[Points], dt: Dt<'_>) -> Vec<f64> {
    let seen = |k: usize| poses[k].is_some() || points.get(k).is_some_and(|points| points[0].is_some());
    let mut out = alloc::vec![0.0; poses.len()];
    let mut k = 0;
    while k < poses.len() {
        if seen(k) {
            k += 1;
            continue;
        }
        let end = (k..poses.len()).find(|&j| seen(j)).unwrap_or(poses.len());
        let length_s: f64 = (k..end).map(|j| dt.at(j)).filter(|step| step.is_finite()).sum();
        out[k..end].fill(bound(length_s));
        k = end;
    }
    out
}
