//! Nodes, radio, receiver and session together, against the simulator's truth.

use std::collections::BTreeMap;

use shisei_hub::{Item, Sample, Session};
use shisei_twin::lab::{Lab, Outage, Settings};
use shisei_wire::message::EventCode;
use shisei_wire::{Deframer, Message};

/// What a session told over a laboratory's time; the PC reads every 5 ms.
fn run(lab: &mut Lab, duration_s: f64) -> (Vec<Item>, Vec<u8>) {
    let (mut session, mut items, mut all) = (Session::default(), Vec::new(), Vec::new());
    let mut time_s = lab.time_s();
    while time_s < duration_s {
        time_s += 0.005;
        lab.run_to(time_s);
        let mut bytes = Vec::new();
        lab.serial(&mut bytes);
        session.push(&bytes, &mut items);
        all.extend_from_slice(&bytes);
    }
    session.finish(&mut items);
    assert_eq!(session.counts().garbage, 0);
    (items, all)
}

fn samples(items: &[Item]) -> impl Iterator<Item = &Sample> {
    items.iter().filter_map(|item| if let Item::Sample(sample) = item { Some(sample) } else { None })
}

fn events(items: &[Item], code: EventCode) -> Vec<(u8, u32)> {
    let found = items.iter().filter_map(|item| match item {
        Item::Event(event) if event.code == code => Some((event.node, event.value)),
        _ => None,
    });
    found.collect()
}

/// Samples by node and boot, their sequence numbers ascending; and how many are missing between them.
fn by_boot(items: &[Item]) -> (BTreeMap<(u8, u16), Vec<Sample>>, u64) {
    let mut boots: BTreeMap<(u8, u16), Vec<Sample>> = BTreeMap::new();
    for sample in samples(items) {
        boots.entry((sample.node, sample.boot)).or_default().push(*sample);
    }
    let mut missing = 0;
    for all in boots.values() {
        for two in all.windows(2) {
            let step = two[1].sequence - two[0].sequence;
            assert!(step > 0, "sequence numbers ascend");
            missing += step as u64 - 1;
        }
    }
    (boots, missing)
}

/// Errors of the frame index in camera time, µs, and those of the simple rule; all samples with a frame.
fn frame_errors(lab: &Lab, items: &[Item], camera_hz: f64) -> (Vec<f64>, Vec<f64>) {
    let (mut errors, mut simple) = (Vec::new(), Vec::new());
    for sample in samples(items) {
        let Some(frame) = sample.frame else { continue };
        let node = lab.node_at(sample.node).expect("a node that was there");
        let near_s = sample.time_s.expect("a sample with a frame has a time");
        let truth_s = lab.true_time_s(node, sample.boot, sample.stamp_us, near_s).expect("its own boot id");
        let truth = lab.true_frame(truth_s);
        errors.push((frame - truth).abs() / camera_hz * 1e6);
        if let Some(at_arrival) = sample.arrival_frame {
            simple.push((f64::from(at_arrival) - truth).abs() / camera_hz * 1e6);
        }
    }
    errors.sort_by(f64::total_cmp);
    simple.sort_by(f64::total_cmp);
    (errors, simple)
}

fn median_and_max(sorted: &[f64]) -> (f64, f64) {
    (sorted[sorted.len() / 2], sorted[sorted.len() - 1])
}

#[test]
fn six_nodes_lose_nothing() {
    let settings = Settings { nodes: 6, gate_s: Some(3.0), movement_s: 30.0, ..Settings::default() };
    let mut lab = Lab::new(settings);
    let (items, _) = run(&mut lab, 60.0);
    let (boots, missing) = by_boot(&items);
    assert_eq!((boots.len(), missing), (6, 0));
    for all in boots.values() {
        assert!(all.len() > 7000, "{}", all.len());
        let tagged = all.iter().filter(|sample| sample.from_gate).count();
        assert!(tagged > 6700, "{tagged} of {}", all.len());
    }
    for code in [EventCode::Lost, EventCode::Rebooted, EventCode::Dropped, EventCode::BadPacket] {
        assert_eq!(events(&items, code), []);
    }
    let (errors, simple) = frame_errors_from_gate(&lab, &items);
    let (own, rule) = (median_and_max(&errors), median_and_max(&simple));
    println!("six nodes: {} samples, frame error µs {own:?}, at arrival {rule:?}", errors.len());
    assert!(own.0 <= 20.0 && own.1 <= 200.0, "{own:?}");
}

fn frame_errors_from_gate(lab: &Lab, items: &[Item]) -> (Vec<f64>, Vec<f64>) {
    let gated: Vec<Item> =
        items.iter().filter(|item| matches!(item, Item::Sample(s) if s.from_gate)).cloned().collect();
    frame_errors(lab, &gated, 120.0)
}

