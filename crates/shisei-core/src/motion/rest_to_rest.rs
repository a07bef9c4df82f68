//! Motion between rests: the sensor stands still, moves, stands still again.
//!
//! Rests are found in the readings ([`crate::rest::find_rests`]), a little of each edge is cut off, and
//! [`super::navigation`] does the rest: it levels and takes the biases at every rest, makes the velocity zero
//! there, and distributes what did not fit over the motion between.

use alloc::vec::Vec;
use core::ops::Range;

use crate::error::{Error, Result};
use crate::filter::Dt;
use crate::math;
use crate::motion::holes::{Readings, sampled_s};
use crate::motion::navigation::{NavigationSettings, Phase, Track, longest_without_rest_s, navigate};
use crate::rest::{RestSettings, find_rests};
use crate::vector::Vec3;

/// Settings of [`rest_to_rest`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RestToRestSettings {
    /// How rests are found; none (the default) lets [`find_quiet_rests`] choose limits by the recording's noise.
    pub rests: Option<RestSettings>,
    /// Cut off each end of a rest, s; default 0.2: the movement begins before it can be seen.
    pub trim_s: f64,
    /// Longest movement without a rest that is still worked out, s; default 20. The band grows with the cube of
    /// the time; beyond, the result says little. `f64::INFINITY` insists.
    pub max_without_rest_s: f64,
    /// The navigator's.
    pub navigation: NavigationSettings,
}

impl Default for RestToRestSettings {
    fn default() -> Self {
        RestToRestSettings {
            rests: None,
            trim_s: 0.2,
            max_without_rest_s: 20.0,
            navigation: NavigationSettings::default(),
        }
    }
}

/// Shortest rest that [`find_quiet_rests`] finds, s.
pub const MIN_REST_S: f64 = 0.5;

/// Shortest rest between two movements, after its ends were cut off, s.
const MIN_MIDDLE_REST_S: f64 = 0.6;

/// The rests of a recording with the strictest limits that find some at both ends.
///
/// A slow movement is hard to tell from a rest: 1 m in 10 s never exceeds 0.08 m/s². So the limits start at the
/// recording's own noise (of its quietest tenth) and are doubled until there is a rest within the first and the
/// last fifth of the recording; the limits of [`RestSettings::default`] end the search. Whatever the strictest
/// search with a result found is returned when no limits give both.
pub fn find_quiet_rests(acc_m_s2: &[Vec3], gyro_rad_s: &[Vec3], dt: Dt<'_>) -> Result<Vec<Range<usize>>> {
    let widest = RestSettings { min_length_s: MIN_REST_S, window_s: 0.4, ..RestSettings::default() };
    let rows = acc_m_s2.len();
    let all = find_rests(acc_m_s2, gyro_rad_s, dt, &widest)?;
    let duration = sampled_s(dt, 0..rows);
    let per_block = (widest.block_s / (duration / rows.max(1) as f64)).max(1.0);
    // deviation of a block's mean (root of three axes' sum) by white noise
    let root = math::sqrt(3.0 / per_block);
    let (acc_floor, gyro_floor) = (quiet_noise(acc_m_s2) * root, quiet_noise(gyro_rad_s) * root);
    let mut fallback = Vec::new();
    let mut factor = 1.0;
    loop {
        let settings = RestSettings {
            acc_deviation_m_s2: (factor * (1.5 * acc_floor + 0.002)).min(widest.acc_deviation_m_s2),
            gyro_deviation_rad_s: (factor * (1.5 * gyro_floor + 0.0005)).min(widest.gyro_deviation_rad_s),
            acc_drift_m_s2: (factor * (2.0 * acc_floor + 0.004)).min(widest.acc_drift_m_s2),
            gyro_drift_rad_s: (factor * (2.0 * gyro_floor + 0.001)).min(widest.gyro_drift_rad_s),
            ..widest
        };
        let rests = find_rests(acc_m_s2, gyro_rad_s, dt, &settings)?;
        let ends = rests.first().is_some_and(|r| 5 * r.start <= rows)
            && rests.last().is_some_and(|r| 5 * r.end >= 4 * rows);
        if ends {
            return Ok(rests);
        }
        if fallback.is_empty() && rests.first().is_some_and(|r| 5 * r.start <= rows) {
            fallback = rests;
        }
        if settings.acc_deviation_m_s2 >= widest.acc_deviation_m_s2 {
            return Ok(if fallback.is_empty() { all } else { fallback });
        }
        factor *= 2.0;
    }
}

