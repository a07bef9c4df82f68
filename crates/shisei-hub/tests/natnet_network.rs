//! Servers that send to a multicast group, and servers that are to be found: on this machine's own network. The
//! server is one of an independent implementation's frames (crates.io `natnet`) behind sockets of the test.

use std::net::{Ipv4Addr, SocketAddr, SocketAddrV4, UdpSocket};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, sync_channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use ::natnet as peer;
use shisei_core::frames::Axes;
use shisei_hub::live::input::ToHub;
use shisei_hub::live::scene::Scene;
use shisei_hub::live::{Input, Line, Output, State, What};
use shisei_hub::natnet::{self, Client, NatNetOut, Stream, Told, id, read, write};

const PATIENCE: Duration = Duration::from_secs(60);
const LOOPBACK: Ipv4Addr = Ipv4Addr::LOCALHOST;
const TICKS_HZ: u64 = 10_000_000;

/// A port that is free, and stays so for the moment.
fn free_port() -> u16 {
    let socket = UdpSocket::bind((LOOPBACK, 0)).expect("a socket");
    socket.local_addr().expect("bound").port()
}

/// Multicast within this machine; says why not where the system refuses.
fn multicast_works(group: SocketAddrV4) -> bool {
    let try_it = || -> std::io::Result<()> {
        let listener = UdpSocket::bind((Ipv4Addr::UNSPECIFIED, group.port()))?;
        listener.join_multicast_v4(group.ip(), &LOOPBACK)?;
        listener.set_read_timeout(Some(Duration::from_secs(1)))?;
        let sender = UdpSocket::bind((LOOPBACK, 0))?;
        socket2::SockRef::from(&sender).set_multicast_if_v4(&LOOPBACK)?;
        sender.send_to(b"there?", group)?;
        listener.recv_from(&mut [0; 16]).map(drop)
    };
    match try_it() {
        Ok(()) => true,
        Err(error) => {
            eprintln!("skipped: no multicast to {group} by way of {LOOPBACK}: {error}");
            false
        }
    }
}

/// A server that streams a body to a group, and answers who asks for it.
struct Server {
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Server {
    /// On an address for commands; `answers` says whom.
    fn start(
        address: SocketAddrV4,
        name: &'static str,
        group: SocketAddrV4,
        answers: fn(SocketAddr) -> bool,
    ) -> Self {
        let commands = UdpSocket::bind(address).expect("the port for commands");
        commands.set_read_timeout(Some(Duration::from_millis(4))).expect("a timeout");
        let data = UdpSocket::bind((LOOPBACK, 0)).expect("a socket");
        socket2::SockRef::from(&data).set_multicast_if_v4(&LOOPBACK).expect("the interface");
        let stop = Arc::new(AtomicBool::new(false));
        let until = Arc::clone(&stop);
        let thread = std::thread::spawn(move || {
            let frames = peer::SyntheticServer::new(peer::Version::new(4, 1, 0, 0), TICKS_HZ);
            let info = natnet::ServerInfo {
                name: name.into(),
                app_version: [3, 1, 0, 0],
                natnet_version: [4, 1, 0, 0],
                clock_hz: TICKS_HZ,
                data_port: group.port(),
                multicast: true,
                group: group.ip().octets(),
            };
            let body = [peer::PlannedBody::tracked(3, [1.0, 2.0, 3.0], [0.5, -0.5, 0.5, 0.5])];
            let (mut bytes, mut number) = ([0; 2048], 0);
            while !until.load(Ordering::Relaxed) {
                if let Ok((count, from)) = commands.recv_from(&mut bytes)
                    && answers(from)
                    && let Ok((id::CONNECT | id::DISCOVERY, _)) = read::packet(&bytes[..count])
                {
                    commands.send_to(&write::server_info(&info), from).expect("sent");
                }
                number += 1;
                let frame = frames.frame_with_sections(
                    number,
                    f64::from(number) / 120.0,
                    &body,
                    &peer::PlannedSections::default(),
                );
                let datagram = frame.and_then(|frame| frame.to_datagram(frames.version));
                data.send_to(&datagram.expect("a frame"), group).expect("sent");
            }
        });
        Server { stop, thread: Some(thread) }
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            thread.join().expect("the server");
        }
    }
}

/// Our client under way.
struct Following {
    arrivals: Receiver<ToHub>,
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Following {
    fn start(host: &str) -> Self {
        let (to_hub, arrivals) = sync_channel(65_536);
        let stop = Arc::new(AtomicBool::new(false));
        let line = Line::new(0, to_hub, Arc::clone(&stop));
        let client = Box::new(Client::new(host));
        let thread = std::thread::spawn(move || client.run(&line));
        Following { arrivals, stop, thread: Some(thread) }
    }

    /// Waits for something.
    fn until(&self, patience: Duration, mut wanted: impl FnMut(&What) -> bool) -> bool {
        let started = Instant::now();
        while started.elapsed() < patience {
            if let Ok(ToHub::Arrival(arrival)) = self.arrivals.recv_timeout(Duration::from_millis(20))
                && wanted(&arrival.what)
            {
                return true;
            }
        }
        false
    }

    /// Waits for so many frames; their numbers, and the body's place in the last.
    fn frames(&self, count: usize) -> (Vec<i32>, Option<[f32; 3]>) {
        let (mut stream, mut numbers, mut place) = (Stream::default(), Vec::new(), None);
        self.until(PATIENCE, |what| {
            let What::NatNet(bytes) = what else { return false };
            if let Ok(Told::Frame(frame)) = stream.push(bytes) {
                numbers.push(frame.number);
                place = frame.bodies.first().map(|body| body.position_m);
            }
            numbers.len() >= count
        });
        (numbers, place)
    }
}

impl Drop for Following {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            thread.join().expect("the client");
        }
    }
}

