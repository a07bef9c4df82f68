//! Whatever is written comes back; whatever comes in does not panic.

use proptest::prelude::*;
use shisei_wire::calibration::{CALIBRATION_BYTES, Calibration, Correction};
use shisei_wire::frame::FRAME_MAX;
use shisei_wire::message::{
    Command, Data, Event, EventCode, Hello, MESSAGE_MAX, Node, NodeCalibration, Pulse, Settings,
};
use shisei_wire::packet::{self, Anchor, FilterKind, Flags, PACKET_MAX, Start};
use shisei_wire::{AccRange, Deframer, GyroRange, Header, Message, Packet, Sample, encode_frame};

fn flags() -> impl Strategy<Value = Flags> {
    (any::<[bool; 5]>(), 0..5_u8, 0..4_u8, 0..4_usize).prop_map(|(bits, gyro, acc, start)| Flags {
        late: bits[0],
        battery_low: bits[1],
        gyro_range: GyroRange::from_code(gyro).unwrap(),
        acc_range: AccRange::from_code(acc).unwrap(),
        filter: if bits[2] { FilterKind::Estimator } else { FilterKind::Complementary },
        start: [Start::Running, Start::Done, Start::Skipped, Start::Moved][start],
        reading_missed: bits[3],
        calibrated: bits[4],
    })
}

fn header() -> impl Strategy<Value = Header> {
    let anchor = proptest::option::of(any::<(u16, u32)>());
    (flags(), any::<(u16, u16, u32)>(), anchor, proptest::option::of(-4000..12000_i16)).prop_map(
        |(flags, (boot, sequence, time_us), anchor, temperature_centi_c)| Header {
            flags,
            boot,
            sequence,
            time_us,
            anchor: anchor.map(|(event, time_us)| Anchor { event, time_us }),
            temperature_centi_c,
        },
    )
}

fn sample() -> impl Strategy<Value = Sample> {
    any::<(u16, [i16; 3], [i16; 3], [i16; 4])>().prop_map(|(dt_us, gyro, acc, quaternion)| Sample {
        dt_us,
        gyro,
        acc,
        quaternion,
    })
}

fn calibration() -> impl Strategy<Value = Calibration> {
    let correction = |bias_max: f32| {
        let matrix = proptest::array::uniform3(proptest::array::uniform3(-0.2_f32..0.2));
        (proptest::array::uniform3(-bias_max..bias_max), matrix).prop_map(|(bias, mut matrix)| {
            (0..3).for_each(|axis| matrix[axis][axis] += 1.0);
            Correction { bias, matrix }
        })
    };
    (correction(5.0), correction(0.5))
        .prop_map(|(accelerometer, gyroscope)| Calibration { accelerometer, gyroscope })
}

fn comes_back(message: &Message<'_>) {
    let mut bytes = [0; MESSAGE_MAX];
    let length = message.encode(&mut bytes).unwrap();
    assert_eq!(Message::decode(&bytes[..length]).as_ref(), Ok(message));
    let mut frame = [0; FRAME_MAX];
    let framed = encode_frame(&bytes[..length], &mut frame).unwrap();
    assert!(frame[..framed - 1].iter().all(|byte| *byte != 0) && frame[framed - 1] == 0);
    let mut deframer = Deframer::default();
    let mut found = 0;
    for byte in &frame[..framed] {
        if let Some(opened) = deframer.push(*byte) {
            assert_eq!(opened, Ok(&bytes[..length]));
            found += 1;
        }
    }
    assert_eq!(found, 1);
}

