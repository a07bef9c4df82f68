//! From readings at the sensor's own rate to ticks of 1/120 s.
//!
//! A reading at time t stands for the interval since the reading before. Intervals are cut at the ticks, so every
//! reading counts in full and nothing is picked or aliased. Turns are added up with the coning correction
//! `φ = Σ δ + ½ Σ (Δ + δ₋₁/6) × δ` (Δ: the sum before δ; δ₋₁: the interval before; J. Bortz 1971, R. Miller 1983), so
//! that the mean rate of a tick, held constant, gives the tick's turn; accelerations are averaged by time.

use shisei_core::Vec3;
use shisei_core::vector::{add, cross, scale};

/// Ticks a second.
pub const RATE_HZ: u64 = 120;
/// Longer than this without a reading, and the ticks between are lost, µs.
pub const GAP_US: u64 = 50_000;
/// Longer than this, and a reading was missed, µs: two and a half at 833 Hz.
const MISSED_US: u64 = 3_000;

/// A reading in units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rates {
    /// When, node µs.
    pub time_us: u64,
    /// rad/s.
    pub gyro_rad_s: Vec3,
    /// m/s².
    pub acc_m_s2: Vec3,
}

/// One tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tick {
    /// Its number from the node's start; lost ticks are counted.
    pub number: u64,
    /// Its end, node µs.
    pub time_us: u64,
    /// Its length, s.
    pub dt_s: f64,
    /// The constant rate with the tick's turn, rad/s.
    pub gyro_rad_s: Vec3,
    /// Mean specific force, m/s².
    pub acc_m_s2: Vec3,
    /// A reading was missed in it.
    pub reading_missed: bool,
}

/// Adds readings up.
#[derive(Clone, Copy, Debug, Default)]
pub struct Ticker {
    origin_us: u64,
    number: u64,
    last_us: Option<u64>,
    filled_us: u64,
    turn: Vec3,
    coning: Vec3,
    delta_before: Vec3,
    acc_sum: Vec3,
    missed: bool,
    /// The tick began before the readings did.
    partial: bool,
}

impl Ticker {
    /// The end of a tick, node µs: ticks of 8333, 8333 and 8334 µs.
    fn end_us(&self, number: u64) -> u64 {
        self.origin_us + (number + 1) * 1_000_000 / RATE_HZ
    }

    /// Takes a reading and tells every tick that it ends. A reading that is not later than the one before is left
    /// out.
    pub fn push(&mut self, reading: &Rates, mut ended: impl FnMut(Tick)) {
        let Some(last_us) = self.last_us else {
            *self =
                Ticker { origin_us: reading.time_us, last_us: Some(reading.time_us), ..Ticker::default() };
            return;
        };
        if reading.time_us <= last_us {
            return;
        }
        self.last_us = Some(reading.time_us);
        let interval_us = reading.time_us - last_us;
        if interval_us > GAP_US {
            self.skip_to(reading.time_us);
            return;
        }
        let missed = interval_us > MISSED_US;
        let mut from_us = last_us;
        loop {
            let end_us = self.end_us(self.number);
            let to_us = end_us.min(reading.time_us);
            self.missed |= missed;
            self.add(reading, to_us.saturating_sub(from_us));
            if end_us > reading.time_us {
                return;
            }
            if let Some(tick) = self.finish(end_us) {
                ended(tick);
            }
            from_us = end_us;
        }
    }

    fn add(&mut self, reading: &Rates, length_us: u64) {
        if length_us == 0 {
            return;
        }
        let dt_s = length_us as f64 * 1e-6;
        let delta = scale(reading.gyro_rad_s, dt_s);
        let lever = add(self.turn, scale(self.delta_before, 1.0 / 6.0));
        self.coning = add(self.coning, cross(lever, delta));
        self.turn = add(self.turn, delta);
        self.delta_before = delta;
        self.acc_sum = add(self.acc_sum, scale(reading.acc_m_s2, dt_s));
        self.filled_us += length_us;
    }

    fn finish(&mut self, end_us: u64) -> Option<Tick> {
        let length_us = core::mem::take(&mut self.filled_us);
        let dt_s = length_us as f64 * 1e-6;
        let (turn, coning) = (core::mem::take(&mut self.turn), core::mem::take(&mut self.coning));
        let acc_sum = core::mem::take(&mut self.acc_sum);
        let (missed, partial) = (core::mem::take(&mut self.missed), core::mem::take(&mut self.partial));
        let number = self.number;
        self.number += 1;
        if partial || length_us == 0 {
            return None;
        }
        Some(Tick {
            number,
            time_us: end_us,
            dt_s,
            gyro_rad_s: scale(add(turn, scale(coning, 0.5)), 1.0 / dt_s),
            acc_m_s2: scale(acc_sum, 1.0 / dt_s),
            reading_missed: missed,
        })
    }

