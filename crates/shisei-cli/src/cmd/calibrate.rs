//! `shisei calibrate`: accelerometer bias and scale and gyroscope bias from rests on six faces.

use std::path::PathBuf;

use serde_json::{Value, json};
use shisei_core::calibration::{
    self, Calibration, FaceRow, FaceState, FaceTable, SensorModel, SixFace, SixFaceSettings,
};
use shisei_core::{Lang, math};
use shisei_record::Recording;
use shisei_record::calibration::CalibrationFile;

use crate::args::{Calibrate, CalibrationMethod};
use crate::fail::{Failure, Outcome, say};
use crate::input::{self, Source};
use crate::output::{Kind, Writer, is_stdout};
use crate::summary::{self, padded};

const RAD_PER_DEG: f64 = std::f64::consts::PI / 180.0;

/// Runs the command.
pub fn run(args: &Calibrate, lang: Lang) -> Outcome<()> {
    refuse_unused(args, lang)?;
    if args.method != CalibrationMethod::SixFace {
        return super::calibrate_poses::run(args, lang);
    }
    let options = input::options(&args.reading, lang)?;
    let source = Source { paths: args.files.clone() };
    let output =
        args.output.clone().unwrap_or_else(|| PathBuf::from(format!("{}.calibration.json", source.stem())));
    let writer = Writer::new(args.force, lang, &args.files);
    writer.check_all(&[(&output, Kind::Calibration)])?;
    let recording = input::open(&source, &options, lang).map_err(|error| error.failure(lang))?;
    let usual = SixFaceSettings::default();
    let settings = SixFaceSettings {
        window_s: args.window.unwrap_or(usual.window_s),
        step_s: args.step.unwrap_or(usual.step_s),
        max_tilt_rad: args.max_tilt.unwrap_or(15.0) * RAD_PER_DEG,
        variance_max: args.var_threshold.unwrap_or(usual.variance_max),
        gravity_m_s2: args.gravity,
        ..usual
    };
    let shown = source.shown();
    let core = |error| Failure::core(&shown, error, lang);
    let dt_s = 1.0 / recording.findings.rate_hz;
    let table = calibration::search_faces(&recording.acc_m_s2, &recording.gyro_rad_s, dt_s, &settings)
        .map_err(core)?;
    eprint!("{}", table_text(&table, &recording, lang));
    if table.missing().next().is_some() {
        return Err(missing(&shown, &table, &settings, lang));
    }
    let found = calibration::solve(&table, &settings).map_err(core)?;
    let file = document(args, &found, &recording);
    writer.write(&output, Kind::Calibration, |out| out.write_all(file.to_json().as_bytes()))?;
    if args.json && !is_stdout(&output) {
        print!("{}", file.to_json());
    }
    eprint!("{}", result_text(&found, lang));
    eprint!("{}", summary::of_notes(&recording, lang));
    if !is_stdout(&output) {
        eprintln!("→ {}", output.display());
    }
    Ok(())
}

/// An option that the method does not use would be believed to have done something.
fn refuse_unused(args: &Calibrate, lang: Lang) -> Outcome<()> {
    let six_face = args.method == CalibrationMethod::SixFace;
    let unused = [
        ("--turns", args.turns.is_some() && args.method != CalibrationMethod::GyroTurns),
        ("--window", args.window.is_some() && !six_face),
        ("--step", args.step.is_some() && !six_face),
        ("--max-tilt", args.max_tilt.is_some() && !six_face),
        ("--var-threshold", args.var_threshold.is_some() && !six_face),
    ];
    let Some((name, _)) = unused.into_iter().find(|(_, unused)| *unused) else { return Ok(()) };
    let method = match args.method {
        CalibrationMethod::SixFace => "six-face",
        CalibrationMethod::MultiPose => "multi-pose",
        CalibrationMethod::GyroTurns => "gyro-turns",
    };
    Err(Failure::input(say(
        lang,
        format!("{name} has no meaning for --method {method}; leave it out or choose another method"),
        format!("{name} は --method {method} では使えません。外すか、別の方法を選んでください"),
    )))
}

fn time_of(recording: &Recording, row: usize) -> f64 {
    recording.time_s.get(row).copied().unwrap_or_default()
}

/// A row a face: where it was found, or what came nearest.
fn table_text(table: &FaceTable, recording: &Recording, lang: Lang) -> String {
    let head = say(
        lang,
        "  face  state       start s   variance   tilt °    |a| m/s²\n",
        "  面    状態        開始 s    分散       傾き °    |a| m/s²\n",
    );
    let rows: String = table
        .faces
        .iter()
        .map(|row| {
            let state = padded(&state_text(row.state, lang), 10);
            let numbers = row.window.map_or_else(String::new, |w| {
                format!(
                    "{:>9.2}  {:>9.6}  {:>7.2}  {:>10.4}",
                    time_of(recording, w.start_row),
                    w.worst_variance(),
                    w.tilt_rad / RAD_PER_DEG,
                    w.mean_norm()
                )
            });
            format!("  {}    {state}{numbers}\n", row.face)
        })
        .collect();
    head + &rows
}

