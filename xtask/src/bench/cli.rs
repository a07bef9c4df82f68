//! `cargo xtask bench cli`: a big CSV through `shisei orient`, beside polars + vqf in Python.

use crate::needs::Needs;
use crate::project::Project;
use crate::run::must;

const ROWS: &str = "1000000";
const RUNS: &str = "5";

/// Prints time and peak memory of whole processes; `words` may have `--install`.
pub fn command(project: &Project, words: &[&str]) -> Result<(), String> {
    let install = match words {
        [] => false,
        ["--install"] => true,
        _ => return Err("cargo xtask bench cli [--install]".into()),
    };
    let needs = Needs { pip: vec!["numpy", "polars", "vqf"], ..Needs::default() };
    needs
        .ensure(project, "core", install)
        .map_err(|reason| reason.replace("test --install core", "bench cli --install"))?;
    must(project.cargo().args(["build", "--release", "--quiet", "--package", "shisei-cli"]))?;
    let mut measure = project.command(project.venv_python());
    measure.arg("xtask/py/cli.py").arg(project.target().join("release/shisei"));
    must(measure.arg(project.target().join("bench-cli")).args([ROWS, RUNS]))
}
