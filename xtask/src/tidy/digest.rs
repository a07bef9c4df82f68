//! The digest runs over every file of the core that has public functions.

use std::path::Path;

use crate::project::Project;

/// Files of the core without numbers of their own.
const WITHOUT_NUMBERS: &[&str] = &["lib", "error", "mod"];

pub fn check(project: &Project) -> Result<Vec<String>, String> {
    let mut complaints = Vec::new();
    for file in project.tracked_files()? {
        if !file.starts_with("crates/shisei-core/src") || file.extension().is_none_or(|ending| ending != "rs")
        {
            continue;
        }
        let text = std::fs::read_to_string(project.root.join(&file)).map_err(|error| error.to_string())?;
        let topics: Vec<&str> = shisei_digest::TOPICS.iter().map(|topic| topic.name).collect();
        complaints.extend(complaint(&file, &text, &topics));
    }
    Ok(complaints)
}

fn complaint(file: &Path, text: &str, topics: &[&str]) -> Option<String> {
    let name = file.file_stem()?.to_str()?;
    let code = text.split("#[cfg(test)]").next().unwrap_or_default();
    let has_functions = code.lines().any(|line| {
        let line = line.trim_start();
        ["pub fn ", "pub const fn ", "fn update("].iter().any(|start| line.starts_with(start))
    });
    let is_test = file.components().any(|part| part.as_os_str() == "tests") || name == "tests";
    let missing = has_functions && !is_test && !WITHOUT_NUMBERS.contains(&name) && !topics.contains(&name);
    missing.then(|| format!("{}: add a topic `{name}` to crates/shisei-digest", file.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_with_functions_needs_a_topic() {
        let file = Path::new("crates/shisei-core/src/earth.rs");
        assert!(complaint(file, "pub fn rate() {}", &["math"]).is_some());
        assert!(complaint(file, "pub fn rate() {}", &["math", "earth"]).is_none());
        assert!(complaint(file, "const A: f64 = 1.0;", &["math"]).is_none());
        assert!(complaint(file, "#[cfg(test)]\nmod tests { pub fn helper() {} }", &["math"]).is_none());
    }
}
