//! The one table of worksheet functions.
//!
//! [`FUNCTIONS`] lists every function once: its names, help in English and Japanese, arguments, result, an
//! example from an independent reference, and the code. Doors (C, Excel, Calc, Python, the command line,
//! the browser) read it; none of them describes a function a second time. A function's Rust argument types
//! are its schema: the shapes come from the types, so they cannot disagree with the code.
#![warn(missing_docs)]

mod error;
mod example;
#[rustfmt::skip]
mod examples;
mod function;
mod input;
pub mod last_error;
mod output;
mod table;
mod text;
mod value;

pub use error::{Error, Result};
pub use example::{Example, ExampleArg, Expected};
pub use function::{Arg, Function, Group, ReturnDoc};
pub use input::{CalibParameters, FiniteVec3, FromInput, RawQuat, Series, SixColumns, UnitQuat};
pub use output::{IntoOutput, Output, ReturnShape, SameAsFirst, Table};
pub use shisei_core::Lang;
pub use shisei_core::error::Kind;
pub use table::FUNCTIONS;
pub use text::Text;
pub use value::{Input, Range, Shape};

/// The version of shisei, one for all crates and doors.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

/// The function with this worksheet name or exported name; case does not matter, as in a spreadsheet.
pub fn find(name: &str) -> Option<&'static Function> {
    FUNCTIONS.iter().find(|f| f.name.eq_ignore_ascii_case(name) || f.export.eq_ignore_ascii_case(name))
}
