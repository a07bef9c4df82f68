//! Position between rests: how much better than the note's way, and whether the stated errors are right.

use shisei_core::filter::Dt;
use shisei_core::motion::navigation::{NavigationSettings, SensorErrors};
use shisei_core::motion::rest_to_rest::{RestToRestSettings, rest_to_rest};
use shisei_core::motion::{DeadReckoning, Scheme};
use shisei_core::{Error, Vec3, math, vector};
use shisei_twin::{Curve, Path, Random, Sensor, Settings, Simulation, Triad, simulate};

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

/// The note's way with the sensor as it comes: levelled at the start, integrated step by step to the end.
fn naive_end(acc: &[Vec3], gyro: &[Vec3]) -> Vec3 {
    let up = shisei_core::rest::mean(&acc[..200]).unwrap();
    let q = shisei_core::Quaternion::from_ypr(shisei_core::Ypr {
        yaw_rad: 0.0,
        pitch_rad: math::atan2(-up[0], math::hypot(up[1], up[2])),
        roll_rad: math::atan2(up[1], up[2]),
    });
    let mut dead = DeadReckoning::new(q, [0.0; 3], G, Scheme::SemiImplicit).unwrap();
    for (a, w) in acc.iter().zip(gyro) {
        dead.update(*w, *a, 0.005);
    }
    dead.state().position_m
}

#[test]
fn rest_to_rest_beats_the_note_and_knows_its_error() {
    let mut random = Random::new(5, 9);
    let settings = RestToRestSettings {
        navigation: NavigationSettings { errors: errors(), ..NavigationSettings::default() },
        ..RestToRestSettings::default()
    };
    // seconds, metres, degrees turned on the way
    for (seconds, length, turn) in [
        (2.0, 0.5, 0.0),
        (2.0, 0.5, 60.0),
        (5.0, 1.0, 0.0),
        (5.0, 1.0, 60.0),
        (10.0, 1.0, 0.0),
        (10.0, 1.0, 60.0),
    ] {
        let (mut ends, mut naive) = (Vec::new(), Vec::new());
        let (mut inside, mut inside_on_the_way) = (0.0, 0.0);
        let runs = 200;
        for run in 0..runs {
            let path = movement(&mut random, seconds, length, turn * DEG);
            let s = simulate(&path, &sensor(), &Settings::new(200.0, 1000 + run));
            let (acc, gyro) = readings(&s);
            let track = rest_to_rest(&acc, &gyro, Dt::Constant(0.005), &settings).unwrap();
            // the track's heading is 0 at the start, and so is the truth's
            let truth = |k: usize| vector::sub(s.truth[k].position_m, s.truth[0].position_m);
            let error = |k: usize| vector::norm(vector::sub(track.position_m[k], truth(k)));
            let last = acc.len() - 1;
            ends.push(1000.0 * error(last));
            naive.push(1000.0 * vector::norm(vector::sub(naive_end(&acc, &gyro), truth(last))));
            inside += f64::from(u8::from(error(last) < track.sigma_total_m(last)));
            inside_on_the_way += f64::from(u8::from(error(last / 2) < track.sigma_total_m(last / 2)));
        }
        let share = 100.0 * inside / runs as f64;
        let share_on_the_way = 100.0 * inside_on_the_way / runs as f64;
        let (ours, note) = (median(ends), median(naive));
        println!(
            "{seconds} s, {length} m, {turn}°: the note {note:.0} mm, rest to rest {ours:.1} mm, \
             inside 1 sigma {share:.0} % (half way {share_on_the_way:.0} %)"
        );
        assert!(ours * 5.0 <= note, "{ours} {note}");
        assert!((60.0..=76.0).contains(&share) && (60.0..=76.0).contains(&share_on_the_way));
    }
}

#[test]
fn the_end_point_narrows_the_band() {
    let path = movement(&mut Random::new(1, 1), 10.0, 1.0, 30.0 * DEG);
    let s = simulate(&path, &sensor(), &Settings::new(200.0, 4));
    let (acc, gyro) = readings(&s);
    let last = acc.len() - 1;
    let end = vector::sub(s.truth[last].position_m, s.truth[0].position_m);
    let mut settings = RestToRestSettings::default();
    let open = rest_to_rest(&acc, &gyro, Dt::Constant(0.005), &settings).unwrap();
    settings.navigation.end = Some((end, 0.001));
    let closed = rest_to_rest(&acc, &gyro, Dt::Constant(0.005), &settings).unwrap();
    assert!(vector::norm(vector::sub(closed.position_m[last], end)) < 0.002);
    assert!(closed.sigma_total_m(last) < 0.002);
    assert!(closed.sigma_total_m(last / 2) < 0.5 * open.sigma_total_m(last / 2));
}

#[test]
fn too_long_or_never_at_rest_is_refused() {
    let path = movement(&mut Random::new(1, 1), 40.0, 4.0, 300.0 * DEG);
    let s = simulate(&path, &sensor(), &Settings::new(100.0, 4));
    let (acc, gyro) = readings(&s);
    let settings = RestToRestSettings::default();
    let refusal = rest_to_rest(&acc, &gyro, Dt::Constant(0.01), &settings).unwrap_err();
    assert!(matches!(refusal, Error::TooLongWithoutRest { .. }), "{refusal:?}");
    let insist = RestToRestSettings { max_without_rest_s: f64::INFINITY, ..settings };
    let track = rest_to_rest(&acc, &gyro, Dt::Constant(0.01), &insist).unwrap();
    assert!(track.longest_without_rest_s > 30.0);

    let mut random = Random::new(3, 3);
    let shaken: Vec<Vec3> = (0..500).map(|_| vector::add([0.0, 0.0, G], random.normal3(3.0))).collect();
    let gyro: Vec<Vec3> = (0..500).map(|_| random.normal3(2.0)).collect();
    let refusal = rest_to_rest(&shaken, &gyro, Dt::Constant(0.01), &settings).unwrap_err();
    assert!(matches!(refusal, Error::NoRest { .. }), "{refusal:?}");
}
