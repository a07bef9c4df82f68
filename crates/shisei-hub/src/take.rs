//! A recording in MCAP.
//!
//! | topic | what |
//! |---|---|
//! | `/raw/PORT` | the bytes of the line as they came, unreadable ones too; [`crate::Session`] decodes them anew |
//! | `/imu/N` | samples of the node at place N, `sensor_msgs/msg/Imu` |
//! | `/sample/N` | the same samples with boot, sequence number, time and frame index, JSON |
//! | `/optical/BODY` | a body as the cameras saw it, `geometry_msgs/msg/PoseStamped`, z up |
//! | `/pose/BODY` | the body as it was given out, the same |
//! | `/fused/BODY` | the same with source, gap and expected errors, JSON |
//! | `/smoothed/BODY` | as `/fused/BODY`, as it is known a little later: held at both ends of short gaps |
//! | `/smoothed_pose/BODY` | as `/pose/BODY`, the same |
//! | `/event` | what happened, JSON |
//!
//! BODY is the body's name, behind its skeleton's and a `/` where it is a bone; in names spaces and `/` become `_`.
//!
//! With several receivers the nodes of the second and later ones are called `PORT-N`.
//!
//! Chunks are built in memory and written whole, so a cut file ends at most in one torn chunk. [`Take::flush`] is to
//! be called at least every half second.

use std::collections::BTreeMap;
use std::io::{self, Write};
use std::sync::{Arc, Mutex};

use mcap::records::MessageHeader;
use mcap::write::NoSeek;
use serde_json::json;
use shisei_core::frames::Pose;

use crate::cdr;
use crate::kept;
use crate::live::scene::Shown;
use crate::session::{Item, Sample};

/// A recording as it is written.
pub struct Take<W: Write> {
    writer: mcap::Writer<NoSeek<Sink<W>>>,
    state: Arc<Mutex<State>>,
    port: String,
    channels: BTreeMap<String, u16>,
    sequence: u32,
    /// When each receiver's clock showed 0.
    receivers: BTreeMap<String, Zero>,
    /// The receiver whose nodes are called by their numbers alone.
    first_port: Option<String>,
}

impl<W: Write> std::fmt::Debug for Take<W> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Take")
            .field("port", &self.port)
            .field("channels", &self.channels)
            .finish_non_exhaustive()
    }
}

/// So long the smallest delay of a line is remembered, ns, and as long again at most: the clocks on both sides run apart.
const LEAST_NS: u64 = 30_000_000_000;

/// When a receiver's clock showed 0, ns since 1970: the line only ever delays, so the smallest delay is the best guess.
#[derive(Clone, Copy, Debug)]
struct Zero {
    /// When `least` was begun.
    since_ns: u64,
    /// The smallest since then.
    least: i128,
    /// The smallest of the time before.
    before: i128,
}

impl Zero {
    /// Takes another difference of both clocks; the smallest of the last half minute to minute.
    fn take(&mut self, unix_ns: u64, difference: i128) -> i128 {
        if unix_ns.saturating_sub(self.since_ns) > LEAST_NS {
            (self.since_ns, self.before, self.least) = (unix_ns, self.least, difference);
        }
        self.least = self.least.min(difference);
        self.least.min(self.before)
    }
}

/// What happened to the writer.
#[derive(Debug, Default)]
struct State {
    error: Option<io::Error>,
    written: u64,
}

/// Passes bytes on until one write fails; then keeps the error and swallows the rest, so that the file ends where
/// it was whole.
#[derive(Debug)]
struct Sink<W: Write> {
    inner: W,
    state: Arc<Mutex<State>>,
}

impl<W: Write> Sink<W> {
    fn guarded(&mut self, act: impl FnOnce(&mut W) -> io::Result<u64>) {
        let Ok(mut state) = self.state.lock() else { return };
        if state.error.is_none() {
            match act(&mut self.inner) {
                Ok(count) => state.written += count,
                Err(error) => state.error = Some(error),
            }
        }
    }
}

impl<W: Write> Write for Sink<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.guarded(|inner| inner.write_all(bytes).map(|()| bytes.len() as u64));
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.guarded(|inner| inner.flush().map(|()| 0));
        Ok(())
    }
}

