//! Walking with the sensor on a foot: the velocity is zero at every step while the foot stands.
//!
//! Stances are found by the test of Skog, Händel, Nilsson & Rantakokko (2010): over a short window,
//! `mean |ω|²/s_ω² + mean |a − g ā/|ā||²/s_a² < 1`. Where the recording rests for longer, the rest is used as
//! in [`super::rest_to_rest`]. [`super::navigation`] turns both into a path with an error band.

use alloc::vec::Vec;

use crate::error::Result;
use crate::filter::Dt;
use crate::motion::holes::{HoleMotion, Readings, sampled_s};
use crate::motion::navigation::{NavigationSettings, Phase, SensorErrors, Track, navigate};
use crate::motion::rest_to_rest::{check_rests, rest_phases};
use crate::rest::{RestSettings, find_rests};
use crate::vector::{self, Vec3};

/// Settings of [`foot`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FootSettings {
    /// Length of the stance test's window, s; default 0.05.
    pub window_s: f64,
    /// s_ω, rad/s; default 0.6. Larger accepts stances in which the foot still rolls.
    pub gyro_scale_rad_s: f64,
    /// s_a, m/s²; default 0.7.
    pub acc_scale_m_s2: f64,
    /// Shorter stances are left out, s; default 0.04.
    pub min_stance_s: f64,
    /// Longest time without a stance that is still worked out, s; default 5.
    pub max_without_rest_s: f64,
    /// The navigator's. Its band is doubled (`band_factor`): a foot that rolls in its stance is an error of the
    /// assumption, not of the sensor, and walks with measured footprints ended 1 to 2.5 of the navigator's
    /// standard deviations off. In holes a swing's motion is assumed, some rad/s and about 1 g; and the band is
    /// doubled again after one, for tilt and velocity are then so far off that the linear model errs: the three
    /// walks of the tests with 0.05 and 0.1 s cut out at 12 places each ended up to 4.2 of the standard deviations
    /// without that from where the whole ones end.
    pub navigation: NavigationSettings,
}

impl Default for FootSettings {
    fn default() -> Self {
        FootSettings {
            window_s: 0.05,
            gyro_scale_rad_s: 0.6,
            acc_scale_m_s2: 0.7,
            min_stance_s: 0.04,
            max_without_rest_s: 5.0,
            navigation: NavigationSettings {
                errors: SensorErrors {
                    acc_bias_m_s2: 0.2,
                    gyro_scale: 0.003,
                    acc_scale: 0.01,
                    gyro_motion_density: 0.0003,
                    acc_motion_density: 0.01,
                    jerk_share: 0.05,
                    acc_sway_m_s2: 0.003,
                    gyro_sway_rad_s: 0.0005,
                    ..SensorErrors::default()
                },
                stance_velocity_m_s: 0.01,
                stance_lever_m: 0.01,
                doubtful_distance: f64::INFINITY,
                hole_motion: HoleMotion {
                    acc_m_s2: 10.0,
                    rate_rad_s: 5.0,
                    band_factor: 2.0,
                    ..HoleMotion::default()
                },
                // of longer ones in a swing, some ended beyond three of the standard deviations stated
                max_hole_s: 0.15,
                band_factor: 2.0,
                ..NavigationSettings::default()
            },
        }
    }
}

