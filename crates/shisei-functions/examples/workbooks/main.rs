//! Writes the sample workbooks: `cargo run -p shisei-functions --example workbooks -- FOLDER`.
//!
//! The two worked examples of the published add-in on the recordings of `examples/`, and a tour of all functions.
//! Every formula has its real value beside it, so that the workbooks show results before a first calculation.
//! `formulas.json` lists the formulas for the OpenDocument version.

mod axes;
mod book;
mod pelvis;
mod six_face;
mod tour;

use book::Book;
use std::path::PathBuf;

type Done = Result<(), Box<dyn std::error::Error>>;

fn main() -> Done {
    let folder = PathBuf::from(std::env::args().nth(1).ok_or("workbooks FOLDER")?);
    std::fs::create_dir_all(&folder)?;
    let mut formulas = Vec::new();
    for (name, fill) in [
        ("shisei-pelvis", pelvis::fill as fn(&mut Book) -> Done),
        ("shisei-six-face", six_face::fill),
        ("shisei-tour", tour::fill),
    ] {
        let mut book = Book::new(name);
        fill(&mut book)?;
        formulas.extend(book.save(&folder)?);
        println!("wrote {}", folder.join(format!("{name}.xlsx")).display());
    }
    std::fs::write(folder.join("formulas.json"), serde_json::to_string_pretty(&formulas)?)?;
    Ok(())
}
