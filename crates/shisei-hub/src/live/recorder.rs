//! The recording's own thread: the disk never holds up the stream.

use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::RecvTimeoutError;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use shisei_core::fuse::delayed::DelayedSettings;

use super::backlog::{Backlog, Waiting, backlog};
use super::hub::Hub;
use super::input::unix_ns;
use super::lagged::{Lagged, Smoothing};
use super::node::Node;
use super::note::{Level, Note};
use super::scene::{Key, Shown};
use crate::session::Item;
use crate::take::Take;

/// What was recorded is handed to the system at least this often: it survives the end of this process.
const FLUSH: Duration = Duration::from_millis(400);
/// And about so often all of it is on the disk: it survives a power failure.
const SYNC: Duration = Duration::from_secs(1);
/// Names that are tried for a recording.
const NAMES_MAX: u32 = 10_000;

/// What is recorded.
#[derive(Debug)]
pub enum Record {
    /// What came over a port: its name, bytes, when, ns since 1970.
    Raw(Arc<str>, Vec<u8>, u64),
    /// What a session told: its port, the receiver's time, s, when.
    Item(Arc<str>, Box<Item>, f64, u64),
    /// A body as the cameras saw it: its path, number of the frame, when.
    Optical(String, Shown, i64, u64),
    /// A body as it is given out.
    Pose(String, Shown, u64),
    /// The body as it is known a little later: its path, when its sample came.
    Smoothed(String, Shown, u64),
    /// What happened.
    Note(String, u64),
}

/// A recording under way. Ends when it is dropped.
#[derive(Debug)]
pub struct Recorder {
    records: Option<Backlog>,
    smoothing: Option<Smoothing>,
    thread: Option<JoinHandle<io::Result<()>>>,
    path: PathBuf,
    started: Instant,
    bytes: Arc<AtomicU64>,
    failed: Arc<AtomicBool>,
}

impl Recorder {
    /// Begins one in a new file: this name, or where it is taken the name with a number.
    pub fn start(wanted: &Path) -> io::Result<Self> {
        let (path, file) = create(wanted)?;
        let (records, taken) = backlog();
        let (bytes, failed) = (Arc::new(AtomicU64::new(0)), Arc::new(AtomicBool::new(false)));
        let (counter, broken) = (Arc::clone(&bytes), Arc::clone(&failed));
        let thread = std::thread::spawn(move || {
            let worked = work(file, &taken, &counter);
            broken.store(worked.is_err(), Ordering::Relaxed);
            worked
        });
        Ok(Recorder {
            smoothing: Some(Smoothing::start(records.clone())),
            records: Some(records),
            thread: Some(thread),
            path,
            started: Instant::now(),
            bytes,
            failed,
        })
    }

    /// Takes something to be recorded.
    pub fn give(&self, record: Record) {
        if let Some(records) = &self.records {
            records.give(record);
        }
    }

    /// Where the estimate with a delay is made.
    pub fn smoothing(&self) -> Option<&Smoothing> {
        self.smoothing.as_ref()
    }

    /// Writing has failed.
    pub fn failed(&self) -> bool {
        self.failed.load(Ordering::Relaxed)
    }

    /// Records that were left out because the disk is too slow.
    pub fn left_out(&self) -> u64 {
        self.records.as_ref().map_or(0, Backlog::left_out)
    }

    /// Where it goes.
    pub fn file(&self) -> String {
        self.path.display().to_string()
    }

    /// How long it is, s.
    pub fn seconds(&self, now: Instant) -> f64 {
        now.saturating_duration_since(self.started).as_secs_f64()
    }

    /// How large it is.
    pub fn bytes(&self) -> u64 {
        self.bytes.load(Ordering::Relaxed)
    }

    /// Ends it: all that was given is written.
    pub fn end(mut self) -> io::Result<()> {
        if let Some(smoothing) = self.smoothing.take() {
            smoothing.end();
        }
        drop(self.records.take());
        match self.thread.take().map(JoinHandle::join) {
            Some(Ok(outcome)) => outcome,
            _ => Err(io::Error::other("recording")),
        }
    }
}

