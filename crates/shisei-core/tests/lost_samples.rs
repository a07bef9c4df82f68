//! Samples lost in a row, in movements as quick as BROAD's: how far the heading is off afterwards, and what is stated.

#![allow(clippy::disallowed_methods)] // the truth of a simulation may use std's mathematics

use std::f64::consts::PI;

use shisei_core::estimator::{Estimator, Sample, Settings, State, smooth};
use shisei_core::filter::Dt;
use shisei_core::{Quaternion, Vec3, vector};
use shisei_twin::curve::Curve;
use shisei_twin::motion::{Path, Turn};
use shisei_twin::random::Random;
use shisei_twin::sensor::Sensor;
use shisei_twin::simulate::{self, simulate};

const REST_S: f64 = 3.0;
const MOVE_S: f64 = 24.0;
/// The heading is looked at so long after a loss.
const LATER_S: f64 = 1.0;
const LOSSES: u64 = 40;

/// Still, then turning and moving all ways; `speed` 1 has rates of about 8 rad/s, as BROAD's fast rotations, with
/// sines of 0.3 to 2.5 Hz; 0.3 the rates of its slow ones.
fn lively(seed: u64, speed: f64) -> Path {
    let mut random = Random::new(seed, 0x6c69_7665);
    let mut faded = |most: f64, slowest_hz: f64, fastest_hz: f64| {
        let mut sum = Curve::default();
        for _ in 0..4 {
            let frequency_hz = speed.sqrt() * random.between(slowest_hz, fastest_hz);
            let phase_rad = random.between(-PI, PI);
            // the same speed at every frequency
            let amplitude = speed * most * random.between(0.5, 1.0) / (2.0 * PI * frequency_hz);
            sum = sum.sine(amplitude, frequency_hz, phase_rad);
        }
        sum.times(Curve::default().bump(REST_S, 1.0, MOVE_S - 2.0, 1.0))
    };
    let mut path = Path::still(REST_S + MOVE_S);
    path.turns = [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
        .map(|axis| Turn { axis, angle_rad: faded(4.0, 0.3, 2.5) })
        .to_vec();
    path.position_m = [0; 3].map(|_| faded(0.25, 0.3, 2.0));
    path
}

/// A sensor with what a calibration leaves.
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
}

fn run_of(seed: u64, rate_hz: f64, speed: f64) -> Run {
    let simulation = simulate(&lively(seed, speed), &sensor(), &simulate::Settings::new(rate_hz, seed));
    let samples = simulation
        .samples
        .iter()
        .map(|s| Sample { gyro_rad_s: s.gyro_rad_s, acc_m_s2: s.acc_m_s2, dt_s: 1.0 / rate_hz })
        .collect();
    Run { samples, truth: simulation.truth.iter().map(|truth| truth.world_from_body).collect() }
}

impl Run {
    fn without(&self, from: usize, count: usize) -> Run {
        let mut lost = Run { samples: self.samples.clone(), truth: self.truth.clone() };
        lost.samples.drain(from..from + count);
        lost.truth.drain(from..from + count);
        lost.samples[from].dt_s *= count as f64 + 1.0;
        lost
    }

    fn online(&self) -> Vec<State> {
        let mut estimator = Estimator::new(&Settings::default()).unwrap();
        self.samples.iter().map(|sample| estimator.update(sample)).collect()
    }

    fn smoothed(&self) -> Vec<State> {
        let acc: Vec<Vec3> = self.samples.iter().map(|sample| sample.acc_m_s2).collect();
        let gyro: Vec<Vec3> = self.samples.iter().map(|sample| sample.gyro_rad_s).collect();
        let dt: Vec<f64> = self.samples.iter().map(|sample| sample.dt_s).collect();
        smooth(&acc, &gyro, Dt::PerSample(&dt), &Settings::default()).unwrap().states
    }

    /// The turn about z from the truth to the estimate of a row, rad. The gyroscope's samples stand for the steps
    /// before them: attitudes are half a step ahead of the readings' time.
    fn heading(&self, states: &[State], k: usize, step_s: f64) -> f64 {
        let back = Quaternion::from_rotation_vector(vector::scale(states[k].rate_rad_s, -0.5 * step_s));
        let d = states[k].world_from_body.product(back).product(self.truth[k].conjugate());
        2.0 * d.z.atan2(d.w)
    }
}