/// Standard deviation of one sample's white noise on one axis: from differences of neighbours, in the quietest
/// tenth of blocks of 20 rows.
fn quiet_noise(rows: &[Vec3]) -> f64 {
    let mut blocks: Vec<f64> = rows
        .chunks(20)
        .filter(|b| b.len() > 4)
        .map(|b| {
            let sum: f64 = b
                .windows(2)
                .map(|w| {
                    let d = crate::vector::sub(w[1], w[0]);
                    crate::vector::dot(d, d)
                })
                .sum();
            sum / (6.0 * (b.len() - 1) as f64)
        })
        .collect();
    blocks.sort_by(f64::total_cmp);
    math::sqrt(blocks.get(blocks.len() / 10).copied().unwrap_or(0.0))
}

/// A rest without the beginning of the movement at its ends: blocks of 0.25 s are cut off an end while their mean
/// acceleration or rate is further from that of the rest's surest part than its noise explains (2.5 standard
/// errors). That part is the rest's middle fifth, or half a second at the recording's own ends, and stays.
fn refined(acc: &[Vec3], gyro: &[Vec3], dt: Dt<'_>, rest: &Range<usize>) -> Range<usize> {
    let rows = rest.len();
    let length: f64 = rest.clone().map(|k| dt.at(k)).sum();
    let block = ((0.25 / length * rows as f64) as usize).clamp(1, rows);
    let stride = block.div_ceil(5);
    if rows < 5 {
        return rest.clone();
    }
    // the recording's own ends are the surest part of their rests
    let middle = if rest.start == 0 {
        0..(2 * block).min(rows)
    } else if rest.end == acc.len() {
        rest.end - (2 * block).min(rows)..rest.end
    } else {
        rest.start + 2 * rows / 5..rest.end - 2 * rows / 5
    };
    let differs = |from: usize, to: usize| {
        [acc, gyro].iter().any(|series| {
            let (Some(all), Some(inner), Some(part)) =
                (series.get(rest.clone()), series.get(middle.clone()), series.get(from..to))
            else {
                return false;
            };
            let noise = quiet_noise(all);
            let d = crate::vector::sub(mean(part), mean(inner));
            let variance = noise * noise * (1.0 / part.len() as f64 + 1.0 / inner.len().max(1) as f64);
            crate::vector::dot(d, d) > 2.5 * 2.5 * 3.0 * variance
        })
    };
    let (mut start, mut end) = (rest.start, rest.end);
    while end > middle.end && differs(end.saturating_sub(block).max(rest.start), end) {
        end = end.saturating_sub(stride).max(middle.end);
    }
    while start < middle.start && differs(start, (start + block).min(rest.end)) {
        start = (start + stride).min(middle.start);
    }
    start..end
}

fn mean(rows: &[Vec3]) -> Vec3 {
    let sum = rows.iter().fold([0.0; 3], |a, b| crate::vector::add(a, *b));
    crate::vector::scale(sum, 1.0 / rows.len().max(1) as f64)
}

