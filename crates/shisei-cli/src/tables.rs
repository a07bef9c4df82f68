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
/// `angles` are in the unit of `unit`: its name in the columns' names, and how many of it are a radian.
pub fn orientation(
    out: &mut dyn Write,
    format: Format,
    recording: &Recording,
    orientation: &Orientation,
    angles: &[[f64; 3]],
    (unit, per_rad): (&str, f64),
) -> io::Result<()> {
    let quaternions: Vec<[f64; 4]> = orientation.world_from_body.iter().map(|q| q.to_array()).collect();
    let with_unit = |name: &str| format!("{name}_{unit}");
    let angle_names = ["yaw", "pitch", "roll"].map(with_unit);
    let sigma_names = ["sigma_tilt", "sigma_heading"].map(with_unit);
    let sigmas = orientation.certainty.as_ref().map(|certainty| {
        [&certainty.sigma_tilt_rad, &certainty.sigma_heading_rad]
            .map(|sigma| sigma.iter().map(|&s| s * per_rad).collect::<Vec<f64>>())
    });
    let mut names = vec!["time_s", "q_w", "q_x", "q_y", "q_z"];
    let mut columns = vec![Column::Numbers(&recording.time_s)];
    for offset in 0..4 {
        columns.push(Column::Strided { values: quaternions.as_flattened(), stride: 4, offset });
    }
    for (offset, name) in angle_names.iter().enumerate() {
        names.push(name);
        columns.push(Column::Strided { values: angles.as_flattened(), stride: 3, offset });
    }
    if let (Some(sigmas), Some(certainty)) = (&sigmas, &orientation.certainty) {
        for (name, sigma) in sigma_names.iter().zip(sigmas) {
            names.push(name);
            columns.push(Column::Numbers(sigma));
        }
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
