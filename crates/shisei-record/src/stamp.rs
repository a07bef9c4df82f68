//! Time stamps written as text: dates, times of day, minutes and seconds.

/// What a stamp counts from, so that a wrap (hour, midnight) can be undone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cycle {
    /// A date is there: never wraps.
    None,
    /// Time of day: wraps every 24 h.
    Day,
    /// Minutes and seconds: wraps every hour.
    Hour,
}

impl Cycle {
    /// Seconds of a cycle, 0 where there is none.
    pub fn seconds(self) -> f64 {
        match self {
            Cycle::None => 0.0,
            Cycle::Day => 86_400.0,
            Cycle::Hour => 3_600.0,
        }
    }
}

/// A stamp: nanoseconds since 1970 (no time zone applied), since midnight or since the hour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stamp {
    /// Nanoseconds.
    pub ns: i64,
    /// What they count from.
    pub cycle: Cycle,
}

/// True for text that has the shape of a stamp.
pub(crate) fn looks_like(text: &[u8]) -> bool {
    text.len() >= 4
        && text.len() <= 48
        && text.first().is_some_and(u8::is_ascii_digit)
        && (text.contains(&b':') || !text.is_ascii())
        && parse(text).is_some()
        || text.len() >= 15 && text.first().is_some_and(u8::is_ascii_digit) && parse(text).is_some()
}

/// Days from 1970-01-01 of a date of the Gregorian calendar (Hinnant's algorithm).
fn days(year: i64, month: i64, day: i64) -> i64 {
    let y = if month <= 2 { year - 1 } else { year };
    let era = y.div_euclid(400);
    let of_era = y - era * 400;
    let shifted = (month + 9) % 12;
    let of_year = (153 * shifted + 2) / 5 + day - 1;
    era * 146_097 + of_era * 365 + of_era / 4 - of_era / 100 + of_year - 719_468
}

/// Digits of a fraction to nanoseconds.
fn fraction_ns(text: &[u8]) -> Option<i64> {
    let mut ns = 0i64;
    let mut scale = 100_000_000i64;
    for byte in text {
        let digit = byte.checked_sub(b'0').filter(|d| *d < 10)?;
        ns += i64::from(digit) * scale;
        scale /= 10;
    }
    Some(ns)
}

fn whole(text: &[u8]) -> Option<i64> {
    if text.is_empty() || text.len() > 9 {
        return None;
    }
    text.iter().try_fold(0i64, |n, b| Some(n * 10 + i64::from(b.checked_sub(b'0').filter(|d| *d < 10)?)))
}

/// Signs of a Japanese date, in UTF-8 and in Shift_JIS, and what stands for them elsewhere.
const JAPANESE: [(&[u8], &[u8], &[u8]); 6] = [
    ("年".as_bytes(), b"\x94\x4E", b"-"),
    ("月".as_bytes(), b"\x8C\x8E", b"-"),
    ("日".as_bytes(), b"\x93\xFA", b" "),
    ("時".as_bytes(), b"\x8E\x9E", b":"),
    ("分".as_bytes(), b"\x95\xAA", b":"),
    ("秒".as_bytes(), b"\x95\x62", b""),
];

/// A stamp with Japanese signs as one without.
fn without_japanese(text: &[u8]) -> Vec<u8> {
    let (mut plain, mut rest) = (Vec::with_capacity(text.len()), text);
    'signs: while let Some((first, after)) = rest.split_first() {
        for (utf8, shift_jis, instead) in JAPANESE {
            if let Some(after) = rest.strip_prefix(utf8).or_else(|| rest.strip_prefix(shift_jis)) {
                plain.extend_from_slice(instead);
                rest = after;
                continue 'signs;
            }
        }
        plain.push(*first);
        rest = after;
    }
    plain
}

/// Reads a stamp: `2024-05-01 10:31:27.812`, `2024/05/01T10:31:27,812+09:00`, `05/01/2024 10:31:27 PM`,
/// `20240501_103127_812`, `20240501103127812`, `2021-08-20_20:21:13_804`, `10:31:27.812`, `10:31:27:812`, `31:27.8`,
/// `2024年5月1日 10時31分27.812秒` (also in Shift_JIS).
pub fn parse(text: &[u8]) -> Option<Stamp> {
    if text.len() > 48 || !text.first().is_some_and(u8::is_ascii_digit) {
        return None;
    }
    if text.is_ascii() { parse_ascii(text) } else { parse_ascii(&without_japanese(text)) }
}

