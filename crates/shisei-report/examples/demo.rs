//! Writes a plausible report in both languages, its PNGs and the same page with hostile names, to a
//! directory: `demo [DIR] [SECONDS]`.

use std::path::PathBuf;

use shisei_core::{Lang, Quaternion, Ypr, math};
use shisei_report::orientation::{self, OrientationReport, Uncertainty};

const RATE_HZ: f64 = 100.0;
const GRAVITY_M_S2: f64 = 9.80665;

/// 0 before `from`, 1 after `to`, smooth between.
fn smooth_step(t: f64, from: f64, to: f64) -> f64 {
    let x = ((t - from) / (to - from)).clamp(0.0, 1.0);
    x * x * x * (10.0 - 15.0 * x + 6.0 * x * x)
}

/// Out to 1 and back within `from` … `to`.
fn swing(t: f64, from: f64, to: f64) -> f64 {
    let middle = 0.5 * (from + to);
    smooth_step(t, from, middle) - smooth_step(t, middle, to)
}

/// Still for 3 s, then twist left and right, bend, lean, and a full turn.
fn ypr_at(t: f64) -> [f64; 3] {
    let late = (t - 22.0).max(0.0);
    let sway = smooth_step(t, 22.0, 24.0);
    [
        0.7 * swing(t, 3.5, 6.5) - 0.65 * swing(t, 6.5, 9.5)
            + 2.0 * core::f64::consts::PI * smooth_step(t, 17.0, 21.0)
            + 0.25 * sway * math::sin(1.3 * late),
        0.9 * swing(t, 10.0, 13.0)
            + 0.03 * math::sin(4.0 * t) * smooth_step(t, 3.0, 4.0)
            + 0.15 * sway * math::sin(0.9 * late),
        0.5 * swing(t, 13.0, 15.0) - 0.45 * swing(t, 15.0, 17.0) + 0.1 * sway * math::sin(2.1 * late),
    ]
}

struct Noise(u64);

impl Noise {
    /// Roughly normal, sigma 1: a sum of twelve uniform numbers.
    fn next(&mut self) -> f64 {
        let mut sum = -6.0;
        for _ in 0..12 {
            self.0 = self.0 * 48271 % 2147483647;
            sum += self.0 as f64 / 2147483647.0;
        }
        sum
    }
}

fn wrapped(angle_rad: f64) -> f64 {
    let turn = 2.0 * core::f64::consts::PI;
    angle_rad - turn * math::floor(angle_rad / turn + 0.5)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut args = std::env::args().skip(1);
    let dir = PathBuf::from(args.next().unwrap_or_else(|| "target/report-demo".to_owned()));
    let seconds: f64 = args.next().map_or(Ok(30.0), |s| s.parse())?;
    std::fs::create_dir_all(&dir)?;

    let gap = (14.2, 14.6);
    let mut noise = Noise(20_250_101);
    let (mut time_s, mut ypr_rad, mut attitude) = (Vec::new(), Vec::new(), Vec::new());
    let (mut acc, mut gyro, mut tilt, mut heading) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for k in 0..(seconds * RATE_HZ) as usize {
        let t = k as f64 / RATE_HZ;
        if t > gap.0 && t < gap.1 {
            continue;
        }
        let q = Quaternion::from_ypr(Ypr::from_array(ypr_at(t)));
        let next = Quaternion::from_ypr(Ypr::from_array(ypr_at(t + 1e-3)));
        let rate = q.conjugate().product(next).to_rotation_vector().map(|w| w * 1e3);
        let moving = smooth_step(t, 3.0, 3.6);
        time_s.push(t);
        ypr_rad.push(ypr_at(t).map(wrapped));
        attitude.push(q);
        gyro.push(rate.map(|w| w + 0.004 + 0.003 * noise.next()));
        acc.push(q.up_body().map(|u| GRAVITY_M_S2 * u + (0.03 + 0.25 * moving) * noise.next()));
        tilt.push(0.006 + 0.02 * moving + 0.05 * swing(t, 13.6, 17.0));
        heading.push(0.002 + 0.004 * t.min(60.0) + 0.05 * smooth_step(t, gap.0, gap.1));
    }

    for (lang, name) in [(Lang::En, "en"), (Lang::Ja, "ja")] {
        let words = words(lang);
        let sources = ["pelvis.csv".to_owned()];
        let report = OrientationReport {
            lang,
            title: words.title,
            source_names: &sources,
            time_s: &time_s,
            ypr_rad: &ypr_rad,
            world_from_body: &attitude,
            acc_m_s2: &acc,
            gyro_rad_s: &gyro,
            rests: &[(0.0, 3.0)],
            gaps: &[gap],
            uncertainty: Some(Uncertainty {
                sigma_tilt_rad: &tilt,
                sigma_heading_rad: &heading,
                poor: &[(14.6, 15.6)],
            }),
            summary: &words.summary,
            assumptions: &words.assumptions,
            warnings: &words.warnings,
            degrees: true,
            generator: concat!("shisei ", env!("CARGO_PKG_VERSION")),
        };
        let page = orientation::html(&report)?;
        let (html_path, png_path) = (dir.join(format!("{name}.html")), dir.join(format!("{name}.png")));
        println!("{}: {} bytes", html_path.display(), page.len());
        std::fs::write(html_path, page)?;
        let picture = orientation::png(&report, 1600, 900)?;
        println!("{}: {} bytes", png_path.display(), picture.len());
        std::fs::write(png_path, picture)?;

        // the same with names that try to break out of their places, for the browser check
        let attack = "</script><script>window.broken=1</script>\"'><img src=x onerror=window.broken=1>";
        let attacks = [attack.to_owned()];
        let pairs = [(attack.to_owned(), attack.to_owned())];
        let hostile = OrientationReport {
            title: attack,
            source_names: &attacks,
            summary: &pairs,
            assumptions: &attacks,
            warnings: &attacks,
            generator: attack,
            ..report
        };
        std::fs::write(dir.join(format!("{name}-hostile.html")), orientation::html(&hostile)?)?;
    }
    Ok(())
}

