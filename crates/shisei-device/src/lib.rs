//! What a node and a receiver do, without their hardware.
//!
//! - [`node`]: readings of the sensor in, packets out: every reading is integrated into its 120 Hz tick; bias and
//!   start from two seconds at rest; attitude; batches that survive a lost link;
//! - [`receiver`]: links to up to six nodes, camera pulses and the recording gate in, serial frames out.
//!
//! Neither waits, allocates or knows a pin. A board (or a simulator) calls them with what happened and when, and does
//! what they return; [`node::Board`] is what a node needs of its board. Times are µs of the device's own clock.
#![cfg_attr(not(test), no_std)]
#![warn(missing_docs)]

pub mod node;
pub mod receiver;

/// Version of this logic, as told over the air and over the wire: major, minor, patch.
pub const FIRMWARE: [u8; 3] = [
    digits(env!("CARGO_PKG_VERSION_MAJOR")),
    digits(env!("CARGO_PKG_VERSION_MINOR")),
    digits(env!("CARGO_PKG_VERSION_PATCH")),
];

/// The number that a few digits mean.
const fn digits(text: &str) -> u8 {
    let (bytes, mut k, mut value) = (text.as_bytes(), 0, 0_u8);
    while k < bytes.len() {
        value = value.wrapping_mul(10).wrapping_add(bytes[k].wrapping_sub(b'0'));
        k += 1;
    }
    value
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_version_is_the_workspaces() {
        let told = super::FIRMWARE.map(|part| part.to_string()).join(".");
        assert_eq!(told, env!("CARGO_PKG_VERSION"));
    }
}
