//! A fused take in MCAP.
//!
//! | topic | what |
//! |---|---|
//! | `/pose/BODY` | every frame that has a pose, `geometry_msgs/msg/PoseStamped` |
//! | `/optical/BODY` | those that the cameras saw, the same |
//! | `/fused/BODY` | every frame: number, source, age of the gap, expected errors, JSON |
//!
//! Poses are in a right-handed world with z up, as the viewers of these messages expect. The stamps are the take's own
//! time: ns since its frame 0 (since its first frame, where that is before).

use std::io::{self, Write};

use mcap::records::MessageHeader;
use mcap::write::NoSeek;
use serde_json::json;
use shisei_core::frames::Axes;
use shisei_core::fuse::{FusedFrame, Source};

use crate::cdr;
use crate::take::{POSE, Schema, add_channel, other, topic};

/// A fused take, one row a frame.
#[derive(Clone, Copy, Debug)]
pub struct FusedTake<'a> {
    /// The body's name.
    pub body: &'a str,
    /// Frame numbers.
    pub frame: &'a [i64],
    /// Time of each frame, s, ascending.
    pub time_s: &'a [f64],
    /// The frames.
    pub frames: &'a [FusedFrame],
    /// The world they are in; right-handed.
    pub axes: Axes,
}

/// Columns that do not fit into a pose.
const FUSED: Schema = Schema {
    name: "shisei.FusedFrame",
    encoding: "jsonschema",
    message_encoding: "json",
    text: r#"{"type":"object","properties":{"frame":{"type":"integer"},"time_s":{"type":"number"},"source":{"type":"string","enum":["optical","bridged","inertial","none"]},"gap_s":{"type":"number"},"sigma_deg":{"type":["number","null"]},"sigma_mm":{"type":["number","null"]}}}"#,
};

/// Writes a fused take, chunked and indexed.
pub fn write(sink: &mut dyn Write, take: &FusedTake<'_>) -> io::Result<()> {
    let mut writer = mcap::WriteOptions::new()
        .compression(None)
        .disable_seeking(true)
        .library(concat!("shisei ", env!("CARGO_PKG_VERSION")))
        .create(NoSeek::new(sink))
        .map_err(other)?;
    let name = topic(take.body);
    let pose = add_channel(&mut writer, &format!("/pose/{name}"), Some(&POSE))?;
    let optical = add_channel(&mut writer, &format!("/optical/{name}"), Some(&POSE))?;
    let fused = add_channel(&mut writer, &format!("/fused/{name}"), Some(&FUSED))?;
    let change = take.axes.to(Axes::ZUp);
    let from_s = take.time_s.first().map_or(0.0, |first| first.min(0.0));
    let rows = take.frame.iter().zip(take.time_s).zip(take.frames);
    for (sequence, ((number, time_s), frame)) in (1_u32..).zip(rows) {
        let ns = ((time_s - from_s) * 1e9).round() as u64;
        let mut put = |channel_id: u16, data: &[u8]| {
            let header = MessageHeader { channel_id, sequence, log_time: ns, publish_time: ns };
            writer.write_to_known_channel(&header, data).map_err(other)
        };
        if let Some(moved) = frame.pose.and_then(|pose| change.world_of_pose(pose).ok()) {
            let message = cdr::pose(&moved, "world", ns);
            put(pose, &message)?;
            if frame.source == Source::Optical {
                put(optical, &message)?;
            }
        }
        let columns = json!({
            "frame": number,
            "time_s": time_s,
            "source": frame.source.name(),
            "gap_s": frame.gap_s,
            "sigma_deg": frame.sigma_rad.to_degrees(),
            "sigma_mm": frame.sigma_m * 1e3,
        });
        put(fused, columns.to_string().as_bytes())?;
    }
    writer.finish().map_err(other)?;
    Ok(())
}
