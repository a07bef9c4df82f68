//! A simulated laboratory at a pseudo-terminal, recorded; killed, unplugged, named.

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use crate::run::Desk;

/// A laboratory and the name of its port.
pub struct Lab {
    child: Child,
    pub port: String,
}

impl Lab {
    pub fn start(args: &[&str]) -> Self {
        let mut command = Command::new(env!("CARGO_BIN_EXE_shisei"));
        command.args(["simulate", "lab"]).args(args).stdout(Stdio::piped()).stderr(Stdio::null());
        let mut child = command.spawn().expect("the laboratory");
        let mut line = String::new();
        BufReader::new(child.stdout.take().expect("piped")).read_line(&mut line).expect("the port's name");
        Lab { child, port: line.trim().to_owned() }
    }
}

impl Drop for Lab {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn unix_ns() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).expect("after 1970").as_nanos() as u64
}

/// Bytes in a recording, and when the last of them came.
fn raw(path: &Path) -> (Vec<u8>, u64) {
    let (mut bytes, mut last_ns) = (Vec::new(), 0);
    let file = std::fs::read(path).expect("the recording");
    shisei_hub::read::raw(&file, |_, time_ns, more| {
        bytes.extend_from_slice(more);
        last_ns = time_ns;
    })
    .expect("readable");
    (bytes, last_ns)
}

/// Twenty kills, five at a time, each at another moment.
#[test]
fn kill_9_costs_at_most_the_last_second() {
    let desk = Desk::new();
    for round in 0..4_u64 {
        std::thread::scope(|scope| {
            for k in 0..5_u64 {
                let path = desk.file(&format!("{round}-{k}.mcap"));
                scope.spawn(move || {
                    let lab = Lab::start(&["--for", "60", "--seed", &k.to_string()]);
                    let mut record = Command::new(env!("CARGO_BIN_EXE_shisei"))
                        .args(["record", &lab.port, "-o"])
                        .arg(&path)
                        .stderr(Stdio::null())
                        .spawn()
                        .expect("the recorder");
                    // Any moment between 1.5 and 3 s, from the clock's fraction.
                    let moment = unix_ns() / 1000 % 1_500_000;
                    std::thread::sleep(Duration::from_micros(1_500_000 + moment));
                    let killed_ns = unix_ns();
                    record.kill().expect("killed");
                    record.wait().expect("ended");
                    let (bytes, last_ns) = raw(&path);
                    let lost_s = killed_ns.saturating_sub(last_ns) as f64 * 1e-9;
                    assert!(lost_s <= 1.0, "{lost_s} s lost");
                    let (mut session, mut items) = (shisei_hub::Session::default(), Vec::new());
                    session.push(&bytes, &mut items);
                    // The first frame may be one that began before the recording.
                    assert!(session.counts().garbage <= 1 && session.counts().frames > 30);
                });
            }
        });
    }
}

#[test]
fn an_unplugged_port_is_said_and_what_was_recorded_is_there() {
    let desk = Desk::new();
    let lab = Lab::start(&["--for", "4"]);
    let ran = desk.run(&["record", &lab.port, "-o", "take.mcap", "--wait", "0.1", "--json"]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    assert!(ran.stderr.contains("the port is gone"), "{}", ran.stderr);
    let told: serde_json::Value = serde_json::from_str(&ran.stdout).expect("JSON");
    assert!(told["samples"].as_u64().is_some_and(|samples| samples > 300), "{told}");
    let (bytes, _) = raw(&desk.file("take.mcap"));
    assert!(bytes.len() > 10_000);
    // A recording is never overwritten unasked.
    let again = desk.run(&["record", "take.mcap", "-o", "take.mcap"]);
    assert_eq!(again.code, 2);
    assert!(again.stderr.contains("--force"), "{}", again.stderr);
}

#[test]
fn nodes_are_listed_and_named() {
    let desk = Desk::new();
    let lab = Lab::start(&["--for", "60"]);
    std::thread::sleep(Duration::from_millis(1500));
    let named = desk.run(&["devices", &lab.port, "--rename", "0=left", "--identify", "all"]);
    assert_eq!(named.code, 0, "{}", named.stderr);
    assert!(named.stdout.contains("left") && named.stdout.contains("node 1"), "{}", named.stdout);
    let wrong = desk.run(&["devices", &lab.port, "--identify", "5"]);
    assert_eq!(wrong.code, 1, "{}", wrong.stderr);
    let wrong = desk.run(&["devices", &lab.port, "--configure", "0=best,4,2000,8"]);
    assert_eq!(wrong.code, 2, "{}", wrong.stderr);
    let none = desk.run(&["devices", "no-such-port"]);
    assert_eq!(none.code, 2, "{}", none.stderr);
}

#[test]
fn a_file_of_bytes_is_recorded_like_a_port() {
    let desk = Desk::new();
    assert_eq!(desk.run(&["simulate", "lab", "-o", "bytes.bin", "--for", "8", "--reboot", "1:5"]).code, 0);
    let ran = desk.run(&["record", "bytes.bin", "-o", "take.mcap", "--lang", "ja"]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    assert!(ran.stderr.contains("サンプル"), "{}", ran.stderr);
    assert_eq!(raw(&desk.file("take.mcap")).0, std::fs::read(desk.file("bytes.bin")).expect("the bytes"));
    assert_eq!(desk.run(&["simulate", "lab", "--nodes", "7", "-o", "x"]).code, 2);
}
