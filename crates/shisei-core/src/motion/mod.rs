//! From acceleration to velocity and position, with an error band.

mod dead_reckoning;
pub mod error_state;
#[cfg(feature = "alloc")]
pub mod foot;
#[cfg(feature = "alloc")]
pub mod holes;
#[cfg(feature = "alloc")]
pub mod navigation;
#[cfg(feature = "alloc")]
pub mod rest_to_rest;
#[cfg(feature = "alloc")]
pub mod step_by_step;

pub use dead_reckoning::{DeadReckoning, MotionState, Scheme};
