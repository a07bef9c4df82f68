//! MetaWear (MbientLab): `epoch (ms),time (-13:00),elapsed (s),x-axis (g),y-axis (g),z-axis (g)`, one file
//! a sensor; `elapsed` starts at 0 in each file, so the epoch is the common clock.

use super::{Dialect, names_with};
use crate::names::Quantity;

/// The dialect.
pub const DIALECT: Dialect = Dialect {
    id: "metawear",
    name: "MetaWear (MbientLab)",
    recognises: |s| names_with(s, "elapsed (s)") && names_with(s, "x-axis"),
    mend: |sheet, reading| {
        let epoch = sheet.header.iter().any(|h| h.to_lowercase().starts_with("epoch"));
        for (m, name) in reading.meanings.iter_mut().zip(&sheet.header) {
            if epoch && m.quantity == Quantity::Time && !name.to_lowercase().starts_with("epoch") {
                m.quantity = Quantity::Other;
            }
        }
    },
};
