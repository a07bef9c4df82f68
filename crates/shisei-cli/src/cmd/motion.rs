//! `shisei motion`: velocity and position with an error band.

use std::io::{self, Write};
use std::path::PathBuf;

use serde_json::json;
use shisei_core::filter::Dt;
use shisei_core::motion::Scheme;
use shisei_core::motion::foot::{FootSettings, foot};
use shisei_core::motion::navigation::{GivenEnd, NavigationSettings, Phase, Track};
use shisei_core::motion::rest_to_rest::{RestToRestSettings, rest_to_rest};
use shisei_core::motion::step_by_step::{StepByStepSettings, step_by_step};
use shisei_core::{Error, LARGEST_ACC_M_S2, LARGEST_RATE_RAD_S, Lang, Vec3, vector};
use shisei_record::Recording;
use shisei_report::column::Column;
use shisei_report::figure::{Figure, Item};
use shisei_report::page::{Block, Page};
use shisei_report::plot::{Axis, Mark, Plot, Series, SpanKind, Tone, spans};

use crate::args::{Motion, MotionMode, SchemeName};
use crate::calibration;
use crate::fail::{Failure, Outcome, say};
use crate::input::{self, Source};
use crate::output::{Kind, Writer, is_stdout};
use crate::summary;

/// How well a known end is known, m.
const END_SIGMA_M: f64 = 0.005;

/// Runs the command.
pub fn run(args: &Motion, lang: Lang) -> Outcome<()> {
    let options = input::options(&args.reading, lang)?;
    let source = Source { paths: args.files.clone() };
    let stem = source.stem();
    let output = args.output.clone().unwrap_or_else(|| PathBuf::from(format!("{stem}.motion.csv")));
    let report = args.report.or(format!("{stem}.motion.html"));
    let writer = Writer::new(args.force, lang, args.files.iter().chain(args.calibration.as_ref()));
    let html = report.as_deref().map(|report| (report, Kind::Html));
    writer.check_all(&[(output.as_path(), Kind::Motion)].into_iter().chain(html).collect::<Vec<_>>())?;
    refuse_unused(args, lang)?;
    let end = end_point(args, lang)?;
    let mut recording = input::open(&source, &options, lang).map_err(|error| error.failure(lang))?;
    if let Some(path) = &args.calibration {
        let file = calibration::read(path, lang)?;
        calibration::apply(&file, &mut recording, lang)?;
    }
    let track = track(args, &recording, end).map_err(|e| Failure::core(&source.shown(), e, lang))?;
    let warnings = doubts(args, &recording, &track, lang);
    writer.write(&output, Kind::Motion, |out| write_csv(out, &recording, &track))?;
    if let Some(path) = &report {
        let page = page(args, &recording, &track, warnings.clone(), &source.shown(), lang);
        writer.write(path, Kind::Html, |out| out.write_all(page.as_bytes()))?;
    }
    let last = track.position_m.len() - 1;
    let p = track.position_m[last];
    if args.json && !is_stdout(&output) {
        println!(
            "{}",
            json!({
                "mode": mode_name(args.mode),
                "rows": track.position_m.len(),
                "end_m": p,
                "sigma_end_m": track.sigma_total_m(last),
                "path_m": path_length(&track),
                "longest_without_rest_s": track.longest_without_rest_s,
                "output": output.display().to_string(),
            })
        );
    }
    let sigma = track.sigma_total_m(last);
    eprintln!(
        "{}",
        say(
            lang,
            format!(
                "end ({:.4}, {:.4}, {:.4}) m ± {sigma:.4} m (1 sigma); path {:.3} m; longest time without a rest {:.1} s",
                p[0],
                p[1],
                p[2],
                path_length(&track),
                track.longest_without_rest_s
            ),
            format!(
                "終点 ({:.4}, {:.4}, {:.4}) m ± {sigma:.4} m (1σ)。経路長 {:.3} m、静止のない最長時間 {:.1} 秒",
                p[0],
                p[1],
                p[2],
                path_length(&track),
                track.longest_without_rest_s
            ),
        )
    );
    let said = warnings.iter().map(String::as_str);
    eprint!("{}", summary::notes(&recording.assumptions, said, lang));
    for path in [Some(&output), report.as_ref()].into_iter().flatten().filter(|p| !is_stdout(p)) {
        eprintln!("→ {}", path.display());
    }
    Ok(())
}

