//! All of it together: inputs in their threads, the hub, the server.

use std::collections::BTreeMap;
use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::time::{Duration, Instant};

use super::board::Board;
use super::hub::Hub;
use super::input::{Input, Line, ToHub};
use super::mounting::Mounting;
use super::note::Note;
use super::output::Output;
use super::settings::{Settings, hello};
use crate::server::{self, Access, Serving};

/// Arrivals that wait for the hub; then inputs wait.
const WAITING: usize = 8192;
/// Arrivals that are taken before clients are shown anything again.
const AT_ONCE: usize = 256;

/// What runs.
#[derive(Debug)]
pub struct Parts {
    /// Where data come from.
    pub inputs: Vec<Box<dyn Input>>,
    /// Where poses go besides the viewer.
    pub outputs: Vec<Box<dyn Output>>,
    /// Who may see the viewer.
    pub access: Access,
    /// How bodies' sensors sit on them, by the bodies' names.
    pub known: BTreeMap<String, Mounting>,
}

impl std::fmt::Debug for dyn Input {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.name())
    }
}

/// Who started it, and hears what happens while it runs.
pub trait Door {
    /// The viewer can be looked at.
    fn serving(&mut self, _: &Serving) {}
    /// Something happened.
    fn note(&mut self, _: &Note) {}
}

/// Nobody.
impl Door for () {}

/// Why it did not begin.
#[derive(Debug)]
pub enum Refused {
    /// The server's address could not be had.
    Address(io::Error),
    /// The recording that was to begin at once could not be made.
    Recording(io::Error),
}

/// Runs until `stop` is set or all inputs have ended.
pub fn run(
    settings: Settings,
    parts: Parts,
    stop: &Arc<AtomicBool>,
    door: &mut dyn Door,
) -> Result<Hub, Refused> {
    let board = Arc::new(Board::new(&hello(&settings)));
    let (to_hub, messages) = sync_channel::<ToHub>(WAITING);
    let serving =
        server::start(parts.access, Arc::clone(&board), to_hub.clone()).map_err(Refused::Address)?;
    let names = parts.inputs.iter().map(|input| (input.name(), input.kind())).collect();
    let record_now = settings.record_now;
    let mut hub = Hub::new(settings, names, parts.outputs, board);
    if record_now {
        hub.begin_recording().map_err(Refused::Recording)?;
    }
    door.serving(&serving);
    hub.know(parts.known);
    for (index, input) in parts.inputs.into_iter().enumerate() {
        let line = Line::new(index, to_hub.clone(), Arc::clone(stop));
        hub.reach(index, line.outbox().clone());
        std::thread::spawn(move || input.run(&line));
    }
    drop(to_hub);
    while !stop.load(Ordering::Relaxed) && !hub.over() {
        let wait = hub.due().saturating_duration_since(Instant::now()).min(Duration::from_millis(100));
        match messages.recv_timeout(wait) {
            Ok(message) => {
                hub.push(message);
                for message in messages.try_iter().take(AT_ONCE) {
                    hub.push(message);
                }
            }
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => break,
        }
        hub.tick(Instant::now());
        tell(&mut hub, door);
    }
    stop.store(true, Ordering::Relaxed);
    for message in messages.try_iter().take(WAITING) {
        hub.push(message);
    }
    // inputs that wait for room see that nobody takes anything any more
    drop(messages);
    hub.finish();
    tell(&mut hub, door);
    drop(serving);
    Ok(hub)
}

fn tell(hub: &mut Hub, door: &mut dyn Door) {
    while let Some(note) = hub.told() {
        door.note(&note);
    }
}
