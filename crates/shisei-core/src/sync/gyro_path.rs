//! The gyroscope's turns between any two times.
//!
//! `start_from_sensor(t)` by exact steps of a constant rate. What a reading stands for is said by [`Stamp`].

use alloc::vec::Vec;

use crate::error::{Error, Result};
use crate::filter::{check_rows, same_length};
use crate::quaternion::Quaternion;
use crate::vector::{self, Vec3};

/// What the time of a reading means.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Stamp {
    /// The reading is the mean rate of the step that ends at its time: how all filters of shisei take it, and how
    /// a sensor's output register fills. Attitude "after sample k" belongs to the time of sample k.
    #[default]
    End,
    /// The reading is the rate at its time: a simulated sensor, or one whose delays were taken out. The clock
    /// offset then comes out half a step larger than with `End`.
    Instant,
}

/// A step longer than this many usual ones is a hole: no turn is known across it.
pub const HOLE_STEPS: f64 = 3.5;

/// Turns of a sensor since its recording's start.
#[derive(Clone, Debug)]
pub struct GyroPath<'a> {
    time_s: &'a [f64],
    start_from_sensor: Vec<Quaternion>,
    /// Holes before each row.
    holes: Vec<u32>,
    step_s: f64,
}

impl<'a> GyroPath<'a> {
    /// From ascending times, s, and rates, rad/s. Refused: fewer than two rows, unequal lengths, numbers that are
    /// not finite, times that do not ascend.
    pub fn new(time_s: &'a [f64], gyro_rad_s: &[Vec3], stamp: Stamp) -> Result<Self> {
        same_length(time_s.len(), gyro_rad_s.len())?;
        if time_s.len() < 2 {
            return Err(Error::TooFewPoints { given: time_s.len(), needed: 2 });
        }
        check_rows(gyro_rad_s, 0)?;
        let mut steps = Vec::with_capacity(time_s.len() - 1);
        for (row, pair) in time_s.windows(2).enumerate() {
            let step = pair[1] - pair[0];
            if !step.is_finite() {
                return Err(Error::NotFinite { row: row + 1 });
            }
            if step <= 0.0 {
                return Err(Error::OutOfOrder { rule: "time_s ascends" });
            }
            steps.push(step);
        }
        let step_s = median(&mut steps.clone());
        let mut q = Quaternion::IDENTITY;
        let mut start_from_sensor = Vec::with_capacity(time_s.len());
        let mut holes = Vec::with_capacity(time_s.len());
        let mut hole = 0;
        start_from_sensor.push(q);
        holes.push(hole);
        for (row, step) in steps.iter().enumerate() {
            let mean = vector::scale(vector::add(gyro_rad_s[row], gyro_rad_s[row + 1]), 0.5);
            // where readings are missing, the mean of those around stands for them
            let own_s = if stamp == Stamp::End { step_s.min(*step) } else { 0.0 };
            let turn =
                vector::add(vector::scale(gyro_rad_s[row + 1], own_s), vector::scale(mean, step - own_s));
            q = q.product(Quaternion::from_rotation_vector(turn)).normalized();
            hole += u32::from(*step > HOLE_STEPS * step_s);
            start_from_sensor.push(q);
            holes.push(hole);
        }
        Ok(GyroPath { time_s, start_from_sensor, holes, step_s })
    }

    /// The usual step, s.
    pub fn step_s(&self) -> f64 {
        self.step_s
    }

    /// First and last time, s.
    pub fn span_s(&self) -> (f64, f64) {
        (self.time_s[0], self.time_s[self.time_s.len() - 1])
    }

    /// The turn between two times as a rotation vector in the sensor's coordinates at the first, rad; none
    /// outside the recording, across a hole, or when the times are not in order.
    pub fn turn(&self, from_s: f64, to_s: f64) -> Option<Vec3> {
        let (a, b) = (self.row(from_s)?, self.row(to_s)?);
        // the row after `to`: a hole in its step counts too
        if from_s > to_s || self.holes[a] != self.holes[b + 1] {
            return None;
        }
        let (qa, qb) = (self.inside(a, from_s), self.inside(b, to_s));
        Some(qa.conjugate().product(qb).to_rotation_vector())
    }

    /// The row at or before a time that has one after it.
    fn row(&self, time_s: f64) -> Option<usize> {
        let last = self.time_s.len() - 1;
        if !(time_s >= self.time_s[0] && time_s <= self.time_s[last]) {
            return None;
        }
        let after = self.time_s.partition_point(|t| *t <= time_s);
        Some(after.clamp(1, last) - 1)
    }

    fn inside(&self, row: usize, time_s: f64) -> Quaternion {
        let share = (time_s - self.time_s[row]) / (self.time_s[row + 1] - self.time_s[row]);
        Quaternion::slerp(self.start_from_sensor[row], self.start_from_sensor[row + 1], share)
    }
}

/// The middle value (the upper one of two); 0 for none.
pub(crate) fn median(values: &mut [f64]) -> f64 {
    let middle = values.len() / 2;
    if values.is_empty() {
        return 0.0;
    }
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_of_a_steady_rate() {
        let time: Vec<f64> = (0..101).map(|k| f64::from(k) * 0.01).collect();
        let path = GyroPath::new(&time, &[[0.3, -0.4, 1.2]; 101], Stamp::Instant).unwrap();
        let turn = path.turn(0.1234, 0.4567).unwrap();
        for (found, rate) in turn.iter().zip([0.3, -0.4, 1.2]) {
            assert!((found - rate * 0.3333).abs() < 1e-14);
        }
        assert!(path.turn(0.0, 1.0).is_some() && path.turn(-0.01, 0.5).is_none());
        assert!(path.turn(0.5, 1.01).is_none() && path.turn(0.5, 0.4).is_none());
    }

    /// A rate that grows by 1 rad/s² from 0: the turn to t is t²/2. A reading at its instant gives it exactly; one
    /// that is taken for the step before it is half a step ahead.
    #[test]
    fn what_a_stamp_means() {
        let time: Vec<f64> = (0..101).map(|k| f64::from(k) * 0.01).collect();
        let gyro: Vec<Vec3> = time.iter().map(|t| [0.0, *t, 0.0]).collect();
        let turn = |stamp| GyroPath::new(&time, &gyro, stamp).unwrap().turn(0.0, 0.5).unwrap()[1];
        assert!((turn(Stamp::Instant) - 0.125).abs() < 1e-12);
        let ahead = 0.5 * (0.505 * 0.505 - 0.005 * 0.005);
        assert!((turn(Stamp::End) - ahead).abs() < 1e-12);
    }

    #[test]
    fn holes_are_not_crossed() {
        let time: Vec<f64> = (0..100).map(|k| f64::from(k) * 0.01 + if k > 50 { 0.1 } else { 0.0 }).collect();
        let path = GyroPath::new(&time, &[[1.0, 0.0, 0.0]; 100], Stamp::End).unwrap();
        assert!(path.turn(0.1, 0.499).is_some() && path.turn(0.62, 1.0).is_some());
        assert!(
            path.turn(0.1, 0.55).is_none() && path.turn(0.55, 0.8).is_none() && path.turn(0.1, 0.8).is_none()
        );
        assert!(GyroPath::new(&[0.0, 0.0], &[[0.0; 3]; 2], Stamp::End).is_err());
    }
}
