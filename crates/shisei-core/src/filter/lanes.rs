//! Attitudes side by side, a component of all of them in a row, as vectors of processors take them.

use crate::euler::{AttitudeRow, ypr_lanes};
use crate::quaternion::Quaternion;

/// Attitudes side by side.
pub(super) const LANES: usize = 8;

/// A number of each lane.
pub(super) type Lane = [f64; LANES];

/// A quaternion of each lane.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lanes {
    w: Lane,
    x: Lane,
    y: Lane,
    z: Lane,
}

impl Lanes {
    pub(super) const IDENTITY: Lanes =
        Lanes { w: [1.0; LANES], x: [0.0; LANES], y: [0.0; LANES], z: [0.0; LANES] };

    #[inline(always)]
    pub(super) fn at(&self, lane: usize) -> Quaternion {
        Quaternion::new(self.w[lane], self.x[lane], self.y[lane], self.z[lane])
    }

    #[inline(always)]
    pub(super) fn set(&mut self, lane: usize, q: Quaternion) {
        [self.w[lane], self.x[lane], self.y[lane], self.z[lane]] = q.to_array();
    }

    /// Gives every lane's attitude, of unit norm, in the form that is asked for.
    #[inline(always)]
    pub(super) fn write<O: AttitudeRow>(&self, mut to: impl FnMut(usize, O)) {
        if O::ANGLES {
            let ypr_rad = ypr_lanes(&self.w, &self.x, &self.y, &self.z);
            for lane in 0..LANES {
                to(lane, O::from_angles(ypr_rad[lane]));
            }
        } else {
            for lane in 0..LANES {
                to(lane, O::from(self.at(lane)));
            }
        }
    }
}
