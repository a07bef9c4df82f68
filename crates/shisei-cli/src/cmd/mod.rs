//! One file a command.

pub mod allan;
pub mod apply;
pub mod calibrate;
mod calibrate_poses;
pub mod convert;
pub mod devices;
pub mod earth;
mod earth_serial;
mod earth_text;
pub mod fuse;
pub mod info;
pub mod live;
mod live_serial;
pub mod motion;
pub mod orient;
mod ports;
pub mod record;
pub mod simulate;
