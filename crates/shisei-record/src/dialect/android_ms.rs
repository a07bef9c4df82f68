//! Android loggers with a date to the second and a column of milliseconds: `Timestamp,Milliseconds,X,Y,Z`.
//!
//! With dates the two roll over apart (28:54,201 → 28:55,250), and the milliseconds either count on or start again
//! every second: they are the clock, and the date settles whole seconds that passed in a pause. Whole seconds since 1970
//! and their milliseconds are one number; any other number is the clock itself.

use super::{Dialect, names_with};
use crate::body::TimeForm;
use crate::names::Quantity;
use crate::plan::CoarseTime;
use crate::rows::time_form;
use crate::units::MILLISECOND;

/// The dialect.
pub const DIALECT: Dialect = Dialect {
    id: "android-ms",
    name: "Android logger with date and milliseconds",
    recognises: |s| {
        s.has_column("Milliseconds")
            && (names_with(s, "timestamp") || s.has_column("date") || s.has_column("time"))
    },
    mend: |sheet, reading| {
        let of = |name: &str| sheet.header.iter().position(|h| h.trim().eq_ignore_ascii_case(name));
        let coarse = of("Timestamp").or_else(|| of("Time")).or_else(|| of("Date"));
        let exact = match coarse.and_then(|column| time_form(sheet, column)) {
            Some(TimeForm::Number) => return,
            Some(TimeForm::Large(first)) if !(900_000_000..4_000_000_000).contains(&first) => return,
            form => matches!(form, Some(TimeForm::Large(_))),
        };
        let Some(ms) = of("Milliseconds") else { return };
        if let Some(m) = reading.meanings.get_mut(ms) {
            m.quantity = Quantity::Time;
            m.unit = Some(MILLISECOND);
        }
        if let Some(m) = coarse.and_then(|column| reading.meanings.get_mut(column)).filter(|_| exact) {
            m.quantity = Quantity::Other;
        }
        reading.time_cycle = Some(1000.0);
        reading.coarse_time = coarse.map(|column| CoarseTime { column, exact });
    },
};
