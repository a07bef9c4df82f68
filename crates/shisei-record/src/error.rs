//! Why a recording could not be opened, as one sentence that says what, where, what was expected and what
//! to do.

use shisei_core::Lang;
use std::fmt;

/// Result of this crate.
pub type Result<T> = std::result::Result<T, Error>;

/// Where in a file: empty parts are not known or do not matter.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Place {
    /// File name as the caller gave it.
    pub file: String,
    /// Line, from 1.
    pub line: Option<usize>,
    /// Column, from 1, and its header text (empty where there is none).
    pub column: Option<(usize, String)>,
}

/// What is wrong with the input or with an option.
#[derive(Clone, Debug, PartialEq)]
pub enum Problem {
    /// The file has no bytes, or only blank lines.
    Empty,
    /// There is a header and no row of numbers.
    HeaderOnly,
    /// Fewer rows than a recording needs.
    TooFewRows {
        /// Rows found.
        rows: usize,
    },
    /// The bytes are not text.
    NotText,
    /// The bytes are of a known kind that this reader does not open.
    OtherFormat {
        /// The kind, and what to do with it (English, Japanese).
        format: &'static str,
    },
    /// A line is longer than any recording's line.
    LineTooLong {
        /// The limit, bytes.
        limit: usize,
    },
    /// No table of numbers was found.
    NoTable,
    /// Numbers with a sign between thousands, as `1,000`.
    Grouped {
        /// The first of them.
        text: String,
    },
    /// The time of many rows is before that of earlier ones.
    Unsorted {
        /// How many.
        count: usize,
        /// Of how many rows.
        rows: usize,
    },
    /// A table, but none of its columns is an acceleration or an angular rate.
    NotARecording {
        /// The columns' names.
        columns: Vec<String>,
    },
    /// Some of the three axes of a quantity are there, others are not.
    MissingColumn {
        /// What is missing, canonical names.
        missing: Vec<String>,
        /// The columns' names.
        columns: Vec<String>,
    },
    /// No angular rate.
    NoGyro {
        /// The columns' names.
        columns: Vec<String>,
    },
    /// No acceleration.
    NoAcc {
        /// The columns' names.
        columns: Vec<String>,
    },
    /// Gravity was taken out of the acceleration.
    GravityRemoved {
        /// The column that says so, or empty where the values do.
        column: String,
        /// |a| at rest, m/s², where it was measured.
        norm_m_s2: Option<f64>,
    },
    /// Integers of an analogue-to-digital converter, without a scale.
    RawCounts {
        /// |a| at rest, counts.
        norm: f64,
    },
    /// |a| at rest fits no unit.
    UnitUnclear {
        /// |a| at rest as read.
        norm: f64,
    },
    /// No time column and no rate.
    RateNeeded,
    /// More than one sensor; one must be chosen.
    ManySensors {
        /// Their names.
        names: Vec<String>,
    },
    /// A recording of messages has none of a motion sensor.
    NoSamples,
    /// The chosen sensor is not there.
    NoSuchSensor {
        /// What was asked for.
        asked: String,
        /// The names there are.
        names: Vec<String>,
    },
    /// A named column is not there.
    NoSuchColumn {
        /// What was asked for.
        asked: String,
        /// The columns' names.
        columns: Vec<String>,
    },
    /// A cell that must be a number is text.
    NotANumber {
        /// The text, shortened.
        text: String,
    },
    /// A cell is NaN or infinite.
    NotFinite {
        /// The text.
        text: String,
    },
    /// A cell is blank.
    Blank,
    /// A row ends before the columns that are needed.
    ShortRow {
        /// Cells in the row.
        cells: usize,
        /// Cells needed.
        needed: usize,
    },
    /// A time stamp cannot be read.
    BadStamp {
        /// The text, shortened.
        text: String,
    },
    /// An option's value cannot be read.
    BadOption {
        /// The option, with its dashes.
        option: &'static str,
        /// The value.
        value: String,
        /// What is expected, by example.
        expected: &'static str,
    },
    /// Parquet data in a compression that is not built in.
    Compression {
        /// Its name.
        codec: String,
    },
    /// A compressed or Parquet file is damaged.
    Damaged {
        /// The kind of file.
        format: &'static str,
        /// What the decoder said.
        detail: String,
    },
    /// Reading went wrong on the way.
    Unreadable {
        /// What the system said.
        detail: String,
    },
    /// Unpacked, the file is larger than the limit.
    TooLarge {
        /// The limit, bytes.
        limit: u64,
    },
    /// Files given together do not share a stretch of time.
    NoOverlap,
    /// Files given together hold the same quantity.
    SameQuantity {
        /// The quantity (`acc` or `gyr`).
        quantity: &'static str,
    },
}

/// A problem and its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Error {
    /// What is wrong.
    pub problem: Problem,
    /// Where.
    pub place: Box<Place>,
}

impl Error {
    /// A problem of a whole file.
    pub fn of_file(file: &str, problem: Problem) -> Self {
        Error { problem, place: Box::new(Place { file: file.to_owned(), ..Place::default() }) }
    }

    /// A problem of an option.
    pub fn of_option(option: &'static str, value: &str, expected: &'static str) -> Self {
        Error {
            problem: Problem::BadOption { option, value: shorten(value), expected },
            place: Box::default(),
        }
    }

    /// A problem with its place.
    pub fn at(problem: Problem, place: Place) -> Self {
        Error { problem, place: Box::new(place) }
    }

    /// The exit code of INTERFACES: 1 where the data do not meet a condition, 2 for bad input or usage.
    pub fn exit_code(&self) -> u8 {
        match self.problem {
            Problem::GravityRemoved { .. } | Problem::NoOverlap => 1,
            _ => 2,
        }
    }

    /// The sentence in a language.
    pub fn sentence(&self, lang: Lang) -> String {
        let place = self.place.text(lang);
        let text = match lang {
            Lang::En => crate::error_text::english(&self.problem),
            Lang::Ja => crate::error_text::japanese(&self.problem),
        };
        if place.is_empty() { text } else { format!("{place}: {text}") }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.sentence(Lang::En))
    }
}

impl std::error::Error for Error {}

impl Place {
    /// `file, line 3, column 5 ("Gx[rad/s]")`, in a language.
    pub fn text(&self, lang: Lang) -> String {
        let mut out = self.file.clone();
        let mut add = |part: String| {
            if !out.is_empty() {
                out.push_str(", ");
            }
            out.push_str(&part);
        };
        if let Some(line) = self.line {
            add(match lang {
                Lang::En => format!("line {line}"),
                Lang::Ja => format!("{line} 行目"),
            });
        }
        if let Some((number, name)) = &self.column {
            let name = if name.is_empty() { String::new() } else { format!(" (\"{}\")", shorten(name)) };
            add(match lang {
                Lang::En => format!("column {number}{name}"),
                Lang::Ja => format!("{number} 列目{name}"),
            });
        }
        out
    }
}

/// A text cut to 40 characters, control characters shown as `·`.
pub(crate) fn shorten(text: &str) -> String {
    let mut out: String = text.chars().take(40).map(|c| if c.is_control() { '·' } else { c }).collect();
    if text.chars().nth(40).is_some() {
        out.push('…');
    }
    out
}
