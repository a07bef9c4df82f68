//! Units as makers write them.

/// What a unit measures, and its factor to SI (m/s², rad/s, s, °C).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Unit {
    /// Acceleration: factor to m/s².
    Acceleration(f64, &'static str),
    /// Angular rate: factor to rad/s.
    AngularRate(f64, &'static str),
    /// Time: factor to s.
    Time(f64, &'static str),
    /// Temperature, °C.
    Celsius,
    /// Counts of a converter.
    Counts,
    /// A unit of something that is not used here (magnetic field, angle, pressure …).
    Other,
}

use shisei_core::STANDARD_GRAVITY_M_S2 as G;

/// Radians in a degree.
pub(crate) const RAD_PER_DEG: f64 = core::f64::consts::PI / 180.0;

pub(crate) const M_S2: Unit = Unit::Acceleration(1.0, "m/s²");
pub(crate) const STANDARD_G: Unit = Unit::Acceleration(G, "g");
pub(crate) const MILLI_G: Unit = Unit::Acceleration(G / 1000.0, "mg");
pub(crate) const RAD_S: Unit = Unit::AngularRate(1.0, "rad/s");
pub(crate) const DEG_S: Unit = Unit::AngularRate(RAD_PER_DEG, "deg/s");
pub(crate) const SECOND: Unit = Unit::Time(1.0, "s");
/// A spreadsheet's dates are days.
pub(crate) const DAY: Unit = Unit::Time(86_400.0, "days");
pub(crate) const MILLISECOND: Unit = Unit::Time(1e-3, "ms");
pub(crate) const MICROSECOND: Unit = Unit::Time(1e-6, "µs");
pub(crate) const NANOSECOND: Unit = Unit::Time(1e-9, "ns");

impl Unit {
    /// The unit's name as shown to people.
    pub fn name(self) -> &'static str {
        match self {
            Unit::Acceleration(_, name) | Unit::AngularRate(_, name) | Unit::Time(_, name) => name,
            Unit::Celsius => "°C",
            Unit::Counts => "counts",
            Unit::Other => "other",
        }
    }

    /// Reads a unit; brackets, blanks, case (save of a lone G) and typographic signs do not matter.
    pub fn parse(text: &str) -> Option<Unit> {
        let text = text.trim().trim_end_matches('*');
        // A lone capital M is not milli, a lone capital S is siemens; neither occurs in recordings.
        let mut plain = String::with_capacity(text.len());
        for c in text.chars() {
            match c {
                ' ' | '\t' | '^' | '·' | '*' | '.' | '(' | ')' | '[' | ']' | '{' | '}' | '"' | '_'
                | '\u{a0}' | 'Â' | '⋅' | '∙' => {}
                '²' | '２' | 'ｲ' => plain.push('2'),
                '°' | 'º' | '˚' | '度' | 'ｰ' => plain.push_str("deg"),
                'µ' | 'μ' => plain.push('u'),
                '−' | '–' | '⁻' => plain.push('-'),
                '¹' => plain.push('1'),
                '／' => plain.push('/'),
                '秒' => plain.push('s'),
                '℃' => plain.push_str("degc"),
                '㎨' => plain.push_str("m/s2"),
                c => plain.extend(c.to_lowercase()),
            }
        }
        let plain = plain.replace("毎deg", "deg").replace("ミリs", "ms");
        Some(match plain.as_str() {
            "m/s2"
            | "m/s/s"
            | "ms-2"
            | "ms2"
            | "m/sec2"
            | "m/sec/sec"
            | "mps2"
            | "mpss"
            | "m/ss"
            | "meters/second2"
            | "meterspersecondsquared"
            | "meters/sec2"
            | "metre/s2"
            | "m/s-2"
            | "ms**-2"
            | "m/s**2"
            | "m/s?"
            | "m/s\u{fffd}" => M_S2,
            "mm/s2" | "mms-2" => Unit::Acceleration(1e-3, "mm/s²"),
            "cm/s2" | "gal" | "cms-2" => Unit::Acceleration(1e-2, "cm/s²"),
            "ft/s2" => Unit::Acceleration(0.3048, "ft/s²"),
            "g" | "gs" | "gn" | "g0" | "gee" | "g's" | "gforce" | "g-force" | "standardgravity" => STANDARD_G,
            "mg" | "millig" | "milli-g" | "mgn" | "mgs" => MILLI_G,
            "ug" | "microg" => Unit::Acceleration(G / 1e6, "µg"),
            "rad/s" | "rads-1" | "rad/sec" | "rad/second" | "radps" | "rps" | "r/s" | "rads/s"
            | "radians/s" | "radians/sec" | "radians/second" | "radianspersecond" | "radian/s" | "rads"
            | "rad/s-1" => RAD_S,
            "mrad/s" | "mrads-1" => Unit::AngularRate(1e-3, "mrad/s"),
            "deg/s" | "degs-1" | "deg/sec" | "dps" | "degps" | "degrees/s" | "degrees/sec" | "degree/s"
            | "degree/sec" | "degrees/second" | "degree/second" | "deg/second" | "degreespersecond"
            | "d/s" | "degs" | "deg/s-1" | "?/s" | "\u{fffd}/s" => DEG_S,
            "mdps" | "mdeg/s" | "millidps" | "mdegs-1" => Unit::AngularRate(RAD_PER_DEG / 1000.0, "mdeg/s"),
            "deg/h" | "deg/hr" | "deg/hour" | "dph" => Unit::AngularRate(RAD_PER_DEG / 3600.0, "deg/h"),
            "cdps" => Unit::AngularRate(RAD_PER_DEG / 100.0, "cdeg/s"),
            "deg/min" | "dpm" => Unit::AngularRate(RAD_PER_DEG / 60.0, "deg/min"),
            "rpm" | "rev/min" | "r/min" => Unit::AngularRate(6.0 * RAD_PER_DEG, "rpm"),
            "rev/s" => Unit::AngularRate(360.0 * RAD_PER_DEG, "rev/s"),
            "s" | "sec" | "secs" | "second" | "seconds" => SECOND,
            "ms" | "msec" | "msecs" | "millis" | "millisecond" | "milliseconds" | "ミリ秒" => MILLISECOND,
            "us" | "usec" | "usecs" | "micros" | "microsecond" | "microseconds" => MICROSECOND,
            "ns" | "nsec" | "nsecs" | "nanos" | "nanosecond" | "nanoseconds" => NANOSECOND,
            "day" | "days" | "日" => DAY,
            "min" | "minutes" => Unit::Time(60.0, "min"),
            "c" | "degc" | "celsius" | "degcelsius" | "degreec" | "degreescelsius" => Unit::Celsius,
            "count" | "counts" | "lsb" | "lsbs" | "raw" | "adc" | "adu" | "digit" | "digits" | "au"
            | "nounits" => Unit::Counts,
            "ut" | "t" | "mt" | "nt" | "gauss" | "mgauss" | "gs/lsb" | "deg" | "rad" | "degrees"
            | "degree" | "radians" | "m" | "mm" | "cm" | "km" | "m/s" | "km/h" | "v" | "mv" | "pa"
            | "hpa" | "kpa" | "bar" | "mbar" | "%" | "hz" | "lux" | "lx" | "db" | "k" | "degf" | "f"
            | "kohms" | "ohm" | "n" | "nm" | "w" | "n/a" | "none" | "local" | "1" => Unit::Other,
            _ => return None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(texts: &[&str], unit: Unit) {
        for text in texts {
            assert_eq!(Unit::parse(text), Some(unit), "{text}");
        }
    }

    #[test]
    fn spellings() {
        check(
            &[
                "m/s^2",
                "m/s²",
                "m/s2",
                "m s^-2",
                "(m/s^2)",
                "m/(s^2)",
                "m/(s^2)*",
                "m·s⁻²",
                "m/sÂ²",
                "m s-2",
                "M/S2",
            ],
            M_S2,
        );
        check(&["g", "G", "[g]", "g's"], STANDARD_G);
        check(&["mg", "mG", "milli-g"], MILLI_G);
        check(&["rad/s", "rad s^-1", "rad/sec", "[rad/s]"], RAD_S);
        check(&["deg/s", "°/s", "dps", "deg/sec", "º/s", "degrees/s", "Â°/s"], DEG_S);
        check(&["us", "µs", "μs", "usec"], MICROSECOND);
        check(&["°C", "C", "℃"], Unit::Celsius);
        assert_eq!(Unit::parse("frobs"), None);
        assert_eq!(Unit::parse(""), None);
    }
}
