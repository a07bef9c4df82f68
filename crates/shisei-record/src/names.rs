//! What a column's name says: quantity, axis, unit, sensor.

use crate::units::{self, Unit};
use crate::words::{ACC, COUNTER, FILLER, GYRO, NO_GRAVITY, OTHER, TEMPERATURE, TIME};

/// What a column measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Acceleration with gravity (specific force).
    Acceleration,
    /// Acceleration from which gravity was taken.
    LinearAcceleration,
    /// The gravity part alone.
    Gravity,
    /// Angular rate.
    AngularRate,
    /// Temperature.
    Temperature,
    /// A time stamp.
    Time,
    /// A running number of samples.
    Counter,
    /// A bare axis: the quantity must come from the unit, the file's name or the values.
    Axis,
    /// Something else: magnetic field, attitude, velocity, …
    Other,
}

/// How raw the numbers are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Grade {
    /// The maker's calibration is applied.
    Calibrated,
    /// Nothing is said.
    #[default]
    Plain,
    /// The name says it is uncalibrated.
    Uncalibrated,
    /// The name says raw.
    Raw,
}

/// A column's meaning.
#[derive(Clone, Debug, PartialEq)]
pub struct Meaning {
    /// What it measures.
    pub quantity: Quantity,
    /// 0, 1, 2 for x, y, z.
    pub axis: Option<u8>,
    /// The unit that is written.
    pub unit: Option<Unit>,
    /// How raw it is.
    pub grade: Grade,
    /// The words that are left: which sensor, which body part.
    pub label: String,
    /// The quantity is in the name, not only in the unit.
    pub named: bool,
}

impl Meaning {
    /// A column that is not used.
    pub fn other() -> Self {
        Meaning {
            quantity: Quantity::Other,
            axis: None,
            unit: None,
            grade: Grade::Plain,
            label: String::new(),
            named: false,
        }
    }
}

/// A full-width letter, digit or sign as its ordinary form.
fn narrow(c: char) -> char {
    let ascii = (c as u32).wrapping_sub(0xFEE0);
    if ('！'..='～').contains(&c) { char::from_u32(ascii).unwrap_or(c) } else { c }
}

/// Splits a name into lower-case words: at signs, at digits, at a lower-to-upper step; bracketed parts apart.
fn words(name: &str) -> (Vec<String>, Vec<String>) {
    let mut words = Vec::new();
    let mut brackets = Vec::new();
    let mut word = String::new();
    let mut inside: Option<String> = None;
    let mut depth = 0;
    let mut previous = ' ';
    for c in name.chars().map(narrow) {
        if let Some(text) = inside.as_mut() {
            match c {
                '(' | '[' | '{' => {
                    depth += 1;
                    text.push(c);
                }
                ')' | ']' | '}' if depth > 0 => {
                    depth -= 1;
                    text.push(c);
                }
                ')' | ']' | '}' => {
                    brackets.push(std::mem::take(text));
                    inside = None;
                }
                c => text.push(c),
            }
            previous = ' ';
            continue;
        }
        if matches!(c, '(' | '[' | '{') {
            inside = Some(String::new());
            depth = 0;
        }
        // 軸 parts as a blank does: X軸加速度, 加速度X軸.
        let joins = c != '軸' && (c.is_alphabetic() || c == 'ー');
        let step = c.is_uppercase() && previous.is_lowercase();
        let script = joins && previous.is_alphabetic() && c.is_ascii() != previous.is_ascii();
        let parted = (!joins && !c.is_ascii_digit())
            || step
            || script
            || c.is_ascii_digit() != previous.is_ascii_digit();
        if parted && !word.is_empty() {
            words.push(std::mem::take(&mut word));
        }
        if joins || c.is_ascii_digit() {
            word.extend(c.to_lowercase());
        }
        previous = c;
    }
    if !word.is_empty() {
        words.push(word);
    }
    if let Some(text) = inside {
        brackets.push(text);
    }
    (words, brackets)
}

