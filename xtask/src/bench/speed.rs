//! `cargo xtask bench speed`: our kernels and files beside named programs, in turns, on one core.

use crate::needs::{Apt, Needs};
use crate::project::Project;
use crate::run::must;

const ROWS: &str = "1000000";
const ROUNDS: &str = "9";

/// Prints medians, and ratios with their limits; fails where one is missed. `words` may have `--install`.
pub fn command(project: &Project, words: &[&str]) -> Result<(), String> {
    let install = match words {
        [] => false,
        ["--install"] => true,
        _ => return Err("cargo xtask bench speed [--install]".into()),
    };
    let needs = Needs {
        apt: vec![Apt::program("gcc", "cc").or("cc")],
        pip: vec!["ahrs", "imufusion", "numpy", "pandas", "polars", "pyarrow", "scipy", "vqf"],
        ..Needs::default()
    };
    needs
        .ensure(project, "core", install)
        .map_err(|reason| reason.replace("test --install core", "bench speed --install"))?;
    must(project.cargo().args(["build", "--release", "--quiet", "--package", "shisei-cli"]))?;
    for (package, example) in [("shisei-wide", "arithmetic"), ("shisei-record", "kernels")] {
        let build = ["build", "--release", "--quiet", "--package", package, "--example", example];
        must(project.cargo().args(build))?;
    }
    let release = project.target().join("release");
    let mut measure = project.command(project.venv_python());
    measure.arg("xtask/py/speed.py").arg(release.join("examples")).arg(release.join("shisei"));
    must(measure.arg(project.target().join("bench-speed")).args([ROWS, ROUNDS]))
}
