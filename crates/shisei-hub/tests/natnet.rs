//! Our NatNet against independent ones: the crate `natnet` writes, we read; we write, it reads; over sockets ours
//! with ours.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::sync_channel;
use std::time::{Duration, Instant};

use ::natnet as peer;
use shisei_core::Quaternion;
use shisei_core::frames::{Axes, Pose};
use shisei_core::fuse::Source;
use shisei_hub::live::input::ToHub;
use shisei_hub::live::optics::{BodyInfo, BodyKey};
use shisei_hub::live::scene::{Key, Scene, Shown};
use shisei_hub::live::{Input, Line, Output, What};
use shisei_hub::natnet::{self, Client, NatNetOut, Stream, Told, id, read, write};

const PATIENCE: Duration = Duration::from_secs(60);
const VERSIONS: [(u8, u8); 4] = [(3, 0), (3, 1), (4, 0), (4, 1)];

fn peer_frame(server: &peer::SyntheticServer, version: (u8, u8)) -> Vec<u8> {
    let bodies = [
        peer::PlannedBody::tracked(3, [1.0, 2.0, 3.0], [0.5, -0.5, 0.5, 0.5]),
        peer::PlannedBody::dropout(4),
    ];
    let bone = |id: i32| peer::RigidBody {
        id,
        position: [0.1, 0.2, 0.3],
        orientation: [0.0, 0.0, 0.0, 1.0],
        mean_marker_error: 0.001,
        params: 1,
    };
    let mut sections = peer::PlannedSections {
        skeletons: vec![peer::Skeleton { id: 7, rigid_bodies: vec![bone(7 << 16 | 1), bone(7 << 16 | 2)] }],
        force_plates: vec![peer::ForcePlate { id: 1, channels: vec![vec![1.0, 2.0], vec![]] }],
        devices: vec![peer::Device { id: 2, channels: vec![vec![0.5; 3]] }],
        ..peer::PlannedSections::default()
    };
    if version >= (4, 1) {
        sections.assets = vec![peer::Asset { id: 9, rigid_bodies: vec![bone(1)], markers: Vec::new() }];
    }
    let mut frame = server.frame_with_sections(1234, 12.5, &bodies, &sections).expect("a frame");
    frame.marker_sets =
        vec![peer::MarkerSet { name: "all".into(), markers: vec![[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]] }];
    frame.other_markers = vec![[7.0, 8.0, 9.0]];
    frame.labeled_markers = vec![peer::LabeledMarker {
        id: 50_001,
        position: [0.1, 0.0, -0.1],
        size: 0.014,
        params: 0x12,
        residual: 0.0002,
    }];
    frame.params = 2;
    frame.to_datagram(server.version).expect("a datagram")
}

fn info(version: (u8, u8)) -> natnet::ServerInfo {
    natnet::ServerInfo {
        name: "test".into(),
        app_version: [3, 1, 0, 0],
        natnet_version: [version.0, version.1, 0, 0],
        clock_hz: 10_000_000,
        data_port: 1511,
        multicast: false,
        group: natnet::GROUP,
    }
}

#[test]
fn what_the_peer_writes_is_read_in_every_version() {
    for version in VERSIONS {
        let server = peer::SyntheticServer::new(peer::Version::new(version.0, version.1, 0, 0), 10_000_000);
        let mut stream = Stream::default();
        let datagram = peer_frame(&server, version);
        assert_eq!(stream.push(&datagram), Ok(Told::Nothing), "before the server's word");
        stream.push(&write::server_info(&info(version))).expect("its word");
        let Ok(Told::Frame(frame)) = stream.push(&datagram) else { panic!("{version:?}: no frame") };
        assert_eq!(frame.number, 1234);
        assert_eq!(frame.bodies.len(), 2);
        assert_eq!((frame.bodies[0].id, frame.bodies[0].tracked()), (3, true));
        assert_eq!(frame.bodies[0].position_m, [1.0, 2.0, 3.0]);
        assert_eq!(frame.bodies[0].quaternion_xyzw, [0.5, -0.5, 0.5, 0.5]);
        assert!(!frame.bodies[1].tracked());
        assert_eq!(frame.skeletons[0].bones[1].id, 7 << 16 | 2);
        assert_eq!(frame.marker_sets[0].1[1], [4.0, 5.0, 6.0]);
        assert_eq!(frame.other_markers_m, [[7.0, 8.0, 9.0]]);
        assert_eq!((frame.markers[0].id, frame.markers[0].params), (50_001, 0x12));
        assert_eq!((frame.mid_exposure, frame.timestamp_s, frame.params), (125_000_000, 12.5, 2));
        // cut anywhere it is refused, and nothing worse
        for end in 0..datagram.len() {
            let _ = stream.push(&datagram[..end]);
        }
    }
}

