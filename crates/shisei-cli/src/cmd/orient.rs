//! `shisei orient`: a recording to yaw, pitch and roll.

use std::path::{Path, PathBuf};

use serde_json::{Value, json};
use shisei_core::filter::AdaptiveGain;
use shisei_core::orient::{self, Later, Method, Orientation, RestChoice};
use shisei_core::{Error, Lang, rest};
use shisei_record::calibration::CalibrationFile;
use shisei_record::{Options, Recording};
use shisei_wide::Vectors;

use crate::args::{FilterName, Orient, Relative};
use crate::calibration;
use crate::fail::{Failure, Outcome, say};
use crate::input::{self, Source, Unopened};
use crate::output::{self, Kind, Writer};
use crate::tables::{self, AngleRanges, Format};
use crate::threads::SideBySide;
use crate::{batch, summary};

const DEG_PER_RAD: f64 = 180.0 / std::f64::consts::PI;

/// Everything that is the same for all files of a run.
#[derive(Debug)]
pub struct Plan {
    pub args: Orient,
    pub options: Options,
    pub settings: orient::Settings,
    pub rest: Rest,
    pub calibration: Option<CalibrationFile>,
    pub writer: Writer,
    pub lang: Lang,
}

/// `--rest` as written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rest {
    Auto,
    Span(f64, f64),
    None,
}

/// What became of one recording.
#[derive(Debug)]
pub struct Done {
    pub source: Source,
    pub recording: Recording,
    /// Without the attitudes, save where they were drawn.
    pub orientation: Orientation,
    /// Least and greatest yaw, pitch, roll, rad.
    pub angle_ranges: AngleRanges,
    pub warnings: Vec<String>,
    pub outputs: Vec<PathBuf>,
}

/// Runs the command.
pub fn run(args: Orient, lang: Lang) -> Outcome<()> {
    let sources = input::expand(&args.files, lang)?;
    let plan = plan(args, lang)?;
    let sources = sources.joined(&plan.options, lang);
    if !sources.batch
        && let [source] = sources.list.as_slice()
    {
        let done = one(&plan, source, &Places::single(&plan, source)).map_err(|e| e.failure(lang))?;
        if plan.args.json {
            println!("{}", done.json(plan.lang));
        }
        eprint!("{}", summary::of_one(&plan, &done));
        return Ok(());
    }
    batch::run(&plan, sources.list)
}

/// Where one recording's results go.
#[derive(Debug)]
pub struct Places {
    pub csv: PathBuf,
    pub html: Option<PathBuf>,
    pub png: Option<PathBuf>,
    /// What the estimator learnt.
    pub learnt: Option<PathBuf>,
}

impl Places {
    fn single(plan: &Plan, source: &Source) -> Places {
        let stem = source.stem();
        let args = &plan.args;
        let csv = args.output.clone().unwrap_or_else(|| PathBuf::from(format!("{stem}.orientation.csv")));
        Places {
            csv,
            html: args.report.or(format!("{stem}.html")),
            png: args.plot.clone(),
            learnt: args.save_calibration.clone(),
        }
    }

    /// In a folder, for one of many.
    pub fn in_folder(plan: &Plan, folder: &Path, stem: &str) -> Places {
        Places {
            csv: folder.join(format!("{stem}.orientation.csv")),
            html: plan.args.report.or(folder.join(format!("{stem}.html"))),
            png: None,
            learnt: None,
        }
    }
}

fn plan(args: Orient, lang: Lang) -> Outcome<Plan> {
    let mut options = input::options(&args.reading, lang)?;
    if args.keep {
        options.keep = vec!["*".to_owned()];
    }
    let calibration = args.calibration.as_deref().map(|path| calibration::read(path, lang)).transpose()?;
    options.counts_ok = calibration.is_some();
    let method = method(&args, lang)?;
    // The estimator takes what it learnt itself, with its doubt; any other calibration corrects the readings.
    let sensor = calibration.as_ref().filter(|_| method.starts_in_motion()).and_then(CalibrationFile::learnt);
    let calibration = if sensor.is_some() { None } else { calibration };
    if args.save_calibration.is_some() && !method.starts_in_motion() {
        return Err(Failure::input(say(
            lang,
            "--save-calibration needs --filter shisei or shisei-online; the other filters learn nothing of the sensor",
            "--save-calibration は --filter shisei または shisei-online で使えます。他のフィルタはセンサの特性を学習しません",
        )));
    }
    let rest = parse_rest(&args.rest, lang)?;
    let settings = orient::Settings {
        method,
        rest: RestChoice::Auto,
        relative: match args.relative {
            Relative::World => orient::Relative::World,
            Relative::Body => orient::Relative::Body,
            Relative::None => orient::Relative::None,
        },
        forward_axis_body: args.forward.as_deref().map(|text| parse_axis(text, lang)).transpose()?,
        gravity_m_s2: args.gravity,
        sensor,
    };
    let writer = Writer::new(args.force, lang, args.files.iter().chain(&args.calibration));
    Ok(Plan { args, options, settings, rest, calibration, writer, lang })
}

