//! A client of Motive: finds the server, keeps the stream alive, comes back by itself.

use std::io::{self, ErrorKind};
use std::net::{Ipv4Addr, SocketAddr, SocketAddrV4, ToSocketAddrs, UdpSocket};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use socket2::{Domain, Protocol, SockAddr, Socket, Type};

use super::{COMMAND_PORT, OWN_NAME, PACKET_MAX, ServerInfo, Stream, Told, id, write};
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
    /// Of a server by its address, `HOST` or `HOST:PORT`; `auto` finds one on the network or on this machine,
    /// `auto:PORT` one that listens on another port than Motive's.
    pub fn new(host: &str) -> Self {
        Client { host: host.to_owned() }
    }

    /// The port on which any server is looked for; none where one is named.
    fn anybody(&self) -> Option<u16> {
        match self.host.strip_prefix("auto")? {
            "" => Some(COMMAND_PORT),
            port => port.strip_prefix(':')?.parse().ok(),
        }
    }

    /// Where to ask: the server, or everybody.
    fn targets(&self) -> Option<(Vec<SocketAddr>, u16)> {
        if let Some(port) = self.anybody() {
            // a server on this machine may hear nothing else
            let all = [Ipv4Addr::BROADCAST, Ipv4Addr::LOCALHOST];
            return Some((all.map(|ip| SocketAddrV4::new(ip, port).into()).to_vec(), id::DISCOVERY));
        }
        let with_port = self.host.to_socket_addrs();
        let mut found = with_port.or_else(|_| (self.host.as_str(), COMMAND_PORT).to_socket_addrs()).ok()?;
        found.find(SocketAddr::is_ipv4).map(|address| (vec![address], id::CONNECT))
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
        let (targets, kind) = self.targets()?;
        let socket = UdpSocket::bind((Ipv4Addr::UNSPECIFIED, 0)).ok()?;
        socket.set_broadcast(true).ok()?;
        socket.set_read_timeout(Some(READ)).ok()?;
        // frames come here as well
        let _ = socket2::SockRef::from(&socket).set_recv_buffer_size(RECEIVE_BUFFER);
        let mut bytes = vec![0; PACKET_MAX];
        while !line.stopped() {
            for target in &targets {
                // a network that is not there yet refuses to send
                let _ = socket.send_to(&write::connect(kind), target);
            }
            let asked = Instant::now();
            while asked.elapsed() < RETRY && !line.stopped() {
                let Ok((count, from)) = socket.recv_from(&mut bytes) else { continue };
                let packet = bytes.get(..count).unwrap_or_default();
                let Ok(Told::Server(info)) = Stream::default().push(packet) else { continue };
                let server = if let Some(port) = self.anybody() {
                    // what another hub gives out is no camera system
                    if info.name == OWN_NAME {
                        continue;
                    }
                    let server = SocketAddr::new(from.ip(), port);
                    let _ = socket.send_to(&write::connect(id::CONNECT), server);
                    server
                } else {
                    // whoever is asked by name must answer himself
                    let Some(server) = targets.iter().find(|target| target.ip() == from.ip()) else {
                        continue;
                    };
                    *server
                };
                return Some(Found { socket, server, info, words: packet.to_vec() });
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
    let group = if found.info.multicast { Some(group(&found.info, towards(found.server))?) } else { None };
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

/// This machine's address on the way to a server: with several networks, the one that the cameras are on.
fn towards(server: SocketAddr) -> Ipv4Addr {
    let way = UdpSocket::bind((Ipv4Addr::UNSPECIFIED, 0)).and_then(|socket| {
        // nothing is sent by that
        socket.connect(server)?;
        socket.local_addr()
    });
    match way {
        Ok(SocketAddr::V4(own)) => *own.ip(),
        _ => Ipv4Addr::UNSPECIFIED,
    }
}

/// The socket on which a group's frames come to an address of this machine.
fn group(info: &ServerInfo, own: Ipv4Addr) -> io::Result<UdpSocket> {
    let socket = Socket::new(Domain::IPV4, Type::DGRAM, Some(Protocol::UDP))?;
    // other clients on this machine listen to the same
    socket.set_reuse_address(true)?;
    let _ = socket.set_recv_buffer_size(RECEIVE_BUFFER);
    socket.bind(&SockAddr::from(SocketAddrV4::new(Ipv4Addr::UNSPECIFIED, info.data_port)))?;
    socket.join_multicast_v4(&Ipv4Addr::from(info.group), &own)?;
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
