//! What a client may say.

use serde_json::Value;

use super::hub::Hub;
use super::node::Node;
use super::scene::Key;

/// Longest name, bytes.
const NAME_MAX: usize = 60;

/// A client's wish.
#[derive(Clone, Debug, PartialEq)]
pub enum Command {
    /// Begin or end a recording.
    Record(bool),
    /// The attitude of a sensor without a body is none, as of now.
    Align(u32),
    /// The heading of a sensor without a body is this now, rad.
    Heading(u32, f64),
    /// A node gets another name.
    Name(String, String),
}

impl Command {
    /// A message; none where it is no wish that is known.
    pub fn parse(text: &str) -> Option<Self> {
        let value: Value = serde_json::from_str(text).ok()?;
        let body = || value["body"].as_u64().and_then(|id| u32::try_from(id).ok());
        let name = |key: &str| value[key].as_str().filter(|name| !name.is_empty()).map(tidy);
        match value["type"].as_str()? {
            "record" => value["on"].as_bool().map(Command::Record),
            "align" => body().map(Command::Align),
            "heading" => {
                let deg = value["deg"].as_f64().filter(|deg| deg.abs() <= 360.0)?;
                body().map(|id| Command::Heading(id, deg.to_radians()))
            }
            "name" => Some(Command::Name(name("node")?, name("name")?)),
            _ => None,
        }
    }
}

/// A name without control characters, not too long.
fn tidy(name: &str) -> String {
    let mut out = String::new();
    for c in name.chars().filter(|c| !c.is_control()) {
        if out.len() + c.len_utf8() > NAME_MAX {
            break;
        }
        out.push(c);
    }
    out
}

impl Hub {
    pub(super) fn command(&mut self, command: Command) {
        match command {
            Command::Record(on) => self.record(on),
            Command::Align(id) => {
                if let Some(node) = self.node_of(id) {
                    node.align();
                }
            }
            Command::Heading(id, yaw_rad) => {
                if let Some(node) = self.node_of(id) {
                    node.set_heading(yaw_rad);
                }
            }
            Command::Name(node, name) => self.name(&node, &name),
        }
    }

    fn node_of(&mut self, id: u32) -> Option<&mut Node> {
        match self.scene.key_of(id)? {
            Key::Node(index) => self.nodes.get_mut(index),
            Key::Body(_) => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wishes_are_understood_and_all_else_is_none() {
        let parse = Command::parse;
        assert_eq!(parse(r#"{"type":"record","on":true}"#), Some(Command::Record(true)));
        assert_eq!(parse(r#"{"type":"align","body":7}"#), Some(Command::Align(7)));
        assert_eq!(
            parse(r#"{"type":"heading","body":7,"deg":180}"#),
            Some(Command::Heading(7, std::f64::consts::PI))
        );
        assert_eq!(
            parse(r#"{"type":"name","node":"node 0","name":"左手\u0007"}"#),
            Some(Command::Name("node 0".into(), "左手".into()))
        );
        for wrong in [
            "",
            "[]",
            "nonsense",
            r#"{"type":"record"}"#,
            r#"{"type":"align","body":-1}"#,
            r#"{"type":"align","body":1e300}"#,
            r#"{"type":"heading","body":1,"deg":1e9}"#,
            r#"{"type":"name","node":"a","name":""}"#,
            r#"{"type":"format","disk":"c:"}"#,
        ] {
            assert_eq!(parse(wrong), None, "{wrong}");
        }
    }
}
