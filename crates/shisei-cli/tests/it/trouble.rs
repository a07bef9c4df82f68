//! What goes wrong while a receiver is recorded: a full disk, a recorder that is killed, a port that is unplugged and
//! comes back, garbage on it. It is said, what was recorded is there, and nothing earlier is touched.

use std::fs::File;
use std::io::{Read, Write};
use std::os::fd::AsFd;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use rustix::io::{ioctl_fionbio, ioctl_fionread};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{OptionalActions, tcgetattr, tcsetattr};
use serde_json::Value;

use crate::live::{Lab, raw};
use crate::run::Desk;

/// Half a minute of two nodes, as the receiver sends it.
fn bytes_of_a_lab(desk: &Desk, name: &str) -> Vec<u8> {
    let ran = desk.run(&["simulate", "lab", "--for", "30", "-o", name]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    std::fs::read(desk.file(name)).expect("the bytes")
}

/// How many samples of node 0 `shisei info` finds.
fn samples_of_node_0(desk: &Desk, name: &str) -> u64 {
    let ran = desk.run(&["info", name, "--sensor", "0", "--json"]);
    assert_eq!(ran.code, 0, "{name}: {}", ran.stderr);
    let told: Value = serde_json::from_str(&ran.stdout).expect("JSON");
    told["recordings"][0]["samples"].as_u64().or_else(|| told["samples"].as_u64()).expect("a count")
}

/// A file size limit says no in the middle of a write, as a full disk does.
#[test]
fn a_full_disk_ends_the_recording_and_keeps_what_is_there() {
    let desk = Desk::new();
    let bytes = bytes_of_a_lab(&desk, "lab.bin");
    assert_eq!(desk.run(&["record", "lab.bin", "-o", "earlier.mcap"]).code, 0);
    let earlier = std::fs::read(desk.file("earlier.mcap")).expect("the earlier recording");
    for (lang, words) in [
        ("en", ["recording ended here", "what was recorded before is kept"]),
        ("ja", ["記録はここで終了しました", "それまでの記録は残っています"]),
    ] {
        // 2048 blocks of 512 bytes; without the signal that would end the program before it can say anything
        let limited =
            "trap '' XFSZ; ulimit -f 2048; exec \"$0\" record lab.bin -o full.mcap --force --lang \"$1\"";
        let program = env!("CARGO_BIN_EXE_shisei");
        let ran = Command::new("sh").args(["-c", limited, program, lang]).current_dir(desk.path()).output();
        let ran = ran.expect("a shell");
        let said = String::from_utf8_lossy(&ran.stderr);
        assert_eq!(ran.status.code(), Some(2), "{said}");
        assert!(said.contains("full.mcap") && words.iter().all(|word| said.contains(word)), "{said}");
        // what is there is whole and begins as the port did
        let kept = raw(&desk.file("full.mcap"));
        assert!(kept.len() > 30_000 && bytes.starts_with(&kept), "{} bytes", kept.len());
        assert!(samples_of_node_0(&desk, "full.mcap") > 300);
        assert_eq!(std::fs::read(desk.file("earlier.mcap")).expect("still there"), earlier);
    }
}

/// No disk at all to write to, from the first byte.
#[cfg(target_os = "linux")]
#[test]
fn a_disk_that_is_full_from_the_start_is_said() {
    let desk = Desk::new();
    bytes_of_a_lab(&desk, "lab.bin");
    for (lang, word) in [("en", "ended here"), ("ja", "終了しました")] {
        let ran = desk.run(&["record", "lab.bin", "-o", "/dev/full", "--force", "--lang", lang]);
        assert!(ran.code == 2 && ran.stderr.contains(word), "{} {}", ran.code, ran.stderr);
        let nowhere = desk.run(&["record", "lab.bin", "-o", "absent/take.mcap", "--lang", lang]);
        assert!(nowhere.code == 2 && nowhere.stderr.contains("-o"), "{} {}", nowhere.code, nowhere.stderr);
    }
}

fn record(desk: &Desk, args: &[&str]) -> Child {
    let mut command = Command::new(env!("CARGO_BIN_EXE_shisei"));
    command.arg("record").args(args).current_dir(desk.path()).env("LC_ALL", "C.UTF-8");
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the recorder")
}

#[test]
fn a_port_that_is_unplugged_and_comes_back_is_recorded_on() {
    std::thread::scope(|scope| {
        for (lang, gone, back) in [
            ("en", "the port is gone", "the port is back"),
            ("ja", "ポートが切断されました", "ポートが復帰しました"),
        ] {
            scope.spawn(move || {
                let desk = Desk::new();
                let link = desk.file("port");
                let plug = |lab: &Lab| std::os::unix::fs::symlink(&lab.port, &link).expect("a link");
                let lab = Lab::start(&["--seed", "3"]);
                plug(&lab);
                let recorder = record(
                    &desk,
                    &["port", "-o", "take.mcap", "--for", "9", "--wait", "8", "--lang", lang, "--json"],
                );
                std::thread::sleep(Duration::from_secs(3));
                std::fs::remove_file(&link).expect("unplugged");
                drop(lab);
                std::thread::sleep(Duration::from_secs(1));
                let lab = Lab::start(&["--seed", "4"]);
                plug(&lab);
                let ran = recorder.wait_with_output().expect("the recorder's end");
                let said = String::from_utf8_lossy(&ran.stderr);
                assert_eq!(ran.status.code(), Some(0), "{said}");
                let (gone, back) = (said.find(gone).expect("the loss"), said.find(back).expect("the return"));
                assert!(gone < back, "{said}");
                let told: Value = serde_json::from_slice(&ran.stdout).expect("JSON");
                assert_eq!(told["interruptions"], 1);
                // samples of both receivers, and the file is an ordinary recording
                let bytes = raw(&desk.file("take.mcap"));
                let (mut session, mut items) = (shisei_hub::Session::default(), Vec::new());
                session.push(&bytes, &mut items);
                let changed = |item: &shisei_hub::Item| matches!(item, shisei_hub::Item::ReceiverRebooted(_));
                assert_eq!(items.iter().filter(|item| changed(item)).count(), 1);
                assert!(samples_of_node_0(&desk, "take.mcap") > 400);
            });
        }
    });
}

/// A port of our own, which says what a test wants.
struct Line {
    owner: File,
    user: File,
    name: String,
}

impl Line {
    fn open() -> Self {
        let owner = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY).expect("a pseudo-terminal");
        grantpt(&owner).and_then(|()| unlockpt(&owner)).expect("a pseudo-terminal");
        let name = ptsname(&owner, Vec::new()).expect("its name").to_string_lossy().into_owned();
        let user = File::options().read(true).write(true).open(&name).expect("its other side");
        let mut modes = tcgetattr(user.as_fd()).expect("its modes");
        modes.make_raw();
        tcsetattr(user.as_fd(), OptionalActions::Now, &modes).expect("its modes");
        Line { owner: owner.into(), user, name }
    }

    fn say(&mut self, bytes: &[u8]) {
        for part in bytes.chunks(1024) {
            self.owner.write_all(part).expect("written");
            std::thread::sleep(Duration::from_millis(2));
        }
    }

    /// How much of what was said nobody has read; nothing can read the line after this.
    fn unread(mut self) -> usize {
        // no frame holds so many zeros
        let mark = [0; 64];
        self.owner.write_all(&mark).expect("written");
        let mut rest = Vec::new();
        while !rest.ends_with(&mark) {
            let mut more = [0; 4096];
            let count = self.user.read(&mut more).expect("what was written");
            rest.extend_from_slice(&more[..count]);
        }
        rest.len() - mark.len()
    }
}

