//! The live side of shisei: what a receiver sends, decoded, tagged and recorded.
//!
//! - [`session`]: bytes of the serial line in; samples with time and frame, events, losses and clock quality out;
//! - [`take`]: an MCAP recording of raw bytes and decoded samples that loses at most half a second when it is cut;
//! - [`fused`]: a fused take as MCAP;
//! - [`read`]: such a recording back, whole or cut;
//! - [`kept`]: the calibration that a node keeps, and that of a file;
//! - [`natnet`]: the stream of OptiTrack's Motive, decoded and encoded;
//! - [`osc`]: poses for programs of avatars and of sound;
//! - [`live`]: sensors and cameras together, as poses with their source and expected error;
//! - [`server`]: the page, the stream and the status, for browsers and programs.
//!
//! Nothing here opens a serial port: a door gives bytes, through [`live::Input`] or straight to a [`Session`].
#![warn(missing_docs)]

mod cdr;
pub mod fused;
pub mod kept;
pub mod live;
pub mod natnet;
pub mod osc;
mod own_address;
pub mod read;
pub mod server;
pub mod session;
pub mod take;

pub use session::{Item, Sample, Session};
pub use take::Take;
