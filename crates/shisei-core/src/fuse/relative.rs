//! A tool without markers, held by something that the cameras see: place from its holder, attitude from its sensor.
//!
//! At a reference frame the tool is known to stand at `grip` in its holder: `q₀ = q_parent(r) ⊗ grip`. From there on
//! the sensor turns it: with the estimator's attitude s(t), whose heading has no meaning outside the recording,
//!
//! `q(t) = A s(t) M,  A = heading of (q₀ s(r)*),  M = (A s(r))* q₀`,
//!
//! so that the tool stands as the reference says at the reference, and its tilt follows gravity ever after: only the
//! heading drifts. The axes of the tool are those of its sensor, but for what M takes up. The place is the holder's:
//! `p(t) = p_parent(t) + R_parent(t) grip_m`.

use alloc::vec::Vec;

use super::{FilledGap, FusedFrame, HOLE_S, Inertial, Optical, Seen, Source, Unfilled, check_poses, middle};
use crate::alignment;
use crate::error::{Error, Result};
use crate::estimator::{self, Calibration, State};
use crate::filter::{Dt, positive, same_length};
use crate::frames::{Axes, Pose};
use crate::math;
use crate::quaternion::Quaternion;
use crate::vector::{self, Vec3};

/// How the tool is held.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RelativeSettings {
    /// The tool's point in the holder's axes, m.
    pub grip_m: Vec3,
    /// Attitude of the tool (its sensor's axes) in the holder at the reference.
    pub grip: Quaternion,
    /// Row of the reference frame; none: the first with both.
    pub reference: Option<usize>,
    /// The holder's frames that are lost for no longer than this are bridged by a straight line, s: 0.5.
    pub hold_s: f64,
    /// The world's axes.
    pub axes: Axes,
    /// Size of gravity, m/s².
    pub gravity_m_s2: f64,
    /// Expected error of the holder's attitude, rad: 0.0052.
    pub attitude_rad: f64,
    /// Expected error of the holder's position, m: 0.003.
    pub position_m: f64,
}

impl Default for RelativeSettings {
    fn default() -> Self {
        RelativeSettings {
            grip_m: [0.0; 3],
            grip: Quaternion::IDENTITY,
            reference: None,
            hold_s: 0.5,
            axes: Axes::YUp,
            gravity_m_s2: crate::STANDARD_GRAVITY_M_S2,
            attitude_rad: 0.0052,
            position_m: 0.003,
        }
    }
}

/// The tool in every frame. Sources are `inertial` (attitude from the sensor, place from the holder) and `none`.
#[derive(Clone, Debug, PartialEq)]
pub struct Relative {
    /// One a frame; the gap's age is the time since the holder was last seen.
    pub frames: Vec<FusedFrame>,
    /// Stretches in which the holder was lost.
    pub gaps: Vec<FilledGap>,
    /// Row of the reference frame.
    pub reference: usize,
    /// Angle of M, rad: how far the tilt at the reference is from what the sensor says. Large where sensor and tool
    /// have different axes.
    pub tilt_off_rad: f64,
    /// What was learnt of the sensor.
    pub calibration: Calibration,
}

/// The sensor's attitudes over time.
struct Sensed<'a> {
    time_s: &'a [f64],
    states: &'a [State],
}

impl Sensed<'_> {
    /// Attitude, tilt's and heading's errors; none where there are no samples.
    fn at(&self, time_s: f64) -> Option<(Quaternion, f64, f64)> {
        let after = self.time_s.partition_point(|t| *t < time_s);
        let last = after.checked_sub(1).or((self.time_s.first() == Some(&time_s)).then_some(0))?;
        let next = after.max(1);
        let (t0, t1) = (self.time_s[last], *self.time_s.get(next)?);
        if t1 - t0 > HOLE_S {
            return None;
        }
        let (a, b) = (&self.states[last], &self.states[next]);
        let q = Quaternion::slerp(a.world_from_body, b.world_from_body, (time_s - t0) / (t1 - t0));
        Some((q, a.sigma_tilt_rad.max(b.sigma_tilt_rad), a.sigma_heading_rad.max(b.sigma_heading_rad)))
    }
}

/// The turn about z that is nearest to a rotation.
fn heading(q: Quaternion) -> Option<Quaternion> {
    let n = math::hypot(q.w, q.z);
    (n > 1e-6).then(|| Quaternion::new(q.w / n, 0.0, 0.0, q.z / n))
}

