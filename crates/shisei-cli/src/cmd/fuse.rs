//! `shisei fuse`: an optical take without holes, with the help of an inertial recording.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use serde_json::json;
use shisei_core::frames::{Axes, Pose};
use shisei_core::fuse::{self, FuseSettings, Fusion, Inertial, Optical, Source as PoseSource};
use shisei_core::sync::rates::{RatesSettings, Start};
use shisei_core::{Lang, Quaternion, math, vector};
use shisei_record::motive::{self, Body, LossRule, Take};
use shisei_record::track::fused::Fused;
use shisei_record::track::{Track, gltf, opensim};
use shisei_record::write::Decimals;
use shisei_record::{Input, Recording};

use crate::args::Reading;
use crate::args_fuse::{Fuse, SyncName};
use crate::fail::{Failure, Outcome, say};
use crate::fuse_report;
use crate::input::{self, Source};
use crate::output::{Kind, Writer, is_stdout};

/// A repeated motion: the next best offset explains nearly as much.
const AMBIGUOUS: f64 = 0.95;
/// Up of the sensor this far from the take's up is worth a word, rad (2°).
const LEAN_RAD: f64 = 0.035;

/// Everything of a run.
#[derive(Debug)]
pub struct Done {
    pub take: Take,
    pub body: Body,
    pub time_s: Vec<f64>,
    pub fusion: Fusion,
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
    let report = (!args.no_report)
        .then(|| args.report.clone().unwrap_or_else(|| PathBuf::from(format!("{stem}.fused.html"))));
    let inputs = args.imu.iter().chain([&args.optical]).cloned().collect();
    let writer = Writer { force: args.force, lang, inputs };
    for path in &outputs {
        writer.check(path, kind(path, lang)?)?;
    }
    if let Some(path) = &args.motive {
        writer.check(path, Kind::Motive)?;
    }
    if let Some(path) = &report {
        writer.check(path, Kind::Html)?;
    }
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
        for (row, frame) in done.fusion.frames.iter().enumerate() {
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
        _ => Err(Failure::input(say(
            lang,
            format!("{}: the ending says no format; use .csv, .parquet, .sto, .mot or .glb", path.display()),
            format!(
                "{}：拡張子から形式が分かりません。.csv、.parquet、.sto、.mot、.glb のいずれかにしてください",
                path.display()
            ),
        ))),
    }
}

fn fused(args: &Fuse, lang: Lang) -> Outcome<Done> {
    let name = args.optical.display().to_string();
    let bytes = input::read(&args.optical, lang)?;
    let refuse = |error: motive::Error| Failure::input(error.sentence(lang));
    let take = motive::read(&Input { name: &name, bytes: &bytes }).map_err(refuse)?;
    let body = take.body(args.body.as_deref()).map_err(refuse)?;
    let time_s = take.time_s().map_err(refuse)?;
    let tracked = take.tracked(&body, LossRule { frozen_run: (args.frozen > 0).then_some(args.frozen) });
    let poses: Vec<Option<Pose>> =
        (0..take.len()).map(|row| take.pose(&body, row).filter(|_| tracked[row])).collect();
    let recording = recording(args, lang)?;
    let sensor_s = match args.sync {
        SyncName::Rates => recording.time_s.clone(),
        SyncName::Sequence => {
            take.sequence_s(&sequence(&recording, &shown(args), lang)?).map_err(|error| Failure {
                exit: crate::fail::Exit::Condition,
                sentence: error.sentence(lang),
            })?
        }
    };
    // samples outside the gate have no frame
    let kept: Vec<usize> = (0..sensor_s.len()).filter(|&row| sensor_s[row].is_finite()).collect();
    let pick = |rows: &[[f64; 3]]| kept.iter().map(|&row| rows[row]).collect::<Vec<_>>();
    let (acc, gyro) = (pick(&recording.acc_m_s2), pick(&recording.gyro_rad_s));
    let sensor_s: Vec<f64> = kept.iter().map(|&row| sensor_s[row]).collect();
    let start = if args.sync == SyncName::Sequence { Start::Near(0.0) } else { Start::Search };
    let from = take.axes();
    let settings = FuseSettings {
        rates: RatesSettings { start, ..RatesSettings::default() },
        axes: from,
        gravity_m_s2: args.gravity,
        ..FuseSettings::default()
    };
    let optical = Optical { time_s: &time_s, poses: &poses };
    let inertial = Inertial { time_s: &sensor_s, acc_m_s2: &acc, gyro_rad_s: &gyro };
    let fusion = fuse::fuse(&optical, &inertial, &settings)
        .map_err(|error| Failure::core(&format!("{name}, {}", shown(args)), error, lang))?;
    if args.sync == SyncName::Sequence {
        check_sequence(&take, &fusion, lang)?;
    }
    let to = args.axes.as_deref().and_then(Axes::from_name).unwrap_or(from);
    let warnings = warnings(&recording, &fusion, from, lang);
    let level = from.to(Axes::ZUp);
    let attitude = fusion.frames.iter().map(|frame| {
        let pose = frame.pose.and_then(|pose| level.world_of(pose.world_from_body).ok());
        pose.unwrap_or(Quaternion::new(f64::NAN, f64::NAN, f64::NAN, f64::NAN))
    });
    let attitude = attitude.collect();
    Ok(Done { take, body, time_s, fusion, from, to, attitude, warnings })
}

