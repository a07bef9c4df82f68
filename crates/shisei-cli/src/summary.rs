//! What the terminal and the report say about a result.

use std::fmt::Write as _;

use serde_json::{Value, json};
use shisei_core::Lang;
use shisei_core::orient::{Method, Orientation};
use shisei_record::{Note, Recording, dialect};
use shisei_report::{OrientationReport, Uncertainty};

use crate::args::Relative;
use crate::cmd::orient::{Done, Plan};
use crate::fail::say;
use crate::input::Source;
use crate::output;

const DEG_PER_RAD: f64 = 180.0 / std::f64::consts::PI;

/// The data of a report, owned.
#[derive(Debug)]
pub struct Report<'a> {
    plan: &'a Plan,
    recording: &'a Recording,
    orientation: &'a Orientation,
    title: String,
    sources: Vec<String>,
    ypr_rad: &'a [[f64; 3]],
    rests: Vec<(f64, f64)>,
    gaps: Vec<(f64, f64)>,
    poor: Vec<(f64, f64)>,
    facts: Vec<(String, String)>,
    assumptions: Vec<String>,
    warnings: &'a [String],
}

/// Collects what a report shows.
pub fn report<'a>(
    plan: &'a Plan,
    source: &Source,
    recording: &'a Recording,
    orientation: &'a Orientation,
    ypr_rad: &'a [[f64; 3]],
    warnings: &'a [String],
) -> Report<'a> {
    let lang = plan.lang;
    let mut sources = source.paths.iter().map(|path| path.display().to_string()).collect::<Vec<_>>();
    if sources == ["-"] {
        sources = vec!["stdin".to_owned()];
    }
    let time = |k: usize| recording.time_s.get(k).copied().unwrap_or_default();
    Report {
        plan,
        recording,
        orientation,
        title: say(lang, format!("Orientation of {}", source.stem()), format!("{} の姿勢", source.stem())),
        sources,
        ypr_rad,
        rests: orientation.rest.iter().map(|r| (time(r.start), time(r.end.saturating_sub(1)))).collect(),
        gaps: recording.findings.gaps.iter().map(|gap| (gap.from_s, gap.from_s + gap.length_s)).collect(),
        poor: poor(recording, orientation),
        facts: facts(plan, recording, orientation),
        assumptions: recording.assumptions.iter().map(|note| note.sentence(lang).to_owned()).collect(),
        warnings,
    }
}

impl Report<'_> {
    fn uncertainty(&self) -> Option<Uncertainty<'_>> {
        let certainty = self.orientation.certainty.as_ref()?;
        Some(Uncertainty {
            sigma_tilt_rad: &certainty.sigma_tilt_rad,
            sigma_heading_rad: &certainty.sigma_heading_rad,
            poor: &self.poor,
        })
    }

    fn view(&self) -> OrientationReport<'_> {
        OrientationReport {
            lang: self.plan.lang,
            title: &self.title,
            source_names: &self.sources,
            time_s: &self.recording.time_s,
            ypr_rad: self.ypr_rad,
            world_from_body: &self.orientation.world_from_body,
            acc_m_s2: &self.recording.acc_m_s2,
            gyro_rad_s: &self.recording.gyro_rad_s,
            rests: &self.rests,
            gaps: &self.gaps,
            uncertainty: self.uncertainty(),
            summary: &self.facts,
            assumptions: &self.assumptions,
            warnings: self.warnings,
            // A person reads degrees; the numbers in the CSV follow --degrees.
            degrees: true,
            generator: concat!("shisei ", env!("CARGO_PKG_VERSION")),
        }
    }

    /// The page.
    pub fn html(&self) -> shisei_report::Result<String> {
        shisei_report::orientation::html(&self.view())
    }

    /// The plot.
    pub fn png(&self) -> shisei_report::Result<Vec<u8>> {
        shisei_report::orientation::png(&self.view(), 1600, 900)
    }
}

/// Where the estimate is called poor: the standard deviation of the tilt is above this, rad (3°) …
const POOR_TILT_RAD: f64 = 0.05235987755982989;
/// … or that of the heading, rad (20°).
const POOR_HEADING_RAD: f64 = 0.3490658503988659;

