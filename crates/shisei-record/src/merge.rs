//! Accelerometer and gyroscope files of one recording onto one clock.

use crate::error::{Error, Problem, Result};
use crate::open::{Part, Share};
use crate::recording::Note;
use shisei_core::Vec3;

/// One part from several.
pub(crate) fn merge(mut parts: Vec<Part>) -> Result<Part> {
    if parts.len() == 1 {
        return Ok(parts.remove(0));
    }
    let mut acc: Option<Part> = None;
    let mut gyro: Option<Part> = None;
    let (mut linear, mut gravity): (Option<Part>, Option<Part>) = (None, None);
    for part in parts {
        match part.share {
            Share::Total => {}
            Share::Linear => {
                linear = Some(part);
                continue;
            }
            Share::Gravity => {
                gravity = Some(part);
                continue;
            }
        }
        let fail = |quantity| Err(Error::of_file(&part.name, Problem::SameQuantity { quantity }));
        match (part.acc.is_some(), part.gyro.is_some()) {
            (true, true) => return fail("acc, gyr"),
            (true, false) if acc.is_some() => return fail("acc"),
            (false, true) if gyro.is_some() => return fail("gyr"),
            (true, false) => acc = Some(part),
            _ => gyro = Some(part),
        }
    }
    match (linear, gravity) {
        (Some(linear), Some(gravity)) if acc.is_none() => acc = Some(add(linear, &gravity)),
        (Some(linear), None) if acc.is_none() => {
            let column = linear.without_gravity.clone().unwrap_or_else(|| linear.name.clone());
            let problem = Problem::GravityRemoved { column, norm_m_s2: None };
            return Err(Error::of_file(&linear.name, problem));
        }
        _ => {}
    }
    let (mut acc, mut out) = match (acc, gyro) {
        (Some(acc), Some(gyro)) => (acc, gyro),
        (Some(acc), None) => {
            let columns = acc.channels.into_iter().map(|c| c.name).collect();
            return Err(Error::of_file(&acc.name, Problem::NoGyro { columns }));
        }
        (None, Some(gyro)) => {
            let columns = gyro.channels.into_iter().map(|c| c.name).collect();
            return Err(Error::of_file(&gyro.name, Problem::NoAcc { columns }));
        }
        (None, None) => return Err(Error::of_file("", Problem::Empty)),
    };
    // The accelerometer's clock in the gyroscope's.
    let shift = match (acc.origin_ns, out.origin_ns) {
        (Some(a), Some(g)) => a.saturating_sub(g) as f64 / 1e9,
        _ => 0.0,
    };
    let acc_time: Vec<f64> = acc.time_s.iter().map(|t| t + shift).collect();
    let (Some(first), Some(last)) = (acc_time.first().copied(), acc_time.last().copied()) else {
        return Err(Error::of_file(&acc.name, Problem::NoOverlap));
    };
    let margin = 2.0 / acc.findings.rate_hz.max(1e-3);
    let keep: Vec<bool> = out.time_s.iter().map(|t| *t >= first - margin && *t <= last + margin).collect();
    let overlap = keep.iter().filter(|k| **k).count();
    if overlap < 2 {
        return Err(Error::of_file(&acc.name, Problem::NoOverlap));
    }
    let dropped = out.time_s.len() - overlap;
    retain(&mut out, &keep);
    take_beside(&mut out, &mut acc, &acc_time);
    out.body.acc = interpolate(&acc_time, &acc.body.acc, &out.time_s);
    out.body.whole_numbers = out.body.whole_numbers && acc.body.whole_numbers;
    out.body.rows = overlap;
    out.findings.rows = overlap;
    out.findings.skipped_rows += dropped;
    out.assumptions.push(Note::new(
        "merged",
        format!(
            "acceleration of {} ({:.2} Hz) is interpolated onto the clock of {} ({:.2} Hz); {dropped} row(s) \
             outside the common time are left out",
            acc.name, acc.findings.rate_hz, out.name, out.findings.rate_hz
        ),
        format!(
            "{} の加速度 ({:.2} Hz) を {} の時刻 ({:.2} Hz) に補間しました。共通の時間帯の外にある {dropped} 行は\
             除きました",
            acc.name, acc.findings.rate_hz, out.name, out.findings.rate_hz
        ),
    ));
    if acc.findings.gaps.iter().any(|g| g.length_s > crate::LONG_GAP_S) {
        out.warnings.push(Note::new(
            "merged-gap",
            format!(
                "{} has gaps longer than 0.5 s; the acceleration inside them is a straight line",
                acc.name
            ),
            format!("{} に 0.5 s を超える欠落があり、その間の加速度は直線で補間されています", acc.name),
        ));
    }
    out.findings.repeated_stamps += acc.findings.repeated_stamps;
    out.findings.wild_stamps += acc.findings.wild_stamps;
    out.findings.resets += acc.findings.resets;
    let mut channels = acc.channels;
    channels.append(&mut out.channels);
    out.channels = channels;
    for note in acc.assumptions {
        if !out.assumptions.iter().any(|n| n.code == note.code) {
            out.assumptions.push(note);
        }
    }
    out.warnings.extend(acc.warnings);
    out.acc = acc.acc;
    out.reading.acc_unit = acc.reading.acc_unit;
    out.without_gravity = acc.without_gravity;
    Ok(out)
}

