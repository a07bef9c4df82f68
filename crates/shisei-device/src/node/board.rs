//! What a node needs of its board.

use shisei_wire::gatt::{COMMAND_MAX, NOTIFICATION_MAX};
use shisei_wire::message::Command;
use shisei_wire::{AccRange, GyroRange};

use super::{Node, Reading, Record};

/// Sensor, radio, clock and pins of a board. Nothing here waits: what is not there yet is told as none.
pub trait Board {
    /// The clock, µs since the start.
    fn now_us(&self) -> u64;
    /// The next reading of the sensor.
    fn reading(&mut self) -> Option<Reading>;
    /// Gives the sensor new ranges.
    fn set_ranges(&mut self, gyro: GyroRange, acc: AccRange);
    /// A receiver came (true) or went (false) since the last call.
    fn link_changed(&mut self) -> Option<bool>;
    /// A newer anchor point: its event and its time, µs of this clock.
    fn anchor(&mut self) -> Option<(u16, u64)>;
    /// Notifies a packet; false where the radio has no room now.
    fn notify(&mut self, packet: &[u8]) -> bool;
    /// A written command: copies it into `out` and returns its length.
    fn command(&mut self, out: &mut [u8]) -> Option<usize>;
    /// Voltage of the battery, mV; 0: not known.
    fn battery_mv(&mut self) -> u16;
    /// Switches the light.
    fn light(&mut self, on: bool);
    /// Stores this, and advertises the name; [`Node::restore`] gets it at the next start.
    fn store(&mut self, record: &Record);
}

/// Does everything there is to do now. To be called when something happened, and every few milliseconds.
pub fn step(node: &mut Node, board: &mut impl Board) {
    let now_us = board.now_us();
    if let Some(connected) = board.link_changed() {
        node.link(connected, now_us);
    }
    let mut bytes = [0; COMMAND_MAX];
    while let Some(length) = board.command(&mut bytes) {
        if let Ok(command) = Command::decode_for_node(bytes.get(..length).unwrap_or_default()) {
            react(node, board, &command, now_us);
        }
    }
    while let Some(reading) = board.reading() {
        node.reading(&reading);
    }
    if let Some((event, time_us)) = board.anchor() {
        node.anchor(event, time_us);
    }
    node.set_battery(board.battery_mv());
    let mut packet = [0; NOTIFICATION_MAX];
    while let Some((length, samples)) = node.packet(&mut packet) {
        if !packet.get(..length).is_some_and(|packet| board.notify(packet)) {
            break;
        }
        node.sent(samples);
    }
    board.light(node.light(now_us));
}

fn react(node: &mut Node, board: &mut impl Board, command: &Command<'_>, now_us: u64) {
    let before = node.settings();
    if node.command(command, now_us) {
        let now = node.settings();
        if (now.gyro_range, now.acc_range) != (before.gyro_range, before.acc_range) {
            // readings are taken to be of them from now on
            board.set_ranges(now.gyro_range, now.acc_range);
        }
        board.store(&node.record());
    }
}
