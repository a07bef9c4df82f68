//! What `shisei fuse` tells: the summary on the terminal and the report page.

use std::fmt::Write as _;

use shisei_core::fuse::{FilledGap, FusedFrame, Source, Unfilled};
use shisei_core::sync::lever::Lever;
use shisei_core::sync::rates::Sync;
use shisei_core::{Lang, Quaternion, vector};
use shisei_report::attitude::AttitudeView;
use shisei_report::column::Column;
use shisei_report::page::{Block, Page};
use shisei_report::plot::{Axis, Mark, Plot, Series, SpanKind, Tone, spans};

use crate::cmd::fuse::{Done, How};
use crate::fail::say;
use crate::summary::padded;

/// Names and values that matter most.
fn facts(done: &Done, lang: Lang) -> Vec<(String, String)> {
    let count = |source| done.frames.iter().filter(|frame| frame.source == source).count();
    let fact = |en: &str, ja: &str, value: String| (say(lang, en, ja), value);
    let mut all = vec![
        fact("Body", "剛体", done.name.clone()),
        fact(
            "Frames",
            "フレーム",
            say(
                lang,
                format!(
                    "{}: {} optical, {} bridged, {} inertial, {} none",
                    done.frames.len(),
                    count(Source::Optical),
                    count(Source::Bridged),
                    count(Source::Inertial),
                    count(Source::None)
                ),
                format!(
                    "{} (光学 {}、補間 {}、慣性のみ {}、なし {})",
                    done.frames.len(),
                    count(Source::Optical),
                    count(Source::Bridged),
                    count(Source::Inertial),
                    count(Source::None)
                ),
            ),
        ),
    ];
    match &done.how {
        How::Bridged { sync, lever, markers, held, .. } => {
            all.extend(of_clocks(sync, lever.as_ref(), lang));
            if !markers.is_empty() {
                let (count, placed) = (markers.len(), markers.iter().filter(|(_, at)| at.is_some()).count());
                all.push(fact(
                    "Markers",
                    "マーカー",
                    say(
                        lang,
                        format!("{placed} of {count} sit on the body; they hold it in {held} frames"),
                        format!("{count} 個中 {placed} 個を剛体上で使用、{held} フレームで位置を保持"),
                    ),
                ));
            }
        }
        How::Held { reference, grip_m, .. } => {
            let [x, y, z] = grip_m.map(|value| value * 1e3);
            all.push(fact("Held by", "持つ側", done.body.name.clone()));
            all.push(fact("Grip in its axes", "持つ側の軸での位置", format!("{x:.1}, {y:.1}, {z:.1} mm")));
            all.push(fact("Reference frame", "基準フレーム", reference.to_string()));
        }
    }
    let name = say(lang, "Axes of the results", "出力の座標系");
    all.push((name, done.to.name().to_owned()));
    all
}

/// Clocks and mounting.
fn of_clocks(sync: &Sync, lever: Option<&Lever>, lang: Lang) -> Vec<(String, String)> {
    let fact = |en: &str, ja: &str, value: String| (say(lang, en, ja), value);
    let mut all = vec![
        fact(
            "Clock offset (1 σ)",
            "時刻のずれ (1 σ)",
            format!("{:.3} ± {:.3} ms", sync.offset_s * 1e3, sync.sigma_offset_s * 1e3),
        ),
        fact(
            "Clock skew (1 σ)",
            "時計の進み (1 σ)",
            format!("{:.2} ± {:.2} ppm", sync.skew * 1e6, sync.sigma_skew * 1e6),
        ),
        fact(
            "Common motion",
            "共通の動き",
            say(
                lang,
                format!(
                    "{:.3} % of the turning explained, residual {:.2} °/s",
                    100.0 * sync.explained,
                    sync.residual_rad_s.to_degrees()
                ),
                format!(
                    "回転の {:.3} % を説明、残差 {:.2} °/s",
                    100.0 * sync.explained,
                    sync.residual_rad_s.to_degrees()
                ),
            ),
        ),
        fact(
            "Mounting, q sensor → body",
            "取り付け (センサ → 剛体)",
            format!(
                "{} ± {:.3}°",
                quaternion(sync.body_from_sensor),
                vector::norm(sync.sigma_mounting_rad).to_degrees()
            ),
        ),
    ];
    if let Some(lever) = lever {
        let [x, y, z] = lever.sensor_m.map(|value| value * 1e3);
        let sigma = vector::norm(lever.sigma_m) * 1e3;
        all.push(fact(
            "Sensor on the body",
            "剛体上のセンサ位置",
            format!("{x:.1}, {y:.1}, {z:.1} mm ± {sigma:.1} mm"),
        ));
    }
    all
}

