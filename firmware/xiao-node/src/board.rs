//! What the node's logic asks of this board.

use core::cell::Cell;

use embassy_nrf::gpio::{Level, Output};
use shisei_board::Clock;
use shisei_board::node::Radio;
use shisei_device::node::{Board, Reading, Record};
use shisei_wire::{AccRange, GyroRange};
use shisei_xiao::BoardClock;

use crate::sensor::Readings;

/// The XIAO.
pub struct Xiao<'a> {
    pub clock: &'a BoardClock,
    pub readings: &'a Readings,
    pub radio: &'a Radio,
    pub battery_mv: &'a Cell<u16>,
    /// Lit when low.
    pub light: Output<'static>,
    /// What changed and is to be stored.
    pub to_store: Option<Record>,
}

impl Board for Xiao<'_> {
    fn now_us(&self) -> u64 {
        self.clock.now_us()
    }

    fn reading(&mut self) -> Option<Reading> {
        self.readings.next()
    }

    fn set_ranges(&mut self, gyro: GyroRange, acc: AccRange) {
        self.readings.set_ranges(gyro, acc);
    }

    fn link_changed(&mut self) -> Option<bool> {
        self.radio.link_changed()
    }

    fn anchor(&mut self) -> Option<(u16, u64)> {
        let anchor = self.radio.anchor()?;
        Some((anchor.event, self.clock.from_controller_us(anchor.controller_us)))
    }

    fn notify(&mut self, packet: &[u8]) -> bool {
        self.radio.notify(packet)
    }

    fn command(&mut self, out: &mut [u8]) -> Option<usize> {
        self.radio.command(out)
    }

    fn battery_mv(&mut self) -> u16 {
        self.battery_mv.get()
    }

    fn light(&mut self, on: bool) {
        self.light.set_level(if on { Level::Low } else { Level::High });
    }

    fn store(&mut self, record: &Record) {
        self.to_store = Some(*record);
    }
}
