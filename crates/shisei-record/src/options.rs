//! What a user may say where the reader would guess.

use crate::error::{Error, Result};
use crate::sheet::Delimiter;
use crate::units::Unit;
use shisei_core::Vec3;

/// Overrides; the default guesses everything.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Which column is what.
    pub columns: Option<Columns>,
    /// Units.
    pub units: Units,
    /// Sampling rate in Hz: time is then made from it and the stamps are left aside.
    pub rate_hz: Option<f64>,
    /// Axes of the output in terms of the sensor's.
    pub axes: Option<AxisMap>,
    /// What a count is.
    pub scale: Option<Scale>,
    /// Which sensor, where there are several: part of its name.
    pub sensor: Option<String>,
    /// Separator.
    pub delimiter: Option<Delimiter>,
    /// Leave out rows with missing, non-finite or unreadable numbers and count them.
    pub skip_bad_rows: bool,
    /// Give raw counts as they are (for a calibration that takes counts).
    pub counts_ok: bool,
    /// Names of further columns to keep; `*` for all that nothing else is read from.
    pub keep: Vec<String>,
    /// Dialect to use by its id, instead of the one recognised.
    pub dialect: Option<String>,
}

impl Options {
    /// Takes what a user says in words, as the command line's option of that name: `columns`, `units`, `axes`, `scale`.
    pub fn set(&mut self, name: &str, text: &str) -> Result<()> {
        match name {
            "columns" => self.columns = Some(Columns::parse(text)?),
            "units" => self.units = Units::parse(text)?,
            "axes" => self.axes = Some(AxisMap::parse(text)?),
            "scale" => self.scale = Some(Scale::parse(text)?),
            other => return Err(Error::of_option("option", other, "columns, units, axes or scale")),
        }
        Ok(())
    }
}

/// What a door calls the options whose names have more than one word there, as its language spells them.
#[derive(Clone, Copy, Debug)]
pub struct Names {
    /// `--rate`.
    pub rate: &'static str,
    /// `--skip-bad-rows`.
    pub skip_bad_rows: &'static str,
    /// `--gravity`.
    pub gravity: &'static str,
}

/// A sentence that names the command line's options, with a door's names for them.
pub fn with_names(sentence: &str, names: Names) -> String {
    let mut parts = sentence.split("--");
    let mut out = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let end = part.find(|c: char| !(c.is_ascii_lowercase() || c == '-')).unwrap_or(part.len());
        let (option, rest) = part.split_at(end);
        match option {
            "columns" | "units" | "axes" | "scale" | "sensor" | "forward" => out.push_str(option),
            "rate" => out.push_str(names.rate),
            "skip-bad-rows" => out.push_str(names.skip_bad_rows),
            "gravity" => out.push_str(names.gravity),
            _ => {
                out.push_str("--");
                out.push_str(option);
            }
        }
        out.push_str(rest);
    }
    out
}

/// A column by name or by number.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ColumnRef {
    /// From 1.
    Number(usize),
    /// The header text, case and blanks at the ends aside.
    Name(String),
}

/// Roles a column can have, in the order of `time, acc x y z, gyr x y z, temp`.
pub const ROLES: [&str; 8] = ["time", "acc_x", "acc_y", "acc_z", "gyr_x", "gyr_y", "gyr_z", "temp"];

/// `--columns`: `acc_x=Ax,acc_y=Ay,…` (the rest is guessed) or a list of roles, one a column
/// (`time,gyr_x,gyr_y,gyr_z,acc_x,acc_y,acc_z,-`).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Columns {
    /// The column of each role of [`ROLES`].
    pub roles: [Option<ColumnRef>; 8],
}

/// `--units`: each empty where the file or the values say it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Units {
    /// Of the acceleration.
    pub acc: Option<Unit>,
    /// Of the angular rate.
    pub gyro: Option<Unit>,
    /// Of the time column.
    pub time: Option<Unit>,
}

/// A signed permutation of axes: output axis `i` is `sign[i]` × input axis `from[i]`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Permutation {
    /// Input axis, 0 to 2.
    pub from: [usize; 3],
    /// True where the sign is turned.
    pub negative: [bool; 3],
}

/// `--axes`: `x,-y,-z` for both sensors, or `acc=-x,-y,-z;gyr=x,y,z`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AxisMap {
    /// Of the acceleration.
    pub acc: Permutation,
    /// Of the angular rate.
    pub gyro: Permutation,
}

/// `--scale acc=16384,gyr=131`: counts per g and counts per deg/s, as data sheets print them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// Counts per g (9.80665 m/s²).
    pub acc_counts_per_g: Option<f64>,
    /// Counts per degree per second.
    pub gyro_counts_per_deg_s: Option<f64>,
}

