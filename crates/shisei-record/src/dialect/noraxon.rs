//! Noraxon: `time;Pelvis Accel Sensor X (mG);…`, milli-g, semicolons with decimal comma, several sensors.

use super::{Dialect, names_with};

/// The dialect.
pub const DIALECT: Dialect = Dialect {
    id: "noraxon",
    name: "Noraxon",
    recognises: |s| names_with(s, "Accel Sensor X (mG)") || preamble_with_noraxon(s),
    mend: |_, _| {},
};

fn preamble_with_noraxon(sheet: &crate::sheet::Sheet<'_>) -> bool {
    super::preamble_with(sheet, "noraxon")
}
