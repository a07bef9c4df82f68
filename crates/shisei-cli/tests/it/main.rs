//! The command as a user meets it: real files, exit codes, sentences, and no output where there is an error.

mod bad_input;
mod calibration;
mod dialects;
mod fuse;
mod hub;
#[cfg(unix)]
mod live;
mod many;
mod measure;
mod orientation;
mod own_results;
mod run;
mod takes;
#[cfg(unix)]
mod trouble;
mod unkind;
