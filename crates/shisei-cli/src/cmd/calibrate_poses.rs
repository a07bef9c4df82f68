//! `shisei calibrate --method multi-pose|gyro-turns`: nine parameters from many poses, the gyroscope's matrix.

use std::path::PathBuf;

use serde_json::{Value, json};
use shisei_core::calibration::gyro_turns::{self, GyroTurns, TurnSettings};
use shisei_core::calibration::known_turns::{self, Part, Parts, TurnAngle};
use shisei_core::calibration::multi_pose::{PARAMETER_NAMES, SigmaSource};
use shisei_core::calibration::recording::{PosesFound, calibrate_poses, find_parts};
use shisei_core::calibration::still::{StillSettings, still_segments};
use shisei_core::calibration::{Calibration, SensorModel};
use shisei_core::{Error, Lang, Vec3, math, vector};
use shisei_record::Recording;
use shisei_record::calibration::CalibrationFile;
use shisei_report::figure::{Figure, Item};
use shisei_report::page::{Block, Page};
use shisei_report::plot::{Axis, Tone};

use crate::args::{Calibrate, CalibrationMethod};
use crate::fail::{Failure, Outcome, say};
use crate::input::{self, Source};
use crate::output::{Kind, Writer, is_stdout};
use crate::summary;

/// A calibration with what is told about it.
struct Found {
    file: CalibrationFile,
    lines: Vec<String>,
    warnings: Vec<String>,
    figure: Option<Block>,
}

/// Runs the command.
pub fn run(args: &Calibrate, lang: Lang) -> Outcome<()> {
    let mut options = input::options(&args.reading, lang)?;
    options.counts_ok = true;
    options.keep = vec!["*".to_owned()];
    let source = Source { paths: args.files.clone() };
    let stem = source.stem();
    let output = args.output.clone().unwrap_or_else(|| PathBuf::from(format!("{stem}.calibration.json")));
    let report = args.report.or(format!("{stem}.calibration.html"));
    let writer = Writer::new(args.force, lang, &args.files);
    let html = report.as_deref().map(|report| (report, Kind::Html));
    writer.check_all(&[(output.as_path(), Kind::Calibration)].into_iter().chain(html).collect::<Vec<_>>())?;
    let recording = input::open(&source, &options, lang).map_err(|error| error.failure(lang))?;
    let shown = source.shown();
    let core = |error| refused(&shown, error, args, lang);
    let found = match (args.method, args.turns) {
        (CalibrationMethod::GyroTurns, Some(degrees)) => {
            known(args, &recording, degrees, lang).map_err(core)?
        }
        (method, _) => poses(args, &recording, method == CalibrationMethod::GyroTurns, lang).map_err(core)?,
    };
    writer.write(&output, Kind::Calibration, |out| out.write_all(found.file.to_json().as_bytes()))?;
    if args.json && !is_stdout(&output) {
        print!("{}", found.file.to_json());
    }
    eprint!("{}", summary::of_notes(&recording, lang));
    for line in found.lines.iter().chain(&found.warnings) {
        eprintln!("  {line}");
    }
    if let Some(path) = &report {
        let page = Page {
            lang,
            title: say(lang, "Calibration", "キャリブレーション"),
            sources: vec![shown.clone()],
            facts: Vec::new(),
            warnings: recording
                .warnings
                .iter()
                .map(|note| note.sentence(lang).to_owned())
                .chain(found.warnings)
                .collect(),
            plots: Vec::new(),
            attitude: None,
            blocks: found
                .figure
                .into_iter()
                .chain([Block::List { heading: say(lang, "Result", "結果"), items: found.lines }])
                .collect(),
            generator: concat!("shisei ", env!("CARGO_PKG_VERSION")).to_owned(),
        }
        .to_html();
        writer.write(path, Kind::Html, |out| out.write_all(page.as_bytes()))?;
    }
    for path in [Some(&output), report.as_ref()].into_iter().flatten().filter(|p| !is_stdout(p)) {
        eprintln!("→ {}", path.display());
    }
    Ok(())
}

