//! The watch: whether the specific force, as an attitude sees it, still is gravity on average.

use crate::vector::{self, Vec3};

/// Time constant of the average, s.
const MEAN_S: f64 = 2.0;
/// No one accelerates by this share of gravity on average over such a time.
const SHARE: f64 = 0.35;
/// How long it must look so, s.
const HOLD_S: f64 = 1.0;

/// Mean specific force in the world, and for how long it has been strange.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Watch {
    gravity: f64,
    mean: Vec3,
    strange_s: f64,
}

impl Watch {
    pub(super) fn new(gravity: f64) -> Self {
        Watch { gravity, mean: [0.0, 0.0, gravity], strange_s: 0.0 }
    }

    /// Takes the sum of force times step over an interval, m/s, and its length, s. True when it can no longer be.
    pub(super) fn update(&mut self, force: Vec3, time_s: f64) -> bool {
        if time_s <= 0.0 {
            return false;
        }
        let share = (time_s / MEAN_S).min(1.0);
        let now = vector::scale(force, 1.0 / time_s);
        self.mean = vector::add(self.mean, vector::scale(vector::sub(now, self.mean), share));
        let off = vector::norm(vector::sub(self.mean, [0.0, 0.0, self.gravity]));
        self.strange_s = if off <= SHARE * self.gravity { 0.0 } else { self.strange_s + time_s };
        self.strange_s > HOLD_S
    }
}
