//! One sensor and the body it is fixed to, brought together by frame number and exposure time.
//!
//! Frames and samples may come in any order relative to each other, and frames a little out of their own: a sample
//! is taken when every frame up to it is there. So what comes out depends on what was sent, not on when it arrived;
//! it is [`LiveBridge`] on the samples, each with the pose of the last frame carried on to it.

use std::collections::VecDeque;

use shisei_core::alignment::Alignment;
use shisei_core::estimator::{self, BridgeSettings, LiveBridge, OpticalPose};
use shisei_core::frames::Pose;
use shisei_core::{Quaternion, Result, Vec3, math, vector};

use crate::session::Sample;

/// A frame counts for samples up to so many frame intervals after it.
const CARRY_STEPS: f64 = 1.5;
/// The next frame is due after so many intervals; samples before that need not wait for it.
const DUE_STEPS: f64 = 0.9;
/// A missing frame is given up when so many later ones are there.
const LATE_FRAMES: usize = 6;
/// Frames and samples that wait at most.
const FRAMES_MAX: usize = 4096;
const WAITING_MAX: usize = 2048;
/// Over so much of sight the estimate is compared with the cameras, s.
const PIN_S: f64 = 0.05;
/// Samples of a node that started anew have nothing before them: a step that is a gap, s.
const ANEW_S: f64 = 10.0;

/// How the sensor's clock and the cameras' belong together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Clocking {
    /// The receiver counts the cameras' pulses: frame number = the sample's frame + this.
    Pulses {
        /// Frames.
        shift: f64,
    },
    /// By the receiver's clock: time = offset + (1 + skew) · exposure time.
    Times {
        /// Receiver's time at exposure time 0, s.
        offset_s: f64,
        /// Receiver's seconds in a second of exposure time, less 1.
        skew: f64,
    },
}

impl Clocking {
    /// Both by pulses, or both by times: what was compared before is in the same times.
    pub fn is_like(&self, other: &Clocking) -> bool {
        std::mem::discriminant(self) == std::mem::discriminant(other)
    }
}

/// A sensor on a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coupling {
    /// Mounting, lever arm, sensor errors, vertical.
    pub alignment: Alignment,
    /// Clocks.
    pub clocking: Clocking,
    /// From one frame to the next, s.
    pub step_s: f64,
}

impl Coupling {
    /// The time of a frame in which frames and samples are compared, s.
    pub fn frame_time_s(&self, number: i64, exposure_s: f64) -> f64 {
        match self.clocking {
            Clocking::Pulses { .. } => number as f64 * self.step_s,
            Clocking::Times { .. } => exposure_s,
        }
    }

    /// The same of a sample; none where the sample does not say.
    pub fn sample_time_s(&self, sample: &Sample) -> Option<f64> {
        match self.clocking {
            Clocking::Pulses { shift } => sample.frame.map(|frame| (frame + shift) * self.step_s),
            Clocking::Times { offset_s, skew } => {
                sample.time_s.map(|time_s| (time_s - offset_s) / (1.0 + skew))
            }
        }
    }
}

/// A body in a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// Number of the frame.
    pub number: i64,
    /// Middle of its exposure, s.
    pub exposure_s: f64,
    /// The body; none where it was not seen.
    pub pose: Option<Pose>,
}

/// A sample, taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moved {
    /// Its time, as frames have it, s.
    pub time_s: f64,
    /// The body as the estimate has it; in a gap shifted by what the estimate was off when the body was last seen.
    pub pose: Pose,
    /// Time since the body was seen, s; 0 while it is.
    pub gap_s: f64,
    /// Expected error of the attitude, rad.
    pub sigma_rad: f64,
    /// Expected error of the position, m; infinite where it does not follow from one that was seen.
    pub sigma_m: f64,
    /// The estimate itself: the sensor in the level world.
    pub bridged: estimator::Bridged,
}

/// What was taken, in the order of its time: for those who look at it later, when they know more.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Taken {
    /// A frame that has nothing missing before it: its time, s, and the body.
    Frame(f64, Option<Pose>),
    /// A sample: its time, s, and the step to it by the node's clock, s.
    Sample(f64, f64, Sample),
}

/// Sensor and body.
#[derive(Debug)]
pub struct Merger {
    coupling: Coupling,
    bridge: LiveBridge,
    frames: VecDeque<(f64, Seen)>,
    /// How many of the frames have nothing missing before them.
    whole: usize,
    waiting: VecDeque<Sample>,
    last: Option<Sample>,
    time_s: Option<f64>,
    seen_s: Option<f64>,
    off: VecDeque<(f64, Vec3, Vec3)>,
    /// Where it is asked for: what was taken, and the number of the last frame in it.
    taken: Option<(Vec<Taken>, i64)>,
}

