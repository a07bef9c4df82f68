//! `shisei earth`: the Earth's rotation from recordings of several directions.

use std::path::{Path, PathBuf};

use serde_json::json;
use shisei_core::Lang;
use shisei_core::earth::Weights;
use shisei_core::earth::advice::{Suggestion, suggest};
use shisei_core::earth::analysis::{Analysis, analyse};
use shisei_core::earth::direction::{Direction, DirectionSummary, Drift, drift, summarise};
use shisei_core::earth::fits::Measured;

use super::{earth_serial, earth_text};
use crate::args::Earth;
use crate::fail::{Exit, Failure, Outcome, say};
use crate::input::{self, Source};
use crate::output::{Kind, Writer};
use crate::stillness::{self, Moved};
use crate::summary;

/// Everything that is told.
pub struct Found {
    /// Names of the directions.
    pub names: Vec<String>,
    /// The directions.
    pub directions: Vec<Direction>,
    /// How each was averaged; empty for a table of means.
    pub summaries: Vec<DirectionSummary>,
    /// The judgement.
    pub analysis: Analysis,
    /// Drift within the recordings.
    pub drift: Option<Drift>,
    /// Directions to add.
    pub suggestions: Vec<Suggestion>,
    /// The latitude was given.
    pub latitude_given: bool,
}

/// Runs the command.
pub fn run(args: &Earth, lang: Lang) -> Outcome<()> {
    if let Some(latitude) = args.latitude.filter(|latitude| !(-90.0 < *latitude && *latitude < 90.0)) {
        return Err(Failure::input(say(
            lang,
            format!(
                "--latitude {latitude}: give more than -90 and less than 90 degrees, north positive; at a pole no direction is north"
            ),
            format!(
                "--latitude {latitude}：-90 より大きく 90 より小さい度で指定してください (北緯が正、極では北が定まりません)"
            ),
        )));
    }
    check_serial(args, lang)?;
    let latitude = args.latitude.map(f64::to_radians);
    let report = args.report.or("earth.html");
    let writer = Writer::new(args.force, lang, &args.files);
    if let Some(report) = &report {
        writer.check_all(&[(report, Kind::Html)])?;
    }
    let weights = if args.weights == "article" { Weights::AsMeasured } else { Weights::Capped };
    let (names, mut directions, summaries) = if let Some(port) = &args.serial {
        earth_serial::measure(args, port, &writer, lang)?
    } else if let Some(table) = table_of_means(args, lang)? {
        let names = (1..=table.len()).map(|k| k.to_string()).collect();
        (names, table, Vec::new())
    } else {
        recordings(args, weights, lang)?
    };
    set_headings(args, &names, &mut directions, lang)?;
    let shown = args
        .serial
        .clone()
        .unwrap_or_else(|| args.files.iter().map(|f| f.display().to_string()).collect::<Vec<_>>().join(", "));
    let analysis = analyse(&directions, latitude).map_err(|e| refused(&shown, e, lang))?;
    let suggestions = suggest(&directions, &analysis, latitude, 4);
    let drift = drift(&summaries);
    let found = Found {
        names,
        directions,
        summaries,
        analysis,
        drift,
        suggestions,
        latitude_given: latitude.is_some(),
    };
    if args.json {
        println!("{}", document(&found));
    }
    for line in earth_text::lines(&found, lang) {
        eprintln!("{line}");
    }
    if let Some(path) = &report {
        let page = earth_text::page(&found, &shown, lang);
        writer.write(path, Kind::Html, |out| out.write_all(page.as_bytes()))?;
        eprintln!("→ {}", path.display());
    }
    Ok(())
}

/// Refuses what only a measurement takes.
fn check_serial(args: &Earth, lang: Lang) -> Outcome<()> {
    let given = [
        ("--output", args.output.is_some()),
        ("--directions", args.directions.is_some()),
        ("--seconds", args.seconds.is_some()),
        ("--baud", args.baud.is_some()),
    ];
    match given.into_iter().find(|(_, given)| *given).filter(|_| args.serial.is_none()) {
        None => Ok(()),
        Some((name, _)) => Err(Failure::input(say(
            lang,
            format!("{name} has no meaning without --serial; leave it out, or measure with --serial PORT"),
            format!("{name} は --serial なしでは使えません。外すか、--serial ポート で計測してください"),
        ))),
    }
}

/// The refusal of a direction in which the sensor did not lie still.
fn moving(shown: &str, moved: Moved, lang: Lang) -> Failure {
    let Moved { still_s, whole_s } = moved;
    Failure::condition(say(
        lang,
        format!(
            "{shown}: the sensor moves: it lies still in one attitude for {still_s:.1} of {whole_s:.1} s, and any turn is far more than the Earth's; give recordings, one a direction, in which it lies still throughout"
        ),
        format!(
            "{shown}：センサが動いています (同じ姿勢で静止しているのは {whole_s:.1} 秒のうち {still_s:.1} 秒)。わずかな動きでも地球の自転よりはるかに大きいため、方向ごとに終始静止した記録を指定してください"
        ),
    ))
}

