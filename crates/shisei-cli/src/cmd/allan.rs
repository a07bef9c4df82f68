//! `shisei allan`: overlapping Allan deviation of all six axes.

use std::fmt::Write as _;
use std::path::PathBuf;

use serde_json::json;
use shisei_core::Lang;
use shisei_core::allan::{self, Analysis};
use shisei_record::{Note, Recording};
use shisei_report::figure::{Figure, Item};
use shisei_report::page::{Block, Page};
use shisei_report::plot::{Axis, Scale, Tone};

use crate::args::Allan;
use crate::fail::{Failure, Outcome, say};
use crate::input::{self, Source};
use crate::output::{Kind, Writer, is_stdout};
use crate::stillness::{self, Moved};
use crate::summary;

/// The unit of values that have no scale.
const COUNTS: &str = "counts";

/// An axis: name, unit of its rate, its analysis.
struct Channel {
    name: &'static str,
    unit: &'static str,
    analysis: Analysis,
}

/// Runs the command.
pub fn run(args: &Allan, lang: Lang) -> Outcome<()> {
    let mut options = input::options(&args.reading, lang)?;
    options.counts_ok = true;
    let source = Source { paths: args.files.clone() };
    let stem = source.stem();
    let output = args.output.clone().unwrap_or_else(|| PathBuf::from(format!("{stem}.allan.csv")));
    let report = args.report.or(format!("{stem}.allan.html"));
    let writer = Writer::new(args.force, lang, &args.files);
    let html = report.as_deref().map(|report| (report, Kind::Html));
    writer.check_all(&[(output.as_path(), Kind::Table)].into_iter().chain(html).collect::<Vec<_>>())?;
    let mut recording = input::open(&source, &options, lang).map_err(|error| error.failure(lang))?;
    let doubts = [in_counts(&recording), moved(&recording)];
    recording.warnings.extend(doubts.into_iter().flatten());
    let shown = source.shown();
    let found = &recording.findings;
    // the deviation is that of evenly spaced samples; gaps would join what does not belong together
    let missing = found.gap_total_s / found.duration_s.max(1e-9);
    if missing > 0.01 {
        return Err(Failure::condition(say(
            lang,
            format!(
                "{shown}: {:.0} % of the time has no samples; the Allan deviation needs a recording without gaps",
                100.0 * missing
            ),
            format!(
                "{shown}：時間の {:.0} % でサンプルが欠けています。アラン偏差には欠落のない記録が必要です",
                100.0 * missing
            ),
        )));
    }
    let dt_s = 1.0 / found.rate_hz;
    let mut channels = Vec::new();
    let counts = recording.counts;
    for (series, names, unit) in [
        (&recording.gyro_rad_s, ["gyr_x", "gyr_y", "gyr_z"], if counts { COUNTS } else { "rad/s" }),
        (&recording.acc_m_s2, ["acc_x", "acc_y", "acc_z"], if counts { COUNTS } else { "m/s²" }),
    ] {
        for (axis, name) in names.into_iter().enumerate() {
            let rate: Vec<f64> = series.iter().map(|v| v[axis]).collect();
            let analysis = allan::analyse(&rate, dt_s)
                .map_err(|e| Failure::core(&format!("{shown} {name}"), e, lang))?;
            channels.push(Channel { name, unit, analysis });
        }
    }
    writer.write(&output, Kind::Table, |out| out.write_all(table(&channels).as_bytes()))?;
    if let Some(path) = &report {
        let page = page(&channels, &shown, &recording, lang);
        writer.write(path, Kind::Html, |out| out.write_all(page.as_bytes()))?;
    }
    if args.json && !is_stdout(&output) {
        println!("{}", document(&channels));
    }
    eprint!("{}", text(&channels, lang));
    eprint!("{}", summary::of_notes(&recording, lang));
    for path in [Some(&output), report.as_ref()].into_iter().flatten().filter(|p| !is_stdout(p)) {
        eprintln!("→ {}", path.display());
    }
    Ok(())
}

/// A doubt where the sensor clearly moved. Counts have no unit, so they are not judged.
fn moved(recording: &Recording) -> Option<Note> {
    if recording.counts {
        return None;
    }
    let Moved { still_s, whole_s } =
        stillness::moved(&recording.acc_m_s2, &recording.gyro_rad_s, &recording.dt_s)?;
    Some(Note::new(
        "moved",
        format!(
            "the sensor lay still in one attitude for {still_s:.1} of {whole_s:.1} s only: these are the numbers of its motion, not of its noise"
        ),
        format!(
            "センサが同じ姿勢で静止していたのは {whole_s:.1} 秒のうち {still_s:.1} 秒だけです。これらは雑音ではなく動きの値です"
        ),
    ))
}

/// A doubt about what units the numbers are in.
fn in_counts(recording: &Recording) -> Option<Note> {
    recording.counts.then(|| {
        Note::new(
            "counts",
            "the values are raw counts of the sensor, and so are these numbers; give --scale acc=COUNTS_PER_G,gyr=COUNTS_PER_DEG_S for those of a data sheet".to_owned(),
            "値はセンサの生カウントで、これらの数値もカウントの単位です。物理量で求めるには --scale acc=COUNTS_PER_G,gyr=COUNTS_PER_DEG_S を指定してください".to_owned(),
        )
    })
}

fn table(channels: &[Channel]) -> String {
    let mut out = String::from("axis,tau_s,deviation,low,high,degrees_of_freedom,noise_exponent\n");
    for c in channels {
        for p in &c.analysis.curve {
            let _ = writeln!(
                out,
                "{},{},{},{},{},{},{}",
                c.name, p.tau_s, p.deviation, p.low, p.high, p.degrees_of_freedom, p.noise_exponent
            );
        }
    }
    out
}

