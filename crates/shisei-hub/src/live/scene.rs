//! What there is to be seen: bodies, bones and sensors without a body, each with a number that stays.

use std::collections::BTreeMap;
use std::time::Instant;

use serde_json::{Value, json};
use shisei_core::frames::Pose;
use shisei_core::fuse::Source;

use super::optics::{BodyInfo, BodyKey};
use crate::take::topic;

/// Objects at most; as many the viewer takes.
pub const OBJECTS_MAX: usize = 1000;

/// What an object is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Key {
    /// Something that the cameras see.
    Body(BodyKey),
    /// A sensor, by its number in the hub.
    Node(usize),
}

/// A pose as it is shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shown {
    /// The pose; the position may be unknown.
    pub pose: Pose,
    /// The position is known.
    pub placed: bool,
    /// Where it comes from.
    pub source: Source,
    /// Time since the cameras saw it, s.
    pub gap_s: f64,
    /// Expected error of the attitude, rad; NaN: not known.
    pub sigma_rad: f64,
    /// Expected error of the position, m; NaN: not known.
    pub sigma_m: f64,
    /// Its time on the clock by which newer and older are told apart, s.
    pub time_s: f64,
    /// When it came.
    pub at: Instant,
}

/// Something to be seen.
#[derive(Clone, Debug)]
pub struct Object {
    /// Its number for clients.
    pub id: u32,
    /// What it is.
    pub key: Key,
    /// Its name.
    pub name: String,
    /// Name of its skeleton.
    pub skeleton: Option<String>,
    /// What it hangs on.
    pub parent: Option<BodyKey>,
    /// Its markers, body coordinates, m.
    pub markers_m: Vec<[f64; 3]>,
    /// Name of the sensor on it.
    pub node: Option<String>,
    /// How it was last seen or computed.
    pub shown: Option<Shown>,
}

impl Object {
    /// Its name with its skeleton's, as in a path.
    pub fn path(&self) -> String {
        match &self.skeleton {
            Some(skeleton) => format!("{skeleton}/{}", self.name),
            None => self.name.clone(),
        }
    }

    /// The same as a recording's topics have it: names without spaces and slashes.
    pub fn topic(&self) -> String {
        let name = topic(&self.name);
        self.skeleton.as_ref().map_or_else(|| name.clone(), |skeleton| format!("{}/{name}", topic(skeleton)))
    }
}

/// All of it.
#[derive(Debug, Default)]
pub struct Scene {
    objects: BTreeMap<Key, Object>,
    next_id: u32,
    /// It is another than clients know.
    pub changed: bool,
}

impl Scene {
    /// An object, made where it is new; none where there are too many.
    pub fn object(&mut self, key: Key, name: &str) -> Option<&mut Object> {
        if self.objects.len() >= OBJECTS_MAX && !self.objects.contains_key(&key) {
            return None;
        }
        let (next_id, changed) = (&mut self.next_id, &mut self.changed);
        Some(self.objects.entry(key).or_insert_with(|| {
            *next_id += 1;
            *changed = true;
            Object {
                id: *next_id,
                key,
                name: name.to_owned(),
                skeleton: None,
                parent: None,
                markers_m: Vec::new(),
                node: None,
                shown: None,
            }
        }))
    }

    /// An object that is there.
    pub fn get_mut(&mut self, key: Key) -> Option<&mut Object> {
        self.objects.get_mut(&key)
    }

    /// What a client's number means.
    pub fn key_of(&self, id: u32) -> Option<Key> {
        self.objects.values().find(|object| object.id == id).map(|object| object.key)
    }

    /// All objects.
    pub fn objects(&self) -> impl Iterator<Item = &Object> {
        self.objects.values()
    }

    /// All objects.
    pub fn objects_mut(&mut self) -> impl Iterator<Item = &mut Object> {
        self.objects.values_mut()
    }

