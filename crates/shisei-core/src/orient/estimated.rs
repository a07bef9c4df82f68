//! The estimator over a whole recording, with the same start and reference as the classic filters.

use alloc::{vec, vec::Vec};
use core::ops::Range;

use super::{Certainty, Method, Settings};
use crate::error::Result;
use crate::estimator::{self, Calibration, Estimator, Pair, Sample, State, heading_between, smooth_each};
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

/// `bias` is taken off every rate before the smoother sees it; the online form is given the rates as they are, for no
/// sample may know of a later one. `level` is the attitude at the start with yaw 0 where there is a rest: the smoother's
/// world is turned about z so that the estimate there agrees with it; the online form's stays, as live.
pub(super) fn run(
    data: (&[Vec3], &[Vec3], &[f64]),
    settings: &Settings,
    bias: Vec3,
    rest: Option<(&Range<usize>, Quaternion)>,
    pair: &impl Pair,
) -> Result<Estimate> {
    let (acc, gyro, dt_s) = data;
    let estimator_settings = estimator::Settings {
        gravity_m_s2: settings.gravity_m_s2,
        calibration: settings.sensor,
        ..estimator::Settings::default()
    };
    let rows = acc.len();
    let mut world_from_body = vec![Quaternion::IDENTITY; rows];
    let mut certainty = Certainty {
        sigma_tilt_rad: vec![0.0; rows],
        sigma_heading_rad: vec![0.0; rows],
        rest: vec![false; rows],
    };
    let mut keep = |k: usize, state: &State| {
        world_from_body[k] = state.world_from_body;
        certainty.sigma_tilt_rad[k] = state.sigma_tilt_rad;
        certainty.sigma_heading_rad[k] = state.sigma_heading_rad;
        certainty.rest[k] = state.rest;
    };
    if settings.method == Method::EstimateOnline {
        let mut estimator = Estimator::new(&estimator_settings)?;
        for k in 0..rows {
            keep(k, &estimator.update(&Sample { gyro_rad_s: gyro[k], acc_m_s2: acc[k], dt_s: dt_s[k] }));
        }
        // at the end of the rest the bias is known
        let start = world_from_body[rest.map_or(0, |(rest, _)| rest.end - 1)];
        return Ok(Estimate { world_from_body, certainty, learnt: estimator.calibration(), start });
    }
    let mut learnt = smooth_each(acc, gyro, bias, Dt::PerSample(dt_s), &estimator_settings, pair, keep)?;
    learnt.gyro_bias_rad_s = vector::add(learnt.gyro_bias_rad_s, bias);
    let mut start = world_from_body[0];
    if let Some((rest, level)) = rest {
        let there = world_from_body[rest.start + rest.len() / 2];
        let turn = heading_between(level, there);
        start = turn.product(there);
        world_from_body.iter_mut().for_each(|q| *q = turn.product(*q));
    }
    Ok(Estimate { world_from_body, certainty, learnt, start })
}
