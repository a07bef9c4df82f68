//! Position between rests: how much better than the note's way, and whether the stated errors are right.

use shisei_core::filter::Dt;
use shisei_core::motion::navigation::{NavigationSettings, SensorErrors};
use shisei_core::motion::rest_to_rest::{RestToRestSettings, rest_to_rest};
use shisei_core::{Vec3, math, vector};
use shisei_twin::{Curve, Motion, Path, Random, Sensor, Settings, Simulation, Triad, simulate};

const G: f64 = shisei_core::STANDARD_GRAVITY_M_S2;
const DEG: f64 = core::f64::consts::PI / 180.0;

/// The sensor of the table: bias 2 mg and 0.05 °/s, scale 0.1 %.
fn sensor() -> Sensor {
    let triad = |noise_density, bias_sigma| Triad {
        full_scale: f64::INFINITY,
        count: 0.0,
        noise_density,
        bias_walk: 0.0,
        bias_sigma,
        scale_sigma: 0.001,
        misalignment_sigma: 0.0,
    };
    Sensor {
        name: "table",
        accelerometer: triad(100e-6 * G, 0.002 * G),
        gyroscope: triad(0.005 * DEG, 0.05 * DEG),
    }
}

/// 1 s of rest, a move of `length_m` in some direction within `seconds`, turned by `turn_rad`, 1 s of rest.
fn movement(random: &mut Random, seconds: f64, length_m: f64, turn_rad: f64) -> Path {
    let heading = random.uniform() * core::f64::consts::TAU;
    let mut path = Path::still(seconds + 2.0).with_ypr(
        Curve::default(),
        Curve::constant(0.1).step(1.0, seconds, turn_rad),
        Curve::constant(-0.2),
    );
    let (s, c) = math::sin_cos(heading);
    path.position_m = [
        Curve::default().step(1.0, seconds, length_m * c),
        Curve::default().step(1.0, seconds, length_m * s),
        Curve::default().step(1.0, 0.5 * seconds, 0.2).step(1.0 + 0.5 * seconds, 0.5 * seconds, -0.1),
    ];
    path
}

fn errors() -> SensorErrors {
    SensorErrors {
        acc_bias_m_s2: 0.002 * G,
        gyro_bias_rad_s: 0.05 * DEG,
        gyro_scale: 0.001,
        acc_scale: 0.001,
        gyro_misalignment: 1e-6,
        acc_misalignment: 1e-6,
        gyro_bias_walk: 1e-7,
        acc_bias_walk: 1e-6,
        ..SensorErrors::default()
    }
}

fn readings(s: &Simulation) -> (Vec<Vec3>, Vec<Vec3>) {
    s.samples.iter().map(|s| (s.acc_m_s2, s.gyro_rad_s)).unzip()
}

fn median(mut v: Vec<f64>) -> f64 {
    v.sort_by(f64::total_cmp);
    v[v.len() / 2]
}

#[test]
fn rest_to_rest_beats_the_note_and_knows_its_error() {
    let mut random = Random::new(5, 9);
    let settings = RestToRestSettings {
        navigation: NavigationSettings { errors: errors(), ..NavigationSettings::default() },
        ..RestToRestSettings::default()
    };
    for (seconds, length, turn) in [
        (2.0, 0.5, 0.0),
        (2.0, 0.5, 60.0),
        (5.0, 1.0, 0.0),
        (5.0, 1.0, 60.0),
        (10.0, 1.0, 0.0),
        (10.0, 1.0, 60.0),
    ] {
        let (mut ends, mut inside, mut middle_inside) = (Vec::new(), 0.0, 0.0);
        let runs = 60;
        for run in 0..runs {
            let path = movement(&mut random, seconds, length, turn * DEG);
            let s = simulate(&path, &sensor(), &Settings::new(200.0, 1000 + run));
            let (acc, gyro) = readings(&s);
            let track = rest_to_rest(&acc, &gyro, Dt::Constant(0.005), &settings).unwrap();
            let yaw = s.truth[0].world_from_body.to_ypr().yaw_rad;
            let error = |k: usize| {
                let p = vector::sub(s.truth[k].position_m, s.truth[0].position_m);
                let (sin, cos) = math::sin_cos(-yaw);
                let p = [cos * p[0] - sin * p[1], sin * p[0] + cos * p[1], p[2]];
                vector::norm(vector::sub(track.position_m[k], p))
            };
            let last = acc.len() - 1;
            ends.push(1000.0 * error(last));
            inside += f64::from(u8::from(error(last) < track.sigma_total_m(last)));
            middle_inside += f64::from(u8::from(error(last / 2) < track.sigma_total_m(last / 2)));
        }
        println!(
            "{seconds} s {length} m {turn}°: median {:.1} mm, inside {:.0} % middle {:.0} %",
            median(ends),
            100.0 * inside / runs as f64,
            100.0 * middle_inside / runs as f64
        );
    }
}
