//! What the hub knows, as if it came from Motive: existing clients see the fused bodies. Unicast, to those who ask, or
//! multicast, to a group on one network.

use std::io;
use std::net::{Ipv4Addr, SocketAddr, SocketAddrV4, UdpSocket};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use shisei_core::frames::{Axes, Pose};
use shisei_core::fuse::Source;

use super::{
    Body, BodyDescription, Frame, GROUP, Model, OWN_NAME, ServerInfo, Skeleton, SkeletonDescription, Version,
    id, read, write,
};
use crate::live::optics::BodyKey;
use crate::live::output::Output;
use crate::live::scene::{Key, Object, Scene};

/// Ticks of the clock, Hz.
const CLOCK_HZ: u64 = 10_000_000;
/// A client that says nothing for so long is gone.
const SILENT: Duration = Duration::from_secs(10);
/// Clients at one time.
const CLIENTS_MAX: usize = 16;
/// A read waits so long.
const READ: Duration = Duration::from_millis(50);
/// Without a frame from the cameras for so long, sensors go on alone: then one goes out this often.
const NO_FRAMES: Duration = Duration::from_millis(100);
const WITHOUT_FRAMES: Duration = Duration::from_millis(20);
/// A number that is so much smaller than the last is another count.
const RESTART_FRAMES: i64 = 100;
/// Largest request.
const REQUEST_MAX: usize = 1024;
/// Largest packet that is sent.
const SEND_MAX: usize = 65_000;

/// The server as an output of the hub.
#[derive(Debug)]
pub struct NatNetOut {
    data: UdpSocket,
    shared: Arc<Shared>,
    stop: Arc<AtomicBool>,
    thread: Option<std::thread::JoinHandle<()>>,
    address: SocketAddr,
    axes: Axes,
    number: i32,
    frames: i64,
    sent: Instant,
    /// When the cameras' last frame came.
    came: Instant,
    /// All get the same frames here.
    group: Option<SocketAddr>,
}

#[derive(Debug)]
struct Shared {
    clients: Mutex<Vec<Listener>>,
    model: Mutex<Model>,
    changed: AtomicBool,
    data_port: u16,
    group: Option<Ipv4Addr>,
}

#[derive(Clone, Copy, Debug)]
struct Listener {
    address: SocketAddr,
    version: Version,
    heard: Instant,
}

impl NatNetOut {
    /// Serves on an address, with ports for commands and data (0: any that is free), in a world of these axes. An
    /// error is that of a port which another program holds.
    pub fn new(address: Ipv4Addr, command: u16, data: u16, axes: Axes) -> io::Result<Self> {
        let socket = UdpSocket::bind((address, data))?;
        let port = socket.local_addr()?.port();
        Self::serve(address, command, socket, port, None, axes)
    }

    /// The same for a multicast group, on the network of that address and no farther: whoever listens to the group on
    /// this port gets the frames. An error also where the group is none.
    pub fn multicast(address: Ipv4Addr, command: u16, group: SocketAddrV4, axes: Axes) -> io::Result<Self> {
        if !group.ip().is_multicast() {
            return Err(io::Error::new(io::ErrorKind::InvalidInput, "not a multicast group"));
        }
        // clients on this machine hold the port of the group
        let socket = UdpSocket::bind((address, 0))?;
        let options = socket2::SockRef::from(&socket);
        options.set_multicast_if_v4(&address)?;
        options.set_multicast_ttl_v4(1)?;
        Self::serve(address, command, socket, group.port(), Some(group), axes)
    }

    fn serve(
        address: Ipv4Addr,
        command: u16,
        data: UdpSocket,
        data_port: u16,
        group: Option<SocketAddrV4>,
        axes: Axes,
    ) -> io::Result<Self> {
        let commands = UdpSocket::bind((address, command))?;
        commands.set_read_timeout(Some(READ))?;
        data.set_nonblocking(true)?;
        let bound = commands.local_addr()?;
        let shared = Arc::new(Shared {
            clients: Mutex::new(Vec::new()),
            model: Mutex::new(Model::default()),
            changed: AtomicBool::new(false),
            data_port,
            group: group.map(|group| *group.ip()),
        });
        let stop = Arc::new(AtomicBool::new(false));
        let (answering, until) = (Arc::clone(&shared), Arc::clone(&stop));
        let thread = std::thread::spawn(move || {
            let mut bytes = [0; REQUEST_MAX];
            while !until.load(Ordering::Relaxed) {
                if let Ok((count, from)) = commands.recv_from(&mut bytes) {
                    answering.answer(&commands, bytes.get(..count).unwrap_or_default(), from);
                }
            }
        });
        Ok(NatNetOut {
            data,
            shared,
            stop,
            thread: Some(thread),
            address: bound,
            axes,
            number: 0,
            frames: -1,
            sent: Instant::now(),
            came: Instant::now(),
            group: group.map(SocketAddr::V4),
        })
    }

