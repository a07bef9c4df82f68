//! Recordings of inertial sensors: bytes in, values out.
//!
//! [`open`] turns the bytes of a file (or of an accelerometer file and a gyroscope file given together) into
//! a [`Recording`] in m/s², rad/s and seconds, and keeps a note of everything it decided; [`inspect`] tells
//! what a file holds even where it is no use as a recording. Nothing here opens a file, waits or prints.
//!
//! The way of a text file: `encoding` → `sheet` (separator, header, units row) → `dialect` and `names` (what
//! each column is) → `plan` (which columns are read) → `body` (numbers) → `clock` (time) → `settle` (units,
//! gravity, axes, clipping).

mod blocks;
mod body;
pub mod calibration;
mod clock;
pub mod dialect;
mod encoding;
pub mod error;
mod error_text;
mod judge;
mod large_pages;
#[cfg(feature = "mcap")]
pub mod mcap_records;
mod merge;
pub mod motive;
pub mod names;
mod number;
mod open;
pub mod options;
#[cfg(feature = "parquet")]
mod parquet_pages;
#[cfg(feature = "parquet")]
mod parquet_read;
#[cfg(feature = "parquet")]
mod parquet_thrift;
#[cfg(feature = "parquet")]
pub mod parquet_write;
pub mod plan;
pub mod recording;
mod rows;
mod settle;
mod shape;
pub mod sheet;
pub mod spresense_stream;
pub mod stamp;
mod stated_rate;
mod stream;
mod suspect;
mod tile;
pub mod track;
pub mod units;
mod wide;
mod words;
pub mod write;

pub use encoding::Encoding;
pub use error::{Error, Place, Problem, Result};
pub use open::{Inspection, inspect, open};
pub use options::{AxisMap, ColumnRef, Columns, Names, Options, Permutation, Scale, Units, with_names};
pub use recording::{Assumption, Channel, Extra, Findings, Gap, LONG_GAP_S, Note, Recording, Warning};
pub use sheet::Delimiter;
pub use shisei_core::Lang;
#[doc(hidden)]
pub use stream::open_in_pieces;
pub use stream::{Stream, open_stream};
pub use suspect::{doubts, doubts_of_attitudes};

/// One file.
#[derive(Clone, Copy, Debug)]
pub struct Input<'a> {
    /// Its name, for messages and for the quantity of columns named only x, y, z.
    pub name: &'a str,
    /// Its bytes; gzip is unpacked.
    pub bytes: &'a [u8],
}
