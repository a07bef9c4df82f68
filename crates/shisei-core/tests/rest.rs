//! Rests of made-up recordings are found at every rate, with bias, noise and uneven time, and movement is not.
#![cfg(feature = "alloc")]

use std::ops::Range;

use shisei_core::filter::Dt;
use shisei_core::rest::{RestSettings, find_rests, first_rest, gyro_bias, is_stable, mean_norm, variance};
use shisei_core::{Error, Vec3, initial, math, vector};

struct Noise(u64);

impl Noise {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        let mut x = self.0;
        x ^= x >> 33;
        x = x.wrapping_mul(0xff51_afd7_ed55_8ccd);
        x ^= x >> 33;
        (x >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn normal3(&mut self, sigma: f64) -> Vec3 {
        [0; 3].map(|_| sigma * ((0..12).map(|_| self.uniform()).sum::<f64>() - 6.0))
    }
}

/// A cheap sensor at `rate_hz`: white noise of 0.04 rad/s and 0.05 m/s² at 100 Hz, growing with the root of
/// the rate up to 400 Hz.
struct Sensor {
    rate_hz: f64,
    bias: Vec3,
    noise: Noise,
    dt_s: Vec<f64>,
    acc: Vec<Vec3>,
    gyro: Vec<Vec3>,
}

impl Sensor {
    fn new(rate_hz: f64, bias: Vec3, seed: u64) -> Self {
        Sensor { rate_hz, bias, noise: Noise(seed), dt_s: vec![], acc: vec![], gyro: vec![] }
    }

    fn time_s(&self) -> f64 {
        self.dt_s.iter().sum()
    }

    /// `seconds` of a movement: rate and acceleration as functions of time.
    fn add(&mut self, seconds: f64, movement: impl Fn(f64) -> (Vec3, Vec3)) -> Range<f64> {
        let start = self.time_s();
        let grow = (self.rate_hz.min(400.0) / 100.0).sqrt();
        let mut t = 0.0;
        while t < seconds {
            let dt_s = (1.0 + 0.2 * (self.noise.uniform() - 0.5)) / self.rate_hz;
            t += dt_s;
            let (gyro, acc) = movement(t);
            let (gn, an) = (self.noise.normal3(0.04 * grow), self.noise.normal3(0.05 * grow));
            self.dt_s.push(dt_s);
            self.gyro.push(vector::add(vector::add(gyro, gn), self.bias));
            self.acc.push(vector::add(acc, an));
        }
        start..self.time_s()
    }

