//! `shisei earth --serial`: guides through the directions and reads the board.

use std::time::{Duration, Instant};

use shisei_core::Lang;
use shisei_core::earth::direction::summarise;
use shisei_core::earth::{SPRESENSE_TICK_HZ, Weights};
use shisei_record::spresense_stream::{Frame, Splitter};

use super::earth::{directions_csv, directions_path};
use crate::args::Earth;
use crate::fail::{Failure, Outcome, say};
use crate::output::{Kind, Writer};
use crate::stillness;

/// Readings a block: 30 blocks a second, 1.8 kB/s, whatever the baud rate.
const BLOCK: u32 = 64;
/// The board says something at least this often while it streams, s.
const SILENCE_S: u64 = 5;

type Measurement = (
    Vec<String>,
    Vec<shisei_core::earth::direction::Direction>,
    Vec<shisei_core::earth::direction::DirectionSummary>,
);

/// Measures all directions; each begins when the user presses Enter.
pub fn measure(args: &Earth, port: &str, writer: &Writer, lang: Lang) -> Outcome<Measurement> {
    let path = directions_path(args);
    writer.check_all(&[(&path, Kind::Table)])?;
    let (count, seconds) = (args.directions.unwrap_or(8), args.seconds.unwrap_or(65));
    if !(3..=100).contains(&count) || !(1..=3600).contains(&seconds) {
        return Err(Failure::input(say(
            lang,
            "give --directions from 3 to 100 and --seconds from 1 to 3600",
            "--directions は 3〜100、--seconds は 1〜3600 で指定してください",
        )));
    }
    let failed = |error: &dyn std::fmt::Display| {
        Failure::input(say(
            lang,
            format!("{port}: {error}; is the board connected, and no other program using the port?"),
            format!(
                "{port}：{error}。ボードの接続と、他のプログラムがポートを使用していないことを確認してください"
            ),
        ))
    };
    let mut line = serialport::new(port, args.baud.unwrap_or(115_200))
        .timeout(Duration::from_millis(200))
        .open()
        .map_err(|e| failed(&e))?;
    let (mut names, mut directions, mut summaries) = (Vec::new(), Vec::new(), Vec::new());
    while names.len() < count {
        let k = names.len() + 1;
        eprintln!(
            "{}",
            say(
                lang,
                format!("direction {k} of {count}: {}; press Enter when the board lies still", hint(k, lang)),
                format!(
                    "{count} 方向中 {k} 方向目: {}。ボードが静止したら Enter を押してください",
                    hint(k, lang)
                ),
            )
        );
        let mut answer = String::new();
        if std::io::stdin().read_line(&mut answer).map_err(|e| failed(&e))? == 0 {
            return Err(Failure::input(say(
                lang,
                format!("the input ended at direction {k}"),
                format!("{k} 方向目で入力が終わりました"),
            )));
        }
        let Some(summary) = one(&mut *line, seconds, port, lang)? else {
            eprintln!(
                "{}",
                say(
                    lang,
                    "  the board moved; this direction is measured again",
                    "  ボードが動きました。この方向を計測し直します",
                )
            );
            continue;
        };
        names.push(k.to_string());
        directions.push(summary.direction);
        summaries.push(summary);
        // what has been measured is kept even when a later direction fails
        writer.write(&path, Kind::Table, |out| out.write_all(directions_csv(&directions).as_bytes()))?;
    }
    eprintln!("→ {}", path.display());
    Ok((names, directions, summaries))
}

/// What to do before direction k: four headings upright, four upside down.
fn hint(k: usize, lang: Lang) -> String {
    let inverted = (k - 1) % 8 >= 4;
    let heading = (k - 1) % 4 * 90;
    match (inverted, lang) {
        (false, Lang::En) => format!("upright, turned to {heading}°"),
        (true, Lang::En) => format!("upside down, turned to {heading}°"),
        (false, Lang::Ja) => format!("正立、方位 {heading}°"),
        (true, Lang::Ja) => format!("上下逆さま、方位 {heading}°"),
    }
}

