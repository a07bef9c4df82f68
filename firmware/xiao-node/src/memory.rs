//! The node's name and calibration, kept over restarts in the last page before the bootloader's user data.

use core::fmt::Write as _;

use embassy_nrf::Peri;
use embassy_nrf::peripherals::NVMC;
use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use embassy_sync::signal::Signal;
use heapless::String;
use nrf_mpsl::{Flash, MultiprotocolServiceLayer};
use shisei_device::node::Node;
use shisei_wire::Calibration;
use shisei_wire::calibration::CALIBRATION_BYTES;
use shisei_wire::frame::checksum;
use shisei_wire::gatt::NAME_MAX;

/// As in memory.x.
const PAGE: u32 = 0x000E_B000;
const PAGE_BYTES: u32 = 0x1000;
/// Length and name, then their checksum.
const CONTENT: usize = 1 + NAME_MAX;
/// A multiple of four, as flash is written.
const NAME_RECORD: usize = 24;
/// Where in the page the calibration begins; erased flash (0xFF) is none.
const CALIBRATION_AT: usize = 32;
/// All that is written, a multiple of four.
const RECORD: usize = (CALIBRATION_AT + CALIBRATION_BYTES).next_multiple_of(4);

/// A name.
pub type Name = String<NAME_MAX>;
/// Settings that are to be kept.
pub type Changed = Signal<NoopRawMutex, Settings>;

/// What is kept.
pub struct Settings {
    pub name: Name,
    pub calibration: Option<Calibration>,
}

impl Settings {
    /// A node's.
    pub fn of(node: &Node) -> Self {
        Settings {
            name: Name::try_from(node.name()).unwrap_or_default(),
            calibration: node.calibration().copied(),
        }
    }
}

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

    /// What was kept; a name from the chip's address where none was.
    pub fn settings(&mut self) -> Settings {
        let name = self.name().unwrap_or_else(|| {
            let [a, b, ..] = shisei_xiao::address();
            let mut name = Name::new();
            // Nine bytes, which fit.
            let _ = write!(name, "node-{b:02x}{a:02x}");
            name
        });
        Settings { name, calibration: self.calibration() }
    }

    fn name(&mut self) -> Option<Name> {
        let mut record = [0; NAME_RECORD];
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

    fn calibration(&mut self) -> Option<Calibration> {
        let mut bytes = [0; CALIBRATION_BYTES];
        self.flash.read(PAGE + CALIBRATION_AT as u32, &mut bytes).ok()?;
        Calibration::decode(&bytes).ok()
    }

    /// Keeps settings as they come, between the radio's events. Never ends.
    pub async fn keep(mut self, changed: &Changed) {
        loop {
            let settings = changed.wait().await;
            let mut record = Record([0xFF; RECORD]);
            let Some((content, rest)) = record.0.split_first_chunk_mut::<CONTENT>() else { return };
            let all = core::iter::once(settings.name.len() as u8).chain(settings.name.bytes());
            content.iter_mut().zip(all).for_each(|(place, byte)| *place = byte);
            let sum = checksum(content).to_le_bytes();
            rest.iter_mut().zip(sum).for_each(|(place, byte)| *place = byte);
            if let Some(Ok(kept)) = settings.calibration.map(|kept| kept.encode())
                && let Some(place) = record.0.get_mut(CALIBRATION_AT..CALIBRATION_AT + CALIBRATION_BYTES)
            {
                place.copy_from_slice(&kept);
            }
            // Where the flash refuses, the settings hold until the next start.
            if self.flash.erase(PAGE, PAGE + PAGE_BYTES).await.is_ok() {
                let _ = self.flash.write(PAGE, &record.0).await;
            }
        }
    }
}
