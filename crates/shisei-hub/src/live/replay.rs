//! A recording, played as if it happened now.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::{Duration, Instant};

use super::input::{Input, Kind, Line, State, What};
use crate::natnet;

/// Longest single wait: the hub may want to end.
const NAP: Duration = Duration::from_millis(50);

/// A recording's raw bytes, and how fast they are played.
#[derive(Debug)]
pub struct Replay {
    name: String,
    /// Port, when, ns since 1970, bytes; in the order of the recording.
    messages: Vec<(Arc<str>, u64, Vec<u8>)>,
    speed: f64,
    packets: BTreeMap<Arc<str>, bool>,
}

impl Replay {
    /// From a recording's bytes; `speed` 1 is as it was, 0 as fast as possible. An error is that of
    /// [`crate::read::raw`].
    pub fn new(name: &str, file: &[u8], speed: f64) -> std::io::Result<Self> {
        let (mut messages, mut packets) = (Vec::new(), BTreeMap::new());
        let mut names: BTreeMap<String, Arc<str>> = BTreeMap::new();
        crate::read::raw(file, |port, unix_ns, bytes| {
            let port = names.entry(port.to_owned()).or_insert_with(|| Arc::from(port));
            // a port's first packet says what it is: NatNet's word about the server, or a receiver's bytes
            packets.entry(Arc::clone(port)).or_insert_with(|| is_natnet(bytes));
            messages.push((Arc::clone(port), unix_ns, bytes.to_vec()));
        })?;
        Ok(Replay { name: name.to_owned(), messages, speed, packets })
    }
}

fn is_natnet(bytes: &[u8]) -> bool {
    natnet::read::packet(bytes).is_ok_and(|(kind, payload)| {
        kind == natnet::id::SERVER_INFO && payload.len() >= 264 && natnet::read::server_info(payload).is_ok()
    })
}

impl Input for Replay {
    fn name(&self) -> String {
        self.name.clone()
    }

    fn kind(&self) -> Kind {
        Kind::Replay
    }

    fn run(self: Box<Self>, line: &Line) {
        let (started, first_ns) = (Instant::now(), self.messages.first().map_or(0, |first| first.1));
        let own: Arc<str> = Arc::from(self.name.as_str());
        line.give(&own, What::State(State::Connected));
        for (port, unix_ns, bytes) in self.messages {
            let since_s = unix_ns.saturating_sub(first_ns) as f64 * 1e-9;
            while self.speed > 0.0 && !line.stopped() {
                let left_s = since_s / self.speed - started.elapsed().as_secs_f64();
                if left_s <= 0.0 {
                    break;
                }
                std::thread::sleep(NAP.min(Duration::from_secs_f64(left_s)));
            }
            let what = if self.packets.get(&port) == Some(&true) {
                What::NatNet(bytes)
            } else {
                What::Serial(bytes)
            };
            if line.stopped() || !line.give_recorded(&port, what, unix_ns) {
                return;
            }
        }
        line.give(&own, What::End);
    }
}