/// The stances of a recording: one flag a row.
pub fn stances(acc_m_s2: &[Vec3], gyro_rad_s: &[Vec3], dt: Dt<'_>, settings: &FootSettings) -> Vec<bool> {
    let n = acc_m_s2.len().min(gyro_rad_s.len());
    let mut standing = alloc::vec![false; n];
    if n == 0 {
        return standing;
    }
    let duration = sampled_s(dt, 0..n);
    let width = ((settings.window_s * n as f64 / duration) as usize).clamp(3, n.max(3));
    let g = settings.navigation.gravity_m_s2;
    let (acc_weight, gyro_weight) = (
        1.0 / (settings.acc_scale_m_s2 * settings.acc_scale_m_s2),
        1.0 / (settings.gyro_scale_rad_s * settings.gyro_scale_rad_s),
    );
    // Σ|a − g u|² = Σ|a|² − 2 g Σ a·u + w g², u = ā/|ā|: running sums do
    let (mut acc_sum, mut acc_square, mut gyro_square) = ([0.0; 3], 0.0, 0.0);
    for k in 0..n {
        acc_sum = vector::add(acc_sum, acc_m_s2[k]);
        acc_square += vector::dot(acc_m_s2[k], acc_m_s2[k]);
        gyro_square += vector::dot(gyro_rad_s[k], gyro_rad_s[k]);
        if k >= width {
            let old = k - width;
            acc_sum = vector::sub(acc_sum, acc_m_s2[old]);
            acc_square -= vector::dot(acc_m_s2[old], acc_m_s2[old]);
            gyro_square -= vector::dot(gyro_rad_s[old], gyro_rad_s[old]);
        }
        if k + 1 < width {
            continue;
        }
        let w = width as f64;
        let acc = acc_square - 2.0 * g * vector::norm(acc_sum) + w * g * g;
        let statistic = (acc.max(0.0) * acc_weight + gyro_square.max(0.0) * gyro_weight) / w;
        if statistic < 1.0 {
            standing[k + 1 - width.div_ceil(2)] = true;
        }
    }
    let min_rows = ((settings.min_stance_s * n as f64 / duration) as usize).max(1);
    let mut start = 0;
    for k in 0..=n {
        let on = k < n && standing[k];
        if !on {
            if k - start < min_rows {
                standing[start..k].fill(false);
            }
            start = k + 1;
        }
    }
    standing
}

/// Velocity and position of a walk with the sensor on a foot; acc and gyro N rows, m/s² and rad/s, 100 Hz or more.
/// The recording begins with the foot at rest for half a second or more.
///
/// Refuses with [`crate::Error::NoRest`], [`crate::Error::TooLongWithoutRest`] and the errors of [`navigate`].
pub fn foot(acc_m_s2: &[Vec3], gyro_rad_s: &[Vec3], dt: Dt<'_>, settings: &FootSettings) -> Result<Track> {
    if let Some(kept) = Readings::of(acc_m_s2, gyro_rad_s, dt) {
        let track = foot(&kept.acc, &kept.gyro, Dt::PerSample(&kept.dt_s), settings);
        return kept.spread(track.map_err(|error| kept.refusal(error))?, &settings.navigation);
    }
    let quiet = RestSettings {
        min_length_s: 0.5,
        window_s: 0.3,
        gravity_m_s2: settings.navigation.gravity_m_s2,
        ..RestSettings::default()
    };
    let rests = find_rests(acc_m_s2, gyro_rad_s, dt, &quiet)?;
    let mut phases = rest_phases(acc_m_s2, gyro_rad_s, dt, &rests, 0.1);
    if let Some(first) = phases.iter().position(|p| *p == Phase::Rest) {
        let standing = stances(acc_m_s2, gyro_rad_s, dt, settings);
        for (phase, stands) in phases.iter_mut().zip(standing).skip(first) {
            if stands && *phase == Phase::Moving {
                *phase = Phase::Stance;
            }
        }
    }
    check_rests(&phases, dt, quiet.min_length_s, settings.max_without_rest_s)?;
    navigate(acc_m_s2, gyro_rad_s, dt, &phases, &settings.navigation)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Error;

    #[test]
    fn lengths_that_disagree_are_refused_before_the_rests_are_looked_for() {
        let rows = [[0.0, 0.0, 9.81]; 300];
        let settings = FootSettings::default();
        let steps = [0.01; 300];
        let refused = |acc: &[Vec3], gyro: &[Vec3], dt: Dt<'_>| foot(acc, gyro, dt, &settings).unwrap_err();
        let lengths = |first, second| Error::LengthMismatch { first, second };
        assert_eq!(refused(&rows, &rows[..7], Dt::Constant(0.01)), lengths(300, 7));
        assert_eq!(refused(&rows[..7], &rows, Dt::PerSample(&steps)), lengths(7, 300));
        assert_eq!(refused(&rows, &rows, Dt::PerSample(&steps[..299])), lengths(300, 299));
        assert_eq!(refused(&rows, &rows, Dt::PerSample(&[])), lengths(300, 0));
        assert!(matches!(refused(&[], &[], Dt::Constant(0.01)), Error::NoRest { .. }));
    }
}
