//! Shimmer (Consensys): `sep=` line, `Shimmer_XXXX_Accel_LN_X_CAL`, a units row; semicolon or tab.
//!
//! Two accelerometers (low noise LN, wide range WR): `--sensor ln` or `wr`. Angular rate in deg/s.

use super::{Dialect, names_with};
use crate::names;
use crate::plan::Reading;
use crate::sheet::Sheet;

/// The dialect.
pub const DIALECT: Dialect = Dialect {
    id: "shimmer",
    name: "Shimmer Consensys",
    recognises: |s| {
        names_with(s, "shimmer_") || s.groups.iter().any(|g| g.to_lowercase().contains("shimmer"))
    },
    mend,
};

/// Reads the names without the device's id, whose letters could be taken for an axis.
fn mend(sheet: &Sheet<'_>, reading: &mut Reading) {
    let mut devices: Vec<String> = Vec::new();
    let mut ids = Vec::new();
    for (i, name) in sheet.header.iter().enumerate() {
        let mut parts = name.splitn(3, '_');
        let (Some(maker), Some(device), Some(rest)) = (parts.next(), parts.next(), parts.next()) else {
            ids.push(String::new());
            continue;
        };
        if !maker.eq_ignore_ascii_case("shimmer") {
            ids.push(String::new());
            continue;
        }
        if let Some(m) = reading.meanings.get_mut(i) {
            *m = names::meaning(rest, sheet.units.get(i).map_or("", String::as_str));
        }
        if !devices.iter().any(|d| d == device) {
            devices.push(device.to_owned());
        }
        ids.push(device.to_lowercase());
    }
    // Several devices in one file stay apart by their id.
    if devices.len() > 1 {
        for (m, id) in reading.meanings.iter_mut().zip(&ids) {
            m.label = if m.label.is_empty() { id.clone() } else { format!("{id} {}", m.label) };
        }
    }
}
