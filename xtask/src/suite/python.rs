//! The Python package: built as users get it, but for the last optimisation; then its tests and its types.

use super::Suite;
use crate::artefacts::python_wheel;
use crate::needs::Needs;
use crate::programs;
use crate::run::{Run, must};
use crate::tally;

pub const SUITE: Suite = Suite {
    name: "python",
    about: "the Python package: every function, frames, threads, calibration files, types",
    needs: |_| Needs {
        pip: vec!["maturin", "pytest", "numpy", "scipy", "pandas", "polars", "mypy"],
        ..Needs::default()
    },
    wants: |_| Needs::default(),
    builds: |project| python_wheel(project).map(drop),
    run,
};

fn run(run: &mut Run<'_>) {
    let project = run.project;
    let python = project.venv_python();
    let installed = python_wheel(project).and_then(|wheel| {
        let mut pip = project.command(&python);
        must(pip.args(["-m", "pip", "install", "--quiet", "--force-reinstall", "--no-deps"]).arg(wheel))
    });
    if let Err(reason) = installed {
        return run.fail("the package", &reason);
    }
    let shisei = match programs::shisei(project) {
        Ok(shisei) => shisei,
        Err(reason) => return run.fail("shisei", &reason),
    };
    let mut tests = project.command(&python);
    tests.env("SHISEI", shisei);
    tests.args(["-m", "pytest", "-q", "-p", "no:cacheprovider", "crates/shisei-python/tests"]);
    run.tests("pytest", &mut tests, tally::pytest);
    let mut types = project.command(&python);
    types.args(["-m", "mypy", "--strict", "--ignore-missing-imports", "--cache-dir"]);
    types.arg(project.target().join("mypy")).arg("crates/shisei-python/python/shisei");
    run.step("mypy --strict", &mut types);
}
