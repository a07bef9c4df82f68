//! What passes between a node, its receiver and a PC, byte by byte. `docs/en/wire.md` is the same in prose.
//!
//! - [`packet`]: a node's Bluetooth notification, a header and up to ten samples;
//! - [`message`]: what receiver and PC say to each other;
//! - [`frame`]: how a message travels on the serial line, COBS with a CRC-16;
//! - [`calibration`]: what a node corrects its readings with before its filter;
//! - [`range`]: full-scale ranges and what a count is worth;
//! - [`gatt`]: the identifiers of the Bluetooth service.
//!
//! All numbers are little-endian. Nothing here allocates, waits or keeps state beyond a [`frame::Deframer`];
//! nothing panics on what comes in.
#![cfg_attr(not(test), no_std)]
#![warn(missing_docs)]

mod bytes;
pub mod calibration;
mod command;
pub mod frame;
pub mod gatt;
pub mod message;
pub mod packet;
pub mod range;
mod settings;

pub use calibration::Calibration;
pub use frame::{Deframer, encode_frame};
pub use message::Message;
pub use packet::{Header, Packet, Sample};
pub use range::{AccRange, GyroRange};

/// The first byte of every packet and every message. Another number is refused.
pub const VERSION: u8 = 1;

/// Why bytes were refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Error {
    /// Fewer or more bytes than the layout has.
    Length,
    /// Another version of the layout.
    Version(u8),
    /// No such kind of message.
    Kind(u8),
    /// A field holds what it cannot mean.
    Value,
    /// A frame's bytes are not COBS.
    Framing,
    /// A frame's checksum differs.
    Checksum,
    /// A frame is longer than any message.
    TooLong,
}

/// Result of decoding.
pub type Result<T> = core::result::Result<T, Error>;