/// A recording that is being written to its end.
#[derive(Debug)]
pub(super) struct Ending {
    file: String,
    left_out: u64,
    thread: JoinHandle<io::Result<()>>,
}

fn create(wanted: &Path) -> io::Result<(PathBuf, File)> {
    let mut path = wanted.to_owned();
    for number in 2..NAMES_MAX {
        match File::create_new(&path) {
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
            opened => return opened.map(|file| (path, file)),
        }
        let stem = wanted.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        path = wanted.with_file_name(format!("{stem}-{number}.mcap"));
    }
    Err(io::ErrorKind::AlreadyExists.into())
}

fn work(file: File, records: &Waiting, bytes: &AtomicU64) -> io::Result<()> {
    let handle = file.try_clone()?;
    let mut take = Take::new(file, "live")?;
    let outcome = fill(&mut take, &handle, records, bytes);
    let written = take.written();
    if let Err(error) = outcome.and_then(|()| take.finish()).and_then(|()| handle.sync_data()) {
        // what was not written whole is no use to anybody
        let _ = handle.set_len(written);
        return Err(error);
    }
    Ok(())
}

fn fill(take: &mut Take<File>, file: &File, records: &Waiting, bytes: &AtomicU64) -> io::Result<()> {
    let (mut flushed, mut synced) = (Instant::now(), Instant::now());
    loop {
        match records.take(FLUSH) {
            Ok(record) => write(take, record)?,
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return Ok(()),
        }
        if flushed.elapsed() >= FLUSH {
            take.flush()?;
            flushed = Instant::now();
            bytes.store(take.written(), Ordering::Relaxed);
            if synced.elapsed() >= SYNC {
                file.sync_data()?;
                synced = Instant::now();
            }
        }
    }
}

fn write(take: &mut Take<File>, record: Record) -> io::Result<()> {
    match record {
        Record::Raw(port, bytes, unix_ns) => take.raw_of(&port, &bytes, unix_ns),
        Record::Item(port, item, receiver_s, unix_ns) => take.item_of(&port, &item, receiver_s, unix_ns),
        Record::Optical(path, shown, frame, unix_ns) => take.optical(&path, &shown.pose, frame, unix_ns),
        Record::Pose(path, shown, unix_ns) => take.pose(&path, &shown, unix_ns),
        Record::Smoothed(path, shown, unix_ns) => take.smoothed(&path, &shown, unix_ns),
        Record::Note(what, unix_ns) => take.note(&what, unix_ns),
    }
}

impl Hub {
    /// Begins or ends a recording.
    pub(super) fn record(&mut self, on: bool) {
        if on == self.recorder.is_some() {
            return;
        }
        if on {
            if let Err(error) = self.begin_recording() {
                let file = self.settings.record.display().to_string();
                self.note(Note::new(
                    Level::Error,
                    format!("{file} could not be written ({error})"),
                    format!("{file} に書き込めませんでした ({error})"),
                ));
            }
        } else if let Some(recorder) = self.recorder.take() {
            let mergers = self.nodes.iter_mut().filter_map(|node| node.merger.as_mut());
            mergers.for_each(|merger| merger.keep_taken(false));
            let (file, left_out) = (recorder.file(), recorder.left_out());
            // what still waits is written while the stream goes on
            self.ending.push(Ending { file, left_out, thread: std::thread::spawn(move || recorder.end()) });
        }
    }

