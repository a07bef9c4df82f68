//! `cargo xtask …`: the one command of developers and of continuous integration.

use std::process::ExitCode;

use xtask::project::Project;
use xtask::{bench, dist, fuzz, soak, suite, tidy};

const USAGE: &str = "\
cargo xtask test [--install] [SUITE …]   run the suites (all without a name); --install fetches what is missing
cargo xtask test --list                  the suites and what each needs
cargo xtask tidy                         rules that no compiler holds us to
cargo xtask bench accuracy               orientation errors on BROAD, ours and our peers' [--install] [--no-peers]
cargo xtask bench cli                    a big CSV through `shisei orient`, beside polars + vqf [--install]
cargo xtask bench speed                  kernels, CSV and `shisei orient` beside named programs [--install]
cargo xtask bench doors                  what Calc, Python and the XLL cost beside the mathematics
cargo xtask dist [--install]             everything users install, into dist/, with checksums
cargo xtask bench bridge [TRIAL …]       errors in optical gaps on BROAD: lines, gyroscope, ours
cargo xtask bench sync [--install]       clocks and mounting of simulated takes, ours beside qmt's
cargo xtask bench live                   from sample to pose, losses: 20 nodes at 120 Hz, 100 at 240 Hz
cargo xtask soak live [MINUTES]          the live demonstration: memory and load stay flat (10 min)
cargo xtask soak [MINUTES] [TARGET …]    fuzzes every importer for longer (10 min each)
";

fn main() -> ExitCode {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = args.iter().map(String::as_str).collect();
    let project = Project { quick: words.first() == Some(&"test"), ..Project::here() };
    match words.split_first() {
        Some((&"test", rest)) => suite::command(&project, rest),
        Some((&"bench", ["accuracy", rest @ ..])) => finish(bench::accuracy::command(&project, rest)),
        Some((&"bench", ["cli", rest @ ..])) => finish(bench::cli::command(&project, rest)),
        Some((&"bench", ["speed", rest @ ..])) => finish(bench::speed::command(&project, rest)),
        Some((&"bench", ["doors", rest @ ..])) => finish(bench::doors::command(&project, rest)),
        Some((&"dist", rest)) => finish(dist::command(&project, rest)),
        #[cfg(feature = "bridge")]
        Some((&"bench", ["bridge", rest @ ..])) => finish(bench::bridge::command(&project, rest)),
        #[cfg(not(feature = "bridge"))]
        Some((&"bench", ["bridge", ..])) => finish(with_feature(&project, "bridge", &words)),
        Some((&"bench", ["sync", rest @ ..])) => finish(bench::sync::command(&project, rest)),
        Some((&"bench", ["live"])) => finish(bench::live::command(&project)),
        Some((&"soak", ["live", rest @ ..])) => finish(soak::command(&project, rest)),
        Some((&"soak", rest)) => finish(fuzz::soak(&project, rest)),
        Some((&"tidy", [])) => report_tidy(&project),
        Some((&("help" | "--help" | "-h"), _)) => {
            print!("{USAGE}");
            ExitCode::SUCCESS
        }
        _ => {
            eprint!("{USAGE}");
            ExitCode::from(2)
        }
    }
}

/// The same words to a program built with a feature that is left out of this one.
#[cfg(not(feature = "bridge"))]
fn with_feature(project: &Project, feature: &str, words: &[&str]) -> Result<(), String> {
    let mut cargo = project.cargo();
    cargo.args(["run", "--quiet", "--package", "xtask", "--features", feature, "--"]);
    xtask::run::must(cargo.args(words))
}

fn report_tidy(project: &Project) -> ExitCode {
    let mut code = ExitCode::SUCCESS;
    for (name, outcome) in tidy::check(project) {
        match outcome {
            Ok(_) => println!("ok      {name}"),
            Err(reason) => {
                println!("FAILED  {name}: {reason}");
                code = ExitCode::FAILURE;
            }
        }
    }
    code
}

fn finish(outcome: Result<(), String>) -> ExitCode {
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(reason) => {
            eprintln!("{reason}");
            ExitCode::FAILURE
        }
    }
}
