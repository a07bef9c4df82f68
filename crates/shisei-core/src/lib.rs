//! Attitude, calibration and motion from accelerometer and gyroscope readings.
//!
//! Conventions, everywhere in shisei:
//! - quaternions are Hamilton's, ordered w, x, y, z, of unit norm; `world_from_body` turns body (sensor)
//!   coordinates into world coordinates: `v_world = q v_body q*`;
//! - the world is right-handed with z up; a level accelerometer at rest reads (0, 0, +9.80665) m/s²;
//! - angles are radians, rates rad/s, accelerations m/s², times s; yaw, pitch, roll are Z-Y-X intrinsic;
//! - a series has one sample a row; row k of a result is the state after sample k.
//!
//! The same input gives the same bits on every target: f64 only, no fused multiply-add, a fixed order of
//! operations, and all transcendental functions through [`math`].
#![cfg_attr(not(test), no_std)]
#![warn(missing_docs)]

#[cfg(feature = "alloc")]
extern crate alloc;

#[cfg(feature = "alloc")]
pub mod alignment;
#[cfg(feature = "alloc")]
pub mod allan;
pub mod calibration;
pub mod clock;
pub mod earth;
pub mod error;
pub mod estimator;
pub mod euler;
pub mod filter;
pub mod frames;
#[cfg(feature = "alloc")]
pub mod fuse;
pub mod heading;
pub mod initial;
pub mod lanes;
pub mod least_squares;
pub mod math;
pub mod matrix;
pub mod motion;
#[cfg(feature = "alloc")]
pub mod orient;
pub mod quaternion;
pub mod relative;
pub mod rest;
pub mod sphere;
pub mod statistics;
#[cfg(feature = "alloc")]
pub mod sync;
pub mod vector;

pub use error::{Error, Face, Kind, Lang, Result};
pub use euler::{AttitudeRow, Ypr};
pub use quaternion::Quaternion;
pub use vector::Vec3;

/// Standard gravity, m/s² (CGPM 1901): the default wherever a gravity can be given.
pub const STANDARD_GRAVITY_M_S2: f64 = 9.80665;
/// Largest rate that is taken for a reading, rad/s: sensors of motion read up to 4000 °/s, which are 70.
pub const LARGEST_RATE_RAD_S: f64 = 100.0;
/// Largest acceleration that is taken for a reading, m/s²: sensors of motion read up to 16 g, those for blows to the
/// body up to 200 g.
pub const LARGEST_ACC_M_S2: f64 = 2000.0;
