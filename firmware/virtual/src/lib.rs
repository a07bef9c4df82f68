//! Nodes and a receiver on this machine: the boards' logic and Bluetooth host over virtual controllers.
//!
//! True time is the machine's monotonic clock since a base that the controllers know too; every controller and every
//! device has a clock with offset and skew. Camera pulse k is at k/120 s.

mod controllers;
mod node;
mod receiver;

use std::time::{SystemTime, UNIX_EPOCH};

pub use controllers::{Controllers, begin, free_ports, open, python, script};
pub use node::VirtualNode;
pub use receiver::{Recorded, listen};

/// Camera frames a second.
pub const CAMERA_HZ: f64 = 120.0;

/// µs of the machine's monotonic clock.
pub fn monotonic_us() -> u64 {
    let now = rustix::time::clock_gettime(rustix::time::ClockId::Monotonic);
    now.tv_sec as u64 * 1_000_000 + now.tv_nsec as u64 / 1_000
}

/// A number that differs from run to run.
pub fn arbitrary() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(1, |time| u64::from(time.subsec_nanos()))
}

/// A device's clock.
#[derive(Clone, Copy, Debug)]
pub struct DeviceClock {
    /// The monotonic clock at true time 0, µs.
    pub base_us: u64,
    /// What it shows at true time 0, µs.
    pub offset_us: f64,
    /// Its skew, ppm.
    pub ppm: f64,
}

impl DeviceClock {
    /// What it shows at a true time.
    pub fn at_us(&self, time_s: f64) -> f64 {
        time_s * 1e6 * (1.0 + self.ppm * 1e-6) + self.offset_us
    }

    /// The true time of what it shows, s.
    pub fn true_s(&self, shown_us: f64) -> f64 {
        (shown_us - self.offset_us) / (1.0 + self.ppm * 1e-6) * 1e-6
    }

    /// True time now, s.
    pub fn now_s(&self) -> f64 {
        (monotonic_us() - self.base_us) as f64 * 1e-6
    }
}

impl shisei_board::Clock for DeviceClock {
    fn now_us(&self) -> u64 {
        self.at_us(self.now_s()) as u64
    }

    fn from_controller_us(&self, controller_us: u64) -> u64 {
        controller_us
    }
}
