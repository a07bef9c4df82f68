//! Which sensor is on which body, how it sits there and how the clocks belong together: from common motion, while it
//! happens. The search runs in a thread of its own and never holds up the stream.

use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};

use shisei_core::alignment::Alignment;
use shisei_core::frames::Pose;
use shisei_core::sync::gyro_path::Stamp;
use shisei_core::sync::lever::lever_arm;
use shisei_core::sync::rates::{RatesSettings, Start, Sync, synchronise};
use shisei_core::{Quaternion, STANDARD_GRAVITY_M_S2, Vec3, vector};

use super::merge::{Clocking, Coupling};
use super::optics::{BodyKey, OpticalFrame};
use crate::session::Sample;

/// So much is remembered, s, and this many frames or samples at most; of all frames together so many poses: 80 MB.
const MEMORY_S: f64 = 30.0;
const ROWS_MAX: usize = 16_384;
const POSES_MAX: usize = 1 << 20;
/// A lever arm that is known less well than this is not used, m.
const LEVER_SIGMA_M: f64 = 0.03;
/// An offset that is known less well than this is not used, s.
const OFFSET_SIGMA_S: f64 = 0.004;
/// Pulses are used where this share of the samples has a frame.
const FRAMES_SHARE: f64 = 0.95;
/// Least motion of a body worth comparing, rad/s (root mean square).
const MOTION_RAD_S: f64 = 0.2;

/// The last samples of a node.
#[derive(Clone, Debug, Default)]
pub struct NodePast {
    rows: VecDeque<Sample>,
    /// Smallest difference between time of arrival and the receiver's, s.
    arrival_less_time_s: Option<f64>,
    arrival_less_frame: VecDeque<(f64, f64)>,
}

impl NodePast {
    /// Remembers a sample.
    pub fn push(&mut self, sample: &Sample, arrival_s: f64) {
        let anew = self.rows.back().is_some_and(|last| {
            let backwards = match (last.frame, sample.frame) {
                (Some(before), Some(now)) => now <= before,
                _ => false,
            };
            last.boot != sample.boot || sample.time_s <= last.time_s || backwards
        });
        if anew {
            *self = NodePast::default();
        }
        let Some(time_s) = sample.time_s else { return };
        let late = arrival_s - time_s;
        self.arrival_less_time_s = Some(self.arrival_less_time_s.map_or(late, |least| least.min(late)));
        if let Some(frame) = sample.frame {
            self.arrival_less_frame.push_back((arrival_s, frame));
        }
        self.rows.push_back(*sample);
        while self.rows.len() > ROWS_MAX
            || self.rows.front().and_then(|first| first.time_s).is_some_and(|s| time_s - s > MEMORY_S)
        {
            self.rows.pop_front();
        }
        while self.arrival_less_frame.len() > self.rows.len() {
            self.arrival_less_frame.pop_front();
        }
    }

    /// How much is remembered, s.
    pub fn length_s(&self) -> f64 {
        let time = |row: Option<&Sample>| row.and_then(|sample| sample.time_s).unwrap_or(0.0);
        time(self.rows.back()) - time(self.rows.front())
    }

    /// Forgets all.
    pub fn clear(&mut self) {
        *self = NodePast::default();
    }
}

/// The last frames, without their markers. A copy shares them.
#[derive(Clone, Debug, Default)]
pub struct OpticalPast {
    rows: VecDeque<(Arc<OpticalFrame>, f64)>,
    /// Poses in all of them.
    poses: usize,
}

impl OpticalPast {
    /// Remembers a frame.
    pub fn push(&mut self, frame: &OpticalFrame, arrival_s: f64) {
        if self
            .rows
            .back()
            .is_some_and(|(last, _)| frame.number <= last.number || frame.exposure_s <= last.exposure_s)
        {
            return;
        }
        let (number, exposure_s) = (frame.number, frame.exposure_s);
        let light = OpticalFrame { number, exposure_s, bodies: frame.bodies.clone(), markers_m: Vec::new() };
        self.poses += light.bodies.len();
        self.rows.push_back((Arc::new(light), arrival_s));
        while self.rows.len() > ROWS_MAX
            || self.poses > POSES_MAX
            || self.rows.front().is_some_and(|(first, _)| exposure_s - first.exposure_s > MEMORY_S)
        {
            let Some((first, _)) = self.rows.pop_front() else { break };
            self.poses -= first.bodies.len();
        }
    }

    /// There are frames enough to tell how far apart they are.
    pub fn has_steps(&self) -> bool {
        self.rows.len() > 1
    }

