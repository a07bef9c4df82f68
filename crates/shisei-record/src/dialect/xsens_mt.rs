//! Xsens MT Manager: a block of `//` lines of varying length (`// Update Rate: 100.0Hz`), then a header.
//!
//! `SampleTimeFine` counts 0.1 ms in 32 bits; where it is empty the packet counter and the update rate make
//! the time. `Acc_*` m/s², `Gyr_*` rad/s; separators vary.

use super::Dialect;
use crate::names::Quantity;
use crate::units::{M_S2, RAD_S, Unit};

/// The dialect.
pub const DIALECT: Dialect = Dialect {
    id: "xsens-mt",
    name: "Xsens MT Manager",
    recognises: |s| {
        s.preamble.iter().any(|l| l.starts_with("//"))
            && (s.has_column("PacketCounter") || s.has_column("Acc_X"))
    },
    mend: |sheet, reading| {
        reading.acc_unit = Some(M_S2);
        reading.gyro_unit = Some(RAD_S);
        reading.time_cycle = Some(4_294_967_296.0);
        for (m, name) in reading.meanings.iter_mut().zip(&sheet.header) {
            if name.eq_ignore_ascii_case("SampleTimeFine") {
                m.unit = Some(Unit::Time(1e-4, "0.1 ms"));
            } else if name.to_uppercase().starts_with("UTC") {
                m.quantity = Quantity::Other;
            }
        }
    },
};
