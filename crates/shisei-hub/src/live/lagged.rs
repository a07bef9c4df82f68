//! The estimate with a delay, for the recording: held at both ends of a gap that is shorter than the delay.
//!
//! It gets the same frames and samples as the causal estimate ([`Merger`] tells what it took), waits for the frames
//! after each sample, so that poses are interpolated and not carried on, and runs in a thread of its own: what is
//! shown live does not wait for it. What comes out depends on what was sent, not on when it arrived.

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::JoinHandle;
use std::time::Instant;

use shisei_core::estimator::Sample as Reading;
use shisei_core::frames::Pose;
use shisei_core::fuse::delayed::{Delayed, DelayedSettings};
use shisei_core::fuse::{FusedFrame, Source};
use shisei_core::{Quaternion, Result, vector};

use super::backlog::Backlog;
use super::merge::{Merger, Taken};
use super::recorder::Record;
use super::scene::Shown;
use crate::session::Sample;

/// Frames further apart than so many frame intervals have nothing known between them.
const NEIGHBOUR_STEPS: f64 = 1.5;
/// The merger takes a sample when all frames up to 0.9 intervals before it are there: behind this many intervals no
/// frame is missing any more.
const SURE_STEPS: f64 = 2.0;
/// Frames that are remembered at most, while no samples come.
const FRAMES_MAX: usize = 4096;
/// Samples that wait for frames at most: the oldest no longer, then.
const SAMPLES_MAX: usize = 4096;
/// Lots of frames and samples that wait for the thread at most: many seconds of twenty nodes.
const WAITING_MAX: usize = 100_000;

/// One sensor on its body, late.
#[derive(Debug)]
pub struct Lagged {
    step_s: f64,
    delayed: Delayed,
    frames: VecDeque<(f64, Option<Pose>)>,
    /// Samples that wait for the frames after them: time, step, when they came.
    waiting: VecDeque<(f64, f64, Sample)>,
    /// When the samples came that have not come out, ns since 1970.
    came_ns: VecDeque<u64>,
    rows: Vec<(f64, FusedFrame)>,
}

/// A sample's body, late.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Late {
    /// When the sample came, ns since 1970.
    pub unix_ns: u64,
    /// Its time, as frames have it, s.
    pub time_s: f64,
    /// The body.
    pub frame: FusedFrame,
}

impl Lagged {
    /// Goes on from what the causal estimate has learnt; [`Merger::taken`] is to be kept from now on. Refused: as
    /// [`Delayed::after`].
    pub fn after(merger: &Merger, settings: &DelayedSettings) -> Result<Self> {
        let coupling = merger.coupling();
        Ok(Lagged {
            step_s: coupling.step_s,
            delayed: Delayed::after(merger.bridge(), &coupling.alignment, settings)?,
            frames: VecDeque::new(),
            waiting: VecDeque::new(),
            came_ns: VecDeque::new(),
            rows: Vec::new(),
        })
    }

    /// Takes what the merger took; `unix_ns` is when it came. Appends what has waited long enough.
    pub fn push(&mut self, taken: &Taken, unix_ns: u64, out: &mut Vec<Late>) {
        match taken {
            Taken::Frame(time_s, pose) => {
                self.frames.push_back((*time_s, *pose));
                if self.frames.len() > FRAMES_MAX {
                    self.frames.pop_front();
                }
            }
            Taken::Sample(time_s, dt_s, sample) => {
                self.waiting.push_back((*time_s, *dt_s, *sample));
                self.came_ns.push_back(unix_ns);
                self.advance(time_s - SURE_STEPS * self.step_s, out);
            }
        }
    }

    /// Appends all that still waits, at the end.
    pub fn finish(mut self, out: &mut Vec<Late>) {
        self.advance(f64::INFINITY, out);
        let Lagged { delayed, mut came_ns, mut rows, .. } = self;
        delayed.finish(&mut rows);
        give(&mut rows, &mut came_ns, out);
    }

    /// Takes the samples up to a time, s.
    fn advance(&mut self, up_to_s: f64, out: &mut Vec<Late>) {
        while let Some(&(time_s, dt_s, sample)) = self.waiting.front() {
            if time_s > up_to_s && self.waiting.len() <= SAMPLES_MAX {
                break;
            }
            self.waiting.pop_front();
            let pose = self.sight(time_s);
            let reading = Reading { gyro_rad_s: sample.gyro_rad_s, acc_m_s2: sample.acc_m_s2, dt_s };
            self.delayed.update(time_s, &reading, pose.as_ref(), &mut self.rows);
        }
        give(&mut self.rows, &mut self.came_ns, out);
    }

