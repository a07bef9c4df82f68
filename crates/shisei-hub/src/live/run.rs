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

/// Runs until `stop` is set or all inputs have ended. `started` hears where the viewer is. An error is the server's
/// address that could not be had.
pub fn run(
    settings: Settings,
    parts: Parts,
    stop: &Arc<AtomicBool>,
    started: impl FnOnce(&Serving),
) -> io::Result<Hub> {
    let board = Arc::new(Board::new(&hello(&settings)));
    let (to_hub, messages) = sync_channel::<ToHub>(WAITING);
    let serving = server::start(parts.access, Arc::clone(&board), to_hub.clone())?;
    started(&serving);
    let names = parts.inputs.iter().map(|input| (input.name(), input.kind())).collect();
    let mut hub = Hub::new(settings, names, parts.outputs, board);
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
    }
    stop.store(true, Ordering::Relaxed);
    // inputs that wait for room see that nobody takes anything any more
    drop(messages);
    hub.finish();
    drop(serving);
    Ok(hub)
}
