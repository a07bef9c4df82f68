//! Prints, for each filter, the bits of the node's packets and the instructions of a sample: the readings of a tick
//! with integration, filter and queue. With `-icount shift=0` QEMU's clock advances by 1 ns an instruction, so a tick
//! of the board's 25 MHz timer is 40.
#![no_std]
#![no_main]

mod work;

use cortex_m::peripheral::syst::SystClkSource;
use cortex_m::peripheral::{Peripherals, SYST};
use cortex_m_rt::entry;
use cortex_m_semihosting::{debug, hprintln};
use panic_semihosting as _;
use shisei_wire::packet::FilterKind;

const INSTRUCTIONS_PER_TICK: u64 = 40;
/// The timer counts down through 24 bits.
const RELOAD: u32 = 0x00FF_FFFF;
/// Readings a sample: 833 / 120 Hz.
const READINGS: (u64, u64) = (833, 120);

fn report(name: &str, filter: FilterKind) {
    let (mut begun, mut sum, mut worst) = (0, 0, 0);
    let (hash, samples) = work::run(filter, |k, before| {
        if before {
            begun = SYST::get_current();
        } else if k > work::STARTED {
            let took = u64::from(begun.wrapping_sub(SYST::get_current()) & RELOAD) * INSTRUCTIONS_PER_TICK;
            sum += took;
            worst = u64::max(worst, took);
        }
    });
    let readings = work::READINGS - work::STARTED - 1;
    let mean = sum * READINGS.0 / (readings * READINGS.1);
    hprintln!("{} {:016x} {} samples, mean {} worst {} instructions", name, hash, samples, mean, worst);
}

#[entry]
fn main() -> ! {
    if let Some(mut peripherals) = Peripherals::take() {
        let timer = &mut peripherals.SYST;
        timer.set_clock_source(SystClkSource::Core);
        timer.set_reload(RELOAD);
        timer.clear_current();
        timer.enable_counter();
    }
    report("complementary", FilterKind::Complementary);
    report("estimator", FilterKind::Estimator);
    debug::exit(debug::EXIT_SUCCESS);
    loop {
        cortex_m::asm::wfi();
    }
}
