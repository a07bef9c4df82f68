//! The node: sensor readings in, packets out.

mod attitude;
mod board;
mod queue;
mod record;
mod start;
mod tick;

pub use attitude::Attitude;
pub use board::{Board, step};
pub use record::{Name, RECORD_BYTES, Record};
pub use start::{DURATION_US as START_US, Found, Starter, TICKS_MIN};
pub use tick::{GAP_US, RATE_HZ, Rates, Tick, Ticker};

use shisei_core::calibration::{Calibration as Correction, SensorModel};
use shisei_core::vector::sub;
use shisei_core::{Quaternion, Vec3};
use shisei_wire::message::{Command, Settings};
use shisei_wire::packet::{self, Anchor, Flags, Header, SAMPLES_MAX, Sample, Start};
use shisei_wire::{AccRange, Calibration, GyroRange};

use queue::Queue;

/// Samples that wait while there is no link: a little over a second. What is older is lost, and its sequence numbers
/// say so.
pub const QUEUE: usize = 128;
/// Samples a packet unless set otherwise: 30 packets a second.
pub const BATCH: u8 = 4;
/// Below this the battery is low, mV.
pub const BATTERY_LOW_MV: u16 = 3_400;
/// How long a node blinks to be found, µs.
pub const IDENTIFY_US: u64 = 10_000_000;

/// What the sensor read, counts of the ranges in force.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reading {
    /// When, node µs, captured by hardware.
    pub time_us: u64,
    /// Gyroscope.
    pub gyro: [i16; 3],
    /// Accelerometer.
    pub acc: [i16; 3],
    /// Temperature, 0.01 °C, where it was read.
    pub temperature_centi_c: Option<i16>,
}

#[derive(Clone, Copy, Debug, Default)]
struct Waiting {
    number: u64,
    time_us: u64,
    missed: bool,
    calibrated: bool,
    gyro_range: GyroRange,
    acc_range: AccRange,
    start: Start,
    sample: Sample,
}

/// A calibration as it was sent, and ready for use.
#[derive(Clone, Copy, Debug)]
struct Kept {
    sent: Calibration,
    correction: Correction,
}

fn correction(sent: &Calibration) -> Correction {
    let model = |half: &shisei_wire::calibration::Correction| {
        let (bias, matrix) = half.to_f64();
        SensorModel { bias, matrix }
    };
    Correction { accelerometer: model(&sent.accelerometer), gyroscope: model(&sent.gyroscope) }
}

/// A node.
#[derive(Clone, Debug)]
pub struct Node {
    boot: u16,
    settings: Settings,
    ticker: Ticker,
    starter: Option<Starter>,
    start: Start,
    bias_rad_s: Vec3,
    attitude: Attitude,
    world_from_body: Quaternion,
    queue: Queue<Waiting, QUEUE>,
    connected_us: Option<u64>,
    anchor: Option<Anchor>,
    temperature_centi_c: Option<i16>,
    battery_mv: u16,
    identify_until_us: u64,
    name: Name,
    kept: Option<Kept>,
}

impl Node {
    /// A node that just started. `boot` is random; a name that is too long is cut at a character's end.
    pub fn new(boot: u16, name: &str) -> Self {
        Node {
            boot,
            settings: Settings { batch: BATCH, ..Settings::default() },
            ticker: Ticker::default(),
            starter: Some(Starter::default()),
            start: Start::Running,
            bias_rad_s: [0.0; 3],
            attitude: Attitude::Waiting,
            world_from_body: Quaternion::IDENTITY,
            queue: Queue::default(),
            connected_us: None,
            anchor: None,
            temperature_centi_c: None,
            battery_mv: 0,
            identify_until_us: 0,
            name: Name::cut(name),
            kept: None,
        }
    }

    /// Takes a reading of the sensor.
    pub fn reading(&mut self, reading: &Reading) {
        let (gyro_range, acc_range) = (self.settings.gyro_range, self.settings.acc_range);
        if let Some(temperature) = reading.temperature_centi_c {
            self.temperature_centi_c = Some(temperature);
        }
        let rates = Rates {
            time_us: reading.time_us,
            gyro_rad_s: reading.gyro.map(|count| f64::from(count) * gyro_range.count_rad_s()),
            acc_m_s2: reading.acc.map(|count| f64::from(count) * acc_range.count_m_s2()),
        };
        let mut ticker = self.ticker;
        ticker.push(&rates, |tick| self.tick(&tick));
        self.ticker = ticker;
    }

