//! Walks with a sensor on the foot against what is known of them.
#![allow(clippy::disallowed_methods)] // the comparison may use std's mathematics

mod support;

use shisei_core::filter::Dt;
use shisei_core::motion::foot::{FootSettings, foot};
use shisei_core::{Error, STANDARD_GRAVITY_M_S2 as G, Vec3};

struct Walk {
    time_s: Vec<f64>,
    dt_s: Vec<f64>,
    acc: Vec<Vec3>,
    gyro: Vec<Vec3>,
}

/// Rows whose time goes on; the first step is the nominal one.
fn walk(rows: &[Vec<f64>], acc_at: usize, gyro_at: usize, gyro_unit: f64) -> Walk {
    let mut w = Walk { time_s: vec![], dt_s: vec![], acc: vec![], gyro: vec![] };
    for r in rows.iter().filter(|r| r.len() >= 7) {
        let step = w.time_s.last().map_or(0.0025, |t| r[0] - t);
        if step <= 0.0 {
            continue;
        }
        w.time_s.push(r[0]);
        w.dt_s.push(step);
        w.acc.push([r[acc_at] * G, r[acc_at + 1] * G, r[acc_at + 2] * G]);
        w.gyro.push([r[gyro_at] * gyro_unit, r[gyro_at + 1] * gyro_unit, r[gyro_at + 2] * gyro_unit]);
    }
    w
}

#[test]
fn closed_walk() {
    let Some(text) = support::recording("zupt_xio_gait/short_walk.csv") else { return };
    let w = walk(&support::table(&text, ','), 4, 1, core::f64::consts::PI / 180.0);
    let track = foot(&w.acc, &w.gyro, Dt::PerSample(&w.dt_s), &FootSettings::default()).unwrap();
    let last = w.acc.len() - 1;
    let end = track.position_m[last];
    let error = (end[0] * end[0] + end[1] * end[1] + end[2] * end[2]).sqrt();
    println!("closing error {:.0} mm, band {:.0} mm", 1000.0 * error, 1000.0 * track.sigma_total_m(last));
    // its publishers' own analysis: 82 mm over about 25 m
    assert!(error <= 0.082, "{error}");
    assert!(error < 2.0 * track.sigma_total_m(last));
}

#[test]
fn footprints() {
    for n in [31, 32] {
        let folder = format!("zupt_gaitdriven_own/SensorConnectData_{n}");
        let Some(text) = support::recording(&format!("{folder}.csv")) else { return };
        let Some(points) = support::recording(&format!("{folder}_strideIndex_timestamp_gcpX_gcpY.csv"))
        else {
            return;
        };
        let w = walk(&support::table(&text, ','), 1, 4, 1.0);
        let points = support::table(&points, ',');
        let track = foot(&w.acc, &w.gyro, Dt::PerSample(&w.dt_s), &FootSettings::default()).unwrap();
        // the footprints' frame has z down, so y changes its sign; heading and start are free
        let ours: Vec<[f64; 2]> = points
            .iter()
            .map(|p| {
                let k = w.time_s.partition_point(|t| *t < p[1]).min(w.time_s.len() - 1);
                [track.position_m[k][0], -track.position_m[k][1]]
            })
            .collect();
        let truth: Vec<[f64; 2]> = points.iter().map(|p| [p[2], p[3]]).collect();
        let total: f64 = truth.windows(2).map(|p| (p[1][0] - p[0][0]).hypot(p[1][1] - p[0][1])).sum();
        let (mut s, mut c) = (0.0, 0.0);
        let from_first = |p: &[f64; 2], q: &[f64; 2]| (p[0] - q[0], p[1] - q[1]);
        for (o, t) in ours.iter().zip(&truth) {
            let ((ox, oy), (tx, ty)) = (from_first(o, &ours[0]), from_first(t, &truth[0]));
            c += ox * tx + oy * ty;
            s += ox * ty - oy * tx;
        }
        let (s, c) = s.atan2(c).sin_cos();
        let mut worst = 0.0_f64;
        for (o, t) in ours.iter().zip(&truth) {
            let ((ox, oy), (tx, ty)) = (from_first(o, &ours[0]), from_first(t, &truth[0]));
            worst = worst.max((c * ox - s * oy - tx).hypot(s * ox + c * oy - ty));
        }
        println!("walk {n}: {total:.1} m, worst footprint {worst:.2} m ({:.2} %)", 100.0 * worst / total);
        assert!(worst <= 0.02 * total, "{n}: {worst} of {total}");
    }
}

#[test]
fn a_walk_without_a_rest_is_refused() {
    let mut random = support::Random(1);
    let acc: Vec<Vec3> = (0..2000).map(|_| random.normal3(15.0)).collect();
    let gyro: Vec<Vec3> = (0..2000).map(|_| random.normal3(5.0)).collect();
    let refusal = foot(&acc, &gyro, Dt::Constant(0.005), &FootSettings::default()).unwrap_err();
    assert!(matches!(refusal, Error::NoRest { .. }), "{refusal:?}");
}

/// Walks with samples cut out of them: where the whole one ends lies within the stated band.
#[test]
fn holes_widen_the_band() {
    let deg = core::f64::consts::PI / 180.0;
    for (name, acc_at, gyro_at, unit) in [
        ("zupt_xio_gait/short_walk.csv", 4, 1, deg),
        ("zupt_gaitdriven_own/SensorConnectData_31.csv", 1, 4, 1.0),
    ] {
        let Some(text) = support::recording(name) else { return };
        let rows = support::table(&text, ',');
        let settings = FootSettings::default();
        let whole = walk(&rows, acc_at, gyro_at, unit);
        let track = foot(&whole.acc, &whole.gyro, Dt::PerSample(&whole.dt_s), &settings).unwrap();
        assert_eq!(track.holes, [], "{name}");
        let (end, span) = (track.position_m[whole.acc.len() - 1], whole.time_s[whole.acc.len() - 1]);
        let cut = |from: f64, length_s: f64| {
            let left: Vec<_> =
                rows.iter().filter(|r| !(r[0] > from && r[0] < from + length_s)).cloned().collect();
            let w = walk(&left, acc_at, gyro_at, unit);
            foot(&w.acc, &w.gyro, Dt::PerSample(&w.dt_s), &settings)
        };
        for length_s in [0.05, 0.1, 0.13] {
            for place in 0..8 {
                let from = span * (0.2 + 0.08 * f64::from(place));
                let track = cut(from, length_s).unwrap();
                let last = track.position_m.len() - 1;
                let off = shisei_core::vector::norm(shisei_core::vector::sub(track.position_m[last], end));
                let sigma = track.sigma_total_m(last);
                println!("{name}: {length_s} s at {from:.2} s: {off:.2} m of {sigma:.2} m");
                assert!(off < 3.0 * sigma, "{name}, {length_s} s at {from}: {off} of {sigma}");
            }
        }
        for length_s in [0.2, 0.8, 3.0] {
            let refusal = cut(0.5 * span, length_s).unwrap_err();
            let Error::HoleTooLong { at_s, seconds, .. } = refusal else { panic!("{refusal:?}") };
            assert!((at_s - 0.5 * span).abs() < 0.02 && (seconds - length_s).abs() < 0.02, "{refusal:?}");
        }
    }
}
