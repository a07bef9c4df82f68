//! Opening: from inputs to a recording, and looking into a file without needing one.

use crate::body::{self, Body, TimeForm, Wanted};
use crate::clock::{self, Stamps};
use crate::dialect;
use crate::error::{Error, Problem, Result};
use crate::options::Options;
use crate::plan::{Plan, Reading, Triple};
use crate::recording::{Channel, Findings, Note, Recording};
use crate::rows;
use crate::sheet::{self, Sheet};
use crate::stamp::{self, Cycle};
use crate::units::{self, SECOND, Unit};
use crate::{Input, merge, settle, suspect};
use shisei_core::Lang;
use std::borrow::Cow;

/// Unpacked files larger than this are refused.
pub(crate) const UNPACKED_LIMIT: u64 = 4 << 30;

/// What a part's acceleration is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Share {
    /// All of it.
    #[default]
    Total,
    /// Without gravity.
    Linear,
    /// Gravity alone.
    Gravity,
}

/// One file's share of a recording, before units are settled.
#[derive(Debug, Default)]
pub(crate) struct Part {
    pub name: String,
    pub dialect: &'static str,
    pub acc: Option<Triple>,
    /// What `acc` is, where it is not all of the acceleration.
    pub share: Share,
    pub gyro: Option<Triple>,
    pub reading: Reading,
    pub body: Body,
    pub time_s: Vec<f64>,
    pub dt_s: Vec<f64>,
    /// What time 0 is, nanoseconds since 1970, where known.
    pub origin_ns: Option<i64>,
    pub findings: Findings,
    pub channels: Vec<Channel>,
    pub assumptions: Vec<Note>,
    pub warnings: Vec<Note>,
    pub keep_names: Vec<String>,
    /// Neither stamps nor a rate: time is in rows and no use.
    pub rate_missing: bool,
    /// Name of a column without gravity, where there is no other acceleration.
    pub without_gravity: Option<String>,
}

/// What a file holds, whether or not it makes a recording.
#[derive(Debug)]
pub struct Inspection {
    /// Id of the dialect of the first file; empty where it has none.
    pub dialect: &'static str,
    /// Name of the dialect.
    pub dialect_name: &'static str,
    /// Encoding and separator of the first text file, for people.
    pub layout: String,
    /// The same in Japanese.
    pub layout_ja: String,
    /// Lines before the header of the first text file.
    pub preamble: Vec<String>,
    /// Every column of every file.
    pub channels: Vec<Channel>,
    /// The recording, where there is one.
    pub recording: Option<Recording>,
    /// Why there is none.
    pub refusal: Option<Error>,
}

