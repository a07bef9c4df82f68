//! A recording, played as if it happened now.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::{Duration, Instant};

use super::input::{Input, Kind, Line, State, What};
use super::note::{Level, Note};
use crate::natnet;
use crate::read;
use shisei_record::mcap_records::Loss;

/// What a recording of ours has, and others do not.
const NO_RAW: &str = "no bytes of a receiver or of Motive in it";
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
    /// What of the recording could not be read.
    loss: Loss,
}

impl Replay {
    /// From a recording's bytes; `speed` 1 is as it was, 0 as fast as possible. An error is that of
    /// [`read::raw`], or of a file that has nothing to be played.
    pub fn new(name: &str, file: &[u8], speed: f64) -> std::io::Result<Self> {
        let (mut messages, mut packets) = (Vec::new(), BTreeMap::new());
        let mut names: BTreeMap<String, Arc<str>> = BTreeMap::new();
        let loss = read::raw(file, |port, unix_ns, bytes| {
            let port = names.entry(port.to_owned()).or_insert_with(|| Arc::from(port));
            // a port's first packet says what it is: NatNet's word about the server, or a receiver's bytes
            packets.entry(Arc::clone(port)).or_insert_with(|| is_natnet(bytes));
            messages.push((Arc::clone(port), unix_ns, bytes.to_vec()));
        })?;
        if messages.is_empty() {
            return Err(std::io::Error::new(std::io::ErrorKind::InvalidData, NO_RAW));
        }
        Ok(Replay { name: name.to_owned(), messages, speed, packets, loss })
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
        let name = &self.name;
        if self.loss.parts > 0 {
            let parts = self.loss.parts;
            let english = format!("{name}: damaged parts that are left out: {parts}");
            let japanese = format!("{name}: 破損した部分が {parts} か所あります。その部分を除いて再生します");
            line.note(&own, Note::new(Level::Warning, english, japanese));
        }
        if self.loss.cut {
            let english = format!("{name} was cut: it is played up to there");
            let japanese = format!("{name} は途中で切れています。読める所まで再生します");
            line.note(&own, Note::new(Level::Warning, english, japanese));
        }
        for (port, unix_ns, bytes) in self.messages {
            let since_s = unix_ns.saturating_sub(first_ns) as f64 * 1e-9;
            while self.speed > 0.0 && !line.stopped() {
                let left_s = since_s / self.speed - started.elapsed().as_secs_f64();
                if left_s <= 0.0 {
                    break;
                }
                std::thread::sleep(Duration::try_from_secs_f64(left_s).map_or(NAP, |left| left.min(NAP)));
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

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicBool, Ordering};
    use std::sync::mpsc::sync_channel;

    use super::super::input::ToHub;
    use super::*;
    use crate::take::Take;

    fn recording() -> Vec<u8> {
        let mut file = Vec::new();
        let mut take = Take::new(&mut file, "port").unwrap();
        for second in 0..3 {
            take.raw(&[1, 2, 0], second * 1_000_000_000).unwrap();
            take.flush().unwrap();
        }
        take.finish().unwrap();
        file
    }

    /// What a replay gives in its first moments.
    fn given(replay: Replay) -> Vec<What> {
        let (to_hub, arrivals) = sync_channel(64);
        let stop = Arc::new(AtomicBool::new(false));
        let line = Line::new(0, to_hub, Arc::clone(&stop));
        let thread = std::thread::spawn(move || Box::new(replay).run(&line));
        std::thread::sleep(2 * NAP);
        stop.store(true, Ordering::Relaxed);
        thread.join().expect("it does not panic");
        let arrivals = arrivals.try_iter().filter_map(|message| match message {
            ToHub::Arrival(arrival) => Some(arrival.what),
            ToHub::Command(_) => None,
        });
        arrivals.collect()
    }

    /// A wait that no duration can hold.
    #[test]
    fn the_slowest_speed_waits() {
        let what = given(Replay::new("take", &recording(), 1e-300).unwrap());
        assert_eq!(what, [What::State(State::Connected), What::Serial(vec![1, 2, 0])]);
    }

    #[test]
    fn a_torn_recording_is_played_and_that_is_said() {
        let file = recording();
        // The second half of so short a recording repeats what the first says.
        let what = given(Replay::new("take", &file[..file.len() / 3], 0.0).unwrap());
        assert!(what.iter().any(|what| matches!(what, What::Note(note) if note.en.contains("was cut"))));
        assert!(what.contains(&What::Serial(vec![1, 2, 0])) && what.contains(&What::End));
        let whole = given(Replay::new("take", &file, 0.0).unwrap());
        assert!(!whole.iter().any(|what| matches!(what, What::Note(_))));
    }

    #[test]
    fn a_recording_of_other_things_is_refused() {
        let mut file = Vec::new();
        Take::new(&mut file, "port").unwrap().finish().unwrap();
        assert_eq!(Replay::new("take", &file, 1.0).unwrap_err().to_string(), NO_RAW);
    }
}
