//! The orientation columns as CSV.

use std::io::{self, Write};

use shisei_core::orient::Orientation;
use shisei_record::Recording;

const DEG_PER_RAD: f64 = 180.0 / std::f64::consts::PI;

/// Writes `time_s, q_w … q_z, yaw, pitch, roll` and the kept columns of the input. Numbers are the shortest that
/// read back to the same bits.
pub fn write(
    out: &mut dyn Write,
    recording: &Recording,
    orientation: &Orientation,
    degrees: bool,
) -> io::Result<()> {
    let (unit, factor) = if degrees { ("deg", DEG_PER_RAD) } else { ("rad", 1.0) };
    let mut line = format!("time_s,q_w,q_x,q_y,q_z,yaw_{unit},pitch_{unit},roll_{unit}").into_bytes();
    for extra in &recording.extra {
        line.push(b',');
        push_cell(&mut line, &extra.name);
    }
    line.push(b'\n');
    let mut buffer = zmij::Buffer::new();
    for k in 0..recording.len() {
        let q = orientation.world_from_body[k];
        let ypr = orientation.ypr(k);
        let row = [
            recording.time_s[k],
            q.w,
            q.x,
            q.y,
            q.z,
            ypr.yaw_rad * factor,
            ypr.pitch_rad * factor,
            ypr.roll_rad * factor,
        ];
        for (column, value) in row.into_iter().enumerate() {
            if column > 0 {
                line.push(b',');
            }
            line.extend_from_slice(buffer.format(value).as_bytes());
        }
        for extra in &recording.extra {
            line.push(b',');
            push_cell(&mut line, extra.cells.get(k).map_or("", |cell| cell));
        }
        line.push(b'\n');
        if line.len() > 1 << 16 {
            out.write_all(&line)?;
            line.clear();
        }
    }
    out.write_all(&line)
}

/// A cell, quoted where it must be.
pub fn push_cell(line: &mut Vec<u8>, cell: &str) {
    if !cell.contains([',', '"', '\n', '\r']) {
        line.extend_from_slice(cell.as_bytes());
        return;
    }
    line.push(b'"');
    for byte in cell.bytes() {
        if byte == b'"' {
            line.push(b'"');
        }
        line.push(byte);
    }
    line.push(b'"');
}
