//! From the sensor's data-ready edges to readings.

use core::cell::Cell;

use embassy_nrf::gpio::Output;
use embassy_nrf::gpiote::InputChannel;
use embassy_nrf::twim::Twim;
use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use embassy_sync::channel::Channel;
use embassy_time::{Duration, Timer, with_timeout};
use shisei_board::sensor::Sensor;
use shisei_device::node::Reading;
use shisei_wire::{AccRange, GyroRange};
use shisei_xiao::BoardClock;

/// Readings that wait: 38 ms.
const WAITING: usize = 32;
/// So long without an edge, and the sensor is started anew.
const SILENCE: Duration = Duration::from_millis(100);

/// Between the sensor and the node's logic.
pub struct Readings {
    channel: Channel<NoopRawMutex, Reading, WAITING>,
    wanted: Cell<Option<(GyroRange, AccRange)>>,
}

impl Default for Readings {
    fn default() -> Self {
        Readings { channel: Channel::new(), wanted: Cell::new(None) }
    }
}

impl Readings {
    /// The next one; none while ranges change, for it would be taken to be of the new ones.
    pub fn next(&self) -> Option<Reading> {
        if self.wanted.get().is_some() { None } else { self.channel.try_receive().ok() }
    }

    /// Waits until there is one.
    pub async fn wait(&self) {
        self.channel.ready_to_receive().await;
    }

    /// Asks for other ranges.
    pub fn set_ranges(&self, gyro: GyroRange, acc: AccRange) {
        self.wanted.set(Some((gyro, acc)));
    }
}

/// Reads the sensor for good; starts it anew where it falls silent.
pub async fn run(
    i2c: Twim<'static>,
    mut ready: InputChannel<'static>,
    mut power: Output<'static>,
    clock: &BoardClock,
    readings: &Readings,
) {
    let mut sensor = Sensor::new(i2c);
    let mut ranges = (GyroRange::default(), AccRange::default());
    loop {
        Timer::after_millis(20).await;
        if sensor.start(ranges.0, ranges.1).await.is_ok() {
            while read(&mut sensor, &mut ready, clock, readings, &mut ranges).await.is_some() {}
        }
        power.set_low();
        Timer::after_millis(50).await;
        power.set_high();
    }
}

/// One reading; none where the sensor does not answer.
async fn read(
    sensor: &mut Sensor<Twim<'static>>,
    ready: &mut InputChannel<'static>,
    clock: &BoardClock,
    readings: &Readings,
    ranges: &mut (GyroRange, AccRange),
) -> Option<()> {
    if let Some(wanted) = readings.wanted.get() {
        sensor.set_ranges(wanted.0, wanted.1).await.ok()?;
        // The first values after a change are still settling, and what waits is of the old ranges.
        Timer::after_millis(5).await;
        readings.channel.clear();
        *ranges = wanted;
        readings.wanted.set(None);
    }
    with_timeout(SILENCE, ready.wait()).await.ok()?;
    let time_us = clock.edge_us();
    let counts = sensor.counts().await.ok()?;
    let reading = Reading {
        time_us,
        gyro: counts.gyro,
        acc: counts.acc,
        temperature_centi_c: Some(counts.temperature_centi_c),
    };
    // A full queue: the node sees the gap in the times and says so.
    let _ = readings.channel.try_send(reading);
    Some(())
}