    /// Begins a recording. An error is that of its file.
    pub fn begin_recording(&mut self) -> io::Result<()> {
        let recorder = Recorder::start(&self.settings.record)?;
        let now_ns = unix_ns();
        for port in &self.ports {
            for words in port.words.iter().flatten() {
                recorder.give(Record::Raw(Arc::clone(&port.name), words.clone(), now_ns));
            }
        }
        for port in &self.ports {
            // names and calibrations belong into it
            if let Some(input) = self.inputs.get(port.input) {
                input.ask(&port.name);
            }
        }
        let file = recorder.file();
        self.recorder = Some(recorder);
        (0..self.nodes.len()).for_each(|node| self.smooth(node));
        let (en, ja) = (format!("recording to {file}"), format!("{file} に記録しています"));
        self.note(Note::new(Level::Info, en, ja));
        Ok(())
    }

    /// Tells of recordings that were ended and are written, with `all` of those that are not yet.
    fn told_ended(&mut self, all: bool) {
        let (over, ending) = std::mem::take(&mut self.ending)
            .into_iter()
            .partition::<Vec<_>, _>(|ending| all || ending.thread.is_finished());
        self.ending = ending;
        for Ending { file, left_out, thread } in over {
            match thread.join().unwrap_or_else(|_| Err(io::Error::other("recording"))) {
                Ok(()) if left_out == 0 => {
                    let (en, ja) = (format!("recorded: {file}"), format!("記録しました：{file}"));
                    self.note(Note::new(Level::Info, en, ja));
                }
                Ok(()) => {
                    self.note(Note::new(
                        Level::Error,
                        format!("{file}: the disk was too slow, {left_out} records are missing in it"),
                        format!(
                            "{file}：ディスクへの書き込みが間に合わず、{left_out} 件のデータが欠落しました"
                        ),
                    ));
                    self.unrecorded.push(file);
                }
                Err(error) => {
                    self.note(Note::new(
                        Level::Error,
                        format!("{file}: {error}; what was recorded before is kept"),
                        format!("{file}：{error}。それまでの記録は残っています"),
                    ));
                    self.unrecorded.push(file);
                }
            }
        }
    }

    /// Files that were not recorded to their end: their disk was full, or too slow.
    pub fn unrecorded(&self) -> &[String] {
        &self.unrecorded
    }

    /// The end: what waits is taken, and recordings are closed.
    pub fn finish(&mut self) {
        self.take_what_waits();
        self.record(false);
        self.told_ended(true);
    }

    /// While it is recorded, a node on a body is also estimated with a delay.
    pub(super) fn smooth(&mut self, node: usize) {
        let Some(smoothing) = self.recorder.as_ref().and_then(Recorder::smoothing) else { return };
        let Some(Node { merger: Some(merger), body: Some(body), .. }) = self.nodes.get_mut(node) else {
            return;
        };
        let Some(object) = self.scene.get_mut(Key::Body(*body)) else { return };
        let settings = DelayedSettings {
            lag_s: self.settings.lag_s,
            optics: self.settings.optics,
            position_trust_s: self.settings.position_trust_s,
        };
        if let Ok(lagged) = Lagged::after(merger, &settings) {
            merger.keep_taken(true);
            smoothing.begin(node, object.topic(), lagged);
        }
    }

    /// What a node's merger took goes to that estimate as well.
    pub(super) fn smooth_on(&mut self, node: usize, unix_ns: u64) {
        let Some(smoothing) = self.recorder.as_ref().and_then(Recorder::smoothing) else { return };
        let Some(place) = self.nodes.get_mut(node) else { return };
        let Some(merger) = place.merger.as_mut() else { return };
        if !smoothing.taken(node, merger.taken(), unix_ns) {
            merger.keep_taken(false);
            let name = place.name.clone();
            self.note(Note::new(
                Level::Warning,
                format!("{name}: this computer is too slow for the estimate with a delay; in the recording it ends here"),
                format!("{name}：処理が間に合わないため、遅延を許した推定の記録をここで終えます"),
            ));
        }
    }

    /// A recording whose disk is full has ended: that is said.
    pub(super) fn look_after_recording(&mut self) {
        if self.recorder.as_ref().is_some_and(Recorder::failed) {
            self.record(false);
        }
        self.told_ended(false);
    }
}
