//! Poses over OSC (open sound control), for programs of avatars and of sound: one way, over UDP.
//!
//! | address | arguments |
//! |---|---|
//! | `/shisei/pose` | name, x, y, z (m, z up), q w, x, y, z, source (1 optical, 2 bridged), gap s, expected errors ° and mm (−1: not known) |
//! | `/VMC/Ext/OK`, `/VMC/Ext/T` | 1; time, s |
//! | `/VMC/Ext/Tra/Pos` | name, position, q x, y, z, w: bodies as trackers of the VMC protocol, Unity's axes |
//! | `/VMC/Ext/Bone/Pos` | Unity's name of a bone, position and q relative to its parent |
//!
//! A pose that is not to be trusted (source none) is not sent, nor one without a position: a sensor that is on no body, or
//! that carries one for too long.

use std::io;
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr, UdpSocket};
use std::time::{Duration, Instant};

use shisei_core::frames::{Axes, Pose};
use shisei_core::fuse::Source;
use shisei_core::vector;

use crate::live::optics::BodyKey;
use crate::live::output::Output;
use crate::live::scene::{Key, Object, Scene};

/// At most so often.
const EVERY: Duration = Duration::from_millis(8);
/// A datagram that no network divides, bytes.
const DATAGRAM: usize = 1400;
/// A bundle's beginning: what it is, and "at once".
const BUNDLE: &[u8] = b"#bundle\0\0\0\0\0\0\0\0\x01";

/// Motive's names of bones, and Unity's.
const BONES: &[(&str, &str)] = &[
    ("Hip", "Hips"),
    ("Ab", "Spine"),
    ("LShoulder", "LeftShoulder"),
    ("LUArm", "LeftUpperArm"),
    ("LFArm", "LeftLowerArm"),
    ("LHand", "LeftHand"),
    ("RShoulder", "RightShoulder"),
    ("RUArm", "RightUpperArm"),
    ("RFArm", "RightLowerArm"),
    ("RHand", "RightHand"),
    ("LThigh", "LeftUpperLeg"),
    ("LShin", "LeftLowerLeg"),
    ("LFoot", "LeftFoot"),
    ("LToe", "LeftToes"),
    ("RThigh", "RightUpperLeg"),
    ("RShin", "RightLowerLeg"),
    ("RFoot", "RightFoot"),
    ("RToe", "RightToes"),
];

/// OSC as an output of the hub.
#[derive(Debug)]
pub struct OscOut {
    socket: UdpSocket,
    to: SocketAddr,
    sent: Option<Instant>,
    started: Instant,
}

impl OscOut {
    /// To an address.
    pub fn new(to: SocketAddr) -> io::Result<Self> {
        let own: IpAddr =
            if to.is_ipv6() { Ipv6Addr::UNSPECIFIED.into() } else { Ipv4Addr::UNSPECIFIED.into() };
        let socket = UdpSocket::bind((own, 0))?;
        socket.set_nonblocking(true)?;
        Ok(OscOut { socket, to, sent: None, started: Instant::now() })
    }
}

impl Output for OscOut {
    fn name(&self) -> String {
        format!("osc {}", self.to)
    }

    fn clients(&self) -> usize {
        1
    }

    fn scene(&mut self, _: &Scene) {}

    fn poses(&mut self, scene: &Scene, _: Option<i64>, _: f64) {
        if self.sent.is_some_and(|at| at.elapsed() < EVERY) {
            return;
        }
        self.sent = Some(Instant::now());
        for datagram in datagrams(messages(scene, self.started.elapsed().as_secs_f64())) {
            // nobody listens, or the buffer is full: the next ones are newer anyway
            let _ = self.socket.send_to(&datagram, self.to);
        }
    }
}

