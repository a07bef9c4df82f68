//! A crystal's clock.

/// Offset and skew against true time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clock {
    /// True time of its start, s.
    pub started_s: f64,
    /// What it shows at its start, µs.
    pub offset_us: f64,
    /// How much faster it is, 1.
    pub skew: f64,
}

impl Clock {
    /// What it shows, µs, with fractions.
    pub fn exact_us(&self, time_s: f64) -> f64 {
        self.offset_us + (time_s - self.started_s) * (1.0 + self.skew) * 1e6
    }

    /// What it shows in whole µs.
    pub fn us(&self, time_s: f64) -> u64 {
        self.exact_us(time_s).max(0.0) as u64
    }

    /// The true time at which it shows this, s.
    pub fn true_s(&self, shown_us: f64) -> f64 {
        self.started_s + (shown_us - self.offset_us) / ((1.0 + self.skew) * 1e6)
    }
}
