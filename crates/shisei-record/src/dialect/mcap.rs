//! MCAP: our own recordings, and others with `sensor_msgs/msg/Imu` in ROS 2's encoding (uncompressed chunks).
//!
//! `shisei record` writes each sample twice: `/imu/N` has the values, `/sample/N` the same sample's time by the
//! receiver's clock, boot id, sequence number and frame index, as JSON. They are read in pairs. Another program's file
//! has the message's own stamp. A file that was cut is read up to its last whole chunk, a damaged one without the chunks
//! that are.

use std::collections::{BTreeMap, HashMap};
use std::ops::ControlFlow;

use mcap::records::Record;
use shisei_core::Vec3;

use super::WholeFile;
use crate::body::{Body, TimeForm, Wanted};
use crate::error::{Error, Problem, Result, shorten};
use crate::mcap_records::{self, Loss};
use crate::names::Grade;
use crate::open::{Clock, Part, finish_time};
use crate::options::Options;
use crate::plan::Triple;
use crate::recording::{Channel, Note};
use crate::units::{M_S2, RAD_S, SECOND};

/// The schema of the samples' values.
const IMU: &str = "sensor_msgs/msg/Imu";
/// Columns beside the values that our own recordings have.
const KEPT: [&str; 5] = ["node", "boot", "seq", "frame", "from_gate"];
/// Topics of one file; more are refused.
const TOPICS_MAX: usize = 10_000;

/// The dialect.
pub const DIALECT: WholeFile = WholeFile {
    id: "mcap",
    name: "MCAP recording",
    layout: "MCAP, sensor_msgs/msg/Imu",
    layout_ja: "MCAP、sensor_msgs/msg/Imu",
    recognises: |bytes| bytes.starts_with(b"\x89MCAP0\r\n"),
    read,
};

/// The values of one message.
#[derive(Clone, Copy, Debug)]
struct Values {
    stamp_s: f64,
    gyro_rad_s: Vec3,
    acc_m_s2: Vec3,
}

/// What the JSON beside it says.
#[derive(Clone, Debug, Default)]
struct Beside {
    time_s: Option<f64>,
    temp_c: Option<f64>,
    kept: [Box<str>; KEPT.len()],
}

/// One sensor's messages.
#[derive(Debug, Default)]
struct Sensor {
    name: String,
    samples: Vec<Sample>,
}

/// A sample's messages.
#[derive(Debug)]
struct Sample {
    /// What both messages say of when they were given.
    publish_ns: u64,
    /// None where the message could not be read.
    values: Option<Values>,
    beside: Option<Beside>,
}

/// What a channel brings.
#[derive(Clone, Debug)]
enum Brings {
    Values(String),
    Beside(String),
    Events,
}

/// A file's sensors by topic, and what of it could not be read.
#[derive(Debug, Default)]
struct File {
    sensors: BTreeMap<String, Sensor>,
    loss: Loss,
}

fn damaged(name: &str, detail: &str) -> Error {
    Error::of_file(name, Problem::Damaged { format: "MCAP", detail: shorten(detail) })
}

