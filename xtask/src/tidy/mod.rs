//! `cargo xtask tidy`: what no compiler holds us to.

mod dependencies;
mod digest;
mod documents;
mod files;

use crate::project::Project;

/// One rule: its name and what breaks it, one line each.
type Rule = (&'static str, fn(&Project) -> Result<Vec<String>, String>);

const RULES: &[Rule] = &[
    ("crates depend on what ARCHITECTURE.md allows", dependencies::check),
    ("ARCHITECTURE.md names every crate", documents::architecture),
    ("the READMEs and the manuals say the same in both languages", documents::languages),
    ("the digest covers the core", digest::check),
    ("links in documents lead somewhere", documents::links),
    ("no file is longer than 800 lines", files::length),
    ("nothing is left undone", files::leftovers),
    ("no path of one machine, no address of a download", files::places),
];

/// Name and outcome of every rule.
pub fn check(project: &Project) -> Vec<(&'static str, Result<String, String>)> {
    RULES.iter().map(|(name, rule)| (*name, judge(rule(project)))).collect()
}

fn judge(complaints: Result<Vec<String>, String>) -> Result<String, String> {
    match complaints {
        Ok(lines) if lines.is_empty() => Ok(String::new()),
        Ok(lines) => Err(format!("\n  {}", lines.join("\n  "))),
        Err(reason) => Err(reason),
    }
}
