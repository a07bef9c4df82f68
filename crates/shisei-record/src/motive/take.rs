//! A take as the file has it.

use super::error::{Error, Problem, Result};
use crate::Warning;
use shisei_core::frames::Axes;

/// How rotations are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rotation {
    /// X, Y, Z, W.
    Quaternion,
    /// Degrees about the body's own axes (0, 1, 2 for x, y, z), the first first: R = R_a R_b R_c.
    Euler([usize; 3]),
}

/// Details of the layout that differ between versions.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Style {
    /// Cell in which heading rows say what they are (`Type`, `Name`, `ID`, `Parent`); none in 1.21.
    pub word_cell: Option<usize>,
    /// True where there is a row of parents (1.25).
    pub has_parents: bool,
    /// Heading of the time column, `Time` or `Time (Seconds)`; empty where there is none.
    pub time_heading: String,
    /// Heading of the time code column; empty where there is none.
    pub timecode_heading: String,
}

/// A column that carries data.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Column {
    /// `Rigid Body`, `Rigid Body Marker`, `Bone`, `Marker` …
    pub kind: Box<str>,
    /// Name of the body or marker.
    pub name: Box<str>,
    /// Motive's identifier.
    pub id: Box<str>,
    /// Name of the parent, 1.25.
    pub parent: Box<str>,
    /// `Rotation`, `Position`, `Error Per Marker`, `Marker Quality` …
    pub quantity: Box<str>,
    /// `X`, `Y`, `Z`, `W` or empty.
    pub axis: Box<str>,
    /// One number a frame, as written; NaN where the cell is blank.
    pub cells: Vec<f64>,
}

/// A take: one row a frame.
#[derive(Clone, Debug)]
pub struct Take {
    /// File name as given, for messages.
    pub file: String,
    /// Keys and values of the first row, in order.
    pub info: Vec<(String, String)>,
    /// Layout.
    pub style: Style,
    /// Frame numbers, ascending.
    pub frame: Vec<i64>,
    /// Time column, s, as written; NaN where blank, empty where there is no such column.
    pub stamp_s: Vec<f64>,
    /// Time code column; empty where there is none.
    pub timecode: Vec<Box<str>>,
    /// Columns that carry data.
    pub columns: Vec<Column>,
    /// What it lacks.
    pub warnings: Vec<Warning>,
}

/// The key of the first row that says how many rows follow.
pub(super) const EXPORTED: &str = "Total Exported Frames";

impl Take {
    /// A value of the first row.
    pub fn info(&self, key: &str) -> Option<&str> {
        self.info.iter().find(|(k, _)| k.eq_ignore_ascii_case(key)).map(|(_, value)| value.as_str())
    }

    fn number(&self, key: &str) -> Option<f64> {
        self.info(key)?.trim().parse::<f64>().ok().filter(|value| value.is_finite())
    }

    /// Number of frames.
    pub fn len(&self) -> usize {
        self.frame.len()
    }

    /// True where there is none (never for a take that was read).
    pub fn is_empty(&self) -> bool {
        self.frame.is_empty()
    }

    /// `1.21` … `1.25`; empty where the first row does not say.
    pub fn version(&self) -> &str {
        self.info("Format Version").unwrap_or_default()
    }

    /// `Total Frames in Take`, which counts frames that were not exported too.
    pub fn total_frames(&self) -> Option<u64> {
        self.number("Total Frames in Take").filter(|count| *count >= 0.0).map(|count| count as u64)
    }

    /// `Total Exported Frames`: as many rows as there should be.
    pub fn exported_frames(&self) -> Option<u64> {
        self.number(EXPORTED).filter(|count| *count >= 0.0).map(|count| count as u64)
    }

    /// Frames a second of the frame numbers, Hz: the export rate, else the capture rate, else from the time
    /// column. Refused where none of them says it.
    pub fn rate_hz(&self) -> Result<f64> {
        let named = ["Export Frame Rate", "Capture Frame Rate"].iter().find_map(|key| self.number(key));
        if let Some(rate) = named.filter(|rate| *rate > 0.0) {
            return Ok(rate);
        }
        let span = || {
            let frames = self.frame.last()?.checked_sub(*self.frame.first()?)? as f64;
            let seconds = self.stamp_s.last()? - self.stamp_s.first()?;
            Some(frames / seconds).filter(|rate| rate.is_finite() && *rate > 0.0)
        };
        span().ok_or_else(|| self.refuse(Problem::NoRate))
    }