    /// Where commands go.
    pub fn address(&self) -> SocketAddr {
        self.address
    }
}

impl Drop for NatNetOut {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            // a panic there has been printed
            let _ = thread.join();
        }
    }
}

fn locked<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    // what is in there is whole at every moment
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Shared {
    fn answer(&self, socket: &UdpSocket, bytes: &[u8], from: SocketAddr) {
        let Ok((kind, payload)) = read::packet(bytes) else { return };
        let answer = match kind {
            id::CONNECT | id::DISCOVERY => {
                let wanted = payload.get(265..267).map(|v| (v[0], v[1])).filter(|v| v.0 >= 3);
                let version = wanted.map(|(major, minor)| Version { major, minor });
                // a group hears one version, the newest
                let version =
                    version.filter(|_| self.group.is_none()).unwrap_or(Version::V4_1).min(Version::V4_1);
                if kind == id::CONNECT && !self.enter(from, Some(version)) {
                    return;
                }
                Some(write::server_info(&self.info(version)))
            }
            id::KEEP_ALIVE => {
                self.enter(from, None);
                None
            }
            id::DISCONNECT => {
                locked(&self.clients).retain(|client| client.address != from);
                None
            }
            id::REQUEST_MODEL => {
                // a group's listeners need not connect
                if !self.enter(from, None) && self.group.is_none() {
                    return;
                }
                Some(write::model(&locked(&self.model), self.version(from)))
            }
            id::ECHO_REQUEST => {
                let mut out = payload.get(..8).unwrap_or(&[0; 8]).to_vec();
                out.extend_from_slice(&ticks_now().to_le_bytes());
                Some(write::packet(id::ECHO_RESPONSE, &out))
            }
            id::REQUEST => Some(self.request(payload, from)),
            _ => None,
        };
        if let Some(answer) = answer {
            // who cannot be reached will ask again
            let _ = socket.send_to(&answer, from);
        }
    }

    /// A command in words: only the version can be changed.
    fn request(&self, payload: &[u8], from: SocketAddr) -> Vec<u8> {
        let text = String::from_utf8_lossy(payload.split(|byte| *byte == 0).next().unwrap_or_default());
        let version = text.strip_prefix("Bitstream,").and_then(|wanted| {
            let mut parts = wanted.split('.').map(|part| part.trim().parse::<u8>().ok());
            let (major, minor) = (parts.next()??, parts.next().flatten().unwrap_or(0));
            let oldest = if self.group.is_some() { Version::V4_1 } else { Version::V3_0 };
            Some(Version { major, minor }).filter(|v| (oldest..=Version::V4_1).contains(v))
        });
        match version {
            Some(version) if self.enter(from, Some(version)) => {
                write::packet(id::RESPONSE, &0_i32.to_le_bytes())
            }
            _ => write::packet(id::UNRECOGNIZED, &[]),
        }
    }

    /// A client is there; false where there are too many.
    fn enter(&self, from: SocketAddr, version: Option<Version>) -> bool {
        let heard = Instant::now();
        let mut clients = locked(&self.clients);
        clients.retain(|client| client.heard.elapsed() < SILENT);
        if let Some(client) = clients.iter_mut().find(|client| client.address == from) {
            client.heard = heard;
            client.version = version.unwrap_or(client.version);
            return true;
        }
        let Some(version) = version.filter(|_| clients.len() < CLIENTS_MAX) else { return false };
        clients.push(Listener { address: from, version, heard });
        true
    }

    fn version(&self, of: SocketAddr) -> Version {
        let clients = locked(&self.clients);
        clients.iter().find(|client| client.address == of).map_or(Version::V4_1, |client| client.version)
    }

    fn info(&self, version: Version) -> ServerInfo {
        ServerInfo {
            name: OWN_NAME.into(),
            app_version: [0, 1, 0, 0],
            natnet_version: [version.major, version.minor, 0, 0],
            clock_hz: CLOCK_HZ,
            data_port: self.data_port,
            multicast: self.group.is_some(),
            group: self.group.map_or(GROUP, |group| group.octets()),
        }
    }
}

fn ticks_now() -> u64 {
    crate::live::input::unix_ns() / (1_000_000_000 / CLOCK_HZ)
}

impl Output for NatNetOut {
    fn name(&self) -> String {
        match self.group {
            Some(group) => format!("natnet {} → {group}", self.address),
            None => format!("natnet {}", self.address),
        }
    }

