//! x-io (x-IMU3, NGIMU): `Timestamp (us),Gyroscope X (deg/s),…,Accelerometer X (g),…`, gyroscope first.

use super::{Dialect, names_with};

/// The dialect.
pub const DIALECT: Dialect = Dialect {
    id: "x-io",
    name: "x-io x-IMU3 or NGIMU",
    recognises: |s| names_with(s, "Gyroscope X (deg/s)") && names_with(s, "Accelerometer X (g)"),
    mend: |_, _| {},
};