impl Merger {
    /// Refused: as [`LiveBridge::new`].
    pub fn new(coupling: Coupling, optics: &BridgeSettings) -> Result<Self> {
        let gravity_m_s2 = coupling.alignment.gravity_m_s2;
        let settings = estimator::Settings { gravity_m_s2, ..estimator::Settings::default() };
        Ok(Merger {
            coupling,
            bridge: LiveBridge::new(optics, &settings)?,
            frames: VecDeque::new(),
            whole: 0,
            waiting: VecDeque::new(),
            last: None,
            time_s: None,
            seen_s: None,
            off: VecDeque::new(),
            taken: None,
        })
    }

    /// How sensor and body belong together.
    pub fn coupling(&self) -> &Coupling {
        &self.coupling
    }

    /// The clocks have been compared anew, in the same way as before ([`Clocking::is_like`]).
    pub fn set_clocking(&mut self, clocking: Clocking) {
        self.coupling.clocking = clocking;
        let again: Vec<Seen> = self.frames.drain(..).map(|(_, seen)| seen).collect();
        self.whole = 0;
        again.into_iter().for_each(|seen| self.insert(seen));
    }

    /// The causal estimate.
    pub fn bridge(&self) -> &LiveBridge {
        &self.bridge
    }

    /// Samples that wait for frames.
    pub fn waiting(&self) -> usize {
        self.waiting.len()
    }

    /// From now on [`Merger::taken`] tells what is taken, or no longer.
    pub fn keep_taken(&mut self, keep: bool) {
        self.taken = keep.then(|| (Vec::new(), i64::MIN));
        self.keep_frames(0);
    }

    /// What was taken since this was asked last.
    pub fn taken(&mut self) -> Vec<Taken> {
        self.taken.as_mut().map(|(taken, _)| std::mem::take(taken)).unwrap_or_default()
    }

    /// Keeps the frames from this one on that have nothing missing before them.
    fn keep_frames(&mut self, from: usize) {
        let Some((taken, last)) = &mut self.taken else { return };
        for (time_s, seen) in self.frames.iter().take(self.whole).skip(from) {
            if seen.number > *last {
                *last = seen.number;
                taken.push(Taken::Frame(*time_s, seen.pose));
            }
        }
    }

    /// Takes a frame, then the samples that have waited for it.
    pub fn frame(&mut self, seen: Seen, out: &mut Vec<Moved>) {
        self.insert(seen);
        self.advance(false, out);
    }

    /// Takes a sample, at once or when the frames before it are there.
    pub fn sample(&mut self, sample: &Sample, out: &mut Vec<Moved>) {
        self.waiting.push_back(*sample);
        self.advance(self.waiting.len() > WAITING_MAX, out);
    }

    /// No frames come any more: takes what waits.
    pub fn release(&mut self, out: &mut Vec<Moved>) {
        self.advance(true, out);
    }

    fn insert(&mut self, seen: Seen) {
        let time_s = self.coupling.frame_time_s(seen.number, seen.exposure_s);
        let place = self.frames.partition_point(|(_, other)| other.number < seen.number);
        let known = self.frames.get(place).is_some_and(|(_, other)| other.number == seen.number);
        if !time_s.is_finite() || known || (place < self.whole) {
            return;
        }
        self.frames.insert(place, (time_s, seen));
        let whole = self.whole;
        if self.whole == 0 {
            self.whole = 1;
        }
        loop {
            let (last, next) = (self.frames.get(self.whole - 1), self.frames.get(self.whole));
            let (Some((_, last)), Some((_, next))) = (last, next) else { break };
            let follows = next.number == last.number + 1;
            if !follows && self.frames.len() - self.whole < LATE_FRAMES {
                break;
            }
            self.whole += 1;
        }
        self.keep_frames(whole);
        while self.frames.len() > FRAMES_MAX {
            self.frames.pop_front();
            self.whole = self.whole.saturating_sub(1).max(1);
        }
    }

    /// Samples before this time need no frame that is still to come, s.
    fn complete_s(&self) -> f64 {
        let newest = self.whole.checked_sub(1).and_then(|k| self.frames.get(k));
        newest.map_or(f64::NEG_INFINITY, |(time_s, _)| time_s + DUE_STEPS * self.coupling.step_s)
    }

    fn advance(&mut self, all: bool, out: &mut Vec<Moved>) {
        let complete_s = self.complete_s();
        while let Some(sample) = self.waiting.front() {
            let sample = *sample;
            let step_s = self.last.map(|last| step(&last, &sample));
            let by_step = || Some(self.time_s? + step_s.filter(|step_s| *step_s < ANEW_S)?);
            let Some(time_s) = self.coupling.sample_time_s(&sample).or_else(by_step) else {
                self.waiting.pop_front();
                continue;
            };
            if !all && time_s >= complete_s {
                return;
            }
            self.waiting.pop_front();
            self.last = Some(sample);
            self.time_s = Some(time_s);
            let dt_s = step_s.unwrap_or(ANEW_S);
            if let Some((taken, _)) = &mut self.taken {
                taken.push(Taken::Sample(time_s, dt_s, sample));
            }
            if let Some(moved) = self.take(&sample, time_s, dt_s) {
                out.push(moved);
            }
        }
    }