/// Opens a recording: one file, or the accelerometer's and the gyroscope's files of one recording.
pub fn open(inputs: &[Input<'_>], options: &Options) -> Result<Recording> {
    let mut parts = Vec::new();
    for input in inputs {
        let bytes = unpack(input)?;
        parts.push(part_of(input.name, &bytes, options, inputs.len() > 1)?);
    }
    if parts.is_empty() {
        return Err(Error::of_file("", Problem::Empty));
    }
    finish(merge::merge(parts)?, options)
}

/// From one part to the recording.
pub(crate) fn finish(part: Part, options: &Options) -> Result<Recording> {
    let mut recording = settle::settle(part, options)?;
    suspect::look(&mut recording);
    Ok(recording)
}

/// Reads one file's bytes.
fn part_of(name: &str, bytes: &[u8], options: &Options, split: bool) -> Result<Part> {
    if let Some(whole) = dialect::whole_file(bytes) {
        return (whole.read)(name, bytes, options);
    }
    #[cfg(feature = "parquet")]
    if crate::parquet_read::recognises(bytes) {
        let file = crate::parquet_read::open(name, bytes)?;
        return table_part(&file.sheet(name)?, options, split, |_, wanted| file.read(name, wanted));
    }
    let sheet = sheet::sniff(name, bytes, options)?;
    table_part(&sheet, options, split, body::read)
}

/// The table of a text or Parquet file.
fn sheet_of<'a>(name: &'a str, bytes: &'a [u8], options: &Options) -> Result<Sheet<'a>> {
    #[cfg(feature = "parquet")]
    if crate::parquet_read::recognises(bytes) {
        return crate::parquet_read::open(name, bytes)?.sheet(name);
    }
    sheet::sniff(name, bytes, options)
}

/// Looks into files: channels and layout in any case, the recording or why there is none.
pub fn inspect(inputs: &[Input<'_>], options: &Options) -> Result<Inspection> {
    let mut out = Inspection {
        dialect: "",
        dialect_name: "",
        layout: String::new(),
        layout_ja: String::new(),
        preamble: Vec::new(),
        channels: Vec::new(),
        recording: None,
        refusal: None,
    };
    for (i, input) in inputs.iter().enumerate() {
        let bytes = unpack(input)?;
        if let Some(whole) = dialect::whole_file(&bytes) {
            if i == 0 {
                out.dialect = whole.id;
                out.dialect_name = whole.name;
                whole.layout.clone_into(&mut out.layout);
                whole.layout_ja.clone_into(&mut out.layout_ja);
            }
            continue;
        }
        let sheet = match sheet_of(input.name, &bytes, options) {
            Ok(sheet) => sheet,
            Err(error) if inputs.len() == 1 => return Err(error),
            Err(error) => {
                out.refusal.get_or_insert(error);
                continue;
            }
        };
        let (dialect, reading) = read_names(&sheet, options);
        let plan = Plan::make(&sheet, &reading, options).unwrap_or_default();
        out.channels.extend(plan.channels(&sheet, &reading));
        if i == 0 {
            out.dialect = dialect.id;
            out.dialect_name = dialect.name;
            (out.layout, out.layout_ja) = layout(&sheet, bytes.starts_with(b"PAR1"));
            out.preamble.clone_from(&sheet.preamble);
        }
    }
    match open(inputs, options) {
        Ok(recording) => {
            out.channels.clone_from(&recording.channels);
            out.dialect = recording.dialect;
            out.recording = Some(recording);
        }
        Err(error) => out.refusal = Some(error),
    }
    Ok(out)
}

/// How a table is laid out, in English and in Japanese.
fn layout(sheet: &Sheet<'_>, parquet: bool) -> (String, String) {
    if parquet {
        return ("Parquet".to_owned(), "Parquet".to_owned());
    }
    let (encoding, delimiter) = (sheet.encoding.name(), sheet.delimiter);
    let comma = sheet.decimal == b',';
    (
        format!("{encoding}, {}{}", delimiter.name(), if comma { ", decimal comma" } else { "" }),
        format!("{encoding}、{}{}", delimiter.name_ja(), if comma { "、小数点はコンマ" } else { "" }),
    )
}

impl Inspection {
    /// What the first file is and how it is laid out, for people.
    pub fn format(&self, lang: Lang) -> String {
        let layout = if lang == Lang::Ja { &self.layout_ja } else { &self.layout };
        format!("{} ({layout})", dialect::name(self.dialect, lang))
    }
}

/// Unpacks gzip; tells known binary formats by their first bytes.
pub(crate) fn unpack<'a>(input: &Input<'a>) -> Result<Cow<'a, [u8]>> {
    let fail = |problem| Error::of_file(input.name, problem);
    let bytes = input.bytes;
    if bytes.is_empty() {
        return Err(fail(Problem::Empty));
    }
    for (magic, format) in [
        (b"PK\x03\x04".as_slice(), "a ZIP archive or an Excel workbook (.xlsx)"),
        (b"\xD0\xCF\x11\xE0", "an old Excel workbook (.xls)"),
        #[cfg(not(feature = "mcap"))]
        (b"\x89MCAP0\r\n", "an MCAP file"),
        (b"\x89HDF\r\n", "an HDF5 or MATLAB file"),
        (b"MATLAB", "a MATLAB file"),
        (b"#ROSBAG", "a ROS bag"),
        (b"SQLite format 3", "an SQLite database or ROS 2 bag"),
        (b"%PDF", "a PDF document"),
        #[cfg(not(feature = "parquet"))]
        (b"PAR1", "a Parquet file"),
        (b"\x89PNG", "a picture"),
    ] {
        if bytes.starts_with(magic) {
            return Err(fail(Problem::OtherFormat { format }));
        }
    }
    if !bytes.starts_with(b"\x1F\x8B") {
        return Ok(Cow::Borrowed(bytes));
    }
    gunzip(bytes).map(Cow::Owned).map_err(fail)
}

