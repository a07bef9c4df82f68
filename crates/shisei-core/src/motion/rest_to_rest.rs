//! Motion between rests: the sensor stands still, moves, stands still again.
//!
//! Rests are found in the readings ([`crate::rest::find_rests`]), a little of each edge is cut off, and
//! [`super::navigation`] does the rest: it levels and takes the biases at every rest, makes the velocity zero
//! there, and distributes what did not fit over the motion between.

use alloc::vec::Vec;
use core::ops::Range;

use crate::error::{Error, Result};
use crate::filter::Dt;
use crate::motion::navigation::{NavigationSettings, Phase, Track, longest_without_rest_s, navigate};
use crate::rest::{RestSettings, find_rests};
use crate::vector::Vec3;

/// Settings of [`rest_to_rest`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RestToRestSettings {
    /// How rests are found; by default as [`RestSettings`] but from 0.5 s on.
    pub rests: RestSettings,
    /// Cut off each end of a rest, s; default 0.1: the movement begins before it can be seen.
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
            rests: RestSettings { min_length_s: 0.5, window_s: 0.3, ..RestSettings::default() },
            trim_s: 0.1,
            max_without_rest_s: 20.0,
            navigation: NavigationSettings::default(),
        }
    }
}

/// The rests of a recording as phases: rows of a rest, less `trim_s` at both its ends (never below a third of
/// it), are [`Phase::Rest`], the others [`Phase::Moving`]. The recording's own ends are not trimmed.
pub fn rest_phases(rows: usize, dt: Dt<'_>, rests: &[Range<usize>], trim_s: f64) -> Vec<Phase> {
    let mut phases = alloc::vec![Phase::Moving; rows];
    for rest in rests {
        let length: f64 = rest.clone().map(|k| dt.at(k)).sum();
        let trim = trim_s.min(length / 3.0);
        let mut start = rest.start;
        if start > 0 {
            let mut cut = 0.0;
            while start < rest.end && cut < trim {
                cut += dt.at(start);
                start += 1;
            }
        }
        let mut end = rest.end.min(rows);
        if end < rows {
            let mut cut = 0.0;
            while end > start && cut < trim {
                end -= 1;
                cut += dt.at(end);
            }
        }
        for phase in phases.get_mut(start..end).unwrap_or(&mut []) {
            *phase = Phase::Rest;
        }
    }
    phases
}

/// Velocity and position of a recording that begins (and, for a good result, ends) at rest; acc and gyro N rows,
/// m/s² and rad/s.
///
/// Refuses with [`Error::NoRest`], [`Error::TooLongWithoutRest`] and the errors of [`navigate`].
pub fn rest_to_rest(
    acc_m_s2: &[Vec3],
    gyro_rad_s: &[Vec3],
    dt: Dt<'_>,
    settings: &RestToRestSettings,
) -> Result<Track> {
    let rests = find_rests(acc_m_s2, gyro_rad_s, dt, &settings.rests)?;
    let phases = rest_phases(acc_m_s2.len(), dt, &rests, settings.trim_s);
    check_rests(&phases, dt, settings.rests.min_length_s, settings.max_without_rest_s)?;
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
