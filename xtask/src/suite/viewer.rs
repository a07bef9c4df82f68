//! What people look at, in a real browser: the report page and the live viewer; and the Unity package under Mono.

use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

use super::Suite;
use crate::needs::{Apt, Needs};
use crate::programs;
use crate::project::Project;
use crate::run::{Run, heading, must};
use crate::tally;

pub const SUITE: Suite = Suite {
    name: "viewer",
    about: "report page and live viewer in a headless Chromium, the Unity package under Mono",
    needs: |_| Needs {
        apt: vec![
            Apt::program("nodejs", "node"),
            Apt::program("npm", "npm"),
            Apt::program("chromium", "chromium"),
            Apt::program("mono-mcs", "mcs"),
            Apt::program("mono-runtime", "mono"),
        ],
        ..Needs::default()
    },
    wants: |_| Needs::default(),
    builds: |_| Ok(()),
    run,
};

const REPORT: &str = "crates/shisei-report/tests/browser";
const VIEWER: &str = "apps/viewer";
const UNITY: &str = "apps/unity";
/// The package's own code, its components, its sample and the tests.
const UNITY_CODE: [&str; 4] = ["Runtime/Stream", "Runtime", "Samples~/Live", "Tests~"];

fn run(run: &mut Run<'_>) {
    heading("pages for the browser");
    if let Err(reason) = report_pages(run.project) {
        run.fail("pages for the browser", &reason);
    } else {
        let mut check = node(run.project, REPORT, "check.mjs");
        run.tests("report page in Chromium", check.arg(pages(run.project)), tally::closing_line);
    }
    viewer(run);
    unity(run);
}

fn viewer(run: &mut Run<'_>) {
    let project = run.project;
    if let Err(reason) = must(&mut npm_ci(project, VIEWER)) {
        return run.fail("packages of the viewer", &reason);
    }
    run.step("the viewer's types", in_folder(project, "npm", VIEWER).args(["run", "--silent", "check"]));
    run.step(
        "the committed viewer is what its sources make",
        node(project, VIEWER, "build.mjs").arg("--check"),
    );
    run.tests("the viewer's parts", &mut node(project, VIEWER, "test.mjs"), tally::node);
    let shots = project.target().join("viewer-pages");
    let mut pages = node(project, VIEWER, "test/browser.mjs");
    run.tests("the viewer in Chromium, a stand-in for the hub", pages.arg(&shots), tally::closing_line);
    match programs::shisei(project) {
        Ok(program) => {
            let mut live = node(project, VIEWER, "test/live.mjs");
            live.args([program, shots]);
            run.tests("the viewer in Chromium, shisei live --demo", &mut live, tally::closing_line);
        }
        Err(reason) => run.fail("shisei", &reason),
    }
}

fn unity(run: &mut Run<'_>) {
    let project = run.project;
    run.check("the Unity package has the version of the rest", unity_version(project));
    let program = project.target().join("unity-tests.exe");
    let compiled = unity_sources(project).and_then(|sources| {
        let mut mcs = in_folder(project, "mcs", UNITY);
        mcs.args(["-langversion:7", "-warnaserror+", "-warn:4"]);
        mcs.arg(format!("-out:{}", program.display())).args(sources);
        must(&mut mcs)
    });
    if let Err(reason) = compiled {
        return run.fail("compiling the Unity package", &reason);
    }
    let mono = || {
        let mut command = project.command("mono");
        command.arg(&program);
        command
    };
    run.tests("the Unity package", &mut mono(), tally::closing_line);
    match programs::shisei(project).and_then(|shisei| Hub::start(project, &shisei)) {
        Ok(hub) => {
            run.tests("the Unity package with shisei live --demo", mono().arg(&hub.url), tally::closing_line);
        }
        Err(reason) => run.fail("shisei live --demo", &reason),
    }
}

fn report_pages(project: &Project) -> Result<(), String> {
    must(programs::example(project, "demo")?.arg(pages(project)))?;
    must(&mut npm_ci(project, REPORT))
}

fn pages(project: &Project) -> PathBuf {
    project.target().join("report-pages")
}

fn npm_ci(project: &Project, folder: &str) -> Command {
    let mut npm = in_folder(project, "npm", folder);
    npm.args(["ci", "--no-audit", "--no-fund"]);
    npm
}

fn node(project: &Project, folder: &str, script: &str) -> Command {
    let mut node = in_folder(project, "node", folder);
    node.arg(script);
    node
}

fn in_folder(project: &Project, program: &str, folder: &str) -> Command {
    let mut command = project.command(program);
    command.current_dir(project.root.join(folder));
    command
}

fn unity_sources(project: &Project) -> Result<Vec<PathBuf>, String> {
    let mut sources = Vec::new();
    for folder in UNITY_CODE {
        let folder = Path::new(folder);
        let entries = std::fs::read_dir(project.root.join(UNITY).join(folder));
        for entry in entries.map_err(|error| format!("{}: {error}", folder.display()))?.flatten() {
            let name = entry.file_name();
            if Path::new(&name).extension().is_some_and(|ending| ending == "cs") {
                sources.push(folder.join(name));
            }
        }
    }
    sources.sort();
    Ok(sources)
}

fn unity_version(project: &Project) -> Result<String, String> {
    let file = project.root.join(UNITY).join("package.json");
    let text = std::fs::read_to_string(&file).map_err(|error| format!("{}: {error}", file.display()))?;
    let package: serde_json::Value = serde_json::from_str(&text).map_err(|error| error.to_string())?;
    match package["version"].as_str() {
        Some(env!("CARGO_PKG_VERSION")) => Ok(String::new()),
        other => Err(format!("{other:?} in {UNITY}/package.json, {} elsewhere", env!("CARGO_PKG_VERSION"))),
    }
}

/// A hub with the demonstration; it ends with this.
struct Hub {
    child: Child,
    url: String,
}

impl Hub {
    fn start(project: &Project, shisei: &Path) -> Result<Self, String> {
        let mut command = project.command(shisei);
        command
            .args(["live", "--demo", "--listen", "127.0.0.1:0", "--for", "120"])
            .current_dir(project.target());
        let child = command.stdin(Stdio::null()).stdout(Stdio::piped()).spawn();
        let mut hub = Hub {
            child: child.map_err(|error| format!("{}: {error}", shisei.display()))?,
            url: String::new(),
        };
        let stdout = hub.child.stdout.take().ok_or("no standard output")?;
        BufReader::new(stdout).read_line(&mut hub.url).map_err(|error| error.to_string())?;
        hub.url = hub.url.trim().to_owned();
        if hub.url.starts_with("http://") { Ok(hub) } else { Err(format!("no address but {:?}", hub.url)) }
    }
}

impl Drop for Hub {
    fn drop(&mut self) {
        // it has ended already: as well
        let _ = self.child.kill().and_then(|()| self.child.wait());
    }
}
