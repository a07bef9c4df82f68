//! Motive's tracking CSV (OptiTrack), versions 1.21 to 1.25: read, changed, written back.
//!
//! A [`Take`] holds the file as it is: the first row's keys and values, the heading of every column, the
//! numbers in the file's own unit and rotation type. Nothing is counted from the left or from the top: the row
//! whose first cell is `Frame` ends the heading, and the columns that carry data begin after `Frame`, `Time …`
//! and `TimeCode`. [`Body`] and [`Marker`] say which columns belong together; [`Take::pose`] and
//! [`Take::set_pose`] turn them into metres and quaternions and back.
//!
//! What a take means: quaternions are X, Y, Z, W, body to world; Euler angles are degrees about the body's own
//! axes in the order that the rotation type names (`XYZ`: R = Rx Ry Rz); the world is y-up unless its owner
//! changed it; time is frame number / export rate, because the time column may be cut to milliseconds.

mod body;
mod error;
mod loss;
mod note;
mod pulses;
mod read;
mod take;
mod write;

pub use body::{Body, Marker, MarkerKind};
pub use error::{Error, Problem, Result};
pub use loss::LossRule;
pub use pulses::read_pulses;
pub use read::{looks_like, read};
pub use take::{Column, Rotation, Style, Take};
pub use write::{is_ours, write};
