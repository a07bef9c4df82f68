//! What node and receiver share of the nRF52840: how they start, and their clock.
//!
//! TIMER3 runs at 1 MHz from the crystal and is the board's clock. What has to be exact is captured into it by PPI,
//! without the processor: CC0 for the board's own edge, CC2 for the controller's clock. [`BoardClock::follow`] keeps
//! the controller's clock (RTC0, 32768 Hz) and this one together: RTC2 mirrors RTC0, and its compare event captures
//! TIMER3.
#![no_std]
#![warn(missing_docs)]

mod start;

pub use start::{boot_id, radio_layer};

use core::cell::Cell;
use core::ptr::NonNull;

use embassy_nrf::Peri;
use embassy_nrf::config::Config;
use embassy_nrf::interrupt::Priority;
use embassy_nrf::pac;
use embassy_nrf::peripherals::{PPI_CH1, RTC2, TIMER3};
use embassy_nrf::ppi::{Event, Ppi};
use embassy_nrf::rtc::{CompareChannel, Interrupt, Rtc};
use embassy_nrf::timer::{Frequency, Timer as HardwareTimer};
use embassy_time::Timer;
use nrf_mpsl::raw;
use shisei_board::Clock;

/// TIMER3's register for the board's own edge.
pub const CC_EDGE: usize = 0;
const CC_CONTROLLER: usize = 2;
const CC_NOW: usize = 3;
/// RTCs count through 24 bits.
const RTC_MASK: u32 = 0x00FF_FFFF;
/// A tenth of a second of an RTC.
const AHEAD: u32 = 3_277;

/// Interrupts below those that MPSL keeps for itself.
pub fn config() -> Config {
    let mut config = Config::default();
    config.gpiote_interrupt_priority = Priority::P2;
    config.time_interrupt_priority = Priority::P2;
    config
}

/// The low-frequency crystal of the XIAO.
pub const LOW_FREQUENCY_CLOCK: raw::mpsl_clock_lfclk_cfg_t = raw::mpsl_clock_lfclk_cfg_t {
    source: raw::MPSL_CLOCK_LF_SRC_XTAL as u8,
    rc_ctiv: 0,
    rc_temp_ctiv: 0,
    accuracy_ppm: 50,
    skip_wait_lfclk_started: false,
};

/// This chip's static random address, least significant byte first.
pub fn address() -> [u8; 6] {
    let [a, b, c, d] = pac::FICR.deviceaddr(0).read().to_le_bytes();
    let [e, f, ..] = pac::FICR.deviceaddr(1).read().to_le_bytes();
    [a, b, c, d, e, f | 0xC0]
}

/// The board's clock, µs since its start.
#[derive(Debug, Default)]
pub struct BoardClock {
    last_us: Cell<u64>,
    /// One moment by the controller's clock and by this one.
    pair: Cell<(u64, u64)>,
}

impl BoardClock {
    /// Starts TIMER3. The crystal must be held (`request_hfclk`), else it runs from the inexact oscillator.
    pub fn start(timer: Peri<'static, TIMER3>) -> (Self, HardwareTimer<'static>) {
        let timer = HardwareTimer::new(timer);
        timer.set_frequency(Frequency::F1MHz);
        timer.start();
        (BoardClock::default(), timer)
    }

    /// A value that hardware captured in the last hour.
    pub fn unwrap_us(&self, captured: u32) -> u64 {
        let now_us = self.now_us();
        now_us - u64::from((now_us as u32).wrapping_sub(captured))
    }

    /// What hardware captured last for the board's own edge.
    pub fn edge_us(&self) -> u64 {
        self.unwrap_us(pac::TIMER3.cc(CC_EDGE).read())
    }

    /// Keeps the controller's clock and this one together. Never ends.
    pub async fn follow(
        &self,
        timer: &HardwareTimer<'static>,
        rtc: Peri<'static, RTC2>,
        channel: Peri<'static, PPI_CH1>,
    ) {
        let Ok(mut rtc) = Rtc::new(rtc, 0) else { return };
        let register = pac::RTC2.events_compare(0).as_ptr();
        let Some(register) = NonNull::new(register) else { return };
        // SAFETY: the register of RTC2's first compare event, and RTC2 is ours.
        let compare = unsafe { Event::new_unchecked(register) };
        let mut ppi = Ppi::new_one_to_one(channel, compare, timer.cc(CC_CONTROLLER).task_capture());
        ppi.enable();
        rtc.enable_event(Interrupt::Compare0);
        rtc.enable();
        // Both count the same edges; their difference is read twice, for one may have stepped in between.
        let difference =
            |rtc: &Rtc<'static>| pac::RTC0.counter().read().0.wrapping_sub(rtc.read()) & RTC_MASK;
        let offset = loop {
            let first = difference(&rtc);
            cortex_m::asm::delay(64 * 15);
            if first == difference(&rtc) {
                break first;
            }
        };
        let (mut wraps, mut last) = (0_u64, 0);
        loop {
            let at = (rtc.read() + AHEAD) & RTC_MASK;
            rtc.reset_event(Interrupt::Compare0);
            let set = rtc.set_compare(CompareChannel::_0, at);
            Timer::after_millis(120).await;
            if set.is_err() || !rtc.is_event_triggered(Interrupt::Compare0) {
                continue;
            }
            let count = (at + offset) & RTC_MASK;
            if count < last {
                wraps += 1;
            }
            last = count;
            // 15625 / 512 µs a count.
            let controller_us = (((wraps << 24) | u64::from(count)) * 15_625) >> 9;
            self.pair.set((controller_us, self.unwrap_us(pac::TIMER3.cc(CC_CONTROLLER).read())));
        }
    }
}

impl Clock for BoardClock {
    fn now_us(&self) -> u64 {
        pac::TIMER3.tasks_capture(CC_NOW).write_value(1);
        let low = pac::TIMER3.cc(CC_NOW).read();
        let last_us = self.last_us.get();
        // Asked many times a second, so at most one wrap lies between.
        let now_us = last_us + u64::from(low.wrapping_sub(last_us as u32));
        self.last_us.set(now_us);
        now_us
    }

    fn from_controller_us(&self, controller_us: u64) -> u64 {
        let (then_us, here_us) = self.pair.get();
        here_us.wrapping_add(controller_us.wrapping_sub(then_us))
    }
}