impl<W: Write> Take<W> {
    /// Begins a recording of a port.
    pub fn new(inner: W, port: &str) -> io::Result<Self> {
        let state = Arc::new(Mutex::new(State::default()));
        let sink = Sink { inner, state: Arc::clone(&state) };
        let writer = mcap::WriteOptions::new()
            .compression(None)
            .disable_seeking(true)
            .library(concat!("shisei ", env!("CARGO_PKG_VERSION")))
            .create(NoSeek::new(sink))
            .map_err(other)?;
        let mut take = Take {
            writer,
            state,
            port: port.to_owned(),
            channels: BTreeMap::new(),
            sequence: 0,
            receivers: BTreeMap::new(),
            first_port: None,
        };
        take.flush()?;
        Ok(take)
    }

    /// Bytes of the line that came at a time, ns since 1970.
    pub fn raw(&mut self, bytes: &[u8], unix_ns: u64) -> io::Result<()> {
        let port = self.port.clone();
        self.raw_of(&port, bytes, unix_ns)
    }

    /// The same of a port of this name.
    pub fn raw_of(&mut self, port: &str, bytes: &[u8], unix_ns: u64) -> io::Result<()> {
        self.message(&format!("/raw/{port}"), None, unix_ns, unix_ns, bytes)
    }

    /// Something that a session told at a time, ns since 1970. `receiver_s` is the receiver's newest time.
    pub fn item(&mut self, item: &Item, receiver_s: f64, unix_ns: u64) -> io::Result<()> {
        let port = self.port.clone();
        self.item_of(&port, item, receiver_s, unix_ns)
    }

    /// The same of the receiver on a port of this name.
    pub fn item_of(&mut self, port: &str, item: &Item, receiver_s: f64, unix_ns: u64) -> io::Result<()> {
        match item {
            Item::Sample(sample) => {
                let stamp_ns =
                    sample.time_s.map_or(unix_ns, |time_s| self.stamp(port, time_s, receiver_s, unix_ns));
                let (imu, columns) = (cdr::imu(sample, stamp_ns), columns(sample));
                let node = match self.first_port.get_or_insert_with(|| port.to_owned()) {
                    first if first == port => sample.node.to_string(),
                    _ => format!("{port}-{}", sample.node),
                };
                self.message(&format!("/imu/{node}"), Some(&IMU), unix_ns, stamp_ns, &imu)?;
                self.message(
                    &format!("/sample/{node}"),
                    Some(&SAMPLE),
                    unix_ns,
                    stamp_ns,
                    columns.to_string().as_bytes(),
                )
            }
            // the gate's own event tells when
            Item::Hello(_) | Item::CountedAnew => Ok(()),
            Item::Event(event) => self.event(
                unix_ns,
                &json!({
                    "event": format!("{:?}", event.code), "node": event.node, "value": event.value,
                    "time_s": event.time_us as f64 * 1e-6,
                }),
            ),
            Item::Lost(node, count) => {
                self.event(unix_ns, &json!({"event": "LostHere", "node": node, "value": count}))
            }
            Item::Rebooted(node, boot) => {
                self.event(unix_ns, &json!({"event": "RebootedHere", "node": node, "value": boot}))
            }
            Item::ReceiverRebooted(boot) => {
                self.receivers.remove(port);
                self.event(unix_ns, &json!({"event": "ReceiverRebooted", "value": boot}))
            }
            Item::Node(node) => self.event(
                unix_ns,
                &json!({
                    "event": "Node", "node": node.node, "connected": node.connected, "address": node.address,
                    "name": node.name, "battery_mv": node.battery_mv,
                }),
            ),
            Item::Calibration(node, calibration) => self.event(
                unix_ns,
                &json!({
                    "event": "Calibration", "node": node,
                    "calibration": calibration.as_ref().map(kept::json),
                }),
            ),
            Item::Garbage => self.event(unix_ns, &json!({"event": "Garbage"})),
        }
    }

    /// A body in a frame as the cameras saw it, at a time, ns since 1970. `path` is as of [`Object::topic`].
    ///
    /// [`Object::topic`]: crate::live::scene::Object::topic
    pub fn optical(&mut self, path: &str, pose: &Pose, frame: i64, unix_ns: u64) -> io::Result<()> {
        let message = cdr::pose(pose, &format!("frame {frame}"), unix_ns);
        self.message(&format!("/optical/{path}"), Some(&POSE), unix_ns, unix_ns, &message)
    }

