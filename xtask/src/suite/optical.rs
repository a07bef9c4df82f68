//! Files for other programs, held against those programs' own checks.

use super::Suite;
use crate::needs::{Apt, Needs};
use crate::programs;
use crate::project::Project;
use crate::run::{Run, must};

pub const SUITE: Suite = Suite {
    name: "optical",
    about: "moving bodies for other programs: glTF by Khronos' validator, MCAP by its Python package, OpenSim's tables",
    needs: |_| Needs {
        apt: vec![Apt::program("nodejs", "node"), Apt::program("npm", "npm")],
        npm: vec!["gltf-validator@2.0.0-dev.3.10"],
        pip: vec!["mcap"],
        ..Needs::default()
    },
    wants: |_| Needs { pip: vec!["opensim"], ..Needs::default() },
    builds: |_| Ok(()),
    run,
};

fn run(run: &mut Run<'_>) {
    let project = run.project;
    let folder = project.target().join("tracks");
    if let Err(reason) = write(project, &folder) {
        return run.fail("tracks", &reason);
    }
    let mut node = project.command("node");
    node.arg("crates/shisei-record/tests/validate_gltf.mjs").arg(project.target().join("npm/node_modules"));
    node.args([folder.join("tool.glb"), folder.join("nothing.glb")]);
    run.step("glTF validator", &mut node);
    for (name, script) in [
        ("MCAP by its Python package", "crates/shisei-hub/tests/check_fused.py"),
        ("OpenSim's tables", "crates/shisei-record/tests/check_sto.py"),
    ] {
        let mut python = project.command(project.venv_python());
        run.step(name, python.arg(script).arg(&folder));
    }
}

fn write(project: &Project, folder: &std::path::Path) -> Result<(), String> {
    std::fs::create_dir_all(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    must(programs::example(project, "tracks")?.arg(folder))?;
    must(programs::example(project, "fused")?.arg(folder))
}
