//! The estimator: attitude with its uncertainty, from a gyroscope and an accelerometer.
#[cfg(feature = "alloc")]
mod backward;
#[cfg(feature = "alloc")]
mod bridge;
mod calibration;
mod covariance;
mod engine;
mod guard;
#[cfg(feature = "alloc")]
mod lag;
mod level;
mod light;
mod model;
mod online;
mod rest;
mod runner;
#[cfg(feature = "alloc")]
mod segments;
mod settings;
#[cfg(feature = "alloc")]
mod smoother;
#[cfg(feature = "alloc")]
pub use bridge::{BridgeSettings, Bridged, bridge};
pub use calibration::{CALIBRATION_STATES, Calibration};
pub use engine::OpticalPose;
pub use guard::Sample;
#[cfg(feature = "alloc")]
pub use lag::FixedLag;
pub use light::LightEstimator;
pub use online::{Estimator, State};
pub use rest::RestLimits;
pub use settings::{Model, Settings};
#[cfg(feature = "alloc")]
pub use smoother::{Smoothed, smooth};