    /// A body as it was given out at a time, ns since 1970.
    pub fn pose(&mut self, path: &str, shown: &Shown, unix_ns: u64) -> io::Result<()> {
        self.fused(["/fused/", "/pose/"], path, shown, unix_ns)
    }

    /// The same as it is known a little later, at the time at which it was given out.
    pub fn smoothed(&mut self, path: &str, shown: &Shown, unix_ns: u64) -> io::Result<()> {
        self.fused(["/smoothed/", "/smoothed_pose/"], path, shown, unix_ns)
    }

    fn fused(&mut self, [fused, pose]: [&str; 2], path: &str, shown: &Shown, unix_ns: u64) -> io::Result<()> {
        let known = |value: f64, scale: f64| value.is_finite().then_some(value * scale);
        let p = shown.pose.position_m.map(|x| x.is_finite().then_some(x).filter(|_| shown.placed));
        let row = json!({
            "time_s": known(shown.time_s, 1.0),
            "p_m": p,
            "q_wxyz": shown.pose.world_from_body.to_array(),
            "source": shown.source.name(),
            "gap_s": shown.gap_s,
            "sigma_deg": known(shown.sigma_rad, 1f64.to_degrees()),
            "sigma_mm": known(shown.sigma_m, 1e3),
        });
        let row = row.to_string();
        self.message(&format!("{fused}{path}"), Some(&FUSED), unix_ns, unix_ns, row.as_bytes())?;
        if !shown.placed {
            return Ok(());
        }
        let message = cdr::pose(&shown.pose, "world", unix_ns);
        self.message(&format!("{pose}{path}"), Some(&POSE), unix_ns, unix_ns, &message)
    }

    /// Something that the door noticed: a port that is gone or back.
    pub fn note(&mut self, what: &str, unix_ns: u64) -> io::Result<()> {
        self.event(unix_ns, &json!({"event": what}))
    }

    fn event(&mut self, unix_ns: u64, event: &serde_json::Value) -> io::Result<()> {
        self.message("/event", Some(&EVENT), unix_ns, unix_ns, event.to_string().as_bytes())
    }

    /// A receiver's time as time of day.
    fn stamp(&mut self, port: &str, time_s: f64, receiver_s: f64, unix_ns: u64) -> u64 {
        let difference = i128::from(unix_ns) - (receiver_s * 1e9) as i128;
        let zero = self.receivers.entry(port.to_owned()).or_insert(Zero {
            since_ns: unix_ns,
            least: difference,
            before: difference,
        });
        let least = zero.take(unix_ns, difference);
        ((time_s * 1e9) as i128 + least).clamp(0, i128::from(u64::MAX)) as u64
    }

    fn message(
        &mut self,
        topic: &str,
        schema: Option<&Schema>,
        log_ns: u64,
        publish_ns: u64,
        data: &[u8],
    ) -> io::Result<()> {
        let channel_id = if let Some(&id) = self.channels.get(topic) {
            id
        } else {
            let id = self.channel(topic, schema)?;
            self.channels.insert(topic.to_owned(), id);
            id
        };
        self.sequence = self.sequence.wrapping_add(1);
        let header =
            MessageHeader { channel_id, sequence: self.sequence, log_time: log_ns, publish_time: publish_ns };
        self.writer.write_to_known_channel(&header, data).map_err(other)?;
        self.outcome()
    }

    fn channel(&mut self, topic: &str, schema: Option<&Schema>) -> io::Result<u16> {
        add_channel(&mut self.writer, topic, schema)
    }

    /// Closes the chunk and hands it to the system: what was given so far survives the end of this process.
    pub fn flush(&mut self) -> io::Result<()> {
        self.writer.flush().map_err(other)?;
        self.outcome()
    }

    /// Ends the recording with its index.
    pub fn finish(mut self) -> io::Result<()> {
        self.writer.finish().map_err(other)?;
        self.outcome()
    }

    /// Bytes that were written whole.
    pub fn written(&self) -> u64 {
        self.state.lock().map_or(0, |state| state.written)
    }

    fn outcome(&self) -> io::Result<()> {
        let Ok(state) = self.state.lock() else { return Ok(()) };
        match &state.error {
            None => Ok(()),
            Some(error) => Err(io::Error::new(error.kind(), error.to_string())),
        }
    }
}

