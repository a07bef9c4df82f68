//! `cargo xtask bench live`: the hub under the load of a large laboratory.

use crate::project::Project;
use crate::run::must;

/// Prints the figures; fails where they are worse than promised.
pub fn command(project: &Project) -> Result<(), String> {
    must(project.cargo().args(["run", "--quiet", "--release", "-p", "shisei-hub", "--example", "load"]))
}
