//! Building what users install: one function an artefact, for the suites that test it and for `dist`.

use std::path::PathBuf;

use crate::project::Project;
use crate::run::{must, show};

/// The Python that knows UNO: LibreOffice's own on Debian.
pub const OFFICE_PYTHON: &str = "/usr/bin/python3";

/// The host's shared library, release build.
pub fn shared_library(project: &Project) -> Result<PathBuf, String> {
    must(project.cargo().args(["build", "--quiet", "--release", "--package", "shisei-capi"]))?;
    let name = format!("{}shisei{}", std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
    Ok(project.target().join("release").join(name))
}

/// shisei.oxt with the host's library, and other platforms' (`windows-x86_64=PATH`) where given.
pub fn calc_extension(project: &Project, others: &[String]) -> Result<PathBuf, String> {
    let library = shared_library(project)?;
    let out = project.target().join("shisei.oxt");
    let mut build = project.command(OFFICE_PYTHON);
    build.args(["apps/calc/build.py"]).arg(&out);
    build.arg(format!("linux-{}={}", std::env::consts::ARCH, library.display())).args(others);
    must(&mut build).map_err(|reason| format!("{}: {reason}", show(&build)))?;
    Ok(out)
}

/// The wheel of the Python package for this platform, abi3 from Python 3.10.
pub fn python_wheel(project: &Project) -> Result<PathBuf, String> {
    let folder = project.target().join("wheels");
    let _ = std::fs::remove_dir_all(&folder); // an older version's wheel must not be taken for the new one
    let mut maturin = project.command(project.venv_python());
    must(maturin.args(["-m", "maturin", "build", "--release", "--quiet", "--out"]).arg(&folder))?;
    let files = std::fs::read_dir(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let mut wheels = files.flatten().map(|entry| entry.path());
    wheels
        .find(|path| path.extension().is_some_and(|end| end == "whl"))
        .ok_or("maturin wrote no wheel".into())
}
