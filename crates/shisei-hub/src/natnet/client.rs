//! A client of Motive: finds the server, keeps the stream alive, comes back by itself.

use std::io::{self, ErrorKind};
use std::net::{Ipv4Addr, SocketAddr, SocketAddrV4, ToSocketAddrs, UdpSocket};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use socket2::{Domain, Protocol, SockAddr, Socket, Type};

use super::{COMMAND_PORT, PACKET_MAX, ServerInfo, Stream, Told, id, write};
use crate::live::input::{Input, Kind, Line, State, What};

/// From one keep-alive to the next: Motive forgets a client after a few seconds.
const KEEP_ALIVE: Duration = Duration::from_millis(250);
/// From one try to reach the server to the next.
const RETRY: Duration = Duration::from_millis(500);
/// Without a packet for so long, the server is gone.
const LOST: Duration = Duration::from_secs(2);
/// A read waits so long.
const READ: Duration = Duration::from_millis(20);
/// Descriptions are asked for again at most so often.
const ASK: Duration = Duration::from_secs(1);
/// Room for what comes while this program is busy, bytes.
const RECEIVE_BUFFER: usize = 4 * 1024 * 1024;

/// A client of one server.
#[derive(Debug)]
pub struct Client {
    host: String,
}

impl Client {
    /// Of a server by its address, `HOST` or `HOST:PORT`; `auto` finds one on the network.
    pub fn new(host: &str) -> Self {
        Client { host: host.to_owned() }
    }

    /// Where to ask: the server, or everybody.
    fn target(&self) -> Option<(SocketAddr, u16)> {
        if self.host == "auto" {
            let all = SocketAddrV4::new(Ipv4Addr::BROADCAST, COMMAND_PORT);
            return Some((all.into(), id::DISCOVERY));
        }
        let with_port = self.host.to_socket_addrs();
        let mut found = with_port.or_else(|_| (self.host.as_str(), COMMAND_PORT).to_socket_addrs()).ok()?;
        found.find(SocketAddr::is_ipv4).map(|address| (address, id::CONNECT))
    }
}

impl Input for Client {
    fn name(&self) -> String {
        format!("natnet {}", self.host)
    }

    fn kind(&self) -> Kind {
        Kind::NatNet
    }

    fn run(self: Box<Self>, line: &Line) {
        let port: Arc<str> = Arc::from(format!("natnet-{}", self.host.replace([':', '/'], "-")));
        let mut was_there = false;
        while !line.stopped() {
            if let Some(found) = self.find(line) {
                was_there = true;
                let ended = follow(&found, line, &port);
                if ended.is_ok() {
                    return;
                }
                line.give(&port, What::State(State::Lost));
            } else if !was_there {
                line.give(&port, What::State(State::Waiting));
            }
            std::thread::sleep(READ);
        }
    }
}

/// A server that has answered.
struct Found {
    socket: UdpSocket,
    server: SocketAddr,
    info: ServerInfo,
    words: Vec<u8>,
}

impl Client {
    /// Asks until a server answers; none where that cannot be, or when the hub ends.
    fn find(&self, line: &Line) -> Option<Found> {
        let (target, kind) = self.target()?;
        let socket = UdpSocket::bind((Ipv4Addr::UNSPECIFIED, 0)).ok()?;
        socket.set_broadcast(true).ok()?;
        socket.set_read_timeout(Some(READ)).ok()?;
        // frames come here as well
        let _ = socket2::SockRef::from(&socket).set_recv_buffer_size(RECEIVE_BUFFER);
        let mut bytes = vec![0; PACKET_MAX];
        while !line.stopped() {
            // a network that is not there yet refuses to send
            let _ = socket.send_to(&write::connect(kind), target);
            let asked = Instant::now();
            while asked.elapsed() < RETRY && !line.stopped() {
                let Ok((count, from)) = socket.recv_from(&mut bytes) else { continue };
                // whoever is asked by name must answer himself
                let expected = kind == id::DISCOVERY || from.ip() == target.ip();
                let packet = bytes.get(..count).unwrap_or_default();
                let mut stream = Stream::default();
                if expected && let Ok(Told::Server(info)) = stream.push(packet) {
                    let server =
                        if kind == id::DISCOVERY { SocketAddr::new(from.ip(), COMMAND_PORT) } else { target };
                    if kind == id::DISCOVERY {
                        let _ = socket.send_to(&write::connect(id::CONNECT), server);
                    }
                    return Some(Found { socket, server, info, words: packet.to_vec() });
                }
            }
        }
        None
    }
}

