//! MicroStrain SensorConnect: `Time,inertial-NNNN:scaledAccelX,…,scaledGyroX,…` (g, rad/s), axes z-down.
//!
//! The raw (`scaled`) channels go before the estimator's (`estCompensatedAccel`, `estAngularRate`).

use super::{Dialect, names_with};
use crate::names::Quantity;
use crate::plan::Reading;
use crate::recording::Note;
use crate::sheet::Sheet;
use crate::units::{RAD_S, STANDARD_G, Unit};

/// The dialect.
pub const DIALECT: Dialect = Dialect {
    id: "microstrain",
    name: "MicroStrain SensorConnect",
    recognises: |s| {
        names_with(s, "scaledAccelX")
            || names_with(s, "estCompensatedAccel")
            || names_with(s, "estLinearAccel")
    },
    mend,
};

fn mend(sheet: &Sheet<'_>, reading: &mut Reading) {
    let scaled = names_with(sheet, "scaledAccelX");
    let scaled_gyro = names_with(sheet, "scaledGyroX");
    let names = sheet.column_names();
    for (m, name) in reading.meanings.iter_mut().zip(&names) {
        let lower = name.to_lowercase();
        if lower.contains("delta") || lower.contains("quality") {
            m.quantity = Quantity::Other;
        }
        if lower.contains("est")
            && (scaled && m.quantity == Quantity::Acceleration
                || scaled_gyro && m.quantity == Quantity::AngularRate)
        {
            m.quantity = Quantity::Other;
        }
        // The estimator's compensated acceleration is in m/s², the scaled one in g.
        if lower.contains("est") && m.quantity == Quantity::Acceleration && m.unit.is_none() {
            m.unit = Some(Unit::Acceleration(1.0, "m/s²"));
        }
    }
    reading.acc_unit = Some(STANDARD_G);
    reading.gyro_unit = Some(RAD_S);
    reading.warnings.push(Note::new(
        "axes-z-down",
        "the axes of MicroStrain sensors point z down; --axes x,-y,-z turns them z up".into(),
        "MicroStrain のセンサは z 軸が下向きです。--axes x,-y,-z で上向きにできます".into(),
    ));
}
