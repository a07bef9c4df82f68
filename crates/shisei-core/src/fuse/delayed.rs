//! Optical and inertial together, a second or two late: a pose, a source and an expected error for every sample of a
//! sensor whose place on its body is known ([`Alignment`]).
//!
//! [`FixedLagBridge`] knows what came up to its lag after a sample. As in [`super::fuse`], what the cameras saw stays
//! as they saw it, and in a gap the estimate is shifted by what it is off beside the gap's ends: beside both where the
//! gap's end has come, else beside its beginning.

use alloc::collections::VecDeque;
use alloc::vec::Vec;

use super::{FusedFrame, PIN_S, Source, forgetting};
use crate::alignment::Alignment;
use crate::error::Result;
use crate::estimator::{BridgeSettings, Bridged, FixedLagBridge, LiveBridge, OpticalPose, Sample};
use crate::filter::positive;
use crate::frames::Pose;
use crate::math;
use crate::quaternion::Quaternion;
use crate::vector::{self, Vec3};

/// How a stream is fused with a delay.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DelayedSettings {
    /// How much later samples a sample waits for, s: 2. A gap is held at both ends while it is shorter, and about as
    /// well as a recording's while it is no longer than half of it.
    pub lag_s: f64,
    /// How well the cameras see.
    pub optics: BridgeSettings,
    /// Positions in gaps longer than this are marked as inertial, not bridged, s: 5.
    pub position_trust_s: f64,
}

impl Default for DelayedSettings {
    fn default() -> Self {
        let optics = BridgeSettings { lever_m: 0.005, ..BridgeSettings::default() };
        DelayedSettings { lag_s: 2.0, optics, position_trust_s: 5.0 }
    }
}

/// A stream under way.
#[derive(Clone, Debug)]
pub struct Delayed {
    alignment: Alignment,
    settings: DelayedSettings,
    bridge: FixedLagBridge,
    /// Samples that still wait: time, and the body as the cameras saw it.
    waiting: VecDeque<(f64, Option<Pose>)>,
    /// What the estimate was off by when the body was last seen: time, turn, shift.
    off: VecDeque<(f64, Vec3, Vec3)>,
    seen_s: Option<f64>,
    known: Vec<Bridged>,
}

impl Delayed {
    /// With nothing known but the alignment. Refused: as [`FixedLagBridge::new`].
    pub fn new(alignment: &Alignment, settings: &DelayedSettings) -> Result<Self> {
        let gravity_m_s2 = alignment.gravity_m_s2;
        let estimator = crate::estimator::Settings { gravity_m_s2, ..Default::default() };
        let bridge = FixedLagBridge::new(&settings.optics, &estimator, settings.lag_s)?;
        Self::of(alignment, settings, bridge)
    }

    /// Goes on from what a live bridge has learnt: the next sample is the one after its last. Refused: as
    /// [`FixedLagBridge::after`].
    pub fn after(live: &LiveBridge, alignment: &Alignment, settings: &DelayedSettings) -> Result<Self> {
        Self::of(alignment, settings, FixedLagBridge::after(live, settings.lag_s)?)
    }

    fn of(alignment: &Alignment, settings: &DelayedSettings, bridge: FixedLagBridge) -> Result<Self> {
        positive("position_trust_s", settings.position_trust_s)?;
        Ok(Delayed {
            alignment: *alignment,
            settings: *settings,
            bridge,
            waiting: VecDeque::new(),
            off: VecDeque::new(),
            seen_s: None,
            known: Vec::new(),
        })
    }

    /// Takes a sample as the sensor gave it, its time in s (ascending), and the body in the optical world where the
    /// cameras saw it then; appends the samples that have waited long enough to `out`, in order, each with its time:
    /// the body in the optical world. Its expected position error is infinite where the position does not follow
    /// from one that was seen; before the first pose there is none.
    pub fn update(
        &mut self,
        time_s: f64,
        sample: &Sample,
        pose: Option<&Pose>,
        out: &mut Vec<(f64, FusedFrame)>,
    ) {
        let alignment = &self.alignment;
        let reading = Sample {
            gyro_rad_s: alignment.rate(sample.gyro_rad_s),
            acc_m_s2: alignment.force(sample.acc_m_s2),
            dt_s: sample.dt_s,
        };
        let fit = |pose: &&Pose| vector::is_finite(pose.position_m) && pose.world_from_body.is_finite();
        let pose = pose.filter(fit);
        self.waiting.push_back((time_s, pose.copied()));
        let seen = pose.map(|pose| alignment.sensor(pose));
        self.known.clear();
        self.bridge.update(&reading, seen.as_ref(), &mut self.known);
        self.give_out(out);
    }

    /// Appends the samples that still wait, at the end of the stream.
    pub fn finish(mut self, out: &mut Vec<(f64, FusedFrame)>) {
        let bridge = self.bridge.clone();
        self.known.clear();
        bridge.finish(&mut self.known);
        self.give_out(out);
    }

    /// Gives out the samples of which `known` tells.
    fn give_out(&mut self, out: &mut Vec<(f64, FusedFrame)>) {
        // how it goes on, as far as that is known
        let count = self.known.len();
        if count == 0 {
            return;
        }
        self.known.extend_from_slice(self.bridge.ahead());
        let mut end: Option<GapEnd> = None;
        for row in 0..count {
            let Some(&(time_s, pose)) = self.waiting.get(row) else { break };
            let frame = if let Some(pose) = pose {
                self.remember(time_s, &pose, row);
                end = None;
                self.seen(pose)
            } else if let Some(seen_s) = self.seen_s {
                let end = *end.get_or_insert_with(|| self.gap_end(row));
                self.filled(row, time_s, seen_s, &end)
            } else {
                NOTHING
            };
            out.push((time_s, frame));
        }
        self.waiting.drain(..count.min(self.waiting.len()));
    }

