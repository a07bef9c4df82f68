//! Bytes of the serial line and of the air: frames, messages, packets. What decodes, encodes to the same bytes.
#![no_main]

use libfuzzer_sys::fuzz_target;
use shisei_wire::message::{Command, MESSAGE_MAX};
use shisei_wire::{Calibration, Deframer, Message, Packet};

fuzz_target!(|bytes: &[u8]| {
    if let Ok(packet) = Packet::decode(bytes) {
        assert_eq!(packet.samples().count(), usize::from(packet.count()));
    }
    let _ = Command::decode_for_node(bytes);
    if let Ok(calibration) = Calibration::decode(bytes) {
        assert_eq!(calibration.encode().as_ref().map(|again| again.as_slice()), Ok(bytes));
    }
    check(bytes);
    let mut deframer = Deframer::default();
    for byte in bytes {
        if let Some(Ok(message)) = deframer.push(*byte) {
            check(message);
        }
    }
});

fn check(bytes: &[u8]) {
    let Ok(message) = Message::decode(bytes) else { return };
    let mut again = [0; MESSAGE_MAX];
    let length = message.encode(&mut again).expect("what was decoded fits");
    assert_eq!(Message::decode(&again[..length]), Ok(message));
    if let Message::Data(data) = message {
        let _ = Packet::decode(data.packet);
    }
}
