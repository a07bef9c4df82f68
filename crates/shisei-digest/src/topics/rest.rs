//! Rests and where an attitude starts.

use shisei_core::filter::Dt;
use shisei_core::rest::{self, RestSettings};
use shisei_core::{STANDARD_GRAVITY_M_S2, initial};

use crate::hash::Digest;
use crate::input::{Input, recording};

pub fn rest(digest: &mut Digest) {
    let made = recording(30, 1024);
    for acc in made.acc_m_s2.chunks(100) {
        digest.push_result(rest::mean(acc), Digest::push_vec3);
        digest.push_result(rest::variance(acc), Digest::push_vec3);
        digest.push_result(rest::mean_norm(acc), Digest::push);
        digest.push_result(rest::is_stable(acc, 0.01, 9.0, 10.0), |digest, stable| {
            digest.push_u64(u64::from(stable));
        });
    }
    for gyro in made.gyro_rad_s.chunks(60) {
        digest.push_result(rest::gyro_bias(gyro), Digest::push_vec3);
    }
    digest.push_result(rest::mean(&[]), Digest::push_vec3);
}

pub fn search(digest: &mut Digest) {
    let made = recording(31, 2048);
    let settings = RestSettings::default();
    for dt in [Dt::Constant(0.01), Dt::PerSample(&made.dt_s)] {
        let (acc, gyro) = (&made.acc_m_s2, &made.gyro_rad_s);
        let found = rest::find_rests(acc, gyro, dt, &settings);
        digest.push_result(found, |digest, rests| {
            for range in rests {
                digest.push_u64(range.start as u64);
                digest.push_u64(range.end as u64);
            }
        });
        let first = rest::first_rest(acc, gyro, dt, &settings);
        digest.push_result(first, |digest, range| digest.push_u64(range.end as u64));
    }
}

pub fn initial(digest: &mut Digest) {
    let mut input = Input::new(32);
    for _ in 0..128 {
        digest.push_result(initial::from_mean_acceleration(input.vec3(10.0)), Digest::push_quaternion);
    }
    let acc = recording(33, 512).acc_m_s2;
    for rows in [&acc[..192], &acc[..]] {
        let g = STANDARD_GRAVITY_M_S2;
        let start = initial::from_stable_window(rows, 0.01, g - 0.5, g + 0.5);
        digest.push_result(start, Digest::push_quaternion);
    }
}
