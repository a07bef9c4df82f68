//! Calibration of accelerometers and gyroscopes.

pub mod affine;
#[cfg(feature = "alloc")]
pub mod gyro_turns;
#[cfg(feature = "alloc")]
pub mod known_turns;
#[cfg(feature = "alloc")]
pub mod multi_pose;
#[cfg(feature = "alloc")]
pub mod recording;
#[cfg(feature = "alloc")]
pub mod still;
