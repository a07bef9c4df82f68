//! Running Windows programs with Wine.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::needs::Apt;
use crate::project::Project;
use crate::run::must;

/// Debian's wine64 without its wrapper.
const WINE: &str = "/usr/lib/wine/wine64";

/// What a suite that runs Windows programs needs.
pub fn needs() -> Vec<Apt> {
    vec![Apt::file("wine64", WINE), Apt::program("gcc-mingw-w64-x86-64", "x86_64-w64-mingw32-gcc")]
}

/// A Wine of its own, so that nothing of the user's is touched.
#[derive(Debug)]
pub struct Wine {
    prefix: PathBuf,
}

impl Wine {
    /// A new, empty Windows in target/wine/NAME.
    pub fn fresh(project: &Project, name: &str) -> Result<Self, String> {
        let prefix = project.target().join("wine").join(name);
        let _ = std::fs::remove_dir_all(&prefix);
        std::fs::create_dir_all(&prefix).map_err(|error| format!("{}: {error}", prefix.display()))?;
        let wine = Wine { prefix };
        let mut boot = wine.command(project);
        must(boot.args(["wineboot.exe", "--init"]).stdout(std::process::Stdio::null()))?;
        Ok(wine)
    }

    /// `wine64 …`.
    pub fn command(&self, project: &Project) -> Command {
        let mut wine = project.command(WINE);
        wine.env("WINEPREFIX", &self.prefix).env("WINEDEBUG", "-all").env("DISPLAY", "");
        wine.env("WINEDLLOVERRIDES", "mscoree,mshtml="); // no question about .NET and a browser
        wine
    }

    /// Drive C.
    pub fn drive_c(&self) -> PathBuf {
        self.prefix.join("drive_c")
    }
}

/// Wine 8 lacks bcryptprimitives.dll, which Rust's library loads for random numbers: a stand-in beside the
/// program. Real Windows has it.
pub fn stand_in(project: &Project, folder: &Path) -> Result<(), String> {
    let source = project.root.join("crates/shisei-excel/tests/bcryptprimitives.c");
    let mut compiler = project.command("x86_64-w64-mingw32-gcc");
    let out = folder.join("bcryptprimitives.dll");
    must(compiler.args(["-shared", "-O2", "-o"]).arg(out).arg(source).arg("-ladvapi32"))
}