/// Computes and writes one recording; nothing is written unless everything could be computed.
pub fn one(plan: &Plan, source: &Source, places: &Places) -> Result<Done, Unopened> {
    let lang = plan.lang;
    let refuse = Unopened::File;
    let format = Format::of(&places.csv);
    let kind = format.kind(Kind::Orientation);
    let others = [(&places.html, Kind::Html), (&places.png, Kind::Png), (&places.learnt, Kind::Calibration)];
    let results: Vec<_> = std::iter::once((places.csv.as_path(), kind))
        .chain(others.into_iter().filter_map(|(path, kind)| Some((path.as_deref()?, kind))))
        .collect();
    plan.writer.check_all(&results).map_err(refuse)?;
    let mut recording = input::open(source, &plan.options, lang)?;
    if let Some(file) = &plan.calibration {
        calibration::apply(file, &mut recording, lang).map_err(refuse)?;
    }
    let (unit, factor) = if plan.args.degrees { ("deg", DEG_PER_RAD) } else { ("rad", 1.0) };
    let names = tables::orientation_names(unit, plan.settings.method.starts_in_motion());
    tables::note_renamed(&mut recording, &names.iter().map(String::as_str).collect::<Vec<_>>());
    let (mut orientation, mut later) = compute(plan, source, &recording).map_err(refuse)?;
    let warnings = warnings(plan, &recording, &orientation);
    let drawn = places.html.is_some() || places.png.is_some();
    if drawn {
        let refused = |error| refuse(Failure::core(&source.shown(), error, lang));
        later.complete(&mut orientation).map_err(refused)?;
    }
    let ypr_rad = if drawn {
        Vectors::widest().ypr_rad(&orientation.world_from_body, orientation.start, orientation.relative)
    } else {
        Vec::new()
    };
    let report = summary::report(plan, source, &recording, &orientation, &ypr_rad, &warnings);

    // Everything is made under temporary names before anything is in its place.
    let drawn = |error: shisei_report::Error| refuse(Failure::input(error.message(lang)));
    let mut outputs = vec![places.csv.clone()];
    let mut staged = Vec::new();
    if let Some(path) = &places.html {
        let page = report.html().map_err(drawn)?;
        staged
            .push(plan.writer.stage(path, Kind::Html, |out| out.write_all(page.as_bytes())).map_err(refuse)?);
        outputs.push(path.clone());
    }
    if let Some(path) = &places.png {
        let picture = report.png().map_err(drawn)?;
        staged.push(plan.writer.stage(path, Kind::Png, |out| out.write_all(&picture)).map_err(refuse)?);
        outputs.push(path.clone());
    }
    if let (Some(path), Some(learnt)) = (&places.learnt, &orientation.learnt) {
        let text = calibration::learnt(learnt, plan.args.gravity).to_json();
        staged.push(
            plan.writer
                .stage(path, Kind::Calibration, |out| out.write_all(text.as_bytes()))
                .map_err(refuse)?,
        );
        outputs.push(path.clone());
    }
    let mut angle_ranges = AngleRanges::default();
    let table = |out: &mut dyn std::io::Write| {
        let attitudes = (&orientation, &mut later);
        angle_ranges = tables::orientation(out, format, &recording, attitudes, (unit, factor))?;
        Ok(())
    };
    staged.push(plan.writer.stage(&places.csv, kind, table).map_err(refuse)?);
    plan.writer.finish(staged).map_err(refuse)?;
    drop(later);
    Ok(Done { source: source.clone(), recording, orientation, angle_ranges, warnings, outputs })
}