    fn take(&mut self, sample: &Sample, time_s: f64, dt_s: f64) -> Option<Moved> {
        let alignment = self.coupling.alignment;
        let gyro_rad_s = alignment.rate(sample.gyro_rad_s);
        let reading = estimator::Sample { gyro_rad_s, acc_m_s2: alignment.force(sample.acc_m_s2), dt_s };
        let sight = self.sight(time_s, gyro_rad_s);
        let bridged = self.bridge.update(&reading, sight.as_ref().map(|(sensor, _)| sensor));
        if let Some((_, frame_s)) = sight {
            self.seen_s = Some(frame_s);
        }
        let seen_s = self.seen_s?;
        let estimated = alignment.body(&OpticalPose {
            world_from_body: bridged.state.world_from_body,
            position_m: bridged.position_m,
        });
        let placed = bridged.sigma_position_m.is_finite();
        let pose = match &sight {
            Some((sensor, _)) => {
                let body = alignment.body(sensor);
                if placed {
                    self.compare(time_s, &body, &estimated);
                }
                body
            }
            None => self.pinned(&estimated),
        };
        if !placed && sight.is_none() {
            self.off.clear();
        }
        let state = &bridged.state;
        Some(Moved {
            time_s,
            pose,
            gap_s: if sight.is_some() { 0.0 } else { time_s - seen_s },
            sigma_rad: math::hypot(state.sigma_tilt_rad, state.sigma_heading_rad),
            sigma_m: bridged.sigma_position_m,
            bridged,
        })
    }

    /// The sensor at a time, carried on from the last frame before it, and that frame's time; none where the body
    /// was not seen.
    fn sight(&mut self, time_s: f64, gyro_rad_s: Vec3) -> Option<(OpticalPose, f64)> {
        // of the frames before, the last two are needed
        while self.whole > 2 && self.frames.get(2).is_some_and(|(later_s, _)| *later_s <= time_s) {
            self.frames.pop_front();
            self.whole -= 1;
        }
        let after = self.frames.partition_point(|(frame_s, _)| *frame_s <= time_s);
        let (frame_s, seen) = *self.frames.get(after.checked_sub(1)?)?;
        let late_s = time_s - frame_s;
        let step_s = self.coupling.step_s;
        if late_s > CARRY_STEPS * step_s {
            return None;
        }
        let sensor = self.coupling.alignment.sensor(&seen.pose?);
        if late_s == 0.0 {
            return Some((sensor, frame_s));
        }
        let rate = vector::sub(gyro_rad_s, self.bridge.bridged().state.gyro_bias_rad_s);
        let turn = Quaternion::from_rotation_vector(vector::scale(rate, late_s));
        let before = after.checked_sub(2).and_then(|k| self.frames.get(k)).copied();
        let speed = before.and_then(|(before_s, before)| {
            let near = frame_s - before_s < CARRY_STEPS * step_s && frame_s > before_s;
            let earlier = self.coupling.alignment.sensor(&before.pose.filter(|_| near)?);
            Some(vector::scale(
                vector::sub(sensor.position_m, earlier.position_m),
                1.0 / (frame_s - before_s),
            ))
        });
        let carried = OpticalPose {
            world_from_body: sensor.world_from_body.product(turn).normalized(),
            position_m: vector::add(sensor.position_m, vector::scale(speed.unwrap_or([0.0; 3]), late_s)),
        };
        Some((carried, frame_s))
    }

    fn compare(&mut self, time_s: f64, seen: &Pose, estimated: &Pose) {
        let turn = seen.world_from_body.product(estimated.world_from_body.conjugate()).to_rotation_vector();
        let shift = vector::sub(seen.position_m, estimated.position_m);
        self.off.push_back((time_s, turn, shift));
        while self.off.front().is_some_and(|(then_s, ..)| time_s - then_s > PIN_S) {
            self.off.pop_front();
        }
    }

    /// What the estimate was off by when the body was last seen is kept, so that nothing jumps.
    fn pinned(&self, estimated: &Pose) -> Pose {
        let share = 1.0 / (self.off.len().max(1) as f64);
        let (mut turn, mut shift) = ([0.0; 3], [0.0; 3]);
        for (_, one_turn, one_shift) in &self.off {
            turn = vector::add(turn, vector::scale(*one_turn, share));
            shift = vector::add(shift, vector::scale(*one_shift, share));
        }
        let q = Quaternion::from_rotation_vector(turn).product(estimated.world_from_body);
        Pose { position_m: vector::add(estimated.position_m, shift), world_from_body: q.normalized() }
    }
}

/// From one sample of a node to the next, by the node's own clock, s; a start anew is a gap.
pub fn step(last: &Sample, next: &Sample) -> f64 {
    if last.boot != next.boot {
        return ANEW_S;
    }
    f64::from(next.stamp_us.wrapping_sub(last.stamp_us)) * 1e-6
}
