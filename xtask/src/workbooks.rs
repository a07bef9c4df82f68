//! The sample workbooks.

use std::path::PathBuf;

use crate::artefacts::OFFICE_PYTHON;
use crate::programs;
use crate::project::Project;
use crate::run::must;

const NAMES: [&str; 3] = ["shisei-pelvis", "shisei-six-face", "shisei-tour"];

/// For Excel.
pub fn build(project: &Project) -> Result<Vec<PathBuf>, String> {
    let folder = project.target().join("samples");
    must(programs::example(project, "workbooks")?.arg(&folder))?;
    Ok(NAMES.iter().map(|name| folder.join(format!("{name}.xlsx"))).collect())
}

/// For Calc, from those for Excel, recalculated there.
pub fn build_ods(project: &Project, extension: &PathBuf) -> Result<Vec<PathBuf>, String> {
    let folder = project.target().join("samples");
    let mut python = project.command(OFFICE_PYTHON);
    must(python.arg("apps/calc/make_samples.py").arg(extension).arg(&folder))?;
    Ok(NAMES.iter().map(|name| folder.join(format!("{name}.ods"))).collect())
}
