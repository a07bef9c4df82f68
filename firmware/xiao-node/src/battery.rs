//! The battery's voltage, through the board's divider of 1 MΩ and 510 kΩ.

use core::cell::Cell;

use embassy_nrf::Peri;
use embassy_nrf::gpio::{Level, Output, OutputDrive};
use embassy_nrf::interrupt::typelevel::{Binding, SAADC as Interrupt};
use embassy_nrf::peripherals::{P0_14, P0_31, SAADC};
use embassy_nrf::saadc::{ChannelConfig, Config, InterruptHandler, Saadc};
use embassy_time::Timer;

/// Full scale of the converter (internal reference 0.6 V, gain 1/6), mV, and its counts.
const FULL_SCALE_MV: i32 = 3_600;
const COUNTS: i32 = 4_096;
/// Battery over converter.
const DIVIDER: (i32, i32) = (1_510, 510);
const EVERY_S: u64 = 10;

/// Measures for good. P0.14 stays low: it is the divider's foot, and high it would bring the battery's voltage to the
/// converter's pin.
pub async fn watch(
    converter: Peri<'static, SAADC>,
    interrupts: impl Binding<Interrupt, InterruptHandler> + 'static,
    pin: Peri<'static, P0_31>,
    foot: Peri<'static, P0_14>,
    battery_mv: &Cell<u16>,
) {
    let _foot = Output::new(foot, Level::Low, OutputDrive::Standard);
    let channel = ChannelConfig::single_ended(pin);
    let mut converter = Saadc::new(converter, interrupts, Config::default(), [channel]);
    loop {
        let mut counts = [0];
        converter.sample(&mut counts).await;
        let pin_mv = i32::from(counts[0].max(0)) * FULL_SCALE_MV / COUNTS;
        battery_mv.set((pin_mv * DIVIDER.0 / DIVIDER.1) as u16);
        Timer::after_secs(EVERY_S).await;
    }
}