    /// The body at a time, between the frames around it.
    fn sight(&mut self, time_s: f64) -> Option<Pose> {
        while self.frames.get(1).is_some_and(|(next_s, _)| *next_s <= time_s) {
            self.frames.pop_front();
        }
        let (from_s, from) = *self.frames.front()?;
        if from_s == time_s {
            return from;
        }
        let (to_s, to) = *self.frames.get(1)?;
        let width_s = to_s - from_s;
        if from_s > time_s || width_s > NEIGHBOUR_STEPS * self.step_s {
            return None;
        }
        let (from, to) = (from?, to?);
        let share = (time_s - from_s) / width_s;
        let step = vector::sub(to.position_m, from.position_m);
        let turned = Quaternion::slerp(from.world_from_body, to.world_from_body, share);
        Some(Pose {
            position_m: vector::add(from.position_m, vector::scale(step, share)),
            world_from_body: turned.normalized(),
        })
    }
}

fn give(rows: &mut Vec<(f64, FusedFrame)>, came_ns: &mut VecDeque<u64>, out: &mut Vec<Late>) {
    for (time_s, frame) in rows.drain(..) {
        let Some(unix_ns) = came_ns.pop_front() else { break };
        out.push(Late { unix_ns, time_s, frame });
    }
}

/// What goes to the thread.
#[derive(Debug)]
enum Work {
    /// A node, from now on: its body's path.
    Begin(usize, String, Box<Lagged>),
    /// What its merger took, and when it came.
    Taken(usize, Vec<Taken>, u64),
    /// No more of it.
    End(usize),
}

/// The thread: all nodes of a recording.
#[derive(Debug)]
pub struct Smoothing {
    work: Option<Sender<Work>>,
    /// Lots that wait.
    waiting: Arc<AtomicUsize>,
    /// Nodes that the thread could not keep up with.
    given_up: RefCell<BTreeSet<usize>>,
    thread: Option<JoinHandle<()>>,
}

impl Smoothing {
    /// What comes out goes to `records`.
    pub fn start(records: Backlog) -> Self {
        let (work, asked) = channel();
        let waiting = Arc::new(AtomicUsize::new(0));
        let left = Arc::clone(&waiting);
        let thread = std::thread::spawn(move || smooth(&asked, &left, &records));
        Smoothing { work: Some(work), waiting, given_up: RefCell::default(), thread: Some(thread) }
    }

    /// A node's body, from now on.
    pub fn begin(&self, node: usize, path: String, lagged: Lagged) {
        self.given_up.borrow_mut().remove(&node);
        self.send(Work::Begin(node, path, Box::new(lagged)));
    }

    /// What a node's merger took at a time, ns since 1970. False where so much waits that this node is given up.
    pub fn taken(&self, node: usize, taken: Vec<Taken>, unix_ns: u64) -> bool {
        if taken.is_empty() || self.given_up.borrow().contains(&node) {
            return true;
        }
        if self.waiting.load(Ordering::Relaxed) >= WAITING_MAX {
            self.given_up.borrow_mut().insert(node);
            self.end_of(node);
            return false;
        }
        self.waiting.fetch_add(1, Ordering::Relaxed);
        self.send(Work::Taken(node, taken, unix_ns));
        true
    }

    /// A node is no longer on its body: what still waits comes out.
    pub fn end_of(&self, node: usize) {
        self.send(Work::End(node));
    }

    fn send(&self, work: Work) {
        if let Some(to) = &self.work {
            // without its thread there is nothing left to record
            let _ = to.send(work);
        }
    }

    /// All that still waits comes out.
    pub fn end(mut self) {
        drop(self.work.take());
        if let Some(thread) = self.thread.take() {
            // a panic there has been printed
            let _ = thread.join();
        }
    }
}

