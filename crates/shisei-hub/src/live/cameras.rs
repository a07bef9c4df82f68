//! What the cameras' program says: what there is, and frames.

use std::sync::Arc;

use shisei_core::frames::Pose;
use shisei_core::fuse::Source;

use super::hub::Hub;
use super::input::{Arrival, Kind};
use super::merge::Seen;
use super::note::{Level, Note};
use super::optics::{self, BodyKey, OpticalFrame};
use super::recorder::Record;
use super::scene::{Key, Shown};
use crate::natnet;

/// A frame number so much smaller than the last is another count.
const RESTART_FRAMES: i64 = 100;

impl Hub {
    pub(super) fn natnet(&mut self, arrival: &Arrival, packet: &[u8]) {
        let Some(index) = self.port(arrival) else { return };
        let port = &mut self.ports[index];
        if let Some(recorder) = &self.recorder {
            recorder.give(Record::Raw(Arc::clone(&port.name), packet.to_vec(), arrival.unix_ns));
        }
        match port.stream.push(packet) {
            Ok(natnet::Told::Server(_)) => port.words[0] = Some(packet.to_vec()),
            Ok(natnet::Told::Model(model)) => {
                port.words[1] = Some(packet.to_vec());
                self.scene.describe(&optics::bodies(&model));
                self.pair_by_name();
            }
            Ok(natnet::Told::Frame(frame)) => {
                let clock_hz = port.stream.server().map_or(0, |server| server.clock_hz);
                let frame = optics::frame(&frame, clock_hz, self.settings.axes);
                self.frame(&frame, arrival);
            }
            Ok(natnet::Told::Nothing) => {}
            Err(natnet::Malformed) => {
                if let Some(input) = self.inputs.get_mut(arrival.input) {
                    input.bad += 1;
                }
            }
        }
    }

    fn frame(&mut self, frame: &OpticalFrame, arrival: &Arrival) {
        if !frame.exposure_s.is_finite() {
            return;
        }
        if let Some(last) = self.optical.number {
            let back = last - frame.number;
            // the same once more, by another way or from a camera system that stands still
            if back == 0 {
                return;
            }
            if back > RESTART_FRAMES || (back < 0 && frame.exposure_s < self.optical.exposure_s) {
                self.note(Note::new(
                    Level::Warning,
                    "the cameras' count began anew",
                    "カメラのフレーム番号が最初に戻りました",
                ));
                self.optical.past.clear();
                (0..self.ports.len()).for_each(|port| self.uncouple(port));
                self.optical.number = None;
            } else if let Some(input) = self.inputs.get_mut(arrival.input) {
                // late ones are counted as lost and found again
                input.lost = match back {
                    ..=-1 => input.lost + (back.unsigned_abs() - 1),
                    _ => input.lost.saturating_sub(1),
                };
            }
        }
        if let Some(input) = self.inputs.get_mut(arrival.input)
            && matches!(input.kind, Kind::NatNet | Kind::Replay)
        {
            input.rate.add(arrival.at, 1);
        }
        self.optical.frames += 1;
        self.optical.past.push(frame, arrival.unix_ns as f64 * 1e-9);
        let newest = self.optical.number.is_none_or(|last| frame.number > last);
        if newest {
            self.optical.number = Some(frame.number);
            self.optical.exposure_s = frame.exposure_s;
            self.optical.at = Some(arrival.at);
            self.optical.markers_m.clone_from(&frame.markers_m);
            frame.bodies.iter().for_each(|(key, pose)| self.seen(frame, *key, *pose, arrival));
        }
        for index in 0..self.nodes.len() {
            let node = &mut self.nodes[index];
            let (Some(merger), Some(body)) = (&mut node.merger, node.body) else { continue };
            let pose = frame.bodies.iter().find(|(key, _)| *key == body).and_then(|(_, pose)| *pose);
            let mut moved = Vec::new();
            let seen = Seen { number: frame.number, exposure_s: frame.exposure_s, pose };
            merger.frame(seen, &mut moved);
            self.moved(index, &moved, arrival.at, arrival.unix_ns);
        }
        if newest {
            self.give_out();
        }
    }

    /// A body in the newest frame.
    fn seen(&mut self, frame: &OpticalFrame, key: BodyKey, pose: Option<Pose>, arrival: &Arrival) {
        let node = self.nodes.iter().find(|node| node.body == Some(key) && node.merger.is_some());
        let coupling = node.and_then(|node| node.merger.as_ref()).map(|merger| *merger.coupling());
        let time_s = coupling
            .map_or(frame.exposure_s, |coupling| coupling.frame_time_s(frame.number, frame.exposure_s));
        let optics = self.settings.optics;
        let Some(object) = self.scene.object(Key::Body(key), &default_name(key)) else { return };
        if let Some(pose) = pose {
            let shown = Shown {
                pose,
                placed: true,
                source: Source::Optical,
                gap_s: 0.0,
                sigma_rad: optics.attitude_rad,
                sigma_m: optics.position_m,
                time_s,
                at: arrival.at,
            };
            object.shown = Some(shown);
            if let Some(recorder) = &self.recorder {
                recorder.give(Record::Optical(object.topic(), shown, frame.number, arrival.unix_ns));
                if coupling.is_none() {
                    recorder.give(Record::Pose(object.topic(), shown, arrival.unix_ns));
                }
            }
        } else if coupling.is_none()
            && let Some(shown) = &mut object.shown
            && shown.source != Source::None
        {
            shown.source = Source::None;
            (shown.sigma_rad, shown.sigma_m) = (f64::NAN, f64::NAN);
        }
    }
}

fn default_name(key: BodyKey) -> String {
    match key {
        BodyKey::Rigid(id) => format!("body {id}"),
        BodyKey::Bone(skeleton, id) => format!("bone {skeleton}.{id}"),
    }
}
