//! Inputs that are the same everywhere: integers turned into numbers exactly.

use shisei_core::{Quaternion, Vec3};

/// A linear congruential generator (D. Knuth's MMIX constants); its upper 53 bits become numbers without rounding.
#[derive(Clone, Debug)]
pub struct Input(u64);

impl Input {
    /// One stream a topic.
    pub const fn new(seed: u64) -> Self {
        Input(seed)
    }

    /// The next number in −1 … 1, a multiple of 2⁻⁵².
    pub fn signed(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        // 53 bits minus 2^52 is exact in f64
        ((self.0 >> 11) as f64 - 4_503_599_627_370_496.0) / 4_503_599_627_370_496.0
    }

    /// Three numbers in −`largest` … `largest`.
    pub fn vec3(&mut self, largest: f64) -> Vec3 {
        [largest * self.signed(), largest * self.signed(), largest * self.signed()]
    }

    /// A unit quaternion, not uniformly distributed.
    pub fn quaternion(&mut self) -> Quaternion {
        let q = Quaternion::new(self.signed(), self.signed(), self.signed(), self.signed());
        q.try_normalized().unwrap_or(Quaternion::IDENTITY)
    }
}
