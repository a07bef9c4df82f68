//! Optical and inertial together: every frame of a take gets a pose, a source and an expected error.
//!
//! Clocks and mounting come from the rotation rates ([`crate::sync::rates`]), the lever arm and the true vertical
//! from the accelerometer ([`crate::sync::lever`]); with the sensor's biases and scales taken out, the bridging
//! smoother ([`crate::estimator::bridge`]) runs over the whole recording with the optical poses as measurements.
//! Frames that the cameras saw keep what they saw. In a gap the smoother's motion is taken, shifted by what it is
//! off beside the gap's two ends, so that next to nothing jumps: in position linearly from the one to the other, in
//! attitude as the mean of a Gauss–Markov process that is known at both ends.
//!
//! The smoother is cut where inertial samples are missing for longer than 0.1 s: a body in a hand may be anywhere after
//! that, and no more could be said than that. What lies in a gap before such a hole is held by the gap's beginning
//! only, what lies after it by the gap's end only; in between, and between two holes, there is no pose.
//!
//! Markers of the body that are seen while it is lost hold its position ([`markers`], [`fuse_with_markers`]).
//! [`delayed`] does the same to a stream, a second or two late.

pub mod delayed;
mod fill;
pub mod markers;
pub mod relative;

use alloc::vec::Vec;

use self::fill::{Motion, PIN_S, fill, forgetting, off};
use self::markers::Held;
use crate::alignment::Alignment;
use crate::error::{Error, Result};
use crate::estimator::{self, BridgeSettings, Calibration, OpticalPose, Points};
use crate::filter::{Dt, same_length};
use crate::frames::{Axes, Pose};
use crate::quaternion::Quaternion;
use crate::sync::gyro_path::Stamp;
use crate::sync::lever::{Lever, lever_arm};
use crate::sync::rates::{RatesSettings, Sync, synchronise};
use crate::vector::{self, Vec3};

/// Inertial samples this long before the first frame and after the last are used too, s.
const MARGIN_S: f64 = 2.0;
/// A lever arm that is known less well than this is not used, m.
const LEVER_SIGMA_M: f64 = 0.03;
/// Poses of neighbouring frames further apart than this many usual steps are not interpolated.
const NEIGHBOUR_STEPS: f64 = 1.5;
/// So often a gap is filled with the markers that agree with it as it was filled before: the better it is known, the
/// better it tells which do.
const ROUNDS: usize = 4;
/// Inertial samples further apart than this leave a hole, s, whatever the usual step is; steps up to so many usual ones
/// leave none.
const HOLE_S: f64 = 0.1;
const HOLE_STEPS: f64 = 1.5;

/// What the cameras saw: one row a frame.
#[derive(Clone, Copy, Debug)]
pub struct Optical<'a> {
    /// Time of each frame, s, ascending.
    pub time_s: &'a [f64],
    /// The body in a right-handed world; none where it was lost.
    pub poses: &'a [Option<Pose>],
}

/// What the sensor read.
#[derive(Clone, Copy, Debug)]
pub struct Inertial<'a> {
    /// Time of each sample on the sensor's clock, s, ascending.
    pub time_s: &'a [f64],
    /// Accelerometer, m/s², sensor axes.
    pub acc_m_s2: &'a [Vec3],
    /// Gyroscope, rad/s, sensor axes.
    pub gyro_rad_s: &'a [Vec3],
}

/// How the two are brought together.
#[derive(Clone, Debug, PartialEq)]
pub struct FuseSettings {
    /// How clocks and mounting are found.
    pub rates: RatesSettings,
    /// How well the cameras see; its lever arm is what remains after the found one, 0.005 m.
    pub optics: BridgeSettings,
    /// The world's axes, whose up is used where gravity does not show it well enough.
    pub axes: Axes,
    /// Size of gravity, m/s².
    pub gravity_m_s2: f64,
    /// Positions in gaps longer than this are marked as inertial, not bridged, s: 30.
    pub position_trust_s: f64,
}

impl Default for FuseSettings {
    fn default() -> Self {
        FuseSettings {
            rates: RatesSettings::default(),
            optics: BridgeSettings { lever_m: 0.005, ..BridgeSettings::default() },
            axes: Axes::YUp,
            gravity_m_s2: crate::STANDARD_GRAVITY_M_S2,
            position_trust_s: 30.0,
        }
    }
}

/// Where a frame's pose comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// The cameras.
    Optical,
    /// The sensor, held at both ends by the cameras, or at times by markers.
    Bridged,
    /// The sensor, held at one end only, for a hole in its samples or the recording's end lies on the other side, or
    /// for too long: the attitude goes on, the position is not to be trusted.
    Inertial,
    /// Neither: [`Unfilled`] says why.
    None,
}

impl Source {
    /// `optical`, `bridged`, `inertial`, `none`.
    pub fn name(self) -> &'static str {
        match self {
            Source::Optical => "optical",
            Source::Bridged => "bridged",
            Source::Inertial => "inertial",
            Source::None => "none",
        }
    }

    /// The number that programs are sent: 0 none, 1 optical, 2 bridged, 3 inertial.
    pub fn code(self) -> u8 {
        match self {
            Source::None => 0,
            Source::Optical => 1,
            Source::Bridged => 2,
            Source::Inertial => 3,
        }
    }
}