#[test]
fn frames_of_a_group_arrive_and_a_server_that_was_gone_is_followed_again() {
    let group = SocketAddrV4::new([239, 255, 42, 97].into(), free_port());
    if !multicast_works(group) {
        return;
    }
    let address = SocketAddrV4::new(LOOPBACK, free_port());
    let server = Server::start(address, "test", group, |_| true);
    let client = Following::start(&address.to_string());
    let (numbers, place) = client.frames(100);
    assert_eq!((numbers.len(), place), (100, Some([1.0, 2.0, 3.0])));
    assert!(numbers.windows(2).all(|two| two[1] == two[0] + 1), "{numbers:?}");
    drop(server);
    assert!(client.until(PATIENCE, |what| *what == What::State(State::Lost)), "it did not miss the server");
    let _server = Server::start(address, "test", group, |_| true);
    assert!(client.until(PATIENCE, |what| *what == What::State(State::Connected)), "it did not come back");
    assert_eq!(client.frames(10).0.len(), 10);
}

#[test]
fn a_server_on_this_machine_is_found_without_its_address_and_our_own_is_not_taken_for_one() {
    let group = SocketAddrV4::new([239, 255, 42, 96].into(), free_port());
    if !multicast_works(group) {
        return;
    }
    let command = free_port();
    // what this program gives out itself is no camera system
    let own = NatNetOut::new(LOOPBACK, command, 0, Axes::YUp).expect("a free port");
    let client = Following::start(&format!("auto:{command}"));
    let connected = |what: &What| *what == What::State(State::Connected);
    assert!(!client.until(Duration::from_millis(1500), connected), "it found itself");
    drop(own);
    let _server = Server::start(SocketAddrV4::new(LOOPBACK, command), "Motive", group, |_| true);
    assert!(client.until(PATIENCE, connected), "not found");
    assert_eq!(client.frames(20).1, Some([1.0, 2.0, 3.0]));
}

#[test]
fn a_server_on_the_network_is_found_by_asking_everybody() {
    // one that hears only what was sent to all: here, what did not come from the loopback
    let command = free_port();
    let heard = UdpSocket::bind((Ipv4Addr::UNSPECIFIED, command)).and_then(|listener| {
        listener.set_read_timeout(Some(Duration::from_secs(1)))?;
        let sender = UdpSocket::bind((Ipv4Addr::UNSPECIFIED, 0))?;
        sender.set_broadcast(true)?;
        sender.send_to(b"there?", (Ipv4Addr::BROADCAST, command))?;
        listener.recv_from(&mut [0; 16])
    });
    let address = match heard {
        Ok((_, from)) if !from.ip().is_loopback() => from.ip(),
        other => {
            eprintln!("skipped: no broadcast reaches this machine: {other:?}");
            return;
        }
    };
    let group = SocketAddrV4::new([239, 255, 42, 95].into(), free_port());
    let everywhere = SocketAddrV4::new(Ipv4Addr::UNSPECIFIED, command);
    let _server = Server::start(everywhere, "Motive", group, |from| !from.ip().is_loopback());
    let client = Following::start(&format!("auto:{command}"));
    let connected = |what: &What| *what == What::State(State::Connected);
    assert!(client.until(PATIENCE, connected), "the server at {address} was not found");
}

#[test]
fn what_we_give_out_to_a_group_arrives() {
    let group = SocketAddrV4::new([239, 255, 42, 94].into(), free_port());
    if !multicast_works(group) {
        return;
    }
    let mut out = NatNetOut::multicast(LOOPBACK, 0, group, Axes::YUp).expect("a free port");
    let scene = Scene::default();
    out.scene(&scene);
    let client = Following::start(&out.address().to_string());
    let (mut stream, mut frames, mut described) = (Stream::default(), 0, false);
    let started = Instant::now();
    let mut number = 0;
    while (frames < 50 || !described) && started.elapsed() < PATIENCE {
        number += 1;
        out.poses(&scene, Some(number), number as f64 / 120.0);
        client.until(Duration::from_millis(5), |what| {
            if let What::NatNet(bytes) = what {
                let told = stream.push(bytes);
                frames += u32::from(matches!(told, Ok(Told::Frame(_))));
                described |= matches!(told, Ok(Told::Model(_)));
            }
            false
        });
    }
    assert!(frames >= 50 && described, "{frames} frames");
    assert_eq!(out.clients(), 1);
    let none = SocketAddrV4::new([192, 0, 2, 1].into(), 1511);
    assert!(NatNetOut::multicast(LOOPBACK, 0, none, Axes::YUp).is_err(), "not a group");
}
