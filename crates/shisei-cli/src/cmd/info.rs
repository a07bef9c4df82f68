//! `shisei info`: what a recording is, and what was assumed.

use std::fmt::Write as _;

use serde_json::{Value, json};
use shisei_core::filter::Dt;
use shisei_core::rest::{self, RestSettings};
use shisei_core::{Lang, vector};
use shisei_record::{Input, Inspection, Options, Problem, Recording};

use crate::args::Info;
use crate::fail::{Failure, Outcome, say};
use crate::input::{self, Source};
use crate::output;
use crate::summary::{self, padded};

/// Runs the command. Several files are looked at one by one, save an accelerometer file and a gyroscope file
/// that belong together.
pub fn run(args: &Info, lang: Lang) -> Outcome<()> {
    let options = input::options(&args.reading, lang)?;
    let sources = input::expand(&args.files, lang)?.joined(&options, lang);
    let mut reports = Vec::new();
    let mut refused = Vec::new();
    for source in together(sources.list, &options, lang) {
        let inspection = match inspect(&source, &options, lang) {
            Ok(inspection) => inspection,
            Err(failure) if sources.batch => {
                eprintln!("{}", failure.sentence);
                reports.push(json!({ "input": source.shown(), "error": failure.sentence }));
                refused.push(failure.exit);
                continue;
            }
            Err(failure) => return Err(failure),
        };
        if inspection.channels.is_empty()
            && let Some(error) = &inspection.refusal
            && sensors(&inspection).is_empty()
        {
            // Not even a table: that is a refusal, not information.
            let failure = input::Unopened::Contents(error.clone()).failure(lang);
            if !sources.batch {
                return Err(failure);
            }
            eprintln!("{}", failure.sentence);
            refused.push(failure.exit);
        }
        if args.json {
            reports.push(as_json(&source, &inspection, lang));
        } else {
            print!("{}", as_text(&source, &inspection, lang));
        }
    }
    if args.json {
        match (sources.batch, reports.pop()) {
            (false, Some(report)) => println!("{report}"),
            (_, last) => {
                reports.extend(last);
                println!("{}", json!({ "recordings": reports }));
            }
        }
    }
    if let Some(exit) = refused.iter().max() {
        let refused = refused.len();
        return Err(Failure {
            exit: *exit,
            sentence: say(lang, format!("{refused} failed"), format!("失敗 {refused} 件")),
        });
    }
    Ok(())
}

/// Makes one source of halves that belong together.
fn together(list: Vec<Source>, options: &Options, lang: Lang) -> Vec<Source> {
    if list.len() < 2 {
        return list;
    }
    let refused: Vec<_> = list
        .iter()
        .filter_map(|source| input::open(source, options, lang).err().map(|why| (source.clone(), why)))
        .collect();
    let pairs = input::pair(&refused);
    let mut out: Vec<Source> = list
        .into_iter()
        .filter(|source| !pairs.iter().any(|pair| pair.paths.contains(&source.paths[0])))
        .collect();
    out.extend(pairs);
    out
}

fn inspect(source: &Source, options: &Options, lang: Lang) -> Outcome<Inspection> {
    let mut files = Vec::new();
    for path in &source.paths {
        let name = if output::is_stdout(path) { "stdin".to_owned() } else { path.display().to_string() };
        files.push((name, input::read(path, lang)?));
    }
    let inputs: Vec<Input<'_>> = files.iter().map(|(name, bytes)| Input { name, bytes }).collect();
    shisei_record::inspect(&inputs, options).map_err(|error| input::Unopened::Contents(error).failure(lang))
}

/// The names of the sensors where there are several.
fn sensors(inspection: &Inspection) -> &[String] {
    match inspection.refusal.as_ref().map(|error| &error.problem) {
        Some(Problem::ManySensors { names }) => names,
        _ => &[],
    }
}

