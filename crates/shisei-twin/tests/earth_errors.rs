//! Earth-rate measurements of a simulated board: are the stated errors right?

use shisei_core::earth::Weights;
use shisei_core::earth::analysis::{Analysis, Believed, EARTH_RATE_RAD_S, analyse};
use shisei_core::earth::direction::{Direction, summarise};
use shisei_core::{Quaternion, Vec3, Ypr, math};
use shisei_twin::{Calibration, Correction, Errors, Path, Random, Sensor, Settings, World, simulate};

const DEG: f64 = core::f64::consts::PI / 180.0;
const LATITUDE: f64 = 35.7 * DEG;
const RUNS: u64 = 200;

/// One direction: 60 s at 50 Hz (the noise density does not know the rate).
fn measure(world_from_body: Quaternion, bias: Vec3, seed: u64) -> Direction {
    let mut path = Path::still(60.0);
    path.mounting = world_from_body;
    let settings = Settings {
        world: World::on_earth(LATITUDE, 0.0),
        errors: Errors::Given(Calibration {
            accelerometer: Correction::diagonal([0.02, -0.03, 0.01], [1.0; 3]),
            gyroscope: Correction::diagonal(bias, [1.0; 3]),
        }),
        ..Settings::new(50.0, seed)
    };
    let s = simulate(&path, &Sensor::spresense(), &settings);
    let (acc, gyro): (Vec<Vec3>, Vec<Vec3>) = s.samples.iter().map(|s| (s.acc_m_s2, s.gyro_rad_s)).unzip();
    let dt = vec![0.02; gyro.len()];
    summarise(&gyro, &acc, &[], &dt, Weights::Capped).unwrap().direction
}

fn ypr(yaw: f64, pitch: f64, roll: f64) -> Quaternion {
    Quaternion::from_ypr(Ypr { yaw_rad: yaw * DEG, pitch_rad: pitch * DEG, roll_rad: roll * DEG })
}

/// Share of runs in which the truth lies inside one standard error.
fn share(poses: &[Quaternion], acc: bool, latitude: Option<f64>, inside: impl Fn(&Analysis) -> bool) -> f64 {
    let mut random = Random::new(11, 3);
    let mut hits = 0;
    for run in 0..RUNS {
        let bias = random.normal3(0.001);
        let directions: Vec<Direction> = poses
            .iter()
            .enumerate()
            .map(|(i, q)| {
                let mut d = measure(*q, bias, (1000 * run + i as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15));
                if !acc {
                    d.acc_m_s2 = None;
                }
                d
            })
            .collect();
        let a = analyse(&directions, latitude).unwrap();
        hits += u64::from(inside(&a));
    }
    100.0 * hits as f64 / RUNS as f64
}

fn rate_inside(a: &Analysis) -> bool {
    let rate = a.rate.expect("a rate");
    (rate.value - EARTH_RATE_RAD_S).abs() < rate.sigma
}

#[test]
fn level_turntable_with_latitude() {
    let poses: Vec<Quaternion> = (0..8).map(|k| ypr(45.0 * f64::from(k), 0.0, 0.0)).collect();
    let share = share(&poses, true, Some(LATITUDE), |a| {
        assert!(matches!(a.believed, Believed::LevelledWithLatitude | Believed::CircleWithLatitude));
        let day = a.day_h.unwrap();
        // the published figure for eight level poses: ± 0.6 h at 1 °/h
        assert!(day.sigma < 0.6 && (day.value - 23.934).abs() < 5.0 * day.sigma, "{day:?}");
        // headings: counter-clockwise turns of 45° from north
        let expected = [0.0, 315.0, 270.0, 225.0, 180.0, 135.0, 90.0, 45.0];
        for (h, e) in a.headings.iter().zip(expected) {
            let mut d = h.heading_rad.value / DEG - e;
            d -= 360.0 * (d / 360.0).round();
            assert!(d.abs() < 5.0 * h.heading_rad.sigma / DEG, "{d} {h:?}");
        }
        rate_inside(a)
    });
    println!("level turntable, latitude known: {share:.0} %");
    assert!((60.0..=76.0).contains(&share), "{share}");
}

