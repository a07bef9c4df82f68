//! A node's settings, as they travel and as they are stored.

use crate::packet::{FilterKind, SAMPLES_MAX};
use crate::{AccRange, Error, GyroRange, Result};

/// Bytes of the settings.
pub const SETTINGS_BYTES: usize = 4;

/// A node's settings: 4 bytes: filter u8, samples a packet u8, gyroscope range u8, accelerometer range u8.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Settings {
    /// What makes the attitude.
    pub filter: FilterKind,
    /// Samples a packet, 1 … 10.
    pub batch: u8,
    /// Range of the gyroscope.
    pub gyro_range: GyroRange,
    /// Range of the accelerometer.
    pub acc_range: AccRange,
}

impl Settings {
    /// Refused ([`Error::Value`]): a number of samples that is none.
    pub fn encode(&self) -> Result<[u8; SETTINGS_BYTES]> {
        if self.batch == 0 || usize::from(self.batch) > SAMPLES_MAX {
            return Err(Error::Value);
        }
        Ok([self.filter as u8, self.batch, self.gyro_range as u8, self.acc_range as u8])
    }

    /// Refused ([`Error::Value`]): a field without meaning.
    pub fn decode([filter, batch, gyro_range, acc_range]: [u8; SETTINGS_BYTES]) -> Result<Self> {
        let filter = FilterKind::from_code(filter).ok_or(Error::Value)?;
        if batch == 0 || usize::from(batch) > SAMPLES_MAX {
            return Err(Error::Value);
        }
        let gyro_range = GyroRange::from_code(gyro_range).ok_or(Error::Value)?;
        let acc_range = AccRange::from_code(acc_range).ok_or(Error::Value)?;
        Ok(Settings { filter, batch, gyro_range, acc_range })
    }
}