/// The rests of a recording, as first and last time, s.
fn rests(recording: &Recording) -> Vec<(f64, f64)> {
    let dt = Dt::PerSample(&recording.dt_s);
    // Counts have no unit, so stillness cannot be judged.
    let found = if recording.counts {
        Vec::new()
    } else {
        rest::find_rests(&recording.acc_m_s2, &recording.gyro_rad_s, dt, &RestSettings::default())
            .unwrap_or_default()
    };
    let time = |k: usize| recording.time_s.get(k).copied().unwrap_or_default();
    found.iter().map(|range| (time(range.start), time(range.end.saturating_sub(1)))).collect()
}

fn as_json(source: &Source, inspection: &Inspection, lang: Lang) -> Value {
    let channels: Vec<Value> = inspection
        .channels
        .iter()
        .map(|c| json!({ "number": c.number, "file": c.file, "name": c.name, "unit": c.unit, "role": c.role, "used": c.used }))
        .collect();
    let mut report = json!({
        "input": source.shown(),
        "dialect": inspection.dialect,
        "dialect_name": inspection.dialect_name,
        "layout": inspection.layout,
        "channels": channels,
        "sensors": sensors(inspection),
        "is_recording": inspection.recording.is_some(),
        "refusal": inspection.refusal.as_ref().map(|error| error.sentence(lang)),
    });
    let Some(recording) = &inspection.recording else { return report };
    let f = &recording.findings;
    let gaps: Vec<Value> =
        f.gaps.iter().map(|g| json!({ "row": g.row, "from_s": g.from_s, "length_s": g.length_s })).collect();
    let rests: Vec<Value> =
        rests(recording).iter().map(|(start, end)| json!({ "start_s": start, "end_s": end })).collect();
    let rest_norm_m_s2 = f.rest_norm;
    let more = json!({
        "sensor": recording.sensor,
        "samples": recording.len(),
        "rate_hz": f.rate_hz,
        "mean_rate_hz": f.mean_rate_hz,
        "duration_s": f.duration_s,
        "time_from_rate": f.time_from_rate,
        "jitter_s": f.jitter_s,
        "start_unix_s": recording.start_unix_s,
        "gaps": { "count": f.gap_count, "total_s": f.gap_total_s, "longest": gaps },
        "repeated_stamps": f.repeated_stamps,
        "backward_stamps": f.backward_stamps,
        "wild_stamps": f.wild_stamps,
        "resets": f.resets,
        "wraps": f.wraps,
        "clipped": f.clipped,
        "clip_level": f.clip_level,
        "skipped_rows": f.skipped_rows,
        "rests": rests,
        "rest_norm_m_s2": rest_norm_m_s2,
        "has_temperature": recording.temp_c.is_some(),
        "assumptions": summary::notes_json(&recording.assumptions, lang),
        "warnings": summary::notes_json(&recording.warnings, lang),
    });
    if let (Some(report), Value::Object(more)) = (report.as_object_mut(), more) {
        report.extend(more);
    }
    report
}

