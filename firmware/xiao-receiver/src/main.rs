//! The receiver on a Seeed XIAO nRF52840: pins, PPI, timers, USB. What it does is in `shisei-device`.
#![no_std]
#![no_main]

mod pulses;
mod serial;

use core::cell::RefCell;

use embassy_executor::Spawner;
use embassy_futures::join::join4;
use embassy_futures::select::select;
use embassy_nrf::gpio::Pull;
use embassy_nrf::gpiote::{InputChannel, InputChannelPolarity};
use embassy_nrf::interrupt::{self, InterruptExt, Priority};
use embassy_nrf::ppi::Ppi;
use embassy_nrf::timer::Timer as HardwareTimer;
use embassy_nrf::usb::vbus_detect;
use embassy_nrf::{bind_interrupts, peripherals, rng, usb};
use nrf_mpsl::{self as mpsl, MultiprotocolServiceLayer};
use nrf_sdc::vendor::NordicConnAnchorPointUpdateEventReportEnable as ReportAnchors;
use shisei_board::Clock;
use shisei_board::receiver::Radio;
use shisei_device::receiver::{NODES_MAX, Receiver};
use shisei_xiao::{
    BoardClock, CC_EDGE, LOW_FREQUENCY_CLOCK, address, boot_id, config, controller_parts, layer_parts,
    radio_layer,
};
use static_cell::StaticCell;

bind_interrupts!(struct Interrupts {
    RNG => rng::InterruptHandler<peripherals::RNG>;
    USBD => usb::InterruptHandler<peripherals::USBD>;
    EGU0_SWI0 => mpsl::LowPrioInterruptHandler;
    CLOCK_POWER => mpsl::ClockInterruptHandler, vbus_detect::InterruptHandler;
    RADIO => mpsl::HighPrioInterruptHandler;
    TIMER0 => mpsl::HighPrioInterruptHandler;
    RTC0 => mpsl::HighPrioInterruptHandler;
});

/// Bytes that wait for the PC: a third of a second of six nodes.
const OUT: usize = 8_192;
/// Memory of Nordic's controller for six links with packets of 251 bytes.
const CONTROLLER_BYTES: usize = 24_576;

#[embassy_executor::main]
async fn main(spawner: Spawner) {
    let p = embassy_nrf::init(config());
    interrupt::USBD.set_priority(Priority::P2);

    let parts = layer_parts!(p);
    let layer = MultiprotocolServiceLayer::new(parts, Interrupts, LOW_FREQUENCY_CLOCK);
    let mpsl = radio_layer(spawner, layer).await;

    // One edge: its time into TIMER3, and one more in TIMER4; the processor has no part in it.
    let (clock, timer) = BoardClock::start(p.TIMER3);
    let counter = HardwareTimer::new_counter(p.TIMER4);
    counter.start();
    let sync = InputChannel::new(p.GPIOTE_CH0, p.P0_02, Pull::Down, InputChannelPolarity::LoToHi);
    let (capture, count) = (timer.cc(CC_EDGE).task_capture(), counter.task_count());
    let mut fork = Ppi::new_one_to_two(p.PPI_CH0, sync.event_in(), capture, count);
    fork.enable();
    let gate = InputChannel::new(p.GPIOTE_CH1, p.P0_03, Pull::Down, InputChannelPolarity::Toggle);

    let (rng, boot) = boot_id(rng::Rng::new(p.RNG, Interrupts)).await;
    static CONTROLLER: StaticCell<nrf_sdc::Mem<CONTROLLER_BYTES>> = StaticCell::new();
    let controller = (|| {
        nrf_sdc::Builder::new()?
            .support_scan()
            .support_central()
            .support_dle_central()
            .support_le_2m_phy()
            .support_phy_update_central()
            .central_count(NODES_MAX as u8)?
            .buffer_cfg(251, 251, 3, 4)?
            .build(controller_parts!(p), rng, mpsl, CONTROLLER.init(nrf_sdc::Mem::new()))
    })()
    .expect("the controller starts with these fixed settings");

    static RECEIVER: StaticCell<RefCell<Receiver<OUT>>> = StaticCell::new();
    let receiver = RECEIVER.init(RefCell::new(Receiver::new(boot, clock.now_us())));
    let radio = Radio::new(receiver, &clock);
    let count = pulses::watch(sync, gate, &counter, &clock, receiver);
    let follow = clock.follow(&timer, p.RTC2, p.PPI_CH1);
    let (usb, line) = serial::open(p.USBD, Interrupts);
    let serial = serial::run(line, &clock, receiver, &radio);
    let talking = shisei_board::receiver::run(controller, address(), ReportAnchors::new(true), &radio);
    // Without its radio a receiver is nothing: it starts anew.
    select(talking, join4(count, follow, usb, serial)).await;
    cortex_m::peripheral::SCB::sys_reset();
}
