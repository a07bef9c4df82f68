//! Many recordings in one run: in parallel, past bad files, with a table at the end.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::{Value, json};
use shisei_core::Lang;
use shisei_record::Note;

use crate::cmd::orient::{self, Places, Plan};
use crate::fail::{Failure, Outcome, say};
use crate::input::{self, Source, Unopened};
use crate::summary::{colon, padded};

/// How many kinds of assumptions, and of warnings, are written out.
const SHOWN: usize = 8;

/// What the table keeps of a recording that worked: a line, not its samples.
#[derive(Debug)]
struct Line {
    shown: String,
    samples: usize,
    rate_hz: f64,
    duration_s: f64,
    assumptions: Vec<String>,
    warnings: Vec<String>,
    json: Value,
}

/// Orients every source; results go to `-o DIRECTORY` or the working directory.
pub fn run(plan: &Plan, sources: Vec<Source>) -> Outcome<()> {
    let lang = plan.lang;
    let args = &plan.args;
    let named = [
        ("--report", args.report.path.is_some()),
        ("--plot", args.plot.is_some()),
        ("--save-calibration", args.save_calibration.is_some()),
    ];
    if let Some((option, _)) = named.into_iter().find(|(_, given)| *given) {
        return Err(Failure::input(say(
            lang,
            format!(
                "{option} names one file, and there are several recordings; leave it out, or give one recording (reports are named after the recordings)"
            ),
            format!(
                "{option} は 1 つのファイル名ですが、記録が複数あります。指定を外すか、記録を 1 つにしてください (レポート名は記録名から決まります)"
            ),
        )));
    }
    let folder = folder(plan)?;
    let stems = unique_stems(&sources);
    let (mut lines, refused) = work(plan, &folder, &sources, &stems);

    // Files with only an accelerometer or only a gyroscope may be halves of one recording.
    let pairs = input::pair(&refused);
    let in_pair =
        |source: &Source| pairs.iter().any(|pair| source.paths.iter().all(|p| pair.paths.contains(p)));
    let mut failures: Vec<(Source, Unopened)> =
        refused.into_iter().filter(|(source, _)| !in_pair(source)).collect();
    let (more, refused) = work(plan, &folder, &pairs, &unique_stems(&pairs));
    lines.extend(more);
    failures.extend(refused);

    lines.sort_by(|a, b| a.shown.cmp(&b.shown));
    finish(plan, &lines, failures)
}

fn folder(plan: &Plan) -> Outcome<PathBuf> {
    let Some(folder) = &plan.args.output else { return Ok(PathBuf::from(".")) };
    let lang = plan.lang;
    let shown = folder.display();
    if folder.exists() && !folder.is_dir() || folder.as_os_str() == "-" {
        return Err(Failure::input(say(
            lang,
            format!("-o {shown} is not a directory, and there are several recordings; name a directory"),
            format!(
                "-o {shown} はディレクトリではありません。記録が複数あるので、ディレクトリを指定してください"
            ),
        )));
    }
    std::fs::create_dir_all(folder).map_err(|error| {
        Failure::input(say(
            lang,
            format!("the directory {shown} could not be made ({error}); choose another with -o"),
            format!("ディレクトリ {shown} を作成できませんでした ({error})。-o で別の場所を指定してください"),
        ))
    })?;
    Ok(folder.clone())
}

/// Output names: the stem, with the folder's name or a number before it where two would collide.
fn unique_stems(sources: &[Source]) -> Vec<String> {
    let mut count: HashMap<String, usize> = HashMap::new();
    for source in sources {
        *count.entry(source.stem()).or_default() += 1;
    }
    let mut taken: HashMap<String, usize> = HashMap::new();
    sources
        .iter()
        .map(|source| {
            let stem = source.stem();
            let mut name = stem.clone();
            if count.get(&stem).is_some_and(|&n| n > 1) {
                let parent = source.paths.first().and_then(|path| path.parent()?.file_name());
                if let Some(parent) = parent {
                    name = format!("{}-{stem}", parent.to_string_lossy());
                }
            }
            let times = taken.entry(name.clone()).or_default();
            *times += 1;
            if *times > 1 { format!("{name}-{times}") } else { name }
        })
        .collect()
}