fn as_text(source: &Source, inspection: &Inspection, lang: Lang) -> String {
    let mut text = format!("{}\n", source.shown());
    let mut line = |en: &str, ja: &str, value: String| {
        let _ = writeln!(text, "  {}{value}", padded(&say(lang, en, ja), 16));
    };
    line("Format", "形式", inspection.format(lang));
    if let Some(recording) = &inspection.recording {
        let f = &recording.findings;
        line("Samples", "サンプル", recording.len().to_string());
        line("Rate", "レート", format!("{:.3} Hz", f.rate_hz));
        line(
            "Duration",
            "長さ",
            say(lang, format!("{:.3} s", f.duration_s), format!("{:.3} 秒", f.duration_s)),
        );
        line("Gaps", "欠落", gaps(recording, lang));
        if f.repeated_stamps + f.backward_stamps + f.resets + f.wraps > 0 {
            line(
                "Time stamps",
                "時刻",
                say(
                    lang,
                    format!(
                        "{} repeated, {} backward, {} resets, {} wraps",
                        f.repeated_stamps, f.backward_stamps, f.resets, f.wraps
                    ),
                    format!(
                        "重複 {}、逆行 {}、リセット {}、桁あふれ {}",
                        f.repeated_stamps, f.backward_stamps, f.resets, f.wraps
                    ),
                ),
            );
        }
        let rests: Vec<String> =
            rests(recording).iter().map(|(from, to)| format!("{from:.2}–{to:.2} s")).collect();
        line(
            "Rests",
            "静止区間",
            if rests.is_empty() {
                say(lang, "none found", "見つかりません")
            } else {
                rests.join(", ")
            },
        );
        let unit = if recording.counts { "counts" } else { "m/s²" };
        line("|a| at rest", "静止時の |a|", format!("{:.4} {unit}", f.rest_norm));
        let clipped: Vec<String> = ["acc x", "acc y", "acc z", "gyr x", "gyr y", "gyr z"]
            .iter()
            .zip(f.clipped)
            .filter(|(_, count)| *count > 0)
            .map(|(axis, count)| format!("{axis} {count}"))
            .collect();
        line(
            "Clipped",
            "飽和",
            if clipped.is_empty() { say(lang, "none", "なし") } else { clipped.join(", ") },
        );
        let largest = |rows: &[shisei_core::Vec3]| rows.iter().map(|&v| vector::norm(v)).fold(0.0, f64::max);
        line("Largest |a|", "最大の |a|", format!("{:.2} {unit}", largest(&recording.acc_m_s2)));
        let unit = if recording.counts { "counts" } else { "rad/s" };
        line("Largest |ω|", "最大の |ω|", format!("{:.3} {unit}", largest(&recording.gyro_rad_s)));
    }
    let sensors = sensors(inspection);
    if !sensors.is_empty() {
        let _ = writeln!(text, "  {}{}", padded(&say(lang, "Sensors", "センサ"), 16), sensors.join(", "));
    }
    if !inspection.channels.is_empty() {
        let _ = writeln!(text, "  {}", say(lang, "Columns", "列"));
    }
    for c in &inspection.channels {
        let mark = if c.used { '✓' } else { ' ' };
        let _ = writeln!(
            text,
            "    {mark} {:>3} {}{}{}",
            c.number,
            padded(&c.name, 28),
            padded(&c.unit, 10),
            role(&c.role, lang)
        );
    }
    if let Some(recording) = &inspection.recording {
        text += &summary::of_notes(recording, lang);
    }
    if let Some(error) = &inspection.refusal {
        let _ = writeln!(
            text,
            "  {} {}",
            say(lang, "no recording:", "記録として開けません："),
            error.sentence(lang)
        );
    }
    text
}

/// What a column is; names of columns stay.
fn role(role: &str, lang: Lang) -> String {
    let ja = match role {
        "acceleration" => "加速度",
        "acceleration without gravity" => "重力を除いた加速度",
        "gravity" => "重力",
        "angular rate" => "角速度",
        "temperature" => "温度",
        "time" => "時刻",
        "counter" => "カウンタ",
        "axis of an unnamed quantity" => "量の分からない軸",
        "other" => "その他",
        column => column,
    };
    say(lang, role, ja)
}

fn gaps(recording: &Recording, lang: Lang) -> String {
    let f = &recording.findings;
    if f.gap_count == 0 {
        return say(lang, "none", "なし");
    }
    let longest = f.gaps.iter().map(|gap| gap.length_s).fold(0.0, f64::max);
    say(
        lang,
        format!("{}, {:.3} s in all, longest {longest:.3} s", f.gap_count, f.gap_total_s),
        format!("{} か所、合計 {:.3} 秒、最長 {longest:.3} 秒", f.gap_count, f.gap_total_s),
    )
}