fn gunzip(bytes: &[u8]) -> std::result::Result<Vec<u8>, Problem> {
    use std::io::Read;
    let mut out = Vec::new();
    let mut reader = flate2::read::MultiGzDecoder::new(bytes).take(UNPACKED_LIMIT + 1);
    reader.read_to_end(&mut out).map_err(|e| Problem::Damaged { format: "gzip", detail: e.to_string() })?;
    if out.len() as u64 > UNPACKED_LIMIT {
        return Err(Problem::TooLarge { limit: UNPACKED_LIMIT });
    }
    Ok(out)
}

fn read_names(sheet: &Sheet<'_>, options: &Options) -> (dialect::Dialect, Reading) {
    let dialect = dialect::of(sheet, options.dialect.as_deref());
    let mut reading = Reading::of(sheet);
    (dialect.mend)(sheet, &mut reading);
    (dialect, reading)
}

/// Reads one table; `read` turns its rows into numbers.
pub(crate) fn table_part(
    sheet: &Sheet<'_>,
    options: &Options,
    split: bool,
    read: impl FnOnce(&Sheet<'_>, &Wanted) -> Result<Body>,
) -> Result<Part> {
    let (dialect, mut reading) = read_names(sheet, options);
    let mut plan = Plan::make(sheet, &reading, options)?;
    let channels = plan.channels(sheet, &reading);
    let share = gravity_shares(&mut plan, &mut reading, split);
    let names = sheet.column_names();
    refuse(sheet.name, &plan, &names, split)?;
    let mut wanted = Wanted {
        keep: plan.keep.clone(),
        skip_bad: options.skip_bad_rows,
        lenient_temp: true,
        ..Wanted::default()
    };
    let added = if share == Share::Total { plan.gravity.take() } else { None };
    for (triple, first) in [(&plan.acc, body::ACC), (&plan.gyro, body::GYRO), (&added, body::GRAVITY)] {
        if let Some(triple) = triple {
            for axis in 0..3 {
                wanted.slot[first + axis] = Some(triple.columns[axis]);
            }
        }
    }
    wanted.slot[body::TEMP] = plan.temp;
    let clock = time_columns(sheet, &plan, &reading, options, &mut wanted);
    let body = read(sheet, &wanted)?;
    let mut part = Part {
        name: sheet.name.to_owned(),
        dialect: dialect.id,
        channels,
        share,
        keep_names: plan.keep.iter().filter_map(|c| names.get(*c).cloned()).collect(),
        without_gravity: plan.without_gravity.clone(),
        acc: plan.acc,
        gyro: plan.gyro,
        ..Part::default()
    };
    part.assumptions.extend(reading.assumptions.iter().cloned());
    part.warnings.extend(reading.warnings.iter().cloned());
    part.body = body;
    part.reading = reading;
    finish_time(&mut part, clock, &wanted, options)?;
    Ok(part)
}

/// Acceleration without gravity beside gravity makes the whole; in files given together each may be alone.
fn gravity_shares(plan: &mut Plan, reading: &mut Reading, split: bool) -> Share {
    let whole = plan.acc.is_some();
    match (plan.linear.take(), plan.gravity.take()) {
        (Some(linear), Some(gravity)) if !whole && linear.unit == gravity.unit => {
            plan.acc = Some(linear);
            plan.gravity = Some(gravity);
            reading.assumptions.push(Note::new(
                "gravity-added",
                "the acceleration is the sum of the columns without gravity and of gravity".into(),
                "加速度は、重力を除いた加速度の列と重力の列の和です".into(),
            ));
            Share::Total
        }
        (Some(linear), _) if !whole && split && plan.gyro.is_none() => {
            plan.acc = Some(linear);
            Share::Linear
        }
        (None, Some(gravity)) if !whole && split && plan.gyro.is_none() => {
            plan.acc = Some(gravity);
            Share::Gravity
        }
        _ => Share::Total,
    }
}

/// Tables that cannot give a recording.
fn refuse(name: &str, plan: &Plan, names: &[String], split: bool) -> Result<()> {
    let columns = names.to_vec();
    let problem = match (&plan.acc, &plan.gyro) {
        (Some(_), Some(_)) => return Ok(()),
        _ if split && (plan.acc.is_some() || plan.gyro.is_some()) => return Ok(()),
        (None, _) if plan.without_gravity.is_some() => Problem::GravityRemoved {
            column: plan.without_gravity.clone().unwrap_or_default(),
            norm_m_s2: None,
        },
        (Some(_), None) => Problem::NoGyro { columns },
        (None, Some(_)) => Problem::NoAcc { columns },
        (None, None) => Problem::NotARecording { columns },
    };
    Err(Error::of_file(name, problem))
}

/// How the time column is to be understood.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Clock {
    pub unit: Option<Unit>,
    /// The column is a running number, not a time.
    pub counter: bool,
    pub cycle: RawCycle,
}

