//! Where data come from. A door gives inputs; each runs in a thread of its own.

use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::SyncSender;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::time::{Instant, SystemTime, UNIX_EPOCH};

use super::note::Note;

/// What kind of input.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A receiver on a serial port.
    Serial,
    /// Motive.
    NatNet,
    /// A recording.
    Replay,
    /// The simulated laboratory.
    Demo,
}

impl Kind {
    /// `serial`, `natnet`, `replay`, `demo`.
    pub fn name(self) -> &'static str {
        match self {
            Kind::Serial => "serial",
            Kind::NatNet => "natnet",
            Kind::Replay => "replay",
            Kind::Demo => "demo",
        }
    }
}

/// How an input is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum State {
    /// Data come.
    Connected,
    /// It has not been found yet.
    #[default]
    Waiting,
    /// It was there and is gone; it is looked for.
    Lost,
}

impl State {
    /// `connected`, `waiting`, `lost`.
    pub fn name(self) -> &'static str {
        match self {
            State::Connected => "connected",
            State::Waiting => "waiting",
            State::Lost => "lost",
        }
    }
}

/// An input: something that gives a receiver's bytes, packets of NatNet, or both.
pub trait Input: Send {
    /// What users call it.
    fn name(&self) -> String;
    /// What kind it is.
    fn kind(&self) -> Kind;
    /// Gives what comes until [`Line::stopped`]; looks for what is gone by itself.
    fn run(self: Box<Self>, line: &Line);
}

/// What comes over a line.
#[derive(Clone, Debug, PartialEq)]
pub enum What {
    /// Bytes of a receiver.
    Serial(Vec<u8>),
    /// A packet of NatNet.
    NatNet(Vec<u8>),
    /// How the input is.
    State(State),
    /// Something to be told.
    Note(Note),
    /// The input has ended: a recording is over.
    End,
}

/// Something that came.
#[derive(Clone, Debug)]
pub struct Arrival {
    /// Which input.
    pub input: usize,
    /// Which of its ports; recordings have several.
    pub port: Arc<str>,
    /// When it came here.
    pub at: Instant,
    /// When it came first, ns since 1970: of a recording, when it was recorded.
    pub unix_ns: u64,
    /// What came.
    pub what: What,
}

/// What goes to the hub's own thread.
#[derive(Debug)]
pub enum ToHub {
    /// From an input.
    Arrival(Arrival),
    /// From a client.
    Command(super::Command),
}

/// What the hub wants to be written that nobody has fetched, at most.
const WORDS_MAX: usize = 64;

/// What the hub wants to be written to ports of an input: port and bytes, oldest first.
#[derive(Clone, Debug, Default)]
pub struct Outbox(Arc<Mutex<VecDeque<Word>>>);

/// A port, and what is to be written to it.
type Word = (Arc<str>, Vec<u8>);

impl Outbox {
    /// One more; while nobody fetches them, the oldest are forgotten.
    pub fn push(&self, port: &Arc<str>, bytes: Vec<u8>) {
        // what is in there is whole at every moment
        let mut words = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if words.len() >= WORDS_MAX {
            words.pop_front();
        }
        words.push_back((Arc::clone(port), bytes));
    }

    /// The oldest.
    pub fn fetch(&self) -> Option<Word> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).pop_front()
    }
}

/// An input's way to the hub.
#[derive(Clone, Debug)]
pub struct Line {
    input: usize,
    to_hub: SyncSender<ToHub>,
    stop: Arc<AtomicBool>,
    outbox: Outbox,
}

impl Line {
    /// The line of an input.
    pub fn new(input: usize, to_hub: SyncSender<ToHub>, stop: Arc<AtomicBool>) -> Self {
        Line { input, to_hub, stop, outbox: Outbox::default() }
    }

    /// What the hub wants to be written; inputs that can write look here often.
    pub fn outbox(&self) -> &Outbox {
        &self.outbox
    }

    /// The hub is ending.
    pub fn stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// Gives what came now on a port. Waits while the hub is behind; false when it is gone.
    pub fn give(&self, port: &Arc<str>, what: What) -> bool {
        self.give_recorded(port, what, unix_ns())
    }

    /// Has something told.
    pub fn note(&self, port: &Arc<str>, note: Note) {
        self.give(port, What::Note(note));
    }

    /// Gives what came at a time, ns since 1970.
    pub fn give_recorded(&self, port: &Arc<str>, what: What, unix_ns: u64) -> bool {
        let arrival =
            Arrival { input: self.input, port: Arc::clone(port), at: Instant::now(), unix_ns, what };
        self.to_hub.send(ToHub::Arrival(arrival)).is_ok()
    }
}

/// Now, ns since 1970: the time of day when this was asked first, and what has passed since, so that setting the
/// system's clock neither tears nor folds a recording. Time in which the computer sleeps does not count.
pub fn unix_ns() -> u64 {
    static FIRST: OnceLock<(Instant, u64)> = OnceLock::new();
    let (then, then_ns) = FIRST.get_or_init(|| {
        let since = SystemTime::now().duration_since(UNIX_EPOCH);
        (Instant::now(), since.map_or(0, |since| whole_ns(since.as_nanos())))
    });
    then_ns.saturating_add(whole_ns(then.elapsed().as_nanos()))
}

fn whole_ns(nanos: u128) -> u64 {
    u64::try_from(nanos).unwrap_or(u64::MAX)
}
