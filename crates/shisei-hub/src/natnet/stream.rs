//! The packets of one server, followed: its version decides how the others are read.

use super::model::{Frame, Model, ServerInfo, Version};
use super::{Malformed, id, read};

/// What a packet told.
#[derive(Clone, Debug, PartialEq)]
pub enum Told {
    /// Who the server is.
    Server(ServerInfo),
    /// What it streams.
    Model(Model),
    /// A frame.
    Frame(Box<Frame>),
    /// Nothing that matters here.
    Nothing,
}

/// One server's packets.
#[derive(Clone, Debug, Default)]
pub struct Stream {
    server: Option<ServerInfo>,
}

impl Stream {
    /// Takes a packet. Frames before the server's own word cannot be read and tell nothing.
    pub fn push(&mut self, bytes: &[u8]) -> Result<Told, Malformed> {
        let (kind, payload) = read::packet(bytes)?;
        match (kind, self.version()) {
            (id::SERVER_INFO, _) => {
                let info = read::server_info(payload)?;
                self.server = Some(info.clone());
                Ok(Told::Server(info))
            }
            (id::MODEL, Some(version)) => read::model(payload, version).map(Told::Model),
            (id::FRAME, Some(version)) => {
                read::frame(payload, version).map(|frame| Told::Frame(Box::new(frame)))
            }
            _ => Ok(Told::Nothing),
        }
    }

    /// The server's version, once it is known.
    pub fn version(&self) -> Option<Version> {
        self.server.as_ref().map(ServerInfo::version)
    }

    /// Who the server is, once that is known.
    pub fn server(&self) -> Option<&ServerInfo> {
        self.server.as_ref()
    }
}
