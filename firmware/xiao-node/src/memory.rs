//! The node's name, kept over restarts in the last page before the bootloader's user data.

use core::fmt::Write as _;

use embassy_nrf::Peri;
use embassy_nrf::peripherals::NVMC;
use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use embassy_sync::signal::Signal;
use heapless::String;
use nrf_mpsl::{Flash, MultiprotocolServiceLayer};
use shisei_wire::frame::checksum;
use shisei_wire::gatt::NAME_MAX;

/// As in memory.x.
const PAGE: u32 = 0x000E_B000;
const PAGE_BYTES: u32 = 0x1000;
/// Length and name, then their checksum.
const CONTENT: usize = 1 + NAME_MAX;
/// A multiple of four, as flash is written.
const RECORD: usize = 24;

/// A name.
pub type Name = String<NAME_MAX>;
/// A name that is to be kept.
pub type NewName = Signal<NoopRawMutex, Name>;

/// The page.
pub struct Memory {
    flash: Flash<'static>,
}

/// Flash is written in words.
#[repr(align(4))]
struct Record([u8; RECORD]);

impl Memory {
    /// To be called once.
    pub fn new(mpsl: &'static MultiprotocolServiceLayer<'static>, nvmc: Peri<'static, NVMC>) -> Self {
        Memory { flash: Flash::take(mpsl, nvmc) }
    }

    /// The name that was kept, else one from the chip's address.
    pub fn name(&mut self) -> Name {
        self.kept().unwrap_or_else(|| {
            let [a, b, ..] = shisei_xiao::address();
            let mut name = Name::new();
            // Nine bytes, which fit.
            let _ = write!(name, "node-{b:02x}{a:02x}");
            name
        })
    }

    fn kept(&mut self) -> Option<Name> {
        let mut record = [0; RECORD];
        self.flash.read(PAGE, &mut record).ok()?;
        let (content, sum) = record.split_first_chunk::<CONTENT>()?;
        let sum = u16::from_le_bytes(*sum.first_chunk()?);
        let (length, name) = content.split_first()?;
        let name = name.get(..usize::from(*length))?;
        if checksum(content) != sum || name.is_empty() {
            return None;
        }
        Name::try_from(core::str::from_utf8(name).ok()?).ok()
    }

    /// Keeps names as they come, between the radio's events. Never ends.
    pub async fn keep(mut self, new_name: &NewName) {
        loop {
            let name = new_name.wait().await;
            let mut record = Record([0xFF; RECORD]);
            let Some((content, rest)) = record.0.split_first_chunk_mut::<CONTENT>() else { return };
            let all = core::iter::once(name.len() as u8).chain(name.bytes());
            content.iter_mut().zip(all).for_each(|(place, byte)| *place = byte);
            let sum = checksum(content).to_le_bytes();
            rest.iter_mut().zip(sum).for_each(|(place, byte)| *place = byte);
            // Where the flash refuses, the name holds until the next start.
            if self.flash.erase(PAGE, PAGE + PAGE_BYTES).await.is_ok() {
                let _ = self.flash.write(PAGE, &record.0).await;
            }
        }
    }
}
