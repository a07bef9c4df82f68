//! Servers that change, or mean no good: sockets of the test that say what a server should not.

use std::net::{Ipv4Addr, SocketAddr, UdpSocket};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, sync_channel};
use std::time::{Duration, Instant};

use shisei_hub::live::input::{Arrival, ToHub};
use shisei_hub::live::scene::OBJECTS_MAX;
use shisei_hub::live::{self, Board, Hub, Input, Kind, Line, State, What};
use shisei_hub::natnet::{self, Client, Stream, Told, Version, id, read, write};

const PATIENCE: Duration = Duration::from_secs(60);
const GROUP: [u8; 4] = [239, 255, 42, 98];

fn info(version: Version, multicast: bool, group: [u8; 4]) -> natnet::ServerInfo {
    natnet::ServerInfo {
        name: "Motive".into(),
        app_version: [3, 1, 0, 0],
        natnet_version: [version.major, version.minor, 0, 0],
        clock_hz: 10_000_000,
        data_port: 1511,
        multicast,
        group,
    }
}

fn body(id: i32) -> natnet::Body {
    natnet::Body {
        id,
        position_m: [1.0, 2.0, 3.0],
        quaternion_xyzw: [0.0, 0.0, 0.0, 1.0],
        error_m: 0.0,
        params: 1,
    }
}

fn frame(number: i32, ids: impl Iterator<Item = i32>, version: Version) -> Vec<u8> {
    let bodies = ids.map(body).collect();
    let mid_exposure = 1_000_000_000 + number as u64 * 83_333;
    write::frame(&natnet::Frame { number, bodies, mid_exposure, ..natnet::Frame::default() }, version)
}

/// A server's socket, and a client of ours that was told to ask there.
struct Stage {
    socket: UdpSocket,
    client: Option<SocketAddr>,
    /// How often it was asked who it is.
    asked: u32,
    arrivals: Receiver<ToHub>,
    stop: Arc<AtomicBool>,
    thread: Option<std::thread::JoinHandle<()>>,
}

impl Stage {
    fn new() -> Self {
        let socket = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).expect("a socket");
        socket.set_read_timeout(Some(Duration::from_millis(4))).expect("a timeout");
        let client = Client::new(&socket.local_addr().expect("bound").to_string());
        let (to_hub, arrivals) = sync_channel(65_536);
        let stop = Arc::new(AtomicBool::new(false));
        let line = Line::new(0, to_hub, Arc::clone(&stop));
        let thread = Some(std::thread::spawn(move || Box::new(client).run(&line)));
        Stage { socket, client: None, asked: 0, arrivals, stop, thread }
    }

    /// Answers what was asked, as a server of this kind.
    fn answer(&mut self, info: &natnet::ServerInfo) {
        let mut bytes = [0; 2048];
        while let Ok((count, from)) = self.socket.recv_from(&mut bytes) {
            self.client = Some(from);
            if let Ok((id::CONNECT, _)) = read::packet(&bytes[..count]) {
                self.asked += 1;
                self.send(&write::server_info(info));
            }
        }
    }

    fn send(&self, packet: &[u8]) {
        if let Some(client) = self.client {
            self.socket.send_to(packet, client).expect("sent");
        }
    }

    fn told(&self) -> Vec<What> {
        let arrivals = self.arrivals.try_iter().map(|message| match message {
            ToHub::Arrival(arrival) => arrival.what,
            ToHub::Command(_) => unreachable!("no clients"),
        });
        arrivals.collect()
    }
}

impl Drop for Stage {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            thread.join().expect("the client");
        }
    }
}

/// Motive that was ended and started in another version before it was missed.
#[test]
fn a_server_that_speaks_another_version_now_is_understood_again() {
    let mut stage = Stage::new();
    let (mut stream, mut version, mut read_after) = (Stream::default(), Version::V4_1, 0);
    let started = Instant::now();
    for number in 0.. {
        stage.answer(&info(version, false, GROUP));
        stage.send(&frame(number, 1..2, version));
        for what in stage.told() {
            let What::NatNet(packet) = what else { continue };
            if let Ok(Told::Frame(_)) = stream.push(&packet)
                && version == Version::V3_0
                && stream.version() == Some(version)
            {
                read_after += 1;
            }
        }
        if number == 60 {
            version = Version::V3_0;
        }
        if read_after > 20 {
            return;
        }
        assert!(started.elapsed() < PATIENCE, "frames of the other version are not read");
    }
}

