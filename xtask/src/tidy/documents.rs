//! Rules on documents: the map is complete, both languages say the same, links lead somewhere.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use crate::project::Project;

/// ARCHITECTURE.md names every folder in crates/.
pub fn architecture(project: &Project) -> Result<Vec<String>, String> {
    let map = read(project, Path::new("ARCHITECTURE.md"))?;
    let names: BTreeSet<String> = project
        .tracked_files()?
        .iter()
        .filter_map(|file| file.strip_prefix("crates").ok()?.iter().next()?.to_str().map(str::to_owned))
        .collect();
    Ok(names
        .into_iter()
        .filter(|name| !map.contains(name.as_str()))
        .map(|name| format!("ARCHITECTURE.md does not say what crates/{name} is"))
        .collect())
}

/// README.md and README.ja.md, docs/en and docs/ja: the same headings, commands and files.
pub fn languages(project: &Project) -> Result<Vec<String>, String> {
    let files = project.tracked_files()?;
    let mut pairs = vec![(PathBuf::from("README.md"), PathBuf::from("README.ja.md"))];
    let mut complaints = Vec::new();
    for (here, there) in [("en", "ja"), ("ja", "en")] {
        let folder = Path::new("docs").join(here);
        for file in files.iter().filter_map(|file| file.strip_prefix(&folder).ok()) {
            let (own, other) = (folder.join(file), Path::new("docs").join(there).join(file));
            if !files.contains(&other) {
                complaints.push(format!("{} is there and {} is not", own.display(), other.display()));
            } else if here == "en" && own.extension().is_some_and(|ending| ending == "md") {
                pairs.push((own, other));
            }
        }
    }
    for (english, japanese) in pairs {
        let one = Outline::of(&read(project, &english)?);
        let other = Outline::of(&read(project, &japanese)?);
        if let Some(difference) = one.difference(&other) {
            complaints.push(format!("{} and {}: {difference}", english.display(), japanese.display()));
        }
    }
    Ok(complaints)
}

/// Every relative link of a Markdown document.
pub fn links(project: &Project) -> Result<Vec<String>, String> {
    let mut complaints = Vec::new();
    for file in project.tracked_files()? {
        if file.extension().is_none_or(|ending| ending != "md") {
            continue;
        }
        let folder = project.root.join(file.parent().unwrap_or(Path::new("")));
        for link in relative_links(&read(project, &file)?) {
            if !folder.join(&link).exists() {
                complaints.push(format!("{}: {link} does not exist", file.display()));
            }
        }
    }
    Ok(complaints)
}

fn read(project: &Project, file: &Path) -> Result<String, String> {
    std::fs::read_to_string(project.root.join(file)).map_err(|error| format!("{}: {error}", file.display()))
}

/// Targets of `[text](target)` outside code that name a file here.
fn relative_links(text: &str) -> Vec<String> {
    let mut found = Vec::new();
    let mut in_code = false;
    for line in text.lines() {
        if line.trim_start().starts_with("```") {
            in_code = !in_code;
        }
        if in_code {
            continue;
        }
        // Odd pieces of a split at backquotes are code.
        for piece in line.split('`').step_by(2).flat_map(|prose| prose.split("](").skip(1)) {
            let target = piece.split(')').next().unwrap_or_default();
            let target = target.split('#').next().unwrap_or_default();
            if !target.is_empty() && !target.contains(':') {
                found.push(target.to_owned());
            }
        }
    }
    found
}

/// What two languages of one document share.
#[derive(Debug, PartialEq)]
struct Outline {
    /// Levels of the headings in their order.
    levels: Vec<usize>,
    /// Lines of shell code without their comments.
    commands: Vec<String>,
}

impl Outline {
    fn of(text: &str) -> Self {
        let (mut levels, mut commands) = (Vec::new(), Vec::new());
        let mut fence: Option<&str> = None;
        for line in text.lines() {
            if let Some(language) = line.trim_start().strip_prefix("```") {
                fence = if fence.is_some() { None } else { Some(language.trim()) };
            } else if let Some(language) = fence {
                let command = line.split(" #").next().unwrap_or_default().trim();
                let shell = ["sh", "bash", "console", "powershell"].contains(&language);
                if shell && !command.is_empty() && !command.starts_with('#') {
                    commands.push(command.to_owned());
                }
            } else if line.starts_with('#') {
                levels.push(line.chars().take_while(|c| *c == '#').count());
            }
        }
        Outline { levels, commands }
    }

    fn difference(&self, other: &Outline) -> Option<String> {
        if self.levels != other.levels {
            return Some(format!("headings of levels {:?} and {:?}", self.levels, other.levels));
        }
        let longest = self.commands.len().max(other.commands.len());
        (0..longest).map(|i| (self.commands.get(i), other.commands.get(i))).find(|(a, b)| a != b).map(
            |(a, b)| {
                let text = |command: Option<&String>| command.map_or("nothing".into(), |c| format!("`{c}`"));
                format!("the commands {} and {}", text(a), text(b))
            },
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ENGLISH: &str = "# Shisei\n## Use\n```sh\n# first\ncargo run -- orient a.csv # writes\n```\n";

    #[test]
    fn the_same_document_in_two_languages_agrees() {
        let japanese = "# 姿勢\n## 使い方\n```sh\n# 最初\ncargo run -- orient a.csv # 書きます\n```\n";
        assert_eq!(Outline::of(ENGLISH).difference(&Outline::of(japanese)), None);
    }

    #[test]
    fn a_command_that_differs_is_named() {
        let japanese = "# 姿勢\n## 使い方\n```sh\ncargo run -- info a.csv\n```\n";
        let difference = Outline::of(ENGLISH).difference(&Outline::of(japanese)).expect("they differ");
        assert!(difference.contains("orient") && difference.contains("info"), "{difference}");
    }

    #[test]
    fn a_missing_heading_is_noticed() {
        let japanese = "# 姿勢\n```sh\ncargo run -- orient a.csv\n```\n";
        assert!(
            Outline::of(ENGLISH).difference(&Outline::of(japanese)).is_some_and(|d| d.contains("[1, 2]"))
        );
    }

    #[test]
    fn links_to_files_are_found_and_others_are_not() {
        let text =
            "[a](docs/a.md#x) `[b](no.md)` [c](https://example.org) [d](#e)\n```\n[f](g)\n```\n![h](i.png)";
        assert_eq!(relative_links(text), ["docs/a.md", "i.png"]);
    }
}
