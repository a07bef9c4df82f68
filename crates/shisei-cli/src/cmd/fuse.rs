//! `shisei fuse`: an optical take without holes, with the help of an inertial recording.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use serde_json::json;
use shisei_core::frames::{Axes, Pose};
use shisei_core::fuse::markers::Place;
use shisei_core::fuse::{FilledGap, FusedFrame, Source as PoseSource};
use shisei_core::sync::lever::Lever;
use shisei_core::sync::rates::Sync;
use shisei_core::{Lang, Quaternion, Vec3};
use shisei_hub::fused::{self as fused_take, FusedTake};
use shisei_record::motive::{self, Body, Take};
use shisei_record::track::fused::Fused;
use shisei_record::track::{Track, gltf, opensim};
use shisei_record::write::Decimals;

use crate::args_fuse::Fuse;
use crate::fail::{Failure, Outcome, say};
use crate::fuse_inputs::fused;
use crate::fuse_report;
use crate::input::Source;
use crate::output::{Kind, Writer, is_stdout};

/// How the frames came about.
#[derive(Debug)]
pub enum How {
    /// A body whose gaps its sensor fills.
    Bridged {
        sync: Box<Sync>,
        lever: Option<Lever>,
        up: Vec3,
        /// Labelled markers by name, and where they sit.
        markers: Vec<(String, Option<Place>)>,
        /// Frames without the body in which a marker holds it.
        held: usize,
    },
    /// A tool without markers in something that the cameras see.
    Held { reference: i64, grip_m: Vec3, tilt_off_rad: f64 },
}

/// Everything of a run.
#[derive(Debug)]
pub struct Done {
    pub take: Take,
    /// The body, or the tool's holder.
    pub body: Body,
    /// What the results are called.
    pub name: String,
    pub time_s: Vec<f64>,
    pub frames: Vec<FusedFrame>,
    pub gaps: Vec<FilledGap>,
    pub how: How,
    pub from: Axes,
    pub to: Axes,
    /// In a world with z up, for the report; NaN where there is no pose.
    pub attitude: Vec<Quaternion>,
    pub warnings: Vec<String>,
}

/// Runs the command.
pub fn run(args: &Fuse, lang: Lang) -> Outcome<()> {
    let stem = (Source { paths: vec![args.optical.clone()] }).stem();
    let mut outputs = args.outputs.clone();
    if outputs.is_empty() {
        outputs.push(PathBuf::from(format!("{stem}.fused.csv")));
    }
    let report = args.report.or(format!("{stem}.fused.html"));
    let inputs = args.imu.iter().chain([&args.optical]).chain(&args.pulses);
    let writer = Writer::new(args.force, lang, inputs);
    let mut results = Vec::new();
    for path in &outputs {
        results.push((path.as_path(), kind(path, lang)?));
    }
    results.extend(args.motive.as_deref().map(|path| (path, Kind::Motive)));
    results.extend(report.as_deref().map(|path| (path, Kind::Html)));
    writer.check_all(&results)?;
    let mut done = fused(args, lang)?;
    let mut staged = Vec::new();
    for path in &outputs {
        let kind = kind(path, lang)?;
        staged.push(writer.stage(path, kind, |out| write(out, kind, &done))?);
    }
    if let Some(path) = &report {
        let page = fuse_report::page(&done, &args.optical.display().to_string(), &shown(args), lang);
        staged.push(writer.stage(path, Kind::Html, |out| out.write_all(page.to_html().as_bytes()))?);
    }
    if let Some(path) = &args.motive {
        for (row, frame) in done.frames.iter().enumerate() {
            if let Some(pose) = frame.pose.filter(|_| frame.source != PoseSource::Optical) {
                done.take.set_pose(&done.body, row, &pose);
            }
        }
        let take = &done.take;
        staged.push(writer.stage(path, Kind::Motive, |out| motive::write(out, take, Decimals::Shortest))?);
    }
    writer.finish(staged)?;
    if args.json {
        println!("{}", summary_json(&done, &outputs));
    }
    eprint!("{}", fuse_report::summary(&done, lang));
    for path in outputs.iter().chain(&args.motive).chain(&report).filter(|path| !is_stdout(path)) {
        eprintln!("→ {}", path.display());
    }
    Ok(())
}

fn shown(args: &Fuse) -> String {
    Source { paths: args.imu.clone() }.shown()
}