fn model() -> natnet::Model {
    let body = |name: &str, id: i32, parent: i32| natnet::BodyDescription {
        name: name.into(),
        id,
        parent,
        offset_m: [0.0, 0.1, 0.0],
        markers_m: vec![[0.0, 0.0, 0.0], [0.1, 0.0, 0.0]],
    };
    natnet::Model {
        bodies: vec![body("Tool 1", 3, -1), body("右手", 4, -1)],
        skeletons: vec![natnet::SkeletonDescription {
            name: "Alice".into(),
            id: 7,
            bones: vec![body("Hip", 1, 0), body("Ab", 2, 1)],
        }],
    }
}

#[test]
fn what_we_write_the_peer_reads_and_so_do_we() {
    let frame = natnet::Frame {
        number: 77,
        marker_sets: vec![("all".into(), vec![[1.0, 2.0, 3.0]])],
        bodies: vec![natnet::Body {
            id: 3,
            position_m: [1.0, 2.0, 3.0],
            quaternion_xyzw: [0.5, 0.5, -0.5, 0.5],
            error_m: 0.001,
            params: 1,
        }],
        skeletons: vec![natnet::Skeleton { id: 7, bones: Vec::new() }],
        mid_exposure: 42,
        ..natnet::Frame::default()
    };
    for version in VERSIONS {
        let theirs = peer::Version::new(version.0, version.1, 0, 0);
        let ours = natnet::Version { major: version.0, minor: version.1 };
        let bytes = write::frame(&frame, ours);
        let parsed = peer::FrameOfData::parse_with_policy(&bytes, theirs, peer::ParsePolicy::Strict)
            .expect("readable for the peer");
        assert_eq!(parsed.frame_number, 77);
        assert_eq!(parsed.rigid_bodies[0].orientation, [0.5, 0.5, -0.5, 0.5]);
        assert!(parsed.rigid_bodies[0].tracking_valid());
        assert_eq!(parsed.decode_skeletons().expect("skeletons")[0].id, 7);
        let (_, payload) = read::packet(&bytes).expect("a packet");
        assert_eq!(read::frame(payload, ours).expect("ours"), frame);

        let bytes = write::model(&model(), ours);
        let parsed = peer::ModelDef::parse_with_policy(&bytes, theirs, peer::ParsePolicy::Strict)
            .expect("readable for the peer");
        let names: Vec<(&str, i32)> = parsed.rigid_bodies().collect();
        assert_eq!(names, [("Tool 1", 3), ("右手", 4)]);
        // and what the peer writes of it we read
        let again = parsed.to_datagram(theirs).expect("a datagram");
        let (_, payload) = read::packet(&again).expect("a packet");
        assert_eq!(read::model(payload, ours).expect("ours"), model());

        let bytes = write::server_info(&info(version));
        let parsed = peer::ServerInfo::parse(&bytes).expect("readable for the peer");
        assert_eq!(parsed.protocol_version, theirs);
        assert_eq!(parsed.high_res_clock_frequency, 10_000_000);
    }
}

fn scene() -> Scene {
    let mut scene = Scene::default();
    let info = |key, name: &str, skeleton: Option<&str>, parent| BodyInfo {
        key,
        name: name.into(),
        skeleton: skeleton.map(str::to_owned),
        parent,
        markers_m: vec![[0.0; 3]],
    };
    let hip = BodyKey::Bone(7, 1);
    scene.describe(&[
        info(BodyKey::Rigid(3), "Tool 1", None, None),
        info(BodyKey::Rigid(4), "Hidden", None, None),
        info(hip, "Hip", Some("Alice"), None),
        info(BodyKey::Bone(7, 2), "Ab", Some("Alice"), Some(hip)),
    ]);
    let shown = |source, position_m| Shown {
        pose: Pose { position_m, world_from_body: Quaternion::new(0.5, 0.5, -0.5, 0.5) },
        placed: true,
        source,
        gap_s: 0.0,
        sigma_rad: 0.001,
        sigma_m: 0.002,
        time_s: 0.0,
        at: Instant::now(),
    };
    let mut set = |key, shown| scene.get_mut(Key::Body(key)).expect("there").shown = Some(shown);
    set(BodyKey::Rigid(3), shown(Source::Bridged, [1.0, 2.0, 3.0]));
    set(BodyKey::Rigid(4), shown(Source::None, [1.0, 2.0, 3.0]));
    set(hip, shown(Source::Optical, [0.0, 0.0, 1.0]));
    set(BodyKey::Bone(7, 2), shown(Source::Optical, [0.0, 0.0, 1.2]));
    scene
}

