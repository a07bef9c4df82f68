//! A node's packet: one Bluetooth notification.
//!
//! | bytes | field |
//! |--:|---|
//! | 0 | version, 1 |
//! | 1 | count of samples, 1 … 10 |
//! | 2–3 | flags, see [`Flags`] |
//! | 4–5 | boot id: random at every start of the node |
//! | 6–7 | sequence number of the first sample, given when it is sampled; wraps |
//! | 8–11 | time of the first sample, node µs; wraps |
//! | 12–15 | newest anchor point, node µs; wraps |
//! | 16–17 | that anchor's connection event counter |
//! | 18–19 | temperature, 0.01 °C; −32768: not known |
//! | 20 + 22 k | sample k, see [`Sample`] |

use crate::bytes::{Put, Take};
use crate::range::{AccRange, GyroRange};
use crate::{Error, Result, VERSION};

/// Bytes before the first sample.
pub const HEADER_BYTES: usize = 20;
/// Bytes of a sample.
pub const SAMPLE_BYTES: usize = 22;
/// Most samples in a packet: what fits into a notification.
pub const SAMPLES_MAX: usize = 10;
/// Longest packet.
pub const PACKET_MAX: usize = HEADER_BYTES + SAMPLES_MAX * SAMPLE_BYTES;

/// A temperature that is not known.
pub(crate) const TEMPERATURE_UNKNOWN: i16 = i16::MIN;
/// A quaternion's 1.
const QUATERNION_ONE: f64 = 32767.0;

/// How the attitude in a packet was found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FilterKind {
    /// The complementary filter.
    #[default]
    Complementary = 0,
    /// The estimator.
    Estimator = 1,
}

impl FilterKind {
    /// From its code.
    pub fn from_code(code: u8) -> Option<Self> {
        [FilterKind::Complementary, FilterKind::Estimator].get(usize::from(code)).copied()
    }
}

/// The state of the node's start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Start {
    /// Averaging the gyroscope at rest.
    #[default]
    Running = 0,
    /// Bias found and removed before the filter.
    Done = 1,
    /// Too few samples: no bias is removed.
    Skipped = 2,
    /// Bias found although the node was moved meanwhile: do it again.
    Moved = 3,
}

/// What a packet says of all its samples.
///
/// Bit 0: the anchor is valid. Bit 1: sampled before the present connection. Bit 2: the battery is low. Bits 3–5:
/// gyroscope range. Bits 6–7: accelerometer range. Bits 8–9: filter. Bits 10–11: start. Bit 12: a sensor reading
/// was missed. Bit 13: the quaternions are of readings corrected by a kept calibration (counts never are). Bits
/// 14–15: 0; readers ignore them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Flags {
    /// Sampled before the present connection was there.
    pub late: bool,
    /// The battery is low.
    pub battery_low: bool,
    /// Range of the gyroscope's counts.
    pub gyro_range: GyroRange,
    /// Range of the accelerometer's counts.
    pub acc_range: AccRange,
    /// What made the quaternions.
    pub filter: FilterKind,
    /// How the start went.
    pub start: Start,
    /// A sensor reading was missed within these samples.
    pub reading_missed: bool,
    /// The filter got readings that a kept calibration corrected; the counts are as the sensor gave them.
    pub calibrated: bool,
}

impl Flags {
    fn to_bits(self, anchor: bool) -> u16 {
        u16::from(anchor)
            | u16::from(self.late) << 1
            | u16::from(self.battery_low) << 2
            | (self.gyro_range as u16) << 3
            | (self.acc_range as u16) << 6
            | (self.filter as u16) << 8
            | (self.start as u16) << 10
            | u16::from(self.reading_missed) << 12
            | u16::from(self.calibrated) << 13
    }

