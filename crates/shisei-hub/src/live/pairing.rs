//! Which node is on which body: by what was said, else by common motion; and the clocks, compared again and again.

use std::time::{Duration, Instant};

use super::hub::Hub;
use super::learn::Question;
use super::merge::{Clocking, Coupling, Merger};
use super::note::{Level, Note};
use super::optics::BodyKey;
use super::recorder::Recorder;
use super::scene::Key;

/// Least of a node's past that is searched, s.
const LEAST_S: f64 = 9.0;
/// From one search for a node to the next, while nothing is found, and to compare clocks that run apart.
const AGAIN: Duration = Duration::from_secs(4);
const CLOCKS: Duration = Duration::from_secs(15);
/// After so many searches near the arrivals' offset the whole past is searched.
const TRIES: u32 = 3;
/// By then nodes and bodies that pairs name have been heard of.
const HEARD: Duration = Duration::from_secs(10);

impl Hub {
    /// Nodes whose body was said.
    pub(super) fn pair_by_name(&mut self) {
        let pairs = self.settings.pairs.clone();
        for node in &mut self.nodes {
            let said = pairs.iter().find(|(name, _)| *name == node.own_name || *name == node.name);
            let body_name = said.map_or(node.own_name.as_str(), |(_, body)| body.as_str());
            let body = self.scene.objects().find(|object| object.name == body_name);
            if let Some(Key::Body(body)) = body.map(|object| object.key)
                && node.merger.is_none()
            {
                node.body = Some(body);
            }
        }
    }

    /// Says once which names of pairs no node and no body has.
    fn doubt_pairs(&mut self, now: Instant) {
        if self.pairs_doubted || now.saturating_duration_since(self.started) < HEARD {
            return;
        }
        self.pairs_doubted = true;
        let mut unknown = Vec::new();
        for (name, body) in &self.settings.pairs {
            if !self.nodes.iter().any(|node| *name == node.own_name || *name == node.name) {
                unknown.push((name.clone(), "node", "ノード"));
            }
            if !self.scene.objects().any(|object| object.name == *body) {
                unknown.push((body.clone(), "body", "剛体"));
            }
        }
        for (name, en, ja) in unknown {
            self.note(Note::new(
                Level::Warning,
                format!("no {en} is called {name}, which --pair names"),
                format!("--pair で指定された {name} という名前の{ja}はありません"),
            ));
        }
    }

    /// Asks the learner for what is not known, takes its answers.
    pub(super) fn learn(&mut self, now: Instant) {
        if let Some(answer) = self.learner.answer() {
            self.learnt(answer.node, answer.found.as_ref());
        }
        if !self.learner.free() || !self.optical.past.has_steps() {
            return;
        }
        self.pair_by_name();
        self.doubt_pairs(now);
        let taken: Vec<BodyKey> =
            self.nodes.iter().filter(|node| node.merger.is_some()).filter_map(|node| node.body).collect();
        let free: Vec<BodyKey> = self
            .scene
            .objects()
            .filter_map(|object| match object.key {
                Key::Body(body) if !taken.contains(&body) => Some(body),
                _ => None,
            })
            .collect();
        let due =
            |asked: Option<Instant>, every| asked.is_none_or(|at| now.saturating_duration_since(at) >= every);
        let next = self.nodes.iter().enumerate().filter(|(_, node)| node.past.length_s() >= LEAST_S);
        let next = next.filter(|(_, node)| match &node.merger {
            None => due(node.asked, AGAIN * (1 + node.tries.min(8))),
            // counted pulses cannot run apart
            Some(merger) => {
                matches!(merger.coupling().clocking, Clocking::Times { .. }) && due(node.asked, CLOCKS)
            }
        });
        let Some((index, node)) = next.min_by_key(|(_, node)| node.asked) else { return };
        let bodies = match node.body {
            Some(body) => vec![body],
            None => free,
        };
        if bodies.is_empty() {
            return;
        }
        let question = Question {
            node: index,
            samples: node.past.clone(),
            frames: self.optical.past.clone(),
            bodies,
            anywhere: node.tries >= TRIES,
        };
        self.nodes[index].asked = Some(now);
        self.learner.ask(question);
    }