/// What the accelerometer's file has beside the acceleration: taken over where its samples are those of the gyroscope's.
fn take_beside(out: &mut Part, acc: &mut Part, acc_time: &[f64]) {
    out.body.skipped += acc.body.skipped;
    out.body.trimmed += acc.body.trimmed;
    let names = std::mem::take(&mut acc.keep_names);
    if acc_time == out.time_s {
        out.keep_names.extend(names);
        out.body.keep.append(&mut acc.body.keep);
        if out.body.temp.is_empty() {
            out.body.temp = std::mem::take(&mut acc.body.temp);
        }
        return;
    }
    for channel in acc.channels.iter_mut().filter(|channel| channel.role == "temp_c") {
        channel.used = false;
    }
    if !names.is_empty() {
        let names = names.join(", ");
        out.warnings.push(Note::new(
            "merged-columns",
            format!(
                "{names} of {} cannot be kept: its samples are at other times than those of {}",
                acc.name, out.name
            ),
            format!("{} の {names} は残せません。サンプルの時刻が {} と異なるためです", acc.name, out.name),
        ));
    }
}

/// The whole acceleration from its two shares, on the first one's clock.
fn add(mut linear: Part, gravity: &Part) -> Part {
    let shift = match (gravity.origin_ns, linear.origin_ns) {
        (Some(g), Some(l)) => g.saturating_sub(l) as f64 / 1e9,
        _ => 0.0,
    };
    let time: Vec<f64> = gravity.time_s.iter().map(|t| t + shift).collect();
    let values = interpolate(&time, &gravity.body.acc, &linear.time_s);
    for (a, g) in linear.body.acc.iter_mut().zip(values) {
        *a = [0, 1, 2].map(|i| a[i] + g[i]);
    }
    linear.channels.extend(gravity.channels.iter().cloned());
    linear.assumptions.push(Note::new(
        "gravity-added",
        format!("the acceleration is the sum of {} (without gravity) and {}", linear.name, gravity.name),
        format!("加速度は {} (重力を除いた加速度) と {} の和です", linear.name, gravity.name),
    ));
    linear.without_gravity = None;
    linear.share = Share::Total;
    linear
}

/// Keeps the rows in the common time.
fn retain(part: &mut Part, keep: &[bool]) {
    fn filter<T>(values: &mut Vec<T>, keep: &[bool]) {
        let mut flags = keep.iter();
        values.retain(|_| flags.next().copied().unwrap_or(false));
    }
    filter(&mut part.time_s, keep);
    filter(&mut part.dt_s, keep);
    filter(&mut part.body.gyro, keep);
    if !part.body.temp.is_empty() {
        filter(&mut part.body.temp, keep);
    }
    for column in &mut part.body.keep {
        filter(column, keep);
    }
    // The first row of what is left has no step before it.
    if keep.first() == Some(&false)
        && let Some(dt) = part.dt_s.first_mut()
        && part.findings.rate_hz > 0.0
    {
        *dt = 1.0 / part.findings.rate_hz;
    }
    part.findings.duration_s =
        part.time_s.last().copied().unwrap_or(0.0) - part.time_s.first().copied().unwrap_or(0.0);
    let first_row = keep.iter().position(|k| *k).unwrap_or(0);
    let rows = part.time_s.len();
    let all_listed = part.findings.gaps.len() == part.findings.gap_count;
    part.findings.gaps.retain_mut(|gap| {
        gap.row = gap.row.saturating_sub(first_row);
        gap.row > 0 && gap.row < rows
    });
    if all_listed {
        let usual_s = 1.0 / part.findings.rate_hz.max(1e-3);
        part.findings.gap_count = part.findings.gaps.len();
        part.findings.gap_total_s = part.findings.gaps.iter().map(|gap| gap.length_s - usual_s).sum();
    }
}

/// Linear interpolation of rising samples; held at both ends.
fn interpolate(time: &[f64], values: &[Vec3], at: &[f64]) -> Vec<Vec3> {
    let mut k = 0;
    at.iter()
        .map(|t| {
            while k + 1 < time.len() && time[k + 1] < *t {
                k += 1;
            }
            let (Some(t0), Some(v0)) = (time.get(k), values.get(k)) else { return [0.0; 3] };
            let (Some(t1), Some(v1)) = (time.get(k + 1), values.get(k + 1)) else { return *v0 };
            if *t <= *t0 {
                return *v0;
            }
            let u = ((t - t0) / (t1 - t0)).min(1.0);
            [0, 1, 2].map(|i| v0[i] + (v1[i] - v0[i]) * u)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_straight_line_stays_straight() {
        let time = [0.0, 1.0, 3.0];
        let values = [[0.0; 3], [1.0, 2.0, 3.0], [3.0, 6.0, 9.0]];
        let out = interpolate(&time, &values, &[-0.5, 0.25, 1.0, 2.0, 4.0]);
        assert_eq!(out, [[0.0; 3], [0.25, 0.5, 0.75], [1.0, 2.0, 3.0], [2.0, 4.0, 6.0], [3.0, 6.0, 9.0]]);
    }
}