fn refused(shown: &str, error: Error, args: &Calibrate, lang: Lang) -> Failure {
    if let (Some(_), Error::FaceMissing { face }) = (args.turns, error) {
        return Failure::condition(say(
            lang,
            format!(
                "{shown}: no rest with {face} up was found; needed are rests on all six faces and one turn about each axis between two rests on the same face"
            ),
            format!(
                "{shown}：{face} を上にした静止が見つかりません。6 面の静止と、同じ面での静止の間の各軸 1 回の回転が必要です"
            ),
        ));
    }
    let mut failure = Failure::core(shown, error, lang);
    let hint = match (args.turns.is_some(), error) {
        (true, _) => say(
            lang,
            "; needed are rests on all six faces and one turn about each axis between two rests on the same face",
            "。6 面の静止と、同じ面での静止の間の各軸 1 回の回転が必要です",
        ),
        (false, Error::TooFewPoints { .. } | Error::Degenerate) => say(
            lang,
            "; rest the sensor for 1 s or more in 12 poses or more that point in all directions",
            "。全方向に向けた 12 以上の姿勢で、それぞれ 1 秒以上静止させてください",
        ),
        _ => String::new(),
    };
    failure.sentence.push_str(&hint);
    failure
}

fn new_file(
    args: &Calibrate,
    calibration: Calibration,
    method: &str,
    recording: &Recording,
) -> CalibrationFile {
    let created = crate::calibration::now();
    let mut file = CalibrationFile::new(calibration, method, args.gravity, &created);
    if let Some(sensor) =
        args.sensor_id.clone().or_else(|| (!recording.sensor.is_empty()).then(|| recording.sensor.clone()))
    {
        file.set("sensor", json!(sensor));
    }
    if let Some(temperatures) = recording.temp_c.as_ref().filter(|all| !all.is_empty()) {
        file.set("temperature_c", json!(temperatures.iter().sum::<f64>() / temperatures.len() as f64));
    }
    file
}

fn triple(v: Vec3, sigma: Vec3, unit: &str) -> String {
    let part = |k: usize| format!("{:.6} ± {:.6}", v[k], sigma[k]);
    format!("{}, {}, {} {unit}", part(0), part(1), part(2))
}

fn matrix_text(m: &[[f64; 3]; 3]) -> String {
    let row = |r: &[f64; 3]| format!("{:.6e} {:.6e} {:.6e}", r[0], r[1], r[2]);
    format!("[{}; {}; {}]", row(&m[0]), row(&m[1]), row(&m[2]))
}