#[test]
fn upright_and_inverted_gives_the_latitude() {
    let poses: Vec<Quaternion> =
        (0..8).map(|k| ypr(90.0 * f64::from(k), 0.0, if k < 4 { 0.0 } else { 180.0 })).collect();
    let rate = share(&poses, true, None, |a| {
        assert_eq!(a.believed, Believed::LevelledFree);
        rate_inside(a)
    });
    let latitude = share(&poses, true, None, |a| {
        let l = a.latitude.unwrap();
        (l.value - LATITUDE).abs() < l.sigma
    });
    println!("upright and inverted: rate {rate:.0} %, latitude {latitude:.0} %");
    assert!((60.0..=76.0).contains(&rate) && (60.0..=76.0).contains(&latitude), "{rate} {latitude}");
}

#[test]
fn a_sphere_without_an_accelerometer() {
    let poses: Vec<Quaternion> = [
        (0.0, 0.0, 0.0),
        (90.0, 0.0, 0.0),
        (180.0, 0.0, 0.0),
        (270.0, 0.0, 0.0),
        (45.0, 0.0, 180.0),
        (135.0, 0.0, 180.0),
        (225.0, 0.0, 180.0),
        (315.0, 0.0, 180.0),
        (0.0, 90.0, 0.0),
        (0.0, -90.0, 0.0),
        (90.0, 0.0, 90.0),
        (90.0, 0.0, -90.0),
    ]
    .map(|(y, p, r)| ypr(y, p, r))
    .to_vec();
    let share = share(&poses, false, None, |a| {
        assert_eq!(a.believed, Believed::Sphere);
        // nothing says where up was: no horizontal part, no latitude, no headings
        assert!(a.horizontal.is_none() && a.latitude.is_none() && a.headings.is_empty());
        rate_inside(a)
    });
    println!("sphere: {share:.0} %");
    assert!((60.0..=76.0).contains(&share), "{share}");
}

/// Directions on a cone: nearly level, so that a circle through them looks good, but their plane is not level.
/// Without accelerations nothing may be taken for horizontal unless they lie in one plane.
#[test]
fn a_circle_counts_as_level_only_where_it_can_be() {
    let spread: Vec<Quaternion> =
        (0..8).map(|k| ypr(45.0 * f64::from(k), 70.0 * f64::from(k % 2), 60.0 * f64::from(k % 3))).collect();
    let of = |poses: &[Quaternion], acc: bool| -> Vec<Direction> {
        let all = poses
            .iter()
            .enumerate()
            .map(|(i, q)| measure(*q, [0.001, -0.002, 0.0005], 7919 * (i as u64 + 1)));
        all.map(|d| Direction { acc_m_s2: d.acc_m_s2.filter(|_| acc), ..d }).collect()
    };
    let blind = analyse(&of(&spread, false), Some(LATITUDE)).unwrap();
    assert!(!blind.plane.flat);
    assert!(!matches!(blind.believed, Believed::CircleWithLatitude), "{:?}", blind.believed);
    assert!(blind.horizontal.is_none() && blind.headings.is_empty() && blind.headings_known.is_none());
    assert_eq!(blind.latitude.unwrap().value, LATITUDE); // as given
    let seeing = analyse(&of(&spread, true), None).unwrap();
    assert_eq!(seeing.believed, Believed::LevelledFree);
    assert!(seeing.horizontal.is_some() && seeing.headings.len() == 8);
    // on a turntable the plane stands for the level one, with or without accelerations
    let level: Vec<Quaternion> = (0..8).map(|k| ypr(45.0 * f64::from(k), 0.0, 0.0)).collect();
    for acc in [false, true] {
        let found = analyse(&of(&level, acc), None).unwrap();
        let horizontal = found.horizontal.unwrap();
        let truth = EARTH_RATE_RAD_S * math::cos(LATITUDE);
        assert!((horizontal.value - truth).abs() < 4.0 * horizontal.sigma, "{horizontal:?}");
        assert_eq!(found.headings.len(), 8);
    }
}