fn mode_name(mode: MotionMode) -> &'static str {
    match mode {
        MotionMode::RestToRest => "rest-to-rest",
        MotionMode::Foot => "foot",
        MotionMode::Naive => "naive",
    }
}

/// An option that the mode does not use would be believed to have done something.
fn refuse_unused(args: &Motion, lang: Lang) -> Outcome<()> {
    let naive = args.mode == MotionMode::Naive;
    let unused = [
        ("--scheme", args.scheme.is_some() && !naive),
        ("--end", args.end.is_some() && naive),
        ("--closed", args.closed && naive),
    ];
    let Some((name, _)) = unused.into_iter().find(|(_, unused)| *unused) else { return Ok(()) };
    let mode = mode_name(args.mode);
    Err(Failure::input(say(
        lang,
        format!("{name} has no meaning for --mode {mode}; leave it out or choose another mode"),
        format!("{name} は --mode {mode} では使えません。外すか、別のモードを選んでください"),
    )))
}

fn end_point(args: &Motion, lang: Lang) -> Outcome<Option<(Vec3, f64)>> {
    if args.closed {
        return Ok(Some(([0.0; 3], END_SIGMA_M)));
    }
    let Some(text) = &args.end else { return Ok(None) };
    let numbers: Vec<f64> =
        text.split(',').filter_map(|n| n.trim().parse().ok()).filter(|n: &f64| n.is_finite()).collect();
    match numbers[..] {
        [x, y, z] if text.split(',').count() == 3 => Ok(Some(([x, y, z], END_SIGMA_M))),
        _ => Err(Failure::input(say(
            lang,
            format!("--end {text}: give three numbers in m, X,Y,Z"),
            format!("--end {text}：X,Y,Z を m 単位の 3 つの数値で指定してください"),
        ))),
    }
}

fn track(args: &Motion, recording: &Recording, end: Option<(Vec3, f64)>) -> Result<Track, Error> {
    let (acc, gyro) = (&recording.acc_m_s2, &recording.gyro_rad_s);
    let dt = Dt::PerSample(&recording.dt_s);
    let limit = |usual: f64| if args.force { f64::INFINITY } else { usual };
    let navigation = |usual: NavigationSettings| NavigationSettings {
        gravity_m_s2: args.gravity,
        end,
        max_end_distance: limit(usual.max_end_distance),
        max_hole_s: limit(usual.max_hole_s),
        ..usual
    };
    match args.mode {
        MotionMode::RestToRest => {
            let usual = RestToRestSettings::default();
            let navigation = navigation(usual.navigation);
            let max_without_rest_s = limit(usual.max_without_rest_s);
            rest_to_rest(acc, gyro, dt, &RestToRestSettings { navigation, max_without_rest_s, ..usual })
        }
        MotionMode::Foot => {
            let usual = FootSettings::default();
            let navigation = navigation(usual.navigation);
            let max_without_rest_s = limit(usual.max_without_rest_s);
            foot(acc, gyro, dt, &FootSettings { navigation, max_without_rest_s, ..usual })
        }
        MotionMode::Naive => {
            let usual = StepByStepSettings::default();
            let scheme = match args.scheme {
                Some(SchemeName::SemiImplicit) => Scheme::SemiImplicit,
                Some(SchemeName::Euler) => Scheme::Euler,
                Some(SchemeName::Trapezoid) => Scheme::Trapezoid,
                None => usual.scheme,
            };
            let max_without_rest_s = limit(usual.max_without_rest_s);
            let max_hole_s = limit(usual.max_hole_s);
            let gravity_m_s2 = args.gravity;
            let settings = StepByStepSettings { scheme, gravity_m_s2, max_without_rest_s, max_hole_s };
            step_by_step(acc, gyro, dt, &settings)
        }
    }
}

fn path_length(track: &Track) -> f64 {
    track.position_m.windows(2).map(|p| vector::norm(vector::sub(p[1], p[0]))).sum()
}

