//! A file on its way to the disk, under a temporary name.

use std::io::{self, IoSlice, Write};

use tempfile::NamedTempFile;

/// Shorter pieces are collected.
const PIECE: usize = 1 << 16;
/// A shorter file is left to the system.
const LONG: u64 = 1 << 20;
/// How much room on the disk is taken at once.
const ROOM: u64 = 1 << 24;

/// A file that is written from its start to its end. Room on the disk is taken ahead of what is written, so that the
/// system need not look for it page by page; where it cannot do that nothing is lost.
#[derive(Debug)]
pub struct Outgoing {
    file: NamedTempFile,
    collected: Vec<u8>,
    written: u64,
    /// Bytes for which room was taken, or that need none.
    room: u64,
}

impl Outgoing {
    /// An empty file.
    pub fn new(file: NamedTempFile) -> Self {
        Outgoing { file, collected: Vec::new(), written: 0, room: LONG }
    }

    /// Writes what was collected and gives back the room that was not needed.
    pub fn finish(mut self) -> io::Result<NamedTempFile> {
        self.flush()?;
        if self.room > LONG {
            self.file.as_file().set_len(self.written)?;
        }
        Ok(self.file)
    }

    fn take_room(&mut self, count: usize) {
        while self.room < self.written + count as u64 {
            #[cfg(target_os = "linux")]
            let _ = rustix::fs::fallocate(
                self.file.as_file(),
                rustix::fs::FallocateFlags::KEEP_SIZE,
                self.room,
                ROOM,
            );
            self.room += ROOM;
        }
    }
}

impl Write for Outgoing {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.write_vectored(&[IoSlice::new(bytes)])
    }

    fn write_vectored(&mut self, parts: &[IoSlice<'_>]) -> io::Result<usize> {
        let count = parts.iter().map(|part| part.len()).sum();
        if self.collected.len() + count > PIECE {
            self.flush()?;
        }
        if count < PIECE {
            parts.iter().for_each(|part| self.collected.extend_from_slice(part));
            return Ok(count);
        }
        self.take_room(count);
        let written = self.file.write_vectored(parts)?;
        self.written += written as u64;
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.take_room(self.collected.len());
        self.file.write_all(&self.collected)?;
        self.written += self.collected.len() as u64;
        self.collected.clear();
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pieces of all sizes, over the limits for collecting and for taking room.
    #[test]
    fn what_is_written_is_there() {
        let folder = tempfile::tempdir().unwrap();
        let mut out = Outgoing::new(NamedTempFile::new_in(&folder).unwrap());
        let mut expected = Vec::new();
        for k in 0..60usize {
            let length = [0, 1, 1000, PIECE - 1, PIECE, PIECE + 1, 700_000][k % 7];
            let piece: Vec<u8> = (0..length).map(|i| (i * 31 + k) as u8).collect();
            out.write_all(&piece).unwrap();
            let (first, second) = piece.split_at(length / 3);
            let twice = out.write_vectored(&[IoSlice::new(first), IoSlice::new(second)]).unwrap();
            expected.extend_from_slice(&piece);
            expected.extend_from_slice(&piece[..twice]);
        }
        assert!(expected.len() as u64 > LONG);
        let file = out.finish().unwrap();
        assert!(std::fs::read(file.path()).unwrap() == expected);
    }
}
