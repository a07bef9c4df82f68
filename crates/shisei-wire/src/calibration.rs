//! A sensor's calibration as a node keeps it: `corrected = matrix · (raw − bias)` for both halves.
//!
//! | bytes | field |
//! |--:|---|
//! | 0 | version of this layout, 1 |
//! | 1–12 | accelerometer bias x, y, z, m/s², f32 |
//! | 13–48 | accelerometer matrix, row by row, f32 |
//! | 49–60 | gyroscope bias x, y, z, rad/s, f32 |
//! | 61–96 | gyroscope matrix, row by row, f32 |
//! | 97–98 | checksum of the bytes before, as that of a frame |
//!
//! Rounding to f32 costs 6e-8 of a value: of gravity 6e-7 m/s².

use crate::bytes::{Put, Take};
use crate::frame::checksum;
use crate::{Error, Result};

/// Bytes of a calibration.
pub const CALIBRATION_BYTES: usize = 1 + 24 * 4 + 2;
/// Version of its layout.
const LAYOUT: u8 = 1;
/// The largest bias of an accelerometer that is one, m/s²: half of gravity.
pub const ACC_BIAS_MAX_M_S2: f32 = 5.0;
/// The largest bias of a gyroscope that is one, rad/s: 28 °/s.
pub const GYRO_BIAS_MAX_RAD_S: f32 = 0.5;
/// How far an element of a matrix may be from the identity's.
pub const MATRIX_MAX: f32 = 0.25;

/// Bias and matrix of one half of the sensor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Correction {
    /// Subtracted first: m/s² or rad/s.
    pub bias: [f32; 3],
    /// Multiplied then; rows first.
    pub matrix: [[f32; 3]; 3],
}

/// What a node corrects its readings with before its filter.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Calibration {
    /// Accelerometer, m/s².
    pub accelerometer: Correction,
    /// Gyroscope, rad/s.
    pub gyroscope: Correction,
}

impl Correction {
    /// From bias and matrix, rounded to what travels.
    pub fn from_f64(bias: [f64; 3], matrix: [[f64; 3]; 3]) -> Self {
        Correction {
            bias: bias.map(|value| value as f32),
            matrix: matrix.map(|row| row.map(|value| value as f32)),
        }
    }

    /// Bias and matrix.
    pub fn to_f64(&self) -> ([f64; 3], [[f64; 3]; 3]) {
        (self.bias.map(f64::from), self.matrix.map(|row| row.map(f64::from)))
    }

    /// Finite, and as near to nothing as a sensor that works.
    fn is_sound(&self, bias_max: f32) -> bool {
        let identity = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let near = |found: &f32, ideal: &f32| (found - ideal).abs() <= MATRIX_MAX;
        self.bias.iter().all(|bias| bias.abs() <= bias_max)
            && self.matrix.as_flattened().iter().zip(identity.as_flattened()).all(|(m, i)| near(m, i))
    }

    fn put(&self, put: &mut Put<'_>) -> Result<()> {
        for value in self.bias.iter().chain(self.matrix.as_flattened()) {
            put.u32(value.to_bits())?;
        }
        Ok(())
    }

    fn take(take: &mut Take<'_>) -> Result<Self> {
        let mut correction = Correction::default();
        let values = correction.bias.iter_mut().chain(correction.matrix.as_flattened_mut());
        for value in values {
            *value = f32::from_bits(take.u32()?);
        }
        Ok(correction)
    }
}

impl Calibration {
    /// Whether it can be that of a sensor that works, in these units: what is not finite, a bias beyond
    /// [`ACC_BIAS_MAX_M_S2`] or [`GYRO_BIAS_MAX_RAD_S`], a matrix further than [`MATRIX_MAX`] from the identity is
    /// refused.
    pub fn is_sound(&self) -> bool {
        self.accelerometer.is_sound(ACC_BIAS_MAX_M_S2) && self.gyroscope.is_sound(GYRO_BIAS_MAX_RAD_S)
    }

