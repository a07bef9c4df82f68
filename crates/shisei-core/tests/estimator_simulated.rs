//! The estimator against simulated truth: consistency, rates and lost samples, garbage, gaps, calibration.

#![allow(clippy::disallowed_methods)] // the truth of a simulation may use std's mathematics

use shisei_core::estimator::{
    BridgeSettings, Calibration, Estimator, FixedLag, LightEstimator, OpticalPose, Sample, Settings, State,
    bridge, smooth,
};
use shisei_core::filter::Dt;
use shisei_core::{Quaternion, Vec3};
use shisei_twin::movements::wander;
use shisei_twin::random::Random;
use shisei_twin::sensor::Sensor;
use shisei_twin::simulate::{self, Simulation, simulate};

const REST_S: f64 = 3.0;

/// The LSM6DS3TR-C's noise and walks, with the errors that a calibration leaves.
fn sensor() -> Sensor {
    let mut sensor = Sensor::lsm6ds3tr_c();
    let acc = &mut sensor.accelerometer;
    (acc.bias_sigma, acc.scale_sigma, acc.misalignment_sigma) = (0.03, 0.003, 0.001);
    let gyro = &mut sensor.gyroscope;
    (gyro.bias_sigma, gyro.scale_sigma, gyro.misalignment_sigma) = (0.02, 0.005, 0.003);
    sensor
}

struct Run {
    samples: Vec<Sample>,
    truth: Vec<Quaternion>,
    simulation: Simulation,
}

fn run_of(seed: u64, rate_hz: f64, move_s: f64, jitter: f64, lost: f64) -> Run {
    let settings = simulate::Settings { jitter, lost, ..simulate::Settings::new(rate_hz, seed) };
    let simulation = simulate(&wander(seed, REST_S, move_s), &sensor(), &settings);
    let times = simulation.time_s();
    let samples = simulation
        .samples
        .iter()
        .enumerate()
        .map(|(k, sample)| Sample {
            gyro_rad_s: sample.gyro_rad_s,
            acc_m_s2: sample.acc_m_s2,
            dt_s: if k == 0 { 1.0 / rate_hz } else { times[k] - times[k - 1] },
        })
        .collect();
    let truth = simulation.truth.iter().map(|truth| truth.world_from_body).collect();
    Run { samples, truth, simulation }
}

fn online(samples: &[Sample], settings: &Settings) -> Vec<State> {
    let mut estimator = Estimator::new(settings).unwrap();
    samples.iter().map(|sample| estimator.update(sample)).collect()
}

fn offline(samples: &[Sample], settings: &Settings) -> Vec<State> {
    let (acc, gyro, dt) = columns(samples);
    smooth(&acc, &gyro, Dt::PerSample(&dt), settings).unwrap().states
}

fn columns(samples: &[Sample]) -> (Vec<Vec3>, Vec<Vec3>, Vec<f64>) {
    (
        samples.iter().map(|sample| sample.acc_m_s2).collect(),
        samples.iter().map(|sample| sample.gyro_rad_s).collect(),
        samples.iter().map(|sample| sample.dt_s).collect(),
    )
}

/// Earth-frame error of an attitude, rad. The gyroscope's samples stand for the steps before them, so the attitude
/// is half a step ahead of the readings' time.
fn error(state: &State, truth: Quaternion, ahead_s: f64) -> Vec3 {
    let turn = state.rate_rad_s.map(|rate| -rate * ahead_s);
    let q = state.world_from_body.product(Quaternion::from_rotation_vector(turn));
    truth.product(q.conjugate()).to_rotation_vector()
}

fn tilt_rms(states: &[State], truth: &[Quaternion], ahead_s: f64) -> f64 {
    let squares: Vec<f64> = states
        .iter()
        .zip(truth)
        .map(|(state, &truth)| {
            let e = error(state, truth, ahead_s);
            e[0] * e[0] + e[1] * e[1]
        })
        .collect();
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt().to_degrees()
}

#[test]
#[ignore = "prints figures"]
fn figures() {
    for rate in [50.0, 100.0, 286.0, 1000.0] {
        let mut sums = [0.0; 8];
        for seed in 0..10 {
            for (k, (jitter, lost)) in [(0.0, 0.0), (0.2, 0.05)].into_iter().enumerate() {
                let run = run_of(seed, rate, 60.0, jitter, lost);
                let mut settings = Settings::default();
                if let Ok(v) = std::env::var("BA") {
                    let v: f64 = v.parse().unwrap();
                    settings.quick.acc_bias_start = v;
                    settings.calm.acc_bias_start = v;
                    settings.quick.acc_scale_start = v / 10.0;
                    settings.calm.acc_scale_start = v / 10.0;
                    settings.quick.gyro_matrix_start = 0.02;
                    settings.calm.gyro_matrix_start = 0.02;
                    settings.quick.gyro_bias_start = 0.05;
                    settings.calm.gyro_bias_start = 0.05;
                    settings.level_sigma_rad = v / 9.8;
                }
                let ahead = 0.5 / rate;
                let on = online(&run.samples, &settings);
                let off = offline(&run.samples, &settings);
                let skip = (REST_S * rate) as usize;
                sums[k] += tilt_rms(&on[skip..], &run.truth[skip..], ahead);
                sums[2 + k] += tilt_rms(&off[skip..], &run.truth[skip..], ahead);
                for (place, states) in [(4 + k, &on), (6 + k, &off)] {
                    let mut nees = 0.0;
                    for (state, &truth) in states.iter().zip(&run.truth).skip(skip) {
                        let e = error(state, truth, ahead);
                        let c = &state.covariance_rad2;
                        let det = c[0][0] * c[1][1] - c[0][1] * c[1][0];
                        nees += (e[0] * e[0] * c[1][1] - 2.0 * e[0] * e[1] * c[0][1] + e[1] * e[1] * c[0][0])
                            / det;
                    }
                    sums[place] += nees / (states.len() - skip) as f64;
                }
            }
        }
        println!("{rate} Hz: {:.3?}", sums.map(|sum| sum / 10.0));
    }
}

