//! Bytes made by others: Python's struct, cobs 1.2 and crcmod 1.7 (crcmod.mkCrcFun(0x11021, 0xFFFF, False, 0)).

use shisei_wire::frame::FRAME_MAX;
use shisei_wire::message::{MESSAGE_MAX, Pulse};
use shisei_wire::{Message, encode_frame};

/// `cobs.encode(m + crc(m))` and a 0, m = `struct.pack('<BBQIB', 1, 2, 0x1234567800, 77, 3)`.
const FRAME: &[u8] = &[
    0x03, 0x01, 0x02, 0x05, 0x78, 0x56, 0x34, 0x12, 0x01, 0x01, 0x02, 0x4d, 0x01, 0x01, 0x04, 0x03, 0xbf,
    0xfc, 0x00,
];

#[test]
fn a_pulse_is_framed_as_others_frame_it() {
    let pulse =
        Message::Pulse(Pulse { time_us: 0x0012_3456_7800, count: 77, gate_seen: true, gate_up: true });
    let (mut bytes, mut frame) = ([0; MESSAGE_MAX], [0; FRAME_MAX]);
    let length = pulse.encode(&mut bytes).unwrap();
    let framed = encode_frame(&bytes[..length], &mut frame).unwrap();
    assert_eq!(&frame[..framed], FRAME);
}