    fn from_bits(bits: u16) -> Result<Self> {
        let field = |shift: u16, width: u16| ((bits >> shift) & ((1 << width) - 1)) as u8;
        Ok(Flags {
            late: field(1, 1) == 1,
            battery_low: field(2, 1) == 1,
            gyro_range: GyroRange::from_code(field(3, 3)).ok_or(Error::Value)?,
            acc_range: AccRange::from_code(field(6, 2)).ok_or(Error::Value)?,
            filter: FilterKind::from_code(field(8, 2)).ok_or(Error::Value)?,
            start: match field(10, 2) {
                0 => Start::Running,
                1 => Start::Done,
                2 => Start::Skipped,
                _ => Start::Moved,
            },
            reading_missed: field(12, 1) == 1,
            calibrated: field(13, 1) == 1,
        })
    }
}

/// A connection's anchor point: the start of a connection event, which both sides see.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Anchor {
    /// The link layer's counter of connection events; wraps.
    pub event: u16,
    /// When, node µs; wraps.
    pub time_us: u32,
}

/// A packet's first bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Header {
    /// What holds for all samples.
    pub flags: Flags,
    /// Random at every start of the node.
    pub boot: u16,
    /// Sequence number of the first sample.
    pub sequence: u16,
    /// When the first sample was taken, node µs.
    pub time_us: u32,
    /// The newest anchor point.
    pub anchor: Option<Anchor>,
    /// Temperature, 0.01 °C.
    pub temperature_centi_c: Option<i16>,
}

/// One sample: 22 bytes.
///
/// | bytes | field |
/// |--:|---|
/// | 0–1 | µs after the packet's time |
/// | 2–7 | gyroscope x, y, z, counts, before bias removal: mean over the tick |
/// | 8–13 | accelerometer x, y, z, counts: mean over the tick |
/// | 14–21 | `world_from_body` w, x, y, z, 1 = 32767 |
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sample {
    /// µs after the packet's time.
    pub dt_us: u16,
    /// Counts of the header's gyroscope range.
    pub gyro: [i16; 3],
    /// Counts of the header's accelerometer range.
    pub acc: [i16; 3],
    /// `world_from_body`, w, x, y, z.
    pub quaternion: [i16; 4],
}

impl Sample {
    /// Rate, rad/s.
    pub fn gyro_rad_s(&self, range: GyroRange) -> [f64; 3] {
        self.gyro.map(|count| f64::from(count) * range.count_rad_s())
    }

    /// Specific force, m/s².
    pub fn acc_m_s2(&self, range: AccRange) -> [f64; 3] {
        self.acc.map(|count| f64::from(count) * range.count_m_s2())
    }

    /// `world_from_body`, not normalised: four counts of 16 bits.
    pub fn world_from_body(&self) -> [f64; 4] {
        self.quaternion.map(|count| f64::from(count) / QUATERNION_ONE)
    }
}

/// The counts nearest to a value; beyond the range the last ones.
pub fn counts(value: f64, one_count: f64) -> i16 {
    let scaled = value / one_count;
    // A cast saturates and makes 0 of NaN; half a count is added towards the value's sign.
    (if scaled < 0.0 { scaled - 0.5 } else { scaled + 0.5 }) as i16
}

/// A unit quaternion's counts.
pub fn quaternion_counts(world_from_body: [f64; 4]) -> [i16; 4] {
    world_from_body.map(|x| counts(x, 1.0 / QUATERNION_ONE).max(-i16::MAX))
}

/// Writes a packet; returns its length. Refused: no sample, more than [`SAMPLES_MAX`], a buffer too short.
pub fn encode(header: &Header, samples: &[Sample], out: &mut [u8]) -> Result<usize> {
    if samples.is_empty() || samples.len() > SAMPLES_MAX {
        return Err(Error::Length);
    }
    let anchor = header.anchor.unwrap_or(Anchor { event: 0, time_us: 0 });
    let mut put = Put::new(out);
    put.u8(VERSION)?;
    put.u8(samples.len() as u8)?;
    put.u16(header.flags.to_bits(header.anchor.is_some()))?;
    put.u16(header.boot)?;
    put.u16(header.sequence)?;
    put.u32(header.time_us)?;
    put.u32(anchor.time_us)?;
    put.u16(anchor.event)?;
    put.i16(header.temperature_centi_c.unwrap_or(TEMPERATURE_UNKNOWN))?;
    for sample in samples {
        put.u16(sample.dt_us)?;
        for count in sample.gyro.iter().chain(&sample.acc).chain(&sample.quaternion) {
            put.i16(*count)?;
        }
    }
    Ok(put.done())
}

