//! One file a command.

pub mod apply;
pub mod calibrate;
pub mod convert;
pub mod info;
pub mod orient;
