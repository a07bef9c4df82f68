//! Sensor Logger (Android, iOS): `time,seconds_elapsed,z,y,x`, one file a sensor, nanoseconds since 1970.
//!
//! `Accelerometer.csv` lacks gravity; `TotalAcceleration.csv` has it, or `Gravity.csv` given with it.
//! Uncalibrated accelerations of iOS are in g. Unless standardised, iOS turns the sign.

use super::Dialect;
use crate::names::Quantity;
use crate::units::{M_S2, RAD_S, SECOND};

/// The dialect.
pub const DIALECT: Dialect = Dialect {
    id: "sensor-logger",
    name: "Sensor Logger",
    recognises: |s| s.has_column("seconds_elapsed"),
    mend: |sheet, reading| {
        let stem = sheet.name.rsplit(['/', '\\']).next().unwrap_or(sheet.name).to_lowercase();
        let uncalibrated = stem.contains("uncalibrated");
        let quantity =
            if stem.starts_with("totalacceleration") || (stem.starts_with("accelerometer") && uncalibrated) {
                Some(Quantity::Acceleration)
            } else if stem.starts_with("accelerometer") {
                Some(Quantity::LinearAcceleration)
            } else if stem.starts_with("gravity") {
                Some(Quantity::Gravity)
            } else if stem.starts_with("gyroscope") {
                Some(Quantity::AngularRate)
            } else {
                None
            };
        for (m, name) in reading.meanings.iter_mut().zip(&sheet.header) {
            let bare = name.trim().len() == 1 && m.axis.is_some();
            if bare && let Some(quantity) = quantity {
                m.quantity = quantity;
                m.unit = match quantity {
                    Quantity::AngularRate => Some(RAD_S),
                    _ if uncalibrated => None,
                    _ => Some(M_S2),
                };
            } else if name.trim().eq_ignore_ascii_case("seconds_elapsed") {
                m.quantity = Quantity::Time;
                m.unit = Some(SECOND);
            } else if bare && m.quantity != Quantity::Other {
                m.quantity = Quantity::Other;
            }
        }
    },
};
