//! MU-01: `Time,Ax[m/s2],Ay[m/s2],Az[m/s2],Gx[rad/s],Gy[rad/s],Gz[rad/s],Temp`.
//!
//! Re-saved by a spreadsheet, the stamps are minutes and seconds to a tenth, equal for several rows: the
//! clock then uses the sensor's rate, 100 Hz, where the stamps agree with it.

use super::Dialect;
use crate::units::{M_S2, RAD_S};

/// The dialect.
pub const DIALECT: Dialect = Dialect {
    id: "mu-01",
    name: "MU-01",
    recognises: |sheet| {
        let starts = |name: &str| {
            sheet.header.iter().any(|h| {
                let h = h.trim().to_lowercase();
                h.strip_prefix(name).is_some_and(|rest| rest.trim_start().starts_with('['))
            })
        };
        sheet.has_column("time") && ["ax", "ay", "az", "gx", "gy", "gz"].iter().all(|n| starts(n))
    },
    mend: |_, reading| {
        // The superscript two does not survive every re-saving: the header is known.
        reading.acc_unit = Some(M_S2);
        reading.gyro_unit = Some(RAD_S);
        reading.rate_hz = reading.rate_hz.or(Some(100.0));
    },
};
