//! Reports one can read anywhere: a single HTML file that works offline, and PNG plots.
//!
//! [`orientation`] makes the report of `orient`. It is put together from parts that know nothing of
//! orientations: [`page`] (one HTML file of facts, warnings, plots and tables), [`plot`] (axes, series, shaded
//! spans), [`attitude`] (the scrubbed 3-D view), [`png`] (the same plots as a picture), [`decimate`] (fewer
//! rows, every peak kept), [`mod@column`] (numbers read in place) and [`escape`].
//!
//! No number is computed here beyond its unit and its range; nothing is read from or written to files.
#![warn(missing_docs)]

pub mod attitude;
pub mod column;
pub mod decimate;
mod encode;
mod error;
pub mod escape;
pub mod figure;
pub mod orientation;
pub mod page;
pub mod plot;
pub mod png;
mod text;

pub use error::{Error, Result};
pub use orientation::{OrientationReport, Uncertainty};
