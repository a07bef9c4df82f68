//! Sony Spresense multi-IMU board (CXD5602PWBIMU): eight hexadecimal fields a line.
//!
//! Counter of 19.2 MHz (unsigned, 32 bits, wraps every 223.7 s), then big-endian float32: temperature °C,
//! gyroscope x y z rad/s, acceleration x y z m/s². Samples come in bursts with pauses between.

use super::WholeFile;
use crate::body::{Body, TimeForm, Wanted};
use crate::error::{Error, Place, Problem, Result, shorten};
use crate::names::Grade;
use crate::number::trim;
use crate::open::{Clock, Part, RawCycle, finish_time};
use crate::options::Options;
use crate::plan::Triple;
use crate::recording::{Channel, Note};
use crate::sheet::line_at;
use crate::units::{M_S2, RAD_S, Unit};

/// The clock of the counter, Hz.
const COUNTER_HZ: f64 = 19_200_000.0;

/// The dialect.
pub const DIALECT: WholeFile = WholeFile {
    id: "spresense",
    name: "Spresense multi-IMU board (hexadecimal log)",
    layout: "text, 8 hexadecimal fields a line",
    layout_ja: "テキスト、1 行に 16 進数 8 個",
    recognises,
    read,
};

/// The eight words of a line.
fn words(line: &[u8]) -> Option<[u32; 8]> {
    let mut out = [0u32; 8];
    let mut fields = trim(line).split(|b| *b == b',');
    for word in &mut out {
        let field = fields.next()?;
        if field.len() != 8 {
            return None;
        }
        for byte in field {
            let digit = char::from(*byte).to_digit(16)?;
            *word = *word << 4 | digit;
        }
    }
    fields.next().is_none().then_some(out)
}

fn recognises(bytes: &[u8]) -> bool {
    let mut at = 0;
    let mut good = 0;
    for _ in 0..12 {
        let Some(head) = bytes.get(at..bytes.len().min(at + 4096)) else { break };
        let Some((line, next)) = line_at(head, 0) else { break };
        match words(line) {
            Some(_) => good += 1,
            // Messages of the logger may stand before the first line.
            None if good == 0 => {}
            None => return false,
        }
        at += next;
    }
    good >= 2
}

fn read(name: &str, bytes: &[u8], options: &Options) -> Result<Part> {
    let mut body = Body::default();
    let (mut at, mut line_number) = (0, 0);
    let mut pending: Option<Error> = None;
    while let Some((line, next)) = line_at(bytes, at) {
        at = next;
        line_number += 1;
        if trim(line).is_empty() {
            continue;
        }
        let Some(w) = words(line) else {
            if body.rows == 0 {
                continue;
            }
            if options.skip_bad_rows {
                body.skipped += 1;
                continue;
            }
            let text = shorten(&String::from_utf8_lossy(line.get(..line.len().min(80)).unwrap_or_default()));
            let place = Place { file: name.to_owned(), line: Some(line_number), column: None };
            pending.get_or_insert(Error::at(Problem::NotANumber { text }, place));
            continue;
        };
        if let Some(error) = pending.take() {
            return Err(error);
        }
        let f = w.map(|bits| f64::from(f32::from_bits(bits)));
        let [_, temp, gx, gy, gz, ax, ay, az] = f;
        if let Some(column) = f.iter().skip(1).position(|v| !v.is_finite()) {
            if options.skip_bad_rows {
                body.skipped += 1;
                continue;
            }
            let text = format!("{:08x}", w.get(column + 1).copied().unwrap_or(0));
            let column = Some((column + 2, String::new()));
            return Err(Error::at(
                Problem::NotFinite { text },
                Place { file: name.to_owned(), line: Some(line_number), column },
            ));
        }
        body.time.push(f64::from(w[0]));
        body.temp.push(temp);
        body.gyro.push([gx, gy, gz]);
        body.acc.push([ax, ay, az]);
        body.rows += 1;
    }
    if pending.is_some() {
        body.trimmed += 1;
    }
    if body.rows < 2 {
        return Err(Error::of_file(name, Problem::TooFewRows { rows: body.rows }));
    }
    let triple = |first: usize, unit: Unit| {
        Some(Triple {
            columns: [first, first + 1, first + 2],
            unit: Some(unit),
            label: String::new(),
            grade: Grade::Plain,
        })
    };
    let mut part = Part {
        name: name.to_owned(),
        dialect: DIALECT.id,
        acc: triple(5, M_S2),
        gyro: triple(2, RAD_S),
        body,
        channels: channels(name),
        ..Part::default()
    };
    part.assumptions.push(Note::new(
        "spresense",
        "fields are the 19.2 MHz counter, temperature, gyroscope (rad/s) and acceleration (m/s²) as the board's \
         logger writes them"
            .into(),
        "各行は 19.2 MHz カウンタ、温度、ジャイロ (rad/s)、加速度 (m/s²) として読みます (ボードのロガーの形式)"
            .into(),
    ));
    let clock = Clock {
        unit: Some(Unit::Time(1.0 / COUNTER_HZ, "ticks of 1/19.2 MHz")),
        cycle: RawCycle::Raw(4_294_967_296.0),
        ..Clock::default()
    };
    let wanted = Wanted { time_form: TimeForm::Number, ..Wanted::default() };
    // The counter counts from power-up: time starts at 0.
    let first = part.body.time.first().copied().unwrap_or(0.0);
    for t in &mut part.body.time {
        *t -= first;
    }
    if options.rate_hz.is_some() {
        part.body.time.clear();
    }
    finish_time(&mut part, clock, &wanted, options)?;
    Ok(part)
}

fn channels(file: &str) -> Vec<Channel> {
    let columns = [
        ("counter", "1/19.2 MHz", "time_s"),
        ("temperature", "°C", "temp_c"),
        ("gyroscope x", "rad/s", "gyr_x"),
        ("gyroscope y", "rad/s", "gyr_y"),
        ("gyroscope z", "rad/s", "gyr_z"),
        ("acceleration x", "m/s²", "acc_x"),
        ("acceleration y", "m/s²", "acc_y"),
        ("acceleration z", "m/s²", "acc_z"),
    ];
    columns
        .iter()
        .enumerate()
        .map(|(i, (name, unit, role))| Channel {
            number: i + 1,
            file: file.to_owned(),
            name: (*name).to_owned(),
            unit: (*unit).to_owned(),
            role: (*role).to_owned(),
            used: true,
        })
        .collect()
}
