//! From a whole recording to a calibration: finds the still segments, chooses how still is still enough.

use alloc::vec::Vec;

use crate::calibration::known_turns::{Part, Parts};
use crate::calibration::multi_pose::{self, MultiPose, Pose, sphere_directions};
use crate::calibration::still::{StillSegment, StillSettings, still_segments};
use crate::error::{Error, Face, Result};
use crate::vector::{self, Vec3};

/// What was found in a recording.
#[derive(Clone, Debug)]
pub struct PosesFound {
    /// The still segments used, in order.
    pub segments: Vec<StillSegment>,
    /// The settings that gave them.
    pub settings: StillSettings,
    /// The calibration from them.
    pub calibration: MultiPose,
}

/// Nine-parameter calibration of a recording: acc and gyro N rows, one every `dt_s` s.
///
/// With `settings` none, several multiples of the noise floor (5, 10, 20, 50) are tried, and the one kept gives
/// the smallest largest standard error of |a| over all poses: few clean poses lose against many good ones.
pub fn calibrate_poses(
    acc: &[Vec3],
    gyro: &[Vec3],
    dt_s: f64,
    gravity_m_s2: f64,
    settings: Option<StillSettings>,
) -> Result<PosesFound> {
    let directions = sphere_directions(100);
    let mut best: Option<(f64, PosesFound)> = None;
    let mut refusal = Error::TooFewPoints { given: 0, needed: multi_pose::PARAMETERS };
    let tried: Vec<StillSettings> = settings.map_or_else(
        || {
            [5.0, 10.0, 20.0, 50.0]
                .map(|k| StillSettings { floor_multiple: k, ..StillSettings::default() })
                .into()
        },
        |s| alloc::vec![s],
    );
    for settings in tried {
        let segments = still_segments(acc, gyro, dt_s, &settings)?;
        let poses: Vec<Pose> = segments.iter().map(Pose::from_segment).collect();
        match multi_pose::calibrate(&poses, gravity_m_s2) {
            Ok(calibration) => {
                let worst = directions.iter().map(|u| calibration.sigma_of_norm(*u)).fold(0.0, f64::max);
                if best.as_ref().is_none_or(|b| worst < b.0) {
                    best = Some((worst, PosesFound { segments, settings, calibration }));
                }
            }
            Err(e) => refusal = e,
        }
    }
    best.map(|b| b.1).ok_or(refusal)
}

/// The nine parts of the six-face-and-three-turns procedure in a recording without labels: a face is the longest
/// still segment on it; a turn is the movement between two rests on the same face with the largest integral
/// about that axis.
///
/// Refuses with [`Error::FaceMissing`], or [`Error::TooFewPoints`] when an axis has no turn.
pub fn find_parts<'a>(acc: &'a [Vec3], gyro: &'a [Vec3], segments: &[StillSegment]) -> Result<Parts<'a>> {
    let empty = Part { acc: &[], gyro: &[] };
    let mut parts = Parts { up: [empty; 3], down: [empty; 3], turn: [empty; 3] };
    // the bias of raw counts may be large: faces are told apart from the middle of all poses
    let mut middle = [0.0; 3];
    for i in 0..3 {
        let low = segments.iter().map(|s| s.acc_mean[i]).fold(f64::INFINITY, f64::min);
        let high = segments.iter().map(|s| s.acc_mean[i]).fold(f64::NEG_INFINITY, f64::max);
        middle[i] = 0.5 * (low + high);
    }
    let face_of = |s: &StillSegment| {
        let d = vector::sub(s.acc_mean, middle);
        let axis = (0..3).fold(0, |a, i| if d[i].abs() > d[a].abs() { i } else { a });
        // within about 25° of the axis
        (d[axis].abs() > 0.9 * vector::norm(d)).then_some((axis, d[axis] > 0.0))
    };
    let part = |start: usize, end: usize| Part {
        acc: acc.get(start..end).unwrap_or(&[]),
        gyro: gyro.get(start..end).unwrap_or(&[]),
    };
    for segment in segments {
        if let Some((axis, positive)) = face_of(segment) {
            let slot = if positive { &mut parts.up[axis] } else { &mut parts.down[axis] };
            if segment.rows() > slot.acc.len() {
                *slot = part(segment.start, segment.end);
            }
        }
    }
    for axis in 0..3 {
        for (slot, positive) in [(&parts.up[axis], true), (&parts.down[axis], false)] {
            if slot.acc.is_empty() {
                return Err(Error::FaceMissing { face: Face { axis: axis as u8, positive } });
            }
        }
    }
    let mut largest = [0.0_f64; 3];
    for pair in segments.windows(2) {
        let [before, after] = pair else { continue };
        let (Some((axis, a)), Some((other, b))) = (face_of(before), face_of(after)) else { continue };
        if axis != other || a != b {
            continue;
        }
        let bias = 0.5 * (before.gyro_mean[axis] + after.gyro_mean[axis]);
        let turn = part(before.end, after.start);
        let total = turn.gyro.iter().map(|g| g[axis] - bias).sum::<f64>().abs();
        if total > largest[axis] {
            largest[axis] = total;
            parts.turn[axis] = turn;
        }
    }
    let turns = parts.turn.iter().filter(|t| !t.acc.is_empty()).count();
    if turns < 3 {
        return Err(Error::TooFewPoints { given: turns, needed: 3 });
    }
    Ok(parts)
}
