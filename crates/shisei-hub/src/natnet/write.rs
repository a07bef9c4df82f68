//! Values into packets.

use super::id;
use super::model::{Body, BodyDescription, Frame, Model, ServerInfo, Version};

/// A packet of a kind.
pub fn packet(kind: u16, payload: &[u8]) -> Vec<u8> {
    let mut out = Vec::with_capacity(payload.len() + 4);
    out.extend_from_slice(&kind.to_le_bytes());
    out.extend_from_slice(&(payload.len().min(usize::from(u16::MAX)) as u16).to_le_bytes());
    out.extend_from_slice(payload);
    out
}

/// A client's first word, or its search for servers; asks for the server's own version.
pub fn connect(kind: u16) -> Vec<u8> {
    let mut payload = padded("Ping");
    payload.extend_from_slice(&[0, 0, 0, 0]);
    payload.extend_from_slice(&[4, 1, 0, 0]);
    payload.push(0);
    payload.extend_from_slice(&[0; 5]);
    packet(kind, &payload)
}

/// A server's word about itself.
pub fn server_info(info: &ServerInfo) -> Vec<u8> {
    let mut payload = padded(&info.name);
    payload.extend_from_slice(&info.app_version);
    payload.extend_from_slice(&info.natnet_version);
    payload.extend_from_slice(&info.clock_hz.to_le_bytes());
    payload.extend_from_slice(&info.data_port.to_le_bytes());
    payload.push(u8::from(info.multicast));
    payload.extend_from_slice(&info.group);
    packet(id::SERVER_INFO, &payload)
}

fn padded(name: &str) -> Vec<u8> {
    let mut out = vec![0; 256];
    // the last byte stays zero
    let end = (0..=255.min(name.len())).rev().find(|&end| name.is_char_boundary(end)).unwrap_or(0);
    if let (Some(to), Some(from)) = (out.get_mut(..end), name.as_bytes().get(..end)) {
        to.copy_from_slice(from);
    }
    out
}

/// A frame in a version's layout.
pub fn frame(frame: &Frame, version: Version) -> Vec<u8> {
    let sized = version.sized();
    let mut out = Vec::with_capacity(512);
    int(&mut out, frame.number);
    section(&mut out, sized, &frame.marker_sets, |out, (name, markers)| {
        text(out, name);
        int(out, markers.len() as i32);
        markers.iter().for_each(|marker| floats(out, marker));
    });
    section(&mut out, sized, &frame.other_markers_m, |out, marker| floats(out, marker));
    section(&mut out, sized, &frame.bodies, body);
    section(&mut out, sized, &frame.skeletons, |out, skeleton| {
        int(out, skeleton.id);
        int(out, skeleton.bones.len() as i32);
        skeleton.bones.iter().for_each(|bone| body(out, bone));
    });
    let nothing = |out: &mut Vec<u8>| section(out, sized, &[], |_, (): &()| {});
    if sized {
        nothing(&mut out);
    }
    section(&mut out, sized, &frame.markers, |out, marker| {
        int(out, marker.id);
        floats(out, &marker.position_m);
        floats(out, &[marker.size_m]);
        out.extend_from_slice(&marker.params.to_le_bytes());
        floats(out, &[marker.residual_m]);
    });
    nothing(&mut out);
    nothing(&mut out);
    out.extend_from_slice(&frame.timecode.0.to_le_bytes());
    out.extend_from_slice(&frame.timecode.1.to_le_bytes());
    out.extend_from_slice(&frame.timestamp_s.to_le_bytes());
    for ticks in [frame.mid_exposure, frame.data_received, frame.transmit] {
        out.extend_from_slice(&ticks.to_le_bytes());
    }
    if sized {
        out.extend_from_slice(&[0; 8]);
    }
    out.extend_from_slice(&frame.params.to_le_bytes());
    int(&mut out, 0);
    packet(id::FRAME, &out)
}

/// Names and structure of what is streamed.
pub fn model(model: &Model, version: Version) -> Vec<u8> {
    let mut out = Vec::new();
    int(&mut out, (model.bodies.len() + model.skeletons.len()) as i32);
    let mut one = |kind: i32, inner: Vec<u8>| {
        int(&mut out, kind);
        if version.sized() {
            int(&mut out, inner.len() as i32);
        }
        out.extend_from_slice(&inner);
    };
    for body in &model.bodies {
        let mut inner = Vec::new();
        description(&mut inner, body, version);
        one(1, inner);
    }
    for skeleton in &model.skeletons {
        let mut inner = Vec::new();
        text(&mut inner, &skeleton.name);
        int(&mut inner, skeleton.id);
        int(&mut inner, skeleton.bones.len() as i32);
        skeleton.bones.iter().for_each(|bone| description(&mut inner, bone, version));
        one(2, inner);
    }
    packet(id::MODEL, &out)
}

fn description(out: &mut Vec<u8>, body: &BodyDescription, version: Version) {
    text(out, &body.name);
    int(out, body.id);
    int(out, body.parent);
    floats(out, &body.offset_m);
    int(out, body.markers_m.len() as i32);
    body.markers_m.iter().for_each(|marker| floats(out, marker));
    (0..body.markers_m.len()).for_each(|_| int(out, 0));
    if version.named_markers() {
        (1..=body.markers_m.len()).for_each(|k| text(out, &format!("Marker{k}")));
    }
}

fn body(out: &mut Vec<u8>, body: &Body) {
    int(out, body.id);
    floats(out, &body.position_m);
    floats(out, &body.quaternion_xyzw);
    floats(out, &[body.error_m]);
    out.extend_from_slice(&body.params.to_le_bytes());
}

fn section<T>(out: &mut Vec<u8>, sized: bool, items: &[T], mut write: impl FnMut(&mut Vec<u8>, &T)) {
    int(out, items.len() as i32);
    let mut inner = Vec::new();
    items.iter().for_each(|item| write(&mut inner, item));
    if sized {
        int(out, inner.len() as i32);
    }
    out.extend_from_slice(&inner);
}

fn int(out: &mut Vec<u8>, value: i32) {
    out.extend_from_slice(&value.to_le_bytes());
}

fn floats(out: &mut Vec<u8>, values: &[f32]) {
    values.iter().for_each(|value| out.extend_from_slice(&value.to_le_bytes()));
}

fn text(out: &mut Vec<u8>, text: &str) {
    out.extend(text.bytes().filter(|byte| *byte != 0));
    out.push(0);
}