fn compute<'a>(plan: &Plan, source: &Source, recording: &'a Recording) -> Outcome<(Orientation, Later<'a>)> {
    let lang = plan.lang;
    let choice = match plan.rest {
        Rest::Auto => RestChoice::Auto,
        Rest::None => RestChoice::None,
        Rest::Span(start_s, end_s) => {
            let rows = orient::rows_between(&recording.time_s, start_s, end_s);
            if rows.len() < rest::MIN_BIAS_SAMPLES {
                let (first, last) = (recording.time_s[0], recording.time_s[recording.len() - 1]);
                return Err(Failure::condition(say(
                    lang,
                    format!(
                        "{}: --rest {start_s}:{end_s} holds {} samples, at least {} are needed; the recording runs from {first:.2} to {last:.2} s",
                        source.shown(),
                        rows.len(),
                        rest::MIN_BIAS_SAMPLES
                    ),
                    format!(
                        "{}：--rest {start_s}:{end_s} に含まれるのは {} サンプルです ({} 以上必要)。記録は {first:.2}〜{last:.2} 秒です",
                        source.shown(),
                        rows.len(),
                        rest::MIN_BIAS_SAMPLES
                    ),
                )));
            }
            RestChoice::Rows { start: rows.start, end: rows.end }
        }
    };
    let settings = orient::Settings { rest: choice, ..plan.settings };
    let (acc, gyro, dt) = (&recording.acc_m_s2, &recording.gyro_rad_s, &recording.dt_s);
    orient::begin(acc, gyro, dt, &settings, &SideBySide).map_err(|error| {
        if let Error::NoRest { needed_s } = error {
            return Failure::condition(say(
                lang,
                format!(
                    "{}: no rest of {needed_s} s was found, so there is no gyroscope bias and no start; keep the sensor still for a few seconds, name the rest with --rest START:END, or go without with --rest none",
                    source.shown()
                ),
                format!(
                    "{}：{needed_s} 秒以上の静止区間が見つからず、ジャイロのバイアスと初期姿勢を決められません。センサを数秒間静止させて計測するか、--rest START:END で区間を指定するか、--rest none を指定してください",
                    source.shown()
                ),
            ));
        }
        Failure::core(&source.shown(), error, lang)
    })
}

fn warnings(plan: &Plan, recording: &Recording, orientation: &Orientation) -> Vec<String> {
    let lang = plan.lang;
    let mut all: Vec<String> = recording.warnings.iter().map(|note| note.sentence(lang).to_owned()).collect();
    let forward_said = plan.settings.forward_axis_body.is_some();
    let doubts = shisei_record::doubts_of_attitudes(orientation.start, forward_said, plan.args.gravity);
    all.extend(doubts.iter().map(|note| note.sentence(lang).to_owned()));
    if let Some(range) = &orientation.rest {
        let variance = rest::variance(&recording.gyro_rad_s[range.clone()]).unwrap_or([0.0; 3]);
        // A rest that was given, not found: 0.1 rad/s is far above any sensor's noise and a person's sway.
        if matches!(plan.rest, Rest::Span(..)) && variance.iter().any(|&v| v > 0.01) {
            all.push(say(
                lang,
                "the sensor moves in the rest given with --rest; the bias and the start are not to be trusted",
                "--rest で指定した区間でセンサが動いています。バイアスと初期姿勢は信頼できません",
            ));
        }
    }
    all
}