    /// From one frame to the next, s: the middle of what was seen.
    pub fn step_s(&self) -> Option<f64> {
        let mut steps: Vec<f64> = self
            .rows
            .iter()
            .zip(self.rows.iter().skip(1))
            .map(|((a, _), (b, _))| (b.exposure_s - a.exposure_s) / (b.number - a.number) as f64)
            .collect();
        steps.sort_by(f64::total_cmp);
        steps.get(steps.len() / 2).copied().filter(|step_s| *step_s > 0.0)
    }

    /// Forgets all.
    pub fn clear(&mut self) {
        *self = OpticalPast::default();
    }
}

/// A question to the learner.
#[derive(Debug)]
pub struct Question {
    /// Which node asks.
    pub node: usize,
    /// Its samples.
    pub samples: NodePast,
    /// The frames.
    pub frames: OpticalPast,
    /// Bodies it may be on.
    pub bodies: Vec<BodyKey>,
    /// Offsets are looked for everywhere, not only near that of the arrivals.
    pub anywhere: bool,
}

/// Its answer.
#[derive(Debug)]
pub struct Answer {
    /// Which node asked.
    pub node: usize,
    /// The body whose turns are the sensor's; none was found.
    pub found: Option<Found>,
}

/// A sensor on a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    /// The body.
    pub body: BodyKey,
    /// How they belong together.
    pub coupling: Coupling,
    /// Error of the clocks, s.
    pub sigma_s: f64,
    /// Share of the body's turns that the sensor's explain.
    pub explained: f64,
}

/// The thread that searches.
#[derive(Debug)]
pub struct Learner {
    questions: Sender<Question>,
    answers: Receiver<Answer>,
    busy: bool,
}

impl Default for Learner {
    fn default() -> Self {
        let (questions, asked) = channel::<Question>();
        let (told, answers) = channel();
        std::thread::spawn(move || {
            while let Ok(question) = asked.recv() {
                let answer = Answer { node: question.node, found: answer(&question) };
                if told.send(answer).is_err() {
                    return;
                }
            }
        });
        Learner { questions, answers, busy: false }
    }
}

impl Learner {
    /// Free for a question.
    pub fn free(&self) -> bool {
        !self.busy
    }

    /// Asks.
    pub fn ask(&mut self, question: Question) {
        self.busy = self.questions.send(question).is_ok();
    }

    /// The answer, when it is there.
    pub fn answer(&mut self) -> Option<Answer> {
        let answer = self.answers.try_recv().ok()?;
        self.busy = false;
        Some(answer)
    }
}

/// The body that turns as the sensor does, best.
pub fn answer(question: &Question) -> Option<Found> {
    let found = question.bodies.iter().filter_map(|body| couple(question, *body));
    found.max_by(|a, b| a.explained.total_cmp(&b.explained))
}

fn couple(question: &Question, body: BodyKey) -> Option<Found> {
    let step_s = question.frames.step_s()?;
    let rows = &question.samples.rows;
    let tagged = rows.iter().filter(|sample| sample.frame.is_some()).count();
    let pulses = tagged as f64 >= FRAMES_SHARE * rows.len() as f64;
    let time = |sample: &Sample| {
        if pulses { sample.frame.map(|frame| frame * step_s) } else { sample.time_s }
    };
    let mut sensor_s = Vec::new();
    let (mut gyro, mut acc) = (Vec::new(), Vec::new());
    for sample in rows {
        if let Some(time_s) = time(sample)
            && sensor_s.last().is_none_or(|last| time_s > *last)
        {
            sensor_s.push(time_s);
            gyro.push(sample.gyro_rad_s);
            acc.push(sample.acc_m_s2);
        }
    }
    let mut optical_s: Vec<f64> = Vec::new();
    let mut poses: Vec<Option<Pose>> = Vec::new();
    let mut optical_late = f64::INFINITY;
    for (frame, arrival_s) in &question.frames.rows {
        let time_s = if pulses { frame.number as f64 * step_s } else { frame.exposure_s };
        optical_s.push(time_s);
        poses.push(frame.bodies.iter().find(|(key, _)| *key == body).and_then(|(_, pose)| *pose));
        optical_late = optical_late.min(arrival_s - time_s);
    }
    if !moves(&optical_s, &poses) {
        return None;
    }
    let sensor_late = if pulses {
        let late =
            question.samples.arrival_less_frame.iter().map(|(arrival, frame)| arrival - frame * step_s);
        late.fold(f64::INFINITY, f64::min)
    } else {
        question.samples.arrival_less_time_s?
    };
    let near = Start::Near(optical_late - sensor_late);
    let attitudes: Vec<Option<Quaternion>> =
        poses.iter().map(|pose| pose.map(|pose| pose.world_from_body)).collect();
    let settings = |start| RatesSettings { start, stamp: Stamp::End, ..RatesSettings::default() };
    let search = |start| synchronise(&optical_s, &attitudes, &sensor_s, &gyro, &settings(start)).ok();
    let mut sync = search(near);
    if sync.is_none() && question.anywhere {
        sync = search(Start::Search);
    }
    let sync = sync.filter(|sync| sync.sigma_offset_s < OFFSET_SIGMA_S)?;
    let clocking = if pulses {
        // the same pulses are counted on both sides: what looks like skew is noise
        let middle_s = sync.sensor_time_s(sync.middle_s) - sync.middle_s;
        Clocking::Pulses { shift: -middle_s / step_s }
    } else {
        Clocking::Times { offset_s: sync.offset_s, skew: sync.skew }
    };
    let alignment = align(&sync, &optical_s, &poses, &sensor_s, &acc);
    let coupling = Coupling { alignment, clocking, step_s };
    Some(Found { body, coupling, sigma_s: sync.sigma_offset_s, explained: sync.explained })
}

