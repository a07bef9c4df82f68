//! The estimator: attitude with its uncertainty, from a gyroscope and an accelerometer.
//!
//! An error-state Kalman filter of attitude, velocity, position, gyroscope bias, accelerometer bias, gyroscope
//! matrix and accelerometer scale. It knows gravity, rests, and that what is held by somebody does not go away: its
//! speed and its place are bounded. From that it learns the sensor's errors while it moves. docs/en/estimator.md
//! has the equations, every setting, what was measured and where it fails.
//!
//! - [`Estimator`]: live, sample by sample, without an allocator; [`LightEstimator`]: smaller, for microcontrollers;
//! - [`FixedLag`]: live with a delay of up to a few seconds;
//! - [`smooth`]: a recording;
//! - [`bridge`]: a recording that an optical system sees most of the time; [`LiveBridge`]: the same live;
//!   [`FixedLagBridge`]: the same with a delay of a few seconds;
//! - [`Calibration`]: what was learnt of a sensor, to start from.
// What the backward pass reads is written by the forward pass, which is there without an allocator too.
#![cfg_attr(not(feature = "alloc"), allow(dead_code))]

#[cfg(feature = "alloc")]
mod backward;
mod between;
#[cfg(feature = "alloc")]
mod bridge;
mod calibration;
mod covariance;
mod engine;
mod guard;
#[cfg(feature = "alloc")]
mod lag;
#[cfg(feature = "alloc")]
mod lag_bridge;
mod level;
mod light;
#[cfg(feature = "alloc")]
mod live_bridge;
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
mod told;
mod transition;
mod watch;

#[cfg(feature = "alloc")]
pub(crate) use bridge::bridge_by_points;
#[cfg(feature = "alloc")]
pub use bridge::{BridgeSettings, Bridged, bridge};
pub use calibration::{CALIBRATION_STATES, Calibration};
pub use engine::OpticalPose;
#[cfg(feature = "alloc")]
pub(crate) use engine::{POINTS, Point, Points};
pub use guard::Sample;
#[cfg(feature = "alloc")]
pub use lag::FixedLag;
#[cfg(feature = "alloc")]
pub use lag_bridge::FixedLagBridge;
pub use light::LightEstimator;
#[cfg(feature = "alloc")]
pub use live_bridge::LiveBridge;
pub use online::{Estimator, State};
pub use rest::RestLimits;
#[cfg(feature = "alloc")]
pub(crate) use runner::heading_between;
pub use settings::{Model, Settings};
#[cfg(feature = "alloc")]
pub use smoother::{InTurn, Pair, Smoothed, smooth, smooth_each};
