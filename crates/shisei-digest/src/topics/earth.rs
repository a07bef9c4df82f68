//! The Earth's rotation from directions; walking with the sensor on a foot.

use alloc::vec::Vec;

use shisei_core::earth::analysis::{self, Analysis};
use shisei_core::earth::direction::{self, Direction};
use shisei_core::earth::fits::{self, Measured, RateFit};
use shisei_core::earth::{Weights, advice};
use shisei_core::filter::Dt;
use shisei_core::motion::foot::{self as walking, FootSettings};
use shisei_core::{Vec3, vector};

use super::navigation::push_track;
use crate::hash::Digest;
use crate::input::{Input, Recording, recording};

/// Upright and inverted at latitude 35.7°, eight headings, with a bias and some noise.
fn directions() -> Vec<Direction> {
    let mut input = Input::new(80);
    let (north, up) = (5.9219e-5, 4.2552e-5);
    [(1.0, 0.0), (0.6, 0.8), (0.0, 1.0), (-0.8, 0.6), (-1.0, 0.0), (-0.6, -0.8), (0.0, -1.0), (0.8, -0.6)]
        .into_iter()
        .enumerate()
        .map(|(k, (c, s))| {
            let side = if k % 2 == 0 { 1.0 } else { -1.0 };
            let rate = [1e-4 + north * c, -2e-4 + side * north * s, 3e-5 + side * up];
            Direction {
                gyro_rad_s: vector::add(rate, input.vec3(1e-6)),
                sigma_rad_s: Some([1e-6; 3]),
                acc_m_s2: Some([0.01, 0.02, side * 9.8]),
                heading_rad: Some(0.785 * k as f64),
            }
        })
        .collect()
}

fn push_measured(digest: &mut Digest, measured: Option<Measured>) {
    let m = measured.unwrap_or(Measured { value: -1.0, sigma: -1.0 });
    digest.push_all(&[m.value, m.sigma]);
}

fn push_fit(digest: &mut Digest, fit: &RateFit) {
    digest.push_vec3(fit.bias_rad_s);
    digest.push_vec3(fit.bias_sigma_rad_s);
    push_measured(digest, fit.rate);
    push_measured(digest, fit.horizontal);
    push_measured(digest, fit.latitude);
    digest.push_all(&fit.residuals);
}

pub fn direction(digest: &mut Digest) {
    let summaries: Vec<_> = [81, 82]
        .into_iter()
        .filter_map(|seed| {
            let Recording { gyro_rad_s, acc_m_s2, dt_s } = recording(seed, 400);
            let warming: Vec<f64> = (0..400).map(|k| 20.0 + 0.01 * f64::from(k)).collect();
            let found = direction::summarise(&gyro_rad_s, &acc_m_s2, &warming, &dt_s, Weights::Capped);
            digest.push_result(found.clone(), |digest, found| {
                digest.push_vec3(found.direction.gyro_rad_s);
                digest.push_vec3(found.direction.sigma_rad_s.unwrap_or_default());
                for (time, rate, temperature) in found.blocks {
                    digest.push(time);
                    digest.push_vec3(rate);
                    digest.push(temperature);
                }
            });
            found.ok()
        })
        .collect();
    if let Some(drift) = direction::drift(&summaries) {
        digest.push_vec3(drift.per_s);
        digest.push_vec3(drift.per_s_sigma);
        let (value, sigma) = drift.per_c.unwrap_or_default();
        digest.push_vec3(value);
        digest.push_vec3(sigma);
    }
}

pub fn all_fits(digest: &mut Digest) {
    let all = directions();
    let up: Vec3 = [0.0, 0.0, 1.0];
    digest.push_result(fits::fit_sphere(&all), |digest, fit| push_fit(digest, &fit));
    digest.push_result(fits::fit_circle(&all, up), |digest, fit| push_fit(digest, &fit));
    for latitude in [None, Some(0.623)] {
        digest.push_result(fits::fit_levelled(&all, latitude), |digest, fit| push_fit(digest, &fit));
    }
    digest.push_result(fits::fit_headings(&all, up), |digest, fit| {
        push_measured(digest, Some(fit.horizontal));
        push_measured(digest, Some(fit.north));
        digest.push_all(&[fit.clockwise_cost, fit.counter_clockwise_cost, fit.sense_probability]);
    });
}

fn push_analysis(digest: &mut Digest, found: &Analysis) {
    push_measured(digest, found.rate);
    push_measured(digest, found.horizontal);
    push_measured(digest, found.latitude);
    push_measured(digest, found.day_h);
    digest.push_all(&[found.plane.condition, found.plane.probability.unwrap_or(-1.0)]);
    for heading in &found.headings {
        push_measured(digest, Some(heading.heading_rad));
    }
}

pub fn analyse(digest: &mut Digest) {
    let all = directions();
    for latitude in [None, Some(0.623)] {
        digest.push_result(analysis::analyse(&all, latitude), |digest, found| push_analysis(digest, &found));
    }
    digest.push_result(analysis::analyse(&all[..2], None), |digest, found| push_analysis(digest, &found));
}

pub fn advise(digest: &mut Digest) {
    let all = directions();
    digest.push_result(analysis::analyse(&all, None), |digest, found| {
        for s in advice::suggest(&all, &found, None, 2) {
            digest.push_all(&[f64::from(s.face.axis), s.heading_rad, s.expected_sigma_rad_s]);
        }
    });
}

pub fn foot(digest: &mut Digest) {
    // a rest and the beginning of a movement
    let Recording { gyro_rad_s, acc_m_s2, dt_s } = recording(83, 260);
    let settings = FootSettings::default();
    let dt = Dt::PerSample(&dt_s);
    for standing in walking::stances(&acc_m_s2, &gyro_rad_s, dt, &settings) {
        digest.push_u64(u64::from(standing));
    }
    let found = walking::foot(&acc_m_s2, &gyro_rad_s, dt, &settings);
    digest.push_result(found, |digest, track| push_track(digest, &track));
}
