//! Which crate may use which: the list of ARCHITECTURE.md, held against `cargo metadata`.

use serde_json::Value;

use crate::project::Project;
use crate::run::output_of;

/// A crate of ours and the crates of ours that it may use.
type Allowed = (&'static str, &'static [&'static str]);

/// What a door may use; no door uses another door.
const DOOR: &[&str] = &["core", "wide", "functions", "record", "report"];

/// Names without their `shisei-`. A new crate gets a line here.
const ALLOWED: &[Allowed] = &[
    ("core", &[]),
    ("wide", &["core"]),
    ("functions", &["core", "wide"]),
    ("record", &["core"]),
    ("wire", &["core"]),
    ("report", &["core", "record"]),
    ("device", &["core", "wire"]),
    ("hub", &["core", "wire", "record"]),
    ("twin", &["core", "wire", "device", "record"]),
    ("digest", &["core", "functions", "wire"]),
    ("cli", &["core", "wide", "functions", "record", "report", "wire", "device", "hub", "twin"]),
    ("capi", DOOR),
    ("excel", DOOR),
    ("python", DOOR),
    ("wasm", DOOR),
    ("xtask", &["core", "functions", "record", "report", "digest", "twin"]),
];

/// Tests may take motion with known truth from the simulator, and the digest.
const ALLOWED_IN_TESTS: &[&str] = &["twin", "digest"];

/// Runtimes for asynchronous code, and the crates that may hold them.
const ASYNC: &[&str] = &["tokio", "async-std", "smol"];
const ASYNC_CRATES: &[&str] = &["hub", "cli"];

pub fn check(project: &Project) -> Result<Vec<String>, String> {
    let json =
        output_of(project.cargo().args(["metadata", "--format-version", "1", "--no-deps", "--offline"]))?;
    let metadata: Value = serde_json::from_str(&json).map_err(|error| format!("cargo metadata: {error}"))?;
    let packages = metadata["packages"].as_array().ok_or("cargo metadata lists no packages")?;
    Ok(packages.iter().flat_map(complaints).collect())
}

fn complaints(package: &Value) -> Vec<String> {
    let full_name = package["name"].as_str().unwrap_or_default();
    let name = short(full_name);
    let Some((_, allowed)) = ALLOWED.iter().find(|(known, _)| *known == name) else {
        return vec![format!("{full_name}: say in xtask/src/tidy/dependencies.rs what it may use")];
    };
    let mut lines = Vec::new();
    for dependency in package["dependencies"].as_array().into_iter().flatten() {
        let used_full = dependency["name"].as_str().unwrap_or_default();
        let used = short(used_full);
        let ours = dependency["path"].is_string();
        let test_only = dependency["kind"] == "dev";
        let fine = allowed.contains(&used) || (test_only && ALLOWED_IN_TESTS.contains(&used));
        if ours && !fine {
            lines.push(format!("{full_name} may not use {used_full}"));
        }
        if name == "core" && !ours && !test_only && used_full != "libm" {
            lines.push(format!("{full_name} may use libm and nothing else, not {used_full}"));
        }
        if ASYNC.contains(&used_full) && !test_only && !ASYNC_CRATES.contains(&name) {
            lines.push(format!("{full_name} may not use {used_full}: asynchronous code lives in shisei-hub"));
        }
    }
    lines
}

fn short(name: &str) -> &str {
    name.strip_prefix("shisei-").unwrap_or(name)
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn package(name: &str, dependency: &str, path: bool, kind: Option<&str>) -> Vec<String> {
        let path = if path { json!("somewhere") } else { Value::Null };
        complaints(&json!({
            "name": name,
            "dependencies": [{"name": dependency, "path": path, "kind": kind}],
        }))
    }

    #[test]
    fn what_is_allowed_passes() {
        assert!(package("shisei-record", "shisei-core", true, None).is_empty());
        assert!(package("shisei-record", "shisei-twin", true, Some("dev")).is_empty());
        assert!(package("shisei-core", "libm", false, None).is_empty());
        assert!(package("shisei-core", "proptest", false, Some("dev")).is_empty());
        assert!(package("shisei-hub", "tokio", false, None).is_empty());
    }

    #[test]
    fn what_is_not_allowed_is_named() {
        assert_eq!(
            package("shisei-core", "shisei-record", true, None),
            ["shisei-core may not use shisei-record"]
        );
        assert_eq!(package("shisei-record", "shisei-twin", true, None).len(), 1);
        assert_eq!(package("shisei-excel", "shisei-capi", true, None).len(), 1);
        assert_eq!(package("shisei-core", "nalgebra", false, None).len(), 1);
        assert_eq!(package("shisei-record", "tokio", false, None).len(), 1);
        assert_eq!(package("shisei-news", "shisei-core", true, None).len(), 1);
    }
}
