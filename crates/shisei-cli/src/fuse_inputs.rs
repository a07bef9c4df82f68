//! What `shisei fuse` reads, and how the clocks are brought together.

use shisei_core::frames::{Axes, Pose};
use shisei_core::fuse::relative::{RelativeSettings, relative};
use shisei_core::fuse::{self, FuseSettings, Fusion, Inertial, Optical};
use shisei_core::sync::rates::{RatesSettings, Start};
use shisei_core::{Error, Lang, Quaternion, Vec3, Ypr, math, vector};
use shisei_record::motive::{self, LossRule, Take};
use shisei_record::{Input, Recording};

use crate::args::Reading;
use crate::args_fuse::{Fuse, ModeName, SyncName};
use crate::cmd::fuse::{Done, How};
use crate::fail::{Exit, Failure, Outcome, say};
use crate::input::{self, Source};

/// A repeated motion: the next best offset explains nearly as much.
const AMBIGUOUS: f64 = 0.95;
/// Up of the sensor this far from the take's up is worth a word, rad (2°).
const LEAN_RAD: f64 = 0.035;
/// So is a tool that stands this far from where its sensor's axes would be, rad (20°).
const TILT_OFF_RAD: f64 = 0.35;

/// Reads both sides and brings them together.
pub fn fused(args: &Fuse, lang: Lang) -> Outcome<Done> {
    check_usage(args, lang)?;
    let name = args.optical.display().to_string();
    let bytes = input::read(&args.optical, lang)?;
    let refuse = |error: motive::Error| Failure::input(error.sentence(lang));
    let take = motive::read(&Input { name: &name, bytes: &bytes }).map_err(refuse)?;
    let body = take.body(args.parent.as_deref().or(args.body.as_deref())).map_err(refuse)?;
    let time_s = take.time_s().map_err(refuse)?;
    let rule = LossRule { frozen_run: (args.frozen > 0).then_some(args.frozen) };
    let tracked = take.tracked(&body, rule);
    let poses: Vec<Option<Pose>> =
        (0..take.len()).map(|row| take.pose(&body, row).filter(|_| tracked[row])).collect();
    let recording = recording(args, lang)?;
    let sensor_s = sensor_s(args, &take, &recording, lang)?;
    // samples outside the gate have no frame
    let kept: Vec<usize> = (0..sensor_s.len()).filter(|&row| sensor_s[row].is_finite()).collect();
    let pick = |rows: &[[f64; 3]]| kept.iter().map(|&row| rows[row]).collect::<Vec<_>>();
    let (acc, gyro) = (pick(&recording.acc_m_s2), pick(&recording.gyro_rad_s));
    let sensor_s: Vec<f64> = kept.iter().map(|&row| sensor_s[row]).collect();
    let from = take.axes();
    let optical = Optical { time_s: &time_s, poses: &poses };
    let inertial = Inertial { time_s: &sensor_s, acc_m_s2: &acc, gyro_rad_s: &gyro };
    let failed = |error| Failure::core(&format!("{name}, {}", shown(args)), error, lang);
    let (frames, gaps, how, mut warnings);
    if args.mode == ModeName::Relative {
        let settings = held(args, &take, from, lang)?;
        let found = relative(&optical, &inertial, &settings).map_err(|error| match args.reference {
            Some(frame) if matches!(error, Error::NoReference { .. }) => {
                Failure::core(&format!("{name}, --reference {frame}"), error, lang)
            }
            _ => failed(error),
        })?;
        warnings = notes(&take, &recording, lang);
        warnings.extend(tilt_warning(found.tilt_off_rad, lang));
        how = How::Held {
            reference: take.frame[found.reference],
            grip_m: settings.grip_m,
            tilt_off_rad: found.tilt_off_rad,
        };
        (frames, gaps) = (found.frames, found.gaps);
    } else {
        let start = if args.sync == SyncName::Rates { Start::Search } else { Start::Near(0.0) };
        let markers = take.markers_of(&body).map_err(refuse)?;
        let sightings: Vec<_> = markers.iter().map(|marker| take.sightings(marker, rule)).collect();
        let seen: Vec<&[Option<Vec3>]> = sightings.iter().map(Vec::as_slice).collect();
        let settings = FuseSettings {
            rates: RatesSettings { start, ..RatesSettings::default() },
            axes: from,
            gravity_m_s2: args.gravity,
            ..FuseSettings::default()
        };
        let fusion = fuse::fuse_with_markers(&optical, &seen, &inertial, &settings).map_err(failed)?;
        if args.sync != SyncName::Rates {
            check_sequence(&take, &fusion, lang)?;
        }
        warnings = all_warnings(&take, &recording, &fusion, lang);
        let names = markers.into_iter().map(|marker| marker.name);
        how = How::Bridged {
            sync: Box::new(fusion.sync),
            lever: fusion.lever,
            up: fusion.up,
            markers: names.zip(fusion.held.places).collect(),
            held: fusion.held.frames.iter().filter(|held| **held).count(),
        };
        (frames, gaps) = (fusion.frames, fusion.gaps);
    }
    let to = args.axes.as_deref().and_then(Axes::from_name).unwrap_or(from);
    let level = from.to(Axes::ZUp);
    let attitude = frames.iter().map(|frame| {
        let pose = frame.pose.and_then(|pose| level.world_of(pose.world_from_body).ok());
        pose.unwrap_or(Quaternion::new(f64::NAN, f64::NAN, f64::NAN, f64::NAN))
    });
    let attitude = attitude.collect();
    let name = match how {
        How::Bridged { .. } => body.name.clone(),
        How::Held { .. } => format!("{}_tool", body.name),
    };
    Ok(Done { take, body, name, time_s, frames, gaps, how, from, to, attitude, warnings })
}

