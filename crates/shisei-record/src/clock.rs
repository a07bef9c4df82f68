//! From raw stamps to a strictly increasing time, its steps, and what was found on the way.

use crate::large_pages;
use crate::recording::{Findings, Gap, Note};

/// Raw stamps of one file.
#[derive(Debug, Default)]
pub(crate) struct Stamps {
    /// Seconds; empty where the file has none.
    pub seconds: Vec<f64>,
    /// Length after which the raw clock starts again, s; 0 for never.
    pub cycle_s: f64,
    /// A rate that the file or its dialect states, Hz.
    pub stated_hz: Option<f64>,
    /// The rate the user gave, Hz.
    pub given_hz: Option<f64>,
}

/// Time of every sample.
#[derive(Debug, Default)]
pub(crate) struct Timeline {
    pub time_s: Vec<f64>,
    pub dt_s: Vec<f64>,
    pub notes: Vec<Note>,
    pub warnings: Vec<Note>,
}

/// More than this part of equal neighbours: the stamps are too coarse to give each sample its time.
const COARSE: f64 = 0.4;
/// A step back longer than this is a restart of the clock, s; shorter ones are disorder.
const RESET_S: f64 = 1.0;

/// Rates that makers use, Hz.
const USUAL_HZ: &[f64] = &[
    1.0, 2.0, 4.0, 5.0, 10.0, 12.5, 15.0, 16.0, 20.0, 25.0, 26.0, 30.0, 31.25, 32.0, 40.0, 50.0, 51.2, 52.0,
    60.0, 62.5, 64.0, 75.0, 80.0, 90.0, 99.0, 100.0, 102.4, 104.0, 119.0, 120.0, 125.0, 128.0, 148.148,
    150.0, 180.0, 200.0, 204.8, 208.0, 238.0, 240.0, 250.0, 256.0, 300.0, 333.0, 360.0, 400.0, 416.0, 480.0,
    500.0, 512.0, 600.0, 800.0, 833.0, 952.0, 960.0, 1000.0, 1024.0, 1125.0, 1600.0, 1666.0, 1920.0, 2000.0,
    3200.0, 4000.0, 6400.0, 8000.0,
];

/// Makes the timeline; `None` where neither stamps nor a rate are there.
pub(crate) fn timeline(stamps: Stamps, rows: usize, findings: &mut Findings) -> Option<Timeline> {
    let mut out = Timeline::default();
    findings.rows = rows;
    if let Some(hz) = stamps.given_hz {
        if !stamps.seconds.is_empty() {
            out.notes.push(Note::new(
                "rate-given",
                format!("time is made from the given {hz} Hz; the stamps are left aside"),
                format!("時刻は指定された {hz} Hz から作り、時刻の列は使いません"),
            ));
        }
        from_rate(hz, rows, &mut out, findings);
        return Some(out);
    }
    let mut seconds = stamps.seconds;
    if seconds.is_empty() {
        let hz = stamps.stated_hz?;
        out.notes.push(Note::new(
            "rate-stated",
            format!(
                "there is no time column: time is made from {hz} Hz, which the file (or its kind) states"
            ),
            format!("時刻の列がないため、ファイル (またはその形式) が示す {hz} Hz から時刻を作ります"),
        ));
        from_rate(hz, rows, &mut out, findings);
        return Some(out);
    }
    unwrap(&mut seconds, stamps.cycle_s, findings);
    let equal = seconds.windows(2).filter(|w| w[0] == w[1]).count();
    if seconds.len() > 2 && equal as f64 > COARSE * (seconds.len() - 1) as f64 {
        findings.repeated_stamps = equal;
        coarse(&seconds, stamps.stated_hz, &mut out, findings)?;
        return Some(out);
    }
    fine(seconds, &mut out, findings);
    Some(out)
}

/// Adds a cycle at every step back by more than half a cycle.
fn unwrap(seconds: &mut [f64], cycle_s: f64, findings: &mut Findings) {
    if cycle_s <= 0.0 {
        return;
    }
    let mut offset = 0.0;
    let mut previous = f64::NEG_INFINITY;
    for t in seconds {
        if *t - previous < -0.5 * cycle_s {
            offset += cycle_s;
            findings.wraps += 1;
        }
        previous = *t;
        *t += offset;
    }
}