/// One frame of the result.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FusedFrame {
    /// The body, in the world it came in; none where the source is none.
    pub pose: Option<Pose>,
    /// Where it comes from.
    pub source: Source,
    /// Time since the cameras last saw the body or a marker that holds it, s; 0 where they see it.
    pub gap_s: f64,
    /// Expected error of the attitude (one standard deviation), rad; NaN where the source is none.
    pub sigma_rad: f64,
    /// Expected error of the position, m; NaN where the source is none.
    pub sigma_m: f64,
}

/// A gap and how it was filled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilledGap {
    /// First lost frame.
    pub first: usize,
    /// Frame after the last lost one.
    pub end: usize,
    /// From the frame before to the frame after, s.
    pub length_s: f64,
    /// How it was filled; none where a frame of it has no pose.
    pub source: Source,
    /// Largest expected errors, rad and m; NaN where not filled.
    pub sigma_rad: f64,
    /// As above, m.
    pub sigma_m: f64,
    /// Its frames without a pose.
    pub unfilled: Unfilled,
}

/// Frames of a gap that have no pose, by what is missing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Unfilled {
    /// Inertial samples.
    pub silent: usize,
    /// Something that holds the sensor: holes in the inertial samples lie on both sides.
    pub loose: usize,
    /// The tool's holder ([`relative`] only).
    pub holder: usize,
}

/// The whole take.
#[derive(Clone, Debug, PartialEq)]
pub struct Fusion {
    /// One a frame.
    pub frames: Vec<FusedFrame>,
    /// Its gaps.
    pub gaps: Vec<FilledGap>,
    /// Clocks and mounting.
    pub sync: Sync,
    /// Lever arm and vertical; none where there was too little unbroken motion to find them.
    pub lever: Option<Lever>,
    /// Up as it was used, in the optical world.
    pub up: Vec3,
    /// What was learnt of the sensor beyond the biases and scales that `sync` and `lever` hold.
    pub calibration: Calibration,
    /// Markers on the body, and where they hold it.
    pub held: Held,
}

/// Brings a take and a recording together.
///
/// Refused: unequal lengths, numbers that are not finite, times that do not ascend, and whatever
/// [`synchronise`] refuses: too little, no common motion, rotation about one axis only.
pub fn fuse(optical: &Optical<'_>, inertial: &Inertial<'_>, settings: &FuseSettings) -> Result<Fusion> {
    fuse_with_markers(optical, &[], inertial, settings)
}