/// An angle between −π and π.
fn wrapped(angle: f64) -> f64 {
    (angle + PI).rem_euclid(2.0 * PI) - PI
}

/// What a number of losses did: errors of the heading over what is stated, and both, rad.
#[derive(Default)]
struct Seen {
    share: Vec<f64>,
    error: Vec<f64>,
    sigma: Vec<f64>,
}

impl Seen {
    fn add(&mut self, run: &Run, states: &[State], row: usize, step_s: f64) {
        // when the bias is known
        let start = (0.9 * REST_S / step_s) as usize;
        let error = wrapped(run.heading(states, row, step_s) - run.heading(states, start, step_s)).abs();
        let sigma = states[row].sigma_heading_rad;
        self.share.push(error / sigma);
        self.error.push(error);
        self.sigma.push(sigma);
    }

    fn beyond(&self, sigmas: f64) -> usize {
        self.share.iter().filter(|share| **share > sigmas).count()
    }

    fn rms(values: &[f64]) -> f64 {
        (values.iter().map(|x| x * x).sum::<f64>() / values.len() as f64).sqrt()
    }
}

/// Movements, each with a row from which samples are lost.
fn runs(rate_hz: f64, speed: f64) -> Vec<(Run, usize)> {
    let mut random = Random::new(1, 3);
    (0..LOSSES)
        .map(|seed| {
            let from_s = random.between(REST_S + 6.0, REST_S + MOVE_S - 4.0);
            (run_of(seed, rate_hz, speed), (from_s * rate_hz) as usize)
        })
        .collect()
}

/// What is seen after losses of `count` samples: smoothed, live.
fn losses(runs: &[(Run, usize)], rate_hz: f64, count: usize) -> [Seen; 2] {
    let mut seen = [Seen::default(), Seen::default()];
    for (run, from) in runs {
        let lost = run.without(*from, count);
        let row = from + (LATER_S * rate_hz) as usize;
        seen[0].add(&lost, &lost.smoothed(), row, 1.0 / rate_hz);
        seen[1].add(&lost, &lost.online(), row, 1.0 / rate_hz);
    }
    seen
}

/// Of normal errors 68.3 % are within one standard deviation and 99.7 % within three: of 40 that leaves more than 20 beyond one
/// in one case of 160, and more than two beyond three in one of 5000 (binomial). The other way round, errors of a tenth of what is
/// stated on the whole would call a heading lost that is as good as known.
#[test]
fn the_heading_after_a_loss_is_as_sure_as_stated() {
    for (rate_hz, speed) in [(100.0, 1.0), (100.0, 0.3), (286.0, 1.0), (50.0, 0.3)] {
        let runs = runs(rate_hz, speed);
        for lost_s in [0.1, 0.2, 0.3, 0.43, 0.49, 0.7] {
            let seen = losses(&runs, rate_hz, (lost_s * rate_hz) as usize);
            for (name, seen) in ["smoothed", "live"].into_iter().zip(&seen) {
                let (one, three) = (seen.beyond(1.0), seen.beyond(3.0));
                let [error, sigma] = [&seen.error, &seen.sigma].map(|all| Seen::rms(all).to_degrees());
                let share = Seen::rms(&seen.share);
                println!(
                    "{rate_hz} Hz, speed {speed}, {lost_s} s, {name}: beyond 1 σ {one}, 3 σ {three} of {LOSSES}; \
                     {error:.2}°, stated {sigma:.2}°, share {share:.2}"
                );
                let place = format!("{rate_hz} Hz, speed {speed}, {lost_s} s lost, {name}");
                assert!(one <= 20 && three <= 2, "{place}: {one} beyond one stated sigma, {three} beyond 3");
                assert!(share > 0.1, "{place}: {error:.2}° off, {sigma:.2}° stated");
            }
        }
    }
}