fn from_rate(hz: f64, rows: usize, out: &mut Timeline, findings: &mut Findings) {
    out.time_s = (0..rows).map(|i| i as f64 / hz).collect();
    out.dt_s = vec![1.0 / hz; rows];
    findings.rate_hz = hz;
    findings.mean_rate_hz = hz;
    findings.time_from_rate = true;
    findings.duration_s = rows.saturating_sub(1) as f64 / hz;
}

/// Stamps that stand still for several samples: the rate over the whole span makes the time, and a jump of
/// the stamps beyond what the rate explains stays a gap.
fn coarse(seconds: &[f64], stated: Option<f64>, out: &mut Timeline, findings: &mut Findings) -> Option<()> {
    let rows = seconds.len();
    let changes: Vec<usize> = (1..rows).filter(|i| seconds[*i] > seconds[*i - 1]).collect();
    // Steps of the stamp and rows in each, without pauses.
    let mut steps: Vec<f64> = changes.iter().map(|i| seconds[*i] - seconds[*i - 1]).collect();
    steps.sort_by(f64::total_cmp);
    let step = steps.get(steps.len() / 2).copied();
    let mut span = 0.0;
    let mut counted = 0usize;
    if let Some(step) = step {
        for pair in changes.windows(2) {
            let length = seconds[pair[1]] - seconds[pair[0]];
            if length < 3.5 * step || length < LONG_PAUSE_S {
                span += length;
                counted += pair[1] - pair[0];
            }
        }
    }
    let measured = if span > 0.0 { Some(counted as f64 / span) } else { None };
    // The ends of the span are known to a stamp's step.
    let tolerance = step.map_or(1.0, |s| (2.0 * s / span.max(s)).max(0.002));
    let hz = match (measured, stated) {
        (Some(measured), Some(stated)) if (measured - stated).abs() <= stated * tolerance.max(0.03) => {
            out.notes.push(Note::new(
                "rate-confirmed",
                format!(
                    "the stamps repeat, so time is made from {stated} Hz, the usual rate of this kind of file \
                     (the stamps over the whole span give {measured:.2} Hz)"
                ),
                format!(
                    "時刻が繰り返されるため、この形式の標準である {stated} Hz から時刻を作ります \
                     (全区間の時刻からは {measured:.2} Hz)"
                ),
            ));
            stated
        }
        (Some(measured), stated) => {
            let usual = USUAL_HZ
                .iter()
                .copied()
                .filter(|hz| (measured - hz).abs() <= hz * tolerance.min(0.02))
                .min_by(|a, b| (a - measured).abs().total_cmp(&(b - measured).abs()));
            let hz = usual.unwrap_or(measured);
            let note = Note::new(
                "rate-measured",
                format!(
                    "the stamps repeat, so time is made from {hz:.6} Hz, measured over their whole span; --rate sets another"
                ),
                format!(
                    "時刻が繰り返されるため、全区間から求めた {hz:.6} Hz から時刻を作ります。--rate で変更できます"
                ),
            );
            if let Some(stated) = stated {
                out.warnings.push(Note::new(
                    "rate-differs",
                    format!(
                        "the stamps give {measured:.2} Hz where {stated} Hz is usual for this kind of file"
                    ),
                    format!("この形式の標準は {stated} Hz ですが、時刻からは {measured:.2} Hz になります"),
                ));
            }
            out.notes.push(note);
            hz
        }
        (None, Some(stated)) => {
            out.notes.push(Note::new(
                "rate-default",
                format!("the stamps stand still, so time is made from {stated} Hz, the usual rate of this kind of file; --rate sets another"),
                format!("時刻が変化しないため、この形式の標準である {stated} Hz から時刻を作ります。--rate で変更できます"),
            ));
            stated
        }
        (None, None) => return None,
    };
    if !(hz.is_finite() && hz > 0.0) {
        return None;
    }
    let dt = 1.0 / hz;
    let mut offset_rows = 0.0;
    let mut gaps = Vec::new();
    let mut t = Vec::with_capacity(rows);
    let mut dts = Vec::with_capacity(rows);
    let mut jump_total = 0.0;
    for i in 0..rows {
        let mut here = dt;
        if i > 0 && seconds[i] > seconds[i - 1] {
            // A step back of the stamps is not a time: only forward jumps count.
            let jump = seconds[i] - seconds[i - 1] - step.unwrap_or(0.0);
            if jump > LONG_PAUSE_S && jump > 3.0 * step.unwrap_or(0.0) {
                here += jump;
                jump_total += jump;
                offset_rows += jump * hz;
                gaps.push(Gap { row: i, from_s: (i as f64 - 1.0 + offset_rows) * dt - jump, length_s: here });
            }
        }
        if i > 0 && seconds[i - 1] - seconds[i] > RESET_S {
            findings.resets += 1;
        }
        t.push((i as f64 + offset_rows) * dt);
        dts.push(here);
    }
    findings.rate_hz = hz;
    findings.time_from_rate = true;
    findings.duration_s = t.last().copied().unwrap_or(0.0);
    findings.mean_rate_hz =
        if findings.duration_s > 0.0 { (rows - 1) as f64 / findings.duration_s } else { hz };
    findings.gap_count = gaps.len();
    findings.gap_total_s = jump_total;
    gaps.truncate(1000);
    findings.gaps = gaps;
    out.time_s = t;
    out.dt_s = dts;
    Some(())
}