    fn tick(&mut self, tick: &Tick) {
        // What is sent stays as the sensor gave it. The correction is linear, and a tick's rate and force are means:
        // corrected once a tick they are what corrected readings would give, but for a hundredth of the coning term.
        let corrected = self.kept.map_or(*tick, |Kept { correction, .. }| Tick {
            gyro_rad_s: correction.gyroscope.apply(tick.gyro_rad_s),
            acc_m_s2: correction.accelerometer.apply(tick.acc_m_s2),
            ..*tick
        });
        if let Some(starter) = &mut self.starter
            && let Some(found) = starter.push(&corrected)
        {
            self.starter = None;
            self.start = found.start;
            self.bias_rad_s = found.bias_rad_s;
            self.attitude =
                Attitude::begin(self.settings.filter, found.world_from_body, found.bias_sigma_rad_s);
        }
        let unbiased = sub(corrected.gyro_rad_s, self.bias_rad_s);
        self.world_from_body = self.attitude.update(unbiased, corrected.acc_m_s2, tick.dt_s);
        let (gyro_range, acc_range) = (self.settings.gyro_range, self.settings.acc_range);
        self.queue.push(Waiting {
            number: tick.number,
            time_us: tick.time_us,
            missed: tick.reading_missed,
            calibrated: self.kept.is_some(),
            gyro_range,
            acc_range,
            start: self.start,
            sample: Sample {
                dt_us: 0,
                gyro: tick.gyro_rad_s.map(|rate| packet::counts(rate, gyro_range.count_rad_s())),
                acc: tick.acc_m_s2.map(|acc| packet::counts(acc, acc_range.count_m_s2())),
                quaternion: packet::quaternion_counts(self.world_from_body.to_array()),
            },
        });
    }

    /// A receiver has subscribed, or is gone.
    pub fn link(&mut self, connected: bool, now_us: u64) {
        self.connected_us = connected.then_some(now_us);
        self.anchor = None;
    }

    /// The newest anchor point of the link, node µs.
    pub fn anchor(&mut self, event: u16, time_us: u64) {
        self.anchor = Some(Anchor { event, time_us: time_us as u32 });
    }

    /// Writes the next packet, if a whole batch waits and there is a link: returns its length, and its samples to be
    /// given to [`Node::sent`] once the radio has taken it.
    pub fn packet(&self, out: &mut [u8]) -> Option<(usize, usize)> {
        let connected_us = self.connected_us?;
        let first = self.queue.get(0)?;
        let batch = usize::from(self.settings.batch).clamp(1, SAMPLES_MAX);
        let late = first.time_us < connected_us;
        let mut samples = [Sample::default(); SAMPLES_MAX];
        let mut missed = false;
        let mut count = 0;
        for (k, slot) in samples.iter_mut().enumerate().take(batch) {
            let Some(waiting) = self.queue.get(k) else { break };
            let dt_us = waiting.time_us - first.time_us;
            let alike = waiting.number == first.number + k as u64
                && (waiting.gyro_range, waiting.acc_range) == (first.gyro_range, first.acc_range)
                && (waiting.start, waiting.calibrated) == (first.start, first.calibrated)
                && (waiting.time_us < connected_us) == late;
            if !alike || dt_us > u64::from(u16::MAX) {
                break;
            }
            *slot = Sample { dt_us: dt_us as u16, ..waiting.sample };
            missed |= waiting.missed;
            count = k + 1;
        }
        // A batch that others follow is sent although it is short: what follows does not fit with it.
        if count < batch && self.queue.len() <= count {
            return None;
        }
        let header = Header {
            flags: Flags {
                late,
                battery_low: self.battery_mv > 0 && self.battery_mv < BATTERY_LOW_MV,
                gyro_range: first.gyro_range,
                acc_range: first.acc_range,
                filter: self.settings.filter,
                start: first.start,
                reading_missed: missed,
                calibrated: first.calibrated,
            },
            boot: self.boot,
            sequence: first.number as u16,
            time_us: first.time_us as u32,
            anchor: self.anchor,
            temperature_centi_c: self.temperature_centi_c,
        };
        let length = packet::encode(&header, samples.get(..count)?, out).ok()?;
        Some((length, count))
    }

