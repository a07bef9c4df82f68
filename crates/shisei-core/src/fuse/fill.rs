//! A gap's frames from the smoother's motion: shifted so that nothing jumps at the ends that hold it, and marked.

use alloc::vec::Vec;

use super::{FilledGap, FuseSettings, FusedFrame, Optical, Source, Unfilled};
use crate::alignment::Alignment;
use crate::estimator::{self, Bridged, OpticalPose};
use crate::frames::Pose;
use crate::math;
use crate::quaternion::Quaternion;
use crate::vector::{self, Vec3};

/// Over so much of sight beside a gap the smoother is compared with the cameras, s.
pub(super) const PIN_S: f64 = 0.1;
/// Frames at which the attitude may be off by more than this for want of samples are left out of that, rad.
const PIN_BEND_RAD: f64 = 4e-3;
/// How fast the rate changes where no sample says it, rad/s²: between two samples the attitude is a slerp. Over 0.02 to 0.1 s
/// it is 16 to 27 (RMS) in the middle one of BROAD's even trials, and 52 to 83 in the fastest.
const TURN_CHANGE: f64 = 50.0;
/// What the cameras are off in attitude depends on the attitude, and so is forgotten as the body turns: in this time,
/// s, where it is turned about.
const FORGET_S: f64 = 2.0;

/// The smoother's motion as a function of optical time.
pub(super) struct Motion<'a> {
    pub time_s: &'a [f64],
    pub bridged: &'a [Bridged],
    pub alignment: &'a Alignment,
    /// Steps longer than this are holes, s.
    pub hole_s: f64,
}

/// The body and the errors expected.
struct Moved {
    pose: Pose,
    sigma_rad: f64,
    sigma_m: f64,
    /// Of the attitude's, what it may be off for want of samples, rad.
    bend_rad: f64,
}

impl Motion<'_> {
    fn at(&self, time_s: f64) -> Option<Moved> {
        let after = self.time_s.partition_point(|t| *t < time_s);
        let last = after.checked_sub(1).or((self.time_s.first() == Some(&time_s)).then_some(0))?;
        let next = after.max(1);
        let (t0, t1) = (self.time_s[last], *self.time_s.get(next)?);
        let (a, b) = (&self.bridged[last], &self.bridged[next]);
        // while the smoother starts anew behind a hole it tells nothing
        let placed = a.sigma_position_m.is_finite() && b.sigma_position_m.is_finite();
        if t1 - t0 > self.hole_s || !placed {
            return None;
        }
        let (h, u) = (t1 - t0, (time_s - t0) / (t1 - t0));
        // a cubic through both positions and velocities
        let (u2, u3) = (u * u, u * u * u);
        let weights =
            [2.0 * u3 - 3.0 * u2 + 1.0, h * (u3 - 2.0 * u2 + u), 3.0 * u2 - 2.0 * u3, h * (u3 - u2)];
        let mut position_m = [0.0; 3];
        for axis in 0..3 {
            position_m[axis] = weights[0] * a.position_m[axis]
                + weights[1] * a.velocity_m_s[axis]
                + weights[2] * b.position_m[axis]
                + weights[3] * b.velocity_m_s[axis];
        }
        let q = Quaternion::slerp(a.state.world_from_body, b.state.world_from_body, u);
        let bend = 0.5 * TURN_CHANGE * h * h * u * (1.0 - u);
        let sigma = |state: &estimator::State| math::hypot(state.sigma_tilt_rad, state.sigma_heading_rad);
        Some(Moved {
            pose: self.alignment.body(&OpticalPose { world_from_body: q, position_m }),
            sigma_rad: math::hypot(sigma(&a.state).max(sigma(&b.state)), bend),
            sigma_m: a.sigma_position_m.max(b.sigma_position_m),
            bend_rad: bend,
        })
    }

    /// The times between which samples follow each other: of all stretches between holes, in order.
    fn stretches(&self) -> Vec<(f64, f64)> {
        let mut all = Vec::new();
        let mut from_s = None;
        for pair in self.time_s.windows(2) {
            from_s = from_s.or(Some(pair[0]));
            if pair[1] - pair[0] > self.hole_s {
                all.extend(from_s.take().map(|from_s| (from_s, pair[0])));
            }
        }
        all.extend(from_s.zip(self.time_s.last().copied()));
        all
    }
}

/// What the smoother is off by at a frame that was seen: a rotation vector and a shift in the world.
pub(super) fn off(seen: &Pose, moved: &Pose) -> (Vec3, Vec3) {
    let turn = seen.world_from_body.product(moved.world_from_body.conjugate()).to_rotation_vector();
    (turn, vector::sub(seen.position_m, moved.position_m))
}

/// Mean of what the smoother is off by over the frames that were seen next to a gap.
fn off_over(
    frames: impl Iterator<Item = usize>,
    optical: &Optical<'_>,
    motion: &Motion<'_>,
) -> Option<(Vec3, Vec3)> {
    let (mut turn, mut shift, mut count) = ([0.0; 3], [0.0; 3], 0.0);
    let (mut end_s, mut from_s) = (None, None);
    for frame in frames {
        let time_s = optical.time_s[frame];
        let away_s = (time_s - *end_s.get_or_insert(time_s)).abs();
        let (Some(seen), Some(moved)) = (optical.poses[frame], motion.at(time_s)) else { break };
        if moved.bend_rad > PIN_BEND_RAD && away_s <= motion.hole_s {
            continue;
        }
        if (time_s - *from_s.get_or_insert(time_s)).abs() > PIN_S {
            break;
        }
        let (by, along) = off(&seen, &moved.pose);
        turn = vector::add(turn, by);
        shift = vector::add(shift, along);
        count += 1.0;
    }
    (count > 0.0).then(|| (vector::scale(turn, 1.0 / count), vector::scale(shift, 1.0 / count)))
}

