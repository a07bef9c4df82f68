//! The server and those who come: the page's own script, programs, slow ones, and ones that mean no good.

use std::io::{Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, sync_channel};
use std::time::{Duration, Instant};

use shisei_hub::live::input::ToHub;
use shisei_hub::live::{Board, Command};
use shisei_hub::server::{Access, Serving, start};
use tungstenite::{Message, WebSocket};

const PATIENCE: Duration = Duration::from_secs(60);

struct Stage {
    board: Arc<Board>,
    serving: Serving,
    to_hub: Receiver<ToHub>,
}

fn stage(token: Option<&str>) -> Stage {
    let board = Arc::new(Board::new(r#"{"type":"hello"}"#));
    board.scene.send_replace(Arc::from(r#"{"type":"scene"}"#));
    board.status.send_replace(Arc::from(r#"{"type":"status"}"#));
    let (sender, to_hub) = sync_channel(64);
    let access = Access { token: token.map(str::to_owned), ..Access::loopback(0) };
    let serving = start(access, Arc::clone(&board), sender).expect("a free port");
    Stage { board, serving, to_hub }
}

impl Stage {
    fn address(&self) -> SocketAddr {
        self.serving.access.address
    }

    fn client(&self) -> WebSocket<TcpStream> {
        client(self.address())
    }

    /// The code with which a request is answered.
    fn code(&self, head: &str) -> u16 {
        let mut stream = connect(self.address());
        stream.write_all(head.as_bytes()).expect("sent");
        let mut answer = String::new();
        stream.read_to_string(&mut answer).expect("an answer");
        answer.split(' ').nth(1).and_then(|code| code.parse().ok()).expect("a code")
    }
}

fn connect(address: SocketAddr) -> TcpStream {
    let stream = TcpStream::connect(address).expect("the server");
    stream.set_read_timeout(Some(PATIENCE)).expect("a timeout");
    stream
}

fn client(address: SocketAddr) -> WebSocket<TcpStream> {
    tungstenite::client(format!("ws://{address}/stream"), connect(address)).expect("a stream").0
}

/// Puts numbered poses on the boards 60 times a second until told to stop.
fn show(stages: [&Stage; 2], bytes: usize) -> (Arc<AtomicBool>, Arc<AtomicU64>, std::thread::JoinHandle<()>) {
    let (stop, shown) = (Arc::new(AtomicBool::new(false)), Arc::new(AtomicU64::new(0)));
    let (until, count) = (Arc::clone(&stop), Arc::clone(&shown));
    let boards = stages.map(|stage| Arc::clone(&stage.board));
    let thread = std::thread::spawn(move || {
        while !until.load(Ordering::Relaxed) {
            let number = count.fetch_add(1, Ordering::Relaxed) + 1;
            let text = format!(r#"{{"type":"poses","number":{number},"pad":"{}"}}"#, "x".repeat(bytes));
            for board in &boards {
                board.poses.send_replace(Arc::from(text.as_str()));
            }
            std::thread::sleep(Duration::from_millis(16));
        }
    });
    (stop, shown, thread)
}

fn number(text: &str) -> Option<u64> {
    let rest = text.split(r#""number":"#).nth(1)?;
    rest.split(',').next()?.parse().ok()
}

/// How many poses came, and the longest wait for one.
#[derive(Clone, Copy, Debug)]
struct Seen {
    count: u32,
    longest: Duration,
}

/// Reads poses for as long as it is so.
fn watch(client: &mut WebSocket<TcpStream>, so: impl Fn() -> bool) -> Seen {
    let mut last = Instant::now();
    let mut seen = Seen { count: 0, longest: Duration::ZERO };
    while so() {
        let message = client.read().expect("a message");
        if message.to_text().is_ok_and(|text| number(text).is_some()) {
            seen.count += 1;
            seen.longest = seen.longest.max(last.elapsed());
            last = Instant::now();
        }
    }
    seen
}

/// The same poses from a server in trouble, and at the same time from one that nobody troubles: what this machine
/// itself delays, it delays for both.
struct Two {
    troubled: WebSocket<TcpStream>,
    quiet: WebSocket<TcpStream>,
}

impl Two {
    fn watch(&mut self, so: impl Fn() -> bool + Sync) -> [Seen; 2] {
        std::thread::scope(|scope| {
            let quiet = scope.spawn(|| watch(&mut self.quiet, &so));
            let troubled = watch(&mut self.troubled, &so);
            [troubled, quiet.join().expect("no panic")]
        })
    }

    fn watch_for(&mut self, seconds: f64) -> [Seen; 2] {
        let begun = Instant::now();
        self.watch(|| begun.elapsed().as_secs_f64() < seconds)
    }
}

/// No pose is late, whatever this machine makes of it.
fn assert_prompt([troubled, quiet]: [Seen; 2], late: Duration) {
    assert!(troubled.longest < quiet.longest + late, "{troubled:?}, elsewhere {quiet:?}");
}

/// And at least half of them come.
fn assert_untroubled(seen: [Seen; 2]) {
    assert_prompt(seen, Duration::from_secs(1));
    let [troubled, quiet] = seen;
    assert!(2 * troubled.count > quiet.count, "{troubled:?}, elsewhere {quiet:?}");
}

#[test]
fn a_client_is_told_all_and_its_wishes_are_heard() {
    let stage = stage(None);
    let mut client = stage.client();
    let mut told = Vec::new();
    for _ in 0..3 {
        told.push(client.read().expect("a message").to_text().expect("text").to_owned());
    }
    assert_eq!(told, [r#"{"type":"hello"}"#, r#"{"type":"scene"}"#, r#"{"type":"status"}"#]);
    stage.board.notes.send(Arc::from(r#"{"type":"note"}"#)).expect("a client");
    stage.board.poses.send_replace(Arc::from(r#"{"type":"poses"}"#));
    let two = [client.read().expect("one"), client.read().expect("two")];
    let mut two = two.map(|message| message.to_text().expect("text").to_owned());
    two.sort();
    assert_eq!(two, [r#"{"type":"note"}"#, r#"{"type":"poses"}"#]);
    client.send(Message::text("nonsense")).expect("sent");
    client.send(Message::text(r#"{"type":"record","on":true}"#)).expect("sent");
    let heard = stage.to_hub.recv_timeout(PATIENCE).expect("a wish");
    assert!(matches!(heard, ToHub::Command(Command::Record(true))), "{heard:?}");
    assert_eq!(stage.board.clients(), 1);
    drop(client);
    let since = Instant::now();
    while stage.board.clients() > 0 && since.elapsed() < PATIENCE {
        std::thread::sleep(Duration::from_millis(10));
    }
    assert_eq!(stage.board.clients(), 0);
}

#[test]
fn clients_are_told_of_the_end() {
    let Stage { serving, .. } = stage(None);
    let mut clients = [client(serving.access.address), client(serving.access.address)];
    drop(serving);
    for client in &mut clients {
        let told = (0..100).find_map(|_| match client.read() {
            Ok(Message::Close(why)) => Some(why),
            Ok(_) => None,
            Err(error) => panic!("{error}"),
        });
        let why = told.flatten().expect("a reason");
        assert_eq!((u16::from(why.code), why.reason.as_str()), (1001, "shisei live ends"));
    }
}

#[test]
fn the_page_and_the_status_are_there_for_those_who_may() {
    let open = stage(None);
    let host = format!("Host: {}\r\n", open.address());
    assert_eq!(open.code(&format!("GET / HTTP/1.1\r\n{host}\r\n")), 200);
    assert_eq!(open.code(&format!("GET /viewer.js HTTP/1.1\r\n{host}\r\n")), 200);
    assert_eq!(open.code(&format!("GET /status HTTP/1.1\r\n{host}\r\n")), 200);
    assert_eq!(open.code(&format!("GET /status HTTP/1.1\r\n{host}Origin: http://evil.example\r\n\r\n")), 403);
    assert_eq!(open.code("GET / HTTP/1.1\r\nHost: evil.example\r\n\r\n"), 403);
    assert_eq!(open.code(&format!("GET /no HTTP/1.1\r\n{host}\r\n")), 404);
    assert_eq!(open.code("\r\n\u{1}\u{2}\u{3}\r\n\r\n"), 400);
    assert_eq!(open.code(&format!("GET / HTTP/1.1\r\nX: {}", "x".repeat(9000))), 431);
    let closed = stage(Some("0123456789abcdef"));
    let ask = |query: &str| format!("GET /status{query} HTTP/1.1\r\nHost: some.machine:1\r\n\r\n");
    assert_eq!(closed.code(&ask("?token=0123456789abcdef")), 200);
    for query in ["", "?token=", "?token=0123456789abcdee", "?token=0123456789abcdef0"] {
        assert_eq!(closed.code(&ask(query)), 403, "{query}");
    }
    let url = format!("ws://{}/stream?token=wrong", closed.address());
    assert!(tungstenite::client(url, connect(closed.address())).is_err());
    assert!(closed.serving.url().ends_with("/?token=0123456789abcdef"));
}

#[test]
fn a_slow_client_gets_the_newest_and_delays_nobody() {
    let (stage, quiet) = (stage(None), stage(None));
    let (stop, shown, thread) = show([&stage, &quiet], 20_000);
    let mut slow = stage.client();
    let mut quick = Two { troubled: stage.client(), quiet: quiet.client() };
    quick.watch_for(0.3);
    // the slow one reads nothing meanwhile: 3 s of 1.2 MB/s
    let seen = quick.watch_for(3.0);
    println!("beside a slow client: {:?}; elsewhere {:?}", seen[0], seen[1]);
    assert_untroubled(seen);
    stop.store(true, Ordering::Relaxed);
    thread.join().expect("no panic");
    let newest = shown.load(Ordering::Relaxed);
    let (mut read, mut last) = (0, 0);
    while last < newest {
        let message = slow.read().expect("a message");
        if let Some(number) = message.to_text().ok().and_then(number) {
            assert!(number > last);
            last = number;
            read += 1;
        }
    }
    println!("the slow client: {read} of {newest} poses, the newest among them");
    assert!(read < newest, "{read} of {newest}");
}

/// Ten thousand connections that say nothing or nonsense, several at a time.
fn flood(address: SocketAddr) {
    let some = || {
        let (mut open, mut made) = (std::collections::VecDeque::new(), 0_u32);
        while made < 1250 {
            // where too many come at once the system makes one wait for a second: another is quicker
            let Ok(mut stream) = TcpStream::connect_timeout(&address, Duration::from_millis(50)) else {
                continue;
            };
            made += 1;
            if made % 3 == 0 {
                // the other side may have closed it already
                let _ = stream.write_all(&[0x16, 3, 1, 0, made as u8]);
            }
            open.push_back(stream);
            if open.len() > 25 {
                open.pop_front();
            }
        }
    };
    std::thread::scope(|scope| (0..8).for_each(|_| drop(scope.spawn(some))));
}

/// Garbage in place of frames, a message that is too long, too many of them: only the one who sends it is sent away.
fn misbehave(address: SocketAddr) {
    for garbage in [&[0xff_u8; 64][..], &[0x81, 0xfe, 0xff, 0xff, 0, 0, 0, 0], &[0x01, 0x05, 1, 2, 3, 4, 5]] {
        let mut bad = client(address);
        bad.get_mut().write_all(garbage).expect("sent");
        let ended = (0..1000).any(|_| bad.read().map_or(true, |message| message.is_close()));
        assert!(ended, "{garbage:?}");
    }
    let mut large = client(address);
    // it may be closed while it still sends
    let _ = large.send(Message::text("x".repeat(100_000)));
    assert!((0..1000).any(|_| large.read().map_or(true, |message| message.is_close())));
    let mut chatty = client(address);
    for _ in 0..200 {
        let _ = chatty.send(Message::text("{}"));
    }
    assert!((0..1000).any(|_| chatty.read().map_or(true, |message| message.is_close())));
}

#[test]
fn ten_thousand_connections_and_garbage_change_nothing_for_others() {
    let (stage, quiet) = (stage(None), stage(None));
    let (stop, _, thread) = show([&stage, &quiet], 500);
    let mut good = Two { troubled: stage.client(), quiet: quiet.client() };
    good.watch_for(0.3);
    let address = stage.address();
    for trouble in [flood, misbehave] {
        let begun = Instant::now();
        let trouble = std::thread::spawn(move || trouble(address));
        let seen = good.watch(|| !trouble.is_finished());
        trouble.join().expect("no panic");
        println!("{:.1?} of trouble: {:?}; elsewhere {:?}", begun.elapsed(), seen[0], seen[1]);
        assert_prompt(seen, Duration::from_secs(1));
    }
    assert_untroubled(good.watch_for(1.0));
    stop.store(true, Ordering::Relaxed);
    thread.join().expect("no panic");
}

#[test]
fn there_are_so_many_places_and_no_more() {
    let stage = stage(None);
    let clients: Vec<WebSocket<TcpStream>> = (0..32).map(|_| stage.client()).collect();
    let url = format!("ws://{}/stream", stage.address());
    assert!(tungstenite::client(&url, connect(stage.address())).is_err());
    assert_eq!(stage.board.clients(), 32);
    drop(clients);
    let since = Instant::now();
    while stage.board.clients() > 0 && since.elapsed() < PATIENCE {
        std::thread::sleep(Duration::from_millis(10));
    }
    assert!(tungstenite::client(&url, connect(stage.address())).is_ok());
}