    /// The radio has taken a packet of so many samples.
    pub fn sent(&mut self, samples: usize) {
        self.queue.drop_first(samples);
    }

    /// Carries out a command. True where what it keeps has changed: [`Node::record`] is to be stored.
    pub fn command(&mut self, command: &Command<'_>, now_us: u64) -> bool {
        match *command {
            Command::Ask => false,
            Command::Identify(_) => {
                self.identify_until_us = now_us + IDENTIFY_US;
                false
            }
            Command::Calibrate(_) => {
                self.restart();
                false
            }
            Command::Rename(_, name) => {
                self.name = Name::cut(name);
                true
            }
            Command::Keep(_, calibration) => {
                self.keep(calibration);
                true
            }
            Command::Configure(_, settings) => self.configure(settings),
        }
    }

    fn configure(&mut self, settings: Settings) -> bool {
        let before = self.settings;
        self.settings = Settings { batch: settings.batch.clamp(1, SAMPLES_MAX as u8), ..settings };
        if self.settings.filter != before.filter {
            self.restart();
        }
        self.settings != before
    }

    fn restart(&mut self) {
        self.starter = Some(Starter::default());
        self.start = Start::Running;
        self.bias_rad_s = [0.0; 3];
        self.attitude = Attitude::Waiting;
    }

    /// What it keeps over restarts, for the board to store.
    pub fn record(&self) -> Record {
        let calibration = self.calibration().copied();
        Record { name: Some(self.name), calibration, settings: Some(self.settings) }
    }

    /// Takes what the board has stored when it starts; the sensor gets the ranges of [`Node::settings`] then.
    pub fn restore(&mut self, record: &Record) {
        self.name = record.name.unwrap_or(self.name);
        self.configure(record.settings.unwrap_or(self.settings));
        self.keep(record.calibration);
    }

    /// Takes a calibration, or none. Bias and attitude are found anew.
    pub fn keep(&mut self, calibration: Option<Calibration>) {
        self.kept = calibration.map(|sent| Kept { sent, correction: correction(&sent) });
        self.restart();
    }

    /// The calibration that is kept.
    pub fn calibration(&self) -> Option<&Calibration> {
        self.kept.as_ref().map(|kept| &kept.sent)
    }

    /// Its name.
    pub fn name(&self) -> &str {
        self.name.as_str()
    }

    /// Its boot id.
    pub fn boot(&self) -> u16 {
        self.boot
    }

    /// Voltage of the battery, mV; 0: not known.
    pub fn set_battery(&mut self, millivolts: u16) {
        self.battery_mv = millivolts;
    }

    /// What [`shisei_wire::gatt::STATUS`] reads before the name: battery, temperature, firmware version, boot id.
    pub fn status(&self) -> [u8; 9] {
        let [battery_0, battery_1] = self.battery_mv.to_le_bytes();
        let [temperature_0, temperature_1] = self.temperature_centi_c.unwrap_or(i16::MIN).to_le_bytes();
        let [major, minor, patch] = crate::FIRMWARE;
        let [boot_0, boot_1] = self.boot.to_le_bytes();
        [battery_0, battery_1, temperature_0, temperature_1, major, minor, patch, boot_0, boot_1]
    }

    /// The settings in force.
    pub fn settings(&self) -> Settings {
        self.settings
    }

    /// How the start went so far.
    pub fn start(&self) -> Start {
        self.start
    }

    /// The attitude now.
    pub fn world_from_body(&self) -> Quaternion {
        self.world_from_body
    }

    /// Whether the light is on: four times a second while it is to be found, a short flash every two seconds without
    /// a link, else off.
    pub fn light(&self, now_us: u64) -> bool {
        if now_us < self.identify_until_us {
            (now_us / 125_000).is_multiple_of(2)
        } else {
            self.connected_us.is_none() && now_us % 2_000_000 < 50_000
        }
    }
}
