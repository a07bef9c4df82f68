//! Prints `topic digest` lines through the debugger's console, then `all digest`, and ends the emulator.
#![no_std]
#![no_main]

use cortex_m_rt::entry;
use cortex_m_semihosting::{debug, hprintln};
use embedded_alloc::LlffHeap;
use panic_semihosting as _;

#[global_allocator]
static HEAP: LlffHeap = LlffHeap::empty();

/// The board's second RAM, all of it; the first holds statics and the stack.
const HEAP_START: usize = 0x2100_0000;
const HEAP_BYTES: usize = 16 << 20;

#[entry]
fn main() -> ! {
    // SAFETY: done once, before anything allocates; the linker puts nothing there.
    unsafe { HEAP.init(HEAP_START, HEAP_BYTES) };
    for topic in shisei_digest::TOPICS {
        hprintln!("{} {:016x}", topic.name, topic.digest());
    }
    hprintln!("all {:016x}", shisei_digest::digest());
    debug::exit(debug::EXIT_SUCCESS);
    loop {
        cortex_m::asm::wfi();
    }
}
