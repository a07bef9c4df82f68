//! `cargo xtask bench …`: numbers that the documentation quotes.

pub mod accuracy;
mod estimators;
mod metrics;
mod trial;
