//! The live stream against programs that know nothing of ours, and a minute of it.

use super::Suite;
use crate::needs::Needs;
use crate::run::{Run, must};
use crate::soak;
use crate::tally;

pub const SUITE: Suite = Suite {
    name: "live",
    about: "the demonstration's NatNet, read by an independent client in four versions and by multicast; a minute of soak",
    needs: |_| Needs { pip: vec!["natnet"], ..Needs::default() },
    wants: |_| Needs::default(),
    run,
};

/// In continuous integration; `cargo xtask soak live` is for longer.
const SOAK_S: u64 = 60;

fn run(run: &mut Run<'_>) {
    let project = run.project;
    if let Err(reason) = must(project.cargo().args(["build", "--quiet", "--release", "-p", "shisei-cli"])) {
        return run.fail("shisei", &reason);
    }
    let shisei = project.target().join("release/shisei");
    let mut read = project.command(project.venv_python());
    read.arg("crates/shisei-hub/tests/read_natnet.py").arg(&shisei);
    run.tests("an independent NatNet client", &mut read, tally::closing_line);
    run.check("memory and load stay flat", soak::watch(&shisei, SOAK_S));
}