fn poses(args: &Calibrate, recording: &Recording, turns: bool, lang: Lang) -> Result<Found, Error> {
    let dt_s = 1.0 / recording.findings.rate_hz;
    let (acc, gyro) = (&recording.acc_m_s2, &recording.gyro_rad_s);
    let found = calibrate_poses(acc, gyro, dt_s, args.gravity, None)?;
    let c = &found.calibration;
    let s = &c.sigma;
    let acc_sigma = SensorModel {
        bias: [s[0], s[1], s[2]],
        matrix: [[s[3], s[4], s[5]], [0.0, s[6], s[7]], [0.0, 0.0, s[8]]],
    };
    let gyro_part: Option<GyroTurns> = if turns {
        Some(gyro_turns::calibrate(gyro, dt_s, &found.segments, &c.accelerometer, &TurnSettings::default())?)
    } else {
        None
    };
    let (gyroscope, gyro_sigma) = match &gyro_part {
        Some(g) => {
            let v = &g.sigma;
            let matrix = [[v[0], v[1], v[2]], [v[3], v[4], v[5]], [v[6], v[7], v[8]]];
            (g.gyroscope, SensorModel { bias: g.bias_sigma, matrix })
        }
        None => bias_only(&found),
    };
    let calibration = Calibration { accelerometer: c.accelerometer, gyroscope };
    let method = if turns { "gyro-turns" } else { "multi-pose" };
    let mut file = new_file(args, calibration, method, recording);
    file.set_sigma(&Calibration { accelerometer: acc_sigma, gyroscope: gyro_sigma });
    let order: Vec<String> = PARAMETER_NAMES.iter().map(|n| format!("acc_{n}")).collect();
    file.set("covariance", json!({ "order": order, "values": c.covariance }));
    let suggestions = c.suggest(3);
    file.set(
        "checks",
        json!({
            "poses": found.segments.len(),
            "residual_rms_m_s2": c.residual_rms,
            "held_out_rms_m_s2": finite(c.held_out_rms),
            "sigma_from": if c.sigma_source == SigmaSource::Residuals { "residuals" } else { "noise of the means" },
            "turn_residual_rms_rad": gyro_part.as_ref().map(|g| g.residual_rms_rad),
            "turn_held_out_rms_rad": gyro_part.as_ref().and_then(|g| g.held_out_rms_rad.is_finite().then_some(g.held_out_rms_rad)),
            "suggested_up": suggestions.iter().map(|s| json!(s.up_body)).collect::<Vec<Value>>(),
        }),
    );
    let mut lines = vec![
        say(
            lang,
            format!("{} still poses", found.segments.len()),
            format!("静止姿勢 {} 個", found.segments.len()),
        ),
        format!(
            "{}: {}",
            say(lang, "accelerometer bias", "加速度のバイアス"),
            triple(c.accelerometer.bias, acc_sigma.bias, "m/s²")
        ),
        format!(
            "{}: {}",
            say(lang, "accelerometer matrix", "加速度の行列"),
            matrix_text(&c.accelerometer.matrix)
        ),
        format!(
            "{}: {}",
            say(lang, "gyroscope bias", "ジャイロのバイアス"),
            triple(gyroscope.bias, gyro_sigma.bias, "rad/s")
        ),
        format!(
            "{}: {:.5} m/s², {}: {:.5} m/s²",
            say(lang, "residual", "残差"),
            c.residual_rms,
            say(lang, "on poses held out", "除外した姿勢での残差"),
            c.held_out_rms
        ),
    ];
    if let Some(g) = &gyro_part {
        lines.push(format!(
            "{}: {}",
            say(lang, "gyroscope matrix", "ジャイロの行列"),
            matrix_text(&g.gyroscope.matrix)
        ));
        lines.push(format!(
            "{}: {:.3}°, {}: {:.3}°",
            say(lang, "direction after the turns off by", "回転後の向きのずれ"),
            g.residual_rms_rad.to_degrees(),
            say(lang, "on turns held out", "除外した回転でのずれ"),
            g.held_out_rms_rad.to_degrees()
        ));
    }
    let mut warnings = Vec::new();
    if c.sigma_source == SigmaSource::MeanNoise {
        warnings.push(say(
            lang,
            "as many poses as parameters: the residual says nothing, the errors are those of the means' noise only",
            "姿勢とパラメータが同数のため、残差からは何も分かりません。誤差は平均値の雑音のみによるものです",
        ));
    }
    for s in &suggestions {
        lines.push(say(
            lang,
            format!("add a pose with {} up: |a| is known there to {:.4} m/s² only; after it {:.4} m/s² or better everywhere", direction(s.up_body, lang), s.sigma_now, s.worst_sigma_after),
            format!("{} を上にした姿勢を追加してください。そこでの |a| の誤差は現在 {:.4} m/s²、追加後は全方向で {:.4} m/s² 以下になります", direction(s.up_body, lang), s.sigma_now, s.worst_sigma_after),
        ));
    }
    let figure = coverage(&found, &suggestions.iter().map(|s| s.up_body).collect::<Vec<_>>(), lang);
    Ok(Found { file, lines, warnings, figure: Some(figure) })
}

