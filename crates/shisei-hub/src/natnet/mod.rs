//! NatNet, the streaming protocol of OptiTrack's Motive: versions 3.0 to 4.1 and what keeps their layout.
//!
//! Little-endian, unpadded, strings end with a zero byte. A packet is `u16 id, u16 length, payload`; the length is
//! not relied on. [`read`] decodes, [`mod@write`] encodes, [`Stream`] follows the packets of one server.

pub mod client;
mod listener;
pub mod model;
pub mod read;
pub mod server;
mod stream;
pub mod write;

pub use client::Client;
pub use model::{
    Body, BodyDescription, Frame, LabeledMarker, Model, ServerInfo, Skeleton, SkeletonDescription, Version,
};
pub use read::Malformed;
pub use server::NatNetOut;
pub use stream::{Stream, Told};

/// What a packet is.
pub mod id {
    /// A client asks who is there.
    pub const CONNECT: u16 = 0;
    /// The server's answer.
    pub const SERVER_INFO: u16 = 1;
    /// A command as text.
    pub const REQUEST: u16 = 2;
    /// The answer to one.
    pub const RESPONSE: u16 = 3;
    /// A client asks for the descriptions.
    pub const REQUEST_MODEL: u16 = 4;
    /// Names and structure of what is streamed.
    pub const MODEL: u16 = 5;
    /// A client asks for a frame.
    pub const REQUEST_FRAME: u16 = 6;
    /// A frame.
    pub const FRAME: u16 = 7;
    /// A client leaves.
    pub const DISCONNECT: u16 = 9;
    /// A client is still there.
    pub const KEEP_ALIVE: u16 = 10;
    /// Asks for the server's clock.
    pub const ECHO_REQUEST: u16 = 12;
    /// The server's clock.
    pub const ECHO_RESPONSE: u16 = 13;
    /// As [`CONNECT`], to all machines.
    pub const DISCOVERY: u16 = 14;
    /// Not understood.
    pub const UNRECOGNIZED: u16 = 100;
}

/// Motive's port for commands.
pub const COMMAND_PORT: u16 = 1510;
/// Motive's port for frames.
pub const DATA_PORT: u16 = 1511;
/// Motive's multicast group.
pub const GROUP: [u8; 4] = [239, 255, 42, 99];
/// What this program calls itself as a server.
pub const OWN_NAME: &str = "shisei";
/// Largest packet: what UDP carries.
pub const PACKET_MAX: usize = 65_535;