/// What an output is, by its ending.
fn kind(path: &Path, lang: Lang) -> Outcome<Kind> {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
    match ending.as_deref() {
        _ if is_stdout(path) => Ok(Kind::Fused),
        Some("csv") => Ok(Kind::Fused),
        Some("parquet") => Ok(Kind::Parquet),
        Some("sto") => Ok(Kind::Sto),
        Some("mot") => Ok(Kind::Mot),
        Some("glb") => Ok(Kind::Glb),
        Some("mcap") => Ok(Kind::Mcap),
        _ => Err(Failure::input(say(
            lang,
            format!(
                "{}: the ending says no format; use .csv, .parquet, .sto, .mot, .glb or .mcap",
                path.display()
            ),
            format!(
                "{}：拡張子から形式が分かりません。.csv、.parquet、.sto、.mot、.glb、.mcap のいずれかにしてください",
                path.display()
            ),
        ))),
    }
}

fn write(out: &mut dyn Write, kind: Kind, done: &Done) -> io::Result<()> {
    let frames = &done.frames;
    let fused = Fused { frame: &done.take.frame, time_s: &done.time_s, frames, from: done.from, to: done.to };
    let poses: Vec<Option<Pose>> = frames.iter().map(|frame| frame.pose).collect();
    let track = Track { name: &done.name, time_s: &done.time_s, poses: &poses, axes: done.from };
    match kind {
        Kind::Parquet => {
            let mut bytes = Vec::new();
            fused.parquet(&mut bytes)?;
            out.write_all(&bytes)
        }
        Kind::Sto => opensim::sto(out, &track),
        Kind::Mot => opensim::mot(out, &track),
        Kind::Glb => gltf::glb(out, &track),
        Kind::Mcap => fused_take::write(
            out,
            &FusedTake {
                body: &done.name,
                frame: &done.take.frame,
                time_s: &done.time_s,
                frames,
                axes: done.from,
            },
        ),
        _ => fused.csv(out),
    }
}

fn summary_json(done: &Done, outputs: &[PathBuf]) -> serde_json::Value {
    let count = |source| done.frames.iter().filter(|frame| frame.source == source).count();
    let gaps: Vec<_> = done
        .gaps
        .iter()
        .map(|gap| {
            json!({
                "first_frame": done.take.frame[gap.first],
                "frames": gap.end - gap.first,
                "length_s": gap.length_s,
                "source": gap.source.name(),
                "sigma_deg": gap.sigma_rad.to_degrees(),
                "sigma_mm": gap.sigma_m * 1e3,
            })
        })
        .collect();
    let mut all = json!({
        "body": done.name,
        "frames": done.frames.len(),
        "optical": count(PoseSource::Optical),
        "bridged": count(PoseSource::Bridged),
        "inertial": count(PoseSource::Inertial),
        "none": count(PoseSource::None),
        "axes": done.to.name(),
        "gaps": gaps,
        "warnings": done.warnings,
        "outputs": outputs.iter().map(|path| path.display().to_string()).collect::<Vec<_>>(),
    });
    let more = match &done.how {
        How::Bridged { sync, lever, up, markers, held } => json!({
            "offset_s": sync.offset_s,
            "sigma_offset_s": sync.sigma_offset_s,
            "skew_ppm": sync.skew * 1e6,
            "sigma_skew_ppm": sync.sigma_skew * 1e6,
            "body_from_sensor_wxyz": sync.body_from_sensor.to_array(),
            "sigma_mounting_deg": sync.sigma_mounting_rad.map(f64::to_degrees),
            "explained": sync.explained,
            "lever_arm_m": lever.map(|lever| lever.sensor_m),
            "sigma_lever_arm_m": lever.map(|lever| lever.sigma_m),
            "up": up,
            "markers": markers.iter().map(|(name, place)| json!({
                "name": name,
                "at_m": place.map(|place| place.at_m),
                "sigma_mm": place.map(|place| place.sigma_m * 1e3),
            })).collect::<Vec<_>>(),
            "held_by_markers": held,
        }),
        How::Held { reference, grip_m, tilt_off_rad } => json!({
            "parent": done.body.name,
            "reference_frame": reference,
            "grip_m": grip_m,
            "tilt_off_deg": tilt_off_rad.to_degrees(),
        }),
    };
    if let (Some(all), serde_json::Value::Object(more)) = (all.as_object_mut(), more) {
        all.extend(more);
    }
    all
}
