//! Fuzzing with libFuzzer on the stable compiler: a short run of every target in `test`, a long one in `soak`.
//!
//! Targets are those of fuzz/Cargo.toml, in cargo-fuzz's layout, so that its users can use it too. Starting inputs
//! come from fuzz/seeds/TARGET, words from fuzz/dict/TARGET.dict; what is found on the way stays under target/fuzz.

use std::fs::{self, File};
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::needs::{Apt, Needs};
use crate::project::Project;
use crate::run::{must, output_of, show};

const MANIFEST: &str = "fuzz/Cargo.toml";

/// Feedback for libFuzzer: LLVM's own coverage pass. No unsafe code of ours touches bytes of input, so that an address
/// sanitizer, which needs a nightly compiler, would only cost speed.
const COVERAGE: &str = "--cfg fuzzing -Ccodegen-units=1 -Cpasses=sancov-module \
    -Cllvm-args=-sanitizer-coverage-level=4 -Cllvm-args=-sanitizer-coverage-inline-8bit-counters \
    -Cllvm-args=-sanitizer-coverage-pc-table -Cllvm-args=-sanitizer-coverage-trace-compares";

/// libFuzzer is C++.
pub fn needs() -> Vec<Apt> {
    vec![Apt::program("g++", "c++")]
}

/// `cargo xtask soak [MINUTES] [TARGET …]`: every target, or those named, for ten minutes or as many as given.
pub fn soak(project: &Project, words: &[&str]) -> Result<(), String> {
    let (minutes, names) = match words.split_first() {
        Some((first, rest)) if first.parse::<u64>().is_ok() => (first.parse().unwrap_or(10), rest),
        _ => (10, words),
    };
    Needs { apt: needs(), ..Needs::default() }.ensure(project, "fuzz", false)?;
    let fuzzer = Fuzzer::build(project)?;
    if let Some(unknown) = names.iter().find(|name| !fuzzer.targets.iter().any(|target| target == *name)) {
        return Err(format!("there is no target `{unknown}`; there are: {}", fuzzer.targets.join(", ")));
    }
    let mut failed = Vec::new();
    for target in fuzzer.targets.iter().filter(|target| names.is_empty() || names.contains(&target.as_str()))
    {
        println!("{target}: {minutes} min");
        match fuzzer.run(target, 60 * minutes, None) {
            Ok(remark) => println!("ok      {target}: {remark}"),
            Err(reason) => {
                println!("FAILED  {target}: {reason}");
                failed.push(target.as_str());
            }
        }
    }
    if failed.is_empty() {
        Ok(())
    } else {
        Err(format!("inputs that break them were found for {}", failed.join(", ")))
    }
}

/// The built targets.
#[derive(Debug)]
pub struct Fuzzer<'a> {
    project: &'a Project,
    pub targets: Vec<String>,
    programs: PathBuf,
}

impl<'a> Fuzzer<'a> {
    pub fn build(project: &'a Project) -> Result<Self, String> {
        let host = host()?;
        let folder = project.target().join("fuzz");
        let flags = format!("CARGO_TARGET_{}_RUSTFLAGS", host.to_uppercase().replace('-', "_"));
        let mut cargo = project.cargo();
        // A named target keeps the flags away from build scripts.
        cargo.args(["build", "--quiet", "--release", "--manifest-path", MANIFEST]);
        cargo.args(["--target", &host, "--target-dir"]).arg(&folder).env(flags, COVERAGE);
        for check in ["DEBUG_ASSERTIONS", "OVERFLOW_CHECKS"] {
            cargo.env(format!("CARGO_PROFILE_RELEASE_{check}"), "true");
        }
        must(&mut cargo)?;
        Ok(Fuzzer { project, targets: targets(project)?, programs: folder.join(host).join("release") })
    }

    /// Runs a target; the remark says how many inputs were tried. A fixed seed makes a first run repeatable.
    pub fn run(&self, target: &str, seconds: u64, seed: Option<u32>) -> Result<String, String> {
        let kept = self.project.target().join("fuzz");
        let corpus = kept.join("corpus").join(target);
        fs::create_dir_all(&corpus).map_err(|error| format!("{}: {error}", corpus.display()))?;
        let log = kept.join(format!("{target}.log"));
        let log_file = File::create(&log).map_err(|error| format!("{}: {error}", log.display()))?;
        let mut command = self.project.command(self.programs.join(target));
        command.arg(&corpus);
        let seeds = self.project.root.join("fuzz/seeds").join(target);
        if seeds.is_dir() {
            command.arg(seeds);
        }
        let words = self.project.root.join("fuzz/dict").join(target).with_extension("dict");
        if words.is_file() {
            command.arg(format!("-dict={}", words.display()));
        }
        command.arg(format!("-max_total_time={seconds}"));
        command.args(["-timeout=10", "-rss_limit_mb=2048", "-print_final_stats=1"]);
        command.arg(format!("-artifact_prefix={}/{target}-", kept.display()));
        command.args(seed.map(|seed| format!("-seed={seed}")));
        let status =
            command.stderr(log_file).status().map_err(|error| format!("{}: {error}", show(&command)))?;
        let text = read(&log);
        let tried = units(&text);
        match (status.success(), tried) {
            (true, Some(1..)) => Ok(format!("{} inputs in {seconds} s", tried.unwrap_or_default())),
            (true, _) => Err(format!("it tried no input; see {}", log.display())),
            (false, _) => Err(format!("{}\nsee {}", tail(&text), log.display())),
        }
    }
}

fn host() -> Result<String, String> {
    let version = output_of(std::process::Command::new("rustc").arg("-vV"))?;
    let host = version.lines().find_map(|line| line.strip_prefix("host: "));
    host.map(str::to_owned).ok_or("rustc -vV names no host".into())
}

fn targets(project: &Project) -> Result<Vec<String>, String> {
    let mut cargo = project.cargo();
    cargo.args(["metadata", "--format-version", "1", "--no-deps", "--offline", "--manifest-path", MANIFEST]);
    let metadata: Value = serde_json::from_str(&output_of(&mut cargo)?).map_err(|error| error.to_string())?;
    let all = metadata["packages"][0]["targets"].as_array().into_iter().flatten();
    let programs = all.filter(|target| target["kind"][0] == "bin");
    Ok(programs.filter_map(|target| Some(target["name"].as_str()?.to_owned())).collect())
}

fn read(file: &Path) -> String {
    fs::read(file).map(|bytes| String::from_utf8_lossy(&bytes).into_owned()).unwrap_or_default()
}

/// `stat::number_of_executed_units: 5819`.
fn units(log: &str) -> Option<u64> {
    log.lines().find_map(|line| line.strip_prefix("stat::number_of_executed_units:")?.trim().parse().ok())
}

/// From where the target broke, at most the last 40 lines.
fn tail(log: &str) -> String {
    let lines: Vec<&str> = log.lines().filter(|line| !line.starts_with('#')).collect();
    lines[lines.len().saturating_sub(40)..].join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_number_of_inputs_is_read() {
        let log = "#2 INITED\nDone 5819 runs\nstat::number_of_executed_units: 5819\nstat::peak_rss_mb: 62\n";
        assert_eq!(units(log), Some(5819));
        assert_eq!(units("INFO: Seed: 1"), None);
    }

    #[test]
    fn the_tail_leaves_progress_out() {
        assert_eq!(tail("#1 pulse\nthread panicked\n#2 NEW\nartifact\n"), "thread panicked\nartifact");
    }
}
