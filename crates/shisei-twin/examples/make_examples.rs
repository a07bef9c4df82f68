//! Writes the recordings in `examples/`: `cargo run -p shisei-twin --example make_examples`.

use std::path::Path;

fn main() -> std::io::Result<()> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    for file in shisei_twin::recordings::files() {
        std::fs::write(folder.join(file.name), file.text)?;
        println!("examples/{}", file.name);
    }
    Ok(())
}
