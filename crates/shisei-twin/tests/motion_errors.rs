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

/// Readings with rows cut out, and a step each.
fn cut(acc: &mut Vec<Vec3>, gyro: &mut Vec<Vec3>, rows: std::ops::Range<usize>, usual_s: f64) -> Vec<f64> {
    let mut dt_s = vec![usual_s; acc.len() - rows.len()];
    dt_s[rows.start] = usual_s * (rows.len() + 1) as f64;
    acc.drain(rows.clone());
    gyro.drain(rows);
    dt_s
}

#[test]
fn a_hole_is_in_the_band() {
    let mut random = Random::new(5, 11);
    let settings = RestToRestSettings::default();
    for length_s in [0.05, 0.1, 0.2, 0.45] {
        let (mut off, runs) = (Vec::new(), 60);
        for run in 0..runs {
            let path = movement(&mut random, 2.0, 0.5, 60.0 * DEG);
            let s = simulate(&path, &sensor(), &Settings::new(200.0, 3000 + run));
            let (mut acc, mut gyro) = readings(&s);
            let last = s.truth.len() - 1;
            let truth = vector::sub(s.truth[last].position_m, s.truth[0].position_m);
            let from = 200 + (random.uniform() * (400.0 - 200.0 * length_s)) as usize;
            let dt_s = cut(&mut acc, &mut gyro, from..from + (200.0 * length_s) as usize, 0.005);
            let track = rest_to_rest(&acc, &gyro, Dt::PerSample(&dt_s), &settings).unwrap();
            let last = acc.len() - 1;
            let error = vector::norm(vector::sub(track.position_m[last], truth));
            assert_eq!(track.holes.len(), 1);
            off.push(error / track.sigma_total_m(last));
        }
        let worst = off.iter().copied().fold(0.0, f64::max);
        println!("{length_s} s: median {:.2}, worst {worst:.2} standard deviations", median(off));
        assert!(worst < 3.0, "{length_s} s: {worst}");
    }
    let path = movement(&mut random, 2.0, 0.5, 0.0);
    let s = simulate(&path, &sensor(), &Settings::new(200.0, 4000));
    let (mut acc, mut gyro) = readings(&s);
    let dt_s = cut(&mut acc, &mut gyro, 300..460, 0.005);
    let refusal = rest_to_rest(&acc, &gyro, Dt::PerSample(&dt_s), &settings).unwrap_err();
    let Error::HoleTooLong { at_s, seconds, .. } = refusal else { panic!("{refusal:?}") };
    assert!((at_s - 1.495).abs() < 1e-9 && (seconds - 0.805).abs() < 1e-9, "{refusal:?}");
}

#[test]
fn samples_that_are_no_readings_are_passed_over() {
    let path = movement(&mut Random::new(1, 2), 2.0, 0.5, 60.0 * DEG);
    let s = simulate(&path, &sensor(), &Settings::new(200.0, 4));
    let (acc, gyro) = readings(&s);
    let last = acc.len() - 1;
    let truth = vector::sub(s.truth[last].position_m, s.truth[0].position_m);
    let settings = RestToRestSettings::default();
    for row in [0, 60, 300, 301, 450, last] {
        for wild in [[1e300, 0.0, 0.0], [0.0, -5000.0, 9.8], [0.0; 3]] {
            let mut acc = acc.clone();
            acc[row] = wild;
            let track = rest_to_rest(&acc, &gyro, Dt::Constant(0.005), &settings).unwrap();
            let error = vector::norm(vector::sub(track.position_m[last], truth));
            assert_eq!((track.position_m.len(), track.passed_over), (last + 1, 1));
            assert!(error < 3.0 * track.sigma_total_m(last), "{row}: {error}");
            assert!(track.sigma_total_m(last) < 0.05);
        }
        let mut gyro = gyro.clone();
        gyro[row][1] = 200.0;
        let track = rest_to_rest(&acc, &gyro, Dt::Constant(0.005), &settings).unwrap();
        let error = vector::norm(vector::sub(track.position_m[last], truth));
        assert!(error < 3.0 * track.sigma_total_m(last), "{row}: {error}");
    }
}

#[test]
fn an_end_that_cannot_be_is_refused() {
    let path = movement(&mut Random::new(1, 1), 5.0, 1.0, 30.0 * DEG);
    let s = simulate(&path, &sensor(), &Settings::new(200.0, 4));
    let (acc, gyro) = readings(&s);
    let last = acc.len() - 1;
    let mut settings = RestToRestSettings::default();
    let open = rest_to_rest(&acc, &gyro, Dt::Constant(0.005), &settings).unwrap();
    let (at, sigma) = (open.position_m[last], open.sigma_position_m[last][0]);
    let mut told = |x: f64, insist: bool| {
        settings.navigation.end = Some((vector::add(at, [x, 0.0, 0.0]), 1e-4));
        settings.navigation.max_end_distance = if insist { f64::INFINITY } else { 10.0 };
        rest_to_rest(&acc, &gyro, Dt::Constant(0.005), &settings)
    };
    assert!(!told(sigma, false).unwrap().given_end.unwrap().is_doubtful());
    let doubtful = told(6.0 * sigma, false).unwrap().given_end.unwrap();
    assert!(doubtful.is_doubtful() && (doubtful.off_m - 6.0 * sigma).abs() < 1e-6, "{doubtful:?}");
    let refusal = told(5.0, false).unwrap_err();
    assert!(matches!(refusal, Error::EndContradicted { .. }), "{refusal:?}");
    let insisted = told(5.0, true).unwrap();
    assert!((insisted.position_m[last][0] - at[0] - 5.0).abs() < 0.01);
    assert!(told(1e300, false).is_err());
}
