//! OpenSim's tables: orientations (`.sto`, quaternions) and motions (`.mot`).
//!
//! Source: OpenSim documentation, "Storage (.sto) files", "Motion (.mot) files" and "OpenSense - Kinematics with
//! IMU data": a header of `key=value` lines up to `endheader`, a line of labels, rows parted by tabs; a
//! quaternion is `w,x,y,z` in one cell. OpenSim's ground is y-up. It passes over keys that it does not know: `generator`
//! says that the file is ours.

use std::io::{self, Write};

use shisei_core::frames::Axes;
use shisei_core::math;

use super::Track;
use crate::write::{Decimals, push_number};

const GENERATOR: &str = concat!("generator=shisei ", env!("CARGO_PKG_VERSION"));

/// Writes the orientations of a body as a quaternion table that OpenSense reads.
pub fn sto(sink: &mut dyn Write, track: &Track<'_>) -> io::Result<()> {
    let rate_hz = rate(track.time_s);
    let name = label(track.name);
    write!(
        sink,
        "DataRate={rate_hz:.6}\nDataType=Quaternion\nversion=3\nOpenSimVersion=4.5\n{GENERATOR}\nendheader\ntime\t{name}\n"
    )?;
    let mut line = Vec::new();
    for (time_s, pose) in track.rows(Axes::YUp) {
        line.clear();
        push_number(&mut line, time_s, Decimals::Shortest);
        for (k, value) in pose.world_from_body.to_array().into_iter().enumerate() {
            line.push(if k == 0 { b'\t' } else { b',' });
            push_number(&mut line, value, Decimals::Shortest);
        }
        line.push(b'\n');
        sink.write_all(&line)?;
    }
    Ok(())
}

/// Writes a motion: `NAME_tx, _ty, _tz` in m and `NAME_rx, _ry, _rz`, body-fixed X-Y-Z angles in degrees.
pub fn mot(sink: &mut dyn Write, track: &Track<'_>) -> io::Result<()> {
    let name = label(track.name);
    let count = track.rows(Axes::YUp).count();
    write!(
        sink,
        "{name}\nversion=1\nnRows={count}\nnColumns=7\ninDegrees=yes\n{GENERATOR}\nendheader\ntime"
    )?;
    for axis in ["tx", "ty", "tz", "rx", "ry", "rz"] {
        write!(sink, "\t{name}_{axis}")?;
    }
    sink.write_all(b"\n")?;
    let mut line = Vec::new();
    for (time_s, pose) in track.rows(Axes::YUp) {
        line.clear();
        push_number(&mut line, time_s, Decimals::Shortest);
        let m = pose.world_from_body.to_matrix();
        // R = Rx Ry Rz
        let angles = [
            math::atan2(-m[1][2], m[2][2]),
            math::atan2(m[0][2], math::hypot(m[0][0], m[0][1])),
            math::atan2(-m[0][1], m[0][0]),
        ];
        for value in pose.position_m.into_iter().chain(angles.map(f64::to_degrees)) {
            line.push(b'\t');
            push_number(&mut line, value, Decimals::Shortest);
        }
        line.push(b'\n');
        sink.write_all(&line)?;
    }
    Ok(())
}

/// Rows a second.
fn rate(time_s: &[f64]) -> f64 {
    match (time_s.first(), time_s.last()) {
        (Some(first), Some(last)) if last > first => (time_s.len() - 1) as f64 / (last - first),
        _ => 1.0,
    }
}

/// A name without blanks and separators, which part the cells.
fn label(name: &str) -> String {
    let label: String = name
        .chars()
        .map(|c| if c.is_whitespace() || c.is_control() || "=,:/".contains(c) { '_' } else { c })
        .collect();
    if label.is_empty() { "body".to_owned() } else { label }
}
