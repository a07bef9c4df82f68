//! The binary stream of the sketch in `apps/spresense`: COBS between zero bytes, CRC-16/CCITT-FALSE, little-endian
//! (`apps/spresense/earth_rate/frame.h` is the description). Bytes in, frames out; nothing hostile panics, and a
//! part without a zero is given up beyond [`LONGEST_FRAME`] bytes.

use shisei_core::Vec3;

/// No frame is longer, zero byte included.
pub const LONGEST_FRAME: usize = 80;

/// One frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Frame {
    /// One reading.
    Sample {
        /// Count of frames, wrapping.
        sequence: u16,
        /// Counter of 19.2 MHz, wrapping.
        ticks: u32,
        /// Temperature, °C.
        temp_c: f64,
        /// Rate, rad/s.
        gyro_rad_s: Vec3,
        /// Acceleration, m/s².
        acc_m_s2: Vec3,
    },
    /// Means over consecutive readings.
    Block {
        /// Count of frames, wrapping.
        sequence: u16,
        /// Readings averaged.
        readings: u16,
        /// Counter at the first of them.
        first_ticks: u32,
        /// Counter at the last of them.
        last_ticks: u32,
        /// Frames the board could not send so far.
        dropped: u32,
        /// Mean temperature, °C.
        temp_c: f64,
        /// Mean rate, rad/s.
        gyro_rad_s: Vec3,
        /// Mean acceleration, m/s².
        acc_m_s2: Vec3,
    },
    /// Once a second.
    Status {
        /// Count of frames, wrapping.
        sequence: u16,
        /// Frames the board could not send so far.
        dropped: u32,
        /// Readings that the sensor's memory lost so far.
        missed: u32,
    },
}

/// CRC-16/CCITT-FALSE.
pub fn crc16(bytes: &[u8]) -> u16 {
    bytes.iter().fold(0xFFFF, |crc, byte| {
        (0..8).fold(
            crc ^ (u16::from(*byte) << 8),
            |c, _| if c & 0x8000 == 0 { c << 1 } else { (c << 1) ^ 0x1021 },
        )
    })
}

/// The bytes between two zeros, without COBS and checksum; none when they are damaged.
fn payload(part: &[u8]) -> Option<Vec<u8>> {
    let mut raw = Vec::with_capacity(part.len());
    let mut at = 0;
    while let Some(&code) = part.get(at) {
        let run = part.get(at + 1..at + usize::from(code))?;
        raw.extend_from_slice(run);
        at += usize::from(code);
        if code < 0xFF && at < part.len() {
            raw.push(0);
        }
    }
    let (body, crc) = raw.split_last_chunk::<2>()?;
    (crc16(body) == u16::from_le_bytes(*crc)).then(|| body.to_vec())
}

struct Reader<'a>(&'a [u8]);

impl Reader<'_> {
    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (head, rest) = self.0.split_first_chunk::<N>()?;
        self.0 = rest;
        Some(*head)
    }

    fn u16(&mut self) -> Option<u16> {
        self.take().map(u16::from_le_bytes)
    }

    fn u32(&mut self) -> Option<u32> {
        self.take().map(u32::from_le_bytes)
    }

    fn f32(&mut self) -> Option<f64> {
        self.take().map(f32::from_le_bytes).filter(|v| v.is_finite()).map(f64::from)
    }

    fn f64(&mut self) -> Option<f64> {
        self.take().map(f64::from_le_bytes).filter(|v| v.is_finite())
    }
}

/// A frame from the bytes between two zeros; none when they are damaged or of an unknown kind.
pub fn decode(part: &[u8]) -> Option<Frame> {
    let body = payload(part)?;
    let mut r = Reader(&body);
    let [kind] = r.take::<1>()?;
    let sequence = r.u16()?;
    let frame = match kind {
        1 => Frame::Sample {
            sequence,
            ticks: r.u32()?,
            temp_c: r.f32()?,
            gyro_rad_s: [r.f32()?, r.f32()?, r.f32()?],
            acc_m_s2: [r.f32()?, r.f32()?, r.f32()?],
        },
        2 => Frame::Block {
            sequence,
            readings: r.u16()?,
            first_ticks: r.u32()?,
            last_ticks: r.u32()?,
            dropped: r.u32()?,
            temp_c: r.f32()?,
            gyro_rad_s: [r.f64()?, r.f64()?, r.f64()?],
            acc_m_s2: [r.f32()?, r.f32()?, r.f32()?],
        },
        3 => Frame::Status { sequence, dropped: r.u32()?, missed: r.u32()? },
        _ => return None,
    };
    r.0.is_empty().then_some(frame)
}