fn refused(shown: &str, error: shisei_core::Error, lang: Lang) -> Failure {
    let mut failure = Failure::core(shown, error, lang);
    if failure.exit != Exit::Condition {
        return failure;
    }
    failure.sentence.push_str(&say(
        lang,
        "; turn the sensor to three or more different headings, better eight, some of them upside down",
        "。センサを 3 方向以上 (できれば 8 方向、一部は上下逆さま) に向けて計測してください",
    ));
    failure
}

type Measurement = (Vec<String>, Vec<Direction>, Vec<DirectionSummary>);

/// One recording a direction.
fn recordings(args: &Earth, weights: Weights, lang: Lang) -> Outcome<Measurement> {
    let options = input::options(&args.reading, lang)?;
    let (mut names, mut directions, mut summaries) = (Vec::new(), Vec::new(), Vec::new());
    for path in &args.files {
        let source = Source { paths: vec![path.clone()] };
        let recording = input::open(&source, &options, lang).map_err(|error| error.failure(lang))?;
        let found = &recording.findings;
        if found.resets > 0 || found.backward_stamps > 0 {
            return Err(Failure::input(say(
                lang,
                format!(
                    "{}: the counter goes back ({} times); means by time need one recording without a restart",
                    path.display(),
                    found.resets + found.backward_stamps
                ),
                format!(
                    "{}：カウンタが {} 回逆戻りしています。時間平均には再起動のない記録が必要です",
                    path.display(),
                    found.resets + found.backward_stamps
                ),
            )));
        }
        if let Some(moved) = stillness::moved(&recording.acc_m_s2, &recording.gyro_rad_s, &recording.dt_s) {
            return Err(moving(&source.shown(), moved, lang));
        }
        let temperature = recording.temp_c.as_deref().unwrap_or(&[]);
        let averaged =
            summarise(&recording.gyro_rad_s, &recording.acc_m_s2, temperature, &recording.dt_s, weights)
                .map_err(|e| Failure::core(&source.shown(), e, lang))?;
        let notes = summary::of_notes(&recording, lang);
        if !notes.is_empty() {
            eprint!("{}\n{notes}", source.shown());
        }
        names.push(source.stem());
        directions.push(averaged.direction);
        summaries.push(averaged);
    }
    Ok((names, directions, summaries))
}

/// A table of means: a header with `gyr_x` and fewer rows than any recording has, or our own.
fn table_of_means(args: &Earth, lang: Lang) -> Outcome<Option<Vec<Direction>>> {
    let [path] = args.files.as_slice() else { return Ok(None) };
    let bytes = input::read(path, lang)?;
    let Ok(text) = std::str::from_utf8(&bytes) else { return Ok(None) };
    let mut lines =
        text.trim_start_matches('\u{feff}').lines().filter(|l| !l.trim().is_empty() && !l.starts_with('#'));
    let head: Vec<&str> = lines.next().unwrap_or_default().split(',').map(str::trim).collect();
    let column = |name: &str| head.iter().position(|h| *h == name);
    let triple = |names: [&str; 3]| Some([column(names[0])?, column(names[1])?, column(names[2])?]);
    let Some(gyro) = triple(["gyr_x", "gyr_y", "gyr_z"]) else { return Ok(None) };
    if column("time_s").is_some() || text.lines().count() > 200 {
        return Ok(None);
    }
    let sigma = triple(["sigma_x", "sigma_y", "sigma_z"]);
    let acc = triple(["acc_x", "acc_y", "acc_z"]);
    let heading = column("heading_deg");
    let mut directions = Vec::new();
    for (row, line) in lines.enumerate() {
        let cells: Vec<&str> = line.split(',').map(str::trim).collect();
        let number = |at: usize| -> Outcome<f64> {
            let cell = cells.get(at).copied().unwrap_or_default();
            cell.parse::<f64>().ok().filter(|v| v.is_finite()).ok_or_else(|| {
                Failure::input(say(
                    lang,
                    format!(
                        "{}, row {}: {cell:?} is not a number; give mean rates in rad/s",
                        path.display(),
                        row + 1
                    ),
                    format!(
                        "{}, {} 行目：{cell:?} は数値ではありません。平均角速度を rad/s で指定してください",
                        path.display(),
                        row + 1
                    ),
                ))
            })
        };
        let vector =
            |at: [usize; 3]| -> Outcome<[f64; 3]> { Ok([number(at[0])?, number(at[1])?, number(at[2])?]) };
        directions.push(Direction {
            gyro_rad_s: vector(gyro)?,
            sigma_rad_s: sigma.map(vector).transpose()?,
            acc_m_s2: acc.map(vector).transpose()?,
            heading_rad: heading.map(number).transpose()?.map(f64::to_radians),
        });
    }
    Ok(Some(directions))
}

