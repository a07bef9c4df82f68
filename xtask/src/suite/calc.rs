//! The Calc extension in a real LibreOffice, headless.

use super::Suite;
use crate::artefacts::{OFFICE_PYTHON, calc_extension, shared_library};
use crate::needs::{Apt, Needs};
use crate::run::Run;
use crate::tally::Tally;

pub const SUITE: Suite = Suite {
    name: "calc",
    about: "the functions in LibreOffice Calc: examples, cell errors, wizard texts, the worked examples",
    needs: |_| Needs {
        apt: vec![
            Apt::program("libreoffice-calc", "soffice"),
            Apt::file("python3-uno", "/usr/lib/python3/dist-packages/uno.py"),
            Apt::file("libreoffice-dev", "/usr/lib/libreoffice/sdk/bin/unoidl-write"),
        ],
        ..Needs::default()
    },
    wants: |_| Needs::default(),
    builds: |project| shared_library(project).map(drop),
    run,
};

fn run(run: &mut Run<'_>) {
    match calc_extension(run.project, &[]) {
        Ok(extension) => {
            let mut test = run.project.command(OFFICE_PYTHON);
            test.arg("apps/calc/tests/test_calc.py").arg(extension);
            run.tests("Calc", &mut test, tally);
        }
        Err(reason) => run.fail("shisei.oxt", &reason),
    }
}

/// The scripts print a line a test.
#[allow(clippy::unnecessary_wraps)] // the signature of all readers
fn tally(output: &str) -> Option<Tally> {
    let count = |start: &str| output.lines().filter(|line| line.starts_with(start)).count();
    Some(Tally { passed: count("ok      "), failed: count("FAILED  "), skipped: count("skipped: ") })
}
