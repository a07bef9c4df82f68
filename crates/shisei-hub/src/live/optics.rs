//! Frames of the cameras in the hub's coordinates: right-handed, z up, m.

use shisei_core::frames::{Axes, Pose};
use shisei_core::{Quaternion, Vec3};

use crate::natnet;

/// What in a frame can be a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum BodyKey {
    /// A rigid body.
    Rigid(i32),
    /// A bone: skeleton, bone.
    Bone(i32, i32),
}

/// A frame.
#[derive(Clone, Debug, PartialEq)]
pub struct OpticalFrame {
    /// Its number.
    pub number: i64,
    /// Middle of its exposure, s of the cameras' clock.
    pub exposure_s: f64,
    /// Bodies; no pose where one was not seen.
    pub bodies: Vec<(BodyKey, Option<Pose>)>,
    /// Markers that belong to no body, m.
    pub markers_m: Vec<Vec3>,
}

/// What is streamed.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyInfo {
    /// Which.
    pub key: BodyKey,
    /// Its name.
    pub name: String,
    /// Name of its skeleton.
    pub skeleton: Option<String>,
    /// What it hangs on.
    pub parent: Option<BodyKey>,
    /// Its markers, body coordinates, m.
    pub markers_m: Vec<Vec3>,
}

/// Label of a marker that belongs to nothing.
const UNLABELLED: i16 = 0x10;
const OCCLUDED: i16 = 0x01;
/// Bodies and markers that are shown at most.
const BODIES_MAX: usize = 512;
const MARKERS_MAX: usize = 512;

/// A frame of NatNet. `clock_hz` are the ticks of its exposure times; where they are missing, the frame's own time is
/// taken.
pub fn frame(frame: &natnet::Frame, clock_hz: u64, axes: Axes) -> OpticalFrame {
    let exposure_s = if clock_hz > 0 && frame.mid_exposure > 0 {
        // whole seconds first: ticks since start-up need more than the 53 bits of a product
        let (whole, rest) = (frame.mid_exposure / clock_hz, frame.mid_exposure % clock_hz);
        whole as f64 + rest as f64 / clock_hz as f64
    } else {
        frame.timestamp_s
    };
    let change = axes.to(Axes::ZUp);
    let bones = frame.skeletons.iter().flat_map(|skeleton| {
        // a bone's number has its skeleton's in the upper half
        skeleton.bones.iter().map(move |bone| (BodyKey::Bone(skeleton.id, bone.id & 0xffff), bone))
    });
    let rigid = frame.bodies.iter().map(|body| (BodyKey::Rigid(body.id), body));
    let bodies = rigid.chain(bones).take(BODIES_MAX).map(|(key, body)| {
        let bone = matches!(key, BodyKey::Bone(..));
        (key, pose(body, bone).and_then(|pose| change.world_of_pose(pose).ok()))
    });
    let loose = frame
        .markers
        .iter()
        .filter(|marker| {
            marker.params & OCCLUDED == 0 && (marker.params & UNLABELLED != 0 || marker.id >> 16 == 0)
        })
        .map(|marker| marker.position_m);
    let unnamed: Vec<[f32; 3]> =
        if frame.markers.is_empty() { frame.other_markers_m.clone() } else { Vec::new() };
    let markers = loose.chain(unnamed).map(|m| m.map(f64::from)).filter(|m| m.iter().all(|x| x.is_finite()));
    OpticalFrame {
        number: i64::from(frame.number),
        exposure_s,
        bodies: bodies.collect(),
        markers_m: markers.take(MARKERS_MAX).map(|m| change.vector(m)).collect(),
    }
}

/// A body that was seen. Motive marks bones as tracked or not as it marks bodies; a pose of zeros is none.
fn pose(body: &natnet::Body, bone: bool) -> Option<Pose> {
    let [x, y, z, w] = body.quaternion_xyzw.map(f64::from);
    let position_m = body.position_m.map(f64::from);
    let finite = position_m.iter().all(|p| p.is_finite());
    let world_from_body = Quaternion::new(w, x, y, z).try_normalized().ok()?;
    let zero = position_m == [0.0; 3] && !bone;
    (body.tracked() && finite && !zero).then_some(Pose { position_m, world_from_body })
}

/// What is streamed, from NatNet's descriptions.
pub fn bodies(model: &natnet::Model) -> Vec<BodyInfo> {
    let info = |key, skeleton: Option<&str>, parent, body: &natnet::BodyDescription| BodyInfo {
        key,
        name: body.name.clone(),
        skeleton: skeleton.map(str::to_owned),
        parent,
        markers_m: body.markers_m.iter().map(|m| m.map(f64::from)).collect(),
    };
    let rigid = model.bodies.iter().map(|body| info(BodyKey::Rigid(body.id), None, None, body));
    let bones = model.skeletons.iter().flat_map(|skeleton| {
        skeleton.bones.iter().map(move |bone| {
            let key = |id: i32| BodyKey::Bone(skeleton.id, id & 0xffff);
            let parent = skeleton.bones.iter().find(|other| other.id == bone.parent && other.id != bone.id);
            info(key(bone.id), Some(&skeleton.name), parent.map(|parent| key(parent.id)), bone)
        })
    });
    rigid.chain(bones).take(BODIES_MAX).collect()
}
