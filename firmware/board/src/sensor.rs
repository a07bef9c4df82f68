//! The LSM6DS3TR-C, the inertial sensor of the XIAO nRF52840 Sense, over I²C.
//!
//! Registers after ST's data sheet of the LSM6DS3TR-C (DocID030071). 833 Hz, the lowest rate above which nothing of a
//! hand's movement is aliased; the data-ready pin gives pulses, so that a reading that was missed does not stop them.

use embedded_hal_async::i2c::I2c;
use shisei_wire::{AccRange, GyroRange};

/// Address on the bus, SA0 low.
const ADDRESS: u8 = 0x6A;
const DRDY_PULSE_CFG: u8 = 0x0B;
const INT1_CTRL: u8 = 0x0D;
const WHO_AM_I: u8 = 0x0F;
const CTRL1_XL: u8 = 0x10;
const CTRL2_G: u8 = 0x11;
const CTRL3_C: u8 = 0x12;
const OUT_TEMP_L: u8 = 0x20;
/// What WHO_AM_I reads.
const IDENTITY: u8 = 0x6A;
const ODR_833_HZ: u8 = 0x70;
/// CTRL3_C: bytes of a value belong together; addresses count up.
const BDU_IF_INC: u8 = 0x44;
const SOFTWARE_RESET: u8 = 0x01;
/// Reads of CTRL3_C until the reset, which takes 50 µs, must be over.
const RESET_READS: u32 = 1_000;

/// Why the sensor does not start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Error<E> {
    /// The bus.
    Bus(E),
    /// Another sensor answers, with this identity.
    Identity(u8),
    /// The reset does not end.
    Reset,
}

impl<E> From<E> for Error<E> {
    fn from(error: E) -> Self {
        Error::Bus(error)
    }
}

/// One reading: counts of the ranges in force, temperature in 0.01 °C.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Counts {
    /// Gyroscope x, y, z.
    pub gyro: [i16; 3],
    /// Accelerometer x, y, z.
    pub acc: [i16; 3],
    /// 0.01 °C.
    pub temperature_centi_c: i16,
}

/// The sensor.
#[derive(Debug)]
pub struct Sensor<I> {
    i2c: I,
}

impl<I: I2c> Sensor<I> {
    /// A sensor on a bus.
    pub fn new(i2c: I) -> Self {
        Sensor { i2c }
    }

    /// Resets it and starts both halves at 833 Hz, with the gyroscope's data-ready pulses on INT1.
    pub async fn start(&mut self, gyro: GyroRange, acc: AccRange) -> Result<(), Error<I::Error>> {
        let identity = self.read(WHO_AM_I).await?;
        if identity != IDENTITY {
            return Err(Error::Identity(identity));
        }
        self.write(CTRL3_C, SOFTWARE_RESET).await?;
        let mut left = RESET_READS;
        while self.read(CTRL3_C).await? & SOFTWARE_RESET != 0 {
            left = left.checked_sub(1).ok_or(Error::Reset)?;
        }
        self.write(CTRL3_C, BDU_IF_INC).await?;
        self.set_ranges(gyro, acc).await?;
        self.write(DRDY_PULSE_CFG, 0x80).await?;
        Ok(self.write(INT1_CTRL, 0x02).await?)
    }

    /// Other ranges.
    pub async fn set_ranges(&mut self, gyro: GyroRange, acc: AccRange) -> Result<(), I::Error> {
        let acc_bits = match acc {
            AccRange::G2 => 0x00,
            AccRange::G16 => 0x04,
            AccRange::G4 => 0x08,
            AccRange::G8 => 0x0C,
        };
        let gyro_bits = match gyro {
            GyroRange::Dps125 => 0x02,
            GyroRange::Dps250 => 0x00,
            GyroRange::Dps500 => 0x04,
            GyroRange::Dps1000 => 0x08,
            GyroRange::Dps2000 => 0x0C,
        };
        self.write(CTRL1_XL, ODR_833_HZ | acc_bits).await?;
        self.write(CTRL2_G, ODR_833_HZ | gyro_bits).await
    }

    /// The newest values, in one transfer.
    pub async fn counts(&mut self) -> Result<Counts, I::Error> {
        let mut bytes = [0; 14];
        self.i2c.write_read(ADDRESS, &[OUT_TEMP_L], &mut bytes).await?;
        let [t0, t1, rest @ ..] = bytes;
        let mut values = [0_i16; 6];
        for (value, pair) in values.iter_mut().zip(rest.as_chunks::<2>().0) {
            *value = i16::from_le_bytes(*pair);
        }
        let [gx, gy, gz, ax, ay, az] = values;
        // 256 counts a °C, 0 at 25 °C.
        let temperature = 2_500 + i32::from(i16::from_le_bytes([t0, t1])) * 100 / 256;
        Ok(Counts { gyro: [gx, gy, gz], acc: [ax, ay, az], temperature_centi_c: temperature as i16 })
    }

    async fn read(&mut self, register: u8) -> Result<u8, I::Error> {
        let mut value = [0];
        self.i2c.write_read(ADDRESS, &[register], &mut value).await?;
        Ok(value[0])
    }

    async fn write(&mut self, register: u8, value: u8) -> Result<(), I::Error> {
        self.i2c.write(ADDRESS, &[register, value]).await
    }
}