/// A raw clock's cycle, in raw units or in seconds.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) enum RawCycle {
    #[default]
    None,
    Raw(f64),
    Seconds(f64),
}

fn time_columns(
    sheet: &Sheet<'_>,
    plan: &Plan,
    reading: &Reading,
    options: &Options,
    wanted: &mut Wanted,
) -> Clock {
    let mut clock = Clock::default();
    if options.rate_hz.is_some() {
        return clock;
    }
    let mut column = plan.time.filter(|c| rows::time_form(sheet, *c).is_some());
    if column.is_none() {
        column = plan.counter.filter(|_| reading.rate_hz.is_some());
        clock.counter = column.is_some();
    }
    let Some(column) = column else { return clock };
    let Some(form) = rows::time_form(sheet, column) else { return clock };
    wanted.slot[body::TIME] = Some(column);
    wanted.time_form = form;
    clock.unit = options.units.time.or(plan.time_unit).or(reading.time_unit);
    if let Some(cycle) = reading.time_cycle {
        clock.cycle = RawCycle::Raw(cycle);
    }
    if let TimeForm::Text(_) = form {
        clock.unit = Some(SECOND);
        let cell = sheet.sample.iter().filter_map(|r| r.get(column)).find(|c| !c.trim().is_empty());
        let cycle = cell.and_then(|c| stamp::parse(c.trim().as_bytes())).map_or(Cycle::None, |s| s.cycle);
        clock.cycle = RawCycle::Seconds(cycle.seconds());
    }
    if let Some(coarse) = reading.coarse_time
        && let Some(form) = rows::time_form(sheet, coarse.column)
    {
        wanted.slot[body::COARSE] = Some(coarse.column);
        wanted.coarse_form = form;
    }
    clock
}

/// From raw time to seconds.
pub(crate) fn finish_time(part: &mut Part, clock: Clock, wanted: &Wanted, options: &Options) -> Result<()> {
    let mut seconds = std::mem::take(&mut part.body.time);
    let rows = part.body.rows;
    let mut unit = clock.unit;
    if clock.counter {
        let hz = part.reading.rate_hz.unwrap_or(100.0);
        unit = Some(Unit::Time(1.0 / hz, "samples"));
        let bits = counter_cycle(&seconds);
        unwrap_counter(&mut seconds, bits, &mut part.findings);
        part.assumptions.push(Note::new(
            "time-from-counter",
            format!("time is made from the sample counter and the stated rate of {hz} Hz"),
            format!("時刻はサンプル番号と記載の {hz} Hz から作ります"),
        ));
    }
    let origin = match wanted.time_form {
        TimeForm::Large(origin) => origin as f64,
        _ => seconds.first().copied().unwrap_or(0.0),
    };
    if unit.is_none() && !seconds.is_empty() {
        match guess_time_unit(&seconds, origin) {
            Some((guess, why)) => {
                part.assumptions.push(Note::new(
                    "unit-time-inferred",
                    format!("the time column has no unit: taken as {} ({why})", guess.name()),
                    format!("時刻の列に単位がないため {} とみなしました", guess.name()),
                ));
                unit = Some(guess);
                if why == BY_STEP {
                    part.warnings.extend(other_time_unit(&seconds));
                }
            }
            None => seconds.clear(),
        }
    }
    if let Some(channel) = part.channels.iter_mut().find(|c| c.role == "time_s")
        && let Some(unit) = unit
        && channel.unit.is_empty()
    {
        unit.name().clone_into(&mut channel.unit);
    }
    let factor = match unit {
        Some(Unit::Time(factor, _)) => factor,
        _ => 1.0,
    };
    if factor != 1.0 {
        // Decimal fractions of a second are exact quotients: 0.01 s is 10 / 1000, not 10 × 0.001.
        let inverse = (1.0 / factor).round();
        let exact = factor < 1.0 && ((1.0 / inverse) - factor).abs() < 1e-12 * factor;
        for value in &mut seconds {
            *value = if exact { *value / inverse } else { *value * factor };
        }
    }
    let cycle_s = match clock.cycle {
        RawCycle::None => 0.0,
        RawCycle::Raw(raw) => raw * factor,
        RawCycle::Seconds(seconds) => seconds,
    };
    part.origin_ns = origin_of(wanted.time_form, unit);
    if part.reading.coarse_time.is_some_and(|coarse| coarse.exact) && seconds.iter().all(|t| *t < cycle_s) {
        add_whole_seconds(&mut seconds, &part.body.coarse);
    } else {
        settle_cycles(&mut seconds, &part.body.coarse, cycle_s, &mut part.findings);
    }
    let count = out_of_order(&seconds);
    if count * 10 > rows {
        return Err(Error::of_file(&part.name, Problem::Unsorted { count, rows }));
    }
    let cycle_s = if part.body.coarse.is_empty() { cycle_s } else { 0.0 };
    let mut stamps = Stamps { seconds, cycle_s, stated_hz: part.reading.rate_hz, given_hz: options.rate_hz };
    // Without stamps and rate the units are still settled first: counts are the more telling refusal.
    part.rate_missing = stamps.seconds.is_empty() && stamps.stated_hz.is_none() && stamps.given_hz.is_none();
    if part.rate_missing {
        stamps.given_hz = Some(100.0);
    }
    let Some(timeline) = clock::timeline(stamps, rows, &mut part.findings) else {
        return Err(Error::of_file(&part.name, Problem::RateNeeded));
    };
    part.time_s = timeline.time_s;
    part.dt_s = timeline.dt_s;
    part.assumptions.extend(timeline.notes);
    part.warnings.extend(timeline.warnings);
    // A clock that counts from long ago (device start, 1970) starts at 0.
    if part.origin_ns.is_some()
        && let Some(first) = part.time_s.first().copied()
    {
        let shift = first;
        if shift != 0.0 {
            part.origin_ns = part.origin_ns.map(|ns| ns.saturating_add((shift * 1e9) as i64));
            for t in &mut part.time_s {
                *t -= shift;
            }
        }
    }
    Ok(())
}

