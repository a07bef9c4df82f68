//! A recording as values, with everything that was assumed and found on the way.

use shisei_core::{Lang, Vec3};

/// A sentence in both languages with a code that programs can hold on to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Note {
    /// Stable code, e.g. `unit-acc-inferred`.
    pub code: &'static str,
    en: String,
    ja: String,
}

impl Note {
    /// A note.
    pub fn new(code: &'static str, en: String, ja: String) -> Self {
        Note { code, en, ja }
    }

    /// The sentence in a language.
    pub fn sentence(&self, lang: Lang) -> &str {
        match lang {
            Lang::En => &self.en,
            Lang::Ja => &self.ja,
        }
    }
}

/// Something that was decided without being told.
pub type Assumption = Note;
/// Something the user should know before trusting a result.
pub type Warning = Note;

/// What a column was taken for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Channel {
    /// Column number in its file, from 1.
    pub number: usize,
    /// File it is in.
    pub file: String,
    /// Name as written.
    pub name: String,
    /// Unit in use or as written; empty where unknown.
    pub unit: String,
    /// Canonical name it is read as (`acc_x`, `time_s`), or what it seems to be (`other`, `acceleration
    /// without gravity`), in English.
    pub role: String,
    /// True where its values are in the recording.
    pub used: bool,
}

/// A stretch without samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap {
    /// First sample after the gap.
    pub row: usize,
    /// Time of the last sample before it, s.
    pub from_s: f64,
    /// Its length, s.
    pub length_s: f64,
}

/// Length from which a gap is one over which an estimator must not trust its state, s.
pub const LONG_GAP_S: f64 = 0.5;

/// What was found in the data.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Findings {
    /// Rows in the recording.
    pub rows: usize,
    /// Nominal rate: one over the usual step, Hz.
    pub rate_hz: f64,
    /// Rows − 1 over the time span, Hz; lower than `rate_hz` where samples are missing.
    pub mean_rate_hz: f64,
    /// From the first sample to the last, s.
    pub duration_s: f64,
    /// True where time was made from a rate, not from stamps.
    pub time_from_rate: bool,
    /// Standard deviation of the usual steps, s.
    pub jitter_s: f64,
    /// Steps longer than 1.5 × the usual one.
    pub gap_count: usize,
    /// Their total length beyond the usual step, s.
    pub gap_total_s: f64,
    /// The longest gaps, in time order (at most 1000).
    pub gaps: Vec<Gap>,
    /// Rows that repeat the previous stamp.
    pub repeated_stamps: usize,
    /// Rows whose stamp lies before the previous one by less than a reset.
    pub backward_stamps: usize,
    /// Single stamps far from those before and after, which follow each other.
    pub wild_stamps: usize,
    /// Places where the clock or counter started again.
    pub resets: usize,
    /// Places where a counter of fixed width wrapped, undone.
    pub wraps: usize,
    /// Samples at the end of the sensor's range, per axis: acc x y z, gyr x y z.
    pub clipped: [usize; 6],
    /// The value at which each axis clips (SI), 0 where none.
    pub clip_level: [f64; 6],
    /// Rows left out (`skip_bad_rows`, incomplete first and last rows).
    pub skipped_rows: usize,
    /// |a| over the stillest stretches, m/s² (counts where `counts`).
    pub rest_norm: f64,
    /// Mean acceleration over the stillest second, m/s².
    pub rest_acc: Vec3,
    /// Largest spread (standard deviation) of an axis of the gyro over the stillest second, rad/s.
    pub rest_gyro_sigma: f64,
}

/// A kept column.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Extra {
    /// Name as written.
    pub name: String,
    /// The cells as written, one a row.
    pub cells: Vec<Box<str>>,
}

/// A recording: N samples in the sensor's axes.
#[derive(Clone, Debug, Default)]
pub struct Recording {
    /// Time of each sample, s, strictly increasing. The file's own clock; where that counts from 1970 it
    /// starts at 0 and `start_unix_s` holds the start.
    pub time_s: Vec<f64>,
    /// Time step of each sample, s: from the one before; the first has the usual step. Always > 0.
    pub dt_s: Vec<f64>,
    /// Specific force, m/s² (counts where `counts`).
    pub acc_m_s2: Vec<Vec3>,
    /// Angular rate, rad/s (counts where `counts`).
    pub gyro_rad_s: Vec<Vec3>,
    /// Temperature, °C.
    pub temp_c: Option<Vec<f64>>,
    /// Columns kept on request.
    pub extra: Vec<Extra>,
    /// Start of the recording, seconds since 1970, where the file says it.
    pub start_unix_s: Option<f64>,
    /// Values are raw counts (only with `Options::counts_ok`).
    pub counts: bool,
    /// Id of the dialect.
    pub dialect: &'static str,
    /// Name of the sensor in the file, where it has one.
    pub sensor: String,
    /// Every column of the input.
    pub channels: Vec<Channel>,
    /// What was decided without being told.
    pub assumptions: Vec<Assumption>,
    /// What to know before trusting a result.
    pub warnings: Vec<Warning>,
    /// What was found.
    pub findings: Findings,
}

impl Recording {
    /// Number of samples.
    pub fn len(&self) -> usize {
        self.acc_m_s2.len()
    }

    /// True where there are none (never for an opened recording).
    pub fn is_empty(&self) -> bool {
        self.acc_m_s2.is_empty()
    }

    pub(crate) fn assume(&mut self, code: &'static str, en: String, ja: String) {
        self.assumptions.push(Note::new(code, en, ja));
    }

    pub(crate) fn warn(&mut self, code: &'static str, en: String, ja: String) {
        self.warnings.push(Note::new(code, en, ja));
    }
}
