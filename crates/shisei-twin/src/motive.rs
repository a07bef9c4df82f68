//! Writes filmed bodies as Motive's tracking CSV, with the quirks of its versions. The layout follows files of
//! Motive 1.7 to 3.1 and is written here apart from the reader, which is tested against it.

use std::fmt::Write;

use shisei_core::frames::Pose;
use shisei_core::{Quaternion, Vec3, math};

use crate::optics::Frame;

const DEG: f64 = core::f64::consts::PI / 180.0;

/// What a lost body's cells hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Loss {
    /// Nothing.
    Blank,
    /// The last pose, again and again.
    Frozen,
}

/// How a take is written.
#[derive(Clone, Debug, PartialEq)]
pub struct Style {
    /// `1.21` … `1.25`: 1.21 has no words in its heading, 1.25 a row of parents.
    pub version: &'static str,
    /// Take Name.
    pub take_name: &'static str,
    /// Capture Start Time.
    pub start_time: &'static str,
    /// Degrees about x, y, z in place of quaternions.
    pub euler: bool,
    /// `Meters`, `Centimeters` or `Millimeters`.
    pub units: &'static str,
    /// The world has z up, as simulated, and the first row says so.
    pub z_up: bool,
    /// A third column with a time code.
    pub timecode: bool,
    /// Digits of the time column.
    pub time_digits: usize,
    /// Lost bodies.
    pub loss: Loss,
    /// Number of the first frame.
    pub first_frame: i64,
    /// Total Frames in Take, where it is not what is written.
    pub total_frames: Option<i64>,
}

impl Default for Style {
    fn default() -> Self {
        Style {
            version: "1.24",
            take_name: "Take 2026-01-05 03.49.50 PM",
            start_time: "2026-01-05 03.49.50.755 PM",
            euler: false,
            units: "Meters",
            z_up: false,
            timecode: false,
            time_digits: 6,
            loss: Loss::Blank,
            first_frame: 0,
            total_frames: None,
        }
    }
}

/// A body to write: its name, its parent for bones, and its frames (of equal number for all).
#[derive(Clone, Debug, PartialEq)]
pub struct Body<'a> {
    /// Name; `SKELETON:BONE` for a bone.
    pub name: &'a str,
    /// A bone of a skeleton.
    pub bone: bool,
    /// Name of the parent.
    pub parent: &'a str,
    /// Where it was.
    pub frames: &'a [Frame],
    /// Write its markers: solved ones always filled, seen ones blank where hidden, and one without a name.
    pub markers: bool,
}

/// One column: five heading cells (type, name, ID, parent, quantity, axis) and its values.
struct Column {
    heading: [String; 6],
    values: Vec<Option<f64>>,
}

