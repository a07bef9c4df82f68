//! What `shisei earth` says: lines for the terminal and the report.

use shisei_core::Lang;
use shisei_core::earth::analysis::{Analysis, Believed, Doubt};
use shisei_core::earth::fits::{Measured, RateFit};
use shisei_core::vector;
use shisei_report::figure::{Figure, Item, project};
use shisei_report::page::{Block, Page};
use shisei_report::plot::{Axis, Tone};

use super::earth::Found;
use crate::fail::say;
use crate::summary::{columns_of, padded};

/// °/h in one rad/s.
const DEG_H: f64 = 180.0 / std::f64::consts::PI * 3600.0;

/// The believed fit's code in JSON.
pub fn code(believed: Believed) -> &'static str {
    match believed {
        Believed::Sphere => "sphere",
        Believed::LevelledWithLatitude => "levelled-with-latitude",
        Believed::LevelledFree => "levelled",
        Believed::CircleWithLatitude => "circle-with-latitude",
        Believed::Circle => "circle",
    }
}

fn per_hour(m: Option<Measured>) -> String {
    m.map_or_else(|| "–".to_owned(), |m| format!("{:.3} ± {:.3} °/h", m.value * DEG_H, m.sigma * DEG_H))
}

fn degrees(m: Measured) -> String {
    format!("{:.1} ± {:.1}°", m.value.to_degrees(), m.sigma.to_degrees())
}

fn doubt(d: Doubt, lang: Lang) -> String {
    match d {
        Doubt::Flat => say(lang, "the directions lie in one plane", "方向が一平面上にあります"),
        Doubt::TooFew => say(lang, "too few directions", "方向の数が足りません"),
        Doubt::NoAcceleration => say(lang, "needs accelerations", "加速度が必要です"),
        Doubt::Undetermined => {
            say(lang, "not determined by these directions", "この方向の組では決まりません")
        }
    }
}

/// Why this fit is believed.
fn reason(found: &Found, lang: Lang) -> String {
    let a = &found.analysis;
    match a.believed {
        Believed::Sphere => say(
            lang,
            "the sphere: the directions fill space",
            "球の当てはめを採用: 方向が空間に広がっています",
        ),
        Believed::LevelledWithLatitude => say(
            lang,
            "the accelerometer-levelled fit with the latitude given: it uses all that is known",
            "加速度で水平を求め、緯度を使った当てはめを採用: 既知の情報をすべて使います",
        ),
        Believed::LevelledFree => say(
            lang,
            "the accelerometer-levelled fit: upright and inverted directions separate the bias from the vertical part",
            "加速度で水平を求めた当てはめを採用: 正立と倒立の方向でバイアスと鉛直成分が分かれます",
        ),
        Believed::CircleWithLatitude => say(
            lang,
            "the circle and the latitude given: the directions lie in one level plane",
            "円の当てはめと緯度を採用: 方向が水平な一平面上にあります",
        ),
        Believed::Circle => say(
            lang,
            "the circle: the directions lie in one plane, so only the horizontal part is known; give --latitude, or add directions, for the day",
            "円の当てはめを採用: 方向が一平面上にあるため、水平成分だけが分かります。恒星日を求めるには --latitude を指定するか、方向を追加してください",
        ),
    }
}

/// The warning about directions in one plane.
fn warnings(a: &Analysis, lang: Lang) -> Vec<String> {
    let mut out = Vec::new();
    if a.plane.flat {
        let condition = a.plane.condition;
        let probability = a.plane.probability.map_or_else(String::new, |p| {
            say(lang, format!(", probability {p:.2} by the noise"), format!("、雑音から見た確率 {p:.2}"))
        });
        out.push(say(
            lang,
            format!(
                "the directions are nearly in one plane (condition number {condition:.0}{probability}): a sphere through them is not determined, its day is chance"
            ),
            format!(
                "方向がほぼ一平面上にあります (条件数 {condition:.0}{probability})。球は決まらないため、球から求めた恒星日は偶然の値です"
            ),
        ));
    }
    if a.headings_known.is_some_and(|h| h.counter_clockwise_cost < h.clockwise_cost) {
        out.push(say(
            lang,
            "the headings fit better the other way round: are they counter-clockwise, or is z down?",
            "方位の向きが逆の方がよく合います。反時計回りの方位か、z 軸が下向きではありませんか",
        ));
    }
    out
}

