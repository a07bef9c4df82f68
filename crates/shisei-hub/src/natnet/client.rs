//! A client of Motive: finds the server, keeps the stream alive, comes back by itself.

use std::io::{self, ErrorKind};
use std::net::{IpAddr, Ipv4Addr, SocketAddr, SocketAddrV4, ToSocketAddrs, UdpSocket};
use std::sync::Arc;
use std::time::{Duration, Instant};

use socket2::{Domain, Protocol, SockAddr, Socket, Type};

use super::listener::{Heard, Listener};
use super::{COMMAND_PORT, OWN_NAME, PACKET_MAX, ServerInfo, Stream, Told, Version, id, write};
use crate::live::input::{Input, Kind, Line, State, What};
use crate::live::note::{Level, Note};
use crate::own_address::towards;

/// From one keep-alive to the next: Motive forgets a client after a few seconds.
const KEEP_ALIVE: Duration = Duration::from_millis(250);
/// From one try to reach the server to the next.
const RETRY: Duration = Duration::from_millis(500);
/// Without an answer for so long, that is told.
const UNANSWERED: Duration = Duration::from_secs(3);
/// Without a packet for so long, the server is asked who it is, and is gone.
const SILENT: Duration = Duration::from_millis(700);
const LOST: Duration = Duration::from_secs(2);
/// A read waits so long.
const READ: Duration = Duration::from_millis(20);
/// Descriptions, and who the server is, are asked for again at most so often.
const ASK: Duration = Duration::from_secs(1);
/// Room for what comes while this program is busy, bytes.
const RECEIVE_BUFFER: usize = 4 * 1024 * 1024;

/// A client of one server.
#[derive(Debug)]
pub struct Client {
    host: String,
    port: Arc<str>,
    /// What was told last, so that it is told once.
    told: Option<Note>,
}

impl Client {
    /// Of a server by its address, `HOST` or `HOST:PORT`; `auto` finds one on the network or on this machine,
    /// `auto:PORT` one that listens on another port than Motive's.
    pub fn new(host: &str) -> Self {
        let port = Arc::from(format!("natnet-{}", host.replace([':', '/'], "-")));
        Client { host: host.to_owned(), port, told: None }
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

    /// Has a difficulty told, once.
    fn tell(&mut self, line: &Line, en: String, ja: String) {
        let note = Note::new(Level::Warning, en, ja);
        if self.told.as_ref() != Some(&note) {
            line.note(&self.port, note.clone());
            self.told = Some(note);
        }
    }
}

impl Input for Client {
    fn name(&self) -> String {
        format!("natnet {}", self.host)
    }

    fn kind(&self) -> Kind {
        Kind::NatNet
    }

