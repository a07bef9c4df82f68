//! What waits for the disk: bounded, so that one that is too slow costs records and not the computer's memory.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::Duration;

use super::recorder::Record;

/// What may wait, bytes: at 1 MB/s more than a minute.
const WAITING_MAX: usize = 96 * 1024 * 1024;

/// How much waits, and how much did not find room.
#[derive(Debug, Default)]
struct State {
    bytes: AtomicUsize,
    left_out: AtomicU64,
}

/// Where records are given.
#[derive(Clone, Debug)]
pub struct Backlog {
    records: Sender<Record>,
    state: Arc<State>,
}

/// Where they are taken.
#[derive(Debug)]
pub struct Waiting {
    records: Receiver<Record>,
    state: Arc<State>,
}

/// Both ends.
pub fn backlog() -> (Backlog, Waiting) {
    let (records, taken) = channel();
    let state = Arc::new(State::default());
    (Backlog { records, state: Arc::clone(&state) }, Waiting { records: taken, state })
}

impl Backlog {
    /// One more; it is left out while too much waits.
    pub fn give(&self, record: Record) {
        let bytes = size(&record);
        if self.state.bytes.load(Ordering::Relaxed).saturating_add(bytes) > WAITING_MAX {
            self.state.left_out.fetch_add(1, Ordering::Relaxed);
            return;
        }
        self.state.bytes.fetch_add(bytes, Ordering::Relaxed);
        // a thread that has ended has told why: the hub asks for it
        let _ = self.records.send(record);
    }

    /// Records that were left out.
    pub fn left_out(&self) -> u64 {
        self.state.left_out.load(Ordering::Relaxed)
    }
}

impl Waiting {
    /// The oldest; waits for it.
    pub fn take(&self, patience: Duration) -> Result<Record, RecvTimeoutError> {
        let record = self.records.recv_timeout(patience)?;
        self.state.bytes.fetch_sub(size(&record), Ordering::Relaxed);
        Ok(record)
    }
}

/// About how much memory a record takes, bytes.
fn size(record: &Record) -> usize {
    let beside = match record {
        Record::Raw(_, bytes, _) => bytes.len(),
        Record::Item(..) => size_of::<crate::session::Item>(),
        Record::Optical(text, ..)
        | Record::Pose(text, ..)
        | Record::Smoothed(text, ..)
        | Record::Note(text, _) => text.len(),
    };
    size_of::<Record>() + beside
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_disk_that_stands_still_costs_records_and_not_memory() {
        let (given, taken) = backlog();
        let packet = || Record::Raw(Arc::from("port"), vec![0; 1024 * 1024], 0);
        (0..200).for_each(|_| given.give(packet()));
        let left_out = given.left_out();
        assert!((100..=110).contains(&left_out), "{left_out}");
        // when it goes on, all that waited is there, and there is room again
        let mut waited = 0;
        while taken.take(Duration::ZERO).is_ok() {
            waited += 1;
        }
        assert_eq!(waited + left_out, 200);
        given.give(packet());
        assert!(taken.take(Duration::ZERO).is_ok());
        assert_eq!(given.left_out(), left_out);
    }
}
