//! What receivers say: samples, nodes, losses.

use std::sync::Arc;
use std::time::{Duration, Instant};

use super::hub::{Hub, NODES_MAX, Port};
use super::input::{Arrival, What};
use super::node::Node;
use super::note::{Level, Note};
use super::recorder::Record;
use super::scene::Key;
use crate::kept;
use crate::session::{Item, Sample};

/// Bytes without anything readable among them for so long are not a receiver's.
const UNREADABLE: Duration = Duration::from_secs(3);

impl Hub {
    pub(super) fn serial(&mut self, arrival: &Arrival, bytes: &[u8]) {
        let Some(index) = self.port(arrival) else { return };
        let port = &mut self.ports[index];
        port.heard_ns = arrival.unix_ns;
        if let Some(recorder) = &self.recorder {
            recorder.give(Record::Raw(Arc::clone(&port.name), bytes.to_vec(), arrival.unix_ns));
        }
        let mut items = std::mem::take(&mut self.items);
        let mut session = port.session.take().unwrap_or_default();
        let before = session.counts();
        session.push(bytes, &mut items);
        let after = session.counts();
        for place in session.nodes() {
            let Some(quality) = session.quality(place) else { continue };
            let Some(node) = self.node(index, place) else { continue };
            if quality.samples < node.taken {
                node.restart();
            }
            node.arrived(quality.samples.saturating_sub(node.taken), arrival.at);
            node.taken = quality.samples;
            node.clock_s = quality.clock_residual_s;
        }
        let port = &mut self.ports[index];
        port.session = Some(session);
        let waited = arrival.at.saturating_duration_since(port.since);
        let unreadable = after.frames == 0 && waited > UNREADABLE && !port.unreadable;
        port.unreadable |= unreadable;
        self.pulses.add(arrival.at, (after.pulses - before.pulses) as u32);
        if let Some(input) = self.inputs.get_mut(arrival.input) {
            input.rate.add(arrival.at, (after.samples - before.samples) as u32);
            input.lost += after.lost - before.lost;
            input.bad += after.garbage - before.garbage;
        }
        if unreadable {
            let name = self.inputs.get(arrival.input).map_or("", |input| input.name.as_str());
            self.note(Note::new(
                Level::Warning,
                format!("{name}: nothing readable comes from the port; is it a receiver's?"),
                format!("{name}：読めるデータが届いていません。レシーバのポートか確認してください"),
            ));
        }
        self.take_in(index, &mut items, arrival);
        self.items = items;
    }

    /// What a port's session told goes into the recording and to whom it concerns.
    fn take_in(&mut self, port: usize, items: &mut Vec<Item>, arrival: &Arrival) {
        let Some(Port { name, session: Some(session), .. }) = self.ports.get(port) else { return };
        let (name, receiver_s) = (Arc::clone(name), session.time_s());
        for item in items.drain(..) {
            if let Some(recorder) = &self.recorder
                && !matches!(item, Item::Hello(_))
            {
                let item = Box::new(item.clone());
                recorder.give(Record::Item(Arc::clone(&name), item, receiver_s, arrival.unix_ns));
            }
            self.item(port, item, arrival);
        }
    }

    /// The end: samples that wait for a clock, for a pulse or for a frame are taken as they are.
    pub(super) fn take_what_waits(&mut self) {
        for index in 0..self.ports.len() {
            let port = &mut self.ports[index];
            let Some(session) = &mut port.session else { continue };
            let mut items = Vec::new();
            session.finish(&mut items);
            let arrival = Arrival {
                input: port.input,
                port: Arc::clone(&port.name),
                at: Instant::now(),
                unix_ns: port.heard_ns,
                what: What::End,
            };
            self.take_in(index, &mut items, &arrival);
        }
        self.release(Instant::now());
    }

    /// The node at a place of a port.
    pub(super) fn node(&mut self, port: usize, place: u8) -> Option<&mut Node> {
        let found = self.nodes.iter().position(|node| node.place == (port, place));
        let index = match found {
            Some(index) => index,
            None if self.nodes.len() < NODES_MAX => {
                self.nodes.push(Node::new((port, place), format!("node {place}")).ok()?);
                self.nodes.len() - 1
            }
            None => return None,
        };
        self.nodes.get_mut(index)
    }

    fn item(&mut self, port: usize, item: Item, arrival: &Arrival) {
        match item {
            Item::Sample(sample) => self.sample(port, &sample, arrival),
            Item::Node(info) => {
                let Some(node) = self.node(port, info.node) else { return };
                node.battery_v = (info.battery_mv > 0).then(|| f64::from(info.battery_mv) * 1e-3);
                node.temperature_c = info.temperature_centi_c.map(|t| f64::from(t) * 0.01);
                self.own_name((port, info.node), &info.name);
            }
            Item::Lost(place, count) => {
                if let Some(node) = self.node(port, place) {
                    node.lost += count;
                }
            }
            Item::Rebooted(place, _) => {
                if let Some(node) = self.node(port, place) {
                    node.past.clear();
                    let name = node.name.clone();
                    self.note(Note::new(
                        Level::Warning,
                        format!("{name} started anew"),
                        format!("{name} が再起動しました"),
                    ));
                }
            }
            Item::ReceiverRebooted(_) => {
                self.note(Note::new(Level::Warning, "the receiver started anew", "レシーバが再起動しました"));
                self.uncouple(port);
            }
            Item::CountedAnew => {
                self.note(Note::new(
                    Level::Info,
                    "pulses are counted anew; sensors are found on their bodies again",
                    "パルスの番号が最初に戻りました。センサと剛体を対応付け直します",
                ));
                self.uncouple(port);
            }
            Item::Event(event) => self.refused(port, &event),
            Item::Calibration(place, kept) => {
                let kept = kept.as_ref().map(kept::of_node);
                let Some(index) = self.nodes.iter().position(|node| node.place == (port, place)) else {
                    return;
                };
                if self.nodes[index].keeps(kept).unwrap_or(false) {
                    self.uncouple_node(index);
                }
            }
            Item::Hello(_) | Item::Garbage => {}
        }
    }

    fn sample(&mut self, port: usize, sample: &Sample, arrival: &Arrival) {
        let Some(index) = self.nodes.iter().position(|node| node.place == (port, sample.node)) else {
            return;
        };
        let node = &mut self.nodes[index];
        let came = node.arrival();
        let sample = &node.corrected(sample);
        node.past.push(sample, arrival.unix_ns as f64 * 1e-9);
        if let Some(t) = sample.temperature_c {
            node.temperature_c = Some(t);
        }
        if let Some(merger) = &mut node.merger {
            let mut moved = Vec::new();
            merger.sample(sample, &mut moved);
            node.merging.extend(came);
            self.moved(index, &moved, arrival.at, arrival.unix_ns);
        } else {
            let shown = node.alone(sample, arrival.at);
            let name = node.name.clone();
            if let Some(object) = self.scene.object(Key::Node(index), &name) {
                object.shown = Some(shown);
            }
            if let Some(came) = came {
                self.latency.add(came.elapsed());
            }
        }
        self.fresh = true;
    }
}
