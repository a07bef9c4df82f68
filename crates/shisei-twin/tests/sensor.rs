//! Errors of sensors: what they are said to be is what the readings show.

use shisei_core::vector::{norm, sub};
use shisei_core::{Vec3, math};
use shisei_twin::{
    Calibration, Correction, Errors, Motion, Path, Random, Sensor, Settings, World, ideal_imu, movements,
    simulate,
};

fn mean_and_deviation(values: &[f64]) -> (f64, f64) {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let variance = values.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / values.len() as f64;
    (mean, math::sqrt(variance))
}

#[test]
fn normal_deviates_have_the_moments_of_the_normal_distribution() {
    let mut random = Random::new(42, 0);
    let n = 400_000;
    let values: Vec<f64> = (0..n).map(|_| random.normal()).collect();
    let (mean, deviation) = mean_and_deviation(&values);
    // Five standard errors: 1/√n, 1/√(2n), √(96/n) for kurtosis.
    assert!(mean.abs() < 0.008 && (deviation - 1.0).abs() < 0.0056, "{mean} {deviation}");
    let fourth = values.iter().map(|x| x * x * x * x).sum::<f64>() / f64::from(n);
    assert!((fourth - 3.0).abs() < 0.078, "{fourth}");
    // P(|x| > 1.959964) = 0.05, P(|x| > 3.290527) = 0.001
    for (limit, p) in [(1.959_964, 0.05), (3.290_527, 0.001)] {
        let share = values.iter().filter(|x| x.abs() > limit).count() as f64 / f64::from(n);
        assert!((share - p).abs() < 5.0 * math::sqrt(p / f64::from(n)), "{share} for {p}");
    }
    // Neighbours in a stream, and neighbouring seeds and streams, share nothing.
    let correlation =
        |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>() / a.len() as f64;
    assert!(correlation(&values, &values[1..]).abs() < 0.008);
    for (seed, stream) in [(43, 0), (42, 1)] {
        let mut other = Random::new(seed, stream);
        let other: Vec<f64> = (0..n).map(|_| other.normal()).collect();
        assert!(correlation(&values, &other).abs() < 0.008);
    }
}

#[test]
fn directions_are_uniform_and_of_unit_length() {
    let mut random = Random::new(1, 1);
    let mut sum = [[0.0; 3]; 3];
    for _ in 0..60_000 {
        let d = random.direction();
        assert!((norm(d) - 1.0).abs() < 1e-15);
        for i in 0..3 {
            for j in 0..3 {
                sum[i][j] += d[i] * d[j] / 60_000.0;
            }
        }
    }
    for i in 0..3 {
        for j in 0..3 {
            let expected = if i == j { 1.0 / 3.0 } else { 0.0 };
            assert!((sum[i][j] - expected).abs() < 0.007, "{sum:?}");
        }
    }
}

#[test]
fn noise_and_bias_are_as_stated() {
    let rest = Path::still(400.0);
    for sensor in [Sensor::mu_01_like(), Sensor::lsm6ds3tr_c(), Sensor::spresense()] {
        let mut quiet_walk = sensor;
        quiet_walk.accelerometer.bias_walk = 0.0;
        quiet_walk.gyroscope.bias_walk = 0.0;
        let simulation = simulate(&rest, &quiet_walk, &Settings::new(100.0, 5));
        for (triad, correction, gyro) in [
            (sensor.accelerometer, simulation.calibration.accelerometer, false),
            (sensor.gyroscope, simulation.calibration.gyroscope, true),
        ] {
            for axis in 0..3 {
                let values: Vec<f64> = simulation
                    .samples
                    .iter()
                    .map(|s| if gyro { s.gyro_rad_s[axis] } else { s.acc_m_s2[axis] })
                    .collect();
                let (mean, deviation) = mean_and_deviation(&values);
                let white = triad.noise_density * math::sqrt(50.0);
                // Quantisation adds count²/12 where it is small beside the noise.
                let expected = math::sqrt(white * white + triad.count * triad.count / 12.0);
                assert!((deviation / expected - 1.0).abs() < 0.03, "{} {axis}: {deviation}", sensor.name);
                if gyro {
                    let difference = mean - correction.bias[axis];
                    assert!(difference.abs() < 5.0 * expected / 200.0, "{} {axis}: {mean}", sensor.name);
                }
            }
        }
    }
}