/// The intervals in which the estimate is poor, s.
pub fn poor(recording: &Recording, orientation: &Orientation) -> Vec<(f64, f64)> {
    let Some(certainty) = &orientation.certainty else { return Vec::new() };
    let is_poor = |k: usize| {
        certainty.sigma_tilt_rad[k] > POOR_TILT_RAD || certainty.sigma_heading_rad[k] > POOR_HEADING_RAD
    };
    let mut spans: Vec<(f64, f64)> = Vec::new();
    let mut before = false;
    for (k, &time_s) in recording.time_s.iter().enumerate() {
        let now = is_poor(k);
        match (now, before, spans.last_mut()) {
            (true, true, Some(span)) => span.1 = time_s,
            (true, _, _) => spans.push((time_s, time_s)),
            _ => {}
        }
        before = now;
    }
    spans
}

/// Name and value of what was done, in the user's language.
fn facts(plan: &Plan, recording: &Recording, orientation: &Orientation) -> Vec<(String, String)> {
    let lang = plan.lang;
    let found = &recording.findings;
    let mut facts = Vec::new();
    let mut add = |en: &str, ja: &str, value: String| facts.push((say(lang, en, ja), value));
    add("Format", "形式", dialect::name(recording.dialect, lang).to_owned());
    add(
        "Samples",
        "サンプル",
        say(
            lang,
            format!("{} at {} Hz, {:.2} s", recording.len(), rate(found.rate_hz), found.duration_s),
            format!("{} 個、{} Hz、{:.2} 秒", recording.len(), rate(found.rate_hz), found.duration_s),
        ),
    );
    let time = |k: usize| recording.time_s.get(k).copied().unwrap_or_default();
    add(
        "Rest",
        "静止区間",
        match &orientation.rest {
            Some(r) => say(
                lang,
                format!("{:.2} to {:.2} s", time(r.start), time(r.end.saturating_sub(1))),
                format!("{:.2}〜{:.2} 秒", time(r.start), time(r.end.saturating_sub(1))),
            ),
            None => say(lang, "none (no bias removed)", "なし (バイアスは除いていません)"),
        },
    );
    if orientation.rest.is_some() && plan.settings.method != Method::EstimateOnline {
        let b = orientation.gyro_bias_rad_s;
        add(
            "Gyroscope bias removed",
            "除いたジャイロのバイアス",
            format!("{:.5}, {:.5}, {:.5} rad/s", b[0], b[1], b[2]),
        );
    }
    add("Filter", "フィルタ", filter_text(plan.settings.method, plan));
    add(
        "Angles",
        "角度の基準",
        match plan.args.relative {
            Relative::World => {
                say(lang, "relative to the start, world axes", "開始時に対する変化 (ワールド軸)")
            }
            Relative::Body => {
                say(lang, "relative to the start, sensor axes", "開始時に対する変化 (センサ軸)")
            }
            Relative::None => say(lang, "attitude itself", "姿勢そのもの"),
        },
    );
    if let Some(certainty) = &orientation.certainty {
        let largest = |sigma: &[f64]| sigma.iter().copied().fold(0.0, f64::max) * DEG_PER_RAD;
        let (tilt, heading) = (largest(&certainty.sigma_tilt_rad), largest(&certainty.sigma_heading_rad));
        let poor_s: f64 = poor(recording, orientation).iter().map(|(from, to)| to - from).sum();
        let poor_text = if poor_s > 0.0 {
            say(
                lang,
                format!("; poor for {poor_s:.1} s in all"),
                format!("、不確かな区間は計 {poor_s:.1} 秒"),
            )
        } else {
            String::new()
        };
        add(
            "Uncertainty (1 σ)",
            "不確かさ (1 σ)",
            say(
                lang,
                format!("tilt up to {tilt:.2}°, heading up to {heading:.2}°{poor_text}"),
                format!("傾き 最大 {tilt:.2}°、方位 最大 {heading:.2}°{poor_text}"),
            ),
        );
    }
    if let Some(axis) = &plan.args.forward {
        add("Forward", "前方", say(lang, format!("sensor {axis}"), format!("センサの {axis}")));
    }
    if let Some(path) = &plan.args.calibration {
        add("Calibration", "キャリブレーション", path.display().to_string());
    }
    facts
}

