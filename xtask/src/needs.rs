//! What a suite needs from the machine, and fetching what is missing.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::project::{Project, on_path};
use crate::run::{output_of, quietly};

/// Everything a suite needs that a Rust toolchain does not bring.
#[derive(Debug, Default)]
pub struct Needs {
    pub apt: Vec<Apt>,
    /// Names from xtask/py/requirements.txt.
    pub pip: Vec<&'static str>,
    /// `name@version`, put under target/npm.
    pub npm: Vec<&'static str>,
    /// Subcommands of cargo (`clippy`, `fmt`): components of rustup.
    pub cargo: Vec<&'static str>,
}

/// A Debian package and how to tell that it is there.
#[derive(Clone, Copy, Debug)]
pub struct Apt {
    pub package: &'static str,
    pub sign: Sign,
    /// A command that does as well on machines without Debian's packages.
    pub instead: Option<&'static str>,
}

/// How to tell that a package is there, wherever it came from.
#[derive(Clone, Copy, Debug)]
pub enum Sign {
    /// A program on the path.
    Program(&'static str),
    /// A file.
    File(&'static str),
}

impl Apt {
    pub const fn program(package: &'static str, program: &'static str) -> Self {
        Apt { package, sign: Sign::Program(program), instead: None }
    }

    pub const fn file(package: &'static str, file: &'static str) -> Self {
        Apt { package, sign: Sign::File(file), instead: None }
    }

    pub const fn or(self, command: &'static str) -> Self {
        Apt { instead: Some(command), ..self }
    }

    fn present(&self) -> bool {
        match self.sign {
            Sign::Program(program) => on_path(program),
            Sign::File(file) => Path::new(file).exists(),
        }
    }
}

impl Needs {
    /// Everything in one line, for `--list` and for the reason of a skip.
    pub fn describe(&self) -> String {
        let mut text = String::new();
        let apt: Vec<&str> = self.apt.iter().map(|need| need.package).collect();
        for (from, names) in [("apt", &apt), ("pip", &self.pip), ("npm", &self.npm), ("cargo", &self.cargo)] {
            if !names.is_empty() {
                let separator = if text.is_empty() { "" } else { "; " };
                let _ = write!(text, "{separator}{from}: {}", names.join(" "));
            }
        }
        if text.is_empty() { "nothing beyond Rust".into() } else { text }
    }

    fn is_empty(&self) -> bool {
        self.apt.is_empty() && self.pip.is_empty() && self.npm.is_empty() && self.cargo.is_empty()
    }

    /// The part that this machine does not have.
    fn missing(&self, project: &Project) -> Result<Needs, String> {
        let pins = pins(project)?;
        let installed = installed_pip(project);
        let mut pip = Vec::new();
        for name in &self.pip {
            let version = pins.get(*name).ok_or(format!("{name} has no pin in xtask/py/requirements.txt"))?;
            if installed.get(*name) != Some(version) {
                pip.push(*name);
            }
        }
        let npm = self.npm.iter().copied().filter(|need| !npm_present(project, need)).collect();
        let cargo = self.cargo.iter().copied().filter(|name| !cargo_present(project, name)).collect();
        let apt = self.apt.iter().copied().filter(|need| !need.present()).collect();
        Ok(Needs { apt, pip, npm, cargo })
    }

    /// Makes sure that everything is there; else the reason why the suite cannot run.
    pub fn ensure(&self, project: &Project, suite: &str, install: bool) -> Result<(), String> {
        let missing = self.missing(project)?;
        if missing.is_empty() {
            return Ok(());
        }
        let what = missing.describe();
        if !missing.cargo.is_empty() {
            return Err(format!("missing {what}; install with `rustup component add`"));
        }
        if !install {
            let instead = missing.apt.iter().find_map(|need| need.instead);
            let instead = instead.map(|command| format!(" (or: {command})")).unwrap_or_default();
            return Err(format!("missing {what}{instead}; `cargo xtask test --install {suite}` installs it"));
        }
        println!("suite {suite}: installing {what}");
        missing.install_apt()?;
        missing.install_pip(project)?;
        missing.install_npm(project)?;
        let still = self.missing(project)?;
        if still.is_empty() {
            Ok(())
        } else {
            Err(format!("still missing after installing: {}", still.describe()))
        }
    }

    fn install_apt(&self) -> Result<(), String> {
        static UPDATED: AtomicBool = AtomicBool::new(false);
        if self.apt.is_empty() {
            return Ok(());
        }
        let packages: Vec<&str> = self.apt.iter().map(|need| need.package).collect();
        let list = packages.join(" ");
        if !on_path("apt-get") {
            return Err(format!(
                "this machine has no apt-get; install what corresponds to {list} and run again"
            ));
        }
        let root = output_of(Command::new("id").arg("-u")).is_ok_and(|id| id.trim() == "0");
        if !root && !on_path("sudo") {
            return Err(format!("you are not root and there is no sudo; ask for: apt-get install {list}"));
        }
        let apt_get = || {
            let mut command = Command::new(if root { "apt-get" } else { "sudo" });
            if !root {
                command.args(["-n", "--preserve-env=DEBIAN_FRONTEND", "apt-get"]);
            }
            command.env("DEBIAN_FRONTEND", "noninteractive");
            command
        };
        if !UPDATED.swap(true, Ordering::Relaxed) {
            quietly(apt_get().args(["update", "-qq"]))?;
        }
        let mut command = apt_get();
        command.args(["install", "-y", "-qq", "--no-install-recommends"]).args(&packages);
        quietly(&mut command)
    }

    fn install_pip(&self, project: &Project) -> Result<(), String> {
        if self.pip.is_empty() {
            return Ok(());
        }
        let python = project.venv_python();
        let works = project.command(&python).args(["-m", "pip", "--version"]).output();
        if !works.is_ok_and(|output| output.status.success()) {
            let venv = project.target().join("venv");
            quietly(project.command("python3").args(["-m", "venv", "--clear"]).arg(venv)).map_err(
                |reason| format!("{reason}; Python 3 with its venv module is needed (Debian: python3-venv)"),
            )?;
        }
        let pins = pins(project)?;
        let mut command = project.command(python);
        command.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check"]);
        command.args(self.pip.iter().filter_map(|name| Some(format!("{name}=={}", pins.get(*name)?))));
        quietly(&mut command)
    }

    fn install_npm(&self, project: &Project) -> Result<(), String> {
        if self.npm.is_empty() {
            return Ok(());
        }
        let mut command = project.command("npm");
        command.args(["install", "--no-audit", "--no-fund", "--save-exact", "--prefix"]);
        command.arg(project.target().join("npm")).args(&self.npm);
        quietly(&mut command)
    }
}

/// name → version of xtask/py/requirements.txt.
fn pins(project: &Project) -> Result<BTreeMap<String, String>, String> {
    let file = project.root.join("xtask/py/requirements.txt");
    let text = std::fs::read_to_string(&file).map_err(|error| format!("{}: {error}", file.display()))?;
    Ok(pairs(&text))
}

/// name → version of what target/venv holds; empty where there is none.
fn installed_pip(project: &Project) -> BTreeMap<String, String> {
    let python = project.venv_python();
    if !python.is_file() {
        return BTreeMap::new();
    }
    let output =
        project.command(python).args(["-m", "pip", "freeze", "--disable-pip-version-check"]).output();
    output.map_or_else(|_| BTreeMap::new(), |output| pairs(&String::from_utf8_lossy(&output.stdout)))
}

fn pairs(lines: &str) -> BTreeMap<String, String> {
    let split =
        |line: &str| line.trim().split_once("==").map(|(name, v)| (name.to_lowercase(), v.to_owned()));
    lines.lines().filter(|line| !line.starts_with('#')).filter_map(split).collect()
}

fn npm_present(project: &Project, need: &str) -> bool {
    let Some((name, version)) = need.rsplit_once('@') else { return false };
    let file = project.target().join("npm/node_modules").join(name).join("package.json");
    let Ok(text) = std::fs::read_to_string(file) else { return false };
    serde_json::from_str::<serde_json::Value>(&text).is_ok_and(|package| package["version"] == version)
}

fn cargo_present(project: &Project, subcommand: &str) -> bool {
    let output = project.cargo().args([subcommand, "--version"]).output();
    output.is_ok_and(|output| output.status.success())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pins_are_read() {
        let pins = pairs("# comment==1\nnumpy==2.4.6\n\nvqf==2.1.2\n");
        assert_eq!(pins.get("numpy").map(String::as_str), Some("2.4.6"));
        assert_eq!(pins.len(), 2);
    }

    #[test]
    fn a_missing_package_is_named_with_the_command_that_installs_it() {
        let needs =
            Needs { apt: vec![Apt::program("no-such-package", "no-such-program-here")], ..Needs::default() };
        let reason = needs.ensure(&Project::here(), "device", false).expect_err("it is not there");
        assert!(reason.contains("no-such-package") && reason.contains("--install device"), "{reason}");
    }

    #[test]
    fn a_package_that_is_there_is_not_installed_again() {
        let needs = Needs { apt: vec![Apt::file("root-folder", "/")], ..Needs::default() };
        assert_eq!(needs.ensure(&Project::here(), "device", false), Ok(()));
    }
}