fn finite(v: f64) -> Value {
    if v.is_finite() { json!(v) } else { Value::Null }
}

/// Gyroscope bias over the rests, no matrix.
fn bias_only(found: &PosesFound) -> (SensorModel, SensorModel) {
    let n = found.segments.len() as f64;
    let (mut bias, mut sigma) = ([0.0; 3], [0.0; 3]);
    for i in 0..3 {
        bias[i] = found.segments.iter().map(|s| s.gyro_mean[i]).sum::<f64>() / n;
        let scatter: f64 =
            found.segments.iter().map(|s| (s.gyro_mean[i] - bias[i]) * (s.gyro_mean[i] - bias[i])).sum();
        sigma[i] = math::sqrt(scatter / ((n - 1.0).max(1.0) * n));
    }
    (SensorModel { bias, ..SensorModel::IDENTITY }, SensorModel { bias: sigma, matrix: [[0.0; 3]; 3] })
}

/// "+x", or "+x towards -y": a direction in words.
fn direction(up: Vec3, lang: Lang) -> String {
    let mut axes = [0, 1, 2];
    axes.sort_by(|a, b| up[*b].abs().total_cmp(&up[*a].abs()));
    let name = |i: usize| format!("{}{}", if up[i] < 0.0 { '-' } else { '+' }, ['x', 'y', 'z'][i]);
    let degrees = math::acos(up[axes[0]].abs().min(1.0)).to_degrees();
    if degrees < 10.0 {
        name(axes[0])
    } else {
        say(
            lang,
            format!("{} (tilted {degrees:.0}° towards {})", name(axes[0]), name(axes[1])),
            format!("{} ({} の方へ {degrees:.0}° 傾ける)", name(axes[0]), name(axes[1])),
        )
    }
}

/// Longitude and latitude of the directions that pointed up, and of those to add.
fn coverage(found: &PosesFound, add: &[Vec3], lang: Lang) -> Block {
    let on_map =
        |u: Vec3| [math::atan2(u[1], u[0]).to_degrees(), math::asin(u[2].clamp(-1.0, 1.0)).to_degrees()];
    let ups = found.segments.iter().filter_map(|s| {
        let a = found.calibration.accelerometer.apply(s.acc_mean);
        let n = vector::norm(a);
        (n > 0.0).then(|| on_map(vector::scale(a, 1.0 / n)))
    });
    let heading = say(lang, "Directions that pointed up", "上を向いた方向");
    let axes = [
        ([1.0, 0.0, 0.0], "+x"),
        ([-1.0, 0.0, 0.0], "-x"),
        ([0.0, 1.0, 0.0], "+y"),
        ([0.0, -1.0, 0.0], "-y"),
        ([0.0, 0.0, 1.0], "+z"),
        ([0.0, 0.0, -1.0], "-z"),
    ];
    Block::Figure {
        figure: Figure {
            description: heading.clone(),
            x: Axis::linear(
                &say(lang, "angle about z from +x towards +y", "+x から +y への z 軸まわりの角度"),
                "°",
            ),
            y: Axis::linear(&say(lang, "angle above the x-y plane", "x-y 平面からの角度"), "°"),
            equal: false,
            items: vec![
                Item::Dots {
                    points: axes.iter().map(|a| on_map(a.0)).collect(),
                    tone: Tone::Plain,
                    labels: axes.iter().map(|a| a.1.to_owned()).collect(),
                },
                Item::Dots { points: ups.collect(), tone: Tone::Z, labels: Vec::new() },
                Item::Dots {
                    points: add.iter().map(|u| on_map(*u)).collect(),
                    tone: Tone::X,
                    labels: Vec::new(),
                },
            ],
            legend: vec![
                (Tone::Z, say(lang, "measured", "計測済み")),
                (Tone::X, say(lang, "to add", "追加する姿勢")),
            ],
        },
        heading,
    }
}