/// The rests of a recording as phases: rows of a rest, refined at both its ends and less `trim_s` there (never
/// below a third of it), are [`Phase::Rest`], the others [`Phase::Moving`]. The recording's own ends are not
/// trimmed.
pub fn rest_phases(
    acc_m_s2: &[Vec3],
    gyro_rad_s: &[Vec3],
    dt: Dt<'_>,
    rests: &[Range<usize>],
    trim_s: f64,
) -> Vec<Phase> {
    let rows = acc_m_s2.len();
    let mut phases = alloc::vec![Phase::Moving; rows];
    for rest in rests {
        let rest = refined(acc_m_s2, gyro_rad_s, dt, rest);
        let length: f64 = rest.clone().map(|k| dt.at(k)).sum();
        let trim = trim_s.min(length / 3.0);
        let (mut start, mut end) = (rest.start, rest.end);
        let mut cut = 0.0;
        while start > 0 && start < end && cut < trim {
            cut += dt.at(start);
            start += 1;
        }
        cut = 0.0;
        while end < rows && end > start && cut < trim {
            end -= 1;
            cut += dt.at(end);
        }
        // what is left of a rest in the middle must be long enough to be more than a slow stretch
        let left: f64 = (start..end).map(|k| dt.at(k)).sum();
        if start > 0 && end < rows && left < MIN_MIDDLE_REST_S {
            continue;
        }
        for phase in phases.get_mut(start..end).unwrap_or(&mut []) {
            *phase = Phase::Rest;
        }
    }
    phases
}

/// Velocity and position of a recording that begins (and, for a good result, ends) at rest; acc and gyro N rows,
/// m/s² and rad/s. Samples that are no readings are passed over.
///
/// Refuses with [`Error::NoRest`], [`Error::TooLongWithoutRest`] and the errors of [`navigate`].
pub fn rest_to_rest(
    acc_m_s2: &[Vec3],
    gyro_rad_s: &[Vec3],
    dt: Dt<'_>,
    settings: &RestToRestSettings,
) -> Result<Track> {
    if let Some(kept) = Readings::of(acc_m_s2, gyro_rad_s, dt) {
        let track = rest_to_rest(&kept.acc, &kept.gyro, Dt::PerSample(&kept.dt_s), settings);
        return kept.spread(track.map_err(|error| kept.refusal(error))?, &settings.navigation);
    }
    let rests = match &settings.rests {
        Some(rests) => find_rests(acc_m_s2, gyro_rad_s, dt, rests)?,
        None => find_quiet_rests(acc_m_s2, gyro_rad_s, dt)?,
    };
    let phases = rest_phases(acc_m_s2, gyro_rad_s, dt, &rests, settings.trim_s);
    check_rests(&phases, dt, MIN_REST_S, settings.max_without_rest_s)?;
    navigate(acc_m_s2, gyro_rad_s, dt, &phases, &settings.navigation)
}

/// Refuses a recording without any rest ([`Error::NoRest`]), and one with more than `max_s` without one
/// ([`Error::TooLongWithoutRest`]), the movement before the first rest included.
pub fn check_rests(phases: &[Phase], dt: Dt<'_>, needed_s: f64, max_s: f64) -> Result<()> {
    let Some(first) = phases.iter().position(|p| *p != Phase::Moving) else {
        return Err(Error::NoRest { needed_s });
    };
    let before: f64 = (0..first).map(|k| dt.at(k)).sum();
    let seconds = longest_without_rest_s(phases, dt).max(before);
    if seconds > max_s {
        return Err(Error::TooLongWithoutRest { seconds, limit_s: max_s });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Error;

    #[test]
    fn lengths_that_disagree_are_refused_before_the_rests_are_looked_for() {
        let rows = [[0.0, 0.0, 9.81]; 300];
        let settings = RestToRestSettings::default();
        let steps = [0.01; 300];
        let refused =
            |acc: &[Vec3], gyro: &[Vec3], dt: Dt<'_>| rest_to_rest(acc, gyro, dt, &settings).unwrap_err();
        let lengths = |first, second| Error::LengthMismatch { first, second };
        assert_eq!(refused(&rows, &rows[..7], Dt::Constant(0.01)), lengths(300, 7));
        assert_eq!(refused(&rows[..7], &rows, Dt::PerSample(&steps)), lengths(7, 300));
        assert_eq!(refused(&rows, &rows, Dt::PerSample(&steps[..299])), lengths(300, 299));
        assert_eq!(refused(&rows, &rows, Dt::PerSample(&[])), lengths(300, 0));
        assert!(matches!(refused(&[], &[], Dt::Constant(0.01)), Error::NoRest { .. }));
    }
}