/// A decoded packet; its samples are read from the bytes when asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Packet<'a> {
    /// Its first bytes.
    pub header: Header,
    samples: &'a [u8],
}

impl<'a> Packet<'a> {
    /// Refused: another version, a count that is 0, too large or not what the length says, an unknown range or
    /// filter.
    pub fn decode(bytes: &'a [u8]) -> Result<Self> {
        let mut take = Take(bytes);
        let version = take.u8()?;
        if version != VERSION {
            return Err(Error::Version(version));
        }
        let count = usize::from(take.u8()?);
        let bits = take.u16()?;
        let (boot, sequence, time_us) = (take.u16()?, take.u16()?, take.u32()?);
        let (anchor_us, event, temperature) = (take.u32()?, take.u16()?, take.i16()?);
        let samples = take.0;
        if count == 0 || count > SAMPLES_MAX || samples.len() != count * SAMPLE_BYTES {
            return Err(Error::Length);
        }
        let header = Header {
            flags: Flags::from_bits(bits)?,
            boot,
            sequence,
            time_us,
            anchor: (bits & 1 == 1).then_some(Anchor { event, time_us: anchor_us }),
            temperature_centi_c: (temperature != TEMPERATURE_UNKNOWN).then_some(temperature),
        };
        Ok(Packet { header, samples })
    }

    /// How many samples; at least one.
    pub fn count(&self) -> u16 {
        (self.samples.len() / SAMPLE_BYTES) as u16
    }

    /// The samples in their order.
    pub fn samples(&self) -> impl Iterator<Item = Sample> + 'a {
        self.samples.chunks_exact(SAMPLE_BYTES).filter_map(|bytes| sample(Take(bytes)).ok())
    }
}

fn sample(mut take: Take<'_>) -> Result<Sample> {
    let dt_us = take.u16()?;
    let mut three = || -> Result<[i16; 3]> { Ok([take.i16()?, take.i16()?, take.i16()?]) };
    let (gyro, acc) = (three()?, three()?);
    let quaternion = [take.i16()?, take.i16()?, take.i16()?, take.i16()?];
    Ok(Sample { dt_us, gyro, acc, quaternion })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn filters_codes_come_back() {
        for filter in [FilterKind::Complementary, FilterKind::Estimator] {
            assert_eq!(FilterKind::from_code(filter as u8), Some(filter));
        }
        assert_eq!(FilterKind::from_code(2), None);
    }

    #[test]
    fn counts_round_and_saturate() {
        assert_eq!([counts(0.4, 1.0), counts(0.6, 1.0), counts(-0.6, 1.0)], [0, 1, -1]);
        assert_eq!([counts(1e9, 1.0), counts(-1e9, 1.0), counts(f64::NAN, 1.0)], [32767, -32768, 0]);
        assert_eq!(quaternion_counts([-1.0, 1.0, 0.0, 0.5]), [-32767, 32767, 0, 16384]);
    }

    #[test]
    fn what_does_not_fit_is_refused() {
        let header = Header::default();
        let mut out = [0; PACKET_MAX];
        assert_eq!(encode(&header, &[], &mut out), Err(Error::Length));
        assert_eq!(encode(&header, &[Sample::default(); 11], &mut out), Err(Error::Length));
        assert_eq!(encode(&header, &[Sample::default(); 10], &mut out[..239]), Err(Error::Length));
        assert_eq!(encode(&header, &[Sample::default(); 10], &mut out), Ok(240));
        assert_eq!(Packet::decode(&out).map(|packet| packet.count()), Ok(10));
        assert_eq!(Packet::decode(&out[..239]), Err(Error::Length));
        out[0] = 9;
        assert_eq!(Packet::decode(&out), Err(Error::Version(9)));
    }
}