/// As [`fuse`], with labelled markers of the body: of each its position in every frame, m, in the world of the poses,
/// none where it was not seen. Where one or more are seen the body's position is held though its pose is lost.
///
/// Refused also: a marker with another number of frames, positions that are not finite.
pub fn fuse_with_markers(
    optical: &Optical<'_>,
    markers: &[&[Option<Vec3>]],
    inertial: &Inertial<'_>,
    settings: &FuseSettings,
) -> Result<Fusion> {
    same_length(optical.time_s.len(), optical.poses.len())?;
    for marker in markers {
        same_length(optical.time_s.len(), marker.len())?;
        if let Some(row) = marker.iter().position(|seen| seen.is_some_and(|seen| !vector::is_finite(seen))) {
            return Err(Error::NotFinite { row });
        }
    }
    same_length(inertial.time_s.len(), inertial.acc_m_s2.len())?;
    check_poses(optical.poses)?;
    let attitude: Vec<Option<Quaternion>> =
        optical.poses.iter().map(|pose| pose.map(|pose| pose.world_from_body)).collect();
    let sync = synchronise(optical.time_s, &attitude, inertial.time_s, inertial.gyro_rad_s, &settings.rates)?;
    let all_s: Vec<f64> = inertial.time_s.iter().map(|time_s| sync.optical_time_s(*time_s)).collect();
    let (Some(&first_s), Some(&last_s)) = (optical.time_s.first(), optical.time_s.last()) else {
        return Err(Error::Empty);
    };
    let start = all_s.partition_point(|time_s| *time_s < first_s - MARGIN_S);
    let end = all_s.partition_point(|time_s| *time_s <= last_s + MARGIN_S).max(start);
    let time_s = &all_s[start..end];
    let (acc, gyro) = (&inertial.acc_m_s2[start..end], &inertial.gyro_rad_s[start..end]);
    if time_s.len() < 2 {
        return Err(Error::TooFewPoints { given: time_s.len(), needed: 2 });
    }
    let mut steps: Vec<f64> = time_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let step_s = middle(&mut steps.clone());
    let delay_s = if settings.rates.stamp == Stamp::End { 0.5 * step_s } else { 0.0 };
    let read_s: Vec<f64> = time_s.iter().map(|time_s| time_s - delay_s).collect();
    let lever =
        lever_arm(optical.time_s, optical.poses, &read_s, acc, sync.body_from_sensor, settings.gravity_m_s2)
            .ok()
            .filter(|lever| vector::norm(lever.sigma_m) < LEVER_SIGMA_M);
    let alignment = Alignment::found(&sync, lever.as_ref(), settings.axes.up(), settings.gravity_m_s2);

    steps.insert(0, step_s);
    let acc: Vec<Vec3> = acc.iter().map(|acc| alignment.force(*acc)).collect();
    let gyro: Vec<Vec3> = gyro.iter().map(|gyro| alignment.rate(*gyro)).collect();
    let seen = Seen::new(optical);
    let measured: Vec<Option<OpticalPose>> =
        time_s.iter().map(|time_s| seen.at(*time_s).map(|pose| alignment.sensor(&pose))).collect();
    let hole_s = HOLE_S.max(HOLE_STEPS * step_s);
    let mut estimator =
        estimator::Settings { gravity_m_s2: alignment.gravity_m_s2, gap_s: hole_s, ..Default::default() };
    estimator.calibration = None;
    let (dt, optics) = (Dt::PerSample(&steps), &settings.optics);
    let filled = |points: &[Points], held: &[bool]| {
        let (bridged, calibration) =
            estimator::bridge_by_points(&acc, &gyro, dt, &measured, points, optics, &estimator)?;
        let motion = Motion { time_s, bridged: &bridged, alignment: &alignment, hole_s };
        Ok::<_, Error>((fill(optical, held, &motion, settings), calibration))
    };
    let mut held =
        Held { places: markers::places(optical, markers), frames: alloc::vec![false; optical.poses.len()] };
    let ((mut frames, mut gaps), mut calibration) = filled(&[], &held.frames)?;
    let mut sightings = Vec::new();
    for _ in 0..ROUNDS {
        let believed = markers::believed(optical, markers, &held.places, &frames);
        let one = |frame: usize| {
            optical.poses[frame].is_none() && believed.iter().any(|seen| seen[frame].is_some())
        };
        let flags: Vec<bool> = (0..frames.len()).map(one).collect();
        if believed == sightings || flags == held.frames && !flags.contains(&true) {
            break;
        }
        let points = markers::points(optical, &believed, &held.places, &alignment, time_s);
        ((frames, gaps), calibration) = filled(&points, &flags)?;
        (sightings, held.frames) = (believed, flags);
    }
    Ok(Fusion { frames, gaps, sync, lever, up: alignment.up, calibration, held })
}

fn check_poses(poses: &[Option<Pose>]) -> Result<()> {
    let finite = |pose: &Pose| vector::is_finite(pose.position_m) && pose.world_from_body.is_finite();
    match poses.iter().position(|pose| pose.is_some_and(|pose| !finite(&pose))) {
        Some(row) => Err(Error::NotFinite { row }),
        None => Ok(()),
    }
}

/// Poses between the frames.
struct Seen<'a> {
    optical: &'a Optical<'a>,
    step_s: f64,
}

impl<'a> Seen<'a> {
    fn new(optical: &'a Optical<'a>) -> Self {
        let mut steps: Vec<f64> = optical.time_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
        Seen { optical, step_s: middle(&mut steps) }
    }

    fn at(&self, time_s: f64) -> Option<Pose> {
        let times = self.optical.time_s;
        let after = times.partition_point(|t| *t < time_s);
        let (last, next) = (after.checked_sub(1), times.get(after));
        if next == Some(&time_s) {
            return self.optical.poses[after];
        }
        let (last, next) = (last?, *next?);
        let width = next - times[last];
        if width > NEIGHBOUR_STEPS * self.step_s {
            return None;
        }
        let (a, b) = (self.optical.poses[last]?, self.optical.poses[after]?);
        Some(between(&a, &b, (time_s - times[last]) / width))
    }

    /// The pose of a frame, or between those around it where no more than so much time lies between them.
    fn across(&self, row: usize, longest_s: f64) -> Option<Pose> {
        let (times, poses) = (self.optical.time_s, self.optical.poses);
        if let Some(pose) = poses[row] {
            return Some(pose);
        }
        let near = |k: &usize| (times[*k] - times[row]).abs() <= longest_s;
        let last = (0..row).rev().take_while(near).find(|&k| poses[k].is_some())?;
        let next = (row + 1..times.len()).take_while(near).find(|&k| poses[k].is_some())?;
        let width = times[next] - times[last];
        let (a, b) = (poses[last]?, poses[next]?);
        (width <= longest_s).then(|| between(&a, &b, (times[row] - times[last]) / width))
    }
}

fn between(a: &Pose, b: &Pose, share: f64) -> Pose {
    let step = vector::sub(b.position_m, a.position_m);
    Pose {
        position_m: vector::add(a.position_m, vector::scale(step, share)),
        world_from_body: Quaternion::slerp(a.world_from_body, b.world_from_body, share).normalized(),
    }
}

/// The middle value; 0 for none.
fn middle(values: &mut [f64]) -> f64 {
    crate::sync::gyro_path::median(values)
}
