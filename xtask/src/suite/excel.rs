//! The XLL and its installer on Windows, as Wine plays it.

use std::path::Path;
use std::time::Duration;

use super::Suite;
use crate::artefacts::{WindowsFiles, windows_files};
use crate::cross::WINDOWS;
use crate::installer;
use crate::needs::{Apt, Needs};
use crate::project::Project;
use crate::run::{Run, heading, must, output_within};
use crate::tally::Tally;
use crate::wine::{self, Wine};
use crate::{digests, workbooks};

pub const SUITE: Suite = Suite {
    name: "excel",
    about: "shisei.xll in a stand-in for Excel, its installer, and the core's digest, on Windows (Wine)",
    needs: |project| {
        let mut needs = WINDOWS.needs(project);
        needs.apt.extend(wine::needs());
        needs.apt.push(Apt::program("wixl", "wixl"));
        needs
    },
    wants: |_| Needs::default(),
    builds: |project| {
        windows_files(project)?;
        build_host(project)?;
        build_digest(project)
    },
    run,
};

fn run(run: &mut Run<'_>) {
    let project = run.project;
    let prepared = windows_files(project).and_then(|files| {
        let wine = Wine::fresh(project, "excel")?;
        Ok((files, wine))
    });
    let (files, wine) = match prepared {
        Ok(prepared) => prepared,
        Err(reason) => return run.fail("the Windows build", &reason),
    };
    match build_host(project) {
        Ok(()) => {
            for lang in ["en", "ja"] {
                let mut host = wine.command(project);
                host.arg(WINDOWS.products(project).join("examples/xll_host.exe"));
                host.arg(windows_path(&files.xll)).arg("1000000").env("SHISEI_LANG", lang);
                run.tests(&format!("XLL, {lang}"), &mut host, tally);
            }
        }
        Err(reason) => run.fail("the stand-in for Excel", &reason),
    }
    heading("digest on Windows");
    digests::compare(run, WINDOWS.triple, digest(project, &wine));
    heading("installer");
    installer_round_trip(run, &files);
}

/// What the door may cost beside the mathematics.
const MOST_EXTRA: f64 = 3.0;

/// The XLL against the mathematics, 1,000,000 rows; fails where the door costs more than `MOST_EXTRA` times those.
pub fn speed(project: &Project) -> Result<(), String> {
    let files = windows_files(project)?;
    build_host(project)?;
    let wine = Wine::fresh(project, "speed")?;
    let mut host = wine.command(project);
    host.arg(WINDOWS.products(project).join("examples/xll_host.exe")).arg(windows_path(&files.xll));
    let output = output_within(&mut host, Duration::from_secs(300))?;
    let line = output.lines().find(|line| line.contains("through the door"));
    let line = line.ok_or("the stand-in for Excel printed no times")?;
    println!("{line}");
    let extra = line.split_once("costs ").and_then(|(_, rest)| rest.split(' ').next()?.parse::<f64>().ok());
    match extra {
        Some(extra) if extra <= MOST_EXTRA => Ok(()),
        _ => Err(format!("the limit is {MOST_EXTRA} × the maths")),
    }
}

fn build_host(project: &Project) -> Result<(), String> {
    let definition = project.root.join("crates/shisei-excel/examples/xll_host.def");
    let mut build = WINDOWS.cargo(project, "rustc");
    build.args(["--package", "shisei-excel", "--example", "xll_host", "--", "-C"]);
    must(build.arg(format!("link-arg={}", definition.display())))?;
    wine::stand_in(project, &WINDOWS.products(project).join("examples"))
}

/// Wine shows the host's root as drive Z.
fn windows_path(path: &Path) -> String {
    format!("Z:{}", path.display().to_string().replace('/', "\\"))
}

fn build_digest(project: &Project) -> Result<(), String> {
    must(WINDOWS.cargo_build(project).args(["--package", "shisei-digest", "--example", "digest"]))
}

fn digest(project: &Project, wine: &Wine) -> Result<String, String> {
    build_digest(project)?;
    let mut program = wine.command(project);
    program.arg(WINDOWS.products(project).join("examples/digest.exe"));
    output_within(&mut program, Duration::from_secs(300))
}

fn installer_round_trip(run: &mut Run<'_>, files: &WindowsFiles) {
    let project = run.project;
    let built = workbooks::build(project).and_then(|samples| installer::build(project, files, &samples));
    match built {
        Ok(msi) => {
            for (name, outcome) in installer::round_trip(project, &msi) {
                run.check(&name, outcome);
            }
        }
        Err(reason) => run.fail("the installer", &reason),
    }
}

#[allow(clippy::unnecessary_wraps)] // the signature of all readers
fn tally(output: &str) -> Option<Tally> {
    let count = |start: &str| output.lines().filter(|line| line.trim_end().starts_with(start)).count();
    Some(Tally { passed: count("ok      "), failed: count("FAILED  "), skipped: 0 })
}
