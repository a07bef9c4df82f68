//! Anchor points as Nordic's controller reports them: vendor event 0x82, switched on by vendor command 0xFD1F.

use bt_hci::event::Vendor;

/// Where the vendor event says what it is.
const SUBEVENT: u8 = 0x82;

/// The start of a connection event.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Anchor {
    /// Handle of the link.
    pub handle: u16,
    /// The link layer's counter; wraps.
    pub event: u16,
    /// The controller's clock, µs.
    pub controller_us: u64,
}

impl Anchor {
    /// Reads a vendor event: subevent u8, handle u16, counter u16, time u64. Another event is none.
    pub fn read(vendor: &Vendor<'_>) -> Option<Self> {
        let (fields, _) = vendor.params.as_ref().split_first_chunk::<13>()?;
        let [SUBEVENT, h0, h1, e0, e1, time @ ..] = *fields else { return None };
        Some(Anchor {
            handle: u16::from_le_bytes([h0, h1]),
            event: u16::from_le_bytes([e0, e1]),
            controller_us: u64::from_le_bytes(time),
        })
    }
}
