//! Frames that wait for the PC: a whole frame or a counted drop, so that a slow PC never holds up the radio.

use shisei_wire::frame::FRAME_MAX;
use shisei_wire::message::MESSAGE_MAX;
use shisei_wire::{Message, encode_frame};

/// A ring of bytes.
#[derive(Clone, Debug)]
pub struct Outbox<const N: usize> {
    bytes: [u8; N],
    first: usize,
    length: usize,
    dropped: u32,
    told: u32,
}

impl<const N: usize> Default for Outbox<N> {
    fn default() -> Self {
        Outbox { bytes: [0; N], first: 0, length: 0, dropped: 0, told: 0 }
    }
}

impl<const N: usize> Outbox<N> {
    /// Adds a message as a frame, or counts it as dropped; returns whether there was room.
    pub fn push(&mut self, message: &Message<'_>) -> bool {
        let (mut bytes, mut frame) = ([0; MESSAGE_MAX], [0; FRAME_MAX]);
        let framed = message
            .encode(&mut bytes)
            .and_then(|length| encode_frame(bytes.get(..length).unwrap_or_default(), &mut frame));
        let frame = framed.ok().and_then(|length| frame.get(..length)).unwrap_or_default();
        if frame.is_empty() || self.length + frame.len() > N {
            self.dropped = self.dropped.wrapping_add(1);
            return false;
        }
        for &byte in frame {
            if let Some(place) = self.bytes.get_mut((self.first + self.length) % N) {
                *place = byte;
                self.length += 1;
            }
        }
        true
    }

    /// Moves waiting bytes into `out`; returns how many.
    pub fn take(&mut self, out: &mut [u8]) -> usize {
        let count = out.len().min(self.length);
        for place in out.iter_mut().take(count) {
            *place = self.bytes.get(self.first).copied().unwrap_or(0);
            self.first = (self.first + 1) % N;
        }
        self.length -= count;
        count
    }

    /// Room for more, bytes.
    pub fn room(&self) -> usize {
        N - self.length
    }

    /// Bytes that wait.
    pub fn len(&self) -> usize {
        self.length
    }

    /// Nothing waits.
    pub fn is_empty(&self) -> bool {
        self.length == 0
    }

    /// Frames dropped so far.
    pub fn dropped(&self) -> u32 {
        self.dropped
    }

    /// Drops that have not been told, once there is room to tell them.
    pub fn untold(&self) -> Option<u32> {
        let untold = self.dropped.wrapping_sub(self.told);
        (untold > 0 && self.length + 64 <= N).then_some(untold)
    }

    /// They have been told.
    pub fn tell(&mut self) {
        self.told = self.dropped;
    }
}
