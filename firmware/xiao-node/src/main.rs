//! The node on a Seeed XIAO nRF52840 Sense: pins, PPI, timers. What it does is in `shisei-device`.
#![no_std]
#![no_main]

mod battery;
mod board;
mod memory;
mod sensor;

use core::cell::{Cell, RefCell};

use embassy_executor::Spawner;
use embassy_futures::join::{join, join4};
use embassy_futures::select::select;
use embassy_nrf::gpio::{Level, Output, OutputDrive, Pull};
use embassy_nrf::gpiote::{InputChannel, InputChannelPolarity};
use embassy_nrf::ppi::Ppi;
use embassy_nrf::{bind_interrupts, peripherals, rng, saadc, twim};
use embassy_time::Timer;
use nrf_mpsl::{self as mpsl, MultiprotocolServiceLayer, SessionMem};
use nrf_sdc::vendor::NordicConnAnchorPointUpdateEventReportEnable as ReportAnchors;
use shisei_board::node::Radio;
use shisei_device::node::{Node, step};
use shisei_xiao::{
    BoardClock, CC_EDGE, LOW_FREQUENCY_CLOCK, address, boot_id, config, controller_parts, layer_parts,
    radio_layer,
};
use static_cell::StaticCell;

use board::Xiao;
use memory::{Changed, Memory, first_name};
use sensor::Readings;

bind_interrupts!(struct Interrupts {
    RNG => rng::InterruptHandler<peripherals::RNG>;
    SAADC => saadc::InterruptHandler;
    TWISPI0 => twim::InterruptHandler<peripherals::TWISPI0>;
    EGU0_SWI0 => mpsl::LowPrioInterruptHandler;
    CLOCK_POWER => mpsl::ClockInterruptHandler;
    RADIO => mpsl::HighPrioInterruptHandler;
    TIMER0 => mpsl::HighPrioInterruptHandler;
    RTC0 => mpsl::HighPrioInterruptHandler;
});

/// Memory of Nordic's controller for one link with packets of 251 bytes.
const CONTROLLER_BYTES: usize = 8_192;
/// The logic is looked after at least this often, ms.
const STEP_MS: u64 = 4;

#[embassy_executor::main]
async fn main(spawner: Spawner) {
    let p = embassy_nrf::init(config());

    static SESSIONS: StaticCell<SessionMem<1>> = StaticCell::new();
    let parts = layer_parts!(p);
    let sessions = SESSIONS.init(SessionMem::new());
    let layer = MultiprotocolServiceLayer::with_timeslots(parts, Interrupts, LOW_FREQUENCY_CLOCK, sessions);
    let mpsl = radio_layer(spawner, layer).await;

    // Each data-ready edge is captured by hardware.
    let (clock, timer) = BoardClock::start(p.TIMER3);
    let ready = InputChannel::new(p.GPIOTE_CH0, p.P0_11, Pull::None, InputChannelPolarity::LoToHi);
    let mut capture = Ppi::new_one_to_one(p.PPI_CH0, ready.event_in(), timer.cc(CC_EDGE).task_capture());
    capture.enable();

    let power = Output::new(p.P1_08, Level::High, OutputDrive::Standard0HighDrive1);
    static I2C_BUFFER: StaticCell<[u8; 16]> = StaticCell::new();
    let mut i2c_config = twim::Config::default();
    i2c_config.frequency = twim::Frequency::K400;
    let i2c = twim::Twim::new(p.TWISPI0, Interrupts, p.P0_07, p.P0_27, i2c_config, I2C_BUFFER.init([0; 16]));

    let (rng, boot) = boot_id(rng::Rng::new(p.RNG, Interrupts)).await;
    static CONTROLLER: StaticCell<nrf_sdc::Mem<CONTROLLER_BYTES>> = StaticCell::new();
    let controller = (|| {
        nrf_sdc::Builder::new()?
            .support_adv()
            .support_peripheral()
            .support_dle_peripheral()
            .support_le_2m_phy()
            .support_phy_update_peripheral()
            .peripheral_count(1)?
            .buffer_cfg(251, 251, 4, 4)?
            .build(controller_parts!(p), rng, mpsl, CONTROLLER.init(nrf_sdc::Mem::new()))
    })()
    .expect("the controller starts with these fixed settings");

    let mut memory = Memory::new(mpsl, p.NVMC);
    let mut node = Node::new(boot, &first_name());
    node.restore(&memory.record());
    let changed = Changed::new();
    let keep = memory.keep(&changed);
    let (radio, readings) = (Radio::default(), Readings::default());
    readings.set_ranges(node.settings().gyro_range, node.settings().acc_range);
    let node = RefCell::new(node);
    radio.set_status(&node.borrow());
    let battery_mv = Cell::new(0);
    let battery = battery::watch(p.SAADC, Interrupts, p.P0_31, p.P0_14, &battery_mv);
    let light = Output::new(p.P0_06, Level::High, OutputDrive::Standard);

    let logic = async {
        let mut board = Xiao {
            clock: &clock,
            readings: &readings,
            radio: &radio,
            battery_mv: &battery_mv,
            light,
            to_store: None,
        };
        loop {
            select(readings.wait(), Timer::after_millis(STEP_MS)).await;
            let mut node = node.borrow_mut();
            step(&mut node, &mut board);
            radio.set_status(&node);
            if let Some(record) = board.to_store.take() {
                changed.signal(record);
            }
        }
    };
    let sensing = sensor::run(i2c, ready, power, &clock, &readings);
    let follow = clock.follow(&timer, p.RTC2, p.PPI_CH1);
    let talking = shisei_board::node::run(controller, address(), ReportAnchors::new(true), &radio);
    // Without its radio a node is nothing: it starts anew.
    select(talking, join4(join(logic, sensing), follow, battery, keep)).await;
    cortex_m::peripheral::SCB::sys_reset();
}
