//! What was so.

use shisei_core::clock::unwrap_near;

use super::clock::Clock;

/// One start of a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Boot {
    /// Its random number.
    pub id: u16,
    /// Its clock since then.
    pub clock: Clock,
}

impl Boot {
    /// The true time of a 32-bit stamp, the one nearest to `near_s`.
    pub fn true_time_s(&self, stamp_us: u32, near_s: f64) -> f64 {
        let expected = self.clock.exact_us(near_s) as i64;
        self.clock.true_s(unwrap_near(stamp_us, 32, expected) as f64)
    }
}