fn recording(args: &Fuse, lang: Lang) -> Outcome<Recording> {
    let reading = Reading {
        columns: args.columns.clone(),
        units: args.units.clone(),
        rate: args.rate,
        sensor: args.sensor.clone(),
        ..Reading::default()
    };
    let mut options = input::options(&reading, lang)?;
    if args.sync == SyncName::Sequence {
        options.keep = vec!["*".to_owned()];
    }
    input::open(&Source { paths: args.imu.clone() }, &options, lang).map_err(|error| error.failure(lang))
}

/// The real-valued optical frame of each sample.
fn sequence(recording: &Recording, shown: &str, lang: Lang) -> Outcome<Vec<f64>> {
    let Some(extra) = recording.extra.iter().find(|extra| extra.name.eq_ignore_ascii_case("frame")) else {
        return Err(Failure::input(say(
            lang,
            format!("{shown}: there is no column frame, which the receiver writes; use --sync rates"),
            format!("{shown}：受信機が書く frame 列がありません。--sync rates を使ってください"),
        )));
    };
    Ok(extra.cells.iter().map(|cell| cell.trim().parse().unwrap_or(f64::NAN)).collect())
}

/// The rates must agree with the sequence to within a frame.
fn check_sequence(take: &Take, fusion: &Fusion, lang: Lang) -> Outcome<()> {
    let rate_hz = take.rate_hz().map_err(|error| Failure::input(error.sentence(lang)))?;
    let sync = &fusion.sync;
    let frames = (sync.sensor_time_s(sync.middle_s) - sync.middle_s) * rate_hz;
    if frames.abs() < 0.75 {
        return Ok(());
    }
    Err(Failure::condition(say(
        lang,
        format!(
            "{}: the rotation rates say that the frame sequence is off by {frames:.2} frames; pulses were lost, or the recording belongs to another take; use --sync rates, or choose the right recording",
            take.file
        ),
        format!(
            "{}：回転の速さを比べると、フレーム番号が {frames:.2} フレームずれています。パルスの欠落か別のテイクの記録です。--sync rates を使うか、正しい記録を選んでください",
            take.file
        ),
    )))
}

fn warnings(recording: &Recording, fusion: &Fusion, from: Axes, lang: Lang) -> Vec<String> {
    let mut all: Vec<String> = recording.warnings.iter().map(|note| note.sentence(lang).to_owned()).collect();
    let sync = &fusion.sync;
    if sync.runner_up > AMBIGUOUS * sync.explained {
        all.push(say(
            lang,
            "the motion repeats itself: another clock offset explains it nearly as well; add a motion that happens only once",
            "動きが繰り返しのため、別の時刻ずれでもほぼ同じように説明できます。1 回だけの動きを加えてください",
        ));
    }
    let across = vector::norm(vector::cross(fusion.up, from.up()));
    let lean = math::atan2(across, vector::dot(fusion.up, from.up()));
    if lean > LEAN_RAD {
        let degrees = lean.to_degrees();
        all.push(say(
            lang,
            format!("gravity stands {degrees:.1}° from the take's up axis; check the ground plane, and whether the take was exported y-up or z-up"),
            format!("重力の向きがテイクの上方向から {degrees:.1}° ずれています。床面のキャリブレーションと、Y-up / Z-up の書き出し設定を確認してください"),
        ));
    }
    if fusion.lever.is_none() {
        all.push(say(
            lang,
            "the sensor's place on the body could not be found (too little unbroken motion); positions in gaps are less sure",
            "剛体上のセンサの位置を求められませんでした (途切れのない動きが足りません)。欠落部分の位置は不確かです",
        ));
    }
    all
}

fn write(out: &mut dyn Write, kind: Kind, done: &Done) -> io::Result<()> {
    let frames = &done.fusion.frames;
    let fused = Fused { frame: &done.take.frame, time_s: &done.time_s, frames, from: done.from, to: done.to };
    let poses: Vec<Option<Pose>> = frames.iter().map(|frame| frame.pose).collect();
    let track = Track { name: &done.body.name, time_s: &done.time_s, poses: &poses, axes: done.from };
    match kind {
        Kind::Parquet => {
            let mut bytes = Vec::new();
            fused.parquet(&mut bytes)?;
            out.write_all(&bytes)
        }
        Kind::Sto => opensim::sto(out, &track),
        Kind::Mot => opensim::mot(out, &track),
        Kind::Glb => gltf::glb(out, &track),
        _ => fused.csv(out),
    }
}

fn summary_json(done: &Done, outputs: &[PathBuf]) -> serde_json::Value {
    let (sync, fusion) = (&done.fusion.sync, &done.fusion);
    let count = |source| fusion.frames.iter().filter(|frame| frame.source == source).count();
    let gaps: Vec<_> = fusion
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
    json!({
        "body": done.body.name,
        "frames": fusion.frames.len(),
        "optical": count(PoseSource::Optical),
        "bridged": count(PoseSource::Bridged),
        "inertial": count(PoseSource::Inertial),
        "none": count(PoseSource::None),
        "offset_s": sync.offset_s,
        "sigma_offset_s": sync.sigma_offset_s,
        "skew_ppm": sync.skew * 1e6,
        "sigma_skew_ppm": sync.sigma_skew * 1e6,
        "body_from_sensor_wxyz": sync.body_from_sensor.to_array(),
        "sigma_mounting_deg": sync.sigma_mounting_rad.map(f64::to_degrees),
        "explained": sync.explained,
        "lever_arm_m": fusion.lever.map(|lever| lever.sensor_m),
        "sigma_lever_arm_m": fusion.lever.map(|lever| lever.sigma_m),
        "up": fusion.up,
        "axes": done.to.name(),
        "gaps": gaps,
        "warnings": done.warnings,
        "outputs": outputs.iter().map(|path| path.display().to_string()).collect::<Vec<_>>(),
    })
}
