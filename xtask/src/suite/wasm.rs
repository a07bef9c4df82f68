//! WebAssembly under Node: the same bits as the host.

use std::time::Duration;

use super::Suite;
use crate::cross::WASM32;
use crate::digests;
use crate::needs::{Apt, Needs};
use crate::project::Project;
use crate::run::{Run, heading, must, output_within};

pub const SUITE: Suite = Suite {
    name: "wasm",
    about: "the core's digest on wasm32, under Node",
    needs: |project| {
        let mut needs = WASM32.needs(project);
        needs.apt.push(Apt::program("nodejs", "node"));
        needs
    },
    wants: |_| Needs::default(),
    builds: build,
    run,
};

fn run(run: &mut Run<'_>) {
    heading("digest on wasm32");
    digests::compare(run, WASM32.triple, under_node(run.project));
}

fn build(project: &Project) -> Result<(), String> {
    must(WASM32.cargo_build(project).args(["--package", "shisei-digest", "--example", "digest_wasm"]))
}

fn under_node(project: &Project) -> Result<String, String> {
    build(project)?;
    let mut node = project.command("node");
    node.arg("xtask/js/digest.mjs").arg(WASM32.products(project).join("examples/digest_wasm.wasm"));
    output_within(&mut node, Duration::from_secs(120))
}