    /// Takes what the cameras' program says it streams; bodies that it no longer has go.
    pub fn describe(&mut self, bodies: &[BodyInfo]) {
        let count = self.objects.len();
        self.objects.retain(|key, _| match key {
            Key::Body(body) => bodies.iter().any(|info| info.key == *body),
            Key::Node(_) => true,
        });
        self.changed |= self.objects.len() != count;
        for info in bodies {
            let Some(object) = self.object(Key::Body(info.key), &info.name) else { return };
            let same = object.name == info.name
                && object.skeleton == info.skeleton
                && object.parent == info.parent
                && object.markers_m == info.markers_m;
            if !same {
                object.name.clone_from(&info.name);
                object.skeleton.clone_from(&info.skeleton);
                object.parent = info.parent;
                object.markers_m.clone_from(&info.markers_m);
                self.changed = true;
            }
        }
    }

    /// Takes an object away.
    pub fn remove(&mut self, key: Key) {
        self.changed |= self.objects.remove(&key).is_some();
    }

    /// The message.
    pub fn message(&self) -> Value {
        let ids: BTreeMap<BodyKey, u32> = self
            .objects
            .values()
            .filter_map(|object| match object.key {
                Key::Body(body) => Some((body, object.id)),
                Key::Node(_) => None,
            })
            .collect();
        let bodies: Vec<Value> = self
            .objects
            .values()
            .map(|object| {
                let kind = match object.key {
                    Key::Body(BodyKey::Rigid(_)) => "body",
                    Key::Body(BodyKey::Bone(..)) => "bone",
                    Key::Node(_) => "node",
                };
                json!({
                    "id": object.id, "name": object.name, "kind": kind, "skeleton": object.skeleton,
                    "parent": object.parent.and_then(|parent| ids.get(&parent)), "node": object.node,
                    "markers": object.markers_m,
                })
            })
            .collect();
        json!({"type": "scene", "bodies": bodies})
    }

    /// The newest poses as a message; `markers_m` are those of no body.
    pub fn poses(&self, time_s: f64, frame: Option<f64>, markers_m: &[[f64; 3]]) -> String {
        use std::fmt::Write;
        let mut out = String::with_capacity(96 * self.objects.len() + 128);
        let _ = write!(out, r#"{{"type":"poses","time_s":{time_s:.4},"frame":"#);
        number(&mut out, frame, 3);
        out.push_str(r#","poses":["#);
        let mut first = true;
        for object in self.objects.values() {
            let Some(shown) = &object.shown else { continue };
            out.push_str(if first { "[" } else { ",[" });
            first = false;
            let _ = write!(out, "{},", object.id);
            for position_m in shown.pose.position_m {
                number(&mut out, shown.placed.then_some(position_m), 5);
                out.push(',');
            }
            for part in shown.pose.world_from_body.to_array() {
                number(&mut out, Some(part), 6);
                out.push(',');
            }
            let _ = write!(out, "{},", shown.source.code());
            number(&mut out, Some(shown.gap_s), 3);
            out.push(',');
            number(&mut out, Some(shown.sigma_rad.to_degrees()), 3);
            out.push(',');
            number(&mut out, Some(shown.sigma_m * 1e3), 2);
            out.push(']');
        }
        out.push_str(r#"],"markers":["#);
        for (k, marker) in markers_m.iter().enumerate() {
            out.push_str(if k == 0 { "[" } else { ",[" });
            for (axis, x) in marker.iter().enumerate() {
                if axis > 0 {
                    out.push(',');
                }
                number(&mut out, Some(*x), 4);
            }
            out.push(']');
        }
        out.push_str("]}");
        out
    }
}

fn number(out: &mut String, value: Option<f64>, digits: usize) {
    use std::fmt::Write;
    match value.filter(|value| value.is_finite()) {
        Some(value) => {
            let _ = write!(out, "{value:.digits$}");
        }
        None => out.push_str("null"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_topic_is_of_names_that_divide_nothing() {
        let mut scene = Scene::default();
        let object = scene.object(Key::Body(BodyKey::Rigid(1)), "左手 1/2").expect("room");
        assert_eq!((object.path().as_str(), object.topic().as_str()), ("左手 1/2", "左手_1_2"));
        object.skeleton = Some("Alice B".into());
        assert_eq!(object.topic(), "Alice_B/左手_1_2");
        object.name.clear();
        assert_eq!(object.topic(), "Alice_B/body");
    }
}