fn rows(found: &Found, lang: Lang) -> Vec<Vec<String>> {
    let a = &found.analysis;
    let of = |name: String, fit: &Result<RateFit, Doubt>| match fit {
        Ok(f) => vec![name, per_hour(f.rate), f.latitude.map_or_else(|| "–".to_owned(), degrees)],
        Err(d) => vec![name, doubt(*d, lang), String::new()],
    };
    let article = a.article.map_or_else(
        || "–".to_owned(),
        |s| {
            format!(
                "{:.6e} rad/s = {:.3} °/h{}, {:.1} h",
                s.radius,
                s.radius * DEG_H,
                s.radius_sigma.map_or_else(String::new, |v| format!(" ± {:.3}", v * DEG_H)),
                std::f64::consts::TAU / s.radius / 3600.0
            )
        },
    );
    let mut rows = vec![
        vec![say(lang, "sphere, as published", "球 (記事の式)"), article, String::new()],
        of(say(lang, "sphere, geometric", "球 (幾何学的)"), &a.sphere),
        vec![
            say(lang, "plain circle: Ω cos φ", "円 (そのまま): Ω cos φ"),
            format!(
                "{:.3} °/h{}",
                a.circle.radius * DEG_H,
                a.circle.radius_sigma.map_or_else(String::new, |s| format!(" ± {:.3}", s * DEG_H))
            ),
            String::new(),
        ],
        vec![
            say(lang, "level circle: Ω cos φ", "水平面の円: Ω cos φ"),
            per_hour(a.level_circle.horizontal),
            String::new(),
        ],
        of(say(lang, "levelled", "水平補正"), &a.levelled_free),
    ];
    if found.latitude_given {
        rows.push(of(say(lang, "levelled, latitude given", "水平補正 (緯度既知)"), &a.levelled));
    }
    if let Some(h) = &a.headings_known {
        rows.push(vec![
            say(lang, "by the headings: Ω cos φ", "方位による: Ω cos φ"),
            per_hour(Some(h.horizontal)),
            say(
                lang,
                format!(
                    "north at {:.1} ± {:.1}° of them; the opposite sense fits {:.0} times worse",
                    h.north.value.to_degrees().rem_euclid(360.0),
                    h.north.sigma.to_degrees(),
                    h.counter_clockwise_cost / h.clockwise_cost.max(1e-300)
                ),
                format!(
                    "真北はその {:.1} ± {:.1}°。逆回りでは残差が {:.0} 倍",
                    h.north.value.to_degrees().rem_euclid(360.0),
                    h.north.sigma.to_degrees(),
                    h.counter_clockwise_cost / h.clockwise_cost.max(1e-300)
                ),
            ),
        ]);
    }
    rows
}

fn facts(found: &Found, lang: Lang) -> Vec<(String, String)> {
    let a = &found.analysis;
    let mut facts = Vec::new();
    if let Some(day) = a.day_h {
        facts.push((say(lang, "Sidereal day", "恒星日"), format!("{:.2} ± {:.2} h", day.value, day.sigma)));
    }
    if a.rate.is_some() {
        facts.push((say(lang, "Rate Ω", "自転角速度 Ω"), per_hour(a.rate)));
    }
    if a.horizontal.is_some() {
        facts.push((say(lang, "Horizontal part Ω cos φ", "水平成分 Ω cos φ"), per_hour(a.horizontal)));
    }
    if let (Some(latitude), false) = (a.latitude, found.latitude_given) {
        let name = if a.believed == Believed::LevelledFree {
            say(lang, "Latitude", "緯度")
        } else {
            say(
                lang,
                "Latitude, if Ω is taken as known (north or south)",
                "緯度 (Ω を既知とした場合、北緯か南緯)",
            )
        };
        facts.push((name, degrees(latitude)));
    }
    facts
}

fn direction_head(lang: Lang) -> Vec<String> {
    match lang {
        Lang::En => ["direction", "x", "y", "z", "heading", "span, gaps"],
        Lang::Ja => ["方向", "x", "y", "z", "方位", "長さ、欠落数"],
    }
    .map(str::to_owned)
    .to_vec()
}

fn direction_rows(found: &Found) -> Vec<Vec<String>> {
    found
        .directions
        .iter()
        .enumerate()
        .map(|(k, d)| {
            let s = d.sigma_rad_s;
            let part = |i: usize| {
                s.map_or_else(
                    || format!("{:.2}", d.gyro_rad_s[i] * DEG_H),
                    |s| format!("{:.2} ± {:.2}", d.gyro_rad_s[i] * DEG_H, s[i] * DEG_H),
                )
            };
            let heading = found.analysis.headings.get(k).map_or_else(String::new, |h| degrees(h.heading_rad));
            let extra = found
                .summaries
                .get(k)
                .map_or_else(String::new, |m| format!("{:.1} s, {}", m.mean.span_s, m.mean.long_steps));
            let name = found.names.get(k).cloned().unwrap_or_default();
            vec![name, part(0), part(1), part(2), heading, extra]
        })
        .collect()
}

