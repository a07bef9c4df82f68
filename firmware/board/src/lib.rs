//! Node and receiver of `shisei-device` over Bluetooth Low Energy, generic over the controller: on the boards Nordic's,
//! in tests a virtual one.
//!
//! - [`node`]: advertises the service, notifies packets, takes commands, tells its state;
//! - [`receiver`]: scans for the service, keeps up to six links, passes packets, anchors and commands on;
//! - [`anchor`]: anchor points, the one thing that is not in the Bluetooth standard;
//! - [`sensor`]: the LSM6DS3TR-C by its registers.
#![no_std]
#![warn(missing_docs)]

pub mod anchor;
#[cfg(feature = "node")]
pub mod node;
#[cfg(feature = "receiver")]
pub mod receiver;
pub mod sensor;

use bt_hci::cmd::SyncCmd;
use bt_hci::controller::ControllerCmdSync;

/// A controller that reports anchor points once `A` asked it to.
pub trait Controller<A: SyncCmd>: trouble_host::Controller + ControllerCmdSync<A> {}

impl<A: SyncCmd, C: trouble_host::Controller + ControllerCmdSync<A>> Controller<A> for C {}

/// What a board's clocks have to say.
pub trait Clock {
    /// µs since the start.
    fn now_us(&self) -> u64;
    /// A time of the controller's clock by this one, µs.
    fn from_controller_us(&self, controller_us: u64) -> u64;
}

impl<K: Clock> Clock for &K {
    fn now_us(&self) -> u64 {
        (*self).now_us()
    }

    fn from_controller_us(&self, controller_us: u64) -> u64 {
        (*self).from_controller_us(controller_us)
    }
}

/// Why the radio stopped for good: the controller does not answer as it should. The board starts anew.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stopped;