fn quaternion(q: Quaternion) -> String {
    format!("{:.5} {:.5} {:.5} {:.5}", q.w, q.x, q.y, q.z)
}

/// Frames of a gap that came about in one way.
struct Part {
    how: String,
    frames: usize,
    /// Largest expected errors, rad and m; NaN where there is no pose.
    sigma_rad: f64,
    sigma_m: f64,
}

/// The ways in which a gap was filled, or not.
fn parts(gap: &FilledGap, frames: &[FusedFrame], lang: Lang) -> Vec<Part> {
    let filled = [
        (Source::Bridged, "bridged", "補間"),
        (Source::Inertial, "inertial: attitude only to be trusted", "慣性のみ: 姿勢だけ信頼できます"),
    ];
    let filled = filled.into_iter().map(|(source, en, ja)| {
        let own = || frames[gap.first..gap.end].iter().filter(move |frame| frame.source == source);
        let largest = |of: fn(&FusedFrame) -> f64| own().map(of).fold(0.0, f64::max);
        Part {
            how: say(lang, en, ja),
            frames: own().count(),
            sigma_rad: largest(|frame| frame.sigma_rad),
            sigma_m: largest(|frame| frame.sigma_m),
        }
    });
    let Unfilled { silent, loose, holder } = gap.unfilled;
    let unfilled = [
        (silent, "none: no inertial samples", "なし: 慣性センサの記録がありません"),
        (
            loose,
            "none: inertial samples missing on both sides",
            "なし: 前後で慣性センサの記録が途切れています",
        ),
        (holder, "none: the parent is lost", "なし: 親が失われています"),
    ];
    let unfilled = unfilled.into_iter().map(|(frames, en, ja)| Part {
        how: say(lang, en, ja),
        frames,
        sigma_rad: f64::NAN,
        sigma_m: f64::NAN,
    });
    filled.chain(unfilled).filter(|part| part.frames > 0).collect()
}

/// A part in words: `108 bridged, up to 0.24° and 1.2 mm (1 σ)`.
fn part_text(part: &Part, lang: Lang) -> String {
    let Part { how, frames, sigma_rad, sigma_m } = part;
    let head = say(lang, format!("{frames} {how}"), format!("{frames} フレーム {how}"));
    if sigma_m.is_nan() {
        return head;
    }
    let (deg, mm) = (number(sigma_rad.to_degrees(), 2), number(sigma_m * 1e3, 1));
    say(
        lang,
        format!("{head}, up to {deg}° and {mm} mm (1 σ)"),
        format!("{head}、最大 {deg}°、{mm} mm (1 σ)"),
    )
}

fn number(value: f64, decimals: usize) -> String {
    if value.is_finite() { format!("{value:.decimals$}") } else { "–".to_owned() }
}

/// For the terminal.
pub fn summary(done: &Done, lang: Lang) -> String {
    let mut text = String::new();
    let _ = writeln!(text, "{}", done.take.file);
    for (name, value) in facts(done, lang) {
        let _ = writeln!(text, "  {}{value}", padded(&name, 28));
    }
    let gaps = &done.gaps;
    for gap in gaps.iter().take(12) {
        let frame = done.take.frame[gap.first];
        let parts = parts(gap, &done.frames, lang);
        let told: Vec<String> = parts.iter().map(|part| part_text(part, lang)).collect();
        let told = told.join(say(lang, "; ", "；").as_str());
        let line = say(
            lang,
            format!("gap at frame {frame}: {:.2} s, {told}", gap.length_s),
            format!("欠落 フレーム {frame}: {:.2} 秒、{told}", gap.length_s),
        );
        let _ = writeln!(text, "  {line}");
    }
    if gaps.len() > 12 {
        let more = gaps.len() - 12;
        let _ =
            writeln!(text, "  {}", say(lang, format!("and {more} more gaps"), format!("ほか {more} か所")));
    }
    for warning in &done.warnings {
        let _ = writeln!(text, "  {} {warning}", say(lang, "warning:", "注意："));
    }
    text
}

