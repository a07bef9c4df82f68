//! Reading and writing fields one after another.

use crate::{Error, Result};

/// Writes fields into a buffer; one that does not fit makes the whole fail.
pub struct Put<'a> {
    buffer: &'a mut [u8],
    at: usize,
}

impl<'a> Put<'a> {
    pub fn new(buffer: &'a mut [u8]) -> Self {
        Put { buffer, at: 0 }
    }

    pub fn bytes(&mut self, bytes: &[u8]) -> Result<()> {
        let end = self.at + bytes.len();
        self.buffer.get_mut(self.at..end).ok_or(Error::Length)?.copy_from_slice(bytes);
        self.at = end;
        Ok(())
    }

    pub fn u8(&mut self, value: u8) -> Result<()> {
        self.bytes(&[value])
    }

    pub fn u16(&mut self, value: u16) -> Result<()> {
        self.bytes(&value.to_le_bytes())
    }

    pub fn i16(&mut self, value: i16) -> Result<()> {
        self.bytes(&value.to_le_bytes())
    }

    pub fn u32(&mut self, value: u32) -> Result<()> {
        self.bytes(&value.to_le_bytes())
    }

    pub fn u64(&mut self, value: u64) -> Result<()> {
        self.bytes(&value.to_le_bytes())
    }

    /// How many bytes were written.
    pub fn done(self) -> usize {
        self.at
    }
}

/// Takes fields from the front of a slice.
#[derive(Clone, Copy)]
pub struct Take<'a>(pub &'a [u8]);

impl Take<'_> {
    fn array<const N: usize>(&mut self) -> Result<[u8; N]> {
        let (head, rest) = self.0.split_first_chunk().ok_or(Error::Length)?;
        self.0 = rest;
        Ok(*head)
    }

    pub fn u8(&mut self) -> Result<u8> {
        Ok(self.array::<1>()?[0])
    }

    pub fn u16(&mut self) -> Result<u16> {
        Ok(u16::from_le_bytes(self.array()?))
    }

    pub fn i16(&mut self) -> Result<i16> {
        Ok(i16::from_le_bytes(self.array()?))
    }

    pub fn u32(&mut self) -> Result<u32> {
        Ok(u32::from_le_bytes(self.array()?))
    }

    pub fn u64(&mut self) -> Result<u64> {
        Ok(u64::from_le_bytes(self.array()?))
    }

    pub fn six(&mut self) -> Result<[u8; 6]> {
        self.array()
    }

    /// Refused where something is left over.
    pub fn end(self) -> Result<()> {
        if self.0.is_empty() { Ok(()) } else { Err(Error::Length) }
    }
}
