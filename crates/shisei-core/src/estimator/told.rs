//! Where the bridging smoother starts anew after a hole in the samples, of which none tells how the sensor moved.
//!
//! The next pose is carried back along the readings to the sample behind the one that ends the hole, so that all that
//! comes between is linear about the truth: found as the start of a recording is, from gravity alone, the attitude would
//! be off by too much. It must not count as a measurement, and so is said to be known several times less well than it
//! is.

use alloc::vec::Vec;

use super::engine::{OpticalPose, Told};
use super::settings::Settings;
use crate::filter::Dt;
use crate::filter::exponential::exp_half;
use crate::math;
use crate::quaternion::Quaternion;
use crate::vector::{self, Vec3};

/// The velocity at a pose is that which brings the sensor to where it is seen so much later, s; in less than the shortest
/// it is not known.
const SPEED_S: f64 = 0.1;
const SHORTEST_S: f64 = 0.03;
/// What is said of velocity and position at the pose, m/s and m, how it grows, per s, and the most that it is: the speed of
/// a hand, and a room.
const VELOCITY: f64 = 0.05;
const VELOCITY_GROWS: f64 = 0.3;
const VELOCITY_UNKNOWN: f64 = 3.0;
const POSITION: f64 = 0.02;
/// Longer than an update, so that one falls within, s.
const COARSE_S: f64 = 0.04;
const POSITION_UNKNOWN: f64 = 3.0;
/// Carried back for longer than this velocity and position say nothing, s.
const LONGEST_S: f64 = 4.0;

/// The samples, with z up.
struct Samples<'a> {
    acc: &'a [Vec3],
    gyro: &'a [Vec3],
    dt: Dt<'a>,
    settings: &'a Settings,
}

impl Samples<'_> {
    fn is_hole(&self, k: usize) -> bool {
        self.dt.at(k) > self.settings.gap_s
    }

    /// The first sample that comes so much later, s.
    fn after(&self, sample: usize, later_s: f64) -> usize {
        let mut time_s = 0.0;
        let rows = self.gyro.len();
        let far = |k: &usize| {
            time_s += self.dt.at(*k).max(0.0);
            time_s > later_s
        };
        (sample + 1..rows).find(far).unwrap_or(rows)
    }

    /// The turn of a step, and the length of the step; none where nothing could be read.
    fn turn(&self, k: usize) -> Option<(Vec3, f64)> {
        let (rate, step_s) = (self.gyro[k], self.dt.at(k));
        let readable = rate.iter().all(|x| x.abs() <= self.settings.gyro_limit_rad_s);
        (readable && step_s > 0.0).then_some((vector::scale(rate, step_s), step_s))
    }

    /// The acceleration of a step in the world, m/s², with the attitude in its middle.
    fn acceleration(&self, k: usize, world_from_body: Quaternion) -> Vec3 {
        let acc = self.acc[k];
        if !acc.iter().all(|x| x.abs() <= self.settings.acc_limit_m_s2) {
            return [0.0; 3];
        }
        vector::sub(world_from_body.rotate(acc), [0.0, 0.0, self.settings.gravity_m_s2])
    }

    /// The velocity at a pose, m/s, from where the sensor is seen next.
    fn velocity(&self, first: usize, pose: &OpticalPose, poses: &[Option<OpticalPose>]) -> Option<Vec3> {
        let (mut q, mut gained, mut moved, mut time_s) = (pose.world_from_body, [0.0; 3], [0.0; 3], 0.0);
        let mut found = None;
        for (k, pose_then) in poses.iter().enumerate().skip(first + 1) {
            if self.is_hole(k) || time_s >= SPEED_S {
                break;
            }
            let (Some((turn, step_s)), Some(then)) = (self.turn(k), pose_then) else { break };
            let half = exp_half(vector::scale(turn, 0.25));
            let push = vector::scale(self.acceleration(k, q.product(half)), step_s);
            moved = vector::add(moved, vector::scale(vector::add(gained, vector::scale(push, 0.5)), step_s));
            gained = vector::add(gained, push);
            q = q.product(half).product(half);
            time_s += step_s;
            if time_s >= SHORTEST_S {
                let seen = vector::sub(then.position_m, pose.position_m);
                found = Some(vector::scale(vector::sub(seen, moved), 1.0 / time_s));
            }
        }
        found
    }

    /// A pose, at sample `last`, carried back to an earlier sample.
    fn back(&self, sample: usize, last: usize, poses: &[Option<OpticalPose>]) -> Option<Told> {
        let pose = poses[last].as_ref()?;
        let known = self.velocity(last, pose, poses);
        let mut velocity = known.unwrap_or_default();
        let (mut q, mut place, mut time_s) = (pose.world_from_body, pose.position_m, 0.0);
        for k in (sample + 1..=last).rev() {
            let Some((turn, step_s)) = self.turn(k) else { continue };
            let half = exp_half(vector::scale(turn, -0.25));
            let push = vector::scale(self.acceleration(k, q.product(half)), step_s);
            let mean = vector::sub(velocity, vector::scale(push, 0.5));
            place = vector::sub(place, vector::scale(mean, step_s));
            velocity = vector::sub(velocity, push);
            q = q.product(half).product(half);
            time_s += step_s;
        }
        let drift = self.settings.bridge.gyro_bias_start * time_s;
        let speed = if known.is_some() { VELOCITY } else { VELOCITY_UNKNOWN };
        let moved = (speed + 0.5 * VELOCITY_GROWS * time_s) * time_s;
        if time_s > LONGEST_S {
            (velocity, place) = ([0.0; 3], pose.position_m);
        }
        Some(Told {
            sample,
            pose: OpticalPose { world_from_body: q.normalized(), position_m: place },
            velocity,
            sigma_rad: math::hypot(self.settings.level_sigma_rad, drift).min(1.0),
            sigma_m_s: (speed + VELOCITY_GROWS * time_s).min(VELOCITY_UNKNOWN),
            sigma_m: (POSITION + moved).min(POSITION_UNKNOWN),
            seen: last,
            coarse_until: [self.after(last, COARSE_S), self.after(last, 2.0 * COARSE_S)],
        })
    }
}

/// Where the filter starts anew, by ascending samples. The poses are those of the samples, in a world with z up.
pub(super) fn told(
    acc: &[Vec3],
    gyro: &[Vec3],
    dt: Dt<'_>,
    poses: &[Option<OpticalPose>],
    settings: &Settings,
) -> Vec<Told> {
    let samples = Samples { acc, gyro, dt, settings };
    let mut all = Vec::new();
    for sample in 2..poses.len() {
        // a pose is better than what is told
        if !samples.is_hole(sample - 1) || samples.is_hole(sample) || poses[sample].is_some() {
            continue;
        }
        let mut until_hole = (sample + 1..poses.len()).take_while(|&k| !samples.is_hole(k));
        let told =
            until_hole.find(|&k| poses[k].is_some()).and_then(|last| samples.back(sample, last, poses));
        all.extend(told);
    }
    all
}