fn advice(found: &Found, lang: Lang) -> Vec<String> {
    found
        .suggestions
        .iter()
        .map(|s| {
            let sigma = s.expected_sigma_rad_s * DEG_H;
            let heading = s.heading_rad.to_degrees();
            say(
                lang,
                format!("{} up, forward {heading:.0}° from north: then Ω to about ± {sigma:.2} °/h", s.face),
                format!(
                    "{} を上、前方を真北から {heading:.0}° に向ける: Ω の誤差は約 ± {sigma:.2} °/h",
                    s.face
                ),
            )
        })
        .collect()
}

fn drift_lines(found: &Found, lang: Lang) -> Vec<String> {
    let Some(d) = found.drift else { return Vec::new() };
    let text = |v: [f64; 3], s: [f64; 3], factor: f64| {
        (0..3).map(|i| format!("{:.2} ± {:.2}", v[i] * factor, s[i] * factor)).collect::<Vec<_>>().join(", ")
    };
    let mut out = vec![say(
        lang,
        format!(
            "bias drift within the recordings: {} °/h per minute",
            text(d.per_s, d.per_s_sigma, DEG_H * 60.0)
        ),
        format!("記録内のバイアスのドリフト: 1 分あたり {} °/h", text(d.per_s, d.per_s_sigma, DEG_H * 60.0)),
    )];
    match d.per_c {
        Some((v, s)) => out.push(say(
            lang,
            format!("with temperature: {} °/h per °C", text(v, s, DEG_H)),
            format!("温度による変化: 1 °C あたり {} °/h", text(v, s, DEG_H)),
        )),
        None => out.push(say(
            lang,
            format!(
                "temperature changed by {:.2} °C only: its effect is not determined",
                d.temperature_span_c
            ),
            format!("温度変化が {:.2} °C しかないため、温度の影響は求められません", d.temperature_span_c),
        )),
    }
    out
}

/// Lines for the terminal.
pub fn lines(found: &Found, lang: Lang) -> Vec<String> {
    let mut out = vec![say(lang, "mean rates, °/h:", "平均角速度 [°/h]:")];
    let mut table = vec![direction_head(lang)];
    table.extend(direction_rows(found));
    let columns = if found.summaries.is_empty() { 5 } else { 6 };
    let widths: Vec<usize> =
        (0..columns).map(|k| table.iter().map(|row| columns_of(&row[k])).max().unwrap_or(0) + 2).collect();
    for row in &table {
        let cells: String = row.iter().zip(&widths).map(|(cell, width)| padded(cell, *width)).collect();
        out.push(format!("  {}", cells.trim_end()));
    }
    for row in rows(found, lang) {
        out.push(format!(
            "  {}",
            row.iter().filter(|c| !c.is_empty()).cloned().collect::<Vec<_>>().join(": ")
        ));
    }
    out.extend(warnings(&found.analysis, lang).into_iter().map(|w| format!("! {w}")));
    out.push(reason(found, lang));
    out.extend(facts(found, lang).into_iter().map(|(n, v)| format!("{n}: {v}")));
    out.extend(drift_lines(found, lang));
    out.push(say(lang, "directions to add:", "追加すると良い方向:"));
    out.extend(advice(found, lang).into_iter().map(|l| format!("  {l}")));
    out
}

/// The report.
pub fn page(found: &Found, shown: &str, lang: Lang) -> String {
    let mut blocks = figures(found, lang);
    blocks.push(Block::Table {
        heading: say(lang, "Directions (°/h)", "各方向 (°/h)"),
        head: direction_head(lang),
        rows: direction_rows(found),
    });
    blocks.push(Block::Table {
        heading: say(lang, "All fits", "すべての当てはめ"),
        head: match lang {
            Lang::En => ["fit", "rate", ""],
            Lang::Ja => ["方法", "角速度", ""],
        }
        .map(str::to_owned)
        .to_vec(),
        rows: rows(found, lang),
    });
    blocks.push(Block::List {
        heading: say(lang, "Directions to add", "追加すると良い方向"),
        items: advice(found, lang),
    });
    let drift = drift_lines(found, lang);
    if !drift.is_empty() {
        blocks.push(Block::List { heading: say(lang, "Drift", "ドリフト"), items: drift });
    }
    let mut facts = facts(found, lang);
    facts.push((say(lang, "Believed", "採用"), reason(found, lang)));
    Page {
        lang,
        title: say(lang, "The Earth's rotation", "地球の自転"),
        sources: vec![shown.to_owned()],
        facts,
        warnings: warnings(&found.analysis, lang),
        plots: Vec::new(),
        attitude: None,
        blocks,
        generator: concat!("shisei ", env!("CARGO_PKG_VERSION")).to_owned(),
    }
    .to_html()
}

