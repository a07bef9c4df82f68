//! Live: optical and inertial together, now.
//!
//! [`input::Input`]s give bytes of receivers and packets of NatNet. [`Hub`] follows both, brings each sensor together
//! with its body ([`merge`]), finds out which belong together ([`learn`]), and puts the newest of everything on a
//! [`Board`], from where clients take it.

pub mod backlog;
pub mod board;
mod cameras;
pub mod command;
pub mod hub;
pub mod input;
pub mod lagged;
pub mod learn;
pub mod merge;
pub mod meter;
pub mod mounting;
mod naming;
mod node;
pub mod note;
pub mod optics;
pub mod output;
mod pairing;
mod receivers;
pub mod recorder;
pub mod replay;
pub mod run;
pub mod scene;
pub mod settings;
mod showing;
mod status;
#[cfg(test)]
mod tests;

pub use board::Board;
pub use command::Command;
pub use hub::Hub;
pub use input::{Input, Kind, Line, State, What};
pub use mounting::Mounting;
pub use note::{Level, Note};
pub use output::Output;
pub use replay::Replay;
pub use run::{Door, Parts, Refused, run};
pub use settings::{Settings, hello};