/// A pause of coarse stamps that is not their own step, s.
const LONG_PAUSE_S: f64 = 0.5;

/// Stamps that are good enough to give each sample its time.
fn fine(mut t: Vec<f64>, out: &mut Timeline, findings: &mut Findings) {
    let rows = t.len();
    let usual = usual_step(&t);
    if t.windows(2).all(|w| w[1] > w[0]) {
        return steps(t, usual, out, findings);
    }
    let falling = t.windows(2).filter(|w| w[1] < w[0]).count();
    if 10 * falling > 9 * (rows - 1) {
        out.warnings.push(Note::new(
            "rows-reversed",
            "the time falls from row to row: the rows seem to be in reverse order; sort them by time".into(),
            "時刻が行ごとに減っています。行の並びが逆のようです。時刻の順に並べ替えてください".into(),
        ));
    }
    let reset = RESET_S.max(20.0 * usual);
    findings.wild_stamps = mend_wild(&mut t, usual, reset);
    // Resets: go on one usual step after the last sample before it.
    let mut offset = 0.0;
    let mut previous = f64::NEG_INFINITY;
    for value in &mut t {
        if previous - *value > reset {
            offset += previous - *value + usual;
            findings.resets += 1;
        }
        previous = *value;
        *value += offset;
    }
    // Repeats and disorder: a group that does not rise is spread up to the next higher stamp.
    let mut good = 0usize;
    let mut i = 1;
    while i < rows {
        if t[i] > t[good] {
            good = i;
            i += 1;
            continue;
        }
        let start = i;
        while i < rows && t[i] <= t[good] {
            if t[i] < t[good] {
                findings.backward_stamps += 1;
            } else {
                findings.repeated_stamps += 1;
            }
            i += 1;
        }
        // Rows good..i share the stamp of `good`: they are spread to the side that has more room.
        let extra = (i - start) as f64;
        let before = good.checked_sub(1).map_or(0.0, |b| t[good] - t[b]);
        let after = if i < rows { t[i] - t[good] } else { 0.0 };
        if before >= after && before > 0.0 {
            let low = t[good] - before;
            for (k, value) in t[good..i].iter_mut().enumerate() {
                *value = low + before * (k + 1) as f64 / (extra + 1.0);
            }
        } else {
            let low = t[good];
            let room = if after > 0.0 { after } else { usual * (extra + 1.0) };
            for (k, value) in t[start..i].iter_mut().enumerate() {
                *value = low + room * (k + 1) as f64 / (extra + 1.0);
            }
        }
        good = i - 1;
    }
    // What rounding left equal.
    for k in 1..rows {
        if t[k] <= t[k - 1] {
            t[k] = t[k - 1] + (usual * 1e-6).max(t[k - 1].abs() * f64::EPSILON * 2.0);
        }
    }
    steps(t, usual, out, findings);
}