/// Runs the sources on all processors; each worker holds one recording at a time.
fn work(
    plan: &Plan,
    folder: &Path,
    sources: &[Source],
    stems: &[String],
) -> (Vec<Line>, Vec<(Source, Unopened)>) {
    let bar = ProgressBar::with_draw_target(Some(sources.len() as u64), ProgressDrawTarget::stderr());
    if let Ok(style) = ProgressStyle::with_template("{bar:40} {pos}/{len} {eta}") {
        bar.set_style(style);
    }
    let next = AtomicUsize::new(0);
    let results = Mutex::new((Vec::new(), Vec::new()));
    let workers =
        std::thread::available_parallelism().map_or(1, std::num::NonZero::get).min(sources.len().max(1));
    std::thread::scope(|scope| {
        for _ in 0..workers {
            scope.spawn(|| {
                while let Some((source, stem)) = {
                    let k = next.fetch_add(1, Ordering::Relaxed);
                    sources.get(k).zip(stems.get(k))
                } {
                    let outcome = orient::one(plan, source, &Places::in_folder(plan, folder, stem));
                    bar.inc(1);
                    let Ok(mut results) = results.lock() else { return };
                    match outcome {
                        Ok(done) => results.0.push(Line {
                            shown: source.shown(),
                            samples: done.recording.len(),
                            rate_hz: done.recording.findings.rate_hz,
                            duration_s: done.recording.findings.duration_s,
                            json: done.json(plan.lang),
                            assumptions: sentences(&done.recording.assumptions, plan.lang),
                            warnings: done.warnings,
                        }),
                        Err(error) => results.1.push((source.clone(), error)),
                    }
                }
            });
        }
    });
    bar.finish_and_clear();
    results.into_inner().unwrap_or_default()
}

fn sentences(notes: &[Note], lang: Lang) -> Vec<String> {
    notes.iter().map(|note| note.sentence(lang).to_owned()).collect()
}

/// What is said of all recordings, each once after the word for it and how many have it, the most frequent first.
fn of_all<'a>(said: impl Iterator<Item = &'a String>, (word, word_ja): (&str, &str), lang: Lang) -> String {
    let mut counts: HashMap<&str, usize> = HashMap::new();
    for sentence in said {
        *counts.entry(sentence).or_default() += 1;
    }
    let mut counts: Vec<(&str, usize)> = counts.into_iter().collect();
    counts.sort_by(|a, b| b.1.cmp(&a.1).then(a.0.cmp(b.0)));
    let (shown, others) = counts.split_at(counts.len().min(SHOWN));
    let mut text: String = shown
        .iter()
        .map(|(sentence, n)| {
            say(lang, format!("{word} ({n}): {sentence}\n"), format!("{word_ja} ({n} 件)：{sentence}\n"))
        })
        .collect();
    if !others.is_empty() {
        text += &say(
            lang,
            format!("… and {} more; shisei info FILE shows those of a recording\n", others.len()),
            format!("ほか {} 種類。shisei info ファイル で記録ごとに確認できます\n", others.len()),
        );
    }
    text
}

fn finish(plan: &Plan, lines: &[Line], failures: Vec<(Source, Unopened)>) -> Outcome<()> {
    let lang = plan.lang;
    let width = lines.iter().map(|line| line.shown.chars().count()).max().unwrap_or(0).clamp(12, 60);
    for line in lines {
        let warnings = match line.warnings.len() {
            0 => String::new(),
            n => say(lang, format!("  {n} warning(s)"), format!("  注意 {n} 件")),
        };
        let name = padded(&line.shown, width);
        eprintln!(
            "{name}  {:>9} × {:>8.2} Hz  {:>9.2} s{warnings}",
            line.samples, line.rate_hz, line.duration_s
        );
    }
    let assumed = lines.iter().flat_map(|line| &line.assumptions);
    eprint!("{}", of_all(assumed, ("assumed", "仮定"), lang));
    eprint!("{}", of_all(lines.iter().flat_map(|line| &line.warnings), ("warning", "注意"), lang));
    let mut refusals: Vec<(String, Failure)> =
        failures.into_iter().map(|(source, why)| (source.shown(), why.failure(lang))).collect();
    refusals.sort_by(|a, b| (&a.0, &a.1.sentence).cmp(&(&b.0, &b.1.sentence)));
    for (shown, Failure { sentence, .. }) in &refusals {
        // The sentence usually begins with the file already.
        if sentence.starts_with(shown.as_str()) {
            eprintln!("{sentence}");
        } else {
            eprintln!("{shown}{}{sentence}", colon(lang));
        }
    }
    if plan.args.json {
        let failed: Vec<Value> =
            refusals.iter().map(|(input, why)| json!({ "input": input, "error": why.sentence })).collect();
        let results: Vec<&Value> = lines.iter().map(|line| &line.json).collect();
        println!("{}", json!({ "results": results, "failed": failed }));
    }
    let (good, bad) = (lines.len(), refusals.len());
    let total = say(lang, format!("{good} done, {bad} failed"), format!("成功 {good} 件、失敗 {bad} 件"));
    if let Some(exit) = refusals.iter().map(|(_, why)| why.exit).max() {
        return Err(Failure { exit, sentence: total });
    }
    eprintln!("{total}");
    Ok(())
}