fn smooth(asked: &Receiver<Work>, waiting: &AtomicUsize, records: &Backlog) {
    let mut nodes: BTreeMap<usize, (String, Box<Lagged>)> = BTreeMap::new();
    let mut out = Vec::new();
    let give = |path: &str, out: &mut Vec<Late>| {
        for late in out.drain(..) {
            if let Some(shown) = shown(&late) {
                records.give(Record::Smoothed(path.to_owned(), shown, late.unix_ns));
            }
        }
    };
    while let Ok(work) = asked.recv() {
        match work {
            Work::Begin(node, path, lagged) => {
                nodes.insert(node, (path, lagged));
            }
            Work::Taken(node, taken, unix_ns) => {
                waiting.fetch_sub(1, Ordering::Relaxed);
                let Some((path, lagged)) = nodes.get_mut(&node) else { continue };
                for one in &taken {
                    lagged.push(one, unix_ns, &mut out);
                }
                give(path, &mut out);
            }
            Work::End(node) => {
                let Some((path, lagged)) = nodes.remove(&node) else { continue };
                lagged.finish(&mut out);
                give(&path, &mut out);
            }
        }
    }
    for (path, lagged) in nodes.into_values() {
        lagged.finish(&mut out);
        give(&path, &mut out);
    }
}

fn shown(late: &Late) -> Option<Shown> {
    let FusedFrame { pose, source, gap_s, sigma_rad, sigma_m } = late.frame;
    Some(Shown {
        pose: pose?,
        placed: matches!(source, Source::Optical | Source::Bridged),
        source,
        gap_s,
        sigma_rad,
        sigma_m,
        time_s: late.time_s,
        at: Instant::now(),
    })
}

#[cfg(test)]
mod tests {
    use shisei_core::alignment::Alignment;
    use shisei_core::estimator::BridgeSettings;
    use shisei_wire::packet::{FilterKind, Start};

    use super::super::backlog::backlog;
    use super::super::merge::{Clocking, Coupling};
    use super::*;

    /// A sample from the far future, then the usual ones.
    #[test]
    fn times_that_go_back_cost_no_memory() {
        let clocking = Clocking::Pulses { shift: 0.0 };
        let coupling = Coupling { alignment: Alignment::default(), clocking, step_s: 0.01 };
        let merger = Merger::new(coupling, &BridgeSettings::default()).unwrap();
        let mut lagged = Lagged::after(&merger, &DelayedSettings::default()).unwrap();
        let sample = Sample {
            node: 0,
            boot: 0,
            sequence: 0,
            raw_sequence: 0,
            stamp_us: 0,
            time_s: None,
            frame: None,
            from_gate: false,
            arrival_frame: None,
            gyro_rad_s: [0.0; 3],
            acc_m_s2: [0.0, 0.0, 9.8],
            world_from_body: Quaternion::IDENTITY,
            temperature_c: None,
            late: false,
            reading_missed: false,
            start: Start::Done,
            filter: FilterKind::Complementary,
            calibrated: false,
        };
        let mut out = Vec::new();
        lagged.push(&Taken::Sample(5000.0, 0.01, sample), 0, &mut out);
        for k in 0..3 * SAMPLES_MAX {
            lagged.push(&Taken::Sample(0.01 * k as f64, 0.01, sample), 0, &mut out);
        }
        assert!(lagged.waiting.len() <= SAMPLES_MAX && !out.is_empty());
    }

    /// A thread that never comes to its work.
    #[test]
    fn what_cannot_be_kept_up_with_is_given_up_once() {
        let (work, asked) = channel();
        let waiting = Arc::new(AtomicUsize::new(0));
        let smoothing = Smoothing {
            work: Some(work),
            waiting: Arc::clone(&waiting),
            given_up: RefCell::default(),
            thread: None,
        };
        let lot = || vec![Taken::Frame(0.0, None)];
        let refused = (0..WAITING_MAX + 1000).filter(|_| !smoothing.taken(2, lot(), 0)).count();
        assert_eq!((refused, waiting.load(Ordering::Relaxed)), (1, WAITING_MAX));
        // when the thread comes to it after all, another node finds room
        let (records, _) = backlog();
        smoothing.end_of(2);
        let thread = std::thread::spawn(move || smooth(&asked, &waiting, &records));
        while smoothing.waiting.load(Ordering::Relaxed) > 0 {
            std::thread::yield_now();
        }
        assert!(smoothing.taken(1, lot(), 0));
        smoothing.end();
        thread.join().expect("the thread");
    }
}