/// Options that need or exclude each other.
fn check_usage(args: &Fuse, lang: Lang) -> Outcome<()> {
    let wrong = |en: &str, ja: &str| Err(Failure::input(say(lang, en, ja)));
    let held = args.mode == ModeName::Relative;
    if !held && (args.parent.is_some() || args.grip.is_some() || args.reference.is_some()) {
        return wrong(
            "--parent, --grip and --reference belong to --mode relative; for a body with a sensor on it give --body",
            "--parent、--grip、--reference は --mode relative で使います。センサを付けた剛体は --body で指定してください",
        );
    }
    if held && args.sync == SyncName::Rates {
        return wrong(
            "with --mode relative the sensor is not on the body that the cameras see, so its rotation tells nothing of the clocks; give --sync sequence or --sync pulse-file",
            "--mode relative では、カメラに写る剛体とセンサの回転が異なるため、回転から時刻を合わせられません。--sync sequence か --sync pulse-file を指定してください",
        );
    }
    if held && args.motive.is_some() {
        return wrong(
            "--motive fills the gaps of a body; with --mode relative the tool is no body of the take; use -o",
            "--motive は剛体の欠落を補うものです。--mode relative の道具はテイクの剛体ではないため、-o を使ってください",
        );
    }
    match (args.sync == SyncName::PulseFile, &args.pulses) {
        (true, None) => wrong(
            "--sync pulse-file needs --pulses FILE: the time of each camera pulse in seconds, one a row",
            "--sync pulse-file には --pulses FILE が必要です。各カメラパルスの時刻を秒で 1 行に 1 つ書いたファイルです",
        ),
        (false, Some(_)) => {
            wrong("--pulses belongs to --sync pulse-file", "--pulses は --sync pulse-file で使います")
        }
        _ => Ok(()),
    }
}

/// Times of the samples: the recording's own, or on the take's clock, NaN where a sample has no frame.
fn sensor_s(args: &Fuse, take: &Take, recording: &Recording, lang: Lang) -> Outcome<Vec<f64>> {
    let condition = |error: motive::Error| Failure { exit: Exit::Condition, sentence: error.sentence(lang) };
    match (args.sync, &args.pulses) {
        (SyncName::Sequence, _) => {
            take.sequence_s(&sequence(recording, &shown(args), lang)?).map_err(condition)
        }
        (SyncName::PulseFile, Some(path)) => {
            let (name, bytes) = (path.display().to_string(), input::read(path, lang)?);
            let pulses = motive::read_pulses(&Input { name: &name, bytes: &bytes })
                .map_err(|error| Failure::input(error.sentence(lang)))?;
            take.pulses_s(&pulses, &recording.time_s).map_err(condition)
        }
        _ => Ok(recording.time_s.clone()),
    }
}

fn shown(args: &Fuse) -> String {
    Source { paths: args.imu.clone() }.shown()
}

/// How the tool is held.
fn held(args: &Fuse, take: &Take, axes: Axes, lang: Lang) -> Outcome<RelativeSettings> {
    let grip = args.grip.unwrap_or_default();
    let [yaw_rad, pitch_rad, roll_rad] = grip.ypr_deg.map(f64::to_radians);
    let reference = match args.reference {
        None => None,
        Some(frame) => Some(take.frame.binary_search(&frame).map_err(|_| {
            Failure::input(say(
                lang,
                format!("{}: the take has no frame {frame}; give one of its frames with --reference", take.file),
                format!("{}：フレーム {frame} はテイクにありません。--reference にはテイクのフレームを指定してください", take.file),
            ))
        })?),
    };
    Ok(RelativeSettings {
        grip_m: grip.at_m,
        grip: Quaternion::from_ypr(Ypr { yaw_rad, pitch_rad, roll_rad }),
        reference,
        axes,
        gravity_m_s2: args.gravity,
        ..RelativeSettings::default()
    })
}

fn tilt_warning(off_rad: f64, lang: Lang) -> Option<String> {
    let degrees = off_rad.to_degrees();
    (off_rad > TILT_OFF_RAD).then(|| {
        say(
            lang,
            format!("at the reference frame the tool's tilt differs by {degrees:.0}° from what its sensor says; say with --grip how the sensor is turned in the parent, or choose another --reference"),
            format!("基準フレームで、道具の傾きがセンサの示す傾きと {degrees:.0}° 違います。--grip で親に対するセンサの向きを指定するか、別の --reference を選んでください"),
        )
    })
}

fn notes(take: &Take, recording: &Recording, lang: Lang) -> Vec<String> {
    take.warnings.iter().chain(&recording.warnings).map(|note| note.sentence(lang).to_owned()).collect()
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
    // Begun before the recording gate rose, a take has pulses from the receiver's start at first; the cameras count from
    // the gate.
    let gate = recording.extra.iter().find(|extra| extra.name.eq_ignore_ascii_case("from_gate"));
    let counted =
        |row: usize| gate.and_then(|gate| gate.cells.get(row)).is_some_and(|cell| cell.trim() == "true");
    let gated = (0..extra.cells.len()).any(counted);
    let frames = extra.cells.iter().enumerate().map(|(row, cell)| {
        let frame = cell.trim().parse().unwrap_or(f64::NAN);
        if gated && !counted(row) { f64::NAN } else { frame }
    });
    Ok(frames.collect())
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

fn all_warnings(take: &Take, recording: &Recording, fusion: &Fusion, lang: Lang) -> Vec<String> {
    let mut all = notes(take, recording, lang);
    let (sync, from) = (&fusion.sync, take.axes());
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