    fn learnt(&mut self, index: usize, found: Option<&super::learn::Found>) {
        let Some(node) = self.nodes.get_mut(index) else { return };
        let Some(found) = found else {
            node.tries = node.tries.saturating_add(1);
            let said =
                self.settings.pairs.iter().find(|(name, _)| *name == node.own_name || *name == node.name);
            if node.tries == TRIES + 2
                && node.merger.is_none()
                && let Some((name, body)) = said.cloned()
            {
                self.note(Note::new(
                    Level::Warning,
                    format!("{name} does not move as {body}, on which --pair says it is"),
                    format!("{name} の動きが、--pair で指定された {body} と一致しません"),
                ));
            }
            return;
        };
        // what has been forgotten meanwhile is not to be brought back
        if node.past.length_s() < LEAST_S {
            return;
        }
        node.tries = 0;
        match &mut node.merger {
            Some(merger) if merger.coupling().clocking.is_like(&found.coupling.clocking) => {
                merger.set_clocking(found.coupling.clocking);
                node.sync_s = Some(found.sigma_s);
            }
            // also where pulses have begun: what is remembered is in the times of another clock
            _ => {
                self.end_of_estimates(index);
                self.couple(index, found.body, found.coupling, found.sigma_s);
            }
        }
    }

    /// What a node's sensor made of its body ends here.
    fn end_of_estimates(&mut self, index: usize) {
        let Some(node) = self.nodes.get_mut(index) else { return };
        let smoothing = self.recorder.as_ref().and_then(Recorder::smoothing);
        if let Some(smoothing) = smoothing.filter(|_| node.merger.is_some()) {
            smoothing.end_of(index);
        }
        node.merger = None;
        node.merging.clear();
    }

    /// Sensors of a port are no longer brought together with bodies: its clock or its count of pulses has changed.
    pub(super) fn uncouple(&mut self, port: usize) {
        for index in 0..self.nodes.len() {
            if self.nodes[index].place.0 == port {
                self.uncouple_node(index);
            }
        }
    }

    /// One sensor is no longer brought together with its body: its clock or its readings have changed.
    pub(super) fn uncouple_node(&mut self, index: usize) {
        self.end_of_estimates(index);
        let Some(node) = self.nodes.get_mut(index) else { return };
        node.past.clear();
        node.asked = None;
        node.sync_s = None;
        // it may be moved to another body meanwhile; where its body was said, that is brought back
        let name = node.name.clone();
        if let Some(body) = node.body.take()
            && let Some(object) =
                self.scene.get_mut(Key::Body(body)).filter(|o| o.node.as_ref() == Some(&name))
        {
            object.node = None;
            self.scene.changed = true;
        }
    }

    /// A sensor is brought together with a body from now on.
    pub(super) fn couple(&mut self, index: usize, body: BodyKey, coupling: Coupling, sigma_s: f64) {
        let name = self.scene.get_mut(Key::Body(body)).map(|object| object.name.clone()).unwrap_or_default();
        let alignment =
            self.known.get(&name).map_or(coupling.alignment, |known| known.onto(&coupling.alignment));
        let coupling = Coupling { alignment, ..coupling };
        let Ok(merger) = Merger::new(coupling, &self.settings.optics) else { return };
        let Some(node) = self.nodes.get_mut(index) else { return };
        node.merger = Some(Box::new(merger));
        node.body = Some(body);
        node.sync_s = Some(sigma_s);
        let name = node.name.clone();
        self.scene.remove(Key::Node(index));
        if let Some(object) = self.scene.get_mut(Key::Body(body)) {
            object.node = Some(name.clone());
            let body_name = object.name.clone();
            if let Some(shown) = &mut object.shown {
                // times of another clock are not compared with the new one's
                shown.time_s = f64::NEG_INFINITY;
            }
            self.note(Note::new(
                Level::Info,
                format!("{name} is on {body_name} (clocks to {:.1} ms)", sigma_s * 1e3),
                format!("{name} を {body_name} に対応付けました (時刻の誤差 {:.1} ms)", sigma_s * 1e3),
            ));
        }
        self.scene.changed = true;
        self.smooth(index);
    }
}