fn write_csv(out: &mut dyn Write, recording: &Recording, track: &Track) -> io::Result<()> {
    let mut buffer = zmij::Buffer::new();
    let mut line = b"time_s,vel_x,vel_y,vel_z,pos_x,pos_y,pos_z,sigma_pos_m\n".to_vec();
    for (k, &time_s) in recording.time_s.iter().enumerate() {
        let (v, p) = (track.velocity_m_s[k], track.position_m[k]);
        for (column, value) in
            [time_s, v[0], v[1], v[2], p[0], p[1], p[2], track.sigma_total_m(k)].into_iter().enumerate()
        {
            if column > 0 {
                line.push(b',');
            }
            line.extend_from_slice(buffer.format(value).as_bytes());
        }
        line.push(b'\n');
        if line.len() > 1 << 16 {
            out.write_all(&line)?;
            line.clear();
        }
    }
    out.write_all(&line)
}

/// What to know before trusting the result, of the recording and of the motion.
fn doubts(args: &Motion, recording: &Recording, track: &Track, lang: Lang) -> Vec<String> {
    let mut warnings: Vec<String> =
        recording.warnings.iter().map(|note| note.sentence(lang).to_owned()).collect();
    warnings.extend(holes(recording, track, lang));
    if let Some(end) = track.given_end.filter(GivenEnd::is_doubtful) {
        let GivenEnd { off_m, sigma_m, distance } = end;
        warnings.push(say(
            lang,
            format!(
                "The end that was given is {off_m:.3} m from where the readings lead to within {sigma_m:.3} m \
                 ({distance:.1} standard deviations): one of the two is wrong; the end was believed."
            ),
            format!(
                "指定した終点は、計測値から求めた終点 (標準偏差 {sigma_m:.3} m) から {off_m:.3} m (標準偏差の {distance:.1} 倍) \
                 離れています。どちらかが誤りです。計算では指定した終点を採用しました。"
            ),
        ));
    }
    if args.mode == MotionMode::Naive {
        warnings.push(say(
            lang,
            "Nothing is corrected after the first rest: the error grows with the cube of the time. rest-to-rest is the trustworthy mode.",
            "最初の静止以降は補正しません。誤差は時間の 3 乗で増えます。信頼できる結果には rest-to-rest を使ってください。",
        ));
    }
    if track.phases.last() == Some(&Phase::Moving) && args.mode != MotionMode::Naive {
        warnings.push(say(
            lang,
            "The recording does not end at rest: the last stretch is not corrected from its far side.",
            "記録が静止で終わっていません。最後の区間は終端側から補正されていません。",
        ));
    }
    warnings
}

/// What was missing from the samples and bridged.
fn holes(recording: &Recording, track: &Track, lang: Lang) -> Vec<String> {
    let mut said = Vec::new();
    let passed_over = track.passed_over;
    if passed_over > 0 {
        said.push(say(
            lang,
            format!(
                "{passed_over} sample(s) are no readings (more than {LARGEST_ACC_M_S2} m/s² or {LARGEST_RATE_RAD_S} \
                 rad/s, or an acceleration of exactly 0, 0, 0) and were passed over."
            ),
            format!(
                "{passed_over} 個のサンプルは計測値ではないため ({LARGEST_ACC_M_S2} m/s² または {LARGEST_RATE_RAD_S} rad/s を\
                 超えるか、加速度がちょうど 0, 0, 0)、読み飛ばしました。"
            ),
        ));
    }
    let longest = track.holes.iter().max_by(|a, b| a.length_s.total_cmp(&b.length_s));
    if let Some(hole) = longest {
        let (count, length_s) = (track.holes.len(), hole.length_s);
        let end_s = recording.time_s.get(hole.row).copied().unwrap_or_default();
        let at_s = end_s - length_s;
        said.push(say(
            lang,
            format!(
                "{count} hole(s) in the samples while the sensor moved, the longest of {length_s:.2} s at {at_s:.2} s: \
                 the band is widened by what may have happened in them."
            ),
            format!(
                "移動中にサンプルの欠けが {count} か所あります (最長は時刻 {at_s:.2} 秒から {length_s:.2} 秒間)。その間に\
                 起こりえた運動の分だけ誤差幅を広げました。"
            ),
        ));
    }
    said
}

