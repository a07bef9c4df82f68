//! What the calibration functions share: the worksheet's columns to and from the core's types.

use crate::error::{Error, Result};
use crate::input::{CalibParameters, SixColumns};
use crate::output::{SameAsFirst, Table};
use crate::value::Shape;
use shisei_core::calibration::{Calibration, SensorModel, SixFaceSettings, search_faces, six_face};
use shisei_core::{Vec3, vector};

/// The nine of `GetBiasCalib`.
pub(super) fn nine(rows: &[[f64; 6]], dt_s: f64, settings: &SixFaceSettings) -> Result<[f64; 9]> {
    let (acc, gyro) = split(rows);
    Ok(six_face(&acc, &gyro, dt_s, settings)?.calibration.to_nine())
}

/// A row a face, in the order +x, −x, +y, −y, +z, −z: found, start s, worst variance, tilt rad, |a|. A face
/// that never pointed up has NaN after its 0: doors show it as not available.
pub(super) fn faces(rows: &[[f64; 6]], dt_s: f64, settings: &SixFaceSettings) -> Result<Table<6, 5>> {
    let (acc, gyro) = split(rows);
    let table = search_faces(&acc, &gyro, dt_s, settings)?;
    let missing = table.missing().map(|row| row.face).collect::<Vec<_>>();
    Ok(Table(table.faces.map(|row| {
        let found = if missing.contains(&row.face) { 0.0 } else { 1.0 };
        row.window.map_or([found, f64::NAN, f64::NAN, f64::NAN, f64::NAN], |w| {
            [found, w.start_row as f64 * dt_s, w.worst_variance(), w.tilt_rad, w.mean_norm()]
        })
    })))
}

/// `(x − bias) · scale`, column by column.
pub(super) fn apply(data: SixColumns<'_>, parameters: CalibParameters) -> Result<SameAsFirst> {
    match (data, parameters) {
        (SixColumns::Three(series), CalibParameters::Six(six)) => {
            let mut out = vec![[0.0; 3]; series.rows.len()];
            SensorModel::from_six(six).apply_series(series.rows, &mut out)?;
            Ok(SameAsFirst::Three(out))
        }
        (SixColumns::Six(series), CalibParameters::Twelve(twelve)) => {
            let calibration = Calibration::from_twelve(twelve);
            let corrected = |(row, r): (usize, &[f64; 6])| {
                let acc = calibration.accelerometer.apply([r[0], r[1], r[2]]);
                let gyro = calibration.gyroscope.apply([r[3], r[4], r[5]]);
                if vector::is_finite(acc) && vector::is_finite(gyro) {
                    Ok([acc[0], acc[1], acc[2], gyro[0], gyro[1], gyro[2]])
                } else {
                    Err(Error::Core(shisei_core::Error::NotFinite { row }))
                }
            };
            series.rows.iter().enumerate().map(corrected).collect::<Result<_>>().map(SameAsFirst::Six)
        }
        (SixColumns::Three(_), CalibParameters::Twelve(_)) => Err(misfit(6, 12)),
        (SixColumns::Six(_), CalibParameters::Six(_)) => Err(misfit(12, 6)),
    }
}

fn misfit(needed: usize, given: usize) -> Error {
    Error::WrongShape { arg: "calibRange", expected: Shape::Vector(needed), rows: 1, cols: given }
}

fn split(rows: &[[f64; 6]]) -> (Vec<Vec3>, Vec<Vec3>) {
    rows.iter().map(|r| ([r[0], r[1], r[2]], [r[3], r[4], r[5]])).unzip()
}