impl Permutation {
    /// x, y, z as they are.
    pub const IDENTITY: Permutation = Permutation { from: [0, 1, 2], negative: [false; 3] };

    /// The vector in the output's axes.
    #[inline]
    pub fn apply(&self, v: Vec3) -> Vec3 {
        let mut out = [0.0; 3];
        for i in 0..3 {
            let value = v[self.from[i]];
            out[i] = if self.negative[i] { -value } else { value };
        }
        out
    }

    /// `x,-y,-z`.
    pub fn text(&self) -> String {
        let mut out = String::new();
        for i in 0..3 {
            if i > 0 {
                out.push(',');
            }
            if self.negative[i] {
                out.push('-');
            }
            out.push(['x', 'y', 'z'][self.from[i].min(2)]);
        }
        out
    }

    fn parse(text: &str) -> Option<Self> {
        let mut from = Vec::new();
        let mut negative = Vec::new();
        let mut minus = false;
        for c in text.chars() {
            match c {
                '-' => minus = true,
                '+' | ',' | ' ' => {}
                'x' | 'X' | 'y' | 'Y' | 'z' | 'Z' => {
                    from.push(match c.to_ascii_lowercase() {
                        'x' => 0,
                        'y' => 1,
                        _ => 2,
                    });
                    negative.push(std::mem::take(&mut minus));
                }
                _ => return None,
            }
        }
        let from: [usize; 3] = from.try_into().ok()?;
        let negative: [bool; 3] = negative.try_into().ok()?;
        let all = (0..3).all(|axis| from.contains(&axis));
        all.then_some(Permutation { from, negative })
    }
}

impl AxisMap {
    /// Reads `--axes`.
    pub fn parse(text: &str) -> Result<Self> {
        let fail = || Error::of_option("--axes", text, "x,-y,-z | acc=-x,-y,-z;gyr=x,y,z");
        if !text.contains('=') {
            let both = Permutation::parse(text).ok_or_else(fail)?;
            return Ok(AxisMap { acc: both, gyro: both });
        }
        let mut out = AxisMap { acc: Permutation::IDENTITY, gyro: Permutation::IDENTITY };
        for part in text.split(';') {
            let (key, value) = part.split_once('=').ok_or_else(fail)?;
            let value = Permutation::parse(value).ok_or_else(fail)?;
            match key.trim().to_lowercase().as_str() {
                "acc" => out.acc = value,
                "gyr" | "gyro" => out.gyro = value,
                _ => return Err(fail()),
            }
        }
        Ok(out)
    }
}

impl Units {
    /// Reads `--units`: `acc=g,gyr=deg/s,time=ms`, or units alone, which say themselves what they are for.
    pub fn parse(text: &str) -> Result<Self> {
        let fail = || Error::of_option("--units", text, "acc=g,gyr=deg/s,time=ms");
        let mut out = Units::default();
        for part in text.split([',', ';']).filter(|p| !p.trim().is_empty()) {
            let (key, value) = part.split_once('=').unwrap_or(("", part));
            let unit = Unit::parse(value).ok_or_else(fail)?;
            match (key.trim().to_lowercase().as_str(), unit) {
                ("acc" | "", Unit::Acceleration(..)) | ("acc", Unit::Counts) => out.acc = Some(unit),
                ("gyr" | "gyro" | "", Unit::AngularRate(..)) | ("gyr" | "gyro", Unit::Counts) => {
                    out.gyro = Some(unit);
                }
                ("time" | "", Unit::Time(..)) => out.time = Some(unit),
                _ => return Err(fail()),
            }
        }
        Ok(out)
    }
}

impl Columns {
    /// Reads `--columns`.
    pub fn parse(text: &str) -> Result<Self> {
        let fail = || {
            Error::of_option(
                "--columns",
                text,
                "acc_x=Ax,acc_y=Ay,acc_z=Az,gyr_x=4,gyr_y=5,gyr_z=6 or time,acc_x,acc_y,acc_z,gyr_x,gyr_y,gyr_z,-",
            )
        };
        let role = |name: &str| {
            let name = name.trim().to_lowercase();
            let name = match name.as_str() {
                "time_s" | "t" => "time",
                "temp_c" | "temperature" => "temp",
                other => other,
            };
            ROLES.iter().position(|r| *r == name || r.replace('_', "") == name)
        };
        let mut roles: [Option<ColumnRef>; 8] = Default::default();
        for (i, part) in text.split([',', ';']).enumerate() {
            let (slot, column) = match part.split_once('=') {
                Some((key, value)) => {
                    let value = value.trim();
                    let column = match value.parse::<usize>() {
                        Ok(number) if number > 0 => ColumnRef::Number(number),
                        _ if !value.is_empty() => ColumnRef::Name(value.to_owned()),
                        _ => return Err(fail()),
                    };
                    (role(key).ok_or_else(fail)?, column)
                }
                None if part.trim() == "-" || part.trim().is_empty() => continue,
                None => (role(part).ok_or_else(fail)?, ColumnRef::Number(i + 1)),
            };
            if let Some(place) = roles.get_mut(slot) {
                *place = Some(column);
            }
        }
        if roles.iter().all(Option::is_none) {
            return Err(fail());
        }
        Ok(Columns { roles })
    }
}

