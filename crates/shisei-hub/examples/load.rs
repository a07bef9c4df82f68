//! The hub under load, in real time: 20 nodes at 120 Hz on bodies that cameras film at 240 Hz, then 100 nodes at
//! 240 Hz. The first is recorded meanwhile, with the estimates that come later. Prints latencies and losses; ends with 1 where they are worse than promised. `cargo xtask bench live`
//! runs it.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use shisei_core::Quaternion;
use shisei_core::frames::{Axes, Pose};
use shisei_hub::live::{Hub, Input, Kind, Line, Parts, Refused, Settings, What, run};
use shisei_hub::natnet::{self, write};
use shisei_hub::server::Access;
use shisei_twin::lab::{self, Lab};
use shisei_twin::stage::{self, Carrier, Stage};

const LENGTH_S: f64 = 26.0;
const LOOK_S: f64 = 0.002;
const CLOCK_HZ: u64 = 10_000_000;

/// What comes when, prepared, so that only the hub works while it is played.
struct Prepared {
    events: Vec<(f64, Arc<str>, What)>,
    speed: f64,
}

impl Input for Prepared {
    fn name(&self) -> String {
        "load".into()
    }

    fn kind(&self) -> Kind {
        Kind::Demo
    }

    fn run(self: Box<Self>, line: &Line) {
        let started = Instant::now();
        for (time_s, port, what) in self.events {
            let left_s = time_s / self.speed - started.elapsed().as_secs_f64();
            if left_s > 0.0 {
                std::thread::sleep(Duration::from_secs_f64(left_s));
            }
            if !line.give(&port, what) {
                return;
            }
        }
        line.give(&Arc::from("load"), What::End);
    }
}

fn labs(count: usize, nodes: usize, camera_hz: f64) -> Vec<Lab> {
    (0..count)
        .map(|k| {
            let settings = lab::Settings {
                nodes,
                seed: k as u64 + 1,
                camera_hz,
                movement_s: 20.0,
                ..Default::default()
            };
            Lab::new(settings)
        })
        .collect()
}

/// Receivers' bytes as they would come, and the true number of samples a second is known.
fn prepare(labs: &mut [Lab], stages: &mut [Stage], length_s: f64) -> Vec<(f64, Arc<str>, What)> {
    let ports: Vec<Arc<str>> = (0..labs.len()).map(|k| Arc::from(format!("receiver{k}"))).collect();
    let motive: Arc<str> = Arc::from("motive");
    let mut events = Vec::new();
    if !stages.is_empty() {
        events.push((0.0, Arc::clone(&motive), What::NatNet(write::server_info(&server()))));
        events.push((0.0, Arc::clone(&motive), What::NatNet(model(stages))));
    }
    let mut time_s = 0.0;
    while time_s < length_s {
        time_s += LOOK_S;
        for (lab, port) in labs.iter_mut().zip(&ports) {
            lab.run_to(time_s);
            let mut bytes = Vec::new();
            lab.serial(&mut bytes);
            if !bytes.is_empty() {
                events.push((time_s, Arc::clone(port), What::Serial(bytes)));
            }
        }
        loop {
            let seen: Vec<stage::Frame> = stages
                .iter_mut()
                .zip(&*labs)
                .filter_map(|(stage, lab)| stage.frame(lab, time_s - 0.004))
                .collect();
            let Some(first) = seen.first() else { break };
            let packet = frame(first, seen.iter().flat_map(|frame| frame.bodies.iter().copied()));
            events.push((time_s, Arc::clone(&motive), What::NatNet(packet)));
        }
    }
    events
}

fn server() -> natnet::ServerInfo {
    natnet::ServerInfo {
        name: "load".into(),
        app_version: [3, 1, 0, 0],
        natnet_version: [4, 1, 0, 0],
        clock_hz: CLOCK_HZ,
        data_port: natnet::DATA_PORT,
        multicast: false,
        group: natnet::GROUP,
    }
}

fn model(stages: &[Stage]) -> Vec<u8> {
    let carriers = stages.iter().flat_map(Stage::carriers).zip(1..);
    let bodies = carriers.map(|(carrier, id)| natnet::BodyDescription {
        name: carrier.name.clone(),
        id,
        parent: -1,
        ..natnet::BodyDescription::default()
    });
    let model = natnet::Model { bodies: bodies.collect(), skeletons: Vec::new() };
    write::model(&model, natnet::Version::V4_1)
}

