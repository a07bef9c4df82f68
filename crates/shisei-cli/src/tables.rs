//! Results as tables: CSV, or Parquet where the file name ends in `.parquet`.

use std::io::{self, Write};
use std::path::Path;

use shisei_core::orient::Orientation;
use shisei_record::Recording;
use shisei_record::write::{self, Column, Decimals};

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

/// Writes `time_s, q_w … q_z, yaw, pitch, roll`, how sure the estimator is, and the kept columns of the input.
/// Angles are in the unit of `unit`: its name in the columns' names, and how many of it are a radian.
pub fn orientation(
    out: &mut dyn Write,
    format: Format,
    recording: &Recording,
    orientation: &Orientation,
    ypr_rad: &[[f64; 3]],
    (unit, per_rad): (&str, f64),
) -> io::Result<()> {
    let quaternions = &orientation.world_from_body;
    let with_unit = |name: &str| format!("{name}_{unit}");
    let angle_names = ["yaw", "pitch", "roll"].map(with_unit);
    let sigma_names = ["sigma_tilt", "sigma_heading"].map(with_unit);
    let parts = [0, 1, 2, 3].map(|i| {
        move |start: usize, out: &mut [f64]| {
            for (value, q) in out.iter_mut().zip(quaternions.iter().skip(start)) {
                *value = q.to_array()[i];
            }
        }
    });
    let angles = [0, 1, 2].map(|i| {
        move |start: usize, out: &mut [f64]| {
            for (value, ypr) in out.iter_mut().zip(ypr_rad.iter().skip(start)) {
                *value = ypr[i] * per_rad;
            }
        }
    });
    let certainty = orientation.certainty.as_ref();
    let sigmas = certainty
        .map_or([[].as_slice(); 2], |c| [c.sigma_tilt_rad.as_slice(), &c.sigma_heading_rad])
        .map(|sigma| {
            move |start: usize, out: &mut [f64]| {
                for (value, sigma) in out.iter_mut().zip(sigma.iter().skip(start)) {
                    *value = sigma * per_rad;
                }
            }
        });

    let rows = quaternions.len();
    let mut names = vec!["time_s", "q_w", "q_x", "q_y", "q_z"];
    let mut columns = vec![Column::Numbers(&recording.time_s)];
    columns.extend(parts.iter().map(|fill| Column::Computed { rows, fill }));
    names.extend(angle_names.iter().map(String::as_str));
    columns.extend(angles.iter().map(|fill| Column::Computed { rows, fill }));
    if let Some(certainty) = certainty {
        names.extend(sigma_names.iter().map(String::as_str));
        columns.extend(sigmas.iter().map(|fill| Column::Computed { rows, fill }));
        names.push("rest");
        columns.push(Column::Flags(&certainty.rest));
    }
    for extra in &recording.extra {
        names.push(&extra.name);
        columns.push(Column::Texts(&extra.cells));
    }
    match format {
        Format::Csv => write::csv(out, &names, &columns, Decimals::Shortest),
        Format::Parquet => {
            let mut bytes = Vec::new();
            shisei_record::parquet_write::parquet(&mut bytes, &names, &columns)?;
            out.write_all(&bytes)
        }
    }
}
