//! A node in the laboratory: the device's logic on a simulated board.

use std::collections::VecDeque;

use shisei_device::node::{Board, Node, RECORD_BYTES, Reading, Record, step};
use shisei_wire::packet::counts;
use shisei_wire::{AccRange, GyroRange};

use super::clock::Clock;
use super::link::Link;
use super::truth::Boot;
use super::{Movement, Settings};
use crate::motion::Path;
use crate::movements::{calibration_poses, wander};
use crate::random::Random;
use crate::simulate::{Errors, Sample, part, simulate};

/// Nominal rate of the sensor, Hz; a part's own is off by some per cent.
const SENSOR_HZ: f64 = 833.0;
const SENSOR_TOLERANCE: f64 = 0.02;
/// Packets that wait in the radio.
const RADIO_QUEUE: usize = 4;
/// From switching on to the first reading, s.
const BOOT_S: f64 = 0.2;

/// Sensor, radio, clock and pins.
#[derive(Debug, Default)]
pub struct SimulatedBoard {
    pub now_us: u64,
    pub readings: VecDeque<Reading>,
    pub link_changed: Option<bool>,
    pub anchor: Option<(u16, u64)>,
    pub radio: VecDeque<Vec<u8>>,
    pub commands: VecDeque<Vec<u8>>,
    pub light: bool,
    pub ranges: (GyroRange, AccRange),
    /// What is written to flash, and so there after a restart.
    pub stored: Option<[u8; RECORD_BYTES]>,
}

impl Board for SimulatedBoard {
    fn now_us(&self) -> u64 {
        self.now_us
    }

    fn reading(&mut self) -> Option<Reading> {
        self.readings.pop_front()
    }

    fn set_ranges(&mut self, gyro: GyroRange, acc: AccRange) {
        self.ranges = (gyro, acc);
    }

    fn link_changed(&mut self) -> Option<bool> {
        self.link_changed.take()
    }

    fn anchor(&mut self) -> Option<(u16, u64)> {
        self.anchor.take()
    }

    fn notify(&mut self, packet: &[u8]) -> bool {
        let room = self.radio.len() < RADIO_QUEUE;
        if room {
            self.radio.push_back(packet.to_vec());
        }
        room
    }

    fn command(&mut self, out: &mut [u8]) -> Option<usize> {
        let command = self.commands.pop_front()?;
        out.get_mut(..command.len())?.copy_from_slice(&command);
        Some(command.len())
    }

    fn battery_mv(&mut self) -> u16 {
        3_900
    }

    fn light(&mut self, on: bool) {
        self.light = on;
    }

    fn store(&mut self, record: &Record) {
        self.stored = Some(record.encode());
    }
}

/// A node, its board, its movement and its link.
#[derive(Debug)]
pub struct SimulatedNode {
    index: usize,
    pub device: Node,
    pub board: SimulatedBoard,
    pub boots: Vec<Boot>,
    pub motion: Path,
    samples: Vec<Sample>,
    sensor_hz: f64,
    movement_s: f64,
    next_reading: usize,
    pub link: Link,
    pub random: Random,
    skew: f64,
    reboots_s: Vec<f64>,
}

impl SimulatedNode {
    pub fn new(index: usize, settings: &Settings, mut random: Random) -> Self {
        let seed = settings.seed.wrapping_mul(64) + index as u64;
        let sensor_hz = SENSOR_HZ * (1.0 + SENSOR_TOLERANCE * random.between(-1.0, 1.0));
        let sampling = crate::Settings { errors: settings.errors, ..crate::Settings::new(sensor_hz, seed) };
        let (motion, sampling) = match settings.movement {
            Movement::Free => (wander(seed, 3.0, settings.movement_s - 6.0), sampling),
            Movement::Poses => {
                let errors = Errors::Given(part(&settings.sensor, &sampling));
                (calibration_poses(seed), crate::Settings { errors, seed: !seed, ..sampling })
            }
        };
        let samples = simulate(&motion, &settings.sensor, &sampling).samples;
        let share = if index == 0 { 1.0 } else { random.between(-1.0, 1.0) };
        let mut reboots_s: Vec<f64> =
            settings.reboots.iter().filter(|(node, _)| *node == index).map(|(_, time_s)| *time_s).collect();
        reboots_s.sort_by(f64::total_cmp);
        let kept = settings.calibrations.iter().rfind(|(node, _)| *node == index).map(|(_, kept)| *kept);
        let stored = kept.map(|kept| Record { calibration: Some(kept), ..Record::default() }.encode());
        let mut node = SimulatedNode {
            index,
            device: Node::new(0, ""),
            board: SimulatedBoard { stored, ..SimulatedBoard::default() },
            boots: Vec::new(),
            // What is simulated in steps of the sensor lasts so long.
            movement_s: samples.len() as f64 / sensor_hz,
            motion,
            samples,
            sensor_hz,
            next_reading: 0,
            link: Link::default(),
            random,
            skew: share * 1e-6 * settings.skew_ppm,
            reboots_s,
        };
        node.start(0.0);
        node
    }

    fn start(&mut self, now_s: f64) {
        // Near its end now and then, so that the 32-bit stamp wraps.
        let offset_us = if self.index.is_multiple_of(2) {
            self.random.between(0.0, 1e6)
        } else {
            f64::from(u32::MAX) - self.random.between(5e6, 9e6)
        };
        let id = self.random.between(1.0, 65_535.0) as u16;
        self.boots.push(Boot { id, clock: Clock { started_s: now_s, offset_us, skew: self.skew } });
        self.device = Node::new(id, &format!("node {}", self.index));
        if let Some(stored) = &self.board.stored {
            self.device.restore(&Record::decode(stored));
        }
        let kept = self.device.settings();
        self.board = SimulatedBoard {
            stored: self.board.stored,
            ranges: (kept.gyro_range, kept.acc_range),
            ..SimulatedBoard::default()
        };
        self.next_reading = shisei_core::math::floor((now_s + BOOT_S) * self.sensor_hz) as usize;
    }

    pub fn clock(&self) -> Clock {
        // There is always a start: `new` makes the first.
        self.boots.last().map_or(Clock { started_s: 0.0, offset_us: 0.0, skew: 0.0 }, |boot| boot.clock)
    }

    /// Where in its movement the node is.
    pub fn movement_time_s(&self, time_s: f64) -> f64 {
        time_s - shisei_core::math::floor(time_s / self.movement_s) * self.movement_s
    }

    pub fn step(&mut self, now_s: f64, _: &Settings) {
        if self.reboots_s.first().is_some_and(|time_s| now_s >= *time_s) {
            self.reboots_s.remove(0);
            self.start(now_s);
            self.link.vanish();
        }
        let clock = self.clock();
        self.board.now_us = clock.us(now_s);
        let (gyro_range, acc_range) = self.board.ranges;
        while (self.next_reading as f64) / self.sensor_hz <= now_s {
            let time_s = self.next_reading as f64 / self.sensor_hz;
            let sample = &self.samples[self.next_reading % self.samples.len()];
            self.board.readings.push_back(Reading {
                time_us: clock.us(time_s),
                gyro: sample.gyro_rad_s.map(|rate| counts(rate, gyro_range.count_rad_s())),
                acc: sample.acc_m_s2.map(|acc| counts(acc, acc_range.count_m_s2())),
                temperature_centi_c: Some(2_500),
            });
            self.next_reading += 1;
        }
        step(&mut self.device, &mut self.board);
    }
}
