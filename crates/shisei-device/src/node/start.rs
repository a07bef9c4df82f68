//! The start: gyroscope bias and attitude from two seconds at rest.

use shisei_core::vector::{add, scale};
use shisei_core::{Quaternion, Vec3, initial, math, vector};
use shisei_wire::packet::Start;

use super::tick::Tick;

/// How long the bias is averaged, µs.
pub const DURATION_US: u64 = 2_000_000;
/// Fewer ticks than this, and no bias is removed.
pub const TICKS_MIN: u32 = 10;
/// A deviation of the rate beyond this means that the node was moved, rad/s.
const MOVED_RAD_S: f64 = 0.05;

/// What the start found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    /// To be subtracted from rates, rad/s.
    pub bias_rad_s: Vec3,
    /// From the mean acceleration; identity where there is none.
    pub world_from_body: Quaternion,
    /// How sure the bias is, rad/s: the scatter of the rates about it, so that a node that was held in a hand is less
    /// sure than one that lay on a table. None where it is not to be relied on.
    pub bias_sigma_rad_s: Option<f64>,
    /// How it went.
    pub start: Start,
}

/// Averages.
#[derive(Clone, Copy, Debug, Default)]
pub struct Starter {
    begun_us: Option<u64>,
    ticks: u32,
    gyro: Vec3,
    gyro_squared: f64,
    acc: Vec3,
}

impl Starter {
    /// Takes a tick; tells what was found once two seconds have passed.
    pub fn push(&mut self, tick: &Tick) -> Option<Found> {
        let begun_us = *self.begun_us.get_or_insert(tick.time_us);
        self.ticks += 1;
        self.gyro = add(self.gyro, tick.gyro_rad_s);
        self.gyro_squared += vector::dot(tick.gyro_rad_s, tick.gyro_rad_s);
        self.acc = add(self.acc, tick.acc_m_s2);
        (tick.time_us.saturating_sub(begun_us) + 8_334 >= DURATION_US).then(|| self.found())
    }

    fn found(&self) -> Found {
        let share = 1.0 / f64::from(self.ticks);
        let mean = scale(self.gyro, share);
        let variance = self.gyro_squared * share - vector::dot(mean, mean);
        let start = if self.ticks < TICKS_MIN {
            Start::Skipped
        } else if variance > MOVED_RAD_S * MOVED_RAD_S {
            Start::Moved
        } else {
            Start::Done
        };
        Found {
            bias_rad_s: if start == Start::Skipped { [0.0; 3] } else { mean },
            world_from_body: initial::from_mean_acceleration(scale(self.acc, share))
                .unwrap_or(Quaternion::IDENTITY),
            bias_sigma_rad_s: (start == Start::Done).then(|| math::sqrt(variance.max(0.0))),
            start,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(three_steps_us: u64, gyro: impl Fn(u64) -> f64) -> Found {
        let mut starter = Starter::default();
        for number in 0.. {
            let gyro_rad_s = [gyro(number), 0.02, -0.03];
            let acc_m_s2 = [0.0, 9.8, 0.0];
            let (time_us, dt_s) = (number * three_steps_us / 3, 8.3e-3);
            let tick = Tick { number, time_us, dt_s, gyro_rad_s, acc_m_s2, reading_missed: false };
            if let Some(found) = starter.push(&tick) {
                return found;
            }
        }
        unreachable!()
    }

    #[test]
    fn bias_is_the_mean_and_up_is_up() {
        let found = run(25_000, |number| if number % 2 == 0 { 0.012 } else { 0.008 });
        assert_eq!(found.start, Start::Done);
        for (axis, expected) in [0.01, 0.02, -0.03].into_iter().enumerate() {
            assert!((found.bias_rad_s[axis] - expected).abs() < 1e-12);
        }
        assert!((found.world_from_body.rotate([0.0, 1.0, 0.0])[2] - 1.0).abs() < 1e-12);
        // ±0.002 about the mean
        assert!((found.bias_sigma_rad_s.unwrap() - 0.002).abs() < 1e-9, "{found:?}");
    }

    #[test]
    fn too_few_ticks_skip_it_and_motion_is_said() {
        assert_eq!(run(900_000, |_| 0.01).start, Start::Skipped);
        assert_eq!(run(900_000, |_| 0.01).bias_rad_s, [0.0; 3]);
        let moved = run(25_000, |number| if number % 2 == 0 { 1.0 } else { -1.0 });
        assert_eq!((moved.start, moved.bias_sigma_rad_s), (Start::Moved, None));
    }
}