/// What numbers of lost samples change in the heading, root mean square, degrees: smoothed, live.
fn costs(rate_hz: f64, counts: core::ops::RangeInclusive<usize>) -> Vec<[f64; 2]> {
    let mut changes = vec![[Vec::new(), Vec::new()]; counts.clone().count()];
    for (run, from) in runs(rate_hz, 1.0) {
        let row = from + (LATER_S * rate_hz) as usize;
        for (way, states) in [Run::smoothed, Run::online].into_iter().enumerate() {
            let all = states(&run);
            for (changes, count) in changes.iter_mut().zip(counts.clone()) {
                let lost = run.without(from, count);
                let heading = lost.heading(&states(&lost), row, 1.0 / rate_hz);
                changes[way].push(wrapped(heading - run.heading(&all, row + count, 1.0 / rate_hz)));
            }
        }
    }
    changes.into_iter().map(|changes| changes.map(|changes| Seen::rms(&changes).to_degrees())).collect()
}

/// One sample costs next to nothing, and where the way of bridging them changes (more than four) nothing jumps.
#[test]
fn a_few_lost_samples_cost_little() {
    for (rate_hz, most_deg) in [(100.0, [0.01, 0.6]), (286.0, [0.001, 0.1])] {
        let all = costs(rate_hz, 1..=7);
        println!("{rate_hz} Hz, 1 to 7 samples lost, change of the heading, smoothed and live: {all:.3?}");
        for way in 0..2 {
            assert!(all[0][way] < most_deg[0] && all[6][way] < most_deg[1], "{rate_hz} Hz: {all:?}");
            for pair in all[3..].windows(2) {
                assert!(pair[1][way] < 2.5 * pair[0][way], "{rate_hz} Hz: {all:?}");
            }
        }
    }
}

impl Run {
    /// Between two times only `burst` samples of every `period` are left.
    fn stuttering(&self, rows: core::ops::Range<usize>, burst: usize, period: usize) -> Run {
        let mut left = Run { samples: Vec::new(), truth: Vec::new() };
        let mut passed_s = 0.0;
        for (k, (sample, truth)) in self.samples.iter().zip(&self.truth).enumerate() {
            passed_s += sample.dt_s;
            if !rows.contains(&k) || k % period < burst {
                left.samples.push(Sample { dt_s: passed_s, ..*sample });
                left.truth.push(*truth);
                passed_s = 0.0;
            }
        }
        left
    }

    /// The angle between the vertical of the truth and of the estimate, rad.
    fn tilt(&self, states: &[State], k: usize) -> f64 {
        let [estimated, truth] =
            [states[k].world_from_body, self.truth[k]].map(|q| q.conjugate().rotate([0.0, 0.0, 1.0]));
        vector::norm(vector::cross(estimated, truth)).atan2(vector::dot(estimated, truth))
    }
}

/// Gaps that follow each other before a level is found between them: each burst is levelled by itself, and what it is
/// worth is stated. A moment's acceleration does not tell how much the sensor moves, so that more than of normal errors may be
/// beyond three standard deviations. Where levels were not found anew 96 % were.
#[test]
fn the_tilt_of_short_bursts_between_gaps_is_as_sure_as_stated() {
    for (burst, period) in [(1, 60), (1, 100), (10, 70), (30, 90)] {
        let mut shares = Vec::new();
        let mut worst = 0.0_f64;
        for seed in 0..10 {
            let run = run_of(seed, 100.0, 0.3);
            let stuttering = run.stuttering(600..2000, burst, period);
            let states = stuttering.smoothed();
            for (k, state) in states.iter().enumerate().skip(600).take(1400 / period * burst) {
                let tilt = stuttering.tilt(&states, k);
                worst = worst.max(tilt);
                shares.push(tilt / state.sigma_tilt_rad);
            }
        }
        let beyond =
            |sigmas: f64| shares.iter().filter(|share| **share > sigmas).count() as f64 / shares.len() as f64;
        let (one, three) = (beyond(1.0), beyond(3.0));
        println!(
            "{burst} of {period}: beyond 1 σ {:.0} %, beyond 3 σ {:.1} %; worst {:.1}°",
            100.0 * one,
            100.0 * three,
            worst.to_degrees()
        );
        assert!(
            one < 0.7 && three < 0.1,
            "{burst} of {period}: {one} beyond one stated sigma, {three} beyond three"
        );
    }
}
