//! Prints, for each filter, the bits of the node's packets and the instructions of a sample: of the filter alone, and
//! whole, with the seven readings of a tick, their integration and the queue. With `-icount shift=0` QEMU's clock advances by 1 ns an instruction, so a tick
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
/// Instructions between two calls, after the start: sum, worst and how many.
#[derive(Default)]
struct Count {
    begun: u32,
    sum: u64,
    worst: u64,
    times: u64,
}

impl Count {
    fn look(&mut self, reading: u64, before: bool) {
        let now = SYST::get_current();
        if before {
            self.begun = now;
        } else if reading > work::STARTED {
            let took = u64::from(self.begun.wrapping_sub(now) & RELOAD) * INSTRUCTIONS_PER_TICK;
            self.sum += took;
            self.worst = self.worst.max(took);
            self.times += 1;
        }
    }
}

fn report(name: &str, kind: FilterKind, calibrated: bool) {
    let (mut filter, mut whole) = (Count::default(), Count::default());
    core::hint::black_box(work::filter(kind, |reading, before| filter.look(reading, before)));
    let (hash, samples) = work::run(kind, calibrated, |reading, before| whole.look(reading, before));
    let mean = filter.sum / filter.times.max(1);
    hprintln!(
        "{} {:016x} {} samples, filter mean {} worst {} whole {}",
        name,
        hash,
        samples,
        mean,
        filter.worst,
        whole.sum / filter.times.max(1)
    );
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
    for (name, kind, calibrated) in work::CASES {
        report(name, kind, calibrated);
    }
    debug::exit(debug::EXIT_SUCCESS);
    loop {
        cortex_m::asm::wfi();
    }
}
