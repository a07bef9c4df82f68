//! Where things are.

use std::path::{Path, PathBuf};
use std::process::Command;

/// The checkout this program was built from.
#[derive(Debug)]
pub struct Project {
    /// The folder of the workspace's Cargo.toml.
    pub root: PathBuf,
    /// True on continuous integration, where nothing may be skipped for want of a package.
    pub ci: bool,
    /// True for tests: what users get is built without the last optimisation across crates, which makes it a little
    /// faster and no different, and takes longest.
    pub quick: bool,
}

impl Project {
    pub fn here() -> Self {
        let mut root = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
        root.pop();
        Project { root, ci: std::env::var_os("CI").is_some_and(|value| value == "true"), quick: false }
    }

    /// Build products and everything fetched.
    pub fn target(&self) -> PathBuf {
        std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| self.root.join("target"), PathBuf::from)
    }

    /// Real recordings: `SHISEI_DATA`, else `../shared/data`; nothing where it is absent.
    pub fn data(&self) -> Option<PathBuf> {
        let folder = std::env::var_os("SHISEI_DATA")
            .map_or_else(|| self.root.join("..").join("shared").join("data"), PathBuf::from);
        folder.is_dir().then_some(folder)
    }

    /// The Python of target/venv.
    pub fn venv_python(&self) -> PathBuf {
        let venv = self.target().join("venv");
        if cfg!(windows) { venv.join("Scripts").join("python.exe") } else { venv.join("bin").join("python") }
    }

    /// A command that runs in the checkout.
    pub fn command(&self, program: impl AsRef<std::ffi::OsStr>) -> Command {
        let mut command = Command::new(program);
        command.current_dir(&self.root);
        command
    }

    /// The cargo that started us.
    pub fn cargo(&self) -> Command {
        self.command(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
    }

    /// What cargo and maturin are given besides when they build the workspace for users.
    pub fn release(&self) -> &'static [&'static str] {
        if self.quick { &["--release", "--config", "profile.release.lto=\"off\""] } else { &["--release"] }
    }

    /// Manifests of the workspaces beside the main one: firmware/*, fuzz.
    pub fn other_workspaces(&self) -> Vec<PathBuf> {
        let firmware = std::fs::read_dir(self.root.join("firmware"));
        let folders = firmware.into_iter().flatten().flatten().map(|entry| entry.path());
        let mut manifests: Vec<PathBuf> = folders
            .chain([self.root.join("fuzz")])
            .map(|folder| folder.join("Cargo.toml"))
            .filter(|manifest| manifest.is_file())
            .filter_map(|manifest| Some(manifest.strip_prefix(&self.root).ok()?.to_owned()))
            .collect();
        manifests.sort();
        manifests
    }

    /// Every file under version control, relative to the root.
    pub fn tracked_files(&self) -> Result<Vec<PathBuf>, String> {
        let output = self
            .command("git")
            .args(["ls-files", "-z", "--cached"])
            .output()
            .map_err(|error| format!("git ls-files: {error}"))?;
        let names = String::from_utf8_lossy(&output.stdout).into_owned();
        let files: Vec<PathBuf> =
            names.split('\0').filter(|name| !name.is_empty()).map(PathBuf::from).collect();
        if files.is_empty() {
            return Err("git ls-files lists nothing; run this in a git checkout".into());
        }
        Ok(files.into_iter().filter(|file| self.root.join(file).is_file()).collect())
    }
}

/// True when a program of this name is on the path.
pub fn on_path(program: &str) -> bool {
    find_on_path(program).is_some()
}

/// Where a program is.
pub fn find_on_path(program: &str) -> Option<PathBuf> {
    let path = std::env::var_os("PATH")?;
    std::env::split_paths(&path).map(|folder| folder.join(program)).find(|file| Path::is_file(file))
}
