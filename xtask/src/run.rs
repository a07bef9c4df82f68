//! Running the steps of a suite and counting them.

use std::io::{BufRead, BufReader, Read, Write};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::project::Project;
use crate::tally::{self, Tally};

/// One suite under way.
#[derive(Debug)]
pub struct Run<'a> {
    pub project: &'a Project,
    pub tally: Tally,
    /// One line for everything that failed or was skipped.
    pub notes: Vec<String>,
}

impl<'a> Run<'a> {
    pub fn new(project: &'a Project) -> Self {
        Run { project, tally: Tally::default(), notes: Vec::new() }
    }

    /// One check of our own: passes with an optional remark, or fails with its reason.
    pub fn check(&mut self, name: &str, result: Result<String, String>) -> bool {
        match result {
            Ok(remark) if remark.is_empty() => println!("ok      {name}"),
            Ok(remark) => println!("ok      {name}: {remark}"),
            Err(reason) => {
                self.fail(name, &reason);
                return false;
            }
        }
        self.tally.passed += 1;
        true
    }

    /// A check that failed.
    pub fn fail(&mut self, name: &str, reason: &str) {
        println!("FAILED  {name}: {reason}");
        self.tally.failed += 1;
        self.notes.push(format!("FAILED  {name}"));
    }

    /// A check that could not run for a reason that is no package's absence.
    pub fn skip(&mut self, name: &str, reason: &str) {
        println!("skipped: {name}: {reason}");
        self.tally.skipped += 1;
        self.notes.push(format!("skipped {name}: {reason}"));
    }

    /// One check that is a command: passes when it ends with 0. Its output goes through.
    pub fn step(&mut self, name: &str, command: &mut Command) -> bool {
        heading(name);
        let started = Instant::now();
        let result = match command.stdin(Stdio::null()).status() {
            Ok(status) if status.success() => Ok(seconds(started)),
            Ok(status) => Err(format!("{} ended with {status}", show(command))),
            Err(error) => Err(format!("{} did not start: {error}", show(command))),
        };
        self.check(name, result)
    }

    /// `cargo test …`: counts the tests it ran. `command` must not have a `--` yet.
    pub fn cargo_test(&mut self, name: &str, command: &mut Command) {
        heading(name);
        let started = Instant::now();
        // A passing test's output is shown so that its "skipped: …" is not swallowed.
        command.args(["--no-fail-fast", "--", "--show-output"]);
        let mut filter = CargoFilter::default();
        let status = stream(command, |line| {
            if filter.shows(line) {
                println!("{line}");
            }
        });
        let counted = filter.settle();
        self.tally.add(counted);
        self.notes.extend(filter.skips.into_iter().map(|line| format!("skipped {line}")));
        match status {
            Ok(true) if counted.ran() == 0 => self.fail(name, "it ran no test"),
            Ok(true) => println!("ok      {name}: {counted}, {}", seconds(started)),
            Ok(false) if counted.failed > 0 => self.notes.push(format!("FAILED  {name}: {counted}")),
            Ok(false) => self.fail(name, "it did not compile or ended early"),
            Err(reason) => self.fail(name, &reason),
        }
    }

    /// Another runner (pytest, node --test) whose closing lines `read` understands.
    pub fn tests(&mut self, name: &str, command: &mut Command, read: fn(&str) -> Option<Tally>) {
        heading(name);
        let mut output = String::new();
        let status = stream(command, |line| {
            println!("{line}");
            output.push_str(line);
            output.push('\n');
        });
        let counted = read(&output).unwrap_or_default();
        self.tally.add(counted);
        match status {
            Ok(true) if counted.ran() == 0 => self.fail(name, "it ran no test"),
            Ok(true) => println!("ok      {name}: {counted}"),
            Ok(false) if counted.failed > 0 => self.notes.push(format!("FAILED  {name}: {counted}")),
            Ok(false) => self.fail(name, "the runner ended with an error"),
            Err(reason) => self.fail(name, &reason),
        }
    }
}

/// Standard output of a command that must end with 0; standard error goes through.
pub fn output_of(command: &mut Command) -> Result<String, String> {
    let output = command
        .stdin(Stdio::null())
        .stderr(Stdio::inherit())
        .output()
        .map_err(|error| format!("{} did not start: {error}", show(command)))?;
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    if output.status.success() {
        Ok(text)
    } else {
        Err(format!("{} ended with {}\n{text}", show(command), output.status))
    }
}

/// As [`output_of`], but the command is ended when it takes longer than `limit`.
pub fn output_within(command: &mut Command, limit: Duration) -> Result<String, String> {
    let started = Instant::now();
    let mut child = command
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .spawn()
        .map_err(|error| format!("{} did not start: {error}", show(command)))?;
    let mut stdout = child.stdout.take().ok_or("no standard output")?;
    let reader = std::thread::spawn(move || {
        let mut bytes = Vec::new();
        // What came before an error is still worth showing.
        let _ = stdout.read_to_end(&mut bytes);
        String::from_utf8_lossy(&bytes).into_owned()
    });
    let status = loop {
        if let Some(status) = child.try_wait().map_err(|error| error.to_string())? {
            break Some(status);
        }
        if started.elapsed() > limit {
            child.kill().and_then(|()| child.wait()).map_err(|error| error.to_string())?;
            break None;
        }
        std::thread::sleep(Duration::from_millis(20));
    };
    let text = reader.join().unwrap_or_default();
    match status {
        Some(status) if status.success() => Ok(text),
        Some(status) => Err(format!("{} ended with {status}\n{text}", show(command))),
        None => Err(format!("{} took longer than {} s\n{text}", show(command), limit.as_secs())),
    }
}

