//! WebAssembly: the same bits as the host under Node, and the JavaScript package as users get it, there and in Chromium.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use super::Suite;
use crate::artefacts::{npm_folder, npm_package};
use crate::cross::WASM32;
use crate::digests;
use crate::needs::{Apt, Needs};
use crate::programs;
use crate::project::Project;
use crate::run::{Run, heading, must, output_within};
use crate::tally;

pub const SUITE: Suite = Suite {
    name: "wasm",
    about: "the core's digest on wasm32; the JavaScript package under Node and in a headless Chromium, and its types",
    needs: |project| {
        let mut needs = WASM32.needs(project);
        needs.apt.extend([
            Apt::program("nodejs", "node"),
            Apt::program("npm", "npm"),
            Apt::program("chromium", "chromium"),
        ]);
        needs.npm.push("typescript@7.0.2");
        needs
    },
    wants: |_| Needs::default(),
    builds: |project| {
        digest(project)?;
        npm_folder(project).map(drop)
    },
    run,
};

const TESTS: &str = "crates/shisei-wasm/tests";

/// Files that use the package's types, and what else TypeScript is to know.
const TYPES: [(&str, &str, &str); 2] = [
    ("the package's types in Node", "types.mts", "es2022"),
    ("the package's types in a browser", "types-browser.mts", "es2022,esnext.disposable,dom"),
];

fn run(run: &mut Run<'_>) {
    heading("digest on wasm32");
    digests::compare(run, WASM32.triple, under_node(run.project));
    heading("the JavaScript package");
    let project = run.project;
    let built = npm_package(project)
        .and_then(|package| installed(project, &package))
        .and_then(|folder| Ok((folder, programs::shisei(project)?)));
    let (package, shisei) = match built {
        Ok(built) => built,
        Err(reason) => return run.fail("the JavaScript package", &reason),
    };
    let node = |script: &str| {
        let mut node = project.command("node");
        node.env("SHISEI_PACKAGE", &package).env("SHISEI", &shisei);
        if script.contains(".test.") {
            node.args(["--test", "--test-reporter=spec"]);
        }
        node.arg(format!("{TESTS}/{script}"));
        node
    };
    run.tests("the package under Node", &mut node("package.test.mjs"), tally::node);
    run.tests("the package in Chromium", &mut node("browser.mjs"), tally::closing_line);
    for (name, file, library) in TYPES {
        run.step(name, &mut types(project, &package, file, library));
    }
}

fn digest(project: &Project) -> Result<(), String> {
    must(WASM32.cargo_build(project).args(["--package", "shisei-digest", "--example", "digest_wasm"]))
}

fn under_node(project: &Project) -> Result<String, String> {
    digest(project)?;
    let mut node = project.command("node");
    node.arg("xtask/js/digest.mjs").arg(WASM32.products(project).join("examples/digest_wasm.wasm"));
    output_within(&mut node, Duration::from_secs(120))
}

/// Installs the package into a folder of its own, with the files that use its types beside it; gives where it is.
fn installed(project: &Project, package: &Path) -> Result<PathBuf, String> {
    let folder = project.target().join("npm-user");
    let _ = std::fs::remove_dir_all(&folder); // an older package must not stay
    std::fs::create_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let mut npm = project.command("npm");
    npm.args(["install", "--silent", "--no-audit", "--no-fund", "--offline", "--prefix"]).arg(&folder);
    must(npm.arg(package))?;
    for (_, file, _) in TYPES {
        let types = project.root.join(TESTS).join(file);
        std::fs::copy(&types, folder.join(file)).map_err(|error| format!("{}: {error}", types.display()))?;
    }
    Ok(folder.join("node_modules/shisei"))
}

fn types(project: &Project, package: &Path, file: &str, library: &str) -> Command {
    let mut tsc = project.command("node");
    tsc.arg(project.target().join("npm/node_modules/typescript/bin/tsc"));
    tsc.args(["--noEmit", "--strict", "--exactOptionalPropertyTypes", "--target", "es2022"]);
    tsc.args(["--lib", library, "--module", "nodenext"]);
    tsc.arg(package.join("../..").join(file));
    tsc
}
