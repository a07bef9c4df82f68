//! What a PC asks for: of a receiver, and through it of nodes.

use crate::bytes::{Put, Take};
use crate::calibration::Calibration;
use crate::gatt::NAME_MAX;
use crate::message::NO_NODE;
use crate::settings::Settings;
use crate::{Error, Result};

/// What the PC can ask for. A node is a place in the receiver, [`NO_NODE`] all of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Command<'a> {
    /// 129: say [`Hello`](crate::message::Hello) and all nodes. No fields.
    Ask,
    /// 130: blink for ten seconds. Node.
    Identify(u8),
    /// 131: find the bias anew; the node lies still for two seconds. Node.
    Calibrate(u8),
    /// 132: take this name. Node, then the name.
    Rename(u8, &'a str),
    /// 133: take these settings. Node, then [`Settings`].
    Configure(u8, Settings),
    /// 134: keep this calibration; none: forget the one that is kept. Node, then [`Calibration`] or nothing.
    Keep(u8, Option<Calibration>),
}

impl Command<'_> {
    /// The byte that says which.
    pub fn kind(&self) -> u8 {
        match self {
            Command::Ask => 129,
            Command::Identify(_) => 130,
            Command::Calibrate(_) => 131,
            Command::Rename(..) => 132,
            Command::Configure(..) => 133,
            Command::Keep(..) => 134,
        }
    }

    /// Which node is asked.
    pub fn node(&self) -> u8 {
        match *self {
            Command::Ask => NO_NODE,
            Command::Identify(node)
            | Command::Calibrate(node)
            | Command::Rename(node, _)
            | Command::Configure(node, _)
            | Command::Keep(node, _) => node,
        }
    }
}

impl<'a> Command<'a> {
    /// A command as a node is written it ([`crate::gatt::CONTROL`]): kind and fields, without version and node.
    /// Refused as by [`Message::decode`](crate::Message::decode).
    pub fn decode_for_node(bytes: &'a [u8]) -> Result<Self> {
        let (kind, fields) = bytes.split_first().ok_or(Error::Length)?;
        let mut take = Take(fields);
        let command = crate::command::take(*kind, NO_NODE, &mut take)?;
        take.end()?;
        Ok(command)
    }
}

/// Kinds of commands that name a node.
pub const FOR_NODES: core::ops::RangeInclusive<u8> = 130..=134;

/// Writes a command's node and fields.
pub fn put(put: &mut Put<'_>, command: &Command<'_>) -> Result<()> {
    match *command {
        Command::Ask => Ok(()),
        Command::Identify(node) | Command::Calibrate(node) => put.u8(node),
        Command::Rename(node, name) => {
            put.u8(node)?;
            put_name(put, name)
        }
        Command::Configure(node, settings) => {
            let settings = settings.encode()?;
            put.u8(node)?;
            put.bytes(&settings)
        }
        Command::Keep(node, ref calibration) => {
            put.u8(node)?;
            put_calibration(put, calibration.as_ref())
        }
    }
}

/// Reads the fields of a command of this kind for this node.
pub fn take<'a>(kind: u8, node: u8, take: &mut Take<'a>) -> Result<Command<'a>> {
    Ok(match kind {
        129 => Command::Ask,
        130 => Command::Identify(node),
        131 => Command::Calibrate(node),
        132 => Command::Rename(node, take_name(take)?),
        133 => {
            let fields = [take.u8()?, take.u8()?, take.u8()?, take.u8()?];
            Command::Configure(node, Settings::decode(fields)?)
        }
        134 => Command::Keep(node, take_calibration(take)?),
        other => return Err(Error::Kind(other)),
    })
}

/// Writes a calibration, or nothing.
pub fn put_calibration(put: &mut Put<'_>, calibration: Option<&Calibration>) -> Result<()> {
    match calibration {
        Some(calibration) => put.bytes(&calibration.encode()?),
        None => Ok(()),
    }
}

/// Reads a calibration; nothing is none.
pub fn take_calibration(take: &mut Take<'_>) -> Result<Option<Calibration>> {
    match core::mem::take(&mut take.0) {
        [] => Ok(None),
        bytes => Calibration::decode(bytes).map(Some),
    }
}

/// Writes a name.
pub fn put_name(put: &mut Put<'_>, name: &str) -> Result<()> {
    if name.len() > NAME_MAX { Err(Error::TooLong) } else { put.bytes(name.as_bytes()) }
}

/// Reads a name.
pub fn take_name<'a>(take: &mut Take<'a>) -> Result<&'a str> {
    let bytes = core::mem::take(&mut take.0);
    if bytes.len() > NAME_MAX {
        return Err(Error::TooLong);
    }
    core::str::from_utf8(bytes).map_err(|_| Error::Value)
}
