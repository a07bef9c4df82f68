//! Serial frames: `COBS(message ‖ CRC-16) 0`.
//!
//! COBS: S. Cheshire, M. Baker, "Consistent Overhead Byte Stuffing", IEEE/ACM ToN 7(2), 1999: a 0 ends a frame and
//! occurs nowhere else. CRC-16/IBM-3740 (also called CCITT-FALSE: polynomial 0x1021, start 0xFFFF, no reflection;
//! of "123456789" it is 0x29B1), low byte first.

use crc::{CRC_16_IBM_3740, Crc, Table};

use crate::message::MESSAGE_MAX;
use crate::{Error, Result};

const CRC: Crc<u16, Table<1>> = Crc::<u16, Table<1>>::new(&CRC_16_IBM_3740);

/// Longest frame: message, checksum, COBS's overhead and the closing 0.
pub const FRAME_MAX: usize = cobs::max_encoding_length(MESSAGE_MAX + 2) + 1;

/// The checksum of a message.
pub fn checksum(message: &[u8]) -> u16 {
    CRC.checksum(message)
}

/// Writes the frame of an encoded message; returns its length with the closing 0. Refused: a message that is too
/// long, a buffer too short.
pub fn encode_frame(message: &[u8], out: &mut [u8]) -> Result<usize> {
    if message.len() > MESSAGE_MAX {
        return Err(Error::TooLong);
    }
    let mut encoder = cobs::CobsEncoder::new(out);
    encoder.push(message).map_err(|_| Error::Length)?;
    encoder.push(&checksum(message).to_le_bytes()).map_err(|_| Error::Length)?;
    let length = encoder.finalize();
    *out.get_mut(length).ok_or(Error::Length)? = 0;
    Ok(length + 1)
}

/// Finds frames in a stream of bytes. Memory is fixed; after anything unreadable it goes on with the next 0.
#[derive(Clone, Debug)]
pub struct Deframer {
    buffer: [u8; FRAME_MAX],
    length: usize,
    too_long: bool,
}

impl Default for Deframer {
    fn default() -> Self {
        Deframer { buffer: [0; FRAME_MAX], length: 0, too_long: false }
    }
}

impl Deframer {
    /// Takes a byte; at the end of a frame returns its message or what is wrong with it. Empty frames are
    /// nothing: a sender may begin with a 0.
    pub fn push(&mut self, byte: u8) -> Option<Result<&[u8]>> {
        if byte != 0 {
            match self.buffer.get_mut(self.length) {
                Some(place) => {
                    *place = byte;
                    self.length += 1;
                }
                None => self.too_long = true,
            }
            return None;
        }
        let length = core::mem::take(&mut self.length);
        if core::mem::take(&mut self.too_long) {
            return Some(Err(Error::TooLong));
        }
        if length == 0 { None } else { Some(open(self.buffer.get_mut(..length)?)) }
    }

    /// Bytes of a frame that has not ended.
    pub fn pending(&self) -> usize {
        self.length
    }
}

fn open(frame: &mut [u8]) -> Result<&[u8]> {
    let length = cobs::decode_in_place(frame).map_err(|_| Error::Framing)?;
    let content = frame.get(..length).ok_or(Error::Framing)?;
    let (message, sum) = content.split_last_chunk::<2>().ok_or(Error::Length)?;
    if checksum(message) == u16::from_le_bytes(*sum) { Ok(message) } else { Err(Error::Checksum) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The check value of the catalogue of CRC algorithms.
    #[test]
    fn the_checksum_is_the_published_one() {
        assert_eq!(checksum(b"123456789"), 0x29b1);
    }

    #[test]
    fn a_frame_after_garbage_is_found() {
        let mut frame = [0; 32];
        let length = encode_frame(&[1, 0, 2], &mut frame).unwrap();
        let mut stream = vec![7, 7, 0];
        stream.extend_from_slice(&frame[..length]);
        let mut deframer = Deframer::default();
        let mut seen = Vec::new();
        for byte in stream {
            if let Some(found) = deframer.push(byte) {
                seen.push(found.map(<[u8]>::to_vec));
            }
        }
        assert_eq!(seen.len(), 2);
        assert!(seen[0].is_err());
        assert_eq!(seen[1], Ok(vec![1, 0, 2]));
    }

    #[test]
    fn an_endless_frame_is_refused_once_and_forgotten() {
        let mut deframer = Deframer::default();
        assert!((0..10_000).all(|_| deframer.push(9).is_none()));
        assert_eq!(deframer.push(0), Some(Err(Error::TooLong)));
        assert_eq!(deframer.push(0), None);
        assert_eq!(deframer.pending(), 0);
    }
}
