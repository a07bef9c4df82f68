//! One file a command.

pub mod apply;
pub mod calibrate;
pub mod info;
pub mod orient;