/// What stands in brackets in a column's name and looks like a unit, but none that is known: `gx [turns/h]`,
/// `time (ticks)`, `time [100us]`.
pub(crate) fn unknown_unit(name: &str) -> Option<String> {
    let (_, brackets) = words(name);
    let looks = |text: &String| {
        let lower = text.to_lowercase();
        let multiple = lower.trim_start_matches(|c: char| c.is_ascii_digit() || c == '.');
        Unit::parse(text).is_none()
            && (lower.contains('/')
                || lower.contains("tick")
                || lower.ends_with("dps")
                || multiple.len() < lower.len() && Unit::parse(multiple).is_some())
    };
    brackets.into_iter().find(looks)
}

fn has(list: &str, word: &str) -> bool {
    list.split_ascii_whitespace().any(|w| w == word)
}

fn axis_of(word: &str) -> Option<u8> {
    match word {
        "x" => Some(0),
        "y" => Some(1),
        "z" => Some(2),
        _ => None,
    }
}

/// The quantity a word names, if it does so alone.
fn quantity_of(word: &str) -> Option<Quantity> {
    if has(ACC, word) {
        Some(Quantity::Acceleration)
    } else if has(GYRO, word) {
        Some(Quantity::AngularRate)
    } else if has(TEMPERATURE, word) {
        Some(Quantity::Temperature)
    } else {
        None
    }
}

/// A word such as `ax`, `gyrox`, `xacc`: quantity and axis in one.
fn fused(word: &str) -> Option<(Quantity, u8)> {
    let try_with = |stem: &str, axis: &str| {
        let quantity = quantity_of(stem).filter(|q| *q != Quantity::Temperature)?;
        Some((quantity, axis_of(axis)?))
    };
    let (last, _) = word.char_indices().next_back()?;
    if last == 0 {
        return None;
    }
    let first_end = word.char_indices().nth(1)?.0;
    try_with(word.get(..last)?, word.get(last..)?).or_else(|| {
        let stem = word.get(first_end..)?;
        if stem.chars().count() < 3 { None } else { try_with(stem, word.get(..first_end)?) }
    })
}

/// Reads a column's name; `unit_cell` is the cell of a units row below it, empty where there is none.
pub fn meaning(name: &str, unit_cell: &str) -> Meaning {
    let name = name.trim().trim_matches('"').trim_start_matches(['#', '%', '/']).trim();
    let (mut words, brackets) = words(name);
    let mut out = Meaning::other();
    let mut index_axis = None;
    for text in &brackets {
        match text.trim().trim_end_matches('軸') {
            "0" => index_axis = Some(0),
            "1" => index_axis = Some(1),
            "2" => index_axis = Some(2),
            other => {
                if let Some(axis) = axis_of(&other.to_lowercase()) {
                    out.axis = Some(axis);
                } else if out.unit.is_none() {
                    out.unit = Unit::parse(other);
                }
            }
        }
    }
    if let Some(unit) = Unit::parse(unit_cell) {
        out.unit = Some(unit);
    }
    if out.unit.is_none() {
        out.unit = trailing_unit(name, &mut words);
    }
    classify(name, &words, index_axis, &mut out);
    out
}