    fn seen(&self, pose: Pose) -> FusedFrame {
        let optics = &self.settings.optics;
        FusedFrame {
            pose: Some(pose),
            source: Source::Optical,
            gap_s: 0.0,
            sigma_rad: optics.attitude_rad,
            sigma_m: optics.position_m,
        }
    }

    /// The body as the estimate has it at a row.
    fn estimated(&self, row: usize) -> Option<Pose> {
        let Bridged { state, position_m, .. } = *self.known.get(row)?;
        Some(self.alignment.body(&OpticalPose { world_from_body: state.world_from_body, position_m }))
    }

    /// What the estimate is off by at a row that was seen, where its position follows from one that was seen.
    fn off(&self, row: usize, seen: &Pose) -> Option<(Vec3, Vec3)> {
        let estimated = self.estimated(row)?;
        let placed = self.known[row].sigma_position_m.is_finite();
        placed.then(|| super::off(seen, &estimated))
    }

    fn remember(&mut self, time_s: f64, seen: &Pose, row: usize) {
        // what was off on the other side of a gap says nothing any more
        if self.seen_s.is_some_and(|seen_s| time_s - seen_s > PIN_S) {
            self.off.clear();
        }
        self.seen_s = Some(time_s);
        if let Some((turn, shift)) = self.off(row, seen) {
            self.off.push_back((time_s, turn, shift));
        }
        while self.off.front().is_some_and(|(then_s, ..)| time_s - then_s > PIN_S) {
            self.off.pop_front();
        }
    }

    /// The first sight after a row, and what the estimate is off by there.
    fn gap_end(&self, row: usize) -> GapEnd {
        let seen = |&(_, pose): &(f64, Option<Pose>)| pose.is_some();
        let mut later = self.waiting.iter().enumerate().skip(row);
        let Some((first, (from_s, _))) = later.find(|(_, row)| seen(row)) else { return GapEnd::default() };
        let near = self.waiting.iter().enumerate().skip(first);
        let near = near.take_while(|(_, row)| seen(row) && row.0 - from_s <= PIN_S);
        let offs = near.filter_map(|(row, (_, pose))| self.off(row, pose.as_ref()?));
        GapEnd { time_s: Some(*from_s), off: mean(offs) }
    }

    /// A sample in a gap.
    fn filled(&self, row: usize, time_s: f64, seen_s: f64, end: &GapEnd) -> FusedFrame {
        let Some(estimated) = self.estimated(row) else { return NOTHING };
        let Bridged { state, sigma_position_m, .. } = &self.known[row];
        let left = mean(self.off.iter().map(|(_, turn, shift)| (*turn, *shift)));
        let ((turn, shift), closed) = match (left, end.time_s.zip(end.off)) {
            (Some(left), Some((end_s, right))) => {
                let (age_s, length_s) = (time_s - seen_s, end_s - seen_s);
                let share = age_s / length_s;
                let turn = mix(left.0, right.0, forgetting(age_s, length_s));
                ((turn, mix(left.1, right.1, (1.0 - share, share))), true)
            }
            (Some(only), None) | (None, Some((_, only))) => (only, false),
            (None, None) => (([0.0; 3], [0.0; 3]), false),
        };
        let unknown_s = end.time_s.filter(|_| closed).unwrap_or(time_s) - seen_s;
        let placed = sigma_position_m.is_finite() && unknown_s <= self.settings.position_trust_s;
        let turned = Quaternion::from_rotation_vector(turn).product(estimated.world_from_body);
        FusedFrame {
            pose: Some(Pose {
                position_m: vector::add(estimated.position_m, shift),
                world_from_body: turned.normalized(),
            }),
            source: if placed { Source::Bridged } else { Source::Inertial },
            gap_s: time_s - seen_s,
            sigma_rad: math::hypot(state.sigma_tilt_rad, state.sigma_heading_rad),
            sigma_m: *sigma_position_m,
        }
    }
}

/// The end of a gap, as far as it is known: when, and what the estimate is off by.
#[derive(Clone, Copy, Debug, Default)]
struct GapEnd {
    time_s: Option<f64>,
    off: Option<(Vec3, Vec3)>,
}

const NOTHING: FusedFrame =
    FusedFrame { pose: None, source: Source::None, gap_s: 0.0, sigma_rad: f64::NAN, sigma_m: f64::NAN };

fn mix(a: Vec3, b: Vec3, (of_a, of_b): (f64, f64)) -> Vec3 {
    vector::add(vector::scale(a, of_a), vector::scale(b, of_b))
}

/// Mean turn and shift; none of none.
fn mean(offs: impl Iterator<Item = (Vec3, Vec3)>) -> Option<(Vec3, Vec3)> {
    let (mut turn, mut shift, mut count) = ([0.0; 3], [0.0; 3], 0.0);
    for (by, along) in offs {
        turn = vector::add(turn, by);
        shift = vector::add(shift, along);
        count += 1.0;
    }
    (count > 0.0).then(|| (vector::scale(turn, 1.0 / count), vector::scale(shift, 1.0 / count)))
}
