//! Clocks and pulses.

use shisei_core::clock::{
    ClockFit, Frame, Pair, Pulse, PulseTrain, Settings, arrival_frame, map_between, unwrap_near,
};

use crate::hash::Digest;
use crate::input::Input;

fn pairs(seed: u64) -> [Pair; 400] {
    let mut input = Input::new(seed);
    core::array::from_fn(|k| {
        let time_s = 0.03 * k as f64;
        Pair {
            remote_s: time_s * 1.00004 + 2e-5 * input.signed(),
            local_s: 7.0 + time_s + 2e-5 * input.signed(),
        }
    })
}

pub fn fit(digest: &mut Digest) {
    let pairs = pairs(60);
    let mut fit = ClockFit::new(Settings::default());
    for pair in pairs {
        digest.push_u64(fit.push(pair) as u64);
        digest.push(fit.skew());
        digest.push(fit.map(pair.remote_s + 0.01).unwrap_or(f64::NAN));
        digest.push(fit.residual_s().unwrap_or(f64::NAN));
    }
    for k in 0..100 {
        let at = 0.11 * f64::from(k);
        digest.push(map_between(&pairs, at, &Settings::default()).unwrap_or(f64::NAN));
    }
}

pub fn frames(digest: &mut Digest) {
    let mut input = Input::new(61);
    let mut train = PulseTrain::<50>::default();
    for count in 0..300 {
        let time_s = 0.01 * f64::from(count) + 1e-4 * input.signed() + if count > 200 { 5.0 } else { 0.0 };
        digest.push_u64(u64::from(train.push(Pulse { time_s, count })));
        let at = time_s + 0.1 * input.signed();
        match train.frame(at) {
            Frame::At(frame) => digest.push(frame),
            Frame::NotYet => digest.push_u64(1),
            Frame::Outside => digest.push_u64(2),
        }
        digest.push_u64(arrival_frame(train.pulses(), at).map_or(u64::MAX, u64::from));
    }
}

pub fn unwrap(digest: &mut Digest) {
    let mut value = 0;
    for k in 0..1000_u32 {
        value = unwrap_near(k.wrapping_mul(20_011), 16, value);
        digest.push_u64(value.cast_unsigned());
    }
}
