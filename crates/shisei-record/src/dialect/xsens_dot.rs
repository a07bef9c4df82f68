//! Movella / Xsens DOT: `sep=,`, lines of `Key:,value`, then `PacketCounter,SampleTimeFine,…`.
//!
//! `SampleTimeFine` counts microseconds in 32 bits; `Acc_*` m/s², `Gyr_*` deg/s; `FreeAcc_*` lacks gravity.

use super::{Dialect, preamble_with};
use crate::units::{DEG_S, M_S2, MICROSECOND};

/// The dialect.
pub const DIALECT: Dialect = Dialect {
    id: "xsens-dot",
    name: "Movella (Xsens) DOT",
    recognises: |s| {
        s.has_column("SampleTimeFine")
            && !s.preamble.iter().any(|l| l.starts_with("//"))
            && (preamble_with(s, "DeviceTag")
                || preamble_with(s, "OutputRate")
                || preamble_with(s, "AppVersion")
                || s.has_column("PacketCounter"))
    },
    mend: |_, reading| {
        reading.acc_unit = Some(M_S2);
        reading.gyro_unit = Some(DEG_S);
        reading.time_unit = Some(MICROSECOND);
        reading.time_cycle = Some(4_294_967_296.0);
    },
};