#[test]
fn bias_walks_as_stated() {
    let mut sensor = Sensor::ideal();
    sensor.gyroscope.bias_walk = 2e-3;
    let ends: Vec<f64> = (0..400)
        .flat_map(|seed| {
            let simulation = simulate(&Path::still(25.0), &sensor, &Settings::new(20.0, seed));
            let last = simulation.samples.len() - 1;
            assert_eq!(simulation.samples[last].gyro_rad_s, simulation.truth[last].gyro_bias_rad_s);
            simulation.samples[last].gyro_rad_s
        })
        .collect();
    let (mean, deviation) = mean_and_deviation(&ends);
    // After 25 s: 2e-3 · √25 = 0.01; 1,200 values give it to 2 %.
    assert!(mean.abs() < 0.0015 && (deviation / 0.01 - 1.0).abs() < 0.1, "{mean} {deviation}");
}

#[test]
fn the_true_calibration_corrects_the_readings() {
    let mut sensor = Sensor::lsm6ds3tr_c();
    for triad in [&mut sensor.accelerometer, &mut sensor.gyroscope] {
        (triad.noise_density, triad.bias_walk, triad.count) = (0.0, 0.0, 0.0);
    }
    let path = movements::wander(3, 0.5, 5.0);
    let simulation = simulate(&path, &sensor, &Settings::new(50.0, 9));
    let correct = |c: &Correction, raw: Vec3| {
        let d = sub(raw, c.bias);
        c.matrix.map(|row| row[0] * d[0] + row[1] * d[1] + row[2] * d[2])
    };
    for sample in &simulation.samples {
        let (acc, gyro) = ideal_imu(&path.state(sample.time_s), &World::default());
        assert!(norm(sub(correct(&simulation.calibration.accelerometer, sample.acc_m_s2), acc)) < 1e-13);
        assert!(norm(sub(correct(&simulation.calibration.gyroscope, sample.gyro_rad_s), gyro)) < 1e-13);
    }
}

#[test]
fn readings_are_whole_counts_within_the_range() {
    let triad = Sensor::mu_01_like().accelerometer;
    assert_eq!(triad.quantise(1e9), 32767.0 * triad.count);
    assert_eq!(triad.quantise(-1e9), -32768.0 * triad.count);
    assert_eq!(triad.quantise(2.6 * triad.count), 3.0 * triad.count);
    assert_eq!(Sensor::spresense().gyroscope.quantise(99.0), 125.0_f64.to_radians());
    // The count of ±16 g in 16 bits, as in the printed rows: 2035 counts are 9.744401 m/s².
    assert!((2035.0 * triad.count - 9.744401).abs() < 5e-7);
}

#[test]
fn the_same_seed_gives_the_same_bits_and_another_does_not() {
    let path = movements::wander(1, 1.0, 3.0);
    let run = |seed| simulate(&path, &Sensor::mu_01_like(), &Settings::new(100.0, seed));
    assert_eq!(run(1), run(1));
    assert_ne!(run(1).samples, run(2).samples);
    assert_ne!(run(1).calibration, run(2).calibration);
}

#[test]
fn jitter_and_losses_are_as_stated() {
    let path = Path::still(200.0);
    let settings = Settings { jitter: 0.2, lost: 0.05, ..Settings::new(100.0, 4) };
    let simulation = simulate(&path, &Sensor::ideal(), &settings);
    let kept = simulation.samples.len() as f64 / 20_001.0;
    assert!((kept - 0.95).abs() < 0.008, "{kept}");
    assert_eq!(simulation.samples.len(), simulation.truth.len());
    assert_eq!(simulation.samples[0].time_s, 0.0);
    let mut displacements = Vec::new();
    for pair in simulation.samples.windows(2) {
        assert!(pair[1].time_s > pair[0].time_s);
        let ticks = pair[1].time_s * 100.0;
        displacements.push(ticks - ticks.round());
    }
    let (mean, deviation) = mean_and_deviation(&displacements);
    // Uniform within ±0.2: deviation 0.2/√3.
    assert!(mean.abs() < 0.005 && (deviation - 0.115_470).abs() < 0.003, "{mean} {deviation}");
    assert!(displacements.iter().all(|d| d.abs() <= 0.2 + 1e-9));
}

#[test]
fn one_option_does_not_shift_the_numbers_of_another() {
    let path = Path::still(2.0);
    let even = Settings::new(100.0, 6);
    let given = Settings { errors: Errors::Given(Calibration::NONE), ..even };
    let lossy = Settings { lost: 0.3, ..even };
    let sensor = Sensor { accelerometer: Sensor::ideal().accelerometer, ..Sensor::spresense() };
    let (a, b) = (simulate(&path, &sensor, &even), simulate(&path, &sensor, &lossy));
    assert!(b.samples.iter().all(|s| a.samples.contains(s)));
    let c = simulate(&path, &sensor, &given);
    for (with, without) in a.samples.iter().zip(&c.samples) {
        let bias = sub(with.gyro_rad_s, without.gyro_rad_s);
        assert!(norm(sub(bias, a.calibration.gyroscope.bias)) < 1e-15);
    }
}
