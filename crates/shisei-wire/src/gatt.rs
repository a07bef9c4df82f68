//! Identifiers of the node's Bluetooth service, as they go over the air (least significant byte first).

const fn uuid(number: u8) -> [u8; 16] {
    // 1f523310-9e1c-4e4d-b12a-5ccb6170xxxx
    [number, 0, 0x70, 0x61, 0xcb, 0x5c, 0x2a, 0xb1, 0x4d, 0x4e, 0x1c, 0x9e, 0x10, 0x33, 0x52, 0x1f]
}

/// The service; advertised, so that a receiver finds nodes by it.
pub const SERVICE: [u8; 16] = uuid(1);
/// Notified packets.
pub const DATA: [u8; 16] = uuid(2);
/// Written commands: the body of a command message (kind and fields, without version and node).
pub const CONTROL: [u8; 16] = uuid(3);
/// Read: battery mV u16, temperature 0.01 °C i16, firmware version 3 bytes, boot id u16, then the name.
pub const STATUS: [u8; 16] = uuid(4);
/// Read: the calibration that the node keeps ([`crate::calibration`]); empty where it keeps none.
pub const CALIBRATION: [u8; 16] = uuid(5);

/// Longest name of a node, bytes of UTF-8; so much fits beside the service into advertisement and scan response.
pub const NAME_MAX: usize = 20;
/// Longest written command: its kind and a calibration.
pub const COMMAND_MAX: usize = 1 + crate::calibration::CALIBRATION_BYTES;
/// Longest notification: an ATT MTU of 247 less 3.
pub const NOTIFICATION_MAX: usize = 244;
