//! Rates and latencies, counted while they happen.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

/// Rates are counted over so much time.
const WINDOW: Duration = Duration::from_secs(2);
/// Latencies that are remembered.
const LATENCIES: usize = 4096;

/// How often something comes.
#[derive(Clone, Debug, Default)]
pub struct Rate {
    /// When and how many.
    came: VecDeque<(Instant, u32)>,
}

impl Rate {
    /// So many came now.
    pub fn add(&mut self, at: Instant, count: u32) {
        // what came within the same moment is one entry: bounded memory
        match self.came.back_mut() {
            Some((last, sum)) if at.saturating_duration_since(*last) < Duration::from_millis(5) => {
                *sum += count;
            }
            _ => self.came.push_back((at, count)),
        }
        self.forget(at);
    }

    fn forget(&mut self, now: Instant) {
        while self.came.front().is_some_and(|(at, _)| now.saturating_duration_since(*at) > WINDOW) {
            self.came.pop_front();
        }
    }

    /// How many a second, Hz.
    pub fn hz(&mut self, now: Instant) -> f64 {
        self.forget(now);
        let Some((first, _)) = self.came.front() else { return 0.0 };
        let length_s = now.saturating_duration_since(*first).as_secs_f64().max(0.25);
        self.came.iter().map(|(_, count)| f64::from(*count)).sum::<f64>() / length_s
    }

    /// Time since the last, s.
    pub fn silent_s(&self, now: Instant) -> Option<f64> {
        self.came.back().map(|(at, _)| now.saturating_duration_since(*at).as_secs_f64())
    }
}

/// From a sample's arrival to its pose.
#[derive(Clone, Debug, Default)]
pub struct Latency {
    seconds: VecDeque<f32>,
}

impl Latency {
    /// One more.
    pub fn add(&mut self, took: Duration) {
        if self.seconds.len() >= LATENCIES {
            self.seconds.pop_front();
        }
        self.seconds.push_back(took.as_secs_f32());
    }

    /// Median and 99th percentile of the newest, ms.
    pub fn ms(&self) -> Option<(f64, f64)> {
        let mut sorted: Vec<f32> = self.seconds.iter().copied().collect();
        sorted.sort_by(f32::total_cmp);
        let at = |share: f64| sorted.get((share * (sorted.len() as f64 - 1.0)).round() as usize);
        Some((f64::from(*at(0.5)?) * 1e3, f64::from(*at(0.99)?) * 1e3))
    }
}
