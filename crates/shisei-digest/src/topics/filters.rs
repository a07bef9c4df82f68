//! Orientation filters: sample by sample with the real steps, and as a series with the same step.

use alloc::vec::Vec;

use shisei_core::filter::{
    AdaptiveGain, Complementary, Dt, Filter, GyroIntegrator, GyroOnly, GyroRk4, Mahony, MahonyAdaptive,
    Readings, exponential, run, run_gyro, run_many_into,
};
use shisei_core::{Quaternion, Result, STANDARD_GRAVITY_M_S2, Ypr};

use crate::hash::Digest;
use crate::input::{Input, Recording, recording};

const ROWS: usize = 1024;

pub fn exponential(digest: &mut Digest) {
    let mut input = Input::new(10);
    for _ in 0..256 {
        // both sides of the polynomial's limit
        let (cos, sinc) = exponential::cos_sinc(exponential::POLYNOMIAL_LIMIT * (1.0 + input.signed()));
        digest.push_all(&[cos, sinc]);
        digest.push_quaternion(exponential::exp_half(input.vec3(0.6)));
    }
}

pub fn gyro(digest: &mut Digest) {
    let start = Input::new(11).quaternion();
    integrator(digest, || GyroIntegrator::new(start));
    integrator(digest, || GyroRk4::new(start));
}

pub fn mahony(digest: &mut Digest) {
    let start = Input::new(12).quaternion();
    for (kp, ki) in [(2.0, 0.0), (0.2, 0.01)] {
        filter(digest, || Mahony::new(start, kp, ki));
    }
    digest.push_result(Mahony::new(start, -1.0, 0.0).map(|_| ()), |_, ()| ());
}

/// Recordings of unequal lengths side by side.
pub fn mahony_lanes(digest: &mut Digest) {
    let start = Input::new(15).quaternion();
    let Recording { gyro_rad_s, acc_m_s2, dt_s } = recording(22, 150);
    let mut rows = [[Quaternion::IDENTITY; 100]; 4];
    let made: Result<Vec<Readings<'_, Quaternion>>> = rows
        .iter_mut()
        .enumerate()
        .map(|(i, out)| {
            let part = 10 * i..10 * i + 100 - 7 * i;
            Ok(Readings {
                filter: Mahony::new(start, 0.5 * i as f64, if i == 2 { 0.01 } else { 0.0 })?,
                gyro_rad_s: &gyro_rad_s[part.clone()],
                acc_m_s2: &acc_m_s2[part.clone()],
                dt: Dt::PerSample(&dt_s[part.clone()]),
                out: &mut out[..part.len()],
            })
        })
        .collect();
    let done = made.and_then(|mut readings| run_many_into(&mut readings).map_err(|(_, error)| error));
    digest
        .push_result(done, |digest, ()| rows.as_flattened().iter().for_each(|&q| digest.push_quaternion(q)));
}

pub fn mahony_adaptive(digest: &mut Digest) {
    let start = Input::new(13).quaternion();
    let gain = AdaptiveGain {
        kp_max: 2.0,
        kp_min: 0.05,
        upper_start: 10.3,
        upper_end: 14.7,
        lower_start: 9.3,
        lower_end: 4.9,
    };
    for norm in [0.0, 4.9, 7.0, 9.3, 9.8, 10.3, 12.0, 14.7, 20.0] {
        digest.push_result(gain.kp(norm, 9.81), Digest::push);
    }
    for ki in [0.0, 0.01] {
        filter(digest, || MahonyAdaptive::new(start, gain, ki, STANDARD_GRAVITY_M_S2));
    }
}

pub fn complementary(digest: &mut Digest) {
    let start = Input::new(14).quaternion();
    for alpha in [0.98, 0.5] {
        filter(digest, || Complementary::new(start, alpha, STANDARD_GRAVITY_M_S2));
    }
}

/// A filter over a recording, with samples that it cannot use among the others.
fn filter<F: Filter>(digest: &mut Digest, make: impl Fn() -> Result<F>) {
    let Recording { gyro_rad_s, acc_m_s2, dt_s } = recording(20, ROWS);
    digest.push_result(make(), |digest, mut filter| {
        for (row, (&gyro, (&acc, &dt))) in gyro_rad_s.iter().zip(acc_m_s2.iter().zip(&dt_s)).enumerate() {
            let acc = if row % 100 == 99 { [0.0; 3] } else { acc };
            let dt = if row % 300 == 299 { f64::NAN } else { dt };
            digest.push_quaternion(filter.update(gyro, acc, dt));
        }
        digest.push_quaternion(filter.orientation());
    });
    digest.push_result(make(), |digest, mut filter| {
        let series = run::<_, Ypr>(&mut filter, &gyro_rad_s, &acc_m_s2, Dt::Constant(0.01));
        digest.push_result(series, |digest, rows| rows.into_iter().for_each(|ypr| digest.push_ypr(ypr)));
    });
}

/// A filter that takes rates only.
fn integrator<F: Filter + GyroOnly>(digest: &mut Digest, make: impl Fn() -> Result<F>) {
    filter(digest, &make);
    let Recording { gyro_rad_s, dt_s, .. } = recording(21, ROWS);
    digest.push_result(make(), |digest, mut filter| {
        let series = run_gyro::<_, Quaternion>(&mut filter, &gyro_rad_s, Dt::PerSample(&dt_s));
        digest.push_result(series, |digest, rows| rows.into_iter().for_each(|q| digest.push_quaternion(q)));
    });
}
