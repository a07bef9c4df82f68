//! Recordings that are cut, and disks that are full.

use std::io::{self, Write};
use std::sync::{Arc, Mutex};

use shisei_hub::read;
use shisei_hub::{Item, Sample, Session, Take};
use shisei_record::mcap_records::Loss;
use shisei_record::{Input, Options, Problem, open};
use shisei_twin::lab::{Lab, Settings};

/// A disk with so much room.
#[derive(Clone, Default)]
struct Disk {
    bytes: Arc<Mutex<Vec<u8>>>,
    room: Option<usize>,
}

impl Write for Disk {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let mut all = self.bytes.lock().unwrap();
        let count = self.room.map_or(bytes.len(), |room| room.saturating_sub(all.len()).min(bytes.len()));
        if count == 0 && !bytes.is_empty() {
            return Err(io::Error::from(io::ErrorKind::StorageFull));
        }
        all.extend_from_slice(&bytes[..count]);
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

const START_NS: u64 = 1_700_000_000_000_000_000;

/// Six seconds of two nodes; what was given before each flush. Ends at the first error.
fn record(disk: Disk) -> (Vec<u8>, Vec<(usize, usize)>, io::Result<()>) {
    let mut lab = Lab::new(Settings { movement_s: 10.0, ..Settings::default() });
    let mut session = Session::default();
    let (mut given, mut flushed) = (Vec::new(), Vec::new());
    let bytes = Arc::clone(&disk.bytes);
    let work = || -> io::Result<()> {
        let mut take = Take::new(disk, "port")?;
        for step in 1..=600 {
            lab.run_to(f64::from(step) * 0.01);
            let (mut new, mut items) = (Vec::new(), Vec::new());
            lab.serial(&mut new);
            let now_ns = START_NS + step as u64 * 10_000_000;
            take.raw(&new, now_ns)?;
            given.extend_from_slice(&new);
            session.push(&new, &mut items);
            for item in &items {
                take.item(item, session.time_s(), now_ns)?;
            }
            if step % 40 == 0 {
                take.flush()?;
                flushed.push((bytes.lock().unwrap().len(), given.len()));
            }
        }
        take.finish()
    };
    let outcome = work();
    (given, flushed, outcome)
}

fn raw_of(file: &[u8]) -> io::Result<Vec<u8>> {
    let mut raw = Vec::new();
    read::raw(file, |port, time_ns, bytes| {
        assert_eq!(port, "port");
        assert!((START_NS..START_NS + 7_000_000_000).contains(&time_ns));
        raw.extend_from_slice(bytes);
    })?;
    Ok(raw)
}

#[test]
fn a_recording_comes_back_and_decodes_anew() {
    let disk = Disk::default();
    let (given, _, outcome) = record(disk.clone());
    outcome.unwrap();
    let file = disk.bytes.lock().unwrap().clone();
    assert_eq!(raw_of(&file).unwrap(), given);
    // The format's own reader sees the decoded samples as well.
    let (mut imu, mut columns, mut tagged) = (0, 0, 0);
    for message in mcap::MessageStream::new(&file).unwrap() {
        let message = message.unwrap();
        if message.channel.topic.starts_with("/imu/") {
            assert_eq!(message.channel.schema.as_ref().unwrap().name, "sensor_msgs/msg/Imu");
            // Encapsulation; time and string, padded to eights; 37 numbers.
            assert_eq!(message.data.len(), 4 + 24 + 37 * 8);
            imu += 1;
        } else if message.channel.topic.starts_with("/sample/") {
            let value: serde_json::Value = serde_json::from_slice(&message.data).unwrap();
            tagged += u32::from(value["frame"].is_number());
            columns += 1;
        }
    }
    assert!(imu > 1100 && imu == columns && tagged > 1100, "{imu} {columns} {tagged}");
}

#[test]
fn a_cut_recording_keeps_what_was_flushed() {
    let disk = Disk::default();
    let (given, flushed, outcome) = record(disk.clone());
    outcome.unwrap();
    let file = disk.bytes.lock().unwrap().clone();
    for k in 0..300 {
        let cut = (k * 7919 + 13) % file.len();
        let Ok(raw) = raw_of(&file[..cut]) else {
            assert!(cut < 64, "only a file without a beginning is none: {cut}");
            continue;
        };
        let kept =
            flushed.iter().filter(|(size, _)| *size <= cut).map(|(_, given)| *given).max().unwrap_or(0);
        assert!(raw.len() >= kept, "cut at {cut}: {} of {kept}", raw.len());
        assert_eq!(raw, given[..raw.len()]);
    }
}

#[test]
fn a_full_disk_is_said_and_loses_nothing_earlier() {
    let disk = Disk { room: Some(300_000), ..Disk::default() };
    let (given, flushed, outcome) = record(disk.clone());
    assert_eq!(outcome.unwrap_err().kind(), io::ErrorKind::StorageFull);
    let file = disk.bytes.lock().unwrap().clone();
    let raw = raw_of(&file).unwrap();
    let kept = flushed.last().unwrap().1;
    assert!(kept > 10_000 && raw.len() >= kept);
    assert_eq!(raw, given[..raw.len()]);
}

#[test]
fn what_is_no_recording_is_an_error() {
    assert!(read::raw(b"time_s,acc_x\n0,1\n", |_, _, _| {}).is_err());
    assert!(read::raw(b"", |_, _, _| {}).is_err());
}

#[test]
fn what_is_lost_is_told() {
    let disk = Disk::default();
    record(disk.clone()).2.unwrap();
    let file = disk.bytes.lock().unwrap().clone();
    let loss = |bytes: &[u8]| read::raw(bytes, |_, _, _| {}).unwrap();
    assert_eq!(loss(&file), Loss::default());
    assert_eq!(loss(&file[..file.len() / 2]), Loss { parts: 0, cut: true });
    let mut damaged = file.clone();
    damaged[file.len() / 2] ^= 0x40;
    assert_eq!(loss(&damaged), Loss { parts: 1, cut: false });
}

/// One chunk of several is damaged: the others are read, and of the samples each keeps its own time.
#[test]
fn a_flipped_bit_costs_its_own_chunk_only() {
    let disk = Disk::default();
    let (given, _, outcome) = record(disk.clone());
    outcome.unwrap();
    let whole = disk.bytes.lock().unwrap().clone();
    let options = Options { sensor: Some("1".into()), keep: vec!["seq".into()], ..Options::default() };
    let samples = |bytes: &[u8]| {
        let recording = open(&[Input { name: "take.mcap", bytes }], &options).unwrap();
        let seq = recording.extra[0].cells.clone();
        let rows = seq.into_iter().zip(recording.time_s).zip(recording.gyro_rad_s);
        let rows: Vec<_> = rows.map(|((seq, time_s), rate)| (seq, time_s, rate)).collect();
        (rows, recording.warnings.iter().any(|note| note.code == "mcap-damaged"))
    };
    let (expected, warned) = samples(&whole);
    assert!(!warned);
    let mut least = usize::MAX;
    for place in (whole.len() / 10..whole.len() * 9 / 10).step_by(whole.len() / 23) {
        let mut damaged = whole.clone();
        damaged[place] ^= 0x10;
        let (left, warned) = samples(&damaged);
        // Time 0 is the first that is left.
        let first = expected.iter().find(|row| row.0 == left[0].0).unwrap().1;
        let mut all = expected.iter();
        for row in &left {
            let same =
                |e: &&(_, f64, _)| (&e.0, e.2) == (&row.0, row.2) && (e.1 - first - row.1).abs() < 1e-9;
            assert!(all.find(same).is_some(), "{row:?} after damage at {place}");
        }
        assert!(warned || left.len() == expected.len(), "{place}");
        least = least.min(left.len());
        let raw = raw_of(&damaged).unwrap();
        assert!(raw.len() * 10 > given.len() * 5, "{place}: {} of {} bytes", raw.len(), given.len());
    }
    assert!(least * 10 > expected.len() * 5 && least < expected.len(), "{least} of {}", expected.len());
}

/// What `shisei orient take.mcap` and `shisei fuse` read: the session's samples, and their frames as a column.
#[test]
fn the_importer_reads_our_recordings_whole_and_cut() {
    let disk = Disk::default();
    let (given, _, outcome) = record(disk.clone());
    outcome.unwrap();
    let (mut session, mut items) = (Session::default(), Vec::new());
    session.push(&given, &mut items);
    let told: Vec<Sample> = items
        .iter()
        .filter_map(|item| if let Item::Sample(sample) = item { Some(*sample) } else { None })
        .filter(|sample| sample.node == 1 && sample.time_s.is_some())
        .collect();
    let whole = disk.bytes.lock().unwrap().clone();
    let options = |sensor: Option<&str>| Options {
        sensor: sensor.map(str::to_owned),
        keep: vec!["*".into()],
        ..Options::default()
    };
    let read = |bytes: &[u8], sensor| open(&[Input { name: "take.mcap", bytes }], &options(sensor));
    match read(&whole, None) {
        Err(error) => {
            assert!(matches!(error.problem, Problem::ManySensors { ref names } if names.len() == 2));
        }
        Ok(_) => panic!("two nodes, and none was asked for"),
    }
    for sensor in ["1", "node 1", "node1"] {
        let recording = read(&whole, Some(sensor)).unwrap();
        assert_eq!(recording.len(), told.len());
        let frames = recording.extra.iter().find(|extra| extra.name == "frame").unwrap();
        let start_s = told[0].time_s.unwrap();
        for (k, sample) in told.iter().enumerate() {
            assert_eq!(recording.gyro_rad_s[k], sample.gyro_rad_s);
            assert_eq!(recording.acc_m_s2[k], sample.acc_m_s2);
            assert!((recording.time_s[k] - (sample.time_s.unwrap() - start_s)).abs() < 1e-9);
            let frame: Option<f64> = frames.cells[k].parse().ok();
            let close = frame.zip(sample.frame).is_some_and(|(read, told)| (read - told).abs() < 1e-9);
            assert!(close || frame == sample.frame);
        }
        assert!(recording.warnings.iter().all(|note| note.code != "mcap-cut"));
    }
    // Cut anywhere: what was flushed is there, and it is said.
    let cut = read(&whole[..whole.len() * 2 / 3], Some("1")).unwrap();
    assert!(cut.len() > told.len() / 2 && cut.len() < told.len());
    assert!(cut.warnings.iter().any(|note| note.code == "mcap-cut"));
}

/// A receiver that starts anew counts its time anew: the time of day of what it sends does not follow.
#[test]
fn stamps_stay_with_the_time_of_day_when_the_receiver_starts_anew() {
    let disk = Disk::default();
    let mut take = Take::new(disk.clone(), "port").unwrap();
    let (mut session, mut items) = (Session::default(), Vec::new());
    let mut now_ns = START_NS;
    for seed in [1, 2] {
        let mut lab = Lab::new(Settings { seed, movement_s: 10.0, ..Settings::default() });
        for step in 1..=800 {
            lab.run_to(f64::from(step) * 0.01);
            now_ns += 10_000_000;
            let mut new = Vec::new();
            lab.serial(&mut new);
            session.push(&new, &mut items);
            for item in items.drain(..) {
                take.item(&item, session.time_s(), now_ns).unwrap();
            }
        }
    }
    take.finish().unwrap();
    let file = disk.bytes.lock().unwrap().clone();
    let mut count = 0;
    for message in mcap::MessageStream::new(&file).unwrap() {
        let message = message.unwrap();
        if message.channel.topic.starts_with("/imu/") && message.publish_time != message.log_time {
            let late_s = (message.log_time as f64 - message.publish_time as f64) * 1e-9;
            assert!((-0.02..0.5).contains(&late_s), "{late_s} s");
            count += 1;
        }
    }
    assert!(count > 2500, "{count}");
}
