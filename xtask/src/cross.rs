//! Building for another target: with the active toolchain where it has the target's standard library, else with
//! Debian's compiler and the library's source.

use std::path::PathBuf;
use std::process::Command;

use crate::needs::{Apt, Needs};
use crate::project::Project;

/// A target and what differs about it.
#[derive(Clone, Copy, Debug)]
pub struct Target {
    pub triple: &'static str,
    /// The parts of the library to build from source.
    build_std: &'static str,
    /// The linker; LLVM's under the name by which it knows its job.
    linker: &'static str,
    /// Debian's package of the linker.
    linker_package: &'static str,
    /// What gives the active toolchain the target.
    instead: &'static str,
}

pub const CORTEX_M4F: Target = Target {
    triple: "thumbv7em-none-eabihf",
    build_std: "core,alloc",
    linker: "ld.lld",
    linker_package: "lld",
    instead: "rustup target add thumbv7em-none-eabihf",
};

pub const WASM32: Target = Target {
    triple: "wasm32-unknown-unknown",
    build_std: "std,panic_abort",
    linker: "wasm-ld",
    linker_package: "lld",
    instead: "rustup target add wasm32-unknown-unknown",
};

/// With unwinding, so that a fault of ours ends as an error in a cell and not as the end of Excel.
pub const WINDOWS: Target = Target {
    triple: "x86_64-pc-windows-gnu",
    build_std: "std,panic_unwind",
    linker: "x86_64-w64-mingw32-gcc",
    linker_package: "gcc-mingw-w64-x86-64",
    instead: "rustup target add x86_64-pc-windows-gnu",
};

impl Target {
    /// Nothing where the active toolchain has the target; else Debian's packages.
    pub fn needs(&self, project: &Project) -> Needs {
        if self.in_active_toolchain(project) {
            return Needs::default();
        }
        Needs {
            apt: vec![
                Apt::file("rustc-web", "/usr/share/doc/rustc-web").or(self.instead),
                Apt::file("cargo-web", "/usr/share/doc/cargo-web"),
                Apt::file("rust-web-src", "/usr/share/doc/rust-web-src"),
                Apt::program(self.linker_package, self.linker),
            ],
            ..Needs::default()
        }
    }

    /// `cargo build --release --target …`, for the caller to add what to build. Firmware is always built whole, for
    /// its size and its instructions are held to limits.
    pub fn cargo_build(&self, project: &Project) -> Command {
        self.cargo(project, "build")
    }

    /// The same with another word than `build` (`rustc` takes options for one product).
    pub fn cargo(&self, project: &Project, word: &str) -> Command {
        let own = self.in_active_toolchain(project);
        let mut cargo = if own { project.cargo() } else { project.command("/usr/bin/cargo") };
        let release = if self.triple == CORTEX_M4F.triple { &["--release"] } else { project.release() };
        cargo.args([word, "--quiet", "--target", self.triple, "--target-dir"]);
        cargo.arg(folder(project)).args(release);
        if !own {
            let name = self.triple.to_uppercase().replace('-', "_");
            // Ours would send Debian's cargo to rustup's compiler.
            for ours in ["CARGO", "RUSTUP_TOOLCHAIN", "LD_LIBRARY_PATH"] {
                cargo.env_remove(ours);
            }
            cargo
                .arg(format!("-Zbuild-std={}", self.build_std))
                .env("RUSTC", "/usr/bin/rustc")
                .env("RUSTC_BOOTSTRAP", "1")
                .env(format!("CARGO_TARGET_{name}_LINKER"), self.linker);
        }
        cargo
    }

    /// Where the products of a release build are.
    pub fn products(&self, project: &Project) -> PathBuf {
        folder(project).join(self.triple).join("release")
    }

    fn in_active_toolchain(&self, project: &Project) -> bool {
        let Ok(output) = project.command("rustc").args(["--print", "sysroot"]).output() else { return false };
        let sysroot = PathBuf::from(String::from_utf8_lossy(&output.stdout).trim());
        sysroot.join("lib/rustlib").join(self.triple).join("lib").is_dir()
    }
}

/// Apart from the host's products, for another compiler may have made them.
fn folder(project: &Project) -> PathBuf {
    project.target().join("cross")
}
