//! `cargo xtask bench …`: numbers that the documentation quotes.

pub mod accuracy;
mod coverage;
pub mod doors;
mod estimators;
mod metrics;
mod trial;