#[test]
fn bad_radio_and_a_restart_are_told_and_nothing_is_tagged_wrongly() {
    let settings = Settings {
        nodes: 6,
        missed: 0.3,
        anchor_jitter_us: 16.0,
        outages: vec![
            Outage { node: 2, from_s: 20.0, to_s: 21.5 },
            Outage { node: 3, from_s: 25.0, to_s: 31.0 },
        ],
        reboots: vec![(1, 30.0), (4, 12.0), (4, 40.0)],
        movement_s: 30.0,
        ..Settings::default()
    };
    let mut lab = Lab::new(settings);
    let (items, bytes) = run(&mut lab, 60.0);
    let (boots, missing) = by_boot(&items);
    // Every start was seen.
    assert_eq!(boots.len(), 9);
    for (node, boot) in boots.keys() {
        let node = lab.node_at(*node).expect("there");
        assert!(lab.boots(node).iter().any(|known| known.id == *boot));
    }
    let rebooted: Vec<u8> = items
        .iter()
        .filter_map(|i| if let Item::Rebooted(node, _) = i { Some(*node) } else { None })
        .collect();
    assert_eq!(rebooted.len(), 3);
    assert_eq!(events(&items, EventCode::Rebooted).len(), 3);
    // Every missing sample was told, by the session and by the receiver, and only node 3 was away for too long.
    let told: u64 = items.iter().map(|i| if let Item::Lost(_, count) = i { *count } else { 0 }).sum();
    let by_receiver: u32 = events(&items, EventCode::Lost).iter().map(|(_, count)| count).sum();
    assert_eq!((missing, missing), (told, u64::from(by_receiver)));
    assert!((400..800).contains(&missing), "{missing}");
    // Six seconds away, a little over one of them kept.
    let tagged = samples(&items).filter(|sample| sample.frame.is_some()).count();
    let (errors, simple) = frame_errors(&lab, &items, 120.0);
    let (own, rule) = (median_and_max(&errors), median_and_max(&simple));
    let total = samples(&items).count();
    println!(
        "bad radio: {tagged} of {total} tagged, {missing} lost, frame error µs {own:?}, at arrival {rule:?}"
    );
    assert!(own.0 <= 20.0 && own.1 <= 200.0, "{own:?}");
    assert!(tagged as f64 > 0.99 * total as f64);
    // The bytes processed anew, in other portions, give the same.
    let (mut session, mut again) = (Session::default(), Vec::new());
    for portion in bytes.chunks(977) {
        session.push(portion, &mut again);
    }
    session.finish(&mut again);
    assert_eq!(again, items);
}

/// The gate rises once for each take: frames count from the last one, and that is told.
#[test]
fn a_second_take_counts_from_its_own_gate() {
    let (gate_s, second_gate_s) = (Some(3.0), Some(12.0));
    let mut lab = Lab::new(Settings { gate_s, second_gate_s, movement_s: 20.0, ..Settings::default() });
    let (items, bytes) = run(&mut lab, 20.0);
    let anew = |items: &[Item]| items.iter().filter(|item| **item == Item::CountedAnew).count();
    assert_eq!((events(&items, EventCode::GateUp).len(), anew(&items)), (2, 2));
    let (errors, _) = frame_errors_from_gate(&lab, &items);
    let (median, largest) = median_and_max(&errors);
    println!("two takes: {} samples, frame error µs median {median}, largest {largest}", errors.len());
    assert!(errors.len() > 3800 && median <= 20.0 && largest <= 200.0, "{median} {largest}");
    let last = samples(&items).filter_map(|sample| sample.frame).last().expect("frames");
    assert!(last < 8.0 * 120.0, "{last}");
    // the same where the gate's own message is lost on the line
    let (mut session, mut without) = (Session::default(), Vec::new());
    for frame in bytes.split_inclusive(|byte| *byte == 0) {
        let (mut deframer, mut gate) = (Deframer::default(), false);
        for &byte in frame {
            if let Some(Ok(Ok(Message::Event(event)))) =
                deframer.push(byte).map(|frame| frame.map(Message::decode))
            {
                gate = event.code == EventCode::GateUp;
            }
        }
        if !gate {
            session.push(frame, &mut without);
        }
    }
    session.finish(&mut without);
    assert_eq!((events(&without, EventCode::GateUp).len(), anew(&without)), (0, 2));
    let frames = |items: &[Item]| samples(items).map(|sample| sample.frame).collect::<Vec<_>>();
    assert_eq!(frames(&without), frames(&items));
}

#[test]
fn garbage_on_the_line_costs_what_it_hits() {
    let mut lab = Lab::new(Settings { nodes: 2, movement_s: 20.0, ..Settings::default() });
    let (clean, bytes) = run(&mut lab, 20.0);
    let mut random = shisei_twin::Random::new(5, 5);
    let mut dirty = Vec::new();
    for portion in bytes.chunks(1000) {
        let mut portion = portion.to_vec();
        match (random.uniform() * 8.0) as u32 {
            0 => portion[0] ^= 0x55,
            1 => portion.truncate(300),
            2 => portion.extend((0..200).map(|_| (random.uniform() * 256.0) as u8)),
            _ => {}
        }
        dirty.extend_from_slice(&portion);
    }
    let (mut session, mut items) = (Session::default(), Vec::new());
    session.push(&dirty, &mut items);
    session.finish(&mut items);
    assert!(session.counts().garbage > 5);
    let (errors, _) = frame_errors(&lab, &items, 120.0);
    assert!(median_and_max(&errors).1 <= 200.0);
    let (kept, all) = (samples(&items).count(), samples(&clean).count());
    assert!(kept < all && kept as f64 > 0.6 * all as f64, "{kept} of {all}");
}
