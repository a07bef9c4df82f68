//! Calibrations: what a sensor's readings are corrected by, and how it is found.

mod apply;
mod fit;
#[cfg(feature = "alloc")]
pub mod gyro_turns;
#[cfg(feature = "alloc")]
pub mod known_turns;
#[cfg(feature = "alloc")]
pub mod multi_pose;
#[cfg(feature = "alloc")]
pub mod recording;
#[cfg(feature = "alloc")]
mod search;
mod six_face;
#[cfg(feature = "alloc")]
pub mod still;

pub use apply::{Calibration, SensorModel};
#[cfg(feature = "alloc")]
pub use search::search_faces;
#[cfg(feature = "alloc")]
pub use six_face::six_face;
pub use six_face::{FaceRow, FaceState, FaceTable, FaceWindow, SixFace, SixFaceSettings, solve};
