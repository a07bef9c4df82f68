//! What clients and outputs get to see, and when it has vanished.

use std::sync::Arc;
use std::time::{Duration, Instant};

use shisei_core::fuse::Source;

use super::hub::Hub;
use super::input::{Kind, State};
use super::merge::Moved;
use super::recorder::Record;
use super::scene::{Key, Shown};

/// The status goes to clients so often.
const STATUS: Duration = Duration::from_secs(1);
/// What has not moved for so long has vanished.
const VANISHED: Duration = Duration::from_millis(300);
/// Without a frame for so long, samples no longer wait for one.
const NO_FRAMES: Duration = Duration::from_millis(100);
/// An input that nothing readable has come from for so long is waiting; a client of NatNet says so itself.
const SILENT: Duration = Duration::from_secs(2);

impl Hub {
    /// How long the samples took that a node's merger has taken now.
    fn merged(&mut self, node: usize) {
        let Some(node) = self.nodes.get_mut(node) else { return };
        let waiting = node.merger.as_ref().map_or(0, |merger| merger.waiting());
        while node.merging.len() > waiting
            && let Some(came) = node.merging.pop_front()
        {
            self.latency.add(came.elapsed());
        }
    }

    /// A body has moved as its sensor says, as of now, ns since 1970.
    pub(super) fn moved(&mut self, node: usize, moved: &[Moved], at: Instant, unix_ns: u64) {
        self.smooth_on(node, unix_ns);
        self.merged(node);
        let Some(body) = self.nodes.get(node).and_then(|node| node.body) else { return };
        let trust_s = self.settings.position_trust_s;
        let Some(object) = self.scene.get_mut(Key::Body(body)) else { return };
        for step in moved {
            let placed = step.sigma_m.is_finite() && step.gap_s <= trust_s;
            let in_gap = step.gap_s > 0.0;
            let source = match (in_gap, placed) {
                (false, _) => Source::Optical,
                (true, true) => Source::Bridged,
                (true, false) => Source::Inertial,
            };
            let shown = Shown {
                pose: step.pose,
                placed: placed || !in_gap,
                source,
                gap_s: step.gap_s,
                sigma_rad: step.sigma_rad,
                sigma_m: step.sigma_m,
                time_s: step.time_s,
                at,
            };
            if let Some(recorder) = &self.recorder {
                recorder.give(Record::Pose(object.topic(), shown, unix_ns));
            }
            if in_gap && object.shown.is_none_or(|last| last.time_s < step.time_s) {
                object.shown = Some(shown);
            }
        }
    }

    /// Passes on where everything is.
    pub(super) fn give_out(&mut self) {
        self.fresh = false;
        let (scene, optical) = (&self.scene, &self.optical);
        for output in &mut self.outputs {
            output.poses(scene, optical.number, optical.exposure_s);
        }
    }

    /// Shows what is new, looks after what has vanished.
    pub fn tick(&mut self, now: Instant) {
        if self.fresh {
            self.give_out();
        }
        if now < self.due() {
            return;
        }
        self.shown_at = now;
        if self.optical.at.is_none_or(|at| now.saturating_duration_since(at) > NO_FRAMES) {
            self.release(now);
        }
        self.vanish(now);
        self.learn(now);
        self.look_after_recording();
        self.look_after_names(now);
        if self.scene.changed {
            self.scene.changed = false;
            let scene = self.scene.message().to_string();
            self.board.scene.send_replace(Arc::from(scene));
            for output in &mut self.outputs {
                output.scene(&self.scene);
            }
        }
        let time_s = now.saturating_duration_since(self.started).as_secs_f64();
        let frame = self.optical.number.map(|number| number as f64);
        let poses = self.scene.poses(time_s, frame, &self.optical.markers_m);
        self.board.poses.send_replace(Arc::from(poses));
        if self.status_at.is_none_or(|at| now.saturating_duration_since(at) >= STATUS) {
            self.status_at = Some(now);
            let status = self.status(now).to_string();
            self.board.status.send_replace(Arc::from(status));
        }
    }

    /// No frames come: samples do not wait for them.
    pub(super) fn release(&mut self, now: Instant) {
        self.optical.markers_m.clear();
        for index in 0..self.nodes.len() {
            let node = &mut self.nodes[index];
            let mut moved = Vec::new();
            if let Some(merger) = &mut node.merger {
                merger.release(&mut moved);
            }
            let unix_ns = self.ports.get(node.place.0).map_or(0, |port| port.heard_ns);
            self.moved(index, &moved, now, unix_ns);
        }
    }

    fn vanish(&mut self, now: Instant) {
        for object in self.scene.objects_mut() {
            let Some(shown) = &mut object.shown else { continue };
            let age = now.saturating_duration_since(shown.at);
            if shown.source != Source::None && age > VANISHED {
                shown.source = Source::None;
                (shown.sigma_rad, shown.sigma_m) = (f64::NAN, f64::NAN);
            }
            if shown.source == Source::None {
                shown.gap_s = age.as_secs_f64();
            }
        }
        for input in &mut self.inputs {
            let silent = input.rate.silent_s(now).is_none_or(|s| s > SILENT.as_secs_f64());
            if silent && input.state == State::Connected && input.kind != Kind::NatNet {
                input.state = State::Waiting;
            }
        }
    }
}