/// Weights of what is known at both ends of a gap for a Gauss–Markov process in between.
pub(super) fn forgetting(age_s: f64, length_s: f64) -> (f64, f64) {
    let kept = |seconds: f64| math::exp(-seconds / FORGET_S);
    let (from, to, across) = (kept(age_s), kept(length_s - age_s), kept(length_s));
    let free = 1.0 - across * across;
    if free <= 0.0 {
        return (1.0, 0.0);
    }
    ((from - across * to) / free, (to - across * from) / free)
}

/// `held`: frames in which a marker holds the position.
pub(super) fn fill(
    optical: &Optical<'_>,
    held: &[bool],
    motion: &Motion<'_>,
    settings: &FuseSettings,
) -> (Vec<FusedFrame>, Vec<FilledGap>) {
    let (time_s, poses) = (optical.time_s, optical.poses);
    let mut frames: Vec<FusedFrame> = poses
        .iter()
        .map(|pose| FusedFrame {
            pose: *pose,
            source: if pose.is_some() { Source::Optical } else { Source::None },
            gap_s: 0.0,
            sigma_rad: if pose.is_some() { settings.optics.attitude_rad } else { f64::NAN },
            sigma_m: if pose.is_some() { settings.optics.position_m } else { f64::NAN },
        })
        .collect();
    let stretches = motion.stretches();
    let mut gaps = Vec::new();
    let mut first = 0;
    while first < poses.len() {
        if poses[first].is_some() {
            first += 1;
            continue;
        }
        let end = (first..poses.len()).find(|&k| poses[k].is_some()).unwrap_or(poses.len());
        let before = first.checked_sub(1);
        let left = before.and_then(|last| off_over((0..=last).rev(), optical, motion));
        let right = off_over(end..poses.len(), optical, motion);
        let from_s = before.map_or(time_s[first], |frame| time_s[frame]);
        let to_s = time_s.get(end).copied().unwrap_or(time_s[end - 1]);
        let length_s = to_s - from_s;
        // times at which the position was last known and is known next
        let mut last_s = before.filter(|_| left.is_some()).map(|frame| time_s[frame]);
        let end_s = right.is_some().then_some(to_s);
        let mut next_held = first;
        let mut gap = FilledGap {
            first,
            end,
            length_s,
            source: Source::Bridged,
            sigma_rad: 0.0,
            sigma_m: 0.0,
            unfilled: Unfilled::default(),
        };
        for frame in first..end {
            let now_s = time_s[frame];
            if held[frame] {
                last_s = Some(now_s);
            }
            if next_held < end && (next_held < frame || !held[next_held]) {
                next_held = (frame..end).find(|&k| held[k]).unwrap_or(end);
            }
            let next_s = if next_held < end { Some(time_s[next_held]) } else { end_s };
            frames[frame].gap_s = now_s - last_s.unwrap_or(from_s);
            // what lies behind a hole holds nothing here
            let place = stretches.partition_point(|(_, until_s)| *until_s < now_s);
            let around = stretches.get(place).filter(|(since_s, _)| *since_s <= now_s);
            let Some(&(since_s, until_s)) = around else {
                gap.unfilled.silent += 1;
                continue;
            };
            let left = left.filter(|_| since_s <= from_s);
            let right = right.filter(|_| to_s <= until_s);
            let Some((from, to)) = left.or(right).zip(right.or(left)) else {
                gap.unfilled.loose += 1;
                continue;
            };
            let Some(moved) = motion.at(now_s) else {
                gap.unfilled.silent += 1;
                continue;
            };
            let last_s = last_s.filter(|last_s| since_s <= *last_s);
            let next_s = next_s.filter(|next_s| *next_s <= until_s);
            let unknown_s = last_s.zip(next_s).map_or(f64::INFINITY, |(last, next)| next - last);
            let trusted = unknown_s <= settings.position_trust_s;
            let source = if trusted { Source::Bridged } else { Source::Inertial };
            let share = if length_s > 0.0 { (now_s - from_s) / length_s } else { 0.0 };
            let mix = |(a, b): (Vec3, Vec3), (of_a, of_b): (f64, f64)| {
                vector::add(vector::scale(a, of_a), vector::scale(b, of_b))
            };
            let linear = (1.0 - share, share);
            let pinned = left.is_some() && right.is_some();
            let turning = if pinned { forgetting(now_s - from_s, length_s) } else { linear };
            let turn = Quaternion::from_rotation_vector(mix((from.0, to.0), turning));
            frames[frame].pose = Some(Pose {
                position_m: vector::add(moved.pose.position_m, mix((from.1, to.1), linear)),
                world_from_body: turn.product(moved.pose.world_from_body).normalized(),
            });
            frames[frame].source = source;
            frames[frame].sigma_rad = moved.sigma_rad;
            frames[frame].sigma_m = moved.sigma_m;
            if gap.source == Source::Bridged {
                gap.source = source;
            }
            gap.sigma_rad = gap.sigma_rad.max(moved.sigma_rad);
            gap.sigma_m = gap.sigma_m.max(moved.sigma_m);
        }
        if gap.unfilled != Unfilled::default() {
            gap.source = Source::None;
            (gap.sigma_rad, gap.sigma_m) = (f64::NAN, f64::NAN);
        }
        gaps.push(gap);
        first = end;
    }
    (frames, gaps)
}