/// Places a tool: `optical` is its holder, `inertial` its sensor with times on the optical clock.
///
/// Refused: unequal lengths, numbers that are not finite, times that do not ascend, a gravity that is not positive;
/// [`Error::NoReference`] for a reference in which the holder was lost or the sensor silent; [`Error::TooFewPoints`]
/// where no frame has both; [`Error::Degenerate`] where the tool points straight down from what its sensor says, so
/// that no heading can be told.
pub fn relative(
    optical: &Optical<'_>,
    inertial: &Inertial<'_>,
    settings: &RelativeSettings,
) -> Result<Relative> {
    same_length(optical.time_s.len(), optical.poses.len())?;
    same_length(inertial.time_s.len(), inertial.acc_m_s2.len())?;
    same_length(inertial.time_s.len(), inertial.gyro_rad_s.len())?;
    check_poses(optical.poses)?;
    ascending(optical.time_s)?;
    ascending(inertial.time_s)?;
    positive("gravity", settings.gravity_m_s2)?;
    if !(vector::is_finite(settings.grip_m) && settings.grip.is_finite()) {
        return Err(Error::NotFinite { row: 0 });
    }
    if inertial.time_s.len() < 2 {
        return Err(Error::TooFewPoints { given: inertial.time_s.len(), needed: 2 });
    }
    let mut steps: Vec<f64> = inertial.time_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let usual = middle(&mut steps.clone());
    steps.insert(0, usual);
    let estimator = estimator::Settings { gravity_m_s2: settings.gravity_m_s2, ..Default::default() };
    let smoothed =
        estimator::smooth(inertial.acc_m_s2, inertial.gyro_rad_s, Dt::PerSample(&steps), &estimator)?;
    let sensed = Sensed { time_s: inertial.time_s, states: &smoothed.states };

    let both = |row: &usize| optical.poses[*row].is_some() && sensed.at(optical.time_s[*row]).is_some();
    let reference = match settings.reference {
        Some(row) if row < optical.poses.len() && both(&row) => row,
        Some(row) => {
            let seen = optical
                .poses
                .get(row)
                .ok_or(Error::OutOfRange { rule: "0 <= reference < frames", value: row as f64 })?;
            return Err(Error::NoReference { silent: seen.is_some() });
        }
        None => (0..optical.poses.len()).find(both).ok_or(Error::TooFewPoints { given: 0, needed: 1 })?,
    };
    let (Some(parent), Some((sensor, _, heading_then))) =
        (optical.poses[reference], sensed.at(optical.time_s[reference]))
    else {
        return Err(Error::TooFewPoints { given: 0, needed: 1 });
    };
    let level = alignment::level(settings.axes.up());
    let start = level.product(parent.world_from_body).product(settings.grip).normalized();
    let align = heading(start.product(sensor.conjugate())).ok_or(Error::Degenerate)?;
    let rest = align.product(sensor).conjugate().product(start).normalized();
    let back = level.conjugate().product(align);

    let seen = Seen::new(optical);
    let (mut last_s, arm_m) = (f64::NAN, vector::norm(settings.grip_m));
    let mut frames = Vec::with_capacity(optical.poses.len());
    for (row, &time_s) in optical.time_s.iter().enumerate() {
        if optical.poses[row].is_some() {
            last_s = time_s;
        }
        let gap_s = if last_s.is_nan() { time_s - optical.time_s[0] } else { time_s - last_s };
        let (holder, told) = (seen.across(row, settings.hold_s), sensed.at(time_s));
        frames.push(match (holder, told) {
            (Some(holder), Some((q, tilt, heading_now))) => {
                let q = back.product(q).product(rest).normalized();
                let place = holder.world_from_body.rotate(settings.grip_m);
                FusedFrame {
                    pose: Some(Pose {
                        position_m: vector::add(holder.position_m, place),
                        world_from_body: q,
                    }),
                    source: Source::Inertial,
                    gap_s,
                    sigma_rad: vector::norm([
                        settings.attitude_rad,
                        tilt,
                        math::hypot(heading_now, if row == reference { 0.0 } else { heading_then }),
                    ]),
                    sigma_m: math::hypot(settings.position_m, arm_m * settings.attitude_rad),
                }
            }
            _ => {
                FusedFrame { pose: None, source: Source::None, gap_s, sigma_rad: f64::NAN, sigma_m: f64::NAN }
            }
        });
    }
    let gaps = gaps(optical, &sensed, &frames);
    Ok(Relative { frames, gaps, reference, tilt_off_rad: rest.angle(), calibration: smoothed.calibration })
}

fn ascending(time_s: &[f64]) -> Result<()> {
    for (row, time) in time_s.iter().enumerate() {
        if !time.is_finite() {
            return Err(Error::NotFinite { row });
        }
        if row > 0 && *time <= time_s[row - 1] {
            return Err(Error::OutOfOrder { rule: "time_s ascends" });
        }
    }
    Ok(())
}

/// Where the holder was lost.
fn gaps(optical: &Optical<'_>, sensed: &Sensed<'_>, frames: &[FusedFrame]) -> Vec<FilledGap> {
    let mut gaps = Vec::new();
    let mut first = 0;
    while first < frames.len() {
        if optical.poses[first].is_some() {
            first += 1;
            continue;
        }
        let end = (first..frames.len()).find(|&k| optical.poses[k].is_some()).unwrap_or(frames.len());
        let time = |row: usize| optical.time_s[row.min(frames.len() - 1)];
        let mut unfilled = Unfilled::default();
        for row in (first..end).filter(|&row| frames[row].pose.is_none()) {
            let silent = sensed.at(optical.time_s[row]).is_none();
            unfilled.silent += usize::from(silent);
            unfilled.holder += usize::from(!silent);
        }
        let filled = unfilled == Unfilled::default();
        let largest = |of: fn(&FusedFrame) -> f64| {
            if filled { frames[first..end].iter().map(of).fold(0.0, f64::max) } else { f64::NAN }
        };
        gaps.push(FilledGap {
            first,
            end,
            length_s: time(end) - time(first.saturating_sub(1)),
            source: if filled { Source::Inertial } else { Source::None },
            sigma_rad: largest(|frame| frame.sigma_rad),
            sigma_m: largest(|frame| frame.sigma_m),
            unfilled,
        });
        first = end;
    }
    gaps
}
