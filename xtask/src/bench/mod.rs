//! `cargo xtask bench …`: numbers that the documentation quotes.

pub mod accuracy;
pub mod doors;
pub mod bridge;
mod estimators;
mod metrics;
mod trial;
