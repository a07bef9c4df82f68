//! The live stream against programs that know nothing of ours, and a minute of it.

use super::Suite;
use crate::needs::Needs;
use crate::programs;
use crate::run::Run;
use crate::soak;
use crate::tally;

pub const SUITE: Suite = Suite {
    name: "live",
    about: "the demonstration's NatNet, read by an independent client in four versions and by multicast; a minute of soak",
    needs: |_| Needs { pip: vec!["natnet"], ..Needs::default() },
    wants: |_| Needs::default(),
    builds: |_| Ok(()),
    run,
};

/// In continuous integration; `cargo xtask soak live` is for longer.
const SOAK_S: u64 = 60;

fn run(run: &mut Run<'_>) {
    let project = run.project;
    let shisei = match programs::shisei(project) {
        Ok(shisei) => shisei,
        Err(reason) => return run.fail("shisei", &reason),
    };
    let mut read = project.command(project.venv_python());
    read.arg("crates/shisei-hub/tests/read_natnet.py").arg(&shisei);
    // beside each other: both wait for most of the time
    let flat = std::thread::scope(|scope| {
        let soak = scope.spawn(|| soak::watch(&shisei, SOAK_S));
        run.tests("an independent NatNet client", &mut read, tally::closing_line);
        soak.join().unwrap_or_else(|_| Err("the watch itself panicked".into()))
    });
    run.check("memory and load stay flat", flat);
}
