//! The estimator: attitude with its uncertainty, from a gyroscope and an accelerometer.
#[cfg(feature = "alloc")]
mod backward;
mod calibration;
mod covariance;
mod engine;
mod guard;
mod level;
mod model;
mod online;
mod rest;
mod runner;
#[cfg(feature = "alloc")]
mod segments;
mod settings;
#[cfg(feature = "alloc")]
mod smoother;
pub use calibration::{CALIBRATION_STATES, Calibration};
pub use engine::OpticalPose;
pub use guard::Sample;
pub use online::{Estimator, State};
pub use rest::RestLimits;
pub use settings::{Model, Settings};
#[cfg(feature = "alloc")]
pub use smoother::{Smoothed, smooth};
