//! Results as tables: CSV, or Parquet where the file name ends in `.parquet`.

use std::io::{self, Write};
use std::path::Path;

use shisei_core::orient::{Later, Orientation};
use shisei_core::{Error, Quaternion};
use shisei_record::write::{self, Column, Decimals, Made};
use shisei_record::{Note, Recording};
use shisei_wide::Vectors;

use crate::output::Kind;

/// What a table is written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    Csv,
    Parquet,
}

impl Format {
    /// By the ending of the file's name.
    pub fn of(path: &Path) -> Format {
        let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
        if ending.as_deref() == Some("parquet") { Format::Parquet } else { Format::Csv }
    }

    /// What an earlier result of this format looks like.
    pub fn kind(self, csv: Kind) -> Kind {
        if self == Format::Parquet { Kind::Parquet } else { csv }
    }
}

/// Writes `time_s, acc_x … gyr_z`, `temp_c` where there is one, and the kept columns of the input.
pub fn recording(out: &mut dyn Write, format: Format, recording: &Recording) -> io::Result<()> {
    match format {
        Format::Csv => write::recording_csv(out, recording, Decimals::Shortest),
        Format::Parquet => {
            let mut bytes = Vec::new();
            shisei_record::parquet_write::recording_parquet(&mut bytes, recording)?;
            out.write_all(&bytes)
        }
    }
}

/// Names of the orientation columns; `unit` is that of the angles in names.
pub fn orientation_names(unit: &str, certain: bool) -> Vec<String> {
    let mut names = ["time_s", "q_w", "q_x", "q_y", "q_z"].map(str::to_owned).to_vec();
    names.extend(["yaw", "pitch", "roll"].map(|name| format!("{name}_{unit}")));
    if certain {
        names.extend(["sigma_tilt", "sigma_heading"].map(|name| format!("{name}_{unit}")));
        names.push("rest".to_owned());
    }
    names
}

/// Says of each kept column whose name is one of ours, or of another, what it is called in the result.
pub fn note_renamed(recording: &mut Recording, ours: &[&str]) {
    let names = write::kept_names(ours, &recording.extra);
    let renamed = recording.extra.iter().zip(names).filter(|(extra, name)| extra.name != *name);
    recording.assumptions.extend(renamed.map(|(extra, name)| {
        let own = &extra.name;
        Note::new(
            "renamed",
            format!(
                "the input's column {own} is called {name} in the result, which has another column {own}"
            ),
            format!("入力の列 {own} は、結果に同名の列があるため {name} として残します"),
        )
    }));
}

/// Writes `time_s, q_w … q_z, yaw, pitch, roll`, how sure the estimator is, and the kept columns of the input.
/// Angles are in the unit of `unit`: its name in the columns' names, and how many of it are a radian.
pub fn orientation(
    out: &mut dyn Write,
    format: Format,
    recording: &Recording,
    (found, later): (&Orientation, &mut Later<'_>),
    (unit, per_rad): (&str, f64),
) -> io::Result<AngleRanges> {
    let mut rows = Rows::of(found, later, per_rad);
    let names = orientation_names(unit, found.certainty.is_some());
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let kept = write::kept_names(&names, &recording.extra);
    let sigmas = found
        .certainty
        .as_ref()
        .map_or([[].as_slice(); 2], |c| [c.sigma_tilt_rad.as_slice(), &c.sigma_heading_rad])
        .map(|sigma| {
            move |start: usize, out: &mut [f64]| {
                for (value, sigma) in out.iter_mut().zip(sigma.iter().skip(start)) {
                    *value = sigma * per_rad;
                }
            }
        });
    let before = [Column::Numbers(&recording.time_s)];
    let mut after = Vec::new();
    if let Some(certainty) = &found.certainty {
        after.extend(sigmas.iter().map(|fill| Column::Computed { rows: recording.len(), fill }));
        after.push(Column::Flags(&certainty.rest));
    }
    after.extend(recording.extra.iter().map(|extra| Column::Texts(&extra.cells)));
    match format {
        Format::Csv => {
            let mut next = |out: &mut [f64], length: usize| rows.next(out, length);
            let mut made = Made { rows: recording.len(), columns: COLUMNS, next: &mut next };
            write::csv_made(out, (&names, &kept), (&before, &mut made, &after), Decimals::Shortest)?;
        }
        Format::Parquet => {
            let mut made = vec![0.0; recording.len() * COLUMNS];
            rows.next(&mut made, COLUMNS);
            let mut columns = before.to_vec();
            columns.extend((0..COLUMNS).map(|offset| Column::Strided {
                values: &made,
                stride: COLUMNS,
                offset,
            }));
            columns.extend(after);
            let names: Vec<&str> = names.iter().copied().chain(kept.iter().map(String::as_str)).collect();
            let mut bytes = Vec::new();
            shisei_record::parquet_write::parquet(&mut bytes, &names, &columns)?;
            out.write_all(&bytes)?;
        }
    }
    rows.failed.map_or(Ok(rows.ranges), |error| Err(io::Error::other(error)))
}

/// Least and greatest yaw, pitch, roll, rad.
pub type AngleRanges = [(f64, f64); 3];

/// `q_w … q_z, yaw, pitch, roll`
const COLUMNS: usize = 7;

/// Attitudes and angles, row after row.
struct Rows<'a, 'b> {
    found: &'a Orientation,
    later: &'a mut Later<'b>,
    /// The attitudes of the rows at hand.
    world_from_body: Vec<Quaternion>,
    per_rad: f64,
    ranges: AngleRanges,
    failed: Option<Error>,
}

impl<'a, 'b> Rows<'a, 'b> {
    fn of(found: &'a Orientation, later: &'a mut Later<'b>, per_rad: f64) -> Self {
        let ranges = [(f64::INFINITY, f64::NEG_INFINITY); 3];
        Rows { found, later, world_from_body: Vec::new(), per_rad, ranges, failed: None }
    }

    /// The next rows, each at the beginning of a part of `out` of the given length.
    fn next(&mut self, out: &mut [f64], length: usize) {
        let found = self.found;
        self.world_from_body.resize(out.len().div_ceil(length), Quaternion::IDENTITY);
        if let Err(error) = self.later.next(found, &mut self.world_from_body) {
            self.failed.get_or_insert(error);
        }
        let ypr_rad = Vectors::widest().ypr_rad(&self.world_from_body, found.start, found.relative);
        let rows = out.chunks_mut(length).filter_map(|row| row.first_chunk_mut::<COLUMNS>());
        let mut ranges = self.ranges;
        for ((row, q), ypr) in rows.zip(&self.world_from_body).zip(&ypr_rad) {
            row[..4].copy_from_slice(&q.to_array());
            for ((place, rad), (least, most)) in row[4..].iter_mut().zip(ypr).zip(&mut ranges) {
                *least = if rad < least { *rad } else { *least };
                *most = if rad > most { *rad } else { *most };
                *place = rad * self.per_rad;
            }
        }
        self.ranges = ranges;
    }
}
