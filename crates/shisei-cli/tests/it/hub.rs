//! `shisei live` as a user meets it: the demonstration, recorded, killed, played again.

use std::io::{BufRead, BufReader, ErrorKind};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;
use tungstenite::{Message, WebSocket};

use crate::run::Desk;

const PATIENCE: Duration = Duration::from_secs(120);

struct Live {
    child: Child,
    address: String,
}

impl Live {
    fn start(folder: &Path, args: &[&str]) -> Self {
        let mut command = Command::new(env!("CARGO_BIN_EXE_shisei"));
        command.arg("live").args(args).args(["--listen", "127.0.0.1:0"]).current_dir(folder);
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().expect("shisei live");
        let mut line = String::new();
        BufReader::new(child.stdout.take().expect("piped")).read_line(&mut line).expect("the address");
        let address = line.trim().trim_start_matches("http://").trim_end_matches('/').to_owned();
        Live { child, address }
    }

    fn client(&self) -> WebSocket<TcpStream> {
        let stream = TcpStream::connect(&self.address).expect("the server");
        stream.set_read_timeout(Some(PATIENCE)).expect("a timeout");
        tungstenite::client(format!("ws://{}/stream", self.address), stream).expect("a stream").0
    }
}

impl Drop for Live {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn read(client: &mut WebSocket<TcpStream>) -> Value {
    let interrupted = |error: &tungstenite::Error| matches!(error, tungstenite::Error::Io(io) if io.kind() == ErrorKind::Interrupted);
    loop {
        match client.read() {
            Ok(message) => return serde_json::from_str(message.to_text().expect("text")).expect("JSON"),
            // a signal for another test of this process
            Err(error) if interrupted(&error) => {}
            Err(error) => panic!("no message: {error}"),
        }
    }
}

/// Reads until a message is as wanted.
fn until(client: &mut WebSocket<TcpStream>, what: &str, mut wanted: impl FnMut(&Value) -> bool) -> Value {
    let started = Instant::now();
    loop {
        let message = read(client);
        if wanted(&message) {
            return message;
        }
        assert!(started.elapsed() < PATIENCE, "{what} did not come");
    }
}

/// Sources of all bodies in a message of poses.
fn sources(message: &Value) -> Vec<i64> {
    let poses = message["poses"].as_array().into_iter().flatten();
    poses.filter_map(|pose| pose[8].as_i64()).collect()
}

#[test]
fn the_demonstration_is_shown_recorded_killed_and_played_again() {
    let desk = Desk::new();
    let folder = desk.path().to_owned();
    let mut live = Live::start(&folder, &["--demo"]);
    let mut client = live.client();
    let hello = read(&mut client);
    assert_eq!((hello["type"].as_str(), hello["protocol"].as_i64()), (Some("hello"), Some(1)));
    client.send(Message::text(r#"{"type":"record","on":true}"#)).expect("sent");
    until(&mut client, "the note of the recording", |m| {
        m["type"] == "note" && m["ja"].as_str().is_some_and(|ja| ja.contains("shisei-live.mcap"))
    });
    // sensors find their bodies, and a body that is hidden goes on from its sensor
    let scene = until(&mut client, "a scene with sensors on bodies", |m| {
        m["type"] == "scene"
            && m["bodies"]
                .as_array()
                .is_some_and(|all| all.iter().filter(|b| b["node"].is_string()).count() == 3)
    });
    let bodies = scene["bodies"].as_array().expect("bodies");
    let kind = |kind: &str| bodies.iter().filter(|body| body["kind"] == kind).count();
    assert_eq!((kind("body"), kind("bone"), kind("node")), (3, 11, 1));
    let poses = until(&mut client, "a bridged body", |m| sources(m).contains(&2));
    assert!(poses["frame"].is_number() && !poses["markers"].as_array().expect("markers").is_empty());
    let bridged = poses["poses"].as_array().into_iter().flatten().find(|pose| pose[8] == 2).expect("bridged");
    assert!(bridged[9].as_f64() > Some(0.0) && bridged[10].is_number() && bridged[11].is_number());
    let status = until(&mut client, "a status", |m| m["type"] == "status" && m["recording"].is_object());
    println!("latency {}", status["latency_ms"]);
    assert_eq!(status["nodes"].as_array().map(Vec::len), Some(4));
    assert_eq!(status["inputs"][0]["lost"], 0);

    // a body is recorded once more when it is known what came next
    let file = folder.join("shisei-live.mcap");
    let (topic, asked) = (b"/smoothed/", Instant::now());
    while !std::fs::read(&file).expect("the recording").windows(topic.len()).any(|bytes| bytes == topic) {
        assert!(asked.elapsed() < PATIENCE, "nothing was smoothed");
        std::thread::sleep(Duration::from_millis(300));
    }

    // killed in the middle: what was recorded can be read, decoded anew and played
    live.child.kill().expect("killed");
    let bytes = std::fs::read(&file).expect("the recording");
    let mut ports = std::collections::BTreeMap::new();
    shisei_hub::read::raw(&bytes, |port, _, part| *ports.entry(port.to_owned()).or_insert(0) += part.len())
        .expect("readable");
    assert_eq!(ports.keys().collect::<Vec<_>>(), ["demo-motive", "demo-receiver"]);
    let played = Live::start(&folder, &["--replay", "shisei-live.mcap", "--speed", "2"]);
    let mut client = played.client();
    until(&mut client, "a bone of the recording", |m| {
        m["type"] == "scene"
            && m["bodies"].as_array().is_some_and(|all| all.iter().any(|b| b["kind"] == "bone"))
    });
    until(&mut client, "a body of the recording", |m| sources(m).contains(&1));
}

/// A receiver that is unplugged and comes back; and a client that goes and comes back.
#[cfg(unix)]
#[test]
fn parts_that_go_come_back_by_themselves() {
    let desk = Desk::new();
    let link = desk.path().join("port");
    let plug = |lab: &crate::live::Lab| {
        let _ = std::fs::remove_file(&link);
        std::os::unix::fs::symlink(&lab.port, &link).expect("a link");
    };
    let lab = crate::live::Lab::start(&["--seed", "3"]);
    plug(&lab);
    let live =
        Live::start(desk.path(), &["--serial", link.to_str().expect("UTF-8"), "--record", "take.mcap"]);
    let state = |m: &Value| m["inputs"][0]["state"].as_str().map(str::to_owned);
    let mut client = live.client();
    until(&mut client, "both nodes", |m| m["type"] == "poses" && sources(m) == [3, 3]);
    drop(lab);
    until(&mut client, "the loss", |m| m["type"] == "status" && state(m).as_deref() == Some("lost"));
    until(&mut client, "nodes that have vanished", |m| m["type"] == "poses" && sources(m) == [0, 0]);
    drop(client);
    let lab = crate::live::Lab::start(&["--seed", "4"]);
    plug(&lab);
    let mut client = live.client();
    until(&mut client, "the return", |m| m["type"] == "status" && state(m).as_deref() == Some("connected"));
    until(&mut client, "both nodes again", |m| m["type"] == "poses" && sources(m) == [3, 3]);
    let recording = std::fs::read(desk.path().join("take.mcap")).expect("the recording");
    let mut bytes = 0;
    shisei_hub::read::raw(&recording, |_, _, part| bytes += part.len()).expect("readable");
    assert!(bytes > 4_000, "{bytes}");
}

/// A name that is set in the viewer is in the node: it is there when the program is started anew.
#[cfg(unix)]
#[test]
fn a_name_given_in_the_viewer_is_kept_by_the_node() {
    let desk = Desk::new();
    let lab = crate::live::Lab::start(&["--seed", "5"]);
    let names = |m: &Value| -> Vec<String> {
        let nodes = m["nodes"].as_array().into_iter().flatten();
        nodes.filter_map(|node| node["name"].as_str().map(str::to_owned)).collect()
    };
    let both = |m: &Value| m["type"] == "status" && names(m).len() == 2;
    let live = Live::start(desk.path(), &["--serial", &lab.port]);
    let mut client = live.client();
    let before = names(&until(&mut client, "both nodes", both));
    let rename = |client: &mut WebSocket<TcpStream>, name: &str| {
        // what it is called now, as the newest status says
        let now = names(&until(client, "both nodes", both));
        let message = serde_json::json!({"type": "name", "node": now[0], "name": name});
        client.send(Message::text(message.to_string())).expect("sent");
    };
    rename(&mut client, "左手");
    until(&mut client, "the node's answer", |m| {
        m["type"] == "note" && m["level"] == "info" && m["ja"].as_str().is_some_and(|ja| ja.contains("左手"))
    });
    // a name that a node cannot keep is one here, and that is said
    rename(&mut client, "a name of more than twenty bytes");
    until(&mut client, "the note", |m| {
        m["type"] == "note" && m["level"] == "warning" && m["en"].as_str().is_some_and(|en| en.contains("20"))
    });
    until(&mut client, "the name here", |m| {
        m["type"] == "status" && names(m).contains(&"a name of more than twenty bytes".to_owned())
    });
    drop((client, live));
    let live = Live::start(desk.path(), &["--serial", &lab.port]);
    let now = names(&until(&mut live.client(), "the node's name", |m| {
        m["type"] == "status" && names(m).contains(&"左手".to_owned())
    }));
    assert!(!now.contains(&before[0]) && now.contains(&before[1]), "{before:?} {now:?}");
}

#[test]
fn what_cannot_be_is_said() {
    let desk = Desk::new();
    for (args, word) in [
        (&["live"][..], "--demo"),
        (&["live", "--demo", "--listen", "nowhere"], "--listen"),
        (&["live", "--demo", "--speed=-1"], "--speed"),
        (&["live", "--demo", "--lag", "0.2"], "--lag"),
        (&["live", "--replay", "absent.mcap"], "absent.mcap"),
        (&["live", "--demo", "--natnet-out", "127.0.0.1:1"], "--natnet-out"),
        (&["live", "--demo", "--natnet-multicast"], "--natnet-out"),
        (
            &["live", "--demo", "--natnet-out", "127.0.0.1:0:1511", "--natnet-multicast", "192.0.2.1"],
            "--natnet-multicast",
        ),
        (&["live", "--demo", "--pair", "x"], "--pair"),
        (&["live", "--demo", "--alignment", "absent.json"], "absent.json: "),
    ] {
        let output = Command::new(env!("CARGO_BIN_EXE_shisei"))
            .args(args)
            .current_dir(desk.path())
            .output()
            .expect("shisei");
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{args:?}: {said}");
        assert!(said.contains(word), "{args:?}: {said}");
    }
}

/// What was asked for and cannot be done is said where it was asked, in both languages.
#[test]
fn a_recording_that_cannot_be_made_and_a_port_that_is_not_there_are_said() {
    let desk = Desk::new();
    let listen = ["--listen", "127.0.0.1:0"];
    let record = ["live", "--demo", "--for", "20", "--record", "no-such-folder/take.mcap"];
    let ran = desk.run(&[&record[..], &listen].concat());
    assert_eq!((ran.code, ran.stdout.as_str()), (2, ""), "{}", ran.stderr);
    assert!(ran.stderr.contains("take.mcap could not be written"), "{}", ran.stderr);
    let ran = desk.run(&[&record[..], &listen, &["--lang", "ja"]].concat());
    assert!(ran.code == 2 && ran.stderr.contains("書き込めませんでした"), "{}", ran.stderr);

    std::fs::write(desk.file("other.mcap"), b"no recording").expect("a file");
    let replay = ["live", "--replay", "other.mcap"];
    let ran = desk.run(&[&replay[..], &listen].concat());
    assert!(ran.code == 2 && ran.stderr.contains("other.mcap: there are no bytes"), "{}", ran.stderr);
    let ran = desk.run(&[&replay[..], &listen, &["--lang", "ja"]].concat());
    assert!(ran.code == 2 && ran.stderr.contains("先頭が破損"), "{}", ran.stderr);

    for (from, out) in [("127.0.0.1:1520", "127.0.0.1:1520:1521"), ("127.0.0.1", "127.0.0.1")] {
        let ran =
            desk.run(&[&["live", "--natnet", from, "--natnet-out", out, "--for", "1"][..], &listen].concat());
        assert!(ran.code == 2 && ran.stderr.contains("gives out itself"), "{}", ran.stderr);
    }

    let serial = ["live", "--serial", "no-such-port", "--for", "1"];
    let ran = desk.run(&[&serial[..], &listen].concat());
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    assert_eq!(ran.stderr.matches("no-such-port: ").count(), 1, "{}", ran.stderr);
    let ran = desk.run(&[&serial[..], &listen, &["--lang", "ja"]].concat());
    assert!(ran.stderr.contains("no-such-port：") && ran.stderr.contains("待ちます"), "{}", ran.stderr);
}
