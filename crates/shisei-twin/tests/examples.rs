//! The committed recordings are what the generator writes, and what their users rely on.

use std::path::{Path, PathBuf};

use shisei_twin::recordings;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples")
}

#[test]
fn committed_files_are_what_the_generator_writes() {
    for file in recordings::files() {
        let committed = std::fs::read_to_string(folder().join(file.name)).unwrap_or_default();
        assert!(
            committed.replace("\r\n", "\n") == file.text,
            "examples/{} is stale; run: cargo run -p shisei-twin --example make_examples",
            file.name
        );
    }
}