fn filter_text(method: Method, plan: &Plan) -> String {
    let name = plan.args.filter.name();
    match method {
        Method::Estimate | Method::EstimateOnline | Method::Gyro | Method::GyroRk4 => name.to_owned(),
        Method::Mahony { kp, ki } => format!("{name} (kp {kp}, ki {ki})"),
        Method::MahonyAdaptive { gain, ki } => format!(
            "{name} (kp {} → {}, ki {ki}, {} / {} / {} / {} m/s²)",
            gain.kp_max, gain.kp_min, gain.lower_end, gain.lower_start, gain.upper_start, gain.upper_end
        ),
        Method::Complementary { alpha } => format!("{name} (alpha {alpha})"),
    }
}

fn rate(rate_hz: f64) -> String {
    let text = format!("{rate_hz:.2}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// The short summary of one recording for the terminal.
pub fn of_one(plan: &Plan, done: &Done) -> String {
    let lang = plan.lang;
    let mut text = String::new();
    let _ = writeln!(text, "{}", done.source.shown());
    let width = if lang == Lang::Ja { 26 } else { 24 };
    for (name, value) in facts(plan, &done.recording, &done.orientation) {
        let _ = writeln!(text, "  {}{value}", padded(&name, width));
    }
    for (axis, name) in [say(lang, "Yaw", "ヨー"), say(lang, "Pitch", "ピッチ"), say(lang, "Roll", "ロール")]
        .iter()
        .enumerate()
    {
        let (least, most) = done.angle_ranges[axis];
        let (least, most) = (least * DEG_PER_RAD, most * DEG_PER_RAD);
        let range = say(lang, format!("{least:.1}° to {most:.1}°"), format!("{least:.1}°〜{most:.1}°"));
        let _ = writeln!(text, "  {}{range}", padded(name, width));
    }
    text += &notes(&done.recording.assumptions, done.warnings.iter().map(String::as_str), lang);
    for path in done.outputs.iter().filter(|path| !output::is_stdout(path)) {
        let _ = writeln!(text, "→ {}", path.display());
    }
    text
}

/// What was assumed of a recording and what to know before trusting a result, a line each.
pub fn of_notes(recording: &Recording, lang: Lang) -> String {
    let warnings = recording.warnings.iter().map(|note| note.sentence(lang));
    notes(&recording.assumptions, warnings, lang)
}

/// The same of notes and sentences.
pub fn notes<'a>(assumptions: &[Note], warnings: impl Iterator<Item = &'a str>, lang: Lang) -> String {
    let mut text = String::new();
    for note in assumptions {
        let _ = writeln!(text, "  {} {}", say(lang, "assumed:", "仮定："), note.sentence(lang));
    }
    for warning in warnings {
        let _ = writeln!(text, "  {} {warning}", say(lang, "warning:", "注意："));
    }
    text
}

/// The same as JSON.
pub fn notes_json(notes: &[Note], lang: Lang) -> Vec<Value> {
    notes.iter().map(|note| json!({ "code": note.code, "sentence": note.sentence(lang) })).collect()
}

/// Padded to a width in terminal columns; Japanese characters take two.
pub fn padded(text: &str, width: usize) -> String {
    format!("{text}{}", " ".repeat(width.saturating_sub(columns_of(text)).max(1)))
}

/// How many columns of a terminal a text takes.
pub fn columns_of(text: &str) -> usize {
    let wide = |c: char| c as u32 >= 0x1100 && !('\u{2000}'..='\u{2fff}').contains(&c);
    text.chars().map(|c| if wide(c) { 2 } else { 1 }).sum()
}

/// The language's separator between a file and what is said of it.
pub fn colon(lang: Lang) -> &'static str {
    if lang == Lang::Ja { "：" } else { ": " }
}