/// One direction; none where the board moved.
fn one(
    line: &mut dyn serialport::SerialPort,
    seconds: u32,
    port: &str,
    lang: Lang,
) -> Outcome<Option<shisei_core::earth::direction::DirectionSummary>> {
    let failed = |what: String| {
        Failure::condition(say(
            lang,
            format!("{port}: {what}; load apps/spresense/earth_rate and check --baud"),
            format!("{port}：{what}。apps/spresense/earth_rate を書き込み、--baud を確認してください"),
        ))
    };
    line.write_all(format!("xk{BLOCK}\n").as_bytes()).map_err(|e| failed(e.to_string()))?;
    let mut splitter = Splitter::default();
    let (mut gyro, mut acc, mut temperature, mut dt) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let (mut last_ticks, mut expected, mut lost) = (None::<u32>, None::<u16>, 0_u32);
    let (mut dropped, mut missed) = (0, 0);
    let mut heard = Instant::now();
    let mut elapsed = 0.0;
    let mut buffer = [0; 4096];
    while elapsed < f64::from(seconds) {
        let n = match line.read(&mut buffer) {
            Ok(n) => n,
            Err(e) if e.kind() == std::io::ErrorKind::TimedOut => 0,
            Err(e) => return Err(failed(e.to_string())),
        };
        for frame in splitter.push(buffer.get(..n).unwrap_or(&[])) {
            heard = Instant::now();
            let sequence = match frame {
                Frame::Sample { sequence, .. }
                | Frame::Block { sequence, .. }
                | Frame::Status { sequence, .. } => sequence,
            };
            if let Some(expected) = expected {
                lost += u32::from(sequence.wrapping_sub(expected));
            }
            expected = Some(sequence.wrapping_add(1));
            match frame {
                Frame::Block { last_ticks: ticks, temp_c, gyro_rad_s, acc_m_s2, .. } => {
                    if let Some(before) = last_ticks {
                        let step = f64::from(ticks.wrapping_sub(before)) / SPRESENSE_TICK_HZ;
                        elapsed += step;
                        gyro.push(gyro_rad_s);
                        acc.push(acc_m_s2);
                        temperature.push(temp_c);
                        dt.push(step);
                    }
                    last_ticks = Some(ticks);
                }
                Frame::Status { dropped: d, missed: m, .. } => (dropped, missed) = (d, m),
                Frame::Sample { .. } => {}
            }
        }
        if heard.elapsed() > Duration::from_secs(SILENCE_S) {
            let _ = line.write_all(b"x");
            return Err(failed(say(
                lang,
                format!("nothing understandable for {SILENCE_S} s ({} damaged frames)", splitter.damaged),
                format!("{SILENCE_S} 秒間、正しいデータがありません (破損フレーム {} 個)", splitter.damaged),
            )));
        }
    }
    line.write_all(b"x").map_err(|e| failed(e.to_string()))?;
    drain(line);
    if lost + dropped + missed > 0 {
        eprintln!(
            "{}",
            say(
                lang,
                format!(
                    "  lost: {lost} frames on the line, {dropped} dropped by the board, {missed} readings by the sensor"
                ),
                format!("  欠落: 回線 {lost} フレーム、ボード {dropped} フレーム、センサ {missed} サンプル"),
            )
        );
    }
    if stillness::moved(&acc, &gyro, &dt).is_some() {
        return Ok(None);
    }
    let found = summarise(&gyro, &acc, &temperature, &dt, Weights::Capped);
    found.map(Some).map_err(|e| Failure::core(port, e, lang))
}

/// What was on its way when the stream was stopped.
fn drain(line: &mut dyn serialport::SerialPort) {
    let mut buffer = [0; 4096];
    let start = Instant::now();
    while start.elapsed() < Duration::from_secs(2) {
        match line.read(&mut buffer) {
            Ok(n) if n > 0 => {}
            _ => return,
        }
    }
}
