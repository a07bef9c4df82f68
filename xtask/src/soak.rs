//! `cargo xtask soak live [MINUTES]`: the demonstration for a while, recorded; memory and load must stay as they were.

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::project::Project;
use crate::run::must;

/// The start is left out: bodies are found, buffers grow to their size.
const START: f64 = 0.4;
/// Growth that is none, kB.
const SLACK_KB: f64 = 4096.0;
/// From one look to the next.
const LOOK: Duration = Duration::from_millis(500);

/// Builds and watches.
pub fn command(project: &Project, words: &[&str]) -> Result<(), String> {
    let minutes: f64 = match words.first() {
        Some(word) => word.parse().map_err(|_| format!("`{word}` is no number of minutes"))?,
        None => 10.0,
    };
    must(project.cargo().args(["build", "--quiet", "--release", "-p", "shisei-cli"]))?;
    let remark = watch(&project.target().join("release/shisei"), (minutes * 60.0) as u64)?;
    println!("{remark}");
    Ok(())
}

/// Memory, kB, and processor time, ticks of 10 ms, of a process.
fn look(pid: u32) -> Option<(f64, f64)> {
    let status = std::fs::read_to_string(format!("/proc/{pid}/status")).ok()?;
    let line = status.lines().find(|line| line.starts_with("VmRSS:"))?;
    let kilobytes = line.split_whitespace().nth(1)?.parse().ok()?;
    let stat = std::fs::read_to_string(format!("/proc/{pid}/stat")).ok()?;
    // behind the name in brackets: the 12th and 13th fields are user and system time
    let fields: Vec<&str> = stat.rsplit(')').next()?.split_whitespace().collect();
    let ticks: f64 = fields.get(11)?.parse::<f64>().ok()? + fields.get(12)?.parse::<f64>().ok()?;
    Some((kilobytes, ticks))
}

/// Runs the demonstration for so many seconds. What was seen, or why it is not flat.
pub fn watch(shisei: &Path, seconds: u64) -> Result<String, String> {
    let take = std::env::temp_dir().join(format!("shisei-soak-{}.mcap", std::process::id()));
    let outcome = watch_recording(shisei, seconds, &take);
    // it may not have begun
    let _ = std::fs::remove_file(&take);
    outcome
}

fn watch_recording(shisei: &Path, seconds: u64, take: &Path) -> Result<String, String> {
    let mut child = Command::new(shisei)
        .args(["live", "--demo", "--listen", "127.0.0.1:0", "--osc", "127.0.0.1:9"])
        .args(["--natnet-out", "127.0.0.1:0:0", "--for", &seconds.to_string(), "--record"])
        .arg(take)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .map_err(|error| format!("{}: {error}", shisei.display()))?;
    let started = Instant::now();
    let mut looks = Vec::new();
    while let Ok(None) = child.try_wait() {
        if let Some((kilobytes, ticks)) = look(child.id()) {
            looks.push((started.elapsed().as_secs_f64(), kilobytes, ticks));
        }
        std::thread::sleep(LOOK);
    }
    let ended = child.wait().map_err(|error| error.to_string())?;
    if !ended.success() {
        return Err(format!("it ended with {ended}"));
    }
    if looks.is_empty() {
        return Ok("this system does not tell a process's memory".into());
    }
    let from = looks.partition_point(|look| look.0 < START * seconds as f64);
    let steady = looks.get(from..).filter(|steady| steady.len() >= 8).ok_or("too short a time")?;
    let (early, late) = steady.split_at(steady.len() / 2);
    let most = |half: &[(f64, f64, f64)]| half.iter().map(|look| look.1).fold(0.0, f64::max);
    let load = |half: &[(f64, f64, f64)]| match (half.first(), half.last()) {
        (Some(first), Some(last)) => (last.2 - first.2) / (last.0 - first.0),
        _ => 0.0,
    };
    let remark = format!(
        "{seconds} s: memory at most {:.1} then {:.1} MB, load {:.1} then {:.1} % of a processor",
        most(early) / 1024.0,
        most(late) / 1024.0,
        load(early),
        load(late)
    );
    let grows = most(late) > most(early) + SLACK_KB.max(0.05 * most(early));
    let slower = load(late) > 1.5 * load(early) + 5.0;
    if grows || slower { Err(format!("not flat: {remark}")) } else { Ok(remark) }
}
