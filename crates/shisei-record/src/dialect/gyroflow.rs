//! Gyroflow `.gcsv`: `GYROFLOW IMU LOG`, lines of `key,value`, then `t,gx,gy,gz,ax,ay,az`.
//!
//! `tscale` seconds, `gscale` rad/s and `ascale` g a count; `orientation` (capital letters positive) is told,
//! not applied.

use super::{Dialect, preamble_with};
use crate::plan::Reading;
use crate::recording::Note;
use crate::sheet::Sheet;
use crate::units::Unit;
use shisei_core::STANDARD_GRAVITY_M_S2 as G;

/// The dialect.
pub const DIALECT: Dialect = Dialect {
    id: "gyroflow",
    name: "Gyroflow log",
    recognises: |s| preamble_with(s, "GYROFLOW IMU LOG") || preamble_with(s, "CAMERA IMU LOG"),
    mend,
};

fn value<'s>(sheet: &'s Sheet<'_>, key: &str) -> Option<&'s str> {
    sheet.preamble.iter().find_map(|line| {
        let (name, value) = line.split_once(',')?;
        name.trim().eq_ignore_ascii_case(key).then(|| value.trim())
    })
}

fn mend(sheet: &Sheet<'_>, reading: &mut Reading) {
    let factor = |key: &str| {
        value(sheet, key).and_then(|v| v.parse::<f64>().ok()).filter(|f| f.is_finite() && *f > 0.0)
    };
    reading.time_unit = Some(Unit::Time(factor("tscale").unwrap_or(1.0), "tscale"));
    reading.gyro_unit = Some(Unit::AngularRate(factor("gscale").unwrap_or(1.0), "counts × gscale"));
    reading.acc_unit = Some(Unit::Acceleration(factor("ascale").unwrap_or(1.0) * G, "counts × ascale"));
    // The preamble's numbers are no rate.
    reading.rate_hz = None;
    if let Some(orientation) = value(sheet, "orientation").filter(|o| *o != "XYZ" && o.len() == 3) {
        let axes: Vec<String> = orientation
            .chars()
            .map(|c| if c.is_uppercase() { c.to_lowercase().to_string() } else { format!("-{c}") })
            .collect();
        let axes = axes.join(",");
        reading.warnings.push(Note::new(
            "orientation-not-applied",
            format!("the log names the orientation {orientation}; it is not applied: --axes {axes} does so"),
            format!(
                "ログに向き {orientation} の指定がありますが、適用していません。--axes {axes} で適用できます"
            ),
        ));
    }
}
