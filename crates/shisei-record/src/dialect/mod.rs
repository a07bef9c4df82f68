//! The kinds of files that makers' tools write: one small file each.
//!
//! A dialect is recognised by what the sheet looks like and mends the generic reading of its names: units
//! that are not written, clocks that wrap, columns whose name misleads. To add one: write
//! `dialect/NAME.rs` with a `pub const DIALECT: Dialect`, list it in [`ALL`], and put a small sample into
//! `fixtures/dialects/`.

use crate::plan::Reading;
use crate::sheet::Sheet;

mod headerless;
mod mu01;

/// A kind of file.
#[derive(Clone, Copy)]
pub struct Dialect {
    /// Stable id, for `--dialect` and `info --json`.
    pub id: &'static str,
    /// Name for people.
    pub name: &'static str,
    /// True when the sheet is of this kind.
    pub recognises: fn(&Sheet<'_>) -> bool,
    /// Mends the reading.
    pub mend: fn(&Sheet<'_>, &mut Reading),
}

impl std::fmt::Debug for Dialect {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.id)
    }
}

/// A table whose header or units say what it is.
pub const GENERIC: Dialect = Dialect {
    id: "generic",
    name: "a table with a header",
    recognises: |s| !s.header.is_empty(),
    mend: |_, _| {},
};

/// Our own columns.
pub const CANONICAL: Dialect = Dialect {
    id: "shisei",
    name: "shisei's columns",
    recognises: |s| s.has_column("time_s") && s.has_column("acc_x") && s.has_column("gyr_z"),
    mend: |_, reading| {
        reading.acc_unit = Some(crate::units::M_S2);
        reading.gyro_unit = Some(crate::units::RAD_S);
    },
};

/// All dialects, the first that recognises a sheet wins.
pub const ALL: &[Dialect] = &[CANONICAL, mu01::DIALECT, headerless::DIALECT, GENERIC];

/// The dialect of a sheet.
pub(crate) fn of(sheet: &Sheet<'_>, asked: Option<&str>) -> Dialect {
    if let Some(dialect) = asked.and_then(|id| ALL.iter().find(|d| d.id == id)) {
        return *dialect;
    }
    ALL.iter().copied().find(|d| (d.recognises)(sheet)).unwrap_or(GENERIC)
}