/// A unit after the last blank or underscore, as in `acc_x m/s^2`, `gyro_x_dps`, `accelerometer_m_s2`.
fn trailing_unit(name: &str, words: &mut Vec<String>) -> Option<Unit> {
    let lower = name.to_lowercase();
    for (tail, unit) in [
        ("m_s2", units::M_S2),
        ("m_s_2", units::M_S2),
        ("ms2", units::M_S2),
        ("mps2", units::M_S2),
        ("rad_s", units::RAD_S),
        ("rad_sec", units::RAD_S),
        ("rads", units::RAD_S),
        ("radps", units::RAD_S),
        ("deg_s", units::DEG_S),
        ("deg_sec", units::DEG_S),
        ("degs", units::DEG_S),
        ("degps", units::DEG_S),
        ("dps", units::DEG_S),
        ("mdps", Unit::AngularRate(units::RAD_PER_DEG / 1000.0, "mdeg/s")),
        ("mg", units::MILLI_G),
        ("_g", units::STANDARD_G),
        ("_s", units::SECOND),
        ("_sec", units::SECOND),
        ("_ms", units::MILLISECOND),
        ("_us", units::MICROSECOND),
        ("_usec", units::MICROSECOND),
        ("_ns", units::NANOSECOND),
        ("_nsec", units::NANOSECOND),
        ("_c", Unit::Celsius),
        ("_deg", Unit::Other),
        ("_ut", Unit::Other),
    ] {
        let bare = lower.split('[').next().unwrap_or(&lower).trim_end();
        let Some(head) = bare.strip_suffix(tail) else { continue };
        let parted = tail.starts_with('_') || head.ends_with(['_', ' ', '-', '.', '/']);
        if !parted || head.is_empty() {
            continue;
        }
        let parts = tail.split('_').filter(|p| !p.is_empty()).count() + usize::from(tail.ends_with("s2"));
        // The digit of "s2" is a word of its own.
        let keep = words.len().saturating_sub(parts);
        if keep == 0 {
            return None;
        }
        words.truncate(keep);
        return Some(unit);
    }
    let tail = name.rsplit([' ', ',', ';', ':']).next()?;
    if tail.len() == name.len() || tail.chars().count() < 2 && !tail.eq_ignore_ascii_case("g") {
        return None;
    }
    let unit = Unit::parse(tail)?;
    let (dropped, _) = self::words(tail);
    let keep = words.len().saturating_sub(dropped.len());
    if keep == 0 {
        return None;
    }
    words.truncate(keep);
    Some(unit)
}

fn classify(name: &str, words: &[String], index_axis: Option<u8>, out: &mut Meaning) {
    let mut quantity: Option<Quantity> = None;
    let mut label: Vec<&str> = Vec::new();
    let mut no_gravity = false;
    let mut gravity = false;
    let mut other = false;
    let mut time = false;
    let mut counter = false;
    for (i, word) in words.iter().enumerate() {
        let word = word.as_str();
        let next = words.get(i + 1).map_or("", String::as_str);
        if matches!(word, "uncal" | "uncalibrated") {
            out.grade = Grade::Uncalibrated;
        } else if matches!(word, "raw" | "counts" | "lsb") {
            out.grade = Grade::Raw;
        } else if matches!(word, "cal" | "calibrated" | "calib") {
            out.grade = Grade::Calibrated;
        }
        if let Some(axis) = axis_of(word) {
            out.axis = Some(axis);
        } else if has(NO_GRAVITY, word) {
            no_gravity = true;
        } else if word == "gravity" || word == "重力" || word == "grav" {
            gravity = true;
        } else if (word == "angular" && matches!(next, "velocity" | "rate" | "vel" | "speed"))
            || (word == "rotation" && next == "rate")
            || (word == "turn" && next == "rate")
        {
            quantity = Some(Quantity::AngularRate);
        } else if (word == "specific" && next == "force")
            || (word == "g" && (next == "force" || next == "fx"))
        {
            quantity = Some(Quantity::Acceleration);
        } else if has(OTHER, word) {
            other = true;
        } else if let Some(q) = quantity_of(word) {
            // A one-letter word names a quantity only where nothing longer does.
            if word.len() > 1 || quantity.is_none() {
                quantity = Some(match (quantity, q) {
                    (Some(had), Quantity::Temperature) if had != Quantity::Temperature => {
                        Quantity::Temperature
                    }
                    _ => q,
                });
            }
        } else if let Some((q, axis)) = fused(word) {
            quantity = quantity.or(Some(q));
            out.axis = Some(axis);
        } else if has(TIME, word) {
            time = true;
        } else if has(COUNTER, word) {
            counter = true;
        } else if !has(FILLER, word) {
            label.push(word);
        }
    }
    let lower = name.to_lowercase();
    if lower.starts_with("gf")
        && let Some(axis) = lower.strip_prefix("gf").and_then(|rest| axis_of(rest.get(..1).unwrap_or("")))
    {
        quantity = Some(Quantity::Acceleration);
        out.axis = Some(axis);
        out.unit = out.unit.or(Some(units::STANDARD_G));
        label.clear();
    }
    // "angular velocity", "rotation rate": the second word is not a quantity of its own.
    let rate_words = lower.contains("angular") || lower.contains("rotation");
    if rate_words && other && quantity == Some(Quantity::AngularRate) {
        other = words.iter().any(|w| {
            has(OTHER, w) && !matches!(w.as_str(), "velocity" | "vel" | "speed" | "axis" | "rotation")
        });
    }
    if lower.contains("axis") {
        other = words.iter().any(|w| w != "axis" && has(OTHER, w));
    }
    out.named = quantity.is_some() || no_gravity || gravity;
    if out.axis.is_none() {
        out.axis = index_axis;
    }
    if out.axis.is_none() {
        out.axis = trailing_index(words, quantity);
        if out.axis.is_some() {
            label.pop();
        }
    }
    out.label = label.join(" ");
    out.quantity = decide(words, quantity, other, no_gravity, gravity, time, counter, out);
}

