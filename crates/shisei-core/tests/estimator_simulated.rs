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
    run_with(&sensor(), seed, rate_hz, move_s, jitter, lost)
}

fn run_with(sensor: &Sensor, seed: u64, rate_hz: f64, move_s: f64, jitter: f64, lost: f64) -> Run {
    let settings = simulate::Settings { jitter, lost, ..simulate::Settings::new(rate_hz, seed) };
    let simulation = simulate(&wander(seed, REST_S, move_s), sensor, &settings);
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

/// The truth in a world whose yaw is that of the state of row k.
fn aligned(truth: &[Quaternion], states: &[State], k: usize) -> Vec<Quaternion> {
    let d = states[k].world_from_body.product(truth[k].conjugate());
    let turn = Quaternion::new(d.w, 0.0, 0.0, d.z).normalized();
    truth.iter().map(|&q| turn.product(q)).collect()
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

/// Normalised squared errors of tilt (two degrees of freedom) and heading (one), mean over the moving part, and the
/// share of the samples within the 95 % bound of tilt.
fn consistency(states: &[State], truth: &[Quaternion], from: usize, ahead_s: f64) -> (f64, f64, f64) {
    let aligned = aligned(truth, states, from / 2);
    let (mut tilt, mut heading, mut within) = (0.0, 0.0, 0.0);
    for (state, &truth) in states.iter().zip(&aligned).skip(from) {
        let e = error(state, truth, ahead_s);
        let c = &state.covariance_rad2;
        let det = c[0][0] * c[1][1] - c[0][1] * c[1][0];
        let square = (e[0] * e[0] * c[1][1] - 2.0 * e[0] * e[1] * c[0][1] + e[1] * e[1] * c[0][0]) / det;
        tilt += square;
        heading += e[2] * e[2] / c[2][2];
        // 95 % of χ² with two degrees of freedom: −2 ln 0.05
        within += f64::from(square <= 5.991);
    }
    let n = (states.len() - from) as f64;
    (tilt / n, heading / n, within / n)
}

/// A sensor whose errors are as large as the default settings say: biases, gyroscope matrix and noise drawn with the
/// filters' start values and walks (where the two filters differ, between them).
fn sensor_of_the_settings() -> Sensor {
    let Settings { quick, calm, .. } = Settings::default();
    let mut sensor = Sensor::lsm6ds3tr_c();
    let acc = &mut sensor.accelerometer;
    let between = (quick.acc_bias_start * calm.acc_bias_start).sqrt();
    (acc.bias_sigma, acc.scale_sigma, acc.misalignment_sigma) = (between, quick.acc_scale_start, 0.0);
    acc.bias_walk = calm.acc_bias_walk;
    let gyro = &mut sensor.gyroscope;
    (gyro.bias_sigma, gyro.bias_walk) = (calm.gyro_bias_start, calm.gyro_bias_walk);
    (gyro.scale_sigma, gyro.misalignment_sigma) = (quick.gyro_matrix_start, quick.gyro_matrix_start);
    gyro.noise_density = calm.heading_noise;
    sensor
}

const RUNS: u64 = 60;
/// 2.5 % and 97.5 % quantiles of χ² with 2·60 and with 60 degrees of freedom (SciPy, stats.chi2.ppf), over 60: where
/// the mean of 60 runs must lie if each counts as one independent error, for along a run errors change slowly.
const TILT_BAND: [f64; 2] = [91.573 / 60.0, 152.211 / 60.0];
const HEADING_BAND: [f64; 2] = [40.482 / 60.0, 83.298 / 60.0];

/// Means of [`consistency`] over runs: live, and smoothed.
fn mean_consistency(sensor: &Sensor, runs: u64) -> [[f64; 3]; 2] {
    let mut means = [[0.0; 3]; 2];
    for seed in 0..runs {
        let run = run_with(sensor, seed, 100.0, 60.0, 0.0, 0.0);
        let settings = Settings::default();
        let both = [online(&run.samples, &settings), offline(&run.samples, &settings)];
        for (mean, states) in means.iter_mut().zip(&both) {
            let (tilt, heading, within) = consistency(states, &run.truth, 300, 0.005);
            for (mean, value) in mean.iter_mut().zip([tilt, heading, within]) {
                *mean += value / runs as f64;
            }
        }
    }
    means
}

#[test]
fn stated_uncertainty_is_that_of_a_sensor_as_the_settings_say() {
    for (name, mean) in
        ["online", "smoother"].into_iter().zip(mean_consistency(&sensor_of_the_settings(), RUNS))
    {
        let [tilt, heading, within] = mean;
        println!(
            "{name}: tilt {tilt:.2} (95 %: {TILT_BAND:.2?}), heading {heading:.2} ({HEADING_BAND:.2?}), {within:.2}"
        );
        assert!((TILT_BAND[0]..TILT_BAND[1]).contains(&tilt), "{name}: tilt {tilt}");
        assert!((HEADING_BAND[0]..HEADING_BAND[1]).contains(&heading), "{name}: heading {heading}");
    }
}

#[test]
fn stated_uncertainty_of_a_calibrated_sensor_is_on_the_safe_side() {
    for (name, mean) in ["online", "smoother"].into_iter().zip(mean_consistency(&sensor(), 12)) {
        let [tilt, heading, within] = mean;
        println!("{name}: tilt {tilt:.2} of 2, heading {heading:.2} of 1, within the 95 % bound {within:.3}");
        assert!((0.2..2.0).contains(&tilt) && (0.05..1.0).contains(&heading) && within >= 0.95, "{name}");
    }
}

#[test]
fn rates_jitter_and_lost_samples_cost_little() {
    for rate in [50.0, 100.0, 286.0, 1000.0] {
        let mut sums = [0.0; 4];
        for seed in 0..6 {
            for (k, (jitter, lost)) in [(0.0, 0.0), (0.2, 0.05)].into_iter().enumerate() {
                let run = run_of(seed, rate, 40.0, jitter, lost);
                let settings = Settings::default();
                let skip = (REST_S * rate) as usize;
                for (place, states) in
                    [(k, online(&run.samples, &settings)), (2 + k, offline(&run.samples, &settings))]
                {
                    sums[place] += tilt_rms(&states[skip..], &run.truth[skip..], 0.5 / rate) / 6.0;
                }
            }
        }
        let [clean, rough, smooth_clean, smooth_rough] = sums;
        println!(
            "{rate} Hz: online {clean:.3}° → {rough:.3}°, smoother {smooth_clean:.3}° → {smooth_rough:.3}°"
        );
        assert!(rough <= 1.15 * clean && smooth_rough <= 1.15 * smooth_clean, "{rate} Hz: {sums:?}");
        assert!(clean < 0.6 && smooth_clean < 0.4, "{rate} Hz: {sums:?}");
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
                assert!(rms < limit, "{name}, kind {kind}, {garbage_s} s: {rms}°");
            }
        }
    }
}

