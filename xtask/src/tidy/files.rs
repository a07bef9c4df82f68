//! Rules on the text of single files.

use std::path::Path;

use crate::project::Project;

const MAX_LINES: usize = 800;

/// Endings of files that are written by hand as code.
const CODE: &[&str] = &[
    "rs", "py", "ts", "tsx", "js", "mjs", "html", "css", "cs", "c", "h", "cpp", "hpp", "ino", "sh", "ps1",
    "toml", "bas",
];

/// Paths that only one machine has. Written in two halves so that this file does not break its own rule.
const PLACES: &[&str] = &[
    concat!("/wo", "rk/"),
    concat!("/ro", "ot/"),
    concat!("/fa", "rm/"),
    concat!("/ho", "me/"),
    concat!("/tmp/", "bash"),
    concat!("C:\\Us", "ers\\"),
    concat!("\"resolved\": \"ht", "tp"),
];

/// Marks of something left for later, in halves too.
const LEFTOVERS: &[&str] = &[
    concat!("TO", "DO"),
    concat!("FIX", "ME"),
    concat!("XX", "X:"),
    concat!("to", "do!("),
    concat!("unimple", "mented!("),
];

/// Extensions whose text may hold the words above for a good reason (data, published logs).
const DATA: &[&str] = &["csv", "tsv", "json", "parquet", "png", "svg", "lock"];

pub fn length(project: &Project) -> Result<Vec<String>, String> {
    each(project, |file, text| {
        let count = text.lines().count();
        let written_by_hand = CODE.contains(&extension(file)) && !is_generated(text);
        let line = format!("{}: {count} lines; split it by topic", file.display());
        if written_by_hand && count > MAX_LINES { vec![line] } else { Vec::new() }
    })
}

pub fn leftovers(project: &Project) -> Result<Vec<String>, String> {
    each(
        project,
        |file, text| if DATA.contains(&extension(file)) { Vec::new() } else { find(file, text, LEFTOVERS) },
    )
}

pub fn places(project: &Project) -> Result<Vec<String>, String> {
    each(project, |file, text| find(file, text, PLACES))
}

/// Generated files say so, and where from, in their first lines (a VBA module's name must stand before it, an XML
/// declaration too).
fn is_generated(text: &str) -> bool {
    text.lines().take(3).any(|line| line.to_lowercase().contains("generated"))
}

fn find(file: &Path, text: &str, words: &[&str]) -> Vec<String> {
    let numbered = text.lines().enumerate();
    let hit = |(number, line): (usize, &str)| {
        let word = words.iter().find(|word| line.contains(**word))?;
        Some(format!("{}:{}: {word}", file.display(), number + 1))
    };
    numbered.filter_map(hit).collect()
}

fn extension(file: &Path) -> &str {
    file.extension().and_then(|ending| ending.to_str()).unwrap_or_default()
}

/// Applies a rule to every text file under version control.
fn each(project: &Project, rule: impl Fn(&Path, &str) -> Vec<String>) -> Result<Vec<String>, String> {
    let mut lines = Vec::new();
    for file in project.tracked_files()? {
        let bytes = std::fs::read(project.root.join(&file))
            .map_err(|error| format!("{}: {error}", file.display()))?;
        if let Ok(text) = String::from_utf8(bytes) {
            lines.extend(rule(&file, &text));
        }
    }
    Ok(lines)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_is_found_with_its_line() {
        let text = format!("fine\nsee {}x\n", PLACES[0]);
        assert_eq!(find(Path::new("a.md"), &text, PLACES), [format!("a.md:2: {}", PLACES[0])]);
        assert!(find(Path::new("a.md"), "docs/work\n", PLACES).is_empty());
    }

    #[test]
    fn what_is_left_undone_is_found() {
        let text = format!("fn f() {{ {}) }}", LEFTOVERS[3]);
        assert_eq!(find(Path::new("a.rs"), &text, LEFTOVERS).len(), 1);
    }

    #[test]
    fn a_generated_file_says_so_in_its_first_lines() {
        assert!(is_generated("/* Generated from crates/shisei-functions; do not edit. */\n"));
        assert!(is_generated("Attribute VB_Name = \"shisei\"\r\n' Generated from the table.\r\n"));
        assert!(!is_generated("//! A module.\n\nuse std::fs;\n// generated\n"));
    }
}
