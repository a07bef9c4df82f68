//! A moving body as binary glTF 2.0 (`.glb`): one file that Blender, browsers and engines open.
//!
//! Source: Khronos Group, "glTF 2.0 Specification". The world is y-up, in metres; a box stands for the body, with
//! its x, y and z sides in red, green and blue tones; translation and rotation are animated, linearly between
//! frames. Time starts at 0.

use std::io::{self, Write};

use serde_json::{Value, json};
use shisei_core::frames::Axes;

use super::Track;

/// Half the box's sides, m.
const HALF: [f32; 3] = [0.04, 0.025, 0.015];
const FLOAT: u32 = 5126;
const SHORT: u32 = 5123;

/// Bytes of the buffer and the views and accessors into it.
#[derive(Default)]
struct Buffer {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Buffer {
    /// Adds an accessor; gives its index.
    fn add(&mut self, bytes: &[u8], kind: &str, component: u32, count: usize, more: &Value) -> usize {
        let mut view = json!({ "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len() });
        if let Some(target) = more.get("target") {
            view["target"] = target.clone();
        }
        self.bytes.extend_from_slice(bytes);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let mut accessor = json!({
            "bufferView": self.views.len(), "componentType": component, "count": count, "type": kind
        });
        for limit in ["min", "max"] {
            if let Some(value) = more.get(limit) {
                accessor[limit] = value.clone();
            }
        }
        self.views.push(view);
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }
}

fn floats(values: impl Iterator<Item = f32>) -> Vec<u8> {
    values.flat_map(f32::to_le_bytes).collect()
}

/// Writes the body. A take without a single pose gives a box at rest.
pub fn glb(sink: &mut dyn Write, track: &Track<'_>) -> io::Result<()> {
    let mut buffer = Buffer::default();
    let mesh = mesh(&mut buffer);
    let mut rows: Vec<(f32, [f32; 3], [f32; 4])> = Vec::new();
    let start_s = track.rows(Axes::YUp).next().map_or(0.0, |(time_s, _)| time_s);
    for (time_s, pose) in track.rows(Axes::YUp) {
        let time = (time_s - start_s) as f32;
        // float32 keeps 0.1 ms for half an hour; equal times are not allowed
        if rows.last().is_some_and(|(before, _, _)| time <= *before) {
            continue;
        }
        let mut q = pose.world_from_body;
        if let Some((_, _, last)) = rows.last() {
            let dot = f64::from(last[0]) * q.x
                + f64::from(last[1]) * q.y
                + f64::from(last[2]) * q.z
                + f64::from(last[3]) * q.w;
            if dot < 0.0 {
                q = q.negated();
            }
        }
        let q = [q.x as f32, q.y as f32, q.z as f32, q.w as f32];
        rows.push((time, pose.position_m.map(|value| value as f32), q));
    }
    let mut root = json!({
        "asset": { "version": "2.0", "generator": concat!("shisei ", env!("CARGO_PKG_VERSION")) },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "name": track.name, "mesh": 0 }],
        "meshes": [mesh],
        "materials": material(),
    });
    if let (Some(first), Some(last)) = (rows.first(), rows.last()) {
        root["nodes"][0]["translation"] = json!(first.1);
        root["nodes"][0]["rotation"] = json!(first.2);
        let count = rows.len();
        let limits = json!({ "min": [first.0], "max": [last.0] });
        let time = buffer.add(&floats(rows.iter().map(|row| row.0)), "SCALAR", FLOAT, count, &limits);
        let place = floats(rows.iter().flat_map(|row| row.1));
        let place = buffer.add(&place, "VEC3", FLOAT, count, &Value::Null);
        let turn = floats(rows.iter().flat_map(|row| row.2));
        let turn = buffer.add(&turn, "VEC4", FLOAT, count, &Value::Null);
        root["animations"] = json!([{
            "name": track.name,
            "samplers": [
                { "input": time, "output": place, "interpolation": "LINEAR" },
                { "input": time, "output": turn, "interpolation": "LINEAR" }
            ],
            "channels": [
                { "sampler": 0, "target": { "node": 0, "path": "translation" } },
                { "sampler": 1, "target": { "node": 0, "path": "rotation" } }
            ]
        }]);
    }
    root["bufferViews"] = json!(buffer.views);
    root["accessors"] = json!(buffer.accessors);
    root["buffers"] = json!([{ "byteLength": buffer.bytes.len() }]);
    pack(sink, &root, &buffer.bytes)
}

fn material() -> Value {
    let color = |name: &str, rgb: [f64; 3]| {
        json!({
            "name": name,
            "pbrMetallicRoughness": {
                "baseColorFactor": [rgb[0], rgb[1], rgb[2], 1.0], "metallicFactor": 0.0, "roughnessFactor": 0.8
            }
        })
    };
    json!([color("x", [0.84, 0.37, 0.0]), color("y", [0.0, 0.62, 0.45]), color("z", [0.0, 0.45, 0.70])])
}

/// A box: one primitive a pair of sides.
fn mesh(buffer: &mut Buffer) -> Value {
    let mut primitives = Vec::new();
    for axis in 0..3 {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let (mut positions, mut normals, mut indices) = (Vec::new(), Vec::new(), Vec::new());
        for (side, sign) in [1.0_f32, -1.0].into_iter().enumerate() {
            for (a, b) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
                let mut corner = [0.0_f32; 3];
                corner[axis] = sign * HALF[axis];
                // counter-clockwise from outside
                corner[u] = sign * a * HALF[u];
                corner[v] = b * HALF[v];
                let mut normal = [0.0_f32; 3];
                normal[axis] = sign;
                positions.push(corner);
                normals.push(normal);
            }
            let base = 4 * side as u16;
            indices.extend([0, 1, 2, 0, 2, 3].map(|k| base + k));
        }
        let limits = json!({ "min": HALF.map(|h| -h), "max": HALF, "target": 34962 });
        let bytes = floats(positions.iter().flatten().copied());
        let position = buffer.add(&bytes, "VEC3", FLOAT, positions.len(), &limits);
        let bytes = floats(normals.iter().flatten().copied());
        let normal = buffer.add(&bytes, "VEC3", FLOAT, normals.len(), &json!({ "target": 34962 }));
        let bytes: Vec<u8> = indices.iter().flat_map(|k: &u16| k.to_le_bytes()).collect();
        let index = buffer.add(&bytes, "SCALAR", SHORT, indices.len(), &json!({ "target": 34963 }));
        primitives.push(json!({
            "attributes": { "POSITION": position, "NORMAL": normal }, "indices": index, "material": axis
        }));
    }
    json!({ "name": "body", "primitives": primitives })
}

fn pack(sink: &mut dyn Write, root: &Value, bytes: &[u8]) -> io::Result<()> {
    let mut text = root.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let length = 12 + 8 + text.len() + 8 + bytes.len();
    let size = |value: usize| {
        u32::try_from(value).map(u32::to_le_bytes).map_err(|_| io::Error::other("glTF binary above 4 GiB"))
    };
    sink.write_all(b"glTF")?;
    sink.write_all(&2_u32.to_le_bytes())?;
    sink.write_all(&size(length)?)?;
    sink.write_all(&size(text.len())?)?;
    sink.write_all(b"JSON")?;
    sink.write_all(&text)?;
    sink.write_all(&size(bytes.len())?)?;
    sink.write_all(b"BIN\0")?;
    sink.write_all(bytes)
}