/// Waits until something is so.
fn until(what: &str, so: impl Fn() -> bool) {
    let begun = Instant::now();
    while !so() {
        assert!(begun.elapsed() < Duration::from_secs(60), "{what} did not come");
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Twenty kills, five at a time, each at another moment.
#[test]
fn kill_9_costs_at_most_the_last_second() {
    let desk = Desk::new();
    let bytes = bytes_of_a_lab(&desk, "lab.bin");
    for round in 0..4 {
        std::thread::scope(|scope| {
            for k in 0..5 {
                let (desk, bytes) = (&desk, &bytes);
                scope.spawn(move || killed(desk, &format!("{round}-{k}.mcap"), bytes));
            }
        });
    }
}

/// Sends half a minute of bytes as fast as a receiver does, and kills the recorder after some of it.
fn killed(desk: &Desk, name: &str, bytes: &[u8]) {
    let (second, take) = (bytes.len() / 30, desk.file(name));
    let mut line = Line::open();
    let mut recorder = record(desk, &[&line.name, "-o", name]);
    // the port is open then
    until("the recording", || take.exists());
    ioctl_fionbio(&line.owner, true).expect("a line that does not block");
    // any moment between 1.5 and 3 s, from the clock's fraction
    let fraction = std::time::UNIX_EPOCH.elapsed().expect("after 1970").subsec_micros() as usize;
    let end = second * 3 / 2 * (1_000_000 + fraction) / 1_000_000;
    let mut sent = 0;
    while sent < end {
        // where this machine falls behind the receiver waits, so that no second is longer than one
        if ioctl_fionread(&line.user).expect("what waits") < second as u64 / 10 {
            sent += line.owner.write(&bytes[sent..sent + second / 100]).unwrap_or(0);
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    recorder.kill().expect("killed");
    recorder.wait().expect("ended");
    let (recorded, taken) = (raw(&take), sent - line.unread());
    assert!(bytes.starts_with(&recorded), "{name}: not what was sent");
    let lost_s = (taken - recorded.len()) as f64 / second as f64;
    assert!(lost_s <= 1.0, "{name}: {lost_s} s lost");
    let (mut session, mut items) = (shisei_hub::Session::default(), Vec::new());
    session.push(&recorded, &mut items);
    assert!(session.counts().garbage == 0 && session.counts().frames > 30);
}

/// A port that is no receiver's: said while it happens, and at the end, in both languages.
#[test]
fn garbage_alone_is_said() {
    std::thread::scope(|scope| {
        for (lang, meanwhile, end) in [
            ("en", "nothing readable comes", "nothing readable came"),
            ("ja", "読めるデータが来ません", "読めるデータが届きませんでした"),
        ] {
            scope.spawn(move || {
                let desk = Desk::new();
                let mut line = Line::open();
                let recorder = record(&desk, &[&line.name, "-o", "take.mcap", "--for", "4", "--lang", lang]);
                let begun = Instant::now();
                let mut random = shisei_twin::Random::new(8, 8);
                let mut sent = 0;
                while begun.elapsed() < Duration::from_millis(3_600) {
                    let garbage: Vec<u8> = (0..200).map(|_| (random.uniform() * 256.0) as u8).collect();
                    line.say(&garbage);
                    sent += garbage.len();
                    std::thread::sleep(Duration::from_millis(20));
                }
                let ran = recorder.wait_with_output().expect("the recorder's end");
                let said = String::from_utf8_lossy(&ran.stderr);
                assert_eq!(ran.status.code(), Some(1), "{said}");
                assert!(said.contains(meanwhile) && said.contains(end), "{said}");
                // what came is there all the same, but for what was sent before the port was opened
                assert!(raw(&desk.file("take.mcap")).len() + 20_000 > sent);
                let info = desk.run(&["info", "take.mcap", "--lang", lang]);
                assert!(info.code == 2 && info.stderr.contains("sensor_msgs/msg/Imu"), "{}", info.stderr);
            });
        }
    });
}

/// Garbage between what a receiver says costs what it hits and is counted.
#[test]
fn garbage_among_data_is_counted_and_the_rest_is_there() {
    let desk = Desk::new();
    let good = bytes_of_a_lab(&desk, "lab.bin");
    let mut line = Line::open();
    let recorder = record(&desk, &[&line.name, "-o", "take.mcap", "--for", "5", "--json"]);
    until("the recording", || desk.file("take.mcap").exists());
    let garbage: Vec<u8> = (0..3_000_u32).map(|k| (k * 37 % 251) as u8 + 1).collect();
    line.say(&garbage);
    line.say(&[0]);
    line.say(&good[..200_000]);
    line.say(&garbage);
    line.say(&good[200_000..]);
    let ran = recorder.wait_with_output().expect("the recorder's end");
    assert_eq!(ran.status.code(), Some(0), "{}", String::from_utf8_lossy(&ran.stderr));
    let told: Value = serde_json::from_slice(&ran.stdout).expect("JSON");
    let unreadable = told["unreadable_frames"].as_u64().expect("a count");
    assert!((1..10).contains(&unreadable), "{told}");
    let samples = told["samples"].as_u64().expect("a count");
    assert!(samples > 6_500, "{told}");
    assert!(samples_of_node_0(&desk, "take.mcap") > 3_200);
    assert_eq!(raw(&desk.file("take.mcap")).len(), 2 * garbage.len() + 1 + good.len());
    assert!(Path::new(&line.name).exists());
}