#[test]
fn streams_and_series_give_the_same_bits() {
    let run = run_of(1, 100.0, 20.0, 0.2, 0.05);
    let settings = Settings::default();
    let stream = online(&run.samples, &settings);
    let (acc, gyro, dt) = columns(&run.samples);
    let mut estimator = Estimator::new(&settings).unwrap();
    let series: Vec<Quaternion> =
        shisei_core::filter::run(&mut estimator, &gyro, &acc, Dt::PerSample(&dt)).unwrap();
    assert!(stream.iter().zip(&series).all(|(state, &q)| state.world_from_body == q));
    let mut lagged = Vec::new();
    let mut lag = FixedLag::new(&settings, 1.0).unwrap();
    for sample in &run.samples {
        lag.update(sample, &mut lagged);
    }
    lag.finish(&mut lagged);
    assert_eq!(lagged.len(), stream.len());
}

/// Garbage of one kind.
fn garbage(kind: usize, random: &mut Random, good: &Sample) -> Sample {
    let mut bad = *good;
    match kind {
        0 => bad.gyro_rad_s = random.normal3(30.0),
        1 => bad.acc_m_s2 = random.normal3(80.0),
        2 => {
            bad.gyro_rad_s = [1e30, -1e30, 1e308];
            bad.acc_m_s2 = [f64::NAN, f64::INFINITY, -1e300];
        }
        3 => bad.gyro_rad_s = good.gyro_rad_s.map(|x| if x < 0.0 { -34.9 } else { 34.9 }),
        4 => bad.acc_m_s2 = good.acc_m_s2.map(|x| if x < 0.0 { -157.0 } else { 157.0 }),
        5 => bad.dt_s = if random.uniform() < 0.5 { f64::NAN } else { 10.0 * random.uniform() },
        6 => {
            bad.gyro_rad_s = [3.0, 1.0, -2.0];
            bad.acc_m_s2 = [2.0, -9.0, 3.0];
        }
        7 => {
            bad.gyro_rad_s = [0.0; 3];
            bad.acc_m_s2 = [0.0; 3];
        }
        8 => {
            bad.gyro_rad_s = random.normal3(0.5);
            bad.acc_m_s2 = random.normal3(5.0);
        }
        _ => {
            bad.gyro_rad_s = good.gyro_rad_s.map(|x| if random.uniform() < 0.3 { 1e30 } else { x });
            bad.acc_m_s2 = good.acc_m_s2.map(|x| if random.uniform() < 0.3 { f64::NAN } else { x });
        }
    }
    bad
}

fn all_finite(state: &State) -> bool {
    state.world_from_body.is_finite()
        && state.rate_rad_s.iter().chain(&state.gyro_bias_rad_s).all(|x| x.is_finite())
        && state.covariance_rad2.iter().flatten().all(|x| x.is_finite())
        && state.sigma_tilt_rad.is_finite()
        && state.sigma_heading_rad.is_finite()
}

/// An hour of garbage in all, in pieces of every kind; ten seconds after each the tilt is right again.
#[test]
fn garbage_never_makes_nan_and_is_recovered_from() {
    const KINDS: usize = 10;
    let rate = 50.0;
    for kind in 0..KINDS {
        for (round, garbage_s) in [5.0, 60.0, 295.0].into_iter().enumerate() {
            let seed = (kind * 3 + round) as u64;
            let run = run_of(seed, rate, 20.0 + garbage_s + 20.0, 0.0, 0.0);
            let mut random = Random::new(seed, 5);
            let (from, to) = ((20.0 * rate) as usize, ((20.0 + garbage_s) * rate) as usize);
            let samples: Vec<Sample> = run
                .samples
                .iter()
                .enumerate()
                .map(|(k, s)| if (from..to).contains(&k) { garbage(kind, &mut random, s) } else { *s })
                .collect();
            let on = online(&samples, &Settings::default());
            let off = offline(&samples, &Settings::default());
            let mut light = LightEstimator::new(&Settings::default()).unwrap();
            let light: Vec<State> = samples.iter().map(|sample| light.update(sample)).collect();
            for (name, states, limit) in
                [("online", &on, 3.0), ("smoother", &off, 3.0), ("light", &light, 5.0)]
            {
                assert!(states.iter().all(all_finite), "{name}, kind {kind}");
                let after = to + (10.0 * rate) as usize;
                let rms = tilt_rms(&states[after..], &run.truth[after..], 0.5 / rate);
                if std::env::var("SHOW").is_ok() {
                    println!("{name} kind {kind} {garbage_s} s: {rms:.2}");
                } else {
                    assert!(rms < limit, "{name}, kind {kind}, {garbage_s} s: {rms}°");
                }
            }
        }
    }
}
