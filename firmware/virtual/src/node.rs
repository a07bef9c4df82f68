//! A node: the logic of `shisei-device` with a sensor that is read at 833 Hz.

use std::collections::VecDeque;
use std::time::Duration;

use shisei_board::Clock;
use shisei_board::node::Radio;
use shisei_device::node::{Board, Node, Reading, Record, step};
use shisei_wire::{AccRange, GyroRange};

use crate::DeviceClock;
use crate::controllers::{Controller, ReportAnchors};

const SENSOR_HZ: f64 = 833.0;

/// A node from one start to its end.
pub struct VirtualNode {
    /// Bluetooth address.
    pub address: [u8; 6],
    /// Random at every start.
    pub boot: u16,
    /// Its first name.
    pub name: String,
    /// Its clock.
    pub clock: DeviceClock,
}

struct VirtualBoard<'a> {
    clock: DeviceClock,
    radio: &'a Radio,
    readings: VecDeque<Reading>,
    next: u64,
}

impl VirtualBoard<'_> {
    /// All readings up to now, at rest, z up: a slow turn that counts show.
    fn sense(&mut self) {
        while self.next as f64 / SENSOR_HZ <= self.clock.now_s() {
            let time_us = self.clock.at_us(self.next as f64 / SENSOR_HZ) as u64;
            let gyro = [3, -2, 1];
            self.readings.push_back(Reading {
                time_us,
                gyro,
                acc: [0, 0, 4098],
                temperature_centi_c: Some(2_512),
            });
            self.next += 1;
        }
    }
}

impl Board for VirtualBoard<'_> {
    fn now_us(&self) -> u64 {
        self.clock.now_us()
    }

    fn reading(&mut self) -> Option<Reading> {
        self.readings.pop_front()
    }

    fn set_ranges(&mut self, _: GyroRange, _: AccRange) {}

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
        3_987
    }

    fn light(&mut self, _: bool) {}

    fn store(&mut self, _: &Record) {}
}

impl VirtualNode {
    /// Runs it until it is dropped.
    pub async fn run(self, controller: Controller) {
        let radio = Radio::default();
        let mut node = Node::new(self.boot, &self.name);
        radio.set_status(&node);
        let logic = async {
            let next = (self.clock.now_s() * SENSOR_HZ) as u64 + 1;
            let mut board =
                VirtualBoard { clock: self.clock, radio: &radio, readings: VecDeque::new(), next };
            loop {
                board.sense();
                step(&mut node, &mut board);
                radio.set_status(&node);
                tokio::time::sleep(Duration::from_millis(4)).await;
            }
        };
        let talking = shisei_board::node::run(controller, self.address, ReportAnchors::new(true), &radio);
        tokio::select! {
            () = logic => {}
            ended = talking => panic!("the node's radio stopped: {ended:?}"),
        }
    }
}