/// A body's or skeleton's name as a part of a topic.
pub(crate) fn topic(name: &str) -> String {
    let part: String = name
        .chars()
        .map(|c| if c.is_whitespace() || c.is_control() || "/:~{}".contains(c) { '_' } else { c })
        .collect();
    if part.is_empty() { "body".to_owned() } else { part }
}

pub(crate) fn add_channel<W: Write + io::Seek>(
    writer: &mut mcap::Writer<W>,
    topic: &str,
    schema: Option<&Schema>,
) -> io::Result<u16> {
    let (schema_id, encoding) = match schema {
        None => (0, "application/octet-stream"),
        Some(s) => {
            let id = writer.add_schema(s.name, s.encoding, s.text.as_bytes()).map_err(other)?;
            (id, s.message_encoding)
        }
    };
    writer.add_channel(schema_id, topic, encoding, &BTreeMap::new()).map_err(other)
}

pub(crate) fn other(error: mcap::McapError) -> io::Error {
    io::Error::other(error)
}

pub(crate) struct Schema {
    pub name: &'static str,
    pub encoding: &'static str,
    pub message_encoding: &'static str,
    pub text: &'static str,
}

const IMU: Schema =
    Schema { name: cdr::NAME, encoding: "ros2msg", message_encoding: "cdr", text: cdr::DEFINITION };
pub(crate) const POSE: Schema =
    Schema { name: cdr::POSE_NAME, encoding: "ros2msg", message_encoding: "cdr", text: cdr::POSE_DEFINITION };
const FUSED: Schema = Schema {
    name: "shisei.Fused",
    encoding: "jsonschema",
    message_encoding: "json",
    text: r#"{"type":"object","properties":{"time_s":{"type":["number","null"]},"p_m":{"type":"array","items":{"type":["number","null"]}},"q_wxyz":{"type":"array","items":{"type":"number"}},"source":{"type":"string"},"gap_s":{"type":"number"},"sigma_deg":{"type":["number","null"]},"sigma_mm":{"type":["number","null"]}}}"#,
};
const SAMPLE: Schema = Schema {
    name: "shisei.Sample",
    encoding: "jsonschema",
    message_encoding: "json",
    text: r#"{"type":"object","properties":{"node":{"type":"integer"},"boot":{"type":"integer"},"seq":{"type":"integer"},"stamp_us":{"type":"integer"},"time_s":{"type":["number","null"]},"frame":{"type":["number","null"]},"from_gate":{"type":"boolean"},"arrival_frame":{"type":["integer","null"]},"late":{"type":"boolean"},"reading_missed":{"type":"boolean"},"temp_c":{"type":["number","null"]},"start":{"type":"string"},"filter":{"type":"string"},"calibrated":{"type":"boolean"}}}"#,
};
const EVENT: Schema = Schema {
    name: "shisei.Event",
    encoding: "jsonschema",
    message_encoding: "json",
    text: r#"{"type":"object","properties":{"event":{"type":"string"},"node":{"type":"integer"},"value":{"type":"integer"}}}"#,
};

fn columns(sample: &Sample) -> serde_json::Value {
    json!({
        "node": sample.node,
        "boot": sample.boot,
        "seq": sample.sequence,
        "stamp_us": sample.stamp_us,
        "time_s": sample.time_s,
        "frame": sample.frame,
        "from_gate": sample.from_gate,
        "arrival_frame": sample.arrival_frame,
        "late": sample.late,
        "reading_missed": sample.reading_missed,
        "temp_c": sample.temperature_c,
        "start": format!("{:?}", sample.start),
        "filter": format!("{:?}", sample.filter),
        "calibrated": sample.calibrated,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The receiver's clock is slower by 100 ppm, the line delays by up to 20 ms: for two hours the time of day that is
    /// made of its time stays with that at which samples come.
    #[test]
    fn a_receivers_clock_that_runs_apart_is_followed() {
        let mut zero = Zero { since_ns: 0, least: i128::MAX, before: i128::MAX };
        for k in 0..720_000_i128 {
            let (true_ns, delay_ns) = (k * 10_000_000, k * 7919 % 20_000_000);
            let (receiver_ns, unix_ns) = (true_ns - true_ns / 10_000, true_ns + delay_ns);
            let found_ns = receiver_ns + zero.take(unix_ns as u64, unix_ns - receiver_ns);
            // a minute's 6 ms
            assert!((found_ns - true_ns).abs() < 7_000_000, "{k}: {}", found_ns - true_ns);
        }
    }
}