fn parse_ascii(text: &[u8]) -> Option<Stamp> {
    if !text.is_ascii() {
        return None;
    }
    let mut date = 0i64;
    let mut has_date = false;
    let mut rest = text;
    if let Some((day, after)) = leading_date(text) {
        date = day;
        has_date = true;
        rest = after;
    }
    while let [b' ' | b'T' | b't' | b'_' | b'-' | b',', after @ ..] = rest {
        rest = after;
    }
    // Zone and half of the day at the end.
    let mut offset_ns = 0i64;
    let mut of_day = has_date;
    if let Some(head) = rest.strip_suffix(b"Z").or_else(|| rest.strip_suffix(b"z")) {
        rest = head;
    }
    for (suffix, pm) in [(b"PM", true), (b"AM", false), (b"pm", true), (b"am", false)] {
        if let Some(head) = rest.strip_suffix(suffix) {
            rest = head.trim_ascii_end();
            of_day = true;
            let hour = whole(rest.split(|b| *b == b':').next()?)?;
            if pm && hour < 12 {
                offset_ns = 12 * 3_600_000_000_000;
            } else if !pm && hour == 12 {
                offset_ns = -12 * 3_600_000_000_000;
            }
        }
    }
    if let Some(zone) = rest.iter().rposition(|b| matches!(b, b'+' | b'-' | b' '))
        && rest.get(..zone).is_some_and(|h| h.contains(&b':'))
    {
        rest = rest.get(..zone)?.trim_ascii_end();
    }
    if rest.is_empty() && !has_date {
        return None;
    }
    let (ns, parts) = clock(rest, of_day)?;
    let ns = ns + offset_ns;
    if has_date {
        return Some(Stamp {
            ns: date.checked_mul(86_400_000_000_000)?.checked_add(ns)?,
            cycle: Cycle::None,
        });
    }
    Some(Stamp { ns, cycle: if parts == 2 && !of_day { Cycle::Hour } else { Cycle::Day } })
}

/// A date at the start: days since 1970 and what follows.
fn leading_date(text: &[u8]) -> Option<(i64, &[u8])> {
    let run = |t: &[u8]| t.iter().take_while(|b| b.is_ascii_digit()).count();
    let first = run(text);
    if first == 8 && matches!(text.get(8), Some(b'T' | b' ' | b'_' | b'-')) || matches!(first, 14 | 17) {
        let day = date(whole(text.get(..4)?)?, whole(text.get(4..6)?)?, whole(text.get(6..8)?)?)?;
        return Some((day, text.get(8..)?));
    }
    let separator = *text.get(first)?;
    if !matches!(separator, b'-' | b'/' | b'.') || first == 0 {
        return None;
    }
    let second_text = text.get(first + 1..)?;
    let second = run(second_text);
    if second == 0 || second > 2 || second_text.get(second) != Some(&separator) {
        return None;
    }
    let third_text = second_text.get(second + 1..)?;
    let third = run(third_text);
    let (a, b, c) =
        (whole(text.get(..first)?)?, whole(second_text.get(..second)?)?, whole(third_text.get(..third)?)?);
    let (year, month, day) = if first == 4 {
        (a, b, c)
    } else if third == 4 || third == 2 {
        let year = if third == 2 { 2000 + c } else { c };
        // Month first as in the United States with '/', day first else; 13 and above decides.
        if b > 12 || (separator == b'/' && a <= 12) { (year, a, b) } else { (year, b, a) }
    } else {
        return None;
    };
    Some((date(year, month, day)?, third_text.get(third..)?))
}

/// Days from 1970-01-01 of a date that a recording may bear.
fn date(year: i64, month: i64, day: i64) -> Option<i64> {
    let plausible = (1..=12).contains(&month) && (1..=31).contains(&day) && (1900..=2200).contains(&year);
    plausible.then(|| days(year, month, day))
}