    /// After a gap: goes on with the tick that contains `time_us`, which is lost as well.
    fn skip_to(&mut self, time_us: u64) {
        *self = Ticker {
            origin_us: self.origin_us,
            number: (time_us - self.origin_us) * RATE_HZ / 1_000_000,
            last_us: self.last_us,
            missed: true,
            partial: true,
            ..Ticker::default()
        };
        // Rounding may leave the number one off.
        while self.end_us(self.number) <= time_us {
            self.number += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shisei_core::{Quaternion, math};

    fn ticks(readings: impl Iterator<Item = Rates>) -> Vec<Tick> {
        let mut ticker = Ticker::default();
        let mut ticks = Vec::new();
        for reading in readings {
            ticker.push(&reading, |tick| ticks.push(tick));
        }
        ticks
    }

    fn constant(time_us: u64) -> Rates {
        Rates { time_us, gyro_rad_s: [1.0, -2.0, 3.0], acc_m_s2: [0.5, 0.0, 9.8] }
    }

    #[test]
    fn a_constant_rate_stays_itself_at_any_reading_rate() {
        for step_us in [300, 1200, 1201, 5000, 8333] {
            let found = ticks((0..4000).map(|k| constant(1_000_003 + k * step_us)));
            let expected = 3999 * step_us * RATE_HZ / 1_000_000;
            assert!(found.len() as u64 >= expected, "{} of {expected}", found.len());
            for (k, tick) in found.iter().enumerate() {
                assert_eq!(tick.number, k as u64);
                assert!((tick.dt_s * 1e6 - 8333.4).abs() < 0.7);
                for axis in 0..3 {
                    assert!((tick.gyro_rad_s[axis] - [1.0, -2.0, 3.0][axis]).abs() < 1e-12);
                    assert!((tick.acc_m_s2[axis] - [0.5, 0.0, 9.8][axis]).abs() < 1e-12);
                }
                assert_eq!(tick.reading_missed, step_us > MISSED_US);
            }
        }
    }

    /// Coning at 20 Hz, 5 degrees: truth in closed form (P. Savage 1998); without the correction the heading creeps
    /// by ω (1 − cos 5°)(1 − sin ωT/ωT), 47 degrees in ten seconds.
    #[test]
    fn coning_leaves_no_drift() {
        let (half_angle, frequency) = (5.0_f64.to_radians(), 2.0 * core::f64::consts::PI * 20.0);
        let s = math::sin(half_angle);
        let rate = |t: f64| {
            let c = 2.0 * math::sin(0.5 * half_angle) * math::sin(0.5 * half_angle);
            [
                -frequency * s * math::sin(frequency * t),
                frequency * s * math::cos(frequency * t),
                -frequency * c,
            ]
        };
        // q = exp of the rotation vector half_angle · (cos, sin, 0), turned: its rate is the one above.
        let attitude = |t: f64| {
            let (sin, cos) = math::sin_cos(frequency * t);
            Quaternion::from_rotation_vector([half_angle * cos, half_angle * sin, 0.0])
        };
        let found = ticks((0..8331_u64).map(|k| {
            let time_us = k * 1200;
            // The mean over the interval that the reading stands for.
            let t = (time_us as f64 - 600.0) * 1e-6;
            Rates { time_us, gyro_rad_s: rate(t), acc_m_s2: [0.0; 3] }
        }));
        let (mut with, mut t) = (attitude(0.0), 0.0);
        for tick in &found {
            with = with.product(Quaternion::from_rotation_vector(scale(tick.gyro_rad_s, tick.dt_s)));
            t += tick.dt_s;
        }
        let error = attitude(t).conjugate().product(with).normalized().angle().to_degrees();
        assert!(error < 0.5, "{error} degrees after {t} s");
    }

    #[test]
    fn a_gap_is_lost_ticks_that_are_counted() {
        let readings = (0..100).chain(200..300).map(|k| constant(k * 1200));
        let found = ticks(readings);
        let jumps: Vec<u64> = found.windows(2).map(|two| two[1].number - two[0].number).collect();
        assert_eq!(jumps.iter().filter(|&&jump| jump != 1).count(), 1);
        let jump = jumps.iter().max().unwrap();
        // 121.2 ms from reading to reading
        assert!((14..=16).contains(jump), "{jump}");
        assert!(found.iter().all(|tick| (tick.gyro_rad_s[2] - 3.0).abs() < 1e-12));
        assert!(found.iter().all(|tick| (tick.dt_s * 1e6 - 8333.4).abs() < 0.7));
    }

    #[test]
    fn readings_out_of_order_are_left_out() {
        let found = ticks([0, 1200, 600, 1200, 2400, 9000].into_iter().map(constant));
        assert_eq!(found.len(), 1);
        assert!((found[0].gyro_rad_s[0] - 1.0).abs() < 1e-12);
    }
}
