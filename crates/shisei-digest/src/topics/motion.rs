//! Whole recordings, dead reckoning, Earth's rotation.

use shisei_core::STANDARD_GRAVITY_M_S2;
use shisei_core::earth::{self, WeightedMean, Weights};
use shisei_core::filter::{AdaptiveGain, Dt};
use shisei_core::motion::{DeadReckoning, MotionState, Scheme};
use shisei_core::orient::{self, Method, Orientation, Relative, RestChoice, Settings};

use crate::hash::Digest;
use crate::input::{Input, Recording, recording};

pub fn orient(digest: &mut Digest) {
    let Recording { gyro_rad_s, acc_m_s2, mut dt_s } = recording(60, 1024);
    dt_s[700] = 2.0;
    let methods = [
        Method::Gyro,
        Method::GyroRk4,
        Method::Mahony { kp: 0.2, ki: 0.01 },
        Method::MahonyAdaptive { gain: AdaptiveGain::default(), ki: 0.0 },
        Method::Complementary { alpha: 0.98 },
    ];
    for (i, method) in methods.into_iter().enumerate() {
        let rest = [RestChoice::Auto, RestChoice::Rows { start: 10, end: 100 }, RestChoice::None][i % 3];
        let relative = [Relative::World, Relative::Body, Relative::None][i % 3];
        let forward_axis_body = (i % 2 == 0).then_some([1.0, 0.2, 0.0]);
        let settings = Settings { method, rest, relative, forward_axis_body, ..Settings::default() };
        let found = orient::orient(&acc_m_s2, &gyro_rad_s, &dt_s, &settings);
        digest.push_result(found, |digest, found| push_orientation(digest, &found));
    }
    let times = [0.0, 0.1, 0.2, 0.3];
    digest.push_u64(orient::rows_between(&times, 0.1, 0.2).len() as u64);
}

fn push_orientation(digest: &mut Digest, found: &Orientation) {
    digest.push_quaternion(found.start);
    digest.push_vec3(found.gyro_bias_rad_s);
    for (k, q) in found.world_from_body.iter().enumerate() {
        digest.push_quaternion(*q);
        digest.push_ypr(found.ypr(k));
    }
}

pub fn dead_reckoning(digest: &mut Digest) {
    let Recording { gyro_rad_s, acc_m_s2, dt_s } = recording(61, 512);
    for scheme in [Scheme::SemiImplicit, Scheme::Euler, Scheme::Trapezoid] {
        let start = Input::new(62).quaternion();
        let made = DeadReckoning::new(start, [0.001, -0.002, 0.0], STANDARD_GRAVITY_M_S2, scheme);
        digest.push_result(made, |digest, mut motion| {
            for row in 0..384 {
                push_state(digest, motion.update(gyro_rad_s[row], acc_m_s2[row], dt_s[row]));
            }
            motion.stop();
            let mut out = [motion.state(); 128];
            let dt = Dt::PerSample(&dt_s[384..]);
            let done = motion.run_into(&gyro_rad_s[384..], &acc_m_s2[384..], dt, &mut out);
            digest
                .push_result(done, |digest, ()| out.into_iter().for_each(|state| push_state(digest, state)));
        });
    }
}

fn push_state(digest: &mut Digest, state: MotionState) {
    digest.push_quaternion(state.world_from_body);
    digest.push_vec3(state.velocity_m_s);
    digest.push_vec3(state.position_m);
}

pub fn earth(digest: &mut Digest) {
    let ticks = [u32::MAX - 5, 3, 10_003, 20_001, 90_000];
    earth::tick_steps(&ticks).for_each(|step| digest.push_u64(u64::from(step)));
    for rate in [7.657_707e-5, 7.292_115e-5, 0.0] {
        digest.push_result(earth::sidereal_day_s(rate), Digest::push);
    }
}

pub fn earth_mean(digest: &mut Digest) {
    let Recording { gyro_rad_s, mut dt_s, .. } = recording(63, 400);
    dt_s[300] = 1.0;
    let mut tick: u32 = u32::MAX - 1_000_000;
    let ticks: [u32; 400] = core::array::from_fn(|row| {
        tick = tick.wrapping_add(9_990 + (row as u32 * 7) % 23);
        tick
    });
    for weights in [Weights::Capped, Weights::AsMeasured] {
        digest.push_result(earth::mean_by_steps(&gyro_rad_s, &dt_s, weights), push_mean);
        let by_ticks = earth::mean_by_ticks(&gyro_rad_s, &ticks, earth::SPRESENSE_TICK_HZ, weights);
        digest.push_result(by_ticks, push_mean);
    }
}

fn push_mean(digest: &mut Digest, found: WeightedMean) {
    digest.push_vec3(found.mean_rad_s);
    digest.push_all(&[found.weight_s, found.span_s, found.median_step_s]);
    digest.push_u64(found.long_steps as u64);
}
