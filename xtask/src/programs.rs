//! The workspace's programs and examples, as its tests build them.
//!
//! Cargo chooses the features of dependencies by the packages it is given: for one package alone it would compile
//! Parquet and all that stands on it anew. So everything is built of the whole workspace, once.

use std::path::PathBuf;
use std::process::Command;

use crate::project::Project;
use crate::run::must;

/// Packages that need another toolchain or host; their own suite builds and tests them.
const OWN_SUITE: [&str; 2] = ["shisei-excel", "shisei-python"];
/// What the suites run.
const EXAMPLES: [&str; 4] = ["demo", "fused", "tracks", "workbooks"];

/// `cargo WORD` for all packages that need Rust only.
pub fn cargo(project: &Project, word: &str) -> Command {
    let mut cargo = project.cargo();
    cargo.args([word, "--workspace"]);
    for name in OWN_SUITE {
        cargo.args(["--exclude", name]);
    }
    cargo
}

/// `shisei`.
pub fn shisei(project: &Project) -> Result<PathBuf, String> {
    Ok(built(project)?.join("shisei"))
}

/// An example, to be given its arguments.
pub fn example(project: &Project, name: &str) -> Result<Command, String> {
    Ok(project.command(built(project)?.join("examples").join(name)))
}

fn built(project: &Project) -> Result<PathBuf, String> {
    let mut build = cargo(project, "build");
    build.args(["--quiet", "--bin", "shisei"]);
    must(build.args(EXAMPLES.iter().flat_map(|name| ["--example", name])))?;
    Ok(project.target().join("debug"))
}