/// After a gap the tilt is found anew, the heading is kept, and its stated uncertainty has grown with the gap.
#[test]
fn a_gap_grows_the_uncertainty_of_the_heading() {
    for (gap_s, at_least) in [(0.6, 0.2), (2.0, 0.8), (5.0, 2.0)] {
        let mut run = run_of(3, 100.0, 40.0, 0.0, 0.0);
        let cut = 2000..2000 + (gap_s * 100.0) as usize;
        run.samples.drain(cut.clone());
        run.truth.drain(cut);
        run.samples[2000].dt_s = gap_s + 0.01;
        for states in
            [online(&run.samples, &Settings::default()), offline(&run.samples, &Settings::default())]
        {
            let (before, after) = (states[1990].sigma_heading_rad, states[2100].sigma_heading_rad);
            assert!(before < 0.1, "{before}");
            assert!(after > at_least && after < 3.2, "gap {gap_s} s: {before} to {after}");
            let rms = tilt_rms(&states[3000..], &run.truth[3000..], 0.005);
            assert!(rms < 1.0, "{rms}");
        }
    }
}

/// Starts in the middle of the movement: no rest to level or to learn from.
#[test]
fn starts_in_motion() {
    for seed in 0..6 {
        let run = run_of(seed, 100.0, 60.0, 0.0, 0.0);
        let (samples, truth) = (&run.samples[1000..6000], &run.truth[1000..6000]);
        for states in [online(samples, &Settings::default()), offline(samples, &Settings::default())] {
            let rms = tilt_rms(&states[1500..], &truth[1500..], 0.005);
            assert!(rms < 1.0, "seed {seed}: {rms}");
        }
    }
}

