//! An end that was given, held against where the readings lead.

use super::{NavigationSettings, Run};
use crate::math;
use crate::motion::error_state::POSITION;
use crate::vector::{self, Vec3};

/// An end that was given against where the readings lead.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GivenEnd {
    /// How far they are apart, m.
    pub off_m: f64,
    /// Standard deviation of where the readings lead (root of the three axes' sum), m.
    pub sigma_m: f64,
    /// The Mahalanobis distance, in standard deviations of both.
    pub distance: f64,
}

impl GivenEnd {
    /// Whether the two hardly agree: further apart than 0.27 % of ends are that agree (of three normal errors; on one
    /// axis these are 3 standard deviations).
    pub fn is_doubtful(&self) -> bool {
        // √χ²₃ at 0.9973
        self.distance > 3.763
    }
}

impl Run<'_> {
    /// What the band of a row is widened by.
    pub(super) fn band_factor(&self, row: usize) -> f64 {
        let NavigationSettings { band_factor, hole_motion, .. } = self.settings;
        if self.bridged.is_some_and(|first| first <= row) {
            band_factor * hole_motion.band_factor
        } else {
            *band_factor
        }
    }

    /// An end that is given against where the readings led.
    pub(super) fn compare(&self, end: Vec3, sigma: f64) -> GivenEnd {
        let off = vector::sub(end, self.position);
        let factor = self.band_factor(self.acc.len());
        let factor = factor * factor;
        let (mut s, mut trace) = ([[0.0; 3]; 3], 0.0);
        for i in 0..3 {
            for j in 0..3 {
                s[i][j] = factor * self.p[POSITION + i][POSITION + j];
            }
            trace += s[i][i];
            s[i][i] += sigma * sigma;
        }
        let square = crate::matrix::inverse(&s)
            .map_or(f64::INFINITY, |inverse| vector::dot(off, crate::matrix::times_vector(&inverse, &off)));
        GivenEnd {
            off_m: vector::norm(off),
            sigma_m: math::sqrt(trace),
            distance: math::sqrt(square.max(0.0)),
        }
    }
}