/// Runs a command that must end with 0; its output goes through.
pub fn must(command: &mut Command) -> Result<(), String> {
    match command.stdin(Stdio::null()).status() {
        Ok(status) if status.success() => Ok(()),
        Ok(status) => Err(format!("{} ended with {status}", show(command))),
        Err(error) => Err(format!("{} did not start: {error}", show(command))),
    }
}

/// As [`must`], but its output is shown only if it fails.
pub fn quietly(command: &mut Command) -> Result<(), String> {
    let output = command
        .stdin(Stdio::null())
        .output()
        .map_err(|error| format!("{} did not start: {error}", show(command)))?;
    if output.status.success() {
        return Ok(());
    }
    let [stdout, stderr] = [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text));
    Err(format!("{} ended with {}\n{stdout}{stderr}", show(command), output.status))
}

/// Runs a command, hands over each line of standard output as it comes; true when it ended with 0.
fn stream(command: &mut Command, mut line: impl FnMut(&str)) -> Result<bool, String> {
    let mut child = command
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .spawn()
        .map_err(|error| format!("{} did not start: {error}", show(command)))?;
    if let Some(stdout) = child.stdout.take() {
        let mut reader = BufReader::new(stdout);
        let mut bytes = Vec::new();
        while reader.by_ref().read_until(b'\n', &mut bytes).map_err(|error| error.to_string())? > 0 {
            line(String::from_utf8_lossy(&bytes).trim_end_matches(['\n', '\r']));
            bytes.clear();
        }
    }
    Ok(child.wait().map_err(|error| error.to_string())?.success())
}

/// The command as one would type it.
pub fn show(command: &Command) -> String {
    let words = std::iter::once(command.get_program()).chain(command.get_args());
    words.map(|word| word.to_string_lossy()).collect::<Vec<_>>().join(" ")
}

pub fn seconds(started: Instant) -> String {
    format!("{:.1} s", started.elapsed().as_secs_f64())
}

pub fn heading(name: &str) {
    println!("\n--- {name}");
    // A lost line of decoration is no reason to stop.
    let _ = std::io::stdout().flush();
}

/// Reads `cargo test -- --show-output`: what to show and what to count.
#[derive(Debug, Default)]
struct CargoFilter {
    tally: Tally,
    skips: Vec<String>,
    /// Inside the output of tests that passed.
    successes: bool,
}

impl CargoFilter {
    fn shows(&mut self, line: &str) -> bool {
        match line {
            "successes:" => self.successes = true,
            "failures:" => self.successes = false,
            _ => {}
        }
        if let Some(counted) = tally::cargo_line(line) {
            self.successes = false;
            self.tally.add(counted);
            if tally::is_skip(line) {
                self.successes = true;
                self.skips.push(line.trim_start().trim_start_matches("skipped: ").to_owned());
            }
            return counted.ran() + counted.skipped > 0;
        }
        let noise = line.is_empty() || line.starts_with("running ") || line.ends_with(" ... ok");
        !self.successes && !noise
    }

    /// A test that skipped itself was counted as passed by libtest.
    fn settle(&self) -> Tally {
        let Tally { passed, failed, skipped } = self.tally;
        Tally { passed: passed.saturating_sub(self.skips.len()), failed, skipped }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_test_that_skips_itself_is_not_counted_as_passed() {
        let output = "running 3 tests\ntest a ... ok\ntest b ... ok\ntest c ... ok\n\nsuccesses:\n\n\
            ---- b stdout ----\nskipped: no recordings\nnoise\n\nsuccesses:\n    a\n    b\n    c\n\n\
            test result: ok. 3 passed; 0 failed; 0 ignored; 0 measured; 0 filtered out";
        let mut filter = CargoFilter::default();
        let shown: Vec<&str> = output.lines().filter(|line| filter.shows(line)).collect();
        assert_eq!(filter.settle(), Tally { passed: 2, failed: 0, skipped: 1 });
        assert_eq!(shown.len(), 2, "{shown:?}");
        assert!(shown[0].starts_with("skipped: ") && shown[1].starts_with("test result: "));
    }

    #[test]
    fn failures_are_shown_in_full() {
        let output = "running 2 tests\ntest a ... FAILED\ntest b ... ok\n\nsuccesses:\n\n---- b stdout ----\nnoise\n\
            \nsuccesses:\n    b\n\nfailures:\n\n---- a stdout ----\npanicked at 'x'\n\nfailures:\n    a\n\n\
            test result: FAILED. 1 passed; 1 failed; 0 ignored; 0 measured; 0 filtered out";
        let mut filter = CargoFilter::default();
        let shown: Vec<&str> = output.lines().filter(|line| filter.shows(line)).collect();
        assert_eq!(filter.settle(), Tally { passed: 1, failed: 1, skipped: 0 });
        assert!(shown.contains(&"panicked at 'x'") && shown.contains(&"test a ... FAILED"), "{shown:?}");
        assert!(!shown.contains(&"noise"), "{shown:?}");
    }
}