fn method(args: &Orient, lang: Lang) -> Outcome<Method> {
    let ki = args.ki.unwrap_or(0.0);
    let method = match args.filter {
        FilterName::Shisei => Method::Estimate,
        FilterName::ShiseiOnline => Method::EstimateOnline,
        FilterName::Gyro => Method::Gyro,
        FilterName::GyroRk4 => Method::GyroRk4,
        FilterName::Mahony => Method::Mahony { kp: args.kp.unwrap_or(0.2), ki },
        FilterName::MahonyAdaptive => {
            let mut gain = AdaptiveGain::default();
            gain.kp_max = args.kp.unwrap_or(gain.kp_max);
            gain.kp_min = args.kp_min.unwrap_or(gain.kp_min);
            if let Some(text) = &args.accel_limits {
                let values: Vec<f64> = text.split(',').filter_map(|part| part.trim().parse().ok()).collect();
                let [lower_end, lower_start, upper_start, upper_end] = values[..] else {
                    return Err(bad_option("--accel-limits", text, "4.9,9.3,10.3,14.7", lang));
                };
                gain = AdaptiveGain { lower_end, lower_start, upper_start, upper_end, ..gain };
            }
            Method::MahonyAdaptive { gain, ki }
        }
        FilterName::Complementary => {
            Method::Complementary { alpha: args.alpha.unwrap_or(shisei_core::filter::DEFAULT_ALPHA) }
        }
    };
    let unused = match args.filter {
        FilterName::Mahony => vec![
            ("--kp-min", args.kp_min.is_some()),
            ("--accel-limits", args.accel_limits.is_some()),
            ("--alpha", args.alpha.is_some()),
        ],
        FilterName::MahonyAdaptive => vec![("--alpha", args.alpha.is_some())],
        _ => vec![
            ("--kp", args.kp.is_some()),
            ("--ki", args.ki.is_some()),
            ("--kp-min", args.kp_min.is_some()),
            ("--accel-limits", args.accel_limits.is_some()),
            ("--alpha", args.alpha.is_some() && args.filter != FilterName::Complementary),
        ],
    };
    if let Some((name, _)) = unused.into_iter().find(|(_, given)| *given) {
        let filter = args.filter.name();
        return Err(Failure::input(say(
            lang,
            format!("{name} has no meaning for --filter {filter}; leave it out or choose another filter"),
            format!("{name} は --filter {filter} では使えません。外すか、別のフィルタを選んでください"),
        )));
    }
    Ok(method)
}

fn parse_rest(text: &str, lang: Lang) -> Outcome<Rest> {
    match text {
        "auto" => return Ok(Rest::Auto),
        "none" => return Ok(Rest::None),
        _ => {}
    }
    let bad = || bad_option("--rest", text, "auto, none, 0:3", lang);
    let (start, end) = text.split_once(':').ok_or_else(bad)?;
    let number = |part: &str| part.trim().parse::<f64>().ok().filter(|v| v.is_finite());
    match (number(start), number(end)) {
        (Some(start), Some(end)) if start < end => Ok(Rest::Span(start, end)),
        _ => Err(bad()),
    }
}

fn parse_axis(text: &str, lang: Lang) -> Outcome<[f64; 3]> {
    let lower = text.trim().to_lowercase();
    let (sign, name) = match lower.strip_prefix('-') {
        Some(name) => (-1.0, name),
        None => (1.0, lower.strip_prefix('+').unwrap_or(&lower)),
    };
    match name {
        "x" => Ok([sign, 0.0, 0.0]),
        "y" => Ok([0.0, sign, 0.0]),
        "z" => Ok([0.0, 0.0, sign]),
        _ => Err(bad_option("--forward", text, "x, -x, y, -y, z, -z", lang)),
    }
}

fn bad_option(name: &str, value: &str, expected: &str, lang: Lang) -> Failure {
    Failure::input(say(
        lang,
        format!("{name} {value} is not understood; expected: {expected}"),
        format!("{name} {value} を解釈できません。例: {expected}"),
    ))
}

impl Done {
    /// The result as one JSON object.
    pub fn json(&self, lang: Lang) -> Value {
        let found = &self.recording.findings;
        let rest = self.orientation.rest.as_ref().map(|range| {
            let time = |k: usize| self.recording.time_s.get(k).copied();
            json!({ "start_s": time(range.start), "end_s": time(range.end.saturating_sub(1)) })
        });
        let outputs: Vec<String> =
            self.outputs.iter().filter(|p| !output::is_stdout(p)).map(|p| p.display().to_string()).collect();
        json!({
            "input": self.source.shown(),
            "dialect": self.recording.dialect,
            "samples": self.recording.len(),
            "rate_hz": found.rate_hz,
            "duration_s": found.duration_s,
            "rest": rest,
            "gyro_bias_rad_s": self.orientation.gyro_bias_rad_s,
            "start_q_wxyz": self.orientation.start.to_array(),
            "assumptions": summary::notes_json(&self.recording.assumptions, lang),
            "warnings": self.warnings,
            "outputs": outputs,
        })
    }
}
