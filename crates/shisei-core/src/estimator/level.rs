//! The start, and the start anew after a gap: level by the mean acceleration of half a second, turned along with
//! the gyroscope, so that the sensor may move meanwhile.

use super::guard::Reading;
use crate::filter::exponential::advance;
use crate::initial;
use crate::math;
use crate::quaternion::Quaternion;
use crate::vector::{self, Vec3};

/// Accelerations that vary by more than this are those of a sensor in motion, m/s².
const MOVING: f64 = 0.3;

/// Mean acceleration in axes that do not turn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Leveller {
    /// Carried along by the gyroscope; not level yet.
    pub carried: Quaternion,
    /// Yaw is to be zero at the first reading; else the heading is kept.
    first: bool,
    sum: Vec3,
    squares: f64,
    count: f64,
    pub time_s: f64,
}

impl Leveller {
    /// From an attitude whose heading is to be kept, or from none.
    pub(super) fn new(from: Option<Quaternion>) -> Self {
        let (first, carried) = (from.is_none(), from.unwrap_or(Quaternion::IDENTITY));
        Leveller { carried, first, sum: [0.0; 3], squares: 0.0, count: 0.0, time_s: 0.0 }
    }

    /// Takes a reading; `rate` is its corrected rate, rad/s, `force` its corrected acceleration. The first
    /// reading's step lies before the start.
    pub(super) fn add(&mut self, reading: &Reading, rate: Vec3, force: Vec3) {
        if self.count > 0.0 {
            self.carried = advance(self.carried, vector::scale(rate, 0.5 * reading.dt_s));
            self.time_s += reading.dt_s;
        }
        let force = self.carried.rotate(force);
        self.sum = vector::add(self.sum, force);
        self.squares += vector::dot(force, force);
        self.count += 1.0;
    }

    /// Begins anew after a turn that is hardly known; the heading goes on.
    pub(super) fn turn(&mut self, turn: &Quaternion) {
        let carried = self.carried.product(*turn).normalized();
        *self = Leveller { carried, sum: [0.0; 3], squares: 0.0, count: 0.0, time_s: 0.0, ..*self };
    }

    /// The attitude now: carried along, and levelled.
    pub(super) fn attitude(&self) -> Quaternion {
        let turn = if self.first && self.sum != [0.0; 3] {
            initial::from_direction(self.sum, 0.0)
        } else {
            initial::level(Quaternion::IDENTITY, self.sum)
        };
        turn.product(self.carried).normalized()
    }

    /// How far the mean acceleration is from gravity, m/s², where nothing else moves: what an accelerometer that
    /// was never calibrated shows.
    pub(super) fn off_gravity(&self, gravity: f64) -> f64 {
        let n = self.count.max(1.0);
        let mean = vector::scale(self.sum, 1.0 / n);
        let spread = self.squares / n - vector::dot(mean, mean);
        if spread > MOVING * MOVING { 0.0 } else { (vector::norm(mean) - gravity).abs() }
    }

    /// Standard deviation of its tilt, rad: `rest` where nothing moves; where the acceleration varies by s, up to
    /// s/g more, for motion does not average out in so short a time.
    pub(super) fn sigma(&self, rest: f64, gravity: f64) -> f64 {
        let n = self.count.max(1.0);
        let mean = vector::scale(self.sum, 1.0 / n);
        let spread = (self.squares / n - vector::dot(mean, mean)).max(0.0) / (gravity * gravity);
        let off = vector::norm(mean) / gravity - 1.0;
        math::sqrt((rest * rest + spread + off * off).min(1.0))
    }
}