/// Nanoseconds since 1970 (or since midnight, or since the clock's own start for large counts) of time 0; nothing where
/// the file's own seconds stay.
fn origin_of(form: TimeForm, unit: Option<Unit>) -> Option<i64> {
    match (form, unit) {
        (TimeForm::Text(ns), _) => Some(ns),
        // Seconds, milliseconds … of a count: exact in integers where the factor is a decimal one.
        (TimeForm::Large(n), Some(Unit::Time(factor, _))) => {
            Some(n.saturating_mul((factor * 1e9).round() as i64))
        }
        (TimeForm::Large(n), _) => Some(n.saturating_mul(1_000_000_000)),
        (TimeForm::Number, Some(units::DAY)) => Some(-DAYS_TO_1970 * 86_400_000_000_000),
        (TimeForm::Number, _) => None,
    }
}

/// From the day 0 of spreadsheets to 1970.
const DAYS_TO_1970: i64 = 25_569;

/// How many rows are far before an earlier one, where the time falls again and again: packets that overtake each other are
/// a few steps out of order, rows that nobody sorted are more.
fn out_of_order(seconds: &[f64]) -> usize {
    let falls = seconds.windows(2).filter(|pair| pair[1] < pair[0]).count();
    if falls * 10 <= seconds.len() {
        return 0;
    }
    let mut sorted = seconds.to_vec();
    sorted.sort_by(f64::total_cmp);
    let far = 10.0 * clock::usual_step(&sorted);
    let mut newest = f64::NEG_INFINITY;
    let behind = |t: &&f64| {
        newest = newest.max(**t);
        **t < newest - far
    };
    seconds.iter().filter(behind).count()
}

/// Parts of seconds and the whole seconds, which count from the first.
fn add_whole_seconds(seconds: &mut [f64], coarse: &[f64]) {
    let first = coarse.first().copied().unwrap_or(0.0);
    for (t, whole) in seconds.iter_mut().zip(coarse) {
        *t += whole - first;
    }
}

/// A fine clock that starts again every cycle, beside a coarse one that does not.
fn settle_cycles(seconds: &mut [f64], coarse: &[f64], cycle_s: f64, findings: &mut Findings) {
    if coarse.is_empty() || cycle_s <= 0.0 || coarse.len() != seconds.len() {
        return;
    }
    let (Some(first), Some(first_coarse)) = (seconds.first().copied(), coarse.first().copied()) else {
        return;
    };
    let mut offset = 0.0;
    let mut previous = first;
    for (t, c) in seconds.iter_mut().zip(coarse) {
        if *t < previous - 0.5 * cycle_s {
            offset += cycle_s;
            findings.wraps += 1;
        }
        previous = *t;
        // Whole cycles that passed unseen during a pause.
        let behind = (c - first_coarse) - (*t + offset - first);
        if behind > 1.5 * cycle_s {
            offset += (behind / cycle_s).floor() * cycle_s;
        }
        *t += offset;
    }
}

