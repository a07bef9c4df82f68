//! Full-scale ranges, and what one count is worth.
//!
//! Counts are those of the LSM6DS3TR-C's data sheet: 35 µ°/s a count for each °/s of range (70 m°/s at
//! ±2000 °/s), 30.5 µg a count for each g of range (0.244 mg at ±8 g).

/// One degree, rad.
const DEG_RAD: f64 = core::f64::consts::PI / 180.0;
/// Standard gravity, m/s².
const GRAVITY_M_S2: f64 = 9.80665;

/// Range of the gyroscope.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum GyroRange {
    /// ±125 °/s.
    Dps125 = 0,
    /// ±250 °/s.
    Dps250 = 1,
    /// ±500 °/s.
    Dps500 = 2,
    /// ±1000 °/s.
    Dps1000 = 3,
    /// ±2000 °/s.
    #[default]
    Dps2000 = 4,
}

impl GyroRange {
    /// All, in the order of their codes.
    pub const ALL: [GyroRange; 5] =
        [GyroRange::Dps125, GyroRange::Dps250, GyroRange::Dps500, GyroRange::Dps1000, GyroRange::Dps2000];

    /// From the code in a packet's flags.
    pub fn from_code(code: u8) -> Option<Self> {
        Self::ALL.get(usize::from(code)).copied()
    }

    /// °/s.
    pub fn degrees_per_second(self) -> u16 {
        125 << (self as u8)
    }

    /// One count, rad/s.
    pub fn count_rad_s(self) -> f64 {
        f64::from(self.degrees_per_second()) * 35e-6 * DEG_RAD
    }
}

/// Range of the accelerometer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AccRange {
    /// ±2 g.
    G2 = 0,
    /// ±4 g.
    G4 = 1,
    /// ±8 g.
    #[default]
    G8 = 2,
    /// ±16 g.
    G16 = 3,
}

impl AccRange {
    /// All, in the order of their codes.
    pub const ALL: [AccRange; 4] = [AccRange::G2, AccRange::G4, AccRange::G8, AccRange::G16];

    /// From the code in a packet's flags.
    pub fn from_code(code: u8) -> Option<Self> {
        Self::ALL.get(usize::from(code)).copied()
    }

    /// g.
    pub fn g(self) -> u16 {
        2 << (self as u8)
    }

    /// One count, m/s².
    pub fn count_m_s2(self) -> f64 {
        f64::from(self.g()) * 30.5e-6 * GRAVITY_M_S2
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The data sheet's table of sensitivities (LSM6DS3TR-C, table 3).
    #[test]
    fn counts_are_the_data_sheets() {
        for (range, millidegrees) in GyroRange::ALL.iter().zip([4.375, 8.75, 17.5, 35.0, 70.0]) {
            assert!((range.count_rad_s() / DEG_RAD * 1000.0 - millidegrees).abs() < 1e-9);
        }
        for (range, milli_g) in AccRange::ALL.iter().zip([0.061, 0.122, 0.244, 0.488]) {
            assert!((range.count_m_s2() / GRAVITY_M_S2 * 1000.0 - milli_g).abs() < 1e-12);
        }
    }

    #[test]
    fn codes_come_back() {
        assert!(GyroRange::ALL.iter().all(|&r| GyroRange::from_code(r as u8) == Some(r)));
        assert!(AccRange::ALL.iter().all(|&r| AccRange::from_code(r as u8) == Some(r)));
        assert_eq!((GyroRange::from_code(5), AccRange::from_code(4)), (None, None));
    }
}
