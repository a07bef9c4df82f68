//! The worksheet functions as C symbols, as `include/shisei.h` describes them.
//!
//! [`exports`] is written from the table of `shisei-functions`; [`abi`] is what every symbol does: borrow the
//! caller's arrays, call the table, copy the result, never unwind. No formula lives here.
#![allow(unsafe_code)] // a C interface reads and writes the caller's pointers

mod abi;
#[rustfmt::skip]
mod exports;
