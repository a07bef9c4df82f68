//! `cargo xtask bench doors`: what a door costs beside the mathematics, in Calc, in Python and in the XLL.

use crate::artefacts::{OFFICE_PYTHON, calc_extension, python_wheel, shared_library};
use crate::project::Project;
use crate::run::must;
use crate::suite;

/// Every part whose tools are there; a part that is not says so.
pub fn command(project: &Project, words: &[&str]) -> Result<(), String> {
    if !words.is_empty() {
        return Err("cargo xtask bench doors".into());
    }
    let parts = [("Calc", calc(project)), ("Python", python(project)), ("XLL", suite::excel::speed(project))];
    let mut failed = Vec::new();
    for (name, outcome) in parts {
        if let Err(reason) = outcome {
            println!("{name}: {reason}");
            failed.push(name);
        }
    }
    if failed.is_empty() { Ok(()) } else { Err(format!("not measured or too slow: {}", failed.join(", "))) }
}

fn calc(project: &Project) -> Result<(), String> {
    let extension = calc_extension(project, &[])?;
    must(project.command(OFFICE_PYTHON).arg("apps/calc/tests/bench.py").arg(extension))
}

fn python(project: &Project) -> Result<(), String> {
    let wheel = python_wheel(project)?;
    let python = project.venv_python();
    let mut pip = project.command(&python);
    must(pip.args(["-m", "pip", "install", "--quiet", "--force-reinstall", "--no-deps"]).arg(wheel))?;
    let mut bench = project.command(&python);
    must(bench.arg("crates/shisei-python/tests/bench.py").arg(shared_library(project)?))
}
