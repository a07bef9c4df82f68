//! What the JavaScript package in `npm/` calls: typed arrays in, typed arrays out. No formula lives here, and no
//! documentation for users: the package wraps every function with names, units and checks.
#![allow(unsafe_code)] // wasm-bindgen's macros

mod arrays;
mod errors;
mod filters;
mod recording;
mod sheet;
