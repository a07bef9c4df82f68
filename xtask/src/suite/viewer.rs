//! What people look at, in a real browser: the report page.

use super::Suite;
use crate::needs::{Apt, Needs};
use crate::project::Project;
use crate::run::{Run, heading, must};
use crate::tally;

pub const SUITE: Suite = Suite {
    name: "viewer",
    about: "the report page in a headless Chromium: both languages, plots, scrubbing, keyboard",
    needs: |_| Needs {
        apt: vec![
            Apt::program("nodejs", "node"),
            Apt::program("npm", "npm"),
            Apt::program("chromium", "chromium"),
        ],
        ..Needs::default()
    },
    wants: |_| Needs::default(),
    run,
};

fn run(run: &mut Run<'_>) {
    heading("pages for the browser");
    if let Err(reason) = prepare(run.project) {
        run.fail("pages for the browser", &reason);
        return;
    }
    let mut check = run.project.command("node");
    check.arg("check.mjs").arg(pages(run.project)).current_dir(browser(run.project));
    run.tests("report page in Chromium", &mut check, tally::closing_line);
}

fn prepare(project: &Project) -> Result<(), String> {
    let mut demo = project.cargo();
    demo.args(["run", "--quiet", "--package", "shisei-report", "--example", "demo", "--"]);
    must(demo.arg(pages(project)))?;
    must(project.command("npm").args(["ci", "--no-audit", "--no-fund"]).current_dir(browser(project)))
}

fn pages(project: &Project) -> std::path::PathBuf {
    project.target().join("report-pages")
}

fn browser(project: &Project) -> std::path::PathBuf {
    project.root.join("crates/shisei-report/tests/browser")
}
