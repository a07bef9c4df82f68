//! The sampling rate that the lines above a table state: `Fs,100`, `OutputRate:,60Hz`, `// Update Rate: 100.0Hz`,
//! `Sample Rate:,128,Hz`, `sampling frequency [kHz] = 1.6`.

/// Lines looked at.
const LINES: usize = 200;

/// What names a rate at a word's end; in front of it may stand what is sampled.
const NAMES: [&str; 4] = ["rate", "frequency", "freq", "サンプリング周波数"];
const SAMPLED: [&str; 13] = [
    "sample",
    "samples",
    "sampling",
    "output",
    "update",
    "data",
    "frame",
    "capture",
    "acquisition",
    "polling",
    "logging",
    "recording",
    "odr",
];

/// Names that stand at the line's beginning only.
const SHORT: [&str; 4] = ["fs", "odr", "hz", "sps"];

/// Rates of something else.
const OTHERS: [&str; 6] = ["cutoff", "cut-off", "filter", "baud", "mag ", "heart"];

/// The rate, Hz: the first with its unit, else the first.
pub(crate) fn find(lines: &[String]) -> Option<f64> {
    let rates = || lines.iter().take(LINES).filter_map(|line| of_line(line));
    let with_unit = rates().find_map(|(hz, has_unit)| has_unit.then_some(hz));
    with_unit.or_else(|| rates().next().map(|(hz, _)| hz))
}

/// The rate in a line, Hz, and whether its unit is there.
fn of_line(line: &str) -> Option<(f64, bool)> {
    let lower = line.to_lowercase().replace(['"', '\''], "");
    let line = lower.trim_start_matches(['#', '%', '/', ' ', '\t', ';', '*']);
    if OTHERS.iter().any(|other| line.contains(other)) {
        return None;
    }
    let short = SHORT.iter().filter_map(|name| line.strip_prefix(name));
    let long = NAMES.iter().flat_map(|name| line.match_indices(name).map(|(at, name)| (at, at + name.len())));
    let long = long.filter(|(start, _)| is_rate(line.get(..*start).unwrap_or_default()));
    let after = short.chain(long.filter_map(|(_, end)| line.get(end..)));
    after.filter_map(value).find(|(hz, _)| (0.1..=100_000.0).contains(hz))
}

/// Whether the word that ends with a rate's name is one: `generated` and `separate` hold such letters, too.
fn is_rate(before: &str) -> bool {
    let letters = before.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    let word = before.get(letters.len()..).unwrap_or_default();
    word.is_empty() || SAMPLED.contains(&word)
}

/// The number behind a name, Hz, and whether its unit is there: `: 100 Hz`, ` (Hz),100`, ` = 1.6 kHz`.
fn value(after: &str) -> Option<(f64, bool)> {
    let between = [' ', '\t', ':', '=', ',', ';', '(', ')', '[', ']', '_'];
    let mut rest = after.strip_prefix(between)?.trim_start_matches(between);
    let mut factor = None;
    if let Some((given, behind)) = unit(rest) {
        factor = Some(given);
        rest = behind.trim_start_matches(between);
    }
    let digits = rest.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(rest.len());
    let (number, behind) = rest.split_at_checked(digits)?;
    let behind = behind.trim_start_matches(between);
    let number: f64 = number.trim_end_matches('.').parse().ok()?;
    if let Some((given, _)) = unit(behind) {
        factor = factor.or(Some(given));
    } else if behind.starts_with(|c: char| c.is_alphanumeric() || matches!(c, '-' | '/')) {
        return None; // a date, or something else a second
    }
    Some((number * factor.unwrap_or(1.0), factor.is_some()))
}

/// A unit of rates at the start, in Hz, and what follows it.
fn unit(text: &str) -> Option<(f64, &str)> {
    let units = [("khz", 1000.0), ("hz", 1.0), ("sps", 1.0), ("samples", 1.0), ("fps", 1.0)];
    let (behind, factor) = units.iter().find_map(|(name, hz)| Some((text.strip_prefix(name)?, *hz)))?;
    (!behind.starts_with(|c: char| c.is_alphanumeric())).then_some((factor, behind))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rate(lines: &[&str]) -> Option<f64> {
        find(&lines.iter().map(|line| (*line).to_owned()).collect::<Vec<_>>())
    }

    #[test]
    fn rates() {
        for (line, hz) in [
            ("Fs,100", 100.0),
            ("OutputRate:,60Hz", 60.0),
            ("// Update Rate: 100.0Hz", 100.0),
            ("Sample Rate:,128,Hz", 128.0),
            ("# Sample rate: 1 kHz", 1000.0),
            ("sampling frequency [kHz] = 1.6", 1600.0),
            ("sample_rate_hz: 52", 52.0),
            ("\"SamplingRate\";\"200\"", 200.0),
            ("サンプリング周波数: 100 Hz", 100.0),
            ("サンプリング周波数[Hz],100", 100.0),
            ("hz=50", 50.0),
            ("Frame rate 120 fps", 120.0),
        ] {
            assert_eq!(rate(&[line]), Some(hz), "{line}");
        }
    }

    #[test]
    fn what_is_no_rate() {
        for line in [
            "# Generated 2024-05-01 by logger",
            "# Calibrated: 2023-11-02",
            "separate 5",
            "rate of turn",
            "Filter cutoff frequency: 10 Hz",
            "rate: 8 g/s",
            "fs2 7",
        ] {
            assert_eq!(rate(&[line]), None, "{line}");
        }
        assert_eq!(rate(&["rate: 3", "# Calibrated: 2023", "# Sample rate: 100 Hz"]), Some(100.0));
    }
}