/// Headings from `--headings`, or from names that end in `_090deg`.
fn set_headings(args: &Earth, names: &[String], directions: &mut [Direction], lang: Lang) -> Outcome<()> {
    let given: Vec<Option<f64>> = if let Some(list) = &args.headings {
        let numbers: Vec<Option<f64>> =
            list.split(',').map(|n| n.trim().parse().ok().filter(|v: &f64| v.is_finite())).collect();
        if numbers.len() != directions.len() || numbers.iter().any(Option::is_none) {
            return Err(Failure::input(say(
                lang,
                format!(
                    "--headings {list}: give one number of degrees for each of the {} directions",
                    directions.len()
                ),
                format!("--headings {list}：{} 方向それぞれの方位を度で指定してください", directions.len()),
            )));
        }
        numbers
    } else {
        names.iter().map(|n| heading_in(n)).collect()
    };
    for (direction, heading) in directions.iter_mut().zip(given) {
        if let Some(heading) = heading {
            direction.heading_rad = Some(heading.to_radians());
        }
    }
    Ok(())
}

/// `log_imu_090deg` → 90.
fn heading_in(name: &str) -> Option<f64> {
    let head =
        name.strip_suffix("deg").or_else(|| name.split("deg").next().filter(|h| h.len() < name.len()))?;
    let digits = head.len() - head.bytes().rev().take_while(u8::is_ascii_digit).count();
    head.get(digits..)?.parse().ok()
}

fn measured(m: Option<Measured>, factor: f64) -> serde_json::Value {
    m.map_or(serde_json::Value::Null, |m| json!({ "value": m.value * factor, "sigma": m.sigma * factor }))
}

fn document(found: &Found) -> serde_json::Value {
    let a = &found.analysis;
    let degree = 1f64.to_degrees();
    json!({
        "believed": earth_text::code(a.believed),
        "rate_rad_s": measured(a.rate, 1.0),
        "horizontal_rad_s": measured(a.horizontal, 1.0),
        "latitude_deg": measured(a.latitude, degree),
        "sidereal_day_h": measured(a.day_h, 1.0),
        "article_sphere_rad_s": a.article.map(|s| s.radius),
        "article_sphere_day_h": a.article.map(|s| std::f64::consts::TAU / s.radius / 3600.0),
        "condition": a.article.map(|s| s.condition).filter(|c| c.is_finite()),
        "flat": a.plane.flat,
        "plane_probability": a.plane.probability,
        "circle_rad_s": { "value": a.circle.radius, "sigma": a.circle.radius_sigma },
        "level_circle_rad_s": measured(a.level_circle.horizontal, 1.0),
        "sphere_rad_s": measured(a.sphere.as_ref().ok().and_then(|f| f.rate), 1.0),
        "levelled_rad_s": measured(a.levelled.as_ref().ok().and_then(|f| f.rate), 1.0),
        "levelled_free_rad_s": measured(a.levelled_free.as_ref().ok().and_then(|f| f.rate), 1.0),
        "by_headings": a.headings_known.map(|h| json!({
            "horizontal_rad_s": measured(Some(h.horizontal), 1.0),
            "north_deg": measured(Some(h.north), degree),
            "opposite_sense_cost_ratio": h.counter_clockwise_cost / h.clockwise_cost.max(1e-300),
            "opposite_sense_probability": h.sense_probability,
        })),
        "bias_rad_s": a.bias_rad_s,
        "directions": found.names.iter().zip(&found.directions).enumerate().map(|(k, (n, d))| json!({
            "name": n,
            "mean_rad_s": d.gyro_rad_s,
            "sigma_rad_s": d.sigma_rad_s,
            "heading_deg": measured(a.headings.get(k).map(|h| h.heading_rad), degree),
        })).collect::<Vec<_>>(),
        "drift_per_s": found.drift.map(|d| json!({ "value": d.per_s, "sigma": d.per_s_sigma })),
        "drift_per_c": found.drift.and_then(|d| d.per_c).map(|c| json!({ "value": c.0, "sigma": c.1 })),
        "add": found.suggestions.iter().map(|s| json!({
            "up": s.face.to_string(),
            "heading_deg": s.heading_rad.to_degrees(),
            "expected_sigma_rad_s": s.expected_sigma_rad_s,
        })).collect::<Vec<_>>(),
    })
}

/// The directions as a table that `shisei earth` reads again.
pub fn directions_csv(directions: &[Direction]) -> String {
    let mut out = String::from("gyr_x,gyr_y,gyr_z,sigma_x,sigma_y,sigma_z,acc_x,acc_y,acc_z\n");
    for d in directions {
        let cells: Vec<String> = d
            .gyro_rad_s
            .into_iter()
            .chain(d.sigma_rad_s.unwrap_or_default())
            .chain(d.acc_m_s2.unwrap_or_default())
            .map(|v| v.to_string())
            .collect();
        out.push_str(&cells.join(","));
        out.push('\n');
    }
    out
}

/// Where the directions of a measurement go.
pub fn directions_path(args: &Earth) -> PathBuf {
    args.output.clone().unwrap_or_else(|| Path::new("directions.csv").to_path_buf())
}

#[cfg(test)]
mod tests {
    use super::heading_in;

    #[test]
    fn headings_in_names() {
        for (name, expected) in [
            ("log_imu_090deg", Some(90.0)),
            ("270deg", Some(270.0)),
            ("a_45deg_again", Some(45.0)),
            ("deg", None),
            ("walk", None),
        ] {
            assert_eq!(heading_in(name), expected, "{name}");
        }
    }
}