/// Our client follows our server: descriptions, frames, loss and return.
#[test]
fn client_and_server_over_sockets() {
    let scene = scene();
    let mut server = NatNetOut::new([127, 0, 0, 1].into(), 0, 0, Axes::YUp).expect("free ports");
    server.scene(&scene);
    let address = server.address();
    let (to_hub, arrivals) = sync_channel(4096);
    let stop = Arc::new(AtomicBool::new(false));
    let line = Line::new(0, to_hub, Arc::clone(&stop));
    let client = Box::new(Client::new(&address.to_string()));
    let thread = std::thread::spawn(move || client.run(&line));
    let mut stream = Stream::default();
    let (mut model, mut frames, mut number) = (None, Vec::new(), 100);
    let started = Instant::now();
    while (model.is_none() || frames.len() < 20) && started.elapsed() < PATIENCE {
        number += 1;
        server.poses(&scene, Some(number), number as f64 / 120.0);
        std::thread::sleep(Duration::from_millis(5));
        for message in arrivals.try_iter() {
            let ToHub::Arrival(arrival) = message else { continue };
            let What::NatNet(bytes) = arrival.what else { continue };
            match stream.push(&bytes) {
                Ok(Told::Model(told)) => model = Some(told),
                Ok(Told::Frame(frame)) => frames.push(frame),
                other => assert!(other.is_ok()),
            }
        }
    }
    assert_eq!(server.clients(), 1);
    let model = model.expect("descriptions");
    let names: Vec<&str> = model.bodies.iter().map(|body| body.name.as_str()).collect();
    assert_eq!(names, ["Tool 1", "Hidden"]);
    assert_eq!(model.skeletons[0].bones.len(), 2);
    let last = frames.last().expect("frames");
    assert!(last.bodies[0].tracked() && !last.bodies[1].tracked());
    // z up (1, 2, 3) is y up (1, 3, −2)
    assert_eq!(last.bodies[0].position_m, [1.0, 3.0, -2.0]);
    assert!(frames.windows(2).all(|two| two[1].number == two[0].number + 1));

    // the cameras stop: sensors go on, and numbers ascend also when a frame comes late after all
    let stopped = Instant::now();
    let mut numbers = Vec::new();
    while stopped.elapsed() < Duration::from_millis(400) {
        if stopped.elapsed() > Duration::from_millis(300) {
            number += 1;
        }
        server.poses(&scene, Some(number), number as f64 / 120.0);
        std::thread::sleep(Duration::from_millis(2));
        for message in arrivals.try_iter() {
            let ToHub::Arrival(arrival) = message else { continue };
            if let What::NatNet(bytes) = arrival.what
                && let Ok(Told::Frame(frame)) = stream.push(&bytes)
            {
                numbers.push(frame.number);
            }
        }
    }
    assert!(numbers.len() > 10 && numbers.windows(2).all(|two| two[1] == two[0] + 1), "{numbers:?}");

    // the server ends and another takes its place
    drop(server);
    let mut lost = false;
    let started = Instant::now();
    while !lost && started.elapsed() < PATIENCE {
        if let Ok(ToHub::Arrival(arrival)) = arrivals.recv_timeout(Duration::from_millis(100)) {
            lost = arrival.what == What::State(shisei_hub::live::State::Lost);
        }
    }
    assert!(lost);
    let address4 = [127, 0, 0, 1].into();
    let mut server = NatNetOut::new(address4, address.port(), 0, Axes::YUp).expect("the same port");
    server.scene(&scene);
    let (mut back, started) = (false, Instant::now());
    while !back && started.elapsed() < PATIENCE {
        number += 1;
        server.poses(&scene, Some(number), number as f64 / 120.0);
        std::thread::sleep(Duration::from_millis(5));
        back = arrivals.try_iter().any(|message| match message {
            ToHub::Arrival(arrival) => {
                matches!(arrival.what, What::NatNet(bytes) if bytes.first() == Some(&7))
            }
            ToHub::Command(_) => false,
        });
    }
    assert!(back, "frames again");
    stop.store(true, Ordering::Relaxed);
    thread.join().expect("no panic");
}