fn document(channels: &[Channel]) -> serde_json::Value {
    let coefficient = |c: allan::Coefficient| json!({ "value": c.value, "sigma": c.sigma });
    let axes: serde_json::Map<String, serde_json::Value> = channels
        .iter()
        .map(|c| {
            let a = &c.analysis;
            let value = json!({
                "unit": c.unit,
                "random_walk": coefficient(a.random_walk),
                "bias_instability": coefficient(a.bias_instability),
                "rate_random_walk": coefficient(a.rate_random_walk),
                "quantisation": coefficient(a.quantisation),
                "floor": a.floor,
                "floor_tau_s": a.floor_tau_s,
                "floor_reached": a.floor_reached,
                "recommended_s": a.recommended_s,
            });
            (c.name.to_owned(), value)
        })
        .collect();
    json!({ "axes": axes })
}

/// Numbers in the units of data sheets: °/√h and °/h, m/s/√h and mg.
fn rows(channels: &[Channel], lang: Lang) -> Vec<Vec<String>> {
    let degree = 180.0 / std::f64::consts::PI;
    channels
        .iter()
        .map(|c| {
            let a = &c.analysis;
            let (walk, walk_unit, floor, floor_unit) = match c.unit {
                "rad/s" => (60.0 * degree, "°/√h", 3600.0 * degree, "°/h"),
                "m/s²" => (60.0, "m/s/√h", 1e3 / shisei_core::STANDARD_GRAVITY_M_S2, "mg"),
                _ => (1.0, "counts·√s", 1.0, "counts"),
            };
            let floor_text = if a.floor_reached {
                format!("{:.4} {floor_unit}", a.floor * floor)
            } else {
                say(
                    lang,
                    format!("≤ {:.4} {floor_unit} (recording too short)", a.floor * floor),
                    format!("≤ {:.4} {floor_unit} (記録が短いため上限)", a.floor * floor),
                )
            };
            vec![
                c.name.to_owned(),
                format!("{:.5} ± {:.5} {walk_unit}", a.random_walk.value * walk, a.random_walk.sigma * walk),
                floor_text,
                format!("{:.2e} ± {:.1e}", a.rate_random_walk.value, a.rate_random_walk.sigma),
                match a.recommended_s {
                    short if short < 1.0 => format!("{short:.3} s"),
                    long => format!("{long:.1} s"),
                },
            ]
        })
        .collect()
}

fn head(channels: &[Channel], lang: Lang) -> Vec<String> {
    let unit = if channels.iter().any(|c| c.unit == COUNTS) { COUNTS } else { "SI" };
    let rate_walk =
        say(lang, format!("rate random walk ({unit}/√s)"), format!("レートランダムウォーク ({unit}/√s)"));
    match lang {
        Lang::En => ["axis", "random walk", "bias instability", &rate_walk, "average for"],
        Lang::Ja => ["軸", "ランダムウォーク", "バイアス安定度", &rate_walk, "平均時間の目安"],
    }
    .map(str::to_owned)
    .to_vec()
}

fn text(channels: &[Channel], lang: Lang) -> String {
    let mut out = format!("  {}\n", head(channels, lang).join(" | "));
    for row in rows(channels, lang) {
        let _ = writeln!(out, "  {}", row.join(" | "));
    }
    out
}

fn page(channels: &[Channel], shown: &str, recording: &Recording, lang: Lang) -> String {
    let duration_s = recording.findings.duration_s;
    let warnings = recording.warnings.iter().map(|note| note.sentence(lang).to_owned()).collect();
    let mut blocks = vec![Block::Table {
        heading: say(lang, "Noise", "雑音"),
        head: head(channels, lang),
        rows: rows(channels, lang),
    }];
    for (part, en, ja) in [(0..3, "Gyroscope", "ジャイロ"), (3..6, "Accelerometer", "加速度")] {
        let (mut items, mut legend) = (Vec::new(), Vec::new());
        let unit = channels.get(part.start).map_or("", |c| c.unit);
        for (c, tone) in channels.get(part).unwrap_or(&[]).iter().zip([Tone::X, Tone::Y, Tone::Z]) {
            let curve = &c.analysis.curve;
            items.push(Item::Band { points: curve.iter().map(|p| [p.tau_s, p.low, p.high]).collect(), tone });
            items.push(Item::Line {
                points: curve.iter().map(|p| [p.tau_s, p.deviation]).collect(),
                tone,
                dashed: false,
            });
            legend.push((tone, c.name.to_owned()));
        }
        let axis = |label: String, unit: &str| Axis { label, unit: unit.to_owned(), scale: Scale::Log };
        let heading = say(lang, format!("{en}: Allan deviation"), format!("{ja}: アラン偏差"));
        let figure = Figure {
            description: heading.clone(),
            x: axis(say(lang, "averaging time τ", "平均時間 τ"), "s"),
            y: axis(say(lang, "deviation", "偏差"), unit),
            equal: false,
            items,
            legend,
        };
        blocks.push(Block::Figure { heading, figure });
    }
    Page {
        lang,
        title: say(lang, "Allan deviation", "アラン偏差"),
        sources: vec![shown.to_owned()],
        facts: vec![(say(lang, "Duration", "長さ"), format!("{duration_s:.1} s"))],
        warnings,
        plots: Vec::new(),
        attitude: None,
        blocks,
        generator: concat!("shisei ", env!("CARGO_PKG_VERSION")).to_owned(),
    }
    .to_html()
}
