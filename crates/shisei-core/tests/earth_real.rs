//! Earth's rotation in real readings: the published table and Sony's public headings.

mod support;

use shisei_core::Error;
use shisei_core::earth::analysis::{Believed, analyse};
use shisei_core::earth::direction::{Direction, DirectionSummary, drift, summarise};
use shisei_core::earth::{SPRESENSE_TICK_HZ, Weights, advice};

const DEG: f64 = core::f64::consts::PI / 180.0;
const DEG_H: f64 = DEG / 3600.0;

/// The eight directions printed in the article.
const ARTICLE: [[f64; 3]; 8] = [
    [-8.590145e-05, 1.027719e-04, -4.973161e-06],
    [-3.489062e-05, 1.068568e-04, -6.999941e-06],
    [2.255051e-06, 8.227464e-05, -2.155673e-06],
    [9.418819e-06, 3.407280e-05, -5.446403e-06],
    [-1.600360e-05, -8.387869e-06, -7.528374e-06],
    [-8.068976e-05, -1.206517e-05, -2.698692e-06],
    [-1.060789e-04, 1.037688e-05, -3.234577e-06],
    [-1.059256e-04, 6.629112e-05, -1.036393e-05],
];

#[test]
fn the_articles_table() {
    let directions = ARTICLE.map(|gyro_rad_s| Direction { gyro_rad_s, ..Direction::default() });
    let a = analyse(&directions, None).unwrap();
    let article = a.article.unwrap();
    // printed: 7.657707e-5 rad/s, 22.8 h, from unrounded means
    assert!((article.radius - 7.657707e-5).abs() <= 5e-11, "{}", article.radius);
    let day = core::f64::consts::TAU / article.radius / 3600.0;
    assert_eq!(format!("{day:.1}"), "22.8");
    assert!((article.condition - 334.0).abs() < 1.0, "{}", article.condition);
    assert!((a.circle.radius - 6.3769e-5).abs() < 5e-10, "{}", a.circle.radius);
    assert!(a.plane.flat);
    assert_eq!(a.believed, Believed::Circle);
    assert!(a.rate.is_none() && a.day_h.is_none());
    // with the latitude of Japan the circle gives the day
    let with = analyse(&directions, Some(35.7 * DEG)).unwrap();
    assert_eq!(with.believed, Believed::CircleWithLatitude);
    let day = with.day_h.unwrap();
    println!("article's circle with 35.7°: {:.2} ± {:.2} h", day.value, day.sigma);
    let latitude = a.latitude.unwrap();
    println!("latitude {:.1} ± {:.1}°", latitude.value / DEG, latitude.sigma / DEG);
    // poses that leave the plane are asked for
    let more = advice::suggest(&directions, &a, None, 4);
    assert_eq!(more.len(), 4);
    assert!(more.iter().any(|s| !(s.face.axis == 2 && s.face.positive)), "{more:?}");
}

/// Eight hexadecimal fields: tick, temperature, gyro, acc.
fn summary(degrees: &str, weights: Weights) -> Option<DirectionSummary> {
    let text = support::recording(&format!("earthrate_spresense/log_imu_{degrees}deg.txt"))?;
    let (mut gyro, mut acc, mut temperature, mut ticks) = (vec![], vec![], vec![], vec![]);
    for line in text.lines() {
        let words: Vec<u32> = line.split(',').filter_map(|w| u32::from_str_radix(w, 16).ok()).collect();
        if words.len() != 8 {
            continue;
        }
        let f = |i: usize| f64::from(f32::from_bits(words[i]));
        ticks.push(words[0]);
        temperature.push(f(1));
        gyro.push([f(2), f(3), f(4)]);
        acc.push([f(5), f(6), f(7)]);
    }
    let mut dt: Vec<f64> =
        ticks.windows(2).map(|t| f64::from(t[1].wrapping_sub(t[0])) / SPRESENSE_TICK_HZ).collect();
    let mut sorted = dt.clone();
    sorted.sort_by(f64::total_cmp);
    dt.insert(0, sorted[sorted.len() / 2]);
    let mut s = summarise(&gyro, &acc, &temperature, &dt, weights).unwrap();
    s.direction.heading_rad = Some(degrees.parse::<f64>().unwrap() * DEG);
    Some(s)
}

