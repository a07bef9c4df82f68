//! Formatting, lints, documentation and every test that needs Rust only.

use std::num::NonZero;

use super::Suite;
use crate::bench::accuracy;
use crate::needs::{Apt, Needs};
use crate::programs;
use crate::run::Run;
use crate::tidy;

pub const SUITE: Suite = Suite {
    name: "core",
    about: "formatting, lints, documentation, the tests of all crates",
    needs: |_| Needs { cargo: vec!["fmt", "clippy"], ..Needs::default() },
    // the sketch for the Spresense is C++
    wants: |project| Needs { apt: vec![Apt::program("g++", "c++")], ..accuracy::needs(project) },
    builds: |_| Ok(()),
    run,
};

fn run(run: &mut Run<'_>) {
    let project = run.project;
    for (name, outcome) in tidy::check(project) {
        run.check(name, outcome);
    }
    run.step("cargo fmt", project.cargo().args(["fmt", "--all", "--check"]));
    for manifest in project.other_workspaces() {
        let name = format!("cargo fmt {}", manifest.display());
        let mut fmt = project.cargo();
        run.step(&name, fmt.args(["fmt", "--check", "--manifest-path"]).arg(manifest));
    }
    let mut clippy = project.cargo();
    clippy.args(["clippy", "--quiet", "--workspace", "--all-targets", "--features", "xtask/bridge"]);
    run.step("cargo clippy", clippy.args(["--", "-D", "warnings"]));
    let without = ["clippy", "--quiet", "-p", "shisei-core", "--no-default-features", "--", "-D", "warnings"];
    run.step("the core without an allocator", project.cargo().args(without));
    let mut doc = project.cargo();
    doc.args(["doc", "--quiet", "--workspace", "--no-deps"]);
    run.step("cargo doc", doc.env("RUSTDOCFLAGS", "-D warnings"));
    let mut test = programs::cargo(project, "test");
    // the longest tests wait for devices and clients, not for the processor
    let threads = 2 * std::thread::available_parallelism().map_or(2, NonZero::get);
    run.cargo_test("cargo test", test.env("RUST_TEST_THREADS", threads.to_string()));
}
