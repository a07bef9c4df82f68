//! Building what users install: one function an artefact, for the suites that test it and for `dist`.

use std::path::PathBuf;

use crate::cross::{WASM32, WINDOWS};
use crate::project::Project;
use crate::run::{must, show};

/// The Python that knows UNO: LibreOffice's own on Debian.
pub const OFFICE_PYTHON: &str = "/usr/bin/python3";

/// The one version of all crates and doors.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

/// The host's shared library, release build.
pub fn shared_library(project: &Project) -> Result<PathBuf, String> {
    must(project.cargo().args(["build", "--quiet", "--package", "shisei-capi"]).args(project.release()))?;
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
    maturin.args(["-m", "maturin", "build", "--quiet"]).args(project.release());
    must(maturin.arg("--out").arg(&folder))?;
    let files = std::fs::read_dir(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let mut wheels = files.flatten().map(|entry| entry.path());
    wheels
        .find(|path| path.extension().is_some_and(|end| end == "whl"))
        .ok_or("maturin wrote no wheel".into())
}

/// The folder of the JavaScript package, as users install it.
pub fn npm_folder(project: &Project) -> Result<PathBuf, String> {
    must(WASM32.cargo_build(project).args(["--package", "shisei-wasm"]))?;
    let folder = project.target().join("npm-package");
    let _ = std::fs::remove_dir_all(&folder); // files of an earlier version must not stay
    let wasm = folder.join("wasm");
    std::fs::create_dir_all(&wasm).map_err(|error| format!("{}: {error}", wasm.display()))?;
    let mut bindgen = project.cargo();
    bindgen.args(["run", "--quiet", "--package", "xtask", "--features", "bindgen", "--bin", "bindgen", "--"]);
    must(bindgen.arg(WASM32.products(project).join("shisei_wasm.wasm")).arg(&wasm))?;
    let sources = project.root.join("crates/shisei-wasm/npm");
    let entries = std::fs::read_dir(&sources).map_err(|error| format!("{}: {error}", sources.display()))?;
    let mut files: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    files.extend(["LICENSE-MIT", "LICENSE-APACHE"].map(|name| project.root.join(name)));
    for file in files {
        let name = file.file_name().ok_or("a file without a name")?;
        std::fs::copy(&file, folder.join(name)).map_err(|error| format!("{}: {error}", file.display()))?;
    }
    Ok(folder)
}

/// The JavaScript package in one file, for `npm install FILE`.
pub fn npm_package(project: &Project) -> Result<PathBuf, String> {
    let mut npm = project.command("npm");
    must(
        npm.args(["pack", "--silent", "--pack-destination"]).arg(project.target()).arg(npm_folder(project)?),
    )?;
    Ok(project.target().join(format!("shisei-{VERSION}.tgz")))
}

/// What the Windows build gives.
#[derive(Clone, Debug)]
pub struct WindowsFiles {
    pub xll: PathBuf,
    pub dll: PathBuf,
    pub register: PathBuf,
}

/// shisei.xll, shisei.dll and the installer's helper.
pub fn windows_files(project: &Project) -> Result<WindowsFiles, String> {
    let mut build = WINDOWS.cargo_build(project);
    must(build.args(["--package", "shisei-excel", "--package", "shisei-capi", "--lib", "--bins"]))?;
    let products = WINDOWS.products(project);
    let folder = project.target().join("windows");
    std::fs::create_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let take = |from: &str, to: &str| -> Result<PathBuf, String> {
        let (from, to) = (products.join(from), folder.join(to));
        let mut strip = project.command("x86_64-w64-mingw32-strip");
        must(strip.arg("--strip-debug").arg("-o").arg(&to).arg(&from))?;
        Ok(to)
    };
    Ok(WindowsFiles {
        xll: take("shisei_xll.dll", "shisei.xll")?,
        dll: take("shisei.dll", "shisei.dll")?,
        register: take("xll-register.exe", "xll-register.exe")?,
    })
}