#[test]
fn a_group_that_is_none_is_told_once_and_the_server_is_not_called_again_and_again() {
    let mut stage = Stage::new();
    let (started, mut notes, mut states) = (Instant::now(), 0, 0);
    while started.elapsed() < Duration::from_secs(4) {
        stage.answer(&info(Version::V4_1, true, [10, 0, 0, 1]));
        for what in stage.told() {
            match what {
                What::Note(note) => {
                    assert!(
                        note.en.contains("10.0.0.1:1511") && note.ja.contains("10.0.0.1:1511"),
                        "{note:?}"
                    );
                    notes += 1;
                }
                What::State(State::Connected | State::Lost) => states += 1,
                _ => {}
            }
        }
    }
    assert_eq!(notes, 1);
    assert!(states <= 2 && stage.asked <= 8, "{states} changes, asked {} times", stage.asked);
}

#[test]
fn what_cannot_be_followed_is_said() {
    let mut stage = Stage::new();
    let started = Instant::now();
    loop {
        stage.answer(&info(Version { major: 2, minor: 5 }, false, GROUP));
        let told = stage.told();
        assert!(!told.contains(&What::State(State::Connected)), "2.5 cannot be read");
        if told.iter().any(|what| matches!(what, What::Note(note) if note.en.contains("2.5"))) {
            break;
        }
        assert!(started.elapsed() < PATIENCE, "nothing is said of version 2.5");
    }
    let (to_hub, arrivals) = sync_channel(64);
    let stop = Arc::new(AtomicBool::new(false));
    let line = Line::new(0, to_hub, Arc::clone(&stop));
    let client = Box::new(Client::new("no-such-computer.invalid"));
    let thread = std::thread::spawn(move || client.run(&line));
    let told = arrivals.recv_timeout(PATIENCE).expect("a note");
    stop.store(true, Ordering::Relaxed);
    thread.join().expect("the client");
    let ToHub::Arrival(Arrival { what: What::Note(note), .. }) = told else { panic!("{told:?}") };
    assert!(note.en.contains("no-such-computer") && note.ja.contains("no-such-computer"), "{note:?}");
}

fn hub() -> Hub {
    let board = Arc::new(Board::new("{}"));
    Hub::new(live::Settings::default(), vec![("cameras".into(), Kind::NatNet)], Vec::new(), board)
}

fn push(hub: &mut Hub, packet: Vec<u8>) {
    let arrival = Arrival {
        input: 0,
        port: Arc::from("natnet"),
        at: Instant::now(),
        unix_ns: 0,
        what: What::NatNet(packet),
    };
    hub.push(ToHub::Arrival(arrival));
}

/// Each frame with other bodies: memory and messages stay bounded.
#[test]
fn bodies_without_end_end() {
    let mut hub = hub();
    push(&mut hub, write::server_info(&info(Version::V4_1, false, GROUP)));
    for number in 0..100 {
        push(&mut hub, frame(number, (0..500).map(|k| number * 500 + k), Version::V4_1));
    }
    assert_eq!(hub.scene().objects().count(), OBJECTS_MAX);
}

/// Frames that come twice, by unicast and by multicast, do not make up for those that are missing.
#[test]
fn a_frame_that_comes_twice_counts_once() {
    let mut hub = hub();
    push(&mut hub, write::server_info(&info(Version::V4_1, false, GROUP)));
    for number in (0..100).filter(|number| number % 10 != 5) {
        push(&mut hub, frame(number, 1..2, Version::V4_1));
        push(&mut hub, frame(number, 1..2, Version::V4_1));
    }
    let status = hub.status(Instant::now());
    assert_eq!((&status["inputs"][0]["lost"], &status["sync"]["frames"]), (&10.into(), &90.into()));
}

/// A count that begins anew with every frame is told once, not with every frame.
#[test]
fn what_happens_again_and_again_is_told_once_a_second() {
    let mut hub = hub();
    push(&mut hub, write::server_info(&info(Version::V4_1, false, GROUP)));
    for number in (0..200).rev() {
        push(&mut hub, frame(number * 1000, 1..2, Version::V4_1));
    }
    let told: Vec<_> = std::iter::from_fn(|| hub.told()).collect();
    assert!(matches!(told.as_slice(), [note] if note.en.contains("anew")), "{told:?}");
}