fn state_text(state: FaceState, lang: Lang) -> String {
    match state {
        FaceState::Found => say(lang, "found", "あり"),
        FaceState::Unsteady => say(lang, "unsteady", "不安定"),
        FaceState::Tilted => say(lang, "tilted", "傾き大"),
        FaceState::NeverUp => say(lang, "never up", "なし"),
    }
}

fn missing(shown: &str, table: &FaceTable, settings: &SixFaceSettings, lang: Lang) -> Failure {
    let (window_s, limit) = (settings.window_s, settings.variance_max);
    let max_tilt = settings.max_tilt_rad / RAD_PER_DEG;
    let why = |row: &FaceRow| {
        let face = row.face;
        match (row.state, row.window) {
            (FaceState::Unsteady, Some(w)) => say(
                lang,
                format!(
                    "{face} was up but never still for {window_s} s (best variance {:.4}, needed {limit})",
                    w.worst_variance()
                ),
                format!(
                    "{face} は上を向きましたが、{window_s} 秒間静止していません (最小の分散 {:.4}、必要 {limit} 以下)",
                    w.worst_variance()
                ),
            ),
            (FaceState::Tilted, Some(w)) => say(
                lang,
                format!(
                    "{face} was still but tilted by {:.1}° (needed {max_tilt:.0}°)",
                    w.tilt_rad / RAD_PER_DEG
                ),
                format!(
                    "{face} は静止しましたが {:.1}° 傾いています (必要 {max_tilt:.0}° 以内)",
                    w.tilt_rad / RAD_PER_DEG
                ),
            ),
            _ => say(lang, format!("{face} was never up"), format!("{face} は一度も上を向いていません")),
        }
    };
    let list: Vec<String> = table.missing().map(why).collect();
    Failure::condition(say(
        lang,
        format!(
            "{shown}: not all six faces were found: {}; rest the sensor on each missing face for {window_s} s, or relax --var-threshold or --max-tilt",
            list.join("; ")
        ),
        format!(
            "{shown}：6 面がそろっていません。{}。足りない面を {window_s} 秒以上静止させて計測し直すか、--var-threshold または --max-tilt を緩めてください",
            list.join("、")
        ),
    ))
}

fn sigma_of(found: &SixFace) -> Calibration {
    let sd = |k: usize| math::sqrt(found.acc_covariance[k][k]);
    let gyro = found.gyro_bias_variance.map(math::sqrt);
    Calibration {
        accelerometer: SensorModel::from_bias_scale([sd(0), sd(1), sd(2)], [sd(3), sd(4), sd(5)]),
        gyroscope: SensorModel::from_bias_scale(gyro, [0.0; 3]),
    }
}

fn document(args: &Calibrate, found: &SixFace, recording: &Recording) -> CalibrationFile {
    let created = crate::calibration::now();
    let mut file = CalibrationFile::new(found.calibration, "six-face", args.gravity, &created);
    if let Some(sensor) =
        args.sensor_id.clone().or_else(|| (!recording.sensor.is_empty()).then(|| recording.sensor.clone()))
    {
        file.set("sensor", json!(sensor));
    }
    if let Some(temperatures) = recording.temp_c.as_ref().filter(|all| !all.is_empty()) {
        let mean = temperatures.iter().sum::<f64>() / temperatures.len() as f64;
        file.set("temperature_c", json!(mean));
    }
    file.set_sigma(&sigma_of(found));
    let order = ["acc_bias_x", "acc_bias_y", "acc_bias_z", "acc_scale_x", "acc_scale_y", "acc_scale_z"];
    file.set("covariance", json!({ "order": order, "values": found.acc_covariance }));
    let faces: Vec<Value> = found
        .table
        .faces
        .iter()
        .filter_map(|row| {
            let w = row.window?;
            Some(json!({
                "face": row.face.to_string(),
                "start_s": time_of(recording, w.start_row),
                "worst_variance": w.worst_variance(),
                "tilt_rad": w.tilt_rad,
                "norm_before_m_s2": w.mean_norm(),
                "norm_after_m_s2": shisei_core::vector::norm(found.calibration.accelerometer.apply(w.acc_mean)),
            }))
        })
        .collect();
    file.set("checks", json!({ "faces": faces }));
    file
}

fn result_text(found: &SixFace, lang: Lang) -> String {
    let sigma = sigma_of(found);
    let (a, g) = (&found.calibration.accelerometer, &found.calibration.gyroscope);
    let line = |en: &str, ja: &str, value: [f64; 3], sd: [f64; 3], digits: usize, unit: &str| {
        let part = |k: usize| format!("{:.digits$} ± {:.digits$}", value[k], sd[k]);
        format!("  {}{}, {}, {} {unit}\n", padded(&say(lang, en, ja), 24), part(0), part(1), part(2))
    };
    [
        line("Accelerometer bias", "加速度のバイアス", a.bias, sigma.accelerometer.bias, 5, "m/s²"),
        line("Accelerometer scale", "加速度のスケール", a.scale(), sigma.accelerometer.scale(), 6, ""),
        line("Gyroscope bias", "ジャイロのバイアス", g.bias, sigma.gyroscope.bias, 6, "rad/s"),
    ]
    .concat()
}