/// 2^8, 2^16 or 2^32 where a counter falls from near it to near zero; 0 else.
fn counter_cycle(counts: &[f64]) -> f64 {
    let highest = counts.iter().copied().fold(0.0, f64::max);
    for cycle in [256.0, 65_536.0, 4_294_967_296.0] {
        if highest < cycle {
            let falls = counts.windows(2).any(|w| w[0] > 0.9 * cycle && w[1] < 0.1 * cycle);
            return if falls { cycle } else { 0.0 };
        }
    }
    0.0
}

fn unwrap_counter(counts: &mut [f64], cycle: f64, findings: &mut Findings) {
    if cycle <= 0.0 {
        return;
    }
    let mut offset = 0.0;
    let mut previous = counts.first().copied().unwrap_or(0.0);
    for c in counts {
        if *c < previous - 0.5 * cycle {
            offset += cycle;
            findings.wraps += 1;
        }
        previous = *c;
        *c += offset;
    }
}

/// Longer steps are microseconds: fewer than five samples a second tell no attitude.
const SLOWEST_MS: f64 = 200.0;

/// Steps in seconds are longer: no motion sensor gives more than 50,000 samples a second.
const LEAST_STEP_S: f64 = 2e-5;

/// What is said of a unit that only the steps tell.
const BY_STEP: &str = "by its usual step";

/// A word of doubt where both milliseconds and microseconds make a rate that a sensor may have.
fn other_time_unit(raw: &[f64]) -> Option<Note> {
    let step = clock::usual_step(raw);
    let whole = raw.iter().take(2000).all(|v| *v == v.trunc());
    let (here, hz, other) =
        if step <= SLOWEST_MS { ("ms", 1e3 / step, "us") } else { ("us", 1e6 / step, "ms") };
    (whole && (100.0..=1000.0).contains(&step)).then(|| {
        Note::new(
            "unit-time-doubtful",
            format!(
                "the time column has no unit and rises by about {step:.0} a sample: {here} give {hz:.1} Hz; if it is {other}, \
                 say --units time={other}"
            ),
            format!(
                "時刻の列に単位がなく、1 サンプルあたり約 {step:.0} 増えます。{here} として {hz:.1} Hz としました。{other} の場合は \
                 --units time={other} を指定してください"
            ),
        )
    })
}

/// The unit of a time column without one, from its start and its usual step; `None` for a mere counter.
fn guess_time_unit(raw: &[f64], origin: f64) -> Option<(Unit, &'static str)> {
    use crate::units::{MICROSECOND, MILLISECOND, NANOSECOND};
    let step = clock::usual_step(raw);
    for (low, high, unit) in [
        (0.9e9, 4.0e9, SECOND),
        (0.9e12, 4.0e12, MILLISECOND),
        (0.9e15, 4.0e15, MICROSECOND),
        (0.9e18, 4.0e18, NANOSECOND),
    ] {
        if (low..high).contains(&origin) && (unit != SECOND || step < 5.0) {
            return Some((unit, "it counts from 1970"));
        }
    }
    // A spreadsheet's date: days since 1900, with the time of day behind the point.
    if (20_000.0..80_000.0).contains(&origin) && 0.0 < step && step < LEAST_STEP_S {
        return Some((units::DAY, "a spreadsheet's dates are days"));
    }
    // A count that rises by one: sample numbers, unless it also skips as milliseconds do.
    let whole = raw.iter().take(2000).all(|v| *v == v.trunc());
    let ones = raw.windows(2).take(2000).filter(|w| w[1] - w[0] == 1.0).count();
    let taken = raw.len().saturating_sub(1).clamp(1, 2000);
    if whole && ones * 100 >= taken * 98 {
        return None;
    }
    Some(if step < 0.9 {
        (SECOND, BY_STEP)
    } else if step <= SLOWEST_MS && whole || step < 500.0 && !whole {
        (MILLISECOND, BY_STEP)
    } else if step < 400_000.0 {
        (MICROSECOND, BY_STEP)
    } else {
        (NANOSECOND, BY_STEP)
    })
}