impl Scale {
    /// Reads `--scale`: `acc=16384,gyr=131` or `16384,131`.
    pub fn parse(text: &str) -> Result<Self> {
        let fail = || Error::of_option("--scale", text, "acc=16384,gyr=131 (counts/g, counts/(deg/s))");
        let mut out = Scale { acc_counts_per_g: None, gyro_counts_per_deg_s: None };
        for (i, part) in text.split([',', ';']).enumerate() {
            let (key, value) = part.split_once('=').unwrap_or((if i == 0 { "acc" } else { "gyr" }, part));
            let value: f64 = value.trim().parse().map_err(|_| fail())?;
            if !(value.is_finite() && value > 0.0) {
                return Err(fail());
            }
            match key.trim().to_lowercase().as_str() {
                "acc" => out.acc_counts_per_g = Some(value),
                "gyr" | "gyro" => out.gyro_counts_per_deg_s = Some(value),
                _ => return Err(fail()),
            }
        }
        Ok(out)
    }
}

impl Delimiter {
    /// Reads `--delimiter`: a sign or a name.
    pub fn parse(text: &str) -> Result<Self> {
        Ok(match text {
            "," | "comma" => Delimiter::Byte(b','),
            ";" | "semicolon" => Delimiter::Byte(b';'),
            "\t" | "\\t" | "tab" => Delimiter::Byte(b'\t'),
            "|" | "bar" => Delimiter::Byte(b'|'),
            " " | "space" => Delimiter::Blanks,
            _ => return Err(Error::of_option("--delimiter", text, "comma, semicolon, tab, bar or space")),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sentences_with_the_names_of_another_door() {
        let names = Names { rate: "rateHz", skip_bad_rows: "skipBadRows", gravity: "gravityMS2" };
        let named = |sentence: &str| with_names(sentence, names);
        assert_eq!(named("row 3; --skip-bad-rows leaves it out"), "row 3; skipBadRows leaves it out");
        assert_eq!(named("--skip-bad-rows を付ける"), "skipBadRows を付ける");
        assert_eq!(named("--units time=ms, or --rate 100"), "units time=ms, or rateHz 100");
        assert_eq!(named("--forward -z のように"), "forward -z のように");
        assert_eq!(named("--gravity 98 is odd"), "gravityMS2 98 is odd");
        assert_eq!(named("a -- b, --dialect x, --"), "a -- b, --dialect x, --");
        assert_eq!(named(""), "");
    }
    use crate::units;

    #[test]
    fn axes() {
        let map = AxisMap::parse("x,-y,-z").unwrap();
        assert_eq!(map.acc.apply([1.0, 2.0, 3.0]), [1.0, -2.0, -3.0]);
        let map = AxisMap::parse("acc=-x,-y,-z;gyr=z,x,y").unwrap();
        assert_eq!(map.acc.apply([1.0, 2.0, 3.0]), [-1.0, -2.0, -3.0]);
        assert_eq!(map.gyro.apply([1.0, 2.0, 3.0]), [3.0, 1.0, 2.0]);
        for bad in ["", "x,y", "x,x,z", "x,y,w", "acc=x,y", "mag=x,y,z"] {
            assert!(AxisMap::parse(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn units_and_scale() {
        let units = Units::parse("acc=g,gyr=deg/s,time=ms").unwrap();
        assert_eq!((units.acc, units.gyro), (Some(units::STANDARD_G), Some(units::DEG_S)));
        assert_eq!(Units::parse("g,rad/s").unwrap().gyro, Some(units::RAD_S));
        assert!(Units::parse("acc=deg/s").is_err());
        assert_eq!(Scale::parse("16384,131").unwrap().gyro_counts_per_deg_s, Some(131.0));
        assert!(Scale::parse("acc=0").is_err());
    }

    #[test]
    fn columns() {
        let columns = Columns::parse("time,acc_x,acc_y,acc_z,-,gyr_x,gyr_y,gyr_z").unwrap();
        assert_eq!(columns.roles[4], Some(ColumnRef::Number(6)));
        let columns = Columns::parse("acc_x=Ax,accy=3").unwrap();
        assert_eq!(columns.roles[1], Some(ColumnRef::Name("Ax".into())));
        assert_eq!(columns.roles[2], Some(ColumnRef::Number(3)));
        assert!(Columns::parse("foo=1").is_err());
    }
}
