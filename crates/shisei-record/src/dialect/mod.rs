//! The kinds of files that makers' tools write: one small file each.
//!
//! A dialect is recognised by what the sheet looks like and mends the generic reading of its names: units
//! that are not written, clocks that wrap, columns whose name misleads. To add one: write
//! `dialect/NAME.rs` with a `pub const DIALECT: Dialect`, list it in [`ALL`], and put a small sample into
//! `fixtures/dialects/`. A file that is no table at all (hexadecimal words, binary) is a `WholeFile`.

use crate::Lang;
use crate::error::Result;
use crate::open::Part;
use crate::options::Options;
use crate::plan::Reading;
use crate::sheet::Sheet;

mod android_ms;
mod apdm;
mod canonical;
mod euroc;
mod gaitmap;
mod gyroflow;
mod headerless;
pub mod maker;
#[cfg(feature = "mcap")]
mod mcap;
mod metawear;
mod microstrain;
mod mu01;
mod noraxon;
mod phyphox;
mod ros;
mod sensor_logger;
mod sensorlog_apple;
mod shimmer;
mod spresense;
mod xio;
mod xsens_dot;
mod xsens_mt;

/// A kind of table.
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

/// A kind of file that is read whole.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WholeFile {
    /// Stable id.
    pub id: &'static str,
    /// Name for people.
    pub name: &'static str,
    /// How it is laid out, for people.
    pub layout: &'static str,
    /// The same in Japanese.
    pub layout_ja: &'static str,
    /// True when the bytes are of this kind.
    pub recognises: fn(&[u8]) -> bool,
    /// Reads it.
    pub read: fn(&str, &[u8], &Options) -> Result<Part>,
}

/// What a kind of file is called, by its id; the id where there is none such.
pub fn name(id: &'static str, lang: Lang) -> &'static str {
    let mut all = ALL.iter().map(|d| (d.id, d.name)).chain(WHOLE.iter().map(|d| (d.id, d.name)));
    let name = all.find(|(known, _)| *known == id).map_or(id, |(_, name)| name);
    if lang == Lang::En {
        return name;
    }
    // Makers' names stay.
    match id {
        "generic" => "見出しのある表",
        "headerless" => "見出しのない数値の表",
        "shisei" => "shisei の列",
        "android-ms" => "日付とミリ秒を記録する Android のロガー",
        "spresense" => "Spresense マルチ IMU ボード (16 進数のログ)",
        "gyroflow" => "Gyroflow のログ",
        "mcap" => "MCAP の記録",
        _ => name,
    }
}

/// A table whose header or units say what it is.
pub const GENERIC: Dialect =
    Dialect { id: "generic", name: "a table with a header", recognises: |_| true, mend: |_, _| {} };

/// All dialects of tables; the first that recognises a sheet wins.
pub const ALL: &[Dialect] = &[
    canonical::DIALECT,
    mu01::DIALECT,
    gyroflow::DIALECT,
    xsens_dot::DIALECT,
    xsens_mt::DIALECT,
    apdm::DIALECT,
    shimmer::DIALECT,
    sensor_logger::DIALECT,
    sensorlog_apple::DIALECT,
    metawear::DIALECT,
    noraxon::DIALECT,
    euroc::DIALECT,
    microstrain::DIALECT,
    ros::DIALECT,
    xio::DIALECT,
    phyphox::DIALECT,
    android_ms::DIALECT,
    gaitmap::DIALECT,
    headerless::DIALECT,
    GENERIC,
];

/// All dialects of whole files.
const WHOLE: &[WholeFile] = &[
    spresense::DIALECT,
    #[cfg(feature = "mcap")]
    mcap::DIALECT,
];

/// The dialect of a sheet.
pub(crate) fn of(sheet: &Sheet<'_>, asked: Option<&str>) -> Dialect {
    if let Some(dialect) = asked.and_then(|id| ALL.iter().find(|d| d.id == id)) {
        return *dialect;
    }
    ALL.iter().copied().find(|d| (d.recognises)(sheet)).unwrap_or(GENERIC)
}

/// The kind of a file that is no table.
pub(crate) fn whole_file(bytes: &[u8]) -> Option<&'static WholeFile> {
    WHOLE.iter().find(|d| (d.recognises)(bytes))
}

/// True when a column's name holds `part`, case aside.
fn names_with(sheet: &Sheet<'_>, part: &str) -> bool {
    let part = part.to_lowercase();
    sheet.header.iter().any(|h| h.to_lowercase().contains(&part))
}

/// True when a line before the header holds `part`, case aside.
fn preamble_with(sheet: &Sheet<'_>, part: &str) -> bool {
    let part = part.to_lowercase();
    sheet.preamble.iter().any(|l| l.to_lowercase().contains(&part))
}