fn frame(first: &stage::Frame, bodies: impl Iterator<Item = Option<Pose>>) -> Vec<u8> {
    let bodies = bodies.zip(1..).map(|(pose, id)| {
        let pose = pose.and_then(|pose| Axes::ZUp.to(Axes::YUp).world_of_pose(pose).ok());
        let (p, q) = pose.map_or(([0.0; 3], Quaternion::IDENTITY), |p| (p.position_m, p.world_from_body));
        natnet::Body {
            id,
            position_m: p.map(|x| x as f32),
            quaternion_xyzw: [q.x, q.y, q.z, q.w].map(|x| x as f32),
            error_m: 0.0,
            params: i16::from(pose.is_some()),
        }
    });
    let frame = natnet::Frame {
        number: first.number as i32,
        bodies: bodies.collect(),
        mid_exposure: ((100.0 + first.time_s) * CLOCK_HZ as f64) as u64,
        ..natnet::Frame::default()
    };
    write::frame(&frame, natnet::Version::V4_1)
}

fn play(events: Vec<(f64, Arc<str>, What)>, speed: f64, recording: Option<&Path>) -> std::io::Result<Hub> {
    let parts = Parts {
        inputs: vec![Box::new(Prepared { events, speed })],
        outputs: Vec::new(),
        access: Access::loopback(0),
        known: BTreeMap::new(),
    };
    let mut settings = Settings { record_now: recording.is_some(), ..Settings::default() };
    settings.record = recording.map_or(settings.record, Path::to_owned);
    run(settings, parts, &Arc::new(AtomicBool::new(false)), &mut ()).map_err(|refused| match refused {
        Refused::Address(error) | Refused::Recording(error) => error,
    })
}

fn main() -> std::io::Result<ExitCode> {
    let mut good = true;

    let mut twenty = labs(4, 5, 240.0);
    let mut stages: Vec<Stage> = (0..twenty.len())
        .map(|k| {
            let carriers = (0..5).map(|node| Carrier {
                name: format!("body {k}.{node}"),
                node,
                body_from_sensor: Quaternion::from_rotation_vector([0.3, node as f64, -0.5 * k as f64]),
                sensor_m: [0.02, 0.0, 0.01],
                place_m: [k as f64, node as f64, 1.0],
                markers_m: Vec::new(),
            });
            let settings = stage::Settings { rate_hz: 240.0, seed: k as u64 + 1, ..Default::default() };
            Stage::new(settings, carriers.collect())
        })
        .collect();
    let events = prepare(&mut twenty, &mut stages, LENGTH_S);
    let take = std::env::temp_dir().join(format!("shisei-load-{}.mcap", std::process::id()));
    let hub = play(events, 1.0, Some(&take))?;
    let recorded = std::fs::metadata(&take)?.len();
    std::fs::remove_file(&take)?;
    let (median, p99) = hub.latency().ms().unwrap_or((f64::INFINITY, f64::INFINITY));
    let on_bodies = hub.scene().objects().filter(|object| object.node.is_some()).count();
    let (lost, samples) = hub.losses();
    println!(
        "20 nodes x 120 Hz, cameras 240 Hz: {samples} samples, {lost} lost, {on_bodies} nodes on bodies, {} MB recorded",
        recorded / 1_000_000
    );
    println!("sample in to pose out: median {median:.3} ms, 99 % {p99:.3} ms (promised 2 and 10)");
    good &= median <= 2.0 && p99 <= 10.0 && lost == 0 && on_bodies == 20;

    // twice as fast as it happened: 120 Hz become 240
    let mut hundred = labs(20, 5, 120.0);
    let length_s = 20.0;
    let events = prepare(&mut hundred, &mut [], length_s);
    let started = Instant::now();
    let hub = play(events, 2.0, None)?;
    let took_s = started.elapsed().as_secs_f64();
    let (lost, samples) = hub.losses();
    let (median, p99) = hub.latency().ms().unwrap_or((f64::INFINITY, f64::INFINITY));
    println!(
        "100 nodes x 240 Hz for {took_s:.1} s: {samples} samples, {lost} lost; median {median:.3} ms, 99 % {p99:.3} ms"
    );
    good &= lost == 0 && samples as f64 > 100.0 * 120.0 * (length_s - 3.0) && took_s < 1.1 * length_s / 2.0;
    Ok(if good { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}