/// Six faces and three known turns, from a `part` column (`x_p`, `x_a`, `x_rot` …) or found in the recording.
fn known(args: &Calibrate, recording: &Recording, degrees: f64, lang: Lang) -> Result<Found, Error> {
    let dt_s = 1.0 / recording.findings.rate_hz;
    let (acc, gyro) = (&recording.acc_m_s2, &recording.gyro_rad_s);
    let radians = degrees.to_radians();
    let angle = if degrees < 0.0 { TurnAngle::Signed(radians) } else { TurnAngle::Size(radians) };
    let labelled = labelled_rows(recording);
    let result = if let Some(rows) = &labelled {
        let part = |k: usize| Part { acc: &rows[k].0, gyro: &rows[k].1 };
        let parts = Parts {
            up: [part(0), part(1), part(2)],
            down: [part(3), part(4), part(5)],
            turn: [part(6), part(7), part(8)],
        };
        known_turns::calibrate(&parts, dt_s, angle, args.gravity)?
    } else {
        let segments = still_segments(acc, gyro, dt_s, &StillSettings::default())?;
        known_turns::calibrate(&find_parts(acc, gyro, &segments)?, dt_s, angle, args.gravity)?
    };
    let calibration = Calibration { accelerometer: result.accelerometer, gyroscope: result.gyroscope };
    let mut file = new_file(args, calibration, "gyro-turns", recording);
    file.set_sigma(&Calibration {
        accelerometer: SensorModel { bias: result.acc_bias_sigma, matrix: result.acc_matrix_sigma },
        gyroscope: SensorModel { bias: result.gyro_bias_sigma, matrix: result.gyro_matrix_sigma },
    });
    file.set(
        "checks",
        json!({ "turns_deg": degrees, "gyro_per_acceleration": result.gyro_per_acceleration }),
    );
    let lines = vec![
        format!(
            "{}: {}",
            say(lang, "accelerometer bias", "加速度のバイアス"),
            triple(result.accelerometer.bias, result.acc_bias_sigma, "")
        ),
        format!(
            "{}: {}",
            say(lang, "accelerometer matrix", "加速度の行列"),
            matrix_text(&result.accelerometer.matrix)
        ),
        format!(
            "{}: {}",
            say(lang, "gyroscope bias", "ジャイロのバイアス"),
            triple(result.gyroscope.bias, result.gyro_bias_sigma, "")
        ),
        format!(
            "{}: {}",
            say(lang, "gyroscope matrix", "ジャイロの行列"),
            matrix_text(&result.gyroscope.matrix)
        ),
        format!(
            "{}: {}",
            say(lang, "its standard errors, placement apart", "その標準誤差 (置き方の誤差を除く)"),
            matrix_text(&result.gyro_matrix_sigma)
        ),
    ];
    let warnings = vec![say(
        lang,
        "faces and turns are taken as true: errors of placement go into the matrices",
        "面と回転軸は正確とみなします。置き方の誤差は行列に入ります",
    )];
    Ok(Found { file, lines, warnings, figure: None })
}

/// The nine labelled parts, in the order up x y z, down x y z, turn x y z; none without such a column.
fn labelled_rows(recording: &Recording) -> Option<Vec<(Vec<Vec3>, Vec<Vec3>)>> {
    let names = ["x_p", "y_p", "z_p", "x_a", "y_a", "z_a", "x_rot", "y_rot", "z_rot"];
    let column = recording.extra.iter().find(|e| e.cells.iter().any(|c| &**c == "x_rot"))?;
    Some(
        names
            .iter()
            .map(|name| {
                (0..recording.acc_m_s2.len())
                    .filter(|k| column.cells.get(*k).is_some_and(|c| &**c == *name))
                    .map(|k| (recording.acc_m_s2[k], recording.gyro_rad_s[k]))
                    .unzip()
            })
            .collect(),
    )
}
