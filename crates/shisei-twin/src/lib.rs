//! Simulated motion whose truth is known, and the sensors that read it.
//!
//! - [`curve`]: smooth functions of time with exact first and second derivatives;
//! - [`motion`]: attitude and position made of them, with exact body rates and accelerations;
//! - [`imu`]: what an ideal sensor reads in a world with gravity and, if wanted, the Earth's rotation;
//! - [`sensor`]: bias, scale, misalignment, noise, quantisation and range of named sensors;
//! - [`simulate()`]: all of them, sampled, seeded: [`Simulation`] holds the readings and the truth;
//! - [`movements`]: movements for tests and demonstrations;
//! - [`optics`]: cameras that film the body, with a clock, noise and losses of their own;
//! - [`motive`]: what they saw as Motive's tracking CSV;
//! - [`stage`]: cameras that film a running laboratory and a dancer, frame by frame;
//! - [`lab`]: nodes, radio links, camera pulses and a receiver without hardware;
//! - [`recordings`]: the recordings in `examples/` and their truth.
//!
//! Conventions are those of `shisei_core`. The same seed gives the same bits on every machine: the generator
//! is PCG and all mathematics goes through `shisei_core::math`.
#![warn(missing_docs)]

pub mod curve;
pub mod imu;
pub mod lab;
pub mod motion;
pub mod motive;
pub mod movements;
pub mod optics;
pub mod random;
pub mod recordings;
pub mod sensor;
pub mod simulate;
pub mod stage;

pub use curve::{Curve, Jet};
pub use imu::{World, ideal_imu};
pub use motion::{Motion, Path, State, Turn};
pub use random::Random;
pub use sensor::{Calibration, Correction, Sensor, Triad};
pub use simulate::{Errors, Sample, Settings, Simulation, Truth, simulate};