    fn run(mut self: Box<Self>, line: &Line) {
        let mut was_there = false;
        while !line.stopped() {
            if let Some(found) = self.find(line) {
                was_there = true;
                if self.follow(&found, line).is_ok() {
                    return;
                }
                line.give(&self.port, What::State(State::Lost));
            } else if !was_there {
                line.give(&self.port, What::State(State::Waiting));
            }
            std::thread::sleep(RETRY);
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
    fn find(&mut self, line: &Line) -> Option<Found> {
        let host = self.host.clone();
        let Some((targets, kind)) = self.targets() else {
            self.tell(
                line,
                format!("{host}: there is no computer of that name; give Motive's address, or auto"),
                format!("{host}：その名前のコンピュータが見つかりません。Motive のアドレスか auto を指定してください"),
            );
            return None;
        };
        let socket = UdpSocket::bind((Ipv4Addr::UNSPECIFIED, 0)).ok()?;
        socket.set_broadcast(true).ok()?;
        socket.set_read_timeout(Some(READ)).ok()?;
        // frames come here as well
        let _ = socket2::SockRef::from(&socket).set_recv_buffer_size(RECEIVE_BUFFER);
        let mut bytes = vec![0; PACKET_MAX];
        let begun = Instant::now();
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
                if info.version() < Version::V3_0 {
                    let Version { major, minor } = info.version();
                    self.tell(
                        line,
                        format!("{host}: the server speaks NatNet {major}.{minor}; 3.0 (Motive 2.0) or later is needed"),
                        format!("{host}：サーバは NatNet {major}.{minor} です。3.0 (Motive 2.0) 以降が必要です"),
                    );
                    continue;
                }
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
            if begun.elapsed() >= UNANSWERED && self.told.is_none() {
                self.tell(
                    line,
                    format!("natnet {host}: no answer yet; is Motive running, does it stream, and does the firewall let it through?"),
                    format!("natnet {host}：応答がありません。Motive の起動、ストリーミングの設定、ファイアウォールを確認してください"),
                );
            }
        }
        None
    }

    /// Follows a server until it is gone (an error) or the hub ends.
    fn follow(&mut self, found: &Found, line: &Line) -> io::Result<()> {
        let heard = Arc::new(Heard::default());
        let mut listener = Listener::new(line, &self.port, found.server, &heard);
        line.give(&self.port, What::State(State::Connected));
        // what it said of itself is known already
        line.give(&self.port, What::NatNet(listener.know(&found.words)));
        let group = if found.info.multicast { self.group(&found.info, found.server, line) } else { None };
        let thread = group.map(|socket| {
            let mut listener = listener.clone();
            std::thread::spawn(move || while !listener.over() && listener.listen(&socket).is_ok() {})
        });
        let outcome = attend(found, &mut listener, line, &heard);
        heard.end();
        if let Some(thread) = thread {
            // a panic there has been printed
            let _ = thread.join();
        }
        let _ = found.socket.send_to(&write::packet(id::DISCONNECT, &[]), found.server);
        outcome
    }

    /// The socket on which a group's frames come to this machine's address on the cameras' network; none, and told,
    /// where it cannot be had.
    fn group(&mut self, info: &ServerInfo, server: SocketAddr, line: &Line) -> Option<UdpSocket> {
        let own = match towards(server) {
            Some(IpAddr::V4(own)) => own,
            _ => Ipv4Addr::UNSPECIFIED,
        };
        let group = SocketAddrV4::new(Ipv4Addr::from(info.group), info.data_port);
        match join(group, own) {
            Ok(socket) => {
                self.told = None;
                Some(socket)
            }
            Err(error) => {
                let host = self.host.clone();
                self.tell(
                    line,
                    format!("natnet {host}: the server sends to the multicast group {group}, which cannot be listened to ({error}); let Motive stream by unicast, or free the port"),
                    format!("natnet {host}：サーバの送信先であるマルチキャストグループ {group} を受信できません ({error})。Motive をユニキャストにするか、ポートを空けてください"),
                );
                None
            }
        }
    }
}

fn attend(found: &Found, listener: &mut Listener, line: &Line, heard: &Heard) -> io::Result<()> {
    let (mut alive, mut asked) = (None::<Instant>, None::<Instant>);
    let mut asked_who = Instant::now();
    let say = |packet: &[u8]| {
        // who cannot be reached now is asked again
        let _ = found.socket.send_to(packet, found.server);
    };
    while !line.stopped() {
        if alive.is_none_or(|at| at.elapsed() >= KEEP_ALIVE) {
            alive = Some(Instant::now());
            say(&write::packet(id::KEEP_ALIVE, &[]));
        }
        if asked.is_none_or(|at| at.elapsed() >= ASK) && heard.wants_model() {
            asked = Some(Instant::now());
            say(&write::packet(id::REQUEST_MODEL, &[]));
        }
        // one that has started anew, perhaps in another version, knows nothing of us
        let silence = heard.silence();
        if (silence > SILENT || heard.puzzled()) && asked_who.elapsed() >= ASK {
            asked_who = Instant::now();
            say(&write::connect(id::CONNECT));
        }
        listener.listen(&found.socket)?;
        if silence > LOST {
            return Err(ErrorKind::TimedOut.into());
        }
        let anew = heard.server().filter(|info| {
            let way = |info: &ServerInfo| (info.multicast, info.data_port, info.group);
            way(info) != way(&found.info)
        });
        if anew.is_some() {
            return Err(ErrorKind::ConnectionReset.into());
        }
    }
    Ok(())
}

/// The socket on which a group's frames come to an address of this machine.
fn join(group: SocketAddrV4, own: Ipv4Addr) -> io::Result<UdpSocket> {
    let socket = Socket::new(Domain::IPV4, Type::DGRAM, Some(Protocol::UDP))?;
    // other clients on this machine listen to the same
    socket.set_reuse_address(true)?;
    let _ = socket.set_recv_buffer_size(RECEIVE_BUFFER);
    socket.bind(&SockAddr::from(SocketAddrV4::new(Ipv4Addr::UNSPECIFIED, group.port())))?;
    socket.join_multicast_v4(group.ip(), &own)?;
    socket.set_read_timeout(Some(READ))?;
    Ok(socket.into())
}
