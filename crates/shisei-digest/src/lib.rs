//! One fixed run over everything in shisei-core, reduced to 64 bits a topic.
//!
//! The core promises the same bits on x86-64, Cortex-M4F, wasm32 and Windows. This crate is the measure: run it
//! on two targets and compare. A topic is one file of the core, so a difference says where to look.
#![cfg_attr(not(test), no_std)]
#![warn(missing_docs)]

extern crate alloc;

mod hash;
mod input;
mod topics;

pub use hash::Digest;
pub use topics::{TOPICS, Topic};

/// The digest of all topics in their order.
pub fn digest() -> u64 {
    let mut all = Digest::new();
    for topic in TOPICS {
        all.push_u64(topic.digest());
    }
    all.value()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_run_repeats_itself() {
        assert_eq!(digest(), digest());
    }

    #[test]
    fn topics_differ_from_each_other_and_from_nothing() {
        for (i, topic) in TOPICS.iter().enumerate() {
            assert_ne!(topic.digest(), Digest::new().value(), "{}", topic.name);
            for other in &TOPICS[..i] {
                assert_ne!(topic.digest(), other.digest(), "{} and {}", topic.name, other.name);
            }
        }
    }

    /// Else the digest would be one of error codes.
    #[test]
    fn topics_run_on_input_that_the_core_accepts() {
        for topic in TOPICS {
            let (accepted, refused) = topic.run().results();
            assert!(accepted > 0 || refused == 0, "{}: {refused} errors and no result", topic.name);
        }
    }
}
