//! The digest runs over every file of the core that has public functions.

use std::path::Path;

use crate::project::Project;

/// Files of the core without numbers of their own.
const WITHOUT_NUMBERS: &[&str] = &["lib", "error", "filter/mod"];

const CORE: &str = "crates/shisei-core/src";

pub fn check(project: &Project) -> Result<Vec<String>, String> {
    let mut complaints = Vec::new();
    for file in project.tracked_files()? {
        if !file.starts_with(CORE) || file.extension().is_none_or(|ending| ending != "rs") {
            continue;
        }
        let text = std::fs::read_to_string(project.root.join(&file)).map_err(|error| error.to_string())?;
        let topics: Vec<&str> = shisei_digest::TOPICS.iter().map(|topic| topic.name).collect();
        complaints.extend(complaint(&file, &text, &topics));
    }
    Ok(complaints)
}

fn complaint(file: &Path, text: &str, topics: &[&str]) -> Option<String> {
    let name = file.strip_prefix(CORE).ok()?.with_extension("").to_string_lossy().replace('\\', "/");
    let code = text.split("#[cfg(test)]").next().unwrap_or_default();
    let has_functions = code.lines().any(|line| {
        let line = line.trim_start();
        ["pub fn ", "pub const fn ", "fn update("].iter().any(|start| line.starts_with(start))
    });
    let is_test = name.split('/').any(|part| part == "tests");
    let known = WITHOUT_NUMBERS.iter().chain(topics).any(|known| *known == name);
    let missing = has_functions && !is_test && !known;
    missing.then(|| format!("{}: add a topic `{name}` to crates/shisei-digest", file.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_with_functions_needs_a_topic() {
        let file = Path::new("crates/shisei-core/src/earth/rate.rs");
        assert!(complaint(file, "pub fn rate() {}", &["math", "rate"]).is_some());
        assert!(complaint(file, "pub fn rate() {}", &["math", "earth/rate"]).is_none());
        assert!(complaint(file, "const A: f64 = 1.0;", &["math"]).is_none());
        assert!(complaint(file, "#[cfg(test)]\nmod tests { pub fn helper() {} }", &["math"]).is_none());
    }
}
