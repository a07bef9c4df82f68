//! The suites. To add one: a file here with a `SUITE`, and its name in `ALL`.

mod calc;
mod core;
mod device;
pub mod excel;
mod fuzz;
mod live;
mod optical;
mod python;
mod viewer;
mod wasm;

use std::process::ExitCode;
use std::sync::mpsc;
use std::time::Instant;

use crate::needs::Needs;
use crate::project::Project;
use crate::run::{Run, seconds};
use crate::tally::Tally;

/// A group of tests that needs the same things from the machine.
#[derive(Debug)]
pub struct Suite {
    pub name: &'static str,
    /// What it shows, in one line.
    pub about: &'static str,
    /// Without these it cannot run.
    pub needs: fn(&Project) -> Needs,
    /// Without these some of its tests say that they skip themselves.
    pub wants: fn(&Project) -> Needs,
    /// What it has compiled beside the workspace; what is missing of it when it runs it compiles then.
    pub builds: fn(&Project) -> Result<(), String>,
    pub run: fn(&mut Run<'_>),
}

/// In the order in which they run.
const ALL: &[Suite] = &[
    core::SUITE,
    calc::SUITE,
    python::SUITE,
    optical::SUITE,
    live::SUITE,
    excel::SUITE,
    device::SUITE,
    wasm::SUITE,
    viewer::SUITE,
    fuzz::SUITE,
];

/// `cargo xtask test …`.
pub fn command(project: &Project, words: &[&str]) -> ExitCode {
    let mut install = false;
    let mut names = Vec::new();
    for word in words {
        match *word {
            "--install" => install = true,
            "--list" => {
                for suite in ALL {
                    println!("{:8} {}", suite.name, suite.about);
                    println!("{:8} needs {}", "", (suite.needs)(project).describe());
                    println!("{:8} wants {}", "", (suite.wants)(project).describe());
                }
                return ExitCode::SUCCESS;
            }
            name if ALL.iter().any(|suite| suite.name == name) => names.push(name),
            other => {
                let known: Vec<&str> = ALL.iter().map(|suite| suite.name).collect();
                eprintln!("there is no suite `{other}`; there are: {}", known.join(", "));
                return ExitCode::from(2);
            }
        }
    }
    let chosen: Vec<&Suite> =
        ALL.iter().filter(|suite| names.is_empty() || names.contains(&suite.name)).collect();
    let mut total = Tally::default();
    let mut notes = Vec::new();
    let (sender, ready) = mpsc::channel();
    std::thread::scope(|scope| {
        // what the later suites need is fetched and compiled while the earlier ones run
        scope.spawn(|| {
            for suite in &chosen {
                // nobody listens any more only if this program panics
                let _ = sender.send(make_ready(suite, project, install));
            }
            drop(sender);
        });
        for suite in &chosen {
            let (tally, remarks) = run(suite, project, &ready);
            total.add(tally);
            notes.extend(remarks.into_iter().map(|note| format!("{:8} {note}", suite.name)));
        }
    });
    println!();
    for note in notes {
        println!("{note}");
    }
    println!("{total}");
    if total.failed == 0 && total.passed > 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// What became of what a suite wants and of what it needs.
struct Ready {
    wants: Result<(), String>,
    needs: Result<(), String>,
}

fn make_ready(suite: &Suite, project: &Project, install: bool) -> Ready {
    // what is only wanted may be absent where nothing is installed
    let wants = if install { (suite.wants)(project).ensure(project, suite.name, true) } else { Ok(()) };
    let needs = (suite.needs)(project).ensure(project, suite.name, install);
    if needs.is_ok() {
        // what does not compile says so again when the suite runs, and fails there
        let _ = (suite.builds)(project);
    }
    Ready { wants, needs }
}

fn run(suite: &Suite, project: &Project, ready: &mpsc::Receiver<Ready>) -> (Tally, Vec<String>) {
    println!("\n=== {}: {}", suite.name, suite.about);
    let started = Instant::now();
    let mut run = Run::new(project);
    let panicked = || Err("installing itself panicked".to_owned());
    let ready = ready.recv().unwrap_or_else(|_| Ready { wants: panicked(), needs: panicked() });
    if let Err(reason) = ready.wants {
        run.fail("installing", &reason);
    }
    match ready.needs {
        Ok(()) => {
            (suite.run)(&mut run);
            if run.tally.ran() == 0 {
                run.fail(suite.name, "the suite ran no test");
            }
        }
        Err(reason) if project.ci => run.fail(suite.name, &reason),
        Err(reason) => run.skip(suite.name, &reason),
    }
    println!("=== {}: {}, {}", suite.name, run.tally, seconds(started));
    (run.tally, run.notes)
}
