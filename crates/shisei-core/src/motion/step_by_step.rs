//! Step by step from the first rest, nothing corrected afterwards: what [`DeadReckoning`] makes of a recording, with the
//! error band that belongs to it.

use alloc::vec::Vec;

use super::holes::{Readings, hole_from_s};
use super::navigation::{NavigationSettings, Phase, Track, navigate};
use super::rest_to_rest::{MIN_REST_S, RestToRestSettings, check_rests, find_quiet_rests, rest_phases};
use super::{DeadReckoning, Scheme};
use crate::error::{Error, Result};
use crate::filter::Dt;
use crate::vector::Vec3;
use crate::{STANDARD_GRAVITY_M_S2, initial, rest};

/// How [`step_by_step`] integrates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepByStepSettings {
    /// Order of the integration.
    pub scheme: Scheme,
    /// Local gravity, m/s², for the error band.
    pub gravity_m_s2: f64,
    /// Longest time without a rest, s; infinity for none.
    pub max_without_rest_s: f64,
    /// Longest hole in the samples that is bridged, s; infinity for any.
    pub max_hole_s: f64,
}

impl Default for StepByStepSettings {
    fn default() -> Self {
        StepByStepSettings {
            scheme: Scheme::SemiImplicit,
            gravity_m_s2: STANDARD_GRAVITY_M_S2,
            max_without_rest_s: RestToRestSettings::default().max_without_rest_s,
            max_hole_s: NavigationSettings::default().max_hole_s,
        }
    }
}

/// Velocity and position of a recording that begins at rest; acc and gyro N rows, m/s² and rad/s. Gyroscope bias, size
/// of gravity and attitude (yaw 0) are those of the first rest; the band is that of the navigator left to itself after
/// that rest.
///
/// Refuses as [`rest_to_rest`](super::rest_to_rest::rest_to_rest).
pub fn step_by_step(
    acc_m_s2: &[Vec3],
    gyro_rad_s: &[Vec3],
    dt: Dt<'_>,
    settings: &StepByStepSettings,
) -> Result<Track> {
    if let Some(kept) = Readings::of(acc_m_s2, gyro_rad_s, dt) {
        let track = step_by_step(&kept.acc, &kept.gyro, Dt::PerSample(&kept.dt_s), settings);
        let navigation =
            NavigationSettings { max_hole_s: settings.max_hole_s, ..NavigationSettings::default() };
        return kept.spread(track.map_err(|error| kept.refusal(error))?, &navigation);
    }
    let rests = find_quiet_rests(acc_m_s2, gyro_rad_s, dt)?;
    let no_rest = Error::NoRest { needed_s: MIN_REST_S };
    let first = rests.first().ok_or(no_rest)?;
    let usual = RestToRestSettings::default();
    let phases = rest_phases(acc_m_s2, gyro_rad_s, dt, core::slice::from_ref(first), usual.trim_s);
    check_rests(&phases, dt, MIN_REST_S, settings.max_without_rest_s)?;
    let StepByStepSettings { gravity_m_s2, max_hole_s, .. } = *settings;
    let navigation = NavigationSettings { gravity_m_s2, max_hole_s, ..NavigationSettings::default() };
    let mut track = navigate(acc_m_s2, gyro_rad_s, dt, &phases, &navigation)?;
    let at_rest: Vec<usize> = (0..phases.len()).filter(|k| phases[*k] == Phase::Rest).collect();
    let (Some(&start), Some(&stop)) = (at_rest.first(), at_rest.last()) else { return Err(no_rest) };
    let still = start..stop + 1;
    let start = initial::from_mean_acceleration(rest::mean(&acc_m_s2[still.clone()])?)?;
    let gravity = rest::mean_norm(&acc_m_s2[still.clone()])?;
    let bias = rest::gyro_bias(&gyro_rad_s[still])?;
    let mut dead = DeadReckoning::new(start, bias, gravity, settings.scheme)?;
    let hole_from_s = hole_from_s(dt);
    for k in 0..acc_m_s2.len() {
        let state = if k <= stop {
            dead.state()
        } else if dt.at(k) > hole_from_s {
            let ends = [k - 1, k].map(|k| (gyro_rad_s[k], acc_m_s2[k]));
            let bridge = navigation.hole_motion.bridge(dt.at(k), [[0.0; 3]; 2], [[0.0; 3]; 2]);
            dead.cross(ends, dt.at(k), bridge.share, bridge.pieces);
            dead.state()
        } else {
            dead.update(gyro_rad_s[k], acc_m_s2[k], dt.at(k))
        };
        track.velocity_m_s[k] = state.velocity_m_s;
        track.position_m[k] = state.position_m;
        track.world_from_body[k] = state.world_from_body;
    }
    Ok(track)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three seconds of rest, then a second of 1 m/s² ahead: sums of steps in closed form.
    #[test]
    fn a_push_after_a_rest() {
        let dt_s = 0.01;
        let acc: Vec<Vec3> = (0..400).map(|k| [if k < 300 { 0.0 } else { 1.0 }, 0.0, 9.81]).collect();
        let gyro = alloc::vec![[0.01, -0.02, 0.005]; 400];
        let end = |scheme| {
            let settings = StepByStepSettings { scheme, ..StepByStepSettings::default() };
            let track = step_by_step(&acc, &gyro, Dt::Constant(dt_s), &settings).unwrap();
            assert!(track.velocity_m_s[..290].iter().all(|v| v.iter().all(|x| x.abs() < 1e-12)));
            assert!(track.sigma_total_m(399) > track.sigma_total_m(310));
            (track.velocity_m_s[399][0], track.position_m[399][0])
        };
        let n = 100.0;
        for (scheme, position) in [
            (Scheme::SemiImplicit, n * (n + 1.0) / 2.0 * dt_s * dt_s),
            (Scheme::Euler, n * (n - 1.0) / 2.0 * dt_s * dt_s),
        ] {
            let (v, x) = end(scheme);
            assert!(
                (v - n * dt_s).abs() < 1e-9 && (x - position).abs() < 1e-9,
                "{scheme:?}: {v} {x} {position}"
            );
        }
        let moving = alloc::vec![[0.3, 0.0, 9.81]; 20];
        let settings = StepByStepSettings::default();
        let refused = step_by_step(&moving, &gyro[..20], Dt::Constant(dt_s), &settings);
        assert!(matches!(refused, Err(Error::NoRest { .. })), "{refused:?}");
    }
}
