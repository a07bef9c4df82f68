//! `cargo xtask dist`: everything users install, into dist/, with a list of files and checksums.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use crate::artefacts::{self, VERSION, WindowsFiles};
use crate::cross::{WASM32, WINDOWS};
use crate::needs::{Apt, Needs};
use crate::project::Project;
use crate::run::{heading, output_of};
use crate::{firmware, installer, wine, workbooks};

/// `cargo xtask dist [--install]`.
pub fn command(project: &Project, words: &[&str]) -> Result<(), String> {
    let install = match words {
        [] => false,
        ["--install"] => true,
        _ => return Err("cargo xtask dist [--install]".into()),
    };
    needs(project).ensure(project, "dist", install)?;
    let out = project.root.join("dist");
    let _ = std::fs::remove_dir_all(&out); // files of an earlier version must not stay
    std::fs::create_dir_all(&out).map_err(|error| format!("{}: {error}", out.display()))?;
    for file in build(project)? {
        let name = file.file_name().ok_or("a file without a name")?;
        std::fs::copy(&file, out.join(name)).map_err(|error| format!("{}: {error}", file.display()))?;
    }
    let list = list(project, &out)?;
    std::fs::write(out.join("SHA256SUMS"), &list).map_err(|error| error.to_string())?;
    print!("\n{list}");
    Ok(())
}

/// What is needed to build for Excel, Calc, Python, JavaScript and the boards on this machine.
fn needs(project: &Project) -> Needs {
    let mut needs = WINDOWS.needs(project);
    needs.apt.extend(wine::needs());
    needs.apt.extend([
        Apt::program("wixl", "wixl"),
        Apt::program("libreoffice-calc", "soffice"),
        Apt::file("python3-uno", "/usr/lib/python3/dist-packages/uno.py"),
        Apt::file("libreoffice-dev", "/usr/lib/libreoffice/sdk/bin/unoidl-write"),
    ]);
    needs.pip.push("maturin");
    needs.apt.extend(WASM32.needs(project).apt);
    needs.apt.push(Apt::program("npm", "npm"));
    needs.apt.extend(firmware::needs(project).apt);
    needs
}

fn build(project: &Project) -> Result<Vec<PathBuf>, String> {
    heading("for Windows");
    let windows = artefacts::windows_files(project)?;
    heading("sample workbooks");
    let samples = workbooks::build(project)?;
    heading("installer");
    let installer = installer::build(project, &windows, &samples)?;
    heading("for Calc");
    let extension =
        artefacts::calc_extension(project, &[format!("windows-x86_64={}", windows.dll.display())])?;
    let ods = workbooks::build_ods(project, &extension)?;
    heading("for Python");
    let wheel = artefacts::python_wheel(project)?;
    heading("for JavaScript");
    let npm = artefacts::npm_package(project)?;
    heading("for the boards");
    let boards = firmware::files(project)?;
    let WindowsFiles { xll, dll, .. } = windows;
    let mut files = vec![xll, dll, installer, extension, wheel, npm, artefacts::shared_library(project)?];
    files.extend(boards);
    files.extend(samples);
    files.extend(ods);
    files.push(project.root.join("crates/shisei-capi/include/shisei.h"));
    files.push(project.root.join("crates/shisei-capi/vba/shisei.bas"));
    files.extend(["LICENSE-MIT", "LICENSE-APACHE"].map(|name| project.root.join(name)));
    Ok(files)
}

/// A line a file: checksum, name; as `sha256sum --check` reads it.
fn list(project: &Project, folder: &Path) -> Result<String, String> {
    let entries = std::fs::read_dir(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let mut names: Vec<String> =
        entries.flatten().map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    let mut sums = project.command("sha256sum");
    let text = output_of(sums.current_dir(folder).args(&names))?;
    let mut list = String::new();
    for line in text.lines() {
        let _ = writeln!(list, "{line}");
    }
    if !list.contains(VERSION) {
        return Err(format!("no file of version {VERSION} was made"));
    }
    Ok(list)
}