/// Puts single stamps between their neighbours, which follow each other, where they are further than `far` from both: a
/// digit or a bit is wrong. Gives how many.
fn mend_wild(t: &mut [f64], usual: f64, far: f64) -> usize {
    let mut count = 0;
    for k in 1..t.len().saturating_sub(1) {
        let (before, here, after) = (t[k - 1], t[k], t[k + 1]);
        let step = after - before;
        if step > 0.0 && step < 3.5 * usual && (here - before).abs() > far && (here - after).abs() > far {
            t[k] = before + 0.5 * step;
            count += 1;
        }
    }
    count
}

/// Median of the rising steps, s.
pub(crate) fn usual_step(t: &[f64]) -> f64 {
    // A hundred thousand steps, evenly taken, tell the median of any number.
    let every = (t.len() / 100_000).max(1);
    let mut steps: Vec<f64> = t.windows(2).step_by(every).map(|w| w[1] - w[0]).filter(|d| *d > 0.0).collect();
    if steps.is_empty() {
        return 0.01;
    }
    let middle = steps.len() / 2;
    let (_, median, _) = steps.select_nth_unstable_by(middle, f64::total_cmp);
    *median
}

/// Rate, jitter and gaps of a rising time.
fn steps(t: Vec<f64>, median: f64, out: &mut Timeline, findings: &mut Findings) {
    let rows = t.len();
    let (mut sum, mut count) = (0.0, 0usize);
    for w in t.windows(2) {
        let d = w[1] - w[0];
        if d > 0.5 * median && d < 1.5 * median {
            sum += d;
            count += 1;
        }
    }
    let usual = if count > 0 { sum / count as f64 } else { median };
    let mut squares = 0.0;
    let mut gaps = Vec::new();
    let mut dt = Vec::with_capacity(rows);
    large_pages::ask_for(&mut dt);
    dt.push(usual);
    for (i, w) in t.windows(2).enumerate() {
        let d = w[1] - w[0];
        dt.push(d);
        if d > 1.5 * median && d > 1.5 * usual {
            findings.gap_count += 1;
            findings.gap_total_s += d - usual;
            gaps.push(Gap { row: i + 1, from_s: w[0], length_s: d });
        } else if d > 0.5 * median {
            squares += (d - usual) * (d - usual);
        }
    }
    if gaps.len() > 1000 {
        gaps.sort_by(|a, b| b.length_s.total_cmp(&a.length_s));
        gaps.truncate(1000);
        gaps.sort_by_key(|g| g.row);
    }
    findings.gaps = gaps;
    findings.rate_hz = 1.0 / usual;
    findings.jitter_s = if count > 0 { shisei_core::math::sqrt(squares / count as f64) } else { 0.0 };
    findings.duration_s = t.last().copied().unwrap_or(0.0) - t.first().copied().unwrap_or(0.0);
    findings.mean_rate_hz =
        if findings.duration_s > 0.0 { (rows - 1) as f64 / findings.duration_s } else { findings.rate_hz };
    out.time_s = t;
    out.dt_s = dt;
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(seconds: Vec<f64>, stated: Option<f64>, cycle_s: f64) -> (Timeline, Findings) {
        let rows = seconds.len();
        let mut findings = Findings::default();
        let stamps = Stamps { seconds, cycle_s, stated_hz: stated, given_hz: None };
        let out = timeline(stamps, rows, &mut findings).unwrap();
        assert_eq!(out.time_s.len(), rows);
        assert!(out.dt_s.iter().all(|d| *d > 0.0));
        assert!(out.time_s.windows(2).all(|w| w[1] > w[0]));
        (out, findings)
    }

    fn close(a: f64, b: f64, tolerance: f64) {
        assert!((a - b).abs() <= tolerance, "{a} {b}");
    }

    #[test]
    fn mu01_stamps_give_the_usual_rate() {
        // 100 Hz, written to a tenth of a second.
        let t: Vec<f64> = (0..1671).map(|i| ((f64::from(i) * 0.01 + 27.83) * 10.0).floor() / 10.0).collect();
        let (out, findings) = run(t, Some(100.0), 3600.0);
        assert_eq!(findings.rate_hz, 100.0);
        assert_eq!(out.time_s[100], 1.0);
        assert_eq!(out.notes[0].code, "rate-confirmed");
    }

    #[test]
    fn mu01_stamps_roll_over_the_hour_and_tell_another_rate() {
        let t: Vec<f64> =
            (0..3000).map(|i| ((3590.0 + f64::from(i) * 0.02) * 10.0).floor() / 10.0 % 3600.0).collect();
        let (_, findings) = run(t, Some(100.0), 3600.0);
        close(findings.rate_hz, 50.0, 1e-9);
        assert_eq!(findings.wraps, 1);
    }

    #[test]
    fn single_wild_stamps_are_put_between_their_neighbours() {
        let good: Vec<f64> = (0..1000).map(|i| f64::from(i) * 0.01).collect();
        for wild in [799.0, -5e8, 1e300, -3.0] {
            let mut t = good.clone();
            (t[200], t[800]) = (wild, wild);
            let (out, findings) = run(t, None, 0.0);
            assert_eq!((findings.wild_stamps, findings.resets, findings.gap_count), (2, 0, 0), "{wild}");
            assert!(out.time_s.iter().zip(&good).all(|(t, good)| (t - good).abs() < 1e-9), "{wild}");
        }
        // A clock that starts again, and a pause, are neither.
        let mut t = good;
        t[500..].iter_mut().for_each(|t| *t -= 4.0);
        t[700..].iter_mut().for_each(|t| *t += 60.0);
        let (_, findings) = run(t, None, 0.0);
        assert_eq!((findings.wild_stamps, findings.resets, findings.gap_count), (0, 1, 1));
    }

    #[test]
    fn rows_in_reverse_order_are_called_that() {
        for step in [0.01, 2.0] {
            let t = (0..300).rev().map(|i| f64::from(i) * step).collect();
            let (out, _) = run(t, None, 0.0);
            assert!(out.warnings.iter().any(|note| note.code == "rows-reversed"));
        }
        let (out, _) = run((0..300).map(|i| f64::from(i % 100) * 0.01).collect(), None, 0.0);
        assert!(out.warnings.is_empty());
    }

    #[test]
    fn jitter_gaps_and_repeats() {
        let mut t: Vec<f64> =
            (0..1000).map(|i| f64::from(i) * 0.01 + if i % 2 == 0 { 0.001 } else { 0.0 }).collect();
        for value in &mut t[500..] {
            *value += 0.75;
        }
        t[300] = t[299];
        let (out, findings) = run(t, None, 0.0);
        close(findings.rate_hz, 100.0, 0.5);
        assert_eq!(findings.gap_count, 1);
        assert_eq!(findings.repeated_stamps, 1);
        close(findings.gaps[0].length_s, 0.76, 0.002);
        assert_eq!(findings.gaps[0].row, 500);
        close(out.dt_s[500], 0.76, 0.002);
    }

    #[test]
    fn counter_wraps_and_device_resets() {
        let t: Vec<f64> = (0..100).map(|i| (f64::from(i) * 0.01 + 0.5) % 1.0).collect();
        let (out, findings) = run(t, None, 1.0);
        assert_eq!(findings.wraps, 1);
        close(out.time_s[99] - out.time_s[0], 0.99, 1e-9);
        let mut t: Vec<f64> = (0..200).map(|i| f64::from(i) * 0.05).collect();
        for (k, value) in t[100..].iter_mut().enumerate() {
            *value = k as f64 * 0.05;
        }
        let (out, findings) = run(t, None, 0.0);
        assert_eq!(findings.resets, 1);
        close(out.time_s[199], 199.0 * 0.05, 1e-9);
    }

    #[test]
    fn millisecond_stamps_give_the_true_rate() {
        let t: Vec<f64> = (0..2000).map(|i| (f64::from(i) / 0.2857).floor() / 1000.0).collect();
        let (_, findings) = run(t, None, 0.0);
        close(findings.rate_hz, 285.7, 0.2);
    }

    #[test]
    fn no_stamps_no_rate() {
        let mut findings = Findings::default();
        assert!(timeline(Stamps::default(), 10, &mut findings).is_none());
    }
}
