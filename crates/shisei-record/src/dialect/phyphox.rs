//! phyphox: `"Time (s)","Gyroscope x (rad/s)",…` or `"Time (s)","X (m/s^2)",…`, one file a sensor.
//!
//! `Linear Acceleration` (the name of the column or of the file) lacks gravity.

use super::{Dialect, names_with};

/// The dialect.
pub const DIALECT: Dialect = Dialect {
    id: "phyphox",
    name: "phyphox",
    recognises: |s| {
        s.header.first().is_some_and(|h| h.trim() == "Time (s)")
            && ["Acceleration x (m/s", "Gyroscope x (rad/s)", "X (m/s", "X (rad/s)"]
                .iter()
                .any(|n| names_with(s, n))
    },
    mend: |_, _| {},
};