fn align(
    sync: &Sync,
    optical_s: &[f64],
    poses: &[Option<Pose>],
    sensor_s: &[f64],
    acc_m_s2: &[Vec3],
) -> Alignment {
    let step_s = match (sensor_s.first(), sensor_s.last()) {
        (Some(first), Some(last)) => (last - first) / sensor_s.len().max(2) as f64,
        _ => 0.0,
    };
    let read_s: Vec<f64> = sensor_s.iter().map(|s| sync.optical_time_s(*s) - 0.5 * step_s).collect();
    let mounting = sync.body_from_sensor;
    let lever = lever_arm(optical_s, poses, &read_s, acc_m_s2, mounting, STANDARD_GRAVITY_M_S2)
        .ok()
        .filter(|lever| vector::norm(lever.sigma_m) < LEVER_SIGMA_M);
    Alignment::found(sync, lever.as_ref(), [0.0, 0.0, 1.0], STANDARD_GRAVITY_M_S2)
}

/// The body turns enough to be told from another.
fn moves(time_s: &[f64], poses: &[Option<Pose>]) -> bool {
    let (mut squares, mut length_s) = (0.0, 0.0);
    for (time, pair) in time_s.windows(2).zip(poses.windows(2)) {
        if let (&[a_s, b_s], &[Some(a), Some(b)]) = (time, pair) {
            let angle = a.world_from_body.conjugate().product(b.world_from_body).angle();
            let step_s = b_s - a_s;
            if step_s > 0.0 {
                squares += angle * angle / step_s;
                length_s += step_s;
            }
        }
    }
    length_s > 5.0 && squares > MOTION_RAD_S * MOTION_RAD_S * length_s
}

#[cfg(test)]
mod tests {
    use super::*;

    fn film(bodies: i32, rate_hz: f64, frames: i64) -> OpticalPast {
        let pose = Pose { position_m: [0.0; 3], world_from_body: Quaternion::IDENTITY };
        let bodies = (0..bodies).map(|id| (BodyKey::Rigid(id), Some(pose))).collect();
        let mut frame = OpticalFrame { number: 0, exposure_s: 0.0, bodies, markers_m: vec![[0.0; 3]; 100] };
        let mut past = OpticalPast::default();
        for number in 0..frames {
            (frame.number, frame.exposure_s) = (number, number as f64 / rate_hz);
            past.push(&frame, frame.exposure_s);
        }
        past
    }

    #[test]
    fn a_question_shares_the_frames_and_many_bodies_cost_no_more_than_some() {
        let past = film(170, 240.0, 9000);
        let poses: usize = past.rows.iter().map(|(frame, _)| frame.bodies.len()).sum();
        assert!(poses == past.poses && poses <= POSES_MAX && poses + 170 > POSES_MAX, "{poses}");
        assert!(past.rows.iter().all(|(frame, _)| frame.markers_m.is_empty()));
        let asked = past.clone();
        assert!(past.rows.iter().zip(&asked.rows).all(|(a, b)| Arc::ptr_eq(&a.0, &b.0)));
        // of few bodies half a minute is there
        let few = film(3, 240.0, 9000);
        assert_eq!(few.rows.len(), 7201);
        assert!(few.step_s().is_some_and(|step_s| (step_s * 240.0 - 1.0).abs() < 1e-9));
    }
}
