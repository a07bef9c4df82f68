//! From the sockets of one server to the hub.

use std::io::{self, ErrorKind};
use std::net::{SocketAddr, UdpSocket};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use super::{Malformed, PACKET_MAX, ServerInfo, Stream, Told};
use crate::live::input::{Line, What};

/// What was heard of a server, on all of its sockets.
#[derive(Debug)]
pub struct Heard {
    stream: Mutex<Stream>,
    last: Mutex<Instant>,
    /// Its descriptions are not known, or others now.
    wants_model: AtomicBool,
    /// A packet could not be read since it last said who it is.
    puzzled: AtomicBool,
    over: AtomicBool,
}

impl Default for Heard {
    fn default() -> Self {
        Heard {
            stream: Mutex::default(),
            last: Mutex::new(Instant::now()),
            wants_model: AtomicBool::new(true),
            puzzled: AtomicBool::new(false),
            over: AtomicBool::new(false),
        }
    }
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    // what is in there is whole at every moment
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Heard {
    /// How long ago the last packet came.
    pub fn silence(&self) -> Duration {
        locked(&self.last).elapsed()
    }

    /// Its descriptions are to be asked for.
    pub fn wants_model(&self) -> bool {
        self.wants_model.load(Ordering::Relaxed)
    }

    /// What comes cannot be read: perhaps it is another server now.
    pub fn puzzled(&self) -> bool {
        self.puzzled.load(Ordering::Relaxed)
    }

    /// Who it said it is.
    pub fn server(&self) -> Option<ServerInfo> {
        locked(&self.stream).server().cloned()
    }

    /// Nobody listens any more.
    pub fn end(&self) {
        self.over.store(true, Ordering::Relaxed);
    }

    fn packet(&self, bytes: &[u8]) {
        *locked(&self.last) = Instant::now();
        let mut stream = locked(&self.stream);
        let before = stream.version();
        match stream.push(bytes) {
            Ok(Told::Server(_)) => {
                self.puzzled.store(false, Ordering::Relaxed);
                if stream.version() != before {
                    self.wants_model.store(true, Ordering::Relaxed);
                }
            }
            Ok(Told::Model(_)) => self.wants_model.store(false, Ordering::Relaxed),
            Ok(Told::Frame(frame)) if frame.params & 2 != 0 => {
                self.wants_model.store(true, Ordering::Relaxed);
            }
            Ok(Told::Frame(_) | Told::Nothing) => {}
            Err(Malformed) => self.puzzled.store(true, Ordering::Relaxed),
        }
    }
}

/// Takes packets of a server from a socket to the hub.
#[derive(Clone)]
pub struct Listener {
    line: Line,
    port: Arc<str>,
    server: SocketAddr,
    heard: Arc<Heard>,
    buffer: Vec<u8>,
}

impl Listener {
    /// Of a server.
    pub fn new(line: &Line, port: &Arc<str>, server: SocketAddr, heard: &Arc<Heard>) -> Self {
        Listener {
            line: line.clone(),
            port: Arc::clone(port),
            server,
            heard: Arc::clone(heard),
            buffer: vec![0; PACKET_MAX],
        }
    }

    /// Takes note of a packet that came before; gives it back.
    pub fn know(&mut self, packet: &[u8]) -> Vec<u8> {
        self.heard.packet(packet);
        packet.to_vec()
    }

    /// Nobody is to listen any more.
    pub fn over(&self) -> bool {
        self.heard.over.load(Ordering::Relaxed)
    }

    /// Takes one packet, or waits a little. An error: nobody takes packets any more.
    pub fn listen(&mut self, socket: &UdpSocket) -> io::Result<()> {
        // that a port is closed comes as an error of the next read, and is none here
        let Ok((count, from)) = socket.recv_from(&mut self.buffer) else { return Ok(()) };
        if from.ip() != self.server.ip() {
            return Ok(());
        }
        let packet = self.buffer.get(..count).unwrap_or_default();
        self.heard.packet(packet);
        // as many bytes as came: many packets may wait for the hub
        if self.line.give(&self.port, What::NatNet(packet.to_vec())) {
            Ok(())
        } else {
            Err(ErrorKind::BrokenPipe.into())
        }
    }
}
