//! From acceleration to velocity and position.

mod dead_reckoning;

pub use dead_reckoning::{DeadReckoning, MotionState, Scheme};
