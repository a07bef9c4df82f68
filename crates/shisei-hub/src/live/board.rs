//! What clients are shown: always the newest of each kind, so that a slow one misses what is old and holds up nobody.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use tokio::sync::{broadcast, watch};

/// Notes that a client may be behind.
const NOTES: usize = 32;

/// A message, shared.
pub type Text = Arc<str>;

/// The newest messages.
#[derive(Debug)]
pub struct Board {
    /// First of all.
    pub hello: Text,
    /// What there is.
    pub scene: watch::Sender<Text>,
    /// Where it is.
    pub poses: watch::Sender<Text>,
    /// How all is.
    pub status: watch::Sender<Text>,
    /// What happened.
    pub notes: broadcast::Sender<Text>,
    clients: AtomicUsize,
}

impl Board {
    /// With a first message.
    pub fn new(hello: &str) -> Self {
        let empty: Text = Arc::from("");
        Board {
            hello: Arc::from(hello),
            scene: watch::Sender::new(Arc::clone(&empty)),
            poses: watch::Sender::new(Arc::clone(&empty)),
            status: watch::Sender::new(empty),
            notes: broadcast::Sender::new(NOTES),
            clients: AtomicUsize::new(0),
        }
    }

    /// How many clients there are.
    pub fn clients(&self) -> usize {
        self.clients.load(Ordering::Relaxed)
    }

    /// One more client, if there are fewer than `most`.
    pub fn enter(&self, most: usize) -> bool {
        let more = |count: usize| (count < most).then_some(count + 1);
        self.clients.fetch_update(Ordering::Relaxed, Ordering::Relaxed, more).is_ok()
    }

    /// One client less.
    pub fn leave(&self) {
        self.clients.fetch_sub(1, Ordering::Relaxed);
    }
}