fn figures(found: &Found, lang: Lang) -> Vec<Block> {
    let a = &found.analysis;
    let normal = a.plane.normal;
    let (e1, e2) = shisei_core::earth::fits::level_axes(normal);
    let centre = a.circle.center;
    let flat = |p: [f64; 3]| {
        let d = vector::sub(p, centre);
        [vector::dot(d, e1) * DEG_H, vector::dot(d, e2) * DEG_H]
    };
    let ring = |k: i32| {
        let (s, c) = shisei_core::math::sin_cos(f64::from(k) * std::f64::consts::TAU / 72.0);
        let r = a.circle.radius;
        vector::add(vector::scale(e1, r * c), vector::scale(e2, r * s))
    };
    let points: Vec<[f64; 3]> = found.directions.iter().map(|d| d.gyro_rad_s).collect();
    let labels: Vec<String> = (1..=points.len()).map(|k| k.to_string()).collect();
    let mut items = vec![Item::Line {
        points: (0..=72)
            .map(|k| ring(k).map(|v| v * DEG_H))
            .map(|v| [vector::dot(v, e1), vector::dot(v, e2)])
            .collect(),
        tone: Tone::Plain,
        dashed: true,
    }];
    // residuals: from each point to the circle
    for p in &points {
        let q = flat(*p);
        let n = shisei_core::math::hypot(q[0], q[1]).max(1e-12);
        let r = a.circle.radius * DEG_H / n;
        items.push(Item::Line { points: vec![q, [q[0] * r, q[1] * r]], tone: Tone::X, dashed: false });
    }
    items.push(Item::Dots {
        points: points.iter().map(|p| flat(*p)).collect(),
        tone: Tone::Z,
        labels: labels.clone(),
    });
    let heading = say(lang, "In their plane, with the circle and residuals", "最適平面上の配置と円、残差");
    let plan = Block::Figure {
        figure: Figure {
            description: heading.clone(),
            x: Axis::linear("", "°/h"),
            y: Axis::linear("", "°/h"),
            equal: true,
            items,
            legend: Vec::new(),
        },
        heading,
    };
    let space = |p: [f64; 3]| project(vector::scale(vector::sub(p, centre), DEG_H));
    let heading = say(lang, "In space", "空間での配置");
    let axis = a.circle.radius;
    let axes = [[axis, 0.0, 0.0], [0.0, axis, 0.0], [0.0, 0.0, axis]];
    let mut items = vec![Item::Line {
        points: (0..=72).map(|k| space(vector::add(centre, ring(k)))).collect(),
        tone: Tone::Plain,
        dashed: true,
    }];
    for (v, tone) in axes.into_iter().zip([Tone::X, Tone::Y, Tone::Z]) {
        items.push(Item::Line {
            points: vec![space(centre), space(vector::add(centre, v))],
            tone,
            dashed: false,
        });
    }
    items.push(Item::Dots { points: points.iter().map(|p| space(*p)).collect(), tone: Tone::Z, labels });
    let room = Block::Figure {
        figure: Figure {
            description: heading.clone(),
            x: Axis::linear("", "°/h"),
            y: Axis::linear("", "°/h"),
            equal: true,
            items,
            legend: vec![(Tone::X, "x".to_owned()), (Tone::Y, "y".to_owned()), (Tone::Z, "z".to_owned())],
        },
        heading,
    };
    let heading = say(lang, "Mean ± standard error of each direction", "各方向の平均 ± 標準誤差");
    let mut items = Vec::new();
    for (i, tone) in [Tone::X, Tone::Y, Tone::Z].into_iter().enumerate() {
        let at = |k: usize| k as f64 + 1.0 + 0.12 * (i as f64 - 1.0);
        let bars = found.directions.iter().enumerate().filter_map(|(k, d)| {
            let s = d.sigma_rad_s?[i];
            Some([at(k), (d.gyro_rad_s[i] - s) * DEG_H, (d.gyro_rad_s[i] + s) * DEG_H])
        });
        items.push(Item::Bars { points: bars.collect(), tone });
        let dots = found.directions.iter().enumerate().map(|(k, d)| [at(k), d.gyro_rad_s[i] * DEG_H]);
        items.push(Item::Dots { points: dots.collect(), tone, labels: Vec::new() });
    }
    let means = Block::Figure {
        figure: Figure {
            description: heading.clone(),
            x: Axis::linear(&say(lang, "direction", "方向"), ""),
            y: Axis::linear(&say(lang, "mean rate", "平均角速度"), "°/h"),
            equal: false,
            items,
            legend: vec![(Tone::X, "x".to_owned()), (Tone::Y, "y".to_owned()), (Tone::Z, "z".to_owned())],
        },
        heading,
    };
    vec![plan, room, means]
}