/// A time of day or minutes and seconds: nanoseconds and the number of parts. Where it is known to be a time of day, two
/// parts are hours and minutes.
fn clock(text: &[u8], of_day: bool) -> Option<(i64, usize)> {
    const SECOND: i64 = 1_000_000_000;
    if text.is_empty() {
        return Some((0, 3));
    }
    if !text.contains(&b':') {
        // 103127, 103127812, 103127_812, 10-31-27_812
        let plain: Vec<&[u8]> = text.split(|b| matches!(b, b'_' | b'.' | b',' | b'-')).collect();
        let (h, m, s, fraction): (&[u8], &[u8], &[u8], &[u8]) = match plain.as_slice() {
            [hms] if hms.len() >= 6 => (hms.get(..2)?, hms.get(2..4)?, hms.get(4..6)?, hms.get(6..)?),
            [hms, fraction] if hms.len() == 6 => (hms.get(..2)?, hms.get(2..4)?, hms.get(4..)?, fraction),
            [h, m, s] if h.len() == 2 => (h, m, s, b""),
            [h, m, s, fraction] if h.len() == 2 => (h, m, s, fraction),
            _ => return None,
        };
        let (h, m, s) = (whole(h)?, whole(m)?, whole(s)?);
        if h > 23 || m > 59 || s > 60 {
            return None;
        }
        return Some(((h * 3600 + m * 60 + s) * SECOND + fraction_ns(fraction)?, 3));
    }
    let mut parts = text.split(|b| *b == b':');
    let (a, b, c, d) = (parts.next()?, parts.next()?, parts.next(), parts.next());
    if parts.next().is_some() {
        return None;
    }
    let seconds = |text: &[u8]| -> Option<i64> {
        let cut = text.iter().position(|b| matches!(b, b'.' | b',' | b'_'));
        let (whole_part, fraction) = match cut {
            Some(at) => (text.get(..at)?, fraction_ns(text.get(at + 1..)?)?),
            None => (text, 0),
        };
        let s = whole(whole_part)?;
        if s > 60 { None } else { Some(s * SECOND + fraction) }
    };
    // At most 1e6 h, so that the nanoseconds fit.
    let hours = |text: &[u8]| whole(text).filter(|h| *h <= 1_000_000);
    let minutes = |m: i64| if m > 59 { None } else { Some(m) };
    match (c, d) {
        (None, _) if of_day => {
            let hour = whole(a).filter(|h| *h <= 23)?;
            Some(((hour * 3600 + minutes(whole(b)?)? * 60) * SECOND, 2))
        }
        (None, _) => Some((hours(a)? * 60 * SECOND + seconds(b)?, 2)),
        (Some(c), None) => {
            // 31:27.8 has two parts; three are hours, minutes, seconds.
            Some((hours(a)? * 3600 * SECOND + minutes(whole(b)?)? * 60 * SECOND + seconds(c)?, 3))
        }
        (Some(c), Some(d)) => {
            let ns = hours(a)? * 3600 * SECOND + minutes(whole(b)?)? * 60 * SECOND + seconds(c)?;
            Some((ns + fraction_ns(d)?, 3))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(text: &str, seconds: f64, cycle: Cycle) {
        let stamp = parse(text.as_bytes()).unwrap_or_else(|| panic!("{text}"));
        assert_eq!(stamp.cycle, cycle, "{text}");
        let difference = stamp.ns as f64 / 1e9 - seconds;
        assert!(difference > -1e-6 && difference < 1e-6, "{text}: {}", stamp.ns);
    }

    #[test]
    fn stamps() {
        // Seconds since 1970 from `date -u -d ... +%s`.
        check("2021-07-30 13:28:54", 1_627_651_734.0, Cycle::None);
        check("2021-07-30T13:28:54.250Z", 1_627_651_734.25, Cycle::None);
        check("2021/07/30 13:28:54,25", 1_627_651_734.25, Cycle::None);
        check("07/30/2021 01:28:54 PM", 1_627_651_734.0, Cycle::None);
        check("30.07.2021 13:28:54", 1_627_651_734.0, Cycle::None);
        check("20210730_132854_250", 1_627_651_734.25, Cycle::None);
        check("20210730132854", 1_627_651_734.0, Cycle::None);
        check("20210730132854250", 1_627_651_734.25, Cycle::None);
        check("20210730132854.25", 1_627_651_734.25, Cycle::None);
        check("2021-07-30_13:28:54_250", 1_627_651_734.25, Cycle::None);
        check("2021-07-30T13:28:54.250-13:00", 1_627_651_734.25, Cycle::None);
        // As Excel writes a date that it was not told how to show.
        check("2021/7/30 13:28", 1_627_651_680.0, Cycle::None);
        check("7/30/2021 1:28 PM", 1_627_651_680.0, Cycle::None);
        check("1:28 PM", 48_480.0, Cycle::Day);
        check("10:31:27.812", 37_887.812, Cycle::Day);
        check("10:31:27:812", 37_887.812, Cycle::Day);
        check("31:27.8", 1_887.8, Cycle::Hour);
        check("00:00.1", 0.1, Cycle::Hour);
        check("2021年7月30日 13:28:54.25", 1_627_651_734.25, Cycle::None);
        check("2021年07月30日13時28分54秒", 1_627_651_734.0, Cycle::None);
        check("13時28分54.5秒", 48_534.5, Cycle::Day);
    }

    #[test]
    fn a_japanese_date_in_shift_jis() {
        let text = "2021年7月30日13時28分54.25秒";
        let (bytes, _, _) = encoding_rs::SHIFT_JIS.encode(text);
        assert_eq!(parse(&bytes), parse(text.as_bytes()));
        assert!(parse(&bytes).is_some());
    }

    #[test]
    fn not_stamps() {
        for text in [
            "",
            ":",
            "1:2:3:4:5",
            "12.5",
            "abc",
            "99-99-9999",
            "1:99",
            "2021-13-40 10:00:00",
            "-1:00",
            "3月",
            "5秒",
        ] {
            assert_eq!(parse(text.as_bytes()), None, "{text}");
        }
    }
}
