//! The topics: a file of the core each. What is added to the core is added here.

mod filters;
mod fits;
mod rest;
mod rotation;

use crate::hash::Digest;

/// A part of the core and the run over it.
#[derive(Clone, Copy, Debug)]
pub struct Topic {
    /// The file of the core, without its ending.
    pub name: &'static str,
    run: fn(&mut Digest),
}

impl Topic {
    /// Runs it.
    pub fn digest(&self) -> u64 {
        let mut digest = Digest::new();
        (self.run)(&mut digest);
        digest.value()
    }
}

/// In a fixed order: the whole digest depends on it.
pub const TOPICS: &[Topic] = &[
    Topic { name: "math", run: rotation::math },
    Topic { name: "vector", run: rotation::vector },
    Topic { name: "quaternion", run: rotation::quaternion },
    Topic { name: "euler", run: rotation::euler },
    Topic { name: "relative", run: rotation::relative },
    Topic { name: "heading", run: rotation::heading },
    Topic { name: "exponential", run: filters::exponential },
    Topic { name: "gyro", run: filters::gyro },
    Topic { name: "mahony", run: filters::mahony },
    Topic { name: "mahony_adaptive", run: filters::mahony_adaptive },
    Topic { name: "complementary", run: filters::complementary },
    Topic { name: "rest", run: rest::rest },
    Topic { name: "search", run: rest::search },
    Topic { name: "initial", run: rest::initial },
    Topic { name: "statistics", run: fits::statistics },
    Topic { name: "least_squares", run: fits::least_squares },
    Topic { name: "allan", run: fits::allan },
];