/// A number at the end, 0 to 3: an axis counted from 0 or from 1; the reader of all columns tells which.
fn trailing_index(words: &[String], quantity: Option<Quantity>) -> Option<u8> {
    if !matches!(quantity, Some(Quantity::Acceleration | Quantity::AngularRate)) {
        return None;
    }
    match words.last()?.as_str() {
        "0" => Some(0),
        "1" => Some(1),
        "2" => Some(2),
        "3" => Some(3),
        _ => None,
    }
}

#[allow(clippy::fn_params_excessive_bools, clippy::too_many_arguments)] // one decision, one place
fn decide(
    words: &[String],
    quantity: Option<Quantity>,
    other: bool,
    no_gravity: bool,
    gravity: bool,
    time: bool,
    counter: bool,
    out: &Meaning,
) -> Quantity {
    let strong_time = words.iter().any(|w| {
        matches!(
            w.as_str(),
            "time"
                | "timestamp"
                | "timestamps"
                | "sampletimefine"
                | "elapsed"
                | "時刻"
                | "時間"
                | "日時"
                | "サンプリング時間"
                | "サンプリング時刻"
                | "計測時間"
                | "計測時刻"
                | "測定時間"
                | "測定時刻"
                | "millis"
                | "micros"
        )
    });
    if strong_time && out.axis.is_none() && !other {
        return Quantity::Time;
    }
    if quantity == Some(Quantity::Temperature) {
        return Quantity::Temperature;
    }
    if other {
        return Quantity::Other;
    }
    if gravity && out.axis.is_some() {
        let with = matches!(quantity, Some(Quantity::Acceleration))
            && words.iter().any(|w| matches!(w.as_str(), "with" | "including" | "incl"));
        return if with { Quantity::Acceleration } else { Quantity::Gravity };
    }
    match (quantity, out.unit) {
        (Some(Quantity::AngularRate), Some(Unit::Acceleration(..))) if words.iter().all(|w| w.len() <= 2) => {
            Quantity::Acceleration
        }
        (Some(Quantity::Acceleration | Quantity::AngularRate), Some(Unit::Other | Unit::Time(..))) => {
            Quantity::Other
        }
        (Some(Quantity::Acceleration), _) if no_gravity => Quantity::LinearAcceleration,
        (Some(q @ (Quantity::Acceleration | Quantity::AngularRate)), _) if out.axis.is_some() => q,
        (None, Some(Unit::Acceleration(..))) if out.axis.is_some() => {
            if no_gravity {
                Quantity::LinearAcceleration
            } else {
                Quantity::Acceleration
            }
        }
        (None, Some(Unit::AngularRate(..))) if out.axis.is_some() => Quantity::AngularRate,
        (None, None | Some(Unit::Counts)) if out.axis.is_some() && no_gravity => Quantity::LinearAcceleration,
        (None, None | Some(Unit::Counts)) if out.axis.is_some() => Quantity::Axis,
        (None, Some(Unit::Celsius)) => Quantity::Temperature,
        _ if time => Quantity::Time,
        _ if counter => Quantity::Counter,
        _ => Quantity::Other,
    }
}