/// The text of a take.
pub fn csv(bodies: &[Body<'_>], rate_hz: f64, style: &Style) -> String {
    let rows = bodies.first().map_or(0, |body| body.frames.len());
    let mut columns: Vec<Column> = bodies.iter().flat_map(|body| pose_columns(body, style)).collect();
    columns.extend(bodies.iter().filter(|body| body.markers).flat_map(|body| marker_columns(body, style)));
    let rotation = if style.euler { "XYZ" } else { "Quaternion" };
    let total = style.total_frames.unwrap_or(rows as i64);
    let mut text = format!(
        "Format Version,{},Take Name,{},Capture Frame Rate,{rate_hz:.6},Export Frame Rate,{rate_hz:.6},\
         Capture Start Time,{},Total Frames in Take,{total},Total Exported Frames,{rows},Rotation Type,{rotation},\
         Length Units,{},Coordinate Space,Global",
        style.version, style.take_name, style.start_time, style.units
    );
    text.push_str(if style.z_up { ",Up Axis,Z\r\n\r\n" } else { "\r\n\r\n" });
    let worded = style.version != "1.21";
    let words = if worded { ["Type", "Name", "ID", "Parent", "", ""] } else { [""; 6] };
    for (row, word) in words.iter().enumerate() {
        if row == 3 && style.version != "1.25" {
            continue;
        }
        match (row, worded) {
            (5, true) => text.push_str("Frame,Time (Seconds)"),
            (5, false) => text.push_str("Frame,Time"),
            _ => {
                let _ = write!(text, ",{word}");
            }
        }
        if style.timecode {
            text.push_str(if row == 5 { ",TimeCode" } else { "," });
        }
        for column in &columns {
            let cell = &column.heading[row];
            // IDs are quoted, other cells where they must be
            if row == 2 || cell.contains(',') {
                let _ = write!(text, ",\"{cell}\"");
            } else {
                let _ = write!(text, ",{cell}");
            }
        }
        text.push_str("\r\n");
    }
    for row in 0..rows {
        let number = style.first_frame + row as i64;
        let _ = write!(text, "{number},{:.*}", style.time_digits, number as f64 / rate_hz);
        if style.timecode {
            let second = row as u64 / 30;
            let _ = write!(text, ",10:{:02}:{:02}:{:02}.0", second / 60 % 60, second % 60, row % 30);
        }
        for column in &columns {
            match column.values[row] {
                Some(value) => {
                    let _ = write!(text, ",{value:.6}");
                }
                None => text.push(','),
            }
        }
        text.push_str("\r\n");
    }
    text
}

fn scale(style: &Style) -> f64 {
    match style.units {
        "Millimeters" => 1000.0,
        "Centimeters" => 100.0,
        _ => 1.0,
    }
}

/// A point of the simulated world (z up) in the take's axes and unit: Motive's y is up, its z is minus our y.
fn point(p: Vec3, style: &Style) -> Vec3 {
    let s = scale(style);
    if style.z_up { [p[0] * s, p[1] * s, p[2] * s] } else { [p[0] * s, p[2] * s, -p[1] * s] }
}

/// The rotation with the world's axes renamed in the same way; the body keeps its own.
fn rotation(q: Quaternion, style: &Style) -> Quaternion {
    let half = math::sqrt(0.5);
    if style.z_up { q } else { Quaternion::new(half, -half, 0.0, 0.0).product(q) }
}

/// Degrees about x, y, z with R = Rx Ry Rz.
fn euler_deg(q: Quaternion) -> Vec3 {
    let m = q.to_matrix();
    let y = math::asin(m[0][2].clamp(-1.0, 1.0));
    [math::atan2(-m[1][2], m[2][2]) / DEG, y / DEG, math::atan2(-m[0][1], m[0][0]) / DEG]
}

fn identifier(name: &str) -> String {
    let sum = name.bytes().fold(0xCF51_07FC_u32, |sum, byte| sum.rotate_left(5) ^ u32::from(byte));
    format!("{sum:08X}B3ED11E565670A50E6808782")
}

fn pose_columns(body: &Body<'_>, style: &Style) -> Vec<Column> {
    let mut last: Option<Pose> = None;
    let poses: Vec<Option<Pose>> = body
        .frames
        .iter()
        .map(|frame| {
            let shown = frame.pose.or(if style.loss == Loss::Frozen { last } else { None });
            last = shown.or(last);
            shown
        })
        .collect();
    let kind = if body.bone { "Bone" } else { "Rigid Body" };
    let column = |quantity: &str, axis: &str, value: &dyn Fn(&Pose) -> f64| Column {
        heading: [kind, body.name, &identifier(body.name), body.parent, quantity, axis].map(str::to_owned),
        values: poses.iter().map(|pose| pose.as_ref().map(value)).collect(),
    };
    let mut columns = Vec::new();
    for (index, axis) in ["X", "Y", "Z"].into_iter().enumerate() {
        columns.push(column("Rotation", axis, &|pose| {
            let q = rotation(pose.world_from_body, style);
            if style.euler { euler_deg(q)[index] } else { [q.x, q.y, q.z][index] }
        }));
    }
    if !style.euler {
        columns.push(column("Rotation", "W", &|pose| rotation(pose.world_from_body, style).w));
    }
    for (index, axis) in ["X", "Y", "Z"].into_iter().enumerate() {
        columns.push(column("Position", axis, &|pose| point(pose.position_m, style)[index]));
    }
    if !body.bone {
        let name = if style.version == "1.21" { "Error Per Marker" } else { "Mean Marker Error" };
        columns.push(column(name, "", &|_| 0.000_12 * scale(style)));
    }
    columns
}

fn marker_columns(body: &Body<'_>, style: &Style) -> Vec<Column> {
    let count = body.frames.first().map_or(0, |frame| frame.markers_m.len());
    let mut columns = Vec::new();
    let mut push = |kind: &str, name: &str, value: &dyn Fn(&Frame) -> Option<Vec3>, quality: Option<f64>| {
        let heading = |quantity: &str, axis: &str| {
            [kind, name, &identifier(name), body.name, quantity, axis].map(str::to_owned)
        };
        for (index, axis) in ["X", "Y", "Z"].into_iter().enumerate() {
            let values = body.frames.iter().map(|frame| Some(point(value(frame)?, style)[index])).collect();
            columns.push(Column { heading: heading("Position", axis), values });
        }
        if let Some(quality) = quality {
            let values = body.frames.iter().map(|_| Some(quality)).collect();
            columns.push(Column { heading: heading("Marker Quality", ""), values });
        }
    };
    for marker in 0..count {
        // the solved marker stays filled while the camera does not see it
        let name = format!("{}_{}", body.name, marker + 1);
        let solved = |frame: &Frame| frame.markers_m[marker].or(Some(frame.truth.position_m));
        push("Rigid Body Marker", &name, &solved, (style.version == "1.21").then_some(0.99));
    }
    for marker in 0..count {
        let name = format!("{}:Marker{}", body.name, marker + 1);
        push("Marker", &name, &|frame| frame.markers_m[marker], None);
    }
    let stray = |frame: &Frame| (frame.number % 7 != 3).then_some([0.5, 0.25, 1.5]);
    let name = if style.version == "1.21" { "Unlabeled:108" } else { "Unlabeled 1108" };
    push("Marker", name, &stray, None);
    columns
}
