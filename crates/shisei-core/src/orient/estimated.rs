//! The estimator over a whole recording, with the same start and reference as the classic filters.

use alloc::vec::Vec;
use core::ops::Range;

use super::{Certainty, Settings};
use crate::error::Result;
use crate::estimator::{self, Calibration, Estimator, Sample, State};
use crate::filter::Dt;
use crate::quaternion::Quaternion;
use crate::vector::{self, Vec3};

/// Attitudes, what is known of them, and what was learnt of the sensor.
pub(super) struct Estimate {
    pub world_from_body: Vec<Quaternion>,
    pub certainty: Certainty,
    pub learnt: Calibration,
    /// Attitude at the start, in the same world.
    pub start: Quaternion,
}

/// `level` is the attitude at the start with yaw 0 where there is a rest: the world is turned about z so that the
/// estimate there agrees with it.
pub(super) fn run(
    data: (&[Vec3], &[Vec3], &[f64]),
    settings: &Settings,
    online: bool,
    bias: Vec3,
    rest: Option<(&Range<usize>, Quaternion)>,
) -> Result<Estimate> {
    let (acc, gyro, dt_s) = data;
    let estimator_settings = estimator::Settings {
        gravity_m_s2: settings.gravity_m_s2,
        calibration: settings.sensor,
        ..estimator::Settings::default()
    };
    let rates: Vec<Vec3> = gyro.iter().map(|&rate| vector::sub(rate, bias)).collect();
    let (states, mut learnt) = if online {
        causal(acc, &rates, dt_s, &estimator_settings)?
    } else {
        let smoothed = estimator::smooth(acc, &rates, Dt::PerSample(dt_s), &estimator_settings)?;
        (smoothed.states, smoothed.calibration)
    };
    learnt.gyro_bias_rad_s = vector::add(learnt.gyro_bias_rad_s, bias);
    let (turn, start) = match rest {
        Some((rest, level)) => {
            let there = states[rest.start + rest.len() / 2].world_from_body;
            let turn = heading_of(level.product(there.conjugate()));
            (turn, turn.product(there))
        }
        None => (Quaternion::IDENTITY, states[0].world_from_body),
    };
    Ok(Estimate {
        world_from_body: states.iter().map(|state| turn.product(state.world_from_body)).collect(),
        certainty: Certainty {
            sigma_tilt_rad: states.iter().map(|state| state.sigma_tilt_rad).collect(),
            sigma_heading_rad: states.iter().map(|state| state.sigma_heading_rad).collect(),
            rest: states.iter().map(|state| state.rest).collect(),
        },
        learnt,
        start,
    })
}

fn causal(
    acc: &[Vec3],
    rates: &[Vec3],
    dt_s: &[f64],
    settings: &estimator::Settings,
) -> Result<(Vec<State>, Calibration)> {
    let mut estimator = Estimator::new(settings)?;
    let states = acc
        .iter()
        .zip(rates)
        .zip(dt_s)
        .map(|((&acc_m_s2, &gyro_rad_s), &dt_s)| estimator.update(&Sample { gyro_rad_s, acc_m_s2, dt_s }))
        .collect();
    Ok((states, estimator.calibration()))
}

/// The turn about z in a rotation; none where it turns z upside down.
fn heading_of(q: Quaternion) -> Quaternion {
    let n = crate::math::hypot(q.w, q.z);
    if n < 1e-9 { Quaternion::IDENTITY } else { Quaternion::new(q.w / n, 0.0, 0.0, q.z / n) }
}
