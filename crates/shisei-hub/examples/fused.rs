//! Writes a made-up fused take as MCAP, and its numbers as CSV beside it: `cargo run --example fused FOLDER`.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::PathBuf;

use shisei_core::Quaternion;
use shisei_core::frames::{Axes, Pose};
use shisei_core::fuse::{FusedFrame, Source};
use shisei_hub::fused::{FusedTake, write};

fn main() -> std::io::Result<()> {
    let folder = PathBuf::from(std::env::args_os().nth(1).unwrap_or_else(|| ".".into()));
    let sources = [Source::Optical, Source::Bridged, Source::Inertial, Source::None];
    let frame: Vec<i64> = (100..1300).collect();
    let time_s: Vec<f64> = frame.iter().map(|number| *number as f64 / 120.0).collect();
    let made = |k: usize| {
        let source = sources[k / 300];
        let angle = k as f64 * 0.01;
        let pose = Pose {
            position_m: [k as f64 * 1e-3, 1.0, -0.5],
            world_from_body: Quaternion::from_rotation_vector([0.3 * angle, angle, -0.2 * angle]),
        };
        let known = source != Source::None;
        FusedFrame {
            pose: known.then_some(pose),
            source,
            gap_s: if source == Source::Optical { 0.0 } else { (k - 299) as f64 / 120.0 },
            sigma_rad: if known { 0.01 } else { f64::NAN },
            sigma_m: if known { 0.002 } else { f64::NAN },
        }
    };
    let frames: Vec<FusedFrame> = (0..frame.len()).map(made).collect();
    let mut sink = BufWriter::new(File::create(folder.join("fused.mcap"))?);
    let take =
        FusedTake { body: "Tool 道具", frame: &frame, time_s: &time_s, frames: &frames, axes: Axes::YUp };
    write(&mut sink, &take)?;
    sink.flush()?;
    // in the y-up world in which they were given
    let mut csv = BufWriter::new(File::create(folder.join("fused.csv"))?);
    writeln!(csv, "frame,time_s,source,p_x,p_y,p_z,q_w,q_x,q_y,q_z")?;
    for ((number, time_s), made) in frame.iter().zip(&time_s).zip(&frames) {
        let numbers = made.pose.map_or(String::new(), |pose| {
            let numbers = pose.position_m.into_iter().chain(pose.world_from_body.to_array());
            numbers.map(|value| value.to_string()).collect::<Vec<_>>().join(",")
        });
        writeln!(csv, "{number},{time_s},{},{numbers}", made.source.name())?;
    }
    csv.flush()
}
