//! Prints `topic digest` lines through the debugger's console, then `all digest`, and ends the emulator.
#![no_std]
#![no_main]

use cortex_m_rt::entry;
use cortex_m_semihosting::{debug, hprintln};
use embedded_alloc::LlffHeap;
use panic_semihosting as _;

#[global_allocator]
static HEAP: LlffHeap = LlffHeap::empty();

const HEAP_BYTES: usize = 2 << 20;

#[entry]
fn main() -> ! {
    // The heap lies between the statics and the stack, which begins at the end of the 4 MiB of RAM.
    // SAFETY: done once, before anything allocates; nothing else uses that memory.
    unsafe { HEAP.init(cortex_m_rt::heap_start() as usize, HEAP_BYTES) };
    for topic in shisei_digest::TOPICS {
        hprintln!("{} {:016x}", topic.name, topic.digest());
    }
    hprintln!("all {:016x}", shisei_digest::digest());
    debug::exit(debug::EXIT_SUCCESS);
    loop {
        cortex_m::asm::wfi();
    }
}
