//! `cargo xtask bench …`: numbers that the documentation quotes.

pub mod accuracy;
#[cfg(feature = "bridge")]
pub mod bridge;
pub mod cli;
mod coverage;
pub mod doors;
mod estimators;
pub mod live;
mod metrics;
mod rates;
pub mod speed;
pub mod sync;
mod trial;