fn page(
    args: &Motion,
    recording: &Recording,
    track: &Track,
    warnings: Vec<String>,
    shown: &str,
    lang: Lang,
) -> String {
    let time = &recording.time_s;
    let mut still = Vec::new();
    let mut start = None;
    for k in 0..=time.len() {
        let moving = track.phases.get(k).is_none_or(|p| *p == Phase::Moving);
        match (moving, start) {
            (false, None) => start = Some(k),
            (true, Some(s)) => {
                still.push((time[s], time[k - 1]));
                start = None;
            }
            _ => {}
        }
    }
    let series = |rows: &'static str, data: &[Vec3], sigma: Option<&[Vec3]>| -> Vec<Series<'static>> {
        [Tone::X, Tone::Y, Tone::Z]
            .into_iter()
            .enumerate()
            .map(|(i, tone)| Series {
                name: format!("{rows}{}", ["x", "y", "z"][i]),
                tone,
                mark: Mark::Line,
                y: Column::Owned(data.iter().map(|v| v[i]).collect()),
                sigma: sigma.map(|s| Column::Owned(s.iter().map(|v| v[i]).collect())),
                factor: 1.0,
                period: None,
            })
            .collect()
    };
    let plot = |en: &str, ja: &str, unit: &str, series| {
        let heading = say(lang, en, ja);
        Plot {
            description: heading.clone(),
            x_axis: Axis::linear(&say(lang, "Time", "時刻"), "s"),
            y_axis: Axis::linear(&heading, unit),
            heading,
            x: Column::Slice(time),
            series,
            spans: spans(&still, SpanKind::Rest),
        }
    };
    let last = track.position_m.len() - 1;
    let stride = track.position_m.len().div_ceil(4000);
    let path = |a: usize, b: usize| -> Vec<[f64; 2]> {
        track.position_m.iter().step_by(stride).chain(track.position_m.last()).map(|p| [p[a], p[b]]).collect()
    };
    let figure = |en: &str, ja: &str, a: usize, b: usize| {
        let heading = say(lang, en, ja);
        let points = path(a, b);
        let ends = [points.first(), points.last()].into_iter().flatten().copied().collect();
        let names = ["x", "y", "z"];
        Block::Figure {
            figure: Figure {
                description: heading.clone(),
                x: Axis::linear(names[a], "m"),
                y: Axis::linear(names[b], "m"),
                equal: true,
                items: vec![
                    Item::Line { points, tone: Tone::Z, dashed: false },
                    Item::Dots {
                        points: ends,
                        tone: Tone::X,
                        labels: vec![say(lang, "start", "始点"), say(lang, "end", "終点")],
                    },
                ],
                legend: Vec::new(),
            },
            heading,
        }
    };
    let p = track.position_m[last];
    Page {
        lang,
        title: say(lang, "Motion", "運動"),
        sources: vec![shown.to_owned()],
        facts: vec![
            (say(lang, "Mode", "方法"), mode_name(args.mode).to_owned()),
            (
                say(lang, "End", "終点"),
                format!("({:.4}, {:.4}, {:.4}) m ± {:.4} m", p[0], p[1], p[2], track.sigma_total_m(last)),
            ),
            (say(lang, "Path", "経路長"), format!("{:.3} m", path_length(track))),
            (
                say(lang, "Longest without a rest", "静止のない最長時間"),
                format!("{:.1} s", track.longest_without_rest_s),
            ),
        ],
        warnings,
        plots: vec![
            plot(
                "Position with its 1-sigma band",
                "位置 (1σ の誤差幅)",
                "m",
                series("p", &track.position_m, Some(&track.sigma_position_m)),
            ),
            plot("Velocity", "速度", "m/s", series("v", &track.velocity_m_s, None)),
        ],
        attitude: None,
        blocks: vec![
            figure("Path from above", "上から見た経路", 0, 1),
            figure("Path from the side", "横から見た経路", 0, 2),
        ],
        generator: concat!("shisei ", env!("CARGO_PKG_VERSION")).to_owned(),
    }
    .to_html()
}
