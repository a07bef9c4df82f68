//! Every importer and decoder against made-up input, briefly; `cargo xtask soak` is for longer.

use super::Suite;
use crate::fuzz::{Fuzzer, needs};
use crate::needs::Needs;
use crate::run::Run;

/// A target.
const SECONDS: u64 = 15;

pub const SUITE: Suite = Suite {
    name: "fuzz",
    about: "every importer and decoder against made-up input, each for a quarter of a minute",
    needs: |_| Needs { apt: needs(), ..Needs::default() },
    wants: |_| Needs::default(),
    builds: |project| Fuzzer::build(project).map(drop),
    run,
};

fn run(run: &mut Run<'_>) {
    let fuzzer = match Fuzzer::build(run.project) {
        Ok(fuzzer) => fuzzer,
        Err(reason) => return run.fail("the targets", &reason),
    };
    // Two at a time: a target is one thread.
    for pair in fuzzer.targets.chunks(2) {
        let fuzz = |target: &String| fuzzer.run(target, SECONDS, Some(1));
        let outcomes: Vec<_> = std::thread::scope(|scope| {
            let started: Vec<_> = pair.iter().map(|target| scope.spawn(move || fuzz(target))).collect();
            let panicked = || Err("the run itself panicked".to_owned());
            started.into_iter().map(|thread| thread.join().unwrap_or_else(|_| panicked())).collect()
        });
        for (target, outcome) in pair.iter().zip(outcomes) {
            run.check(target, outcome);
        }
    }
}