/// What there is, as messages.
pub fn messages(scene: &Scene, time_s: f64) -> Vec<Vec<u8>> {
    let mut all =
        vec![message("/VMC/Ext/OK", &[Argument::Int(1)]), message("/VMC/Ext/T", &[Argument::Float(time_s)])];
    for object in scene.objects() {
        let trusted = object.shown.filter(|shown| shown.source != Source::None && shown.placed);
        let Some(shown) = trusted else { continue };
        let name = object.path();
        let known = |value: f64| if value.is_finite() { value } else { -1.0 };
        let mut arguments = vec![Argument::Text(&name)];
        arguments.extend(shown.pose.position_m.map(Argument::Float));
        arguments.extend(shown.pose.world_from_body.to_array().map(Argument::Float));
        arguments.push(Argument::Int(shown.source.code().into()));
        arguments.push(Argument::Float(shown.gap_s));
        arguments.push(Argument::Float(known(shown.sigma_rad.to_degrees())));
        arguments.push(Argument::Float(known(shown.sigma_m * 1e3)));
        all.push(message("/shisei/pose", &arguments));
        all.push(posed("/VMC/Ext/Tra/Pos", &name, &unity(&shown.pose)));
        if let Some((name, local)) = bone(object, scene) {
            all.push(posed("/VMC/Ext/Bone/Pos", name, &local));
        }
    }
    all
}

/// In Unity's axes, those of the body included: bodies of Motive have their y up.
fn unity(pose: &Pose) -> Pose {
    let motive = Axes::ZUp.to(Axes::YUp).world_of_pose(*pose).unwrap_or(*pose);
    Axes::YUp.to(Axes::UnityYUp).pose(motive)
}

/// A bone's name in Unity, and its pose relative to its parent.
fn bone<'a>(object: &'a Object, scene: &Scene) -> Option<(&'a str, Pose)> {
    let Key::Body(BodyKey::Bone(..)) = object.key else { return None };
    let shown = object.shown.filter(|shown| shown.placed)?;
    // Motive puts the skeleton's name before the bone's
    let own = object.name.rsplit('_').next().unwrap_or(&object.name);
    let name = BONES.iter().find(|(motive, _)| *motive == own).map_or(own, |(_, unity)| unity);
    let own = unity(&shown.pose);
    let Some(parent) = object.parent else { return Some((name, own)) };
    let parent = scene.objects().find(|other| other.key == Key::Body(parent))?.shown.filter(|p| p.placed)?;
    let parent = unity(&parent.pose);
    let back = parent.world_from_body.conjugate();
    Some((
        name,
        Pose {
            position_m: back.rotate(vector::sub(own.position_m, parent.position_m)),
            world_from_body: back.product(own.world_from_body).normalized(),
        },
    ))
}

fn posed(address: &str, name: &str, pose: &Pose) -> Vec<u8> {
    let q = pose.world_from_body;
    let mut arguments = vec![Argument::Text(name)];
    arguments.extend(pose.position_m.map(Argument::Float));
    arguments.extend([q.x, q.y, q.z, q.w].map(Argument::Float));
    message(address, &arguments)
}

/// An argument of a message.
#[derive(Clone, Copy, Debug)]
enum Argument<'a> {
    Int(i32),
    /// Sent with 32 bits.
    Float(f64),
    Text(&'a str),
}

fn message(address: &str, arguments: &[Argument<'_>]) -> Vec<u8> {
    let mut out = Vec::with_capacity(96);
    text(&mut out, address);
    let kinds: String = arguments
        .iter()
        .map(|argument| match argument {
            Argument::Int(_) => 'i',
            Argument::Float(_) => 'f',
            Argument::Text(_) => 's',
        })
        .collect();
    text(&mut out, &format!(",{kinds}"));
    for argument in arguments {
        match argument {
            Argument::Int(value) => out.extend_from_slice(&value.to_be_bytes()),
            Argument::Float(value) => out.extend_from_slice(&(*value as f32).to_be_bytes()),
            Argument::Text(value) => text(&mut out, value),
        }
    }
    out
}

/// A string with a zero at its end, filled up to whole groups of four.
fn text(out: &mut Vec<u8>, text: &str) {
    out.extend(text.bytes().filter(|byte| *byte != 0));
    out.push(0);
    while !out.len().is_multiple_of(4) {
        out.push(0);
    }
}

/// Messages in bundles of a datagram each.
pub fn datagrams(messages: Vec<Vec<u8>>) -> Vec<Vec<u8>> {
    let mut all: Vec<Vec<u8>> = Vec::new();
    for message in messages {
        let fits = all.last().is_some_and(|last| last.len() + 4 + message.len() <= DATAGRAM);
        if !fits {
            all.push(BUNDLE.to_vec());
        }
        if let Some(last) = all.last_mut() {
            last.extend_from_slice(&(message.len() as u32).to_be_bytes());
            last.extend_from_slice(&message);
        }
    }
    all
}
