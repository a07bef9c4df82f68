//! What `cargo xtask` does, one topic a file.

pub mod artefacts;
pub mod bench;
pub mod cross;
pub mod digests;
pub mod dist;
pub mod elf;
pub mod firmware;
pub mod fuzz;
pub mod installer;
pub mod logic;
pub mod needs;
pub mod programs;
pub mod project;
pub mod run;
pub mod soak;
pub mod suite;
pub mod tally;
pub mod tidy;
pub mod virtual_bluetooth;
pub mod wine;
pub mod workbooks;