/// The report.
pub fn page<'a>(done: &'a Done, optical: &str, inertial: &str, lang: Lang) -> Page<'a> {
    let frames = &done.frames;
    let seen = |frame: usize| frames[frame].source == Source::Optical;
    let column = |value: &dyn Fn(usize) -> f64| Column::Owned((0..frames.len()).map(value).collect());
    let series = |name: String, tone, y, sigma| Series {
        name,
        tone,
        mark: Mark::Line,
        y,
        sigma,
        factor: 1.0,
        period: None,
    };
    let gaps: Vec<(f64, f64)> = done
        .gaps
        .iter()
        .map(|gap| (done.time_s[gap.first.saturating_sub(1)], done.time_s[gap.end.min(frames.len() - 1)]))
        .collect();
    let plot = |en: &str, ja: &str, unit: &str, series| {
        let heading = say(lang, en, ja);
        Plot {
            description: heading.clone(),
            x_axis: Axis::linear(&say(lang, "Time", "時刻"), "s"),
            y_axis: Axis::linear(&heading, unit),
            heading,
            x: Column::Slice(&done.time_s),
            series,
            spans: spans(&gaps, SpanKind::Gap),
        }
    };
    let position = |only_seen: bool| -> Vec<Series<'a>> {
        [Tone::X, Tone::Y, Tone::Z]
            .into_iter()
            .enumerate()
            .map(|(axis, tone)| {
                let value = |row: usize| {
                    let pose = frames[row].pose.filter(|_| !only_seen || seen(row));
                    pose.map_or(f64::NAN, |pose| pose.position_m[axis])
                };
                let sigma = (!only_seen)
                    .then(|| column(&|row| if seen(row) { f64::NAN } else { frames[row].sigma_m }));
                series(["x", "y", "z"][axis].to_owned(), tone, column(&value), sigma)
            })
            .collect()
    };
    let errors = vec![
        series(
            say(lang, "attitude (degrees)", "姿勢 (度)"),
            Tone::X,
            column(&|row| frames[row].sigma_rad.to_degrees()),
            None,
        ),
        series(
            say(lang, "position (cm)", "位置 (cm)"),
            Tone::Z,
            column(&|row| frames[row].sigma_m * 100.0),
            None,
        ),
    ];
    let rows = done.gaps.iter().flat_map(|gap| {
        parts(gap, frames, lang).into_iter().map(|part| {
            vec![
                done.take.frame[gap.first].to_string(),
                part.frames.to_string(),
                format!("{:.3}", gap.length_s),
                part.how,
                number(part.sigma_rad.to_degrees(), 2),
                number(part.sigma_m * 1e3, 1),
            ]
        })
    });
    let head = match lang {
        Lang::En => {
            ["Gap at frame", "Frames", "Gap, s", "Filled by", "Attitude, ° (1 σ)", "Position, mm (1 σ)"]
        }
        Lang::Ja => [
            "欠落の最初のフレーム",
            "フレーム数",
            "欠落の長さ [秒]",
            "補った方法",
            "姿勢 [°] (1 σ)",
            "位置 [mm] (1 σ)",
        ],
    };
    Page {
        lang,
        title: say(lang, "Optical and inertial together", "光学計測と慣性計測の統合"),
        sources: vec![optical.to_owned(), inertial.to_owned()],
        facts: facts(done, lang),
        warnings: done.warnings.clone(),
        plots: vec![
            plot("Position as the cameras saw it", "光学計測の位置 (補間前)", "m", position(true)),
            plot("Position without holes", "欠落を補った位置", "m", position(false)),
            plot("Expected error (1 σ)", "予想誤差 (1 σ)", "", errors),
        ],
        attitude: Some(AttitudeView { time_s: &done.time_s, world_from_body: &done.attitude }),
        blocks: vec![Block::Table {
            heading: say(lang, "Gaps", "欠落区間"),
            head: head.map(str::to_owned).to_vec(),
            rows: rows.collect(),
        }],
        generator: format!("shisei {}", env!("CARGO_PKG_VERSION")),
    }
}