#[test]
fn osc_is_what_an_independent_decoder_reads() {
    let messages = shisei_hub::osc::messages(&scene(), 1.5);
    let mut addresses = Vec::new();
    for datagram in shisei_hub::osc::datagrams(messages) {
        assert!(datagram.len() <= 1400);
        let (rest, packet) = rosc::decoder::decode_udp(&datagram).expect("OSC");
        assert!(rest.is_empty());
        let rosc::OscPacket::Bundle(bundle) = packet else { panic!("a bundle") };
        for content in bundle.content {
            let rosc::OscPacket::Message(message) = content else { panic!("a message") };
            if message.addr == "/shisei/pose" && message.args[0] == rosc::OscType::String("Tool 1".into()) {
                assert_eq!(message.args[1..4], [1.0_f32, 2.0, 3.0].map(rosc::OscType::Float));
                assert_eq!(message.args[8], rosc::OscType::Int(2));
            }
            if message.addr == "/VMC/Ext/Tra/Pos" && message.args[0] == rosc::OscType::String("Tool 1".into())
            {
                // y up (1, 3, −2); Unity's x is the other way
                assert_eq!(message.args[1..4], [-1.0_f32, 3.0, -2.0].map(rosc::OscType::Float));
            }
            if message.addr == "/VMC/Ext/Bone/Pos" && message.args[0] == rosc::OscType::String("Spine".into())
            {
                let size: f32 =
                    message.args[1..4].iter().map(|x| x.clone().float().expect("a number").powi(2)).sum();
                assert!((size.sqrt() - 0.2).abs() < 1e-6, "{size}");
                assert_eq!(message.args[7], rosc::OscType::Float(1.0));
            }
            addresses.push(message.addr);
        }
    }
    let count = |address: &str| addresses.iter().filter(|one| *one == address).count();
    assert_eq!(count("/VMC/Ext/OK"), 1);
    // the hidden body is not sent
    assert_eq!((count("/shisei/pose"), count("/VMC/Ext/Tra/Pos"), count("/VMC/Ext/Bone/Pos")), (3, 3, 2));
}

#[test]
fn osc_goes_to_an_address_of_either_kind() {
    for ip in ["127.0.0.1:0", "[::1]:0"] {
        let Ok(listener) = std::net::UdpSocket::bind(ip) else {
            eprintln!("skipped: this machine has no {ip}");
            continue;
        };
        listener.set_read_timeout(Some(PATIENCE)).expect("a timeout");
        let mut out = shisei_hub::osc::OscOut::new(listener.local_addr().expect("bound")).expect("a socket");
        out.poses(&scene(), None, 0.0);
        let mut bytes = [0; 2048];
        let count = listener.recv(&mut bytes).expect("a datagram");
        assert!(bytes[..count].starts_with(b"#bundle"), "{ip}");
    }
}

/// What is streamed is told to clients only; whoever asks for more than he sends gets nothing for it.
#[test]
fn who_is_no_client_is_told_no_bodies() {
    let address = [127, 0, 0, 1].into();
    let mut server = NatNetOut::new(address, 0, 0, Axes::YUp).expect("free ports");
    server.scene(&scene());
    let asker = std::net::UdpSocket::bind("127.0.0.1:0").expect("a port");
    asker.set_read_timeout(Some(PATIENCE)).expect("a timeout");
    let ask = |kind: u16| asker.send_to(&write::packet(kind, &[0; 8]), server.address()).expect("sent");
    let answer = || {
        let mut bytes = [0; 4096];
        let count = asker.recv(&mut bytes).expect("an answer");
        read::packet(&bytes[..count]).expect("a packet").0
    };
    ask(id::REQUEST_MODEL);
    ask(id::ECHO_REQUEST);
    assert_eq!(answer(), id::ECHO_RESPONSE);
    ask(id::CONNECT);
    assert_eq!(answer(), id::SERVER_INFO);
    ask(id::REQUEST_MODEL);
    assert_eq!(answer(), id::MODEL);
}