    fn rests(&self) -> Vec<Range<f64>> {
        let rests =
            find_rests(&self.acc, &self.gyro, Dt::PerSample(&self.dt_s), &RestSettings::default()).unwrap();
        let until = |row: usize| self.dt_s[..row].iter().sum::<f64>();
        rests.into_iter().map(|rows| until(rows.start)..until(rows.end)).collect()
    }
}

const UP: Vec3 = [9.7, 0.1, -0.9];

fn still(_: f64) -> (Vec3, Vec3) {
    ([0.0; 3], UP)
}

/// A person who stands: a sway of 0.8° at 0.4 Hz and breath.
fn standing(t: f64) -> (Vec3, Vec3) {
    let sway = 0.014 * math::sin(2.5 * t);
    ([0.0, 0.035 * math::cos(2.5 * t) * 0.5, 0.01 * math::sin(1.7 * t)], [9.75, 0.1, -0.9 + 9.8 * sway])
}

/// Walking: 1 Hz steps.
fn walking(t: f64) -> (Vec3, Vec3) {
    let s = math::sin(6.3 * t);
    ([0.8 * s, 0.5 * math::cos(12.6 * t), 0.6 * s], [9.7 + 2.0 * math::sin(12.6 * t), 1.5 * s, -0.9])
}

/// A slow bend of 20 °/s.
fn bending(t: f64) -> (Vec3, Vec3) {
    ([0.0, 0.35, 0.0], [9.8 * math::cos(0.35 * t), 0.0, 9.8 * math::sin(0.35 * t)])
}

fn check(rate_hz: f64, bias: Vec3, seed: u64) {
    let mut sensor = Sensor::new(rate_hz, bias, seed);
    let first = sensor.add(3.0, standing);
    sensor.add(4.0, walking);
    let second = sensor.add(2.0, still);
    sensor.add(2.0, bending);
    sensor.add(0.5, still);
    sensor.add(3.0, walking);
    let third = sensor.add(5.0, still);
    let found = sensor.rests();
    let context = format!("{rate_hz} Hz, seed {seed}: {found:?}");
    assert_eq!(found.len(), 3, "{context}");
    for (found, truth) in found.iter().zip([first, second, third]) {
        // one block and a sample of slack outside, a tenth and a quarter of a second inside
        let slack = 0.05 + 1.5 / rate_hz;
        assert!(found.start >= truth.start - slack && found.end <= truth.end + slack, "{context}");
        assert!(found.start <= truth.start + 0.25 && found.end >= truth.end - 0.25, "{context}");
    }
}

#[test]
fn rests_are_found_at_all_rates_and_biases() {
    for seed in 1..=10 {
        for rate_hz in [20.0, 50.0, 100.0, 128.0, 333.0, 1000.0, 2000.0] {
            check(rate_hz, [0.0; 3], seed);
            check(rate_hz, [0.2, -0.15, 0.25], seed + 100);
        }
    }
}

#[test]
fn movement_is_no_rest() {
    for rate_hz in [20.0, 100.0, 1000.0] {
        let mut sensor = Sensor::new(rate_hz, [0.1, 0.0, 0.0], 5);
        sensor.add(10.0, walking);
        sensor.add(6.0, bending);
        // free fall, and a constant turn faster than any bias
        sensor.add(3.0, |_| ([0.0; 3], [0.0; 3]));
        sensor.add(3.0, |_| ([0.0, 0.0, 1.0], [0.0, 0.0, 9.8]));
        // held in the hand and shaken
        sensor.add(3.0, |t| ([0.5 * math::sin(40.0 * t), 0.0, 0.0], [0.0, 3.0 * math::sin(40.0 * t), 9.8]));
        assert_eq!(sensor.rests(), []);
        let result =
            first_rest(&sensor.acc, &sensor.gyro, Dt::PerSample(&sensor.dt_s), &RestSettings::default());
        assert_eq!(result, Err(Error::NoRest { needed_s: 1.0 }));
    }
}

#[test]
fn a_rest_ends_at_a_gap_and_where_the_attitude_creeps() {
    let mut sensor = Sensor::new(100.0, [0.0; 3], 1);
    sensor.add(2.0, still);
    let row = sensor.dt_s.len();
    sensor.add(2.0, still);
    sensor.dt_s[row] = 3.0;
    assert_eq!(sensor.rests().len(), 2);

    // 1.5 °/s: slower than the noise of a window, but 15° in all
    let mut sensor = Sensor::new(100.0, [0.0; 3], 2);
    sensor.add(10.0, |t| {
        let angle = 0.0262 * t;
        ([0.0, 0.0262, 0.0], [9.8 * math::cos(angle), 0.0, 9.8 * math::sin(angle)])
    });
    for rest in sensor.rests() {
        assert!(rest.end - rest.start < 5.0, "{rest:?}");
    }
}

#[test]
fn settings_and_series_are_checked() {
    let acc = [[0.0, 0.0, 9.8]; 200];
    let gyro = [[0.0; 3]; 200];
    let settings = RestSettings::default();
    assert_eq!(first_rest(&acc, &gyro, Dt::Constant(0.01), &settings), Ok(0..200));
    assert_eq!(find_rests(&[], &[], Dt::Constant(0.01), &settings), Ok(vec![]));
    assert_eq!(find_rests(&acc[..99], &gyro[..99], Dt::Constant(0.01), &settings), Ok(vec![]));
    let settings = RestSettings { window_s: 2.0, ..settings };
    assert!(matches!(find_rests(&acc, &gyro, Dt::Constant(0.01), &settings), Err(Error::OutOfOrder { .. })));
    assert!(find_rests(&acc, &gyro[1..], Dt::Constant(0.01), &RestSettings::default()).is_err());
}

/// By hand: rows 1, 2, 3 and 6 have mean 3 and population variance (4 + 1 + 0 + 9)/4.
#[test]
fn means_and_variances() {
    let rows = [[1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [3.0, 4.0, 0.0], [6.0, 0.0, 8.0]];
    assert_eq!(variance(&rows).unwrap(), [3.5, 3.0, 12.0]);
    assert_eq!(mean_norm(&rows).unwrap(), 4.5);
    assert_eq!(variance(&rows[..1]).unwrap(), [0.0; 3]);
    assert_eq!(variance(&[]), Err(Error::Empty));
    assert_eq!(is_stable(&rows, 12.0, 4.5, 4.5), Ok(true));
    assert_eq!(is_stable(&rows, 11.9, 4.5, 4.5), Ok(false));
    assert_eq!(is_stable(&rows, 12.0, 4.6, 5.0), Ok(false));
    assert!(matches!(is_stable(&rows, 12.0, 5.0, 4.0), Err(Error::OutOfOrder { .. })));
    assert!(matches!(is_stable(&rows, -1.0, 4.0, 5.0), Err(Error::Negative { .. })));
    assert_eq!(gyro_bias(&[[1.0, 2.0, 3.0]; 9]), Ok([0.0; 3]));
    assert_eq!(gyro_bias(&[[1.0, 2.0, 3.0]; 10]), Ok([1.0, 2.0, 3.0]));
}

/// By hand: pitch = atan2(−3, 4), roll = π/2.
#[test]
fn initial_attitude() {
    let ypr = initial::from_mean_acceleration([3.0, 4.0, 0.0]).unwrap().to_ypr();
    assert!(ypr.yaw_rad.abs() < 1e-15);
    assert!((ypr.pitch_rad + 0.6435011087932844).abs() < 1e-15);
    assert!((ypr.roll_rad - std::f64::consts::FRAC_PI_2).abs() < 1e-15);
    assert_eq!(initial::from_mean_acceleration([0.0; 3]), Err(Error::ZeroAcceleration));
    assert!(matches!(
        initial::from_stable_window(&[[0.0, 0.0, 9.8]; 3], 0.01, 9.9, 10.0),
        Err(Error::NotStable { variance: 0.0, .. })
    ));
}
