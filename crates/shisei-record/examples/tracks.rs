//! Writes a simulated tool in every format of `track`: `cargo run --example tracks FOLDER`.

use std::fs::File;
use std::io::BufWriter;
use std::path::PathBuf;

use shisei_core::Quaternion;
use shisei_core::frames::{Axes, Pose};
use shisei_record::track::{Track, gltf, opensim};
use shisei_twin::movements;
use shisei_twin::optics::{Cameras, Rig, film};

fn main() -> std::io::Result<()> {
    let folder = PathBuf::from(std::env::args_os().nth(1).unwrap_or_else(|| ".".into()));
    let rig = Rig { body_from_sensor: Quaternion::IDENTITY, sensor_m: [0.0; 3], markers_m: Vec::new() };
    let cameras = Cameras { lost_s: vec![(2.0, 2.5)], ..Cameras::new(120.0, 10.0, 1) };
    let frames = film(&movements::wander(1, 1.0, 8.0), &rig, &cameras);
    let time_s: Vec<f64> = frames.iter().map(|frame| frame.time_s).collect();
    let poses: Vec<Option<Pose>> = frames.iter().map(|frame| frame.pose).collect();
    let track = Track { name: "Tool 道具", time_s: &time_s, poses: &poses, axes: Axes::ZUp };
    let create = |name: &str| File::create(folder.join(name)).map(BufWriter::new);
    gltf::glb(&mut create("tool.glb")?, &track)?;
    opensim::sto(&mut create("tool.sto")?, &track)?;
    opensim::mot(&mut create("tool.mot")?, &track)?;
    let nothing = vec![None; time_s.len()];
    gltf::glb(&mut create("nothing.glb")?, &Track { poses: &nothing, ..track })
}
