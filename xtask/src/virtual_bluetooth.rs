//! Nodes and receiver over virtual Bluetooth controllers (`firmware/virtual`), and readers that are not ours.

use std::process::Command;

use crate::project::Project;
use crate::run::{Run, must};

/// bumble is the controllers and the other central; the rest reads what was recorded.
pub const PIP: [&str; 4] = ["bumble", "cobs", "crcmod", "mcap"];

fn cargo(project: &Project, word: &str) -> Command {
    let mut cargo = project.cargo();
    // In its folder, for the settings in its .cargo/config.toml.
    cargo.arg(word).args(["--locked", "--target-dir"]).arg(project.target().join("virtual"));
    cargo.current_dir(project.root.join("firmware/virtual"));
    cargo.env("SHISEI_PYTHON", project.venv_python());
    cargo
}

/// Builds tests and programs together, for cargo would choose other features of what they depend on for one alone.
pub fn build(project: &Project) -> Result<(), String> {
    must(cargo(project, "test").args(["--quiet", "--no-run"]))
}

/// A program of `firmware/virtual`, to be given its arguments.
pub fn program(project: &Project, name: &str) -> Result<Command, String> {
    build(project)?;
    Ok(project.command(project.target().join("virtual/debug").join(name)))
}

/// The tests, then the third-party readers on what they recorded.
pub fn run(run: &mut Run<'_>) {
    let project = run.project;
    let (frames, take) =
        (project.target().join("virtual/frames.bin"), project.target().join("virtual/take.mcap"));
    // What an earlier run left must not be taken for this one's.
    let _ = std::fs::remove_file(&frames);
    let _ = std::fs::remove_file(&take);
    let mut tests = cargo(project, "test");
    tests.env("SHISEI_FRAMES", &frames).env("SHISEI_TAKE", &take);
    run.cargo_test("virtual Bluetooth", &mut tests);
    for (name, script, file) in [
        ("frames by PyPI's cobs and crcmod", "frames.py", &frames),
        ("an unfinished recording by PyPI's mcap", "cut_take.py", &take),
    ] {
        let mut reader = project.command(project.venv_python());
        reader.arg(project.root.join("firmware/virtual/py").join(script)).arg(file);
        run.step(name, &mut reader);
    }
}
