//! Several clocks and a train of pulses: when a sample was taken, and in which camera frame.
//!
//! A node stamps its samples with its own clock; a receiver stamps camera pulses with another. Both see the start of
//! each connection event of their radio link, which gives pairs of the two clocks ([`Pair`]). From pairs
//! [`ClockFit`] (as they come) or [`map_between`] (afterwards, from both sides) carries a sample's time to the
//! receiver's clock, and [`frame_index`] says between which pulses it lies, as a real number.
mod fit;
mod frames;
mod unwrap;

pub use fit::{ClockFit, Outcome, Pair, Settings, map_between};
pub use frames::{Frame, Pulse, PulseTrain, arrival_frame, frame_index};
pub use unwrap::unwrap_near;