    /// Writes it with its checksum. Refused ([`Error::Value`]): what is not sound.
    pub fn encode(&self) -> Result<[u8; CALIBRATION_BYTES]> {
        if !self.is_sound() {
            return Err(Error::Value);
        }
        let mut bytes = [0; CALIBRATION_BYTES];
        let mut put = Put::new(&mut bytes);
        put.u8(LAYOUT)?;
        self.accelerometer.put(&mut put)?;
        self.gyroscope.put(&mut put)?;
        let length = put.done();
        let sum = checksum(bytes.get(..length).unwrap_or_default());
        Put::new(bytes.get_mut(length..).unwrap_or_default()).u16(sum)?;
        Ok(bytes)
    }

    /// Refused: another length or layout, a wrong checksum, what is not sound.
    pub fn decode(bytes: &[u8]) -> Result<Self> {
        let whole: &[u8; CALIBRATION_BYTES] = bytes.try_into().map_err(|_| Error::Length)?;
        let mut take = Take(whole);
        let layout = take.u8()?;
        if layout != LAYOUT {
            return Err(Error::Version(layout));
        }
        let (accelerometer, gyroscope) = (Correction::take(&mut take)?, Correction::take(&mut take)?);
        let content = whole.len() - take.0.len();
        let sum = take.u16()?;
        if checksum(whole.get(..content).unwrap_or_default()) != sum {
            return Err(Error::Checksum);
        }
        let calibration = Calibration { accelerometer, gyroscope };
        if calibration.is_sound() { Ok(calibration) } else { Err(Error::Value) }
    }

    /// A short number to tell calibrations apart: the checksum.
    pub fn id(&self) -> u16 {
        let last = self.encode().ok().and_then(|bytes| bytes.last_chunk::<2>().copied());
        last.map_or(0, u16::from_le_bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SUM: u16 = 0x34A4;

    fn example() -> Calibration {
        Calibration {
            accelerometer: Correction {
                bias: [0.25, -0.5, 0.125],
                matrix: [[1.0, 0.25, 0.0], [0.0, 0.75, 0.0], [-0.25, 0.0, 1.25]],
            },
            gyroscope: Correction {
                bias: [0.0625, 0.0, -0.5],
                matrix: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            },
        }
    }

    /// Written out by hand after IEEE 754 (0.25 is 3E800000, −0.5 BF000000, 1 3F800000 …); the checksum by Python's
    /// `binascii.crc_hqx(content, 0xFFFF)`.
    #[test]
    fn bytes_are_as_described() {
        let words: [u32; 24] = [
            0x3E80_0000,
            0xBF00_0000,
            0x3E00_0000,
            0x3F80_0000,
            0x3E80_0000,
            0,
            0,
            0x3F40_0000,
            0,
            0xBE80_0000,
            0,
            0x3FA0_0000,
            0x3D80_0000,
            0,
            0xBF00_0000,
            0x3F80_0000,
            0,
            0,
            0,
            0x3F80_0000,
            0,
            0,
            0,
            0x3F80_0000,
        ];
        let mut expected = vec![1];
        expected.extend(words.iter().flat_map(|word| word.to_le_bytes()));
        expected.extend(SUM.to_le_bytes());
        let bytes = example().encode().unwrap();
        assert_eq!(bytes.as_slice(), expected);
        assert_eq!(Calibration::decode(&bytes), Ok(example()));
        assert_eq!(example().id(), SUM);
    }

    #[test]
    fn nonsense_is_refused() {
        let bytes = example().encode().unwrap();
        assert_eq!(Calibration::decode(&bytes[..98]), Err(Error::Length));
        for bit in 0..8 * bytes.len() {
            let mut other = bytes;
            other[bit / 8] ^= 1 << (bit % 8);
            assert!(Calibration::decode(&other).is_err(), "bit {bit}");
        }
        let broken = |change: fn(&mut Calibration)| {
            let mut calibration = example();
            change(&mut calibration);
            assert_eq!(calibration.encode(), Err(Error::Value));
        };
        broken(|c| c.accelerometer.bias[1] = f32::NAN);
        broken(|c| c.gyroscope.matrix[2][1] = f32::INFINITY);
        // in g, in degrees, all zero
        broken(|c| c.accelerometer.matrix = c.accelerometer.matrix.map(|row| row.map(|x| x / 9.80665)));
        broken(|c| c.gyroscope.bias = [3.0, 0.0, 0.0]);
        broken(|c| *c = Calibration::default());
    }
}