fn parse(name: &str, bytes: &[u8]) -> Result<File> {
    let (mut file, mut channels, mut schemas) = (File::default(), HashMap::new(), HashMap::new());
    let mut taken = Ok(());
    let loss = mcap_records::records(bytes, |record| {
        taken = take(name, record, &mut file, &mut channels, &mut schemas);
        if taken.is_ok() { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    });
    taken?;
    file.loss = loss.map_err(|error| damaged(name, &error.to_string()))?;
    Ok(file)
}

fn take(
    name: &str,
    record: Record<'_>,
    file: &mut File,
    channels: &mut HashMap<u16, Brings>,
    schemas: &mut HashMap<u16, String>,
) -> Result<()> {
    if channels.len() > TOPICS_MAX || schemas.len() > TOPICS_MAX {
        return Err(damaged(name, "more than 10000 topics"));
    }
    match record {
        Record::Schema { header, .. } => {
            schemas.insert(header.id, header.name);
        }
        Record::Channel(channel) => {
            let topic = channel.topic;
            let brings = if let Some(node) = topic.strip_prefix("/sample/") {
                Brings::Beside(format!("/imu/{node}"))
            } else if topic == "/event" {
                Brings::Events
            } else if schemas.get(&channel.schema_id).is_some_and(|schema| schema == IMU)
                && channel.message_encoding == "cdr"
            {
                let node = topic.strip_prefix("/imu/").map(|node| format!("node {node}"));
                let sensor = file.sensors.entry(topic.clone()).or_default();
                // A node may have told its name before, and channels are repeated at a file's end.
                if sensor.name.is_empty() {
                    sensor.name = node.unwrap_or_else(|| topic.trim_start_matches('/').to_owned());
                }
                Brings::Values(topic)
            } else {
                return Ok(());
            };
            channels.insert(channel.id, brings);
        }
        Record::Message { header, data } => match channels.get(&header.channel_id) {
            Some(Brings::Values(topic)) => {
                if let Some(sensor) = file.sensors.get_mut(topic) {
                    let (publish_ns, values) = (header.publish_time, values(&data));
                    sensor.samples.push(Sample { publish_ns, values, beside: None });
                }
            }
            Some(Brings::Beside(topic)) => {
                // The other half of the newest sample; that one may have been in a damaged part.
                let newest = file.sensors.get_mut(topic).and_then(|sensor| sensor.samples.last_mut());
                if let Some(sample) = newest
                    && sample.beside.is_none()
                    && sample.publish_ns == header.publish_time
                {
                    sample.beside = Some(beside(&data));
                }
            }
            Some(Brings::Events) => named(&data, &mut file.sensors),
            None => {}
        },
        _ => {}
    }
    Ok(())
}

/// A node told its name.
fn named(json: &[u8], sensors: &mut BTreeMap<String, Sensor>) {
    let Ok(event) = serde_json::from_slice::<serde_json::Value>(json) else { return };
    if event["event"] != "Node" {
        return;
    }
    let (Some(node), Some(name)) = (event["node"].as_u64(), event["name"].as_str()) else { return };
    if !name.trim().is_empty() && node < TOPICS_MAX as u64 {
        // It may be told before its first sample.
        name.trim().clone_into(&mut sensors.entry(format!("/imu/{node}")).or_default().name);
    }
}

fn beside(json: &[u8]) -> Beside {
    let Ok(sample) = serde_json::from_slice::<serde_json::Value>(json) else { return Beside::default() };
    let cell = |key: &str| match &sample[key] {
        serde_json::Value::Null => "".into(),
        other => other.to_string().into_boxed_str(),
    };
    Beside { time_s: sample["time_s"].as_f64(), temp_c: sample["temp_c"].as_f64(), kept: KEPT.map(cell) }
}

/// A message in XCDR1, little-endian; anything else is none.
fn values(data: &[u8]) -> Option<Values> {
    let (head, content) = data.split_first_chunk::<4>()?;
    if head[..2] != [0, 1] {
        return None;
    }
    let word = |at: usize| Some(u32::from_le_bytes(*content.get(at..)?.first_chunk()?));
    let (seconds, nanoseconds) = (word(0)? as i32, word(4)?);
    let text = word(8)? as usize;
    let numbers = text.checked_add(12)?.checked_next_multiple_of(8)?;
    let number = |k: usize| -> Option<f64> {
        let bytes = content.get(numbers.checked_add(8 * k)?..)?;
        Some(f64::from_le_bytes(*bytes.first_chunk()?)).filter(|value| value.is_finite())
    };
    let three = |first: usize| Some([number(first)?, number(first + 1)?, number(first + 2)?]);
    // Orientation 4 and its covariance 9, rate 3 and its covariance 9, acceleration 3.
    Some(Values {
        stamp_s: f64::from(seconds) + f64::from(nanoseconds) * 1e-9,
        gyro_rad_s: three(13)?,
        acc_m_s2: three(25)?,
    })
}

/// The sensor that was asked for, or the only one.
fn choose(name: &str, file: File, asked: Option<&str>) -> Result<Sensor> {
    let mut sensors: Vec<(String, Sensor)> =
        file.sensors.into_iter().filter(|(_, sensor)| !sensor.samples.is_empty()).collect();
    let names: Vec<String> = sensors.iter().map(|(_, sensor)| sensor.name.clone()).collect();
    if names.is_empty() {
        return Err(Error::of_file(name, Problem::NoSamples));
    }
    let Some(asked) = asked else {
        return match (sensors.pop(), sensors.is_empty()) {
            (Some((_, only)), true) => Ok(only),
            _ => Err(Error::of_file(name, Problem::ManySensors { names })),
        };
    };
    let wanted = asked.trim().to_lowercase();
    let plain = |text: &str| text.to_lowercase().replace([' ', '_', '-', '/'], "");
    let exactly = |(_, sensor): &(String, Sensor)| sensor.name.to_lowercase() == wanted;
    let by_topic = |(topic, _): &(String, Sensor)| {
        topic.trim_start_matches("/imu/") == wanted || plain(topic) == plain(&wanted).replace("node", "imu")
    };
    let in_part = |(_, sensor): &(String, Sensor)| plain(&sensor.name).contains(&plain(&wanted));
    let mut in_part = sensors.iter().enumerate().filter(|(_, sensor)| in_part(sensor)).map(|(k, _)| k);
    let found = sensors.iter().position(exactly).or_else(|| sensors.iter().position(by_topic));
    let (first, second) = (in_part.next(), in_part.next());
    if found.is_none() && second.is_some() {
        return Err(Error::of_file(name, Problem::ManySensors { names }));
    }
    if let Some(found) = found.or(first) {
        return Ok(sensors.swap_remove(found).1);
    }
    Err(Error::of_file(name, Problem::NoSuchSensor { asked: asked.to_owned(), names }))
}

fn read(name: &str, bytes: &[u8], options: &Options) -> Result<Part> {
    let file = parse(name, bytes)?;
    let loss = file.loss;
    let sensor = choose(name, file, options.sensor.as_deref())?;
    let ours = sensor.samples.iter().any(|sample| sample.beside.is_some());
    let all_kept = options.keep.iter().any(|asked| asked == "*");
    let kept: Vec<usize> = (0..KEPT.len())
        .filter(|&k| {
            ours && (all_kept || options.keep.iter().any(|asked| asked.eq_ignore_ascii_case(KEPT[k])))
        })
        .collect();
    if let Some(asked) = options
        .keep
        .iter()
        .find(|asked| *asked != "*" && !(ours && KEPT.iter().any(|known| asked.eq_ignore_ascii_case(known))))
    {
        let columns = if ours { KEPT.map(str::to_owned).to_vec() } else { Vec::new() };
        return Err(Error::of_file(name, Problem::NoSuchColumn { asked: asked.clone(), columns }));
    }
    let mut body = Body { keep: vec![Vec::new(); kept.len()], ..Body::default() };
    let (mut without_time, none) = (0, Beside::default());
    for sample in &sensor.samples {
        let Some(values) = &sample.values else {
            body.skipped += 1;
            continue;
        };
        // A cut or damaged file may lack a sample's other half.
        let beside = sample.beside.as_ref().unwrap_or(&none);
        let Some(time_s) = (if ours { beside.time_s } else { Some(values.stamp_s) }) else {
            without_time += 1;
            continue;
        };
        body.time.push(time_s);
        body.acc.push(values.acc_m_s2);
        body.gyro.push(values.gyro_rad_s);
        if ours {
            body.temp.push(beside.temp_c.unwrap_or(f64::NAN));
        }
        for (column, &which) in body.keep.iter_mut().zip(&kept) {
            column.push(beside.kept[which].clone());
        }
        body.rows += 1;
    }
    if body.rows < 2 {
        return Err(Error::of_file(name, Problem::TooFewRows { rows: body.rows }));
    }
    let mut part = Part {
        name: name.to_owned(),
        dialect: DIALECT.id,
        acc: Some(triple(4, M_S2)),
        gyro: Some(triple(1, RAD_S)),
        channels: channels(name, ours),
        keep_names: kept.iter().map(|&k| KEPT[k].to_owned()).collect(),
        ..Part::default()
    };
    notes(&mut part, &sensor.name, loss, without_time);
    if ours {
        // The receiver's clock counts from its start.
        let first_s = body.time.first().copied().unwrap_or(0.0);
        body.time.iter_mut().for_each(|time_s| *time_s -= first_s);
    }
    part.body = body;
    if options.rate_hz.is_some() {
        part.body.time.clear();
    }
    let clock = Clock { unit: Some(SECOND), ..Clock::default() };
    finish_time(&mut part, clock, &Wanted { time_form: TimeForm::Number, ..Wanted::default() }, options)?;
    Ok(part)
}

fn notes(part: &mut Part, sensor: &str, loss: Loss, without_time: usize) {
    part.assumptions.push(Note::new(
        "mcap",
        format!("the sensor is {sensor}; rates are rad/s before bias removal, accelerations m/s²"),
        format!("センサは {sensor} です。ジャイロはバイアス補正前の rad/s、加速度は m/s² として読みます"),
    ));
    if loss.parts > 0 {
        let parts = loss.parts;
        part.warnings.push(Note::new(
            "mcap-damaged",
            format!("damaged parts of the recording are left out: {parts}; their samples are missing"),
            format!("記録に破損した部分が {parts} か所あります。その部分のサンプルを除いて読みます"),
        ));
    }
    if loss.cut {
        part.warnings.push(Note::new(
            "mcap-cut",
            "the recording was cut: it is read up to its last whole part".into(),
            "記録が途中で切れています。最後の完全な部分までを読みます".into(),
        ));
    }
    if without_time > 0 {
        part.warnings.push(Note::new(
            "mcap-without-time",
            format!(
                "{without_time} samples from before the clocks were paired have no time and are left out"
            ),
            format!("時計の対応が得られる前の {without_time} サンプルは時刻がないため除きます"),
        ));
    }
}

fn triple(first: usize, unit: crate::units::Unit) -> Triple {
    let columns = [first, first + 1, first + 2];
    Triple { columns, unit: Some(unit), label: String::new(), grade: Grade::Plain }
}

fn channels(file: &str, ours: bool) -> Vec<Channel> {
    let values = [
        ("time_s", "s", "time_s"),
        ("angular_velocity.x", "rad/s", "gyr_x"),
        ("angular_velocity.y", "rad/s", "gyr_y"),
        ("angular_velocity.z", "rad/s", "gyr_z"),
        ("linear_acceleration.x", "m/s²", "acc_x"),
        ("linear_acceleration.y", "m/s²", "acc_y"),
        ("linear_acceleration.z", "m/s²", "acc_z"),
    ];
    let beside = std::iter::once(("temp_c", "°C", "temp_c")).chain(KEPT.map(|name| (name, "", "")));
    let all = values.into_iter().chain(beside.filter(|_| ours));
    all.enumerate()
        .map(|(k, (name, unit, role))| Channel {
            number: k + 1,
            file: file.to_owned(),
            name: name.to_owned(),
            unit: unit.to_owned(),
            role: role.to_owned(),
            used: !role.is_empty(),
        })
        .collect()
}