proptest! {
    #[test]
    fn packets_come_back(header in header(), samples in proptest::collection::vec(sample(), 1..=10)) {
        let mut bytes = [0; PACKET_MAX];
        let length = packet::encode(&header, &samples, &mut bytes).unwrap();
        let packet = Packet::decode(&bytes[..length]).unwrap();
        prop_assert_eq!(packet.header, header);
        prop_assert_eq!(packet.samples().collect::<Vec<_>>(), samples);
    }

    #[test]
    fn messages_come_back(
        (boot, time_us, other_us, count) in any::<(u16, u64, u64, u32)>(),
        (node, a, b, code, address) in any::<(u8, bool, bool, u8, [u8; 6])>(),
        packet in proptest::collection::vec(any::<u8>(), 0..=244),
        name in "[a-zあ-ん]{0,6}",
        calibration in calibration(),
    ) {
        let firmware = [node, 1, 2];
        comes_back(&Message::Hello(Hello {
            boot, firmware, gate_seen: a, gate_up: b, time_us, dropped: count,
        }));
        comes_back(&Message::Pulse(Pulse { time_us, count, gate_seen: a, gate_up: b }));
        comes_back(&Message::Data(Data {
            node,
            arrival_us: time_us,
            anchor_us: a.then_some(other_us),
            pulse: b.then_some(count),
            packet: &packet,
        }));
        let code = EventCode::ALL[usize::from(code) % EventCode::ALL.len()];
        comes_back(&Message::Event(Event { time_us, code, node, value: count }));
        comes_back(&Message::Node(Node {
            node, connected: a, address, boot, battery_mv: boot, temperature_centi_c: b.then_some(2150),
            firmware, name: &name,
        }));
        let settings = Settings { batch: 1 + node % 10, ..Settings::default() };
        for command in [
            Command::Ask,
            Command::Identify(node),
            Command::Calibrate(node),
            Command::Rename(node, &name),
            Command::Configure(node, settings),
            Command::Keep(node, Some(calibration)),
            Command::Keep(node, None),
        ] {
            comes_back(&Message::Command(command));
            // as a node is written it: without version and node
            let mut bytes = [0; MESSAGE_MAX];
            let length = Message::Command(command).encode(&mut bytes).unwrap();
            let fields = bytes[..length].get(3..).unwrap_or_default();
            let written: Vec<u8> = bytes[1..2].iter().chain(fields).copied().collect();
            prop_assert!(written.len() <= shisei_wire::gatt::COMMAND_MAX);
            let read = Command::decode_for_node(&written).unwrap();
            prop_assert_eq!((read.kind(), read.node()), (command.kind(), shisei_wire::message::NO_NODE));
            if let (Command::Keep(_, read), Command::Keep(_, sent)) = (read, command) {
                prop_assert_eq!(read, sent);
            }
        }
        for calibration in [Some(calibration), None] {
            comes_back(&Message::Calibration(NodeCalibration { node, calibration }));
        }
    }

    #[test]
    fn hostile_bytes_are_refused_and_nothing_else(bytes in proptest::collection::vec(any::<u8>(), 0..700)) {
        let _ = Message::decode(&bytes);
        let _ = Command::decode_for_node(&bytes);
        let _ = Calibration::decode(bytes.get(..CALIBRATION_BYTES).unwrap_or(&bytes));
        if let Ok(packet) = Packet::decode(&bytes) {
            prop_assert_eq!(packet.samples().count(), usize::from(packet.count()));
        }
        let mut deframer = Deframer::default();
        for byte in bytes {
            let _ = deframer.push(byte);
        }
    }

    /// The checksum finds every burst of 16 bits or less: what passes differs in more than a byte (a damaged
    /// length byte of COBS moves everything after it, which a 16-bit sum misses once in 65536 times).
    #[test]
    fn one_damaged_byte_is_noticed(
        count in any::<u32>(), at in 0..17_usize, change in 1..=255_u8,
    ) {
        let mut bytes = [0; MESSAGE_MAX];
        let pulse = Message::Pulse(Pulse { time_us: 0x1234_5678_9abc, count, gate_seen: true, gate_up: true });
        let length = pulse.encode(&mut bytes).unwrap();
        let mut frame = [0; FRAME_MAX];
        let framed = encode_frame(&bytes[..length], &mut frame).unwrap();
        prop_assume!(at < framed - 1);
        frame[at] ^= change;
        let mut deframer = Deframer::default();
        for byte in &frame[..framed] {
            if let Some(Ok(message)) = deframer.push(*byte) {
                let changed = message.iter().zip(&bytes).filter(|(a, b)| a != b).count();
                prop_assert!(message.len() != length || changed > 1, "a damaged frame passed");
            }
        }
    }
}
