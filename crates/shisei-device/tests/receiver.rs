//! A receiver, seen from the PC.

use shisei_device::receiver::{NODES_MAX, Receiver};
use shisei_wire::calibration::{Calibration, Correction};
use shisei_wire::frame::FRAME_MAX;
use shisei_wire::message::{Command, EventCode, MESSAGE_MAX, NO_NODE};
use shisei_wire::packet::{self, Anchor, Header, Sample};
use shisei_wire::{Deframer, Message, encode_frame};

type Small = Receiver<4096>;

/// What the PC reads now; every frame must be readable.
fn read<const N: usize>(receiver: &mut Receiver<N>, mut each: impl FnMut(&Message<'_>)) -> usize {
    let mut bytes = vec![0; N];
    let count = receiver.outbox.take(&mut bytes);
    let (mut deframer, mut frames) = (Deframer::default(), 0);
    for byte in &bytes[..count] {
        if let Some(message) = deframer.push(*byte) {
            each(&Message::decode(message.expect("a whole frame")).expect("a message"));
            frames += 1;
        }
    }
    assert_eq!(deframer.pending(), 0);
    frames
}

fn events<const N: usize>(receiver: &mut Receiver<N>) -> Vec<(EventCode, u8, u32)> {
    let mut events = Vec::new();
    read(receiver, |message| {
        if let Message::Event(event) = message {
            events.push((event.code, event.node, event.value));
        }
    });
    events
}

fn notification(boot: u16, sequence: u16, event: u16) -> Vec<u8> {
    let anchor = Some(Anchor { event, time_us: 5 });
    let header = Header { boot, sequence, anchor, ..Header::default() };
    let mut bytes = [0; 240];
    let length = packet::encode(&header, &[Sample::default(); 4], &mut bytes).unwrap();
    bytes[..length].to_vec()
}

fn send(receiver: &mut Small, command: &Command<'_>) -> Option<(u8, Vec<u8>)> {
    let (mut bytes, mut frame) = ([0; MESSAGE_MAX], [0; FRAME_MAX]);
    let length = Message::Command(*command).encode(&mut bytes).unwrap();
    let length = encode_frame(&bytes[..length], &mut frame).unwrap();
    let answers: Vec<_> = frame[..length].iter().filter_map(|byte| receiver.byte(*byte, 0)).collect();
    answers.first().map(|to_node| (to_node.node, to_node.bytes().to_vec()))
}

#[test]
fn losses_reboots_and_anchors_are_told() {
    let mut receiver = Small::new(3, 0);
    assert_eq!(receiver.advertised([1; 6], 0), Some(0));
    receiver.connected(0, "左手", &[0xe4, 0x0c, 0xd0, 0x09, 0, 1, 0, 1, 0], 10);
    for event in 0..100 {
        receiver.anchor(0, event, u64::from(event) * 15_000);
    }
    assert_eq!(events(&mut receiver), [(EventCode::Started, NO_NODE, 3), (EventCode::Connected, 0, 0)]);
    receiver.notification(0, &notification(9, 65_532, 99), 20);
    receiver.notification(0, &notification(9, 0, 98), 21);
    receiver.notification(0, &notification(9, 9, 3), 22);
    receiver.notification(0, &notification(8, 0, 99), 23);
    receiver.notification(0, &[1, 2, 3], 24);
    let (mut anchors, mut told) = (vec![], vec![]);
    read(&mut receiver, |message| match message {
        Message::Data(data) => anchors.push(data.anchor_us),
        Message::Event(event) => told.push((event.code, event.value)),
        _ => {}
    });
    assert_eq!(anchors, [Some(1_485_000), Some(1_470_000), None, Some(1_485_000)]);
    assert_eq!(told, [(EventCode::Lost, 5), (EventCode::Rebooted, 8), (EventCode::BadPacket, 3)]);
}

#[test]
fn pulses_count_from_the_gate() {
    let mut receiver = Small::new(3, 0);
    receiver.pulse(100, 11);
    receiver.gate(true, 150, 11);
    receiver.gate(true, 151, 11);
    receiver.pulse(200, 12);
    receiver.pulse(300, 14);
    receiver.gate(false, 350, 14);
    receiver.tick(2_000_000);
    let (mut pulses, mut told) = (vec![], vec![]);
    read(&mut receiver, |message| match message {
        Message::Pulse(pulse) => pulses.push((pulse.count, pulse.gate_seen)),
        Message::Event(event) => told.push((event.code, event.value)),
        _ => {}
    });
    assert_eq!(pulses, [(10, false), (0, true), (2, true)]);
    assert_eq!(
        told,
        [
            (EventCode::Started, 3),
            (EventCode::GateUp, 0),
            (EventCode::GateDown, 3),
            (EventCode::PulsesStopped, 2)
        ]
    );
}

#[test]
fn six_nodes_and_a_seventh() {
    let mut receiver = Small::new(3, 0);
    for place in 0..NODES_MAX {
        assert_eq!(receiver.advertised([place as u8; 6], 0), Some(place));
        receiver.connected(place, "", &[], 0);
    }
    assert_eq!(receiver.advertised([9; 6], 0), None);
    assert_eq!(receiver.advertised([9; 6], 1), None);
    assert_eq!(events(&mut receiver).iter().filter(|event| event.0 == EventCode::Full).count(), 1);
    receiver.disconnected(2, 8, 2);
    assert_eq!(receiver.advertised([2; 6], 3), Some(2), "its old place");
    assert_eq!(receiver.advertised([9; 6], 3), Some(2), "a place of one that is gone");
}

#[test]
fn a_slow_pc_costs_whole_frames_that_are_counted() {
    let mut receiver = Small::new(3, 0);
    receiver.connected(0, "", &[], 0);
    let mut sent = 2;
    for k in 0..200_u16 {
        receiver.notification(0, &notification(9, 4 * k, 0), 0);
        sent += 1;
    }
    let kept = read(&mut receiver, |_| {});
    let dropped = receiver.outbox.dropped();
    assert!(dropped > 100);
    assert_eq!(kept + dropped as usize, sent);
    receiver.tick(1);
    assert!(events(&mut receiver).contains(&(EventCode::Dropped, NO_NODE, dropped)));
    receiver.tick(2_000_000);
    assert!(!events(&mut receiver).iter().any(|event| event.0 == EventCode::Dropped));
}

#[test]
fn commands_go_to_nodes_that_are_there() {
    let mut receiver = Small::new(3, 0);
    assert_eq!(receiver.advertised([1; 6], 0), Some(0));
    receiver.connected(0, "a", &[], 0);
    assert_eq!(send(&mut receiver, &Command::Rename(0, "足")), Some((0, [&[132], "足".as_bytes()].concat())));
    assert_eq!(send(&mut receiver, &Command::Identify(NO_NODE)), Some((NO_NODE, vec![130])));
    let _ = events(&mut receiver);
    assert_eq!(send(&mut receiver, &Command::Identify(1)), None);
    assert_eq!(events(&mut receiver), [(EventCode::BadCommand, 1, 130)]);
    for byte in [5, 5, 5, 0] {
        assert_eq!(receiver.byte(byte, 0), None);
    }
    assert_eq!(events(&mut receiver), [(EventCode::BadCommand, NO_NODE, 0)]);
    assert_eq!(send(&mut receiver, &Command::Ask), None);
    let mut names = Vec::new();
    read(&mut receiver, |message| {
        if let Message::Node(node) = message {
            names.push(node.name.to_owned());
        }
    });
    assert_eq!(names, ["足"]);
}

#[test]
fn a_nodes_calibration_is_passed_on_told_and_read_back() {
    let mut receiver = Small::new(3, 0);
    assert_eq!(receiver.advertised([1; 6], 0), Some(0));
    receiver.connected(0, "a", &[], 0);
    let half = |bias: f32| Correction {
        bias: [bias, 0.0, 0.0],
        matrix: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    };
    let calibration = Calibration { accelerometer: half(0.25), gyroscope: half(-0.0625) };
    let bytes = calibration.encode().unwrap();
    let sent = send(&mut receiver, &Command::Keep(0, Some(calibration)));
    assert_eq!(sent, Some((0, [&[134], bytes.as_slice()].concat())));
    assert_eq!(send(&mut receiver, &Command::Keep(0, None)), Some((0, vec![134])));

    let told = |receiver: &mut Small| {
        let mut all = Vec::new();
        read(receiver, |message| {
            if let Message::Calibration(kept) = message {
                all.push((kept.node, kept.calibration));
            }
        });
        all
    };
    // with the node's name at first: none is known
    assert_eq!(told(&mut receiver), [(0, None)]);
    receiver.calibration(0, &bytes);
    assert_eq!(told(&mut receiver), [(0, Some(calibration))]);
    // the same again is no news; what cannot be read is none
    receiver.calibration(0, &bytes);
    assert_eq!(told(&mut receiver), []);
    assert_eq!(send(&mut receiver, &Command::Ask), None);
    assert_eq!(told(&mut receiver), [(0, Some(calibration))]);
    receiver.calibration(0, &bytes[..50]);
    assert_eq!(told(&mut receiver), [(0, None)]);
    receiver.calibration(9, &bytes);
}

/// A PC opens the port after nobody has read it for long, and asks: what it asks for waits for room, also beside
/// packets that want the same.
#[test]
fn an_answer_is_not_lost_in_a_full_outbox() {
    let mut receiver = Small::new(3, 0);
    for place in 0..NODES_MAX {
        assert_eq!(receiver.advertised([place as u8; 6], 0), Some(place));
        receiver.connected(place, "left-hand", &[0xe4, 0x0c, 0xd0, 0x09, 0, 1, 0, 1, 0], 10);
    }
    let mut sequence = 0;
    let mut notify = |receiver: &mut Small| {
        receiver.notification(0, &notification(7, sequence, 0), 20);
        sequence += 4;
    };
    (0..200).for_each(|_| notify(&mut receiver));
    assert!(receiver.outbox.dropped() > 100);
    assert_eq!(send(&mut receiver, &Command::Ask), None);
    // the PC reads a packet of USB at a time, while more notifications come than it reads
    let mut bytes = Vec::new();
    for step in 0..400 {
        let mut packet = [0; 64];
        let count = receiver.outbox.take(&mut packet);
        bytes.extend_from_slice(&packet[..count]);
        receiver.tick(30 + step);
        notify(&mut receiver);
    }
    let (mut deframer, mut hellos, mut nodes, mut kept) = (Deframer::default(), 0, Vec::new(), Vec::new());
    for byte in &bytes {
        match deframer.push(*byte).map(|message| Message::decode(message.expect("a whole frame"))) {
            Some(Ok(Message::Hello(_))) => hellos += 1,
            Some(Ok(Message::Node(node))) => nodes.push(node.node),
            Some(Ok(Message::Calibration(told))) => kept.push(told.node),
            _ => {}
        }
    }
    let all: Vec<u8> = (0..NODES_MAX as u8).collect();
    // what was told when they connected waited before
    assert!(
        hellos >= 1 && nodes == [&all[..], &all].concat() && kept == nodes,
        "{hellos} {nodes:?} {kept:?}"
    );
}

#[test]
fn a_command_that_a_node_did_not_take_is_told() {
    let mut receiver = Small::new(3, 0);
    receiver.advertised([1; 6], 0);
    receiver.connected(0, "a", &[], 10);
    let (node, command) = send(&mut receiver, &Command::Identify(0)).expect("for the node");
    events(&mut receiver);
    receiver.not_carried_out(node, command[0], 20);
    assert_eq!(events(&mut receiver), [(EventCode::BadCommand, 0, u32::from(Command::Identify(0).kind()))]);
}
