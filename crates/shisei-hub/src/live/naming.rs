//! Names of nodes: shown here at once, and sent to the node through its receiver, so that it keeps them.

use std::time::{Duration, Instant};

use shisei_wire::gatt::NAME_MAX;
use shisei_wire::message::{Command, Event, EventCode, NO_NODE};

use super::hub::{Hub, NODES_MAX};
use super::note::{Level, Note};
use super::scene::Key;
use crate::session::command_bytes;

/// A receiver answers within this time.
const PATIENCE: Duration = Duration::from_secs(3);

/// A name that a node was asked to take.
#[derive(Debug)]
pub(super) struct Naming {
    place: (usize, u8),
    name: String,
    asked: Instant,
}

impl Hub {
    /// A client calls a node by another name.
    pub(super) fn name(&mut self, node: &str, name: &str) {
        let Some(found) = self.nodes.iter_mut().find(|known| known.name == node) else { return };
        name.clone_into(&mut found.name);
        let (place, own) = (found.place, found.own_name.clone());
        if self.aliases.len() < NODES_MAX {
            self.aliases.insert(own, name.to_owned());
        }
        self.renamed(place, name);
        self.ask_to_be_named(place, name);
    }

    fn ask_to_be_named(&mut self, place: (usize, u8), name: &str) {
        let Some(port) = self.ports.get(place.0) else { return };
        let Some(outbox) = self.inputs.get(port.input).and_then(|input| input.outbox.as_ref()) else {
            return;
        };
        if name.len() > NAME_MAX {
            self.note(Note::new(
                Level::Warning,
                format!("{name} is called so here only: a node keeps {NAME_MAX} bytes"),
                format!(
                    "「{name}」はこの画面だけの名前です。ノードに保存できるのは {NAME_MAX} バイトまでです"
                ),
            ));
            return;
        }
        // it is told by asking for all nodes
        for command in [Command::Rename(place.1, name), Command::Ask] {
            if let Some(bytes) = command_bytes(command) {
                outbox.push(&port.name, bytes);
            }
        }
        self.namings.retain(|naming| naming.place != place);
        self.namings.push(Naming { place, name: name.to_owned(), asked: Instant::now() });
    }

    /// A receiver told a node's own name.
    pub(super) fn own_name(&mut self, place: (usize, u8), own: &str) {
        let asked = self.namings.iter().position(|naming| naming.place == place && naming.name == own);
        let taken = asked.map(|asked| self.namings.swap_remove(asked));
        let Some(node) = self.nodes.iter_mut().find(|node| node.place == place) else { return };
        if node.own_name != own && !own.is_empty() {
            let before = std::mem::replace(&mut node.own_name, own.to_owned());
            if taken.is_some() {
                // what it is called here it is called now
                self.aliases.remove(&before);
            }
            let name = self.aliases.get(own).map_or(own, String::as_str).to_owned();
            node.name.clone_from(&name);
            self.renamed(place, &name);
        }
        if taken.is_some() {
            self.note(Note::new(
                Level::Info,
                format!("{own}: the node keeps this name"),
                format!("ノードに名前「{own}」を保存しました"),
            ));
        }
    }

    /// A receiver did not take a command.
    pub(super) fn refused(&mut self, port: usize, event: &Event) {
        let rename = u32::from(Command::Rename(NO_NODE, "").kind());
        if event.code == EventCode::BadCommand && event.value == rename {
            self.not_named(|naming| {
                naming.place == (port, event.node) || naming.place.0 == port && event.node == NO_NODE
            });
        }
    }

    /// Names that no receiver has confirmed.
    pub(super) fn look_after_names(&mut self, now: Instant) {
        if !self.namings.is_empty() {
            self.not_named(|naming| now.saturating_duration_since(naming.asked) > PATIENCE);
        }
    }

    fn not_named(&mut self, which: impl Fn(&Naming) -> bool) {
        let all = std::mem::take(&mut self.namings);
        let (failed, waiting) = all.into_iter().partition::<Vec<_>, _>(which);
        self.namings = waiting;
        for Naming { name, .. } in failed {
            self.note(Note::new(
                Level::Warning,
                format!("{name}: the node did not take the name; it is called so here only"),
                format!("ノードに名前「{name}」を保存できませんでした。この画面だけの名前になります"),
            ));
        }
    }

    /// A name of a node has changed.
    fn renamed(&mut self, place: (usize, u8), name: &str) {
        let Some(index) = self.nodes.iter().position(|node| node.place == place) else { return };
        let body = self.nodes[index].body;
        if let Some(object) = self.scene.get_mut(Key::Node(index)) {
            name.clone_into(&mut object.name);
        }
        if let Some(object) = body.and_then(|body| self.scene.get_mut(Key::Body(body))) {
            object.node = Some(name.to_owned());
        }
        self.scene.changed = true;
    }
}
