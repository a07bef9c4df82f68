//! What the node keeps over restarts ([`Record`]), in the last page before the bootloader's user data.

use core::fmt::Write as _;

use embassy_nrf::Peri;
use embassy_nrf::peripherals::NVMC;
use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use embassy_sync::signal::Signal;
use heapless::String;
use nrf_mpsl::{Flash, MultiprotocolServiceLayer};
use shisei_device::node::{RECORD_BYTES, Record};
use shisei_wire::gatt::NAME_MAX;

/// As in memory.x.
const PAGE: u32 = 0x000E_B000;
const PAGE_BYTES: u32 = 0x1000;

/// What is to be kept.
pub type Changed = Signal<NoopRawMutex, Record>;

/// The page.
pub struct Memory {
    flash: Flash<'static>,
}

/// Flash is written in words.
#[repr(align(4))]
struct Words([u8; RECORD_BYTES]);

impl Memory {
    /// To be called once.
    pub fn new(mpsl: &'static MultiprotocolServiceLayer<'static>, nvmc: Peri<'static, NVMC>) -> Self {
        Memory { flash: Flash::take(mpsl, nvmc) }
    }

    /// What was kept.
    pub fn record(&mut self) -> Record {
        let mut bytes = [0; RECORD_BYTES];
        self.flash.read(PAGE, &mut bytes).map_or(Record::default(), |()| Record::decode(&bytes))
    }

    /// Keeps what changed as it comes, between the radio's events. Never ends.
    pub async fn keep(mut self, changed: &Changed) {
        loop {
            let record = Words(changed.wait().await.encode());
            // Where the flash refuses, what changed holds until the next start.
            if self.flash.erase(PAGE, PAGE + PAGE_BYTES).await.is_ok() {
                let _ = self.flash.write(PAGE, &record.0).await;
            }
        }
    }
}

/// The name of a node that was given none, from the chip's address.
pub fn first_name() -> String<NAME_MAX> {
    let [a, b, ..] = shisei_xiao::address();
    let mut name = String::new();
    // Nine bytes, which fit.
    let _ = write!(name, "node-{b:02x}{a:02x}");
    name
}