    fn clients(&self) -> usize {
        locked(&self.shared.clients).iter().filter(|client| client.heard.elapsed() < SILENT).count()
    }

    fn scene(&mut self, scene: &Scene) {
        let mut model = Model::default();
        for object in scene.objects() {
            let Key::Body(key) = object.key else { continue };
            let description = |parent: i32| BodyDescription {
                name: object.name.clone(),
                id: number(key),
                parent,
                offset_m: [0.0; 3],
                markers_m: object.markers_m.iter().map(|m| m.map(|x| x as f32)).collect(),
            };
            match key {
                BodyKey::Rigid(_) => model.bodies.push(description(-1)),
                BodyKey::Bone(skeleton, _) => {
                    let bone = description(object.parent.map_or(0, number));
                    let name = object.skeleton.clone().unwrap_or_default();
                    match model.skeletons.iter_mut().find(|known| known.id == skeleton) {
                        Some(known) => known.bones.push(bone),
                        None => model.skeletons.push(SkeletonDescription {
                            name,
                            id: skeleton,
                            bones: vec![bone],
                        }),
                    }
                }
            }
        }
        *locked(&self.shared.model) = model;
        self.shared.changed.store(true, Ordering::Relaxed);
    }

    fn poses(&mut self, scene: &Scene, frame: Option<i64>, exposure_s: f64) {
        let clients: Vec<Listener> = {
            let mut clients = locked(&self.shared.clients);
            clients.retain(|client| client.heard.elapsed() < SILENT);
            clients.clone()
        };
        // every frame once; where none come any more, sensors go on
        let newer = frame.filter(|frame| *frame != self.frames);
        // a number that was given to one of our own, after all
        let given =
            newer.is_some_and(|frame| (0..RESTART_FRAMES).contains(&(i64::from(self.number) - frame)));
        if newer.is_some() {
            self.came = Instant::now();
        }
        let alone = self.came.elapsed() >= NO_FRAMES && self.sent.elapsed() >= WITHOUT_FRAMES;
        if (clients.is_empty() && self.group.is_none()) || given || (newer.is_none() && !alone) {
            return;
        }
        self.sent = Instant::now();
        self.frames = newer.unwrap_or(self.frames);
        self.number = newer.map_or(self.number.wrapping_add(1), |frame| frame as i32);
        let mut out = Frame {
            number: self.number,
            timestamp_s: exposure_s,
            mid_exposure: (exposure_s.max(0.0) * CLOCK_HZ as f64) as u64,
            transmit: ticks_now(),
            params: if self.shared.changed.swap(false, Ordering::Relaxed) { 2 } else { 0 },
            ..Frame::default()
        };
        for object in scene.objects() {
            let Key::Body(key) = object.key else { continue };
            let body = body(object, key, self.axes);
            match key {
                BodyKey::Rigid(_) => out.bodies.push(body),
                BodyKey::Bone(skeleton, _) => {
                    match out.skeletons.iter_mut().find(|known| known.id == skeleton) {
                        Some(known) => known.bones.push(body),
                        None => out.skeletons.push(Skeleton { id: skeleton, bones: vec![body] }),
                    }
                }
            }
        }
        let group = self.group.map(|address| (address, Version::V4_1));
        let single = clients.iter().map(|client| (client.address, client.version));
        let to: Vec<_> = if group.is_some() { group.into_iter().collect() } else { single.collect() };
        for (address, version) in to {
            let packet = write::frame(&out, version);
            if packet.len() <= SEND_MAX {
                // a full buffer costs this client a frame, and nobody anything else
                let _ = self.data.send_to(&packet, address);
            }
        }
    }
}

fn number(key: BodyKey) -> i32 {
    match key {
        BodyKey::Rigid(id) => id,
        BodyKey::Bone(skeleton, id) => (skeleton << 16) | id,
    }
}

fn body(object: &Object, key: BodyKey, axes: Axes) -> Body {
    let shown = object
        .shown
        .filter(|shown| shown.placed && matches!(shown.source, Source::Optical | Source::Bridged));
    let pose: Option<Pose> = shown.and_then(|shown| Axes::ZUp.to(axes).world_of_pose(shown.pose).ok());
    let (p, q) = match pose {
        Some(pose) => (pose.position_m, pose.world_from_body),
        None => ([0.0; 3], shisei_core::Quaternion::IDENTITY),
    };
    let error_m = shown.map_or(0.0, |shown| shown.sigma_m);
    Body {
        id: number(key),
        position_m: p.map(|x| x as f32),
        quaternion_xyzw: [q.x, q.y, q.z, q.w].map(|x| x as f32),
        error_m: if error_m.is_finite() { error_m as f32 } else { 0.0 },
        params: i16::from(pose.is_some()),
    }
}