#[test]
fn sonys_headings() {
    let files = ["000", "090", "180", "270"];
    let all = |weights| files.iter().map(|f| summary(f, weights)).collect::<Option<Vec<_>>>();
    let Some(summaries) = all(Weights::Capped) else { return };
    let directions: Vec<Direction> = summaries.iter().map(|s| s.direction).collect();
    let a = analyse(&directions, None).unwrap();
    let (radius, sigma) = (a.circle.radius / DEG_H, a.circle.radius_sigma.unwrap() / DEG_H);
    let level = a.level_circle.horizontal.unwrap();
    println!(
        "plain circle {radius:.2} ± {sigma:.2} °/h, level {:.2} ± {:.2}",
        level.value / DEG_H,
        level.sigma / DEG_H
    );
    assert!((radius - 11.4).abs() <= 2.0 * sigma && sigma <= 1.2);
    assert!((level.value / DEG_H - 11.4).abs() <= 2.0 * level.sigma / DEG_H && level.sigma / DEG_H <= 1.2);
    // the headings' own sense fits, the opposite one does not
    let known = a.headings_known.unwrap();
    assert!(known.counter_clockwise_cost > 20.0 * known.clockwise_cost && known.sense_probability < 0.01);
    assert!((known.horizontal.value / DEG_H - 11.4).abs() <= 2.0 * known.horizontal.sigma / DEG_H);
    // four headings 90° apart come out 90° apart
    for k in 0..4 {
        let step = a.headings[(k + 1) % 4].heading_rad.value - a.headings[k].heading_rad.value;
        let off = (step / DEG - 90.0).rem_euclid(360.0);
        assert!(off.min(360.0 - off) < 25.0, "{off}");
    }
    // every sample by its own step, as the article weighs: the gaps' samples count too much
    let article: Vec<Direction> = all(Weights::AsMeasured).unwrap().iter().map(|s| s.direction).collect();
    let b = analyse(&article, None).unwrap();
    assert!((b.circle.radius / DEG_H - 12.29).abs() < 0.02, "{}", b.circle.radius / DEG_H);
    let d = drift(&summaries).unwrap();
    assert!(d.per_s_sigma.iter().all(|s| *s > 0.0));
}

#[test]
fn what_determines_nothing_is_refused() {
    let one = Direction { gyro_rad_s: ARTICLE[0], ..Direction::default() };
    assert!(matches!(analyse(&[one], None), Err(Error::TooFewPoints { given: 1, needed: 3 })));
    assert!(matches!(analyse(&[], None), Err(Error::TooFewPoints { .. })));
    assert_eq!(analyse(&[one; 8], None).unwrap_err(), Error::Degenerate);
    // errors below 0, or none
    for sigma in [-1e-6, f64::NAN] {
        let unsure = Direction { sigma_rad_s: Some([1e-6, sigma, 1e-6]), ..one };
        assert!(matches!(analyse(&[unsure; 3], None), Err(Error::Negative { name: "sigma_rad_s", .. })));
    }
    // identical but for noise
    let mut random = support::Random(2);
    let noisy: Vec<Direction> = (0..8)
        .map(|_| {
            let n = random.normal3(2e-6);
            Direction {
                gyro_rad_s: [n[0] + 1e-3, n[1], n[2]],
                sigma_rad_s: Some([2e-6; 3]),
                ..Direction::default()
            }
        })
        .collect();
    assert_eq!(analyse(&noisy, None).unwrap_err(), Error::Degenerate);
    let bad = Direction { gyro_rad_s: [f64::NAN, 0.0, 0.0], ..Direction::default() };
    assert!(matches!(analyse(&[one, bad, one], None), Err(Error::NotFinite { row: 1 })));
    let line: Vec<Direction> = (0..5)
        .map(|k| Direction { gyro_rad_s: [f64::from(k) * 1e-5, 0.0, 0.0], ..Direction::default() })
        .collect();
    assert_eq!(analyse(&line, None).unwrap_err(), Error::Degenerate);
    let directions = ARTICLE.map(|gyro_rad_s| Direction { gyro_rad_s, ..Direction::default() });
    assert!(matches!(analyse(&directions, Some(91.0 * DEG)), Err(Error::OutOfRange { .. })));
}
