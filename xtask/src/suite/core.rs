//! Formatting, lints, documentation and every test that needs Rust only.

use super::Suite;
use crate::bench::accuracy;
use crate::fuzz::{self, Fuzzer};
use crate::needs::Needs;
use crate::run::{Run, heading};
use crate::tidy;

/// Crates whose tests need another toolchain or host; their own suite runs them.
const OWN_SUITE: &[&str] = &["shisei-excel", "shisei-python"];

/// A target.
const FUZZ_SECONDS: u64 = 15;

pub const SUITE: Suite = Suite {
    name: "core",
    about: "formatting, lints, documentation, the tests of all crates",
    needs: |project| Needs { cargo: vec!["fmt", "clippy"], apt: fuzz::needs(project), ..Needs::default() },
    wants: accuracy::needs,
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
    let clippy = ["clippy", "--quiet", "--workspace", "--all-targets", "--", "-D", "warnings"];
    run.step("cargo clippy", project.cargo().args(clippy));
    let without = ["clippy", "--quiet", "-p", "shisei-core", "--no-default-features", "--", "-D", "warnings"];
    run.step("the core without an allocator", project.cargo().args(without));
    let mut doc = project.cargo();
    doc.args(["doc", "--quiet", "--workspace", "--no-deps"]);
    run.step("cargo doc", doc.env("RUSTDOCFLAGS", "-D warnings"));
    let mut test = project.cargo();
    test.args(["test", "--workspace"]);
    for name in OWN_SUITE.iter().filter(|name| project.root.join("crates").join(name).is_dir()) {
        test.args(["--exclude", name]);
    }
    run.cargo_test("cargo test", &mut test);
    if fuzz::is_there(project) {
        fuzz_briefly(run);
    }
}

/// Every importer, briefly; `cargo xtask soak` is for longer.
fn fuzz_briefly(run: &mut Run<'_>) {
    heading("fuzz");
    match Fuzzer::build(run.project) {
        Ok(fuzzer) => {
            // Two at a time: a target is one thread.
            for pair in fuzzer.targets.chunks(2) {
                let fuzz = |target: &String| fuzzer.run(target, FUZZ_SECONDS, Some(1));
                let outcomes: Vec<_> = std::thread::scope(|scope| {
                    let started: Vec<_> =
                        pair.iter().map(|target| scope.spawn(move || fuzz(target))).collect();
                    let panicked = || Err("the run itself panicked".to_owned());
                    started.into_iter().map(|thread| thread.join().unwrap_or_else(|_| panicked())).collect()
                });
                for (target, outcome) in pair.iter().zip(outcomes) {
                    run.check(&format!("fuzz {target}"), outcome);
                }
            }
        }
        Err(reason) => run.fail("fuzz", &reason),
    }
}