/// What was learnt in one recording makes the next one better, and survives being stored.
#[test]
fn a_stored_calibration_helps() {
    let (mut without, mut with) = (0.0, 0.0);
    for seed in 0..6 {
        let first = run_of(seed, 100.0, 60.0, 0.0, 0.0);
        let mut estimator = Estimator::new(&Settings::default()).unwrap();
        for sample in &first.samples {
            estimator.update(sample);
        }
        let learnt = estimator.calibration();
        assert_eq!(learnt.check(), Ok(()));
        // the same sensor, another movement: the simulated errors depend on the seed, the readings on the truth
        let errors = simulate::Errors::Given(first.simulation.calibration);
        let settings = simulate::Settings { errors, ..simulate::Settings::new(100.0, seed + 100) };
        let simulation = simulate(&wander(seed + 50, REST_S, 40.0), &sensor(), &settings);
        let samples: Vec<Sample> = simulation
            .samples
            .iter()
            .map(|s| Sample { gyro_rad_s: s.gyro_rad_s, acc_m_s2: s.acc_m_s2, dt_s: 0.01 })
            .collect();
        let truth: Vec<Quaternion> = simulation.truth.iter().map(|t| t.world_from_body).collect();
        let known = Settings { calibration: Some(learnt), ..Settings::default() };
        without += tilt_rms(&online(&samples, &Settings::default())[300..], &truth[300..], 0.005);
        with += tilt_rms(&online(&samples, &known)[300..], &truth[300..], 0.005);
    }
    println!("tilt without {:.3}°, with a stored calibration {:.3}°", without / 6.0, with / 6.0);
    assert!(with < 0.9 * without, "{without} {with}");
    let broken =
        Calibration::with_sigmas(([0.0; 3], [[2.0; 3]; 3]), ([0.0; 3], [[1.0; 3]; 3]), 1.0, 1.0, 1.0, 1.0);
    assert!(Estimator::new(&Settings { calibration: Some(broken), ..Settings::default() }).is_err());
}

/// Optical gaps of 1 and 5 s, after 20 s in which the sensor was learnt: it carries attitude and position across.
#[test]
fn optical_gaps_are_bridged() {
    for (gap_s, limit_deg, limit_m) in [(1.0, 0.4, 0.01), (5.0, 0.5, 0.1)] {
        let run = run_of(7, 100.0, 60.0, 0.0, 0.0);
        let mut random = Random::new(7, 9);
        let poses: Vec<Option<OpticalPose>> = (0..run.samples.len())
            .map(|k| {
                let truth = &run.simulation.truth[k];
                let jitter = Quaternion::from_rotation_vector(random.normal3(0.003));
                let noise = random.normal3(0.001);
                // The optical attitude of the readings' convention: half a step ahead.
                let ahead = run.samples[k].gyro_rad_s.map(|rate| rate * 0.005);
                let q = truth.world_from_body.product(Quaternion::from_rotation_vector(ahead));
                let position = truth.position_m;
                let pose = OpticalPose {
                    world_from_body: jitter.product(q),
                    position_m: [position[0] + noise[0], position[1] + noise[1], position[2] + noise[2]],
                };
                let hidden = (k as f64 * 0.01) % (gap_s + 3.0) >= 3.0;
                (!hidden).then_some(pose)
            })
            .collect();
        let (acc, gyro, dt) = columns(&run.samples);
        let (optics, settings) = (BridgeSettings::default(), Settings::default());
        let (rows, _) = bridge(&acc, &gyro, Dt::PerSample(&dt), &poses, &optics, &settings).unwrap();
        let (mut angle, mut place, mut count) = (0.0, 0.0, 0.0);
        for (k, row) in rows.iter().enumerate().skip(2000).filter(|(k, _)| poses[*k].is_none()) {
            let e = error(&row.state, run.truth[k], 0.005);
            let p = run.simulation.truth[k].position_m;
            let off = [0, 1, 2].map(|j| row.position_m[j] - p[j]);
            angle += e.iter().map(|x| x * x).sum::<f64>();
            place += off.iter().map(|x| x * x).sum::<f64>();
            count += 1.0;
        }
        let (angle, place) = ((angle / count).sqrt().to_degrees(), (place / count).sqrt());
        println!("gaps of {gap_s} s: {angle:.3}°, {:.1} mm", 1000.0 * place);
        assert!(angle < limit_deg && place < limit_m);
    }
}