struct Words {
    title: &'static str,
    summary: Vec<(String, String)>,
    assumptions: Vec<String>,
    warnings: Vec<String>,
}

fn words(lang: Lang) -> Words {
    let owned = |items: &[&str]| items.iter().map(|s| (*s).to_owned()).collect();
    let pairs =
        |items: &[(&str, &str)]| items.iter().map(|(a, b)| ((*a).to_owned(), (*b).to_owned())).collect();
    match lang {
        Lang::En => Words {
            title: "Orientation of pelvis.csv",
            summary: pairs(&[
                ("Duration", "30.0 s, 2,961 samples"),
                ("Rate", "100.00 Hz"),
                ("Filter", "Mahony, kp 0.2, ki 0"),
                ("Rest used", "0.00 s to 3.00 s"),
                ("Gyroscope bias removed", "0.23, 0.23, 0.23 °/s"),
                ("Angles relative to", "the start, in world axes"),
            ]),
            assumptions: owned(&[
                "Accelerations are in g (the header says so) and were multiplied with 9.80665 m/s².",
                "Rates are in degrees per second (the header says so).",
                "The time stamps are milliseconds from the first row.",
                "Yaw is 0 at the start: no compass was used, so the heading drifts slowly.",
            ]),
            warnings: owned(&[
                "There are no samples between 14.20 s and 14.60 s; the heading after it is less certain.",
            ]),
        },
        Lang::Ja => Words {
            title: "骨盤.csv の姿勢",
            summary: pairs(&[
                ("記録の長さ", "30.0 秒、2,961 点"),
                ("サンプリング周波数", "100.00 Hz"),
                ("フィルター", "Mahony、kp 0.2、ki 0"),
                ("使用した静止区間", "0.00 秒から 3.00 秒"),
                ("除去したジャイロのバイアス", "0.23, 0.23, 0.23 °/s"),
                ("角度の基準", "開始時の姿勢 (世界座標系の軸)"),
            ]),
            assumptions: owned(&[
                "加速度の単位は g とし (見出しの記載による)、9.80665 m/s² を掛けました。",
                "角速度の単位は度毎秒としました (見出しの記載による)。",
                "時刻は先頭行からのミリ秒としました。",
                "開始時のヨーを 0 としました。方位センサーを使わないため、方位は少しずつずれます。",
            ]),
            warnings: owned(&[
                "14.20 秒から 14.60 秒の間にサンプルがありません。それ以降の方位は不確かさが大きくなります。",
            ]),
        },
    }
}
