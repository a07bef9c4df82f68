//! The digest as a WebAssembly module for `xtask/js/digest.mjs`: no imports, three exports.
#![allow(unsafe_code)] // an exported name is unsafe by Rust's rules; nothing else here is

/// How many topics there are.
#[unsafe(no_mangle)]
pub extern "C" fn topics() -> u32 {
    shisei_digest::TOPICS.len() as u32
}

/// The digest of a topic; 0 where there is none.
#[unsafe(no_mangle)]
pub extern "C" fn topic(index: u32) -> u64 {
    shisei_digest::TOPICS.get(index as usize).map_or(0, shisei_digest::Topic::digest)
}

/// The digest of all topics.
#[unsafe(no_mangle)]
pub extern "C" fn all() -> u64 {
    shisei_digest::digest()
}