/// Cuts a stream into frames.
#[derive(Clone, Debug, Default)]
pub struct Splitter {
    part: Vec<u8>,
    /// Parts that were damaged so far.
    pub damaged: usize,
}

impl Splitter {
    /// Takes bytes as they come; gives the frames that they complete.
    pub fn push(&mut self, bytes: &[u8]) -> Vec<Frame> {
        let mut frames = Vec::new();
        for &byte in bytes {
            if byte != 0 {
                if self.part.len() <= LONGEST_FRAME {
                    self.part.push(byte);
                }
                continue;
            }
            if !self.part.is_empty() {
                match decode(&self.part) {
                    Some(frame) => frames.push(frame),
                    None => self.damaged += 1,
                }
                self.part.clear();
            }
        }
        frames
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn encode(body: &[u8]) -> Vec<u8> {
        let mut raw = body.to_vec();
        raw.extend_from_slice(&crc16(body).to_le_bytes());
        let mut out = Vec::new();
        for run in raw.split(|b| *b == 0) {
            out.push(run.len() as u8 + 1);
            out.extend_from_slice(run);
        }
        out.push(0);
        out
    }

    fn status(sequence: u16) -> Vec<u8> {
        let mut body = vec![3];
        body.extend_from_slice(&sequence.to_le_bytes());
        body.extend_from_slice(&7_u32.to_le_bytes());
        body.extend_from_slice(&0_u32.to_le_bytes());
        encode(&body)
    }

    #[test]
    fn check_value_of_the_checksum() {
        // the catalogue's check value of CRC-16/CCITT-FALSE
        assert_eq!(crc16(b"123456789"), 0x29B1);
    }

    #[test]
    fn frames_come_out_of_any_pieces() {
        let mut bytes = b"ready\r\n".to_vec();
        bytes.push(0);
        bytes.extend(status(1));
        bytes.extend(status(0));
        let mut splitter = Splitter::default();
        let found: Vec<Frame> = bytes.chunks(3).flat_map(|c| splitter.push(c)).collect();
        let expected = |sequence| Frame::Status { sequence, dropped: 7, missed: 0 };
        assert_eq!(found, [expected(1), expected(0)]);
        assert_eq!(splitter.damaged, 1);
    }

    #[test]
    fn damage_is_counted_and_never_panics() {
        let good = status(300);
        for at in 0..good.len() - 1 {
            for bit in 0..8 {
                let mut bad = good.clone();
                bad[at] ^= 1 << bit;
                let mut splitter = Splitter::default();
                assert!(splitter.push(&bad).is_empty(), "{at} {bit}");
            }
        }
        let mut splitter = Splitter::default();
        splitter.push(&vec![1; 1 << 20]);
        assert!(splitter.part.len() <= LONGEST_FRAME + 1);
        let mut all = Splitter::default();
        for seed in 0..=255_u8 {
            let noise: Vec<u8> = (0..200_u32).map(|k| (k * k + u32::from(seed) * 31 + k / 3) as u8).collect();
            all.push(&noise);
        }
    }

    #[test]
    fn streams_written_by_another_program_are_read() {
        // made with Python's struct and binascii.crc_hqx; they are also what fuzzing starts from
        let read = |bytes: &[u8]| {
            let mut splitter = Splitter::default();
            (splitter.push(bytes), splitter.damaged)
        };
        let (samples, damaged) = read(include_bytes!("../../../fuzz/seeds/spresense_stream/samples"));
        assert_eq!((samples.len(), damaged), (13, 0));
        let Frame::Sample { sequence: 11, ticks, gyro_rad_s, .. } = samples[11] else {
            panic!("{samples:?}")
        };
        assert_eq!((ticks, gyro_rad_s[0]), (42_704, f64::from(11.0e-4_f32)));
        assert_eq!(samples[12], Frame::Status { sequence: 12, dropped: 7, missed: 2 });
        let (blocks, damaged) = read(include_bytes!("../../../fuzz/seeds/spresense_stream/blocks"));
        assert_eq!((blocks.len(), damaged), (5, 0));
        assert!(matches!(blocks[3], Frame::Block { sequence: 0, readings: 256, .. }));
        let (left, damaged) = read(include_bytes!("../../../fuzz/seeds/spresense_stream/damaged"));
        assert_eq!(left.len(), 2);
        assert!(damaged >= 3, "{damaged}");
    }
}
