//! Our own columns: `time_s, acc_x … gyr_z[, temp_c]`, m/s² and rad/s.

use super::Dialect;
use crate::units::{M_S2, RAD_S};

/// The dialect.
pub const DIALECT: Dialect = Dialect {
    id: "shisei",
    name: "shisei's columns",
    recognises: |s| s.has_column("time_s") && s.has_column("acc_x") && s.has_column("gyr_z"),
    mend: |_, reading| {
        reading.acc_unit = Some(M_S2);
        reading.gyro_unit = Some(RAD_S);
    },
};
