//! The live side of shisei: what a receiver sends, decoded, tagged and recorded.
//!
//! - [`session`]: bytes of the serial line in; samples with time and frame, events, losses and clock quality out;
//! - [`take`]: an MCAP recording of raw bytes and decoded samples that loses at most half a second when it is cut;
//! - [`read`]: such a recording back, whole or cut.
//!
//! Nothing here opens a port or a file: a door gives bytes and a writer.
#![warn(missing_docs)]

mod cdr;
pub mod read;
pub mod session;
pub mod take;

pub use session::{Item, Sample, Session};
pub use take::Take;