    /// Time of each frame, s: frame number / rate, from the take's frame 0.
    pub fn time_s(&self) -> Result<Vec<f64>> {
        let rate_hz = self.rate_hz()?;
        Ok(self.frame.iter().map(|frame| *frame as f64 / rate_hz).collect())
    }

    /// Times of an inertial recording's samples on the take's clock, s, from the frame sequence that a receiver
    /// counted (the real-valued frame index of each sample; NaN before and after the gate is left as it is).
    /// Refused: a sequence that goes back, and one whose count is more than two off `Total Frames in Take`.
    pub fn sequence_s(&self, frame: &[f64]) -> Result<Vec<f64>> {
        let rate_hz = self.rate_hz()?;
        let mut last = f64::NEG_INFINITY;
        for (row, frame) in frame.iter().enumerate().filter(|(_, frame)| frame.is_finite()) {
            if *frame <= last {
                return Err(self.refuse(Problem::SequenceReset { sample: row + 1 }));
            }
            last = *frame;
        }
        let counted = if last.is_finite() && last >= 0.0 { last.ceil() as u64 + 1 } else { 0 };
        if let Some(total) = self.total_frames().filter(|total| total.abs_diff(counted) > 2) {
            return Err(self.refuse(Problem::SequenceCount { counted, total }));
        }
        Ok(frame.iter().map(|frame| frame / rate_hz).collect())
    }

    /// Units of length in a metre: 1, 100 or 1000; 1 where the first row does not say.
    pub fn lengths_in_m(&self) -> Result<f64> {
        let Some(text) = self.info("Length Units") else { return Ok(1.0) };
        match text.trim().to_ascii_lowercase().as_str() {
            "" | "meters" | "meter" | "metres" | "m" => Ok(1.0),
            "centimeters" | "centimeter" | "centimetres" | "cm" => Ok(100.0),
            "millimeters" | "millimeter" | "millimetres" | "mm" => Ok(1000.0),
            _ => Err(self.refuse(Problem::LengthUnit { text: text.to_owned() })),
        }
    }

    /// The rotation type; quaternions where the first row does not say.
    pub fn rotation(&self) -> Result<Rotation> {
        let text = self.info("Rotation Type").unwrap_or_default();
        let lower = text.trim().to_ascii_lowercase();
        if lower.is_empty() || lower.contains("quaternion") {
            return Ok(Rotation::Quaternion);
        }
        let order = lower.split(|c: char| !c.is_ascii_alphabetic()).find_map(euler_order);
        order.map(Rotation::Euler).ok_or_else(|| self.refuse(Problem::RotationType { text: text.to_owned() }))
    }

    /// The world's axes: y-up unless a key of the first row (`Up Axis` and the like) names z.
    pub fn axes(&self) -> Axes {
        let up = self.info.iter().find(|(key, _)| {
            let key = key.to_ascii_lowercase();
            key.starts_with("up ") || key.ends_with(" up") || key == "up"
        });
        match up {
            Some((_, value)) if value.to_ascii_lowercase().contains('z') => Axes::ZUp,
            _ => Axes::YUp,
        }
    }

    /// True where poses are relative to their parents.
    pub fn is_local(&self) -> bool {
        self.info("Coordinate Space").is_some_and(|space| space.trim().eq_ignore_ascii_case("local"))
    }

    pub(super) fn refuse(&self, problem: Problem) -> Error {
        Error::of_file(&self.file, problem)
    }
}

/// `xyz` and its permutations.
fn euler_order(word: &str) -> Option<[usize; 3]> {
    let [a, b, c] = <[u8; 3]>::try_from(word.as_bytes()).ok()?;
    let order = [a, b, c].map(|letter| usize::from(letter.wrapping_sub(b'x')));
    let mut seen = [false; 3];
    for axis in order {
        *seen.get_mut(axis)? = true;
    }
    seen.iter().all(|axis| *axis).then_some(order)
}