/// Follows a server until it is gone (an error) or the hub ends.
fn follow(found: &Found, line: &Line, port: &Arc<str>) -> io::Result<()> {
    line.give(port, What::State(State::Connected));
    line.give(port, What::NatNet(found.words.clone()));
    let over = Arc::new(AtomicBool::new(false));
    let group = if found.info.multicast { Some(group(&found.info)?) } else { None };
    let heard = Arc::new(std::sync::Mutex::new(Instant::now()));
    let changed = Arc::new(AtomicBool::new(true));
    let mut listener = Listener {
        stream: Stream::default(),
        line: line.clone(),
        port: Arc::clone(port),
        heard: Arc::clone(&heard),
        changed: Arc::clone(&changed),
        server: found.server,
    };
    // what it said of itself is known already
    let _ = listener.stream.push(&found.words);
    let thread = group.map(|socket| {
        let (mut listener, over) = (listener.clone(), Arc::clone(&over));
        std::thread::spawn(move || while !over.load(Ordering::Relaxed) && listener.listen(&socket).is_ok() {})
    });
    let outcome = attend(found, &mut listener, line, &heard, &changed);
    over.store(true, Ordering::Relaxed);
    if let Some(thread) = thread {
        // a panic there has been printed
        let _ = thread.join();
    }
    let _ = found.socket.send_to(&write::packet(id::DISCONNECT, &[]), found.server);
    outcome
}

fn attend(
    found: &Found,
    listener: &mut Listener,
    line: &Line,
    heard: &std::sync::Mutex<Instant>,
    changed: &AtomicBool,
) -> io::Result<()> {
    let (mut alive, mut asked) = (None::<Instant>, None::<Instant>);
    while !line.stopped() {
        if alive.is_none_or(|at| at.elapsed() >= KEEP_ALIVE) {
            alive = Some(Instant::now());
            let _ = found.socket.send_to(&write::packet(id::KEEP_ALIVE, &[]), found.server);
        }
        if asked.is_none_or(|at| at.elapsed() >= ASK) && changed.load(Ordering::Relaxed) {
            asked = Some(Instant::now());
            let _ = found.socket.send_to(&write::packet(id::REQUEST_MODEL, &[]), found.server);
        }
        listener.listen(&found.socket)?;
        if heard.lock().is_ok_and(|at| at.elapsed() > LOST) {
            return Err(ErrorKind::TimedOut.into());
        }
    }
    Ok(())
}

/// The socket on which a group's frames come.
fn group(info: &ServerInfo) -> io::Result<UdpSocket> {
    let socket = Socket::new(Domain::IPV4, Type::DGRAM, Some(Protocol::UDP))?;
    // other clients on this machine listen to the same
    socket.set_reuse_address(true)?;
    let _ = socket.set_recv_buffer_size(RECEIVE_BUFFER);
    socket.bind(&SockAddr::from(SocketAddrV4::new(Ipv4Addr::UNSPECIFIED, info.data_port)))?;
    socket.join_multicast_v4(&Ipv4Addr::from(info.group), &Ipv4Addr::UNSPECIFIED)?;
    socket.set_read_timeout(Some(READ))?;
    Ok(socket.into())
}

/// Takes packets from a socket to the hub.
#[derive(Clone)]
struct Listener {
    stream: Stream,
    line: Line,
    port: Arc<str>,
    heard: Arc<std::sync::Mutex<Instant>>,
    changed: Arc<AtomicBool>,
    server: SocketAddr,
}

impl Listener {
    /// Takes one packet, or waits a little. An error: nobody takes packets any more.
    fn listen(&mut self, socket: &UdpSocket) -> io::Result<()> {
        let mut bytes = vec![0; PACKET_MAX];
        // that a port is closed comes as an error of the next read, and is none here
        let Ok((count, from)) = socket.recv_from(&mut bytes) else { return Ok(()) };
        if from.ip() != self.server.ip() {
            return Ok(());
        }
        bytes.truncate(count);
        if let Ok(mut heard) = self.heard.lock() {
            *heard = Instant::now();
        }
        match self.stream.push(&bytes) {
            Ok(Told::Model(_)) => self.changed.store(false, Ordering::Relaxed),
            Ok(Told::Frame(frame)) if frame.params & 2 != 0 => self.changed.store(true, Ordering::Relaxed),
            _ => {}
        }
        if self.line.give(&self.port, What::NatNet(bytes)) {
            Ok(())
        } else {
            Err(ErrorKind::BrokenPipe.into())
        }
    }
}
