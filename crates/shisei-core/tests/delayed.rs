//! Bridging a stream with a delay, against the smoother on the same samples and the simulator's truth.

use shisei_core::alignment::Alignment;
use shisei_core::estimator::{
    BridgeSettings, Bridged, FixedLagBridge, LiveBridge, OpticalPose, Sample, Settings, bridge,
};
use shisei_core::filter::Dt;
use shisei_core::frames::Pose;
use shisei_core::fuse::delayed::{Delayed, DelayedSettings};
use shisei_core::fuse::{FusedFrame, Source};
use shisei_core::vector;
use shisei_twin::simulate::{self, Errors, simulate};
use shisei_twin::{Motion as _, Sensor, movements};

const RATE_HZ: f64 = 120.0;
const OPTICS: BridgeSettings = BridgeSettings { attitude_rad: 0.0052, position_m: 5e-4, lever_m: 0.005 };

/// A sensor that cameras see at every sample, but not all the time: z up, at the body's point.
struct Take {
    samples: Vec<Sample>,
    truth: Vec<OpticalPose>,
    poses: Vec<Option<OpticalPose>>,
}

/// Hidden from `lost` to `lost + length_s` in every `every_s` from 10 s on.
fn take(seed: u64, end_s: f64, every_s: f64, length_s: f64) -> Take {
    let motion = movements::wander(seed, 4.0, end_s);
    let settings =
        simulate::Settings { errors: Errors::DrawnAligned, ..simulate::Settings::new(RATE_HZ, seed) };
    let simulation = simulate(&motion, &Sensor::lsm6ds3tr_c(), &settings);
    let (time_s, acc, gyro) = (simulation.time_s(), simulation.acc_m_s2(), simulation.gyro_rad_s());
    let samples = acc
        .iter()
        .zip(&gyro)
        .map(|(&acc_m_s2, &gyro_rad_s)| Sample { gyro_rad_s, acc_m_s2, dt_s: 1.0 / RATE_HZ })
        .collect();
    let truth: Vec<OpticalPose> = time_s
        .iter()
        .map(|&time_s| {
            let at = motion.state(time_s);
            OpticalPose { world_from_body: at.world_from_body, position_m: at.position_m }
        })
        .collect();
    let hidden = |time_s: f64| time_s > 10.0 && time_s.rem_euclid(every_s) < length_s;
    let poses = truth.iter().zip(&time_s).map(|(pose, time_s)| (!hidden(*time_s)).then_some(*pose));
    Take { samples, poses: poses.collect(), truth }
}

fn smoothed(take: &Take) -> Vec<Bridged> {
    let acc: Vec<_> = take.samples.iter().map(|sample| sample.acc_m_s2).collect();
    let gyro: Vec<_> = take.samples.iter().map(|sample| sample.gyro_rad_s).collect();
    let dt = Dt::Constant(1.0 / RATE_HZ);
    bridge(&acc, &gyro, dt, &take.poses, &OPTICS, &Settings::default()).expect("a take").0
}

fn lagged(take: &Take, lag_s: f64) -> Vec<Bridged> {
    let mut bridge = FixedLagBridge::new(&OPTICS, &Settings::default(), lag_s).expect("settings");
    let mut out = Vec::new();
    for (sample, pose) in take.samples.iter().zip(&take.poses) {
        bridge.update(sample, pose.as_ref(), &mut out);
    }
    bridge.finish(&mut out);
    out
}

/// Root mean square errors in the gaps, degrees and mm.
fn gap_errors(take: &Take, found: &[Bridged]) -> (f64, f64) {
    let (mut turned, mut moved, mut count) = (0.0, 0.0, 0.0);
    for ((found, truth), _) in
        found.iter().zip(&take.truth).zip(&take.poses).filter(|(_, pose)| pose.is_none())
    {
        let q = found.state.world_from_body.conjugate().product(truth.world_from_body);
        let apart = vector::norm(vector::sub(found.position_m, truth.position_m)) * 1e3;
        let angle = q.angle().to_degrees();
        turned += angle * angle;
        moved += apart * apart;
        count += 1.0;
    }
    ((turned / count).sqrt(), (moved / count).sqrt())
}

#[test]
fn all_in_one_window_is_the_smoother() {
    let mut take = take(3, 12.0, 1.5, 0.4);
    let rows = (12.0 * RATE_HZ) as usize;
    take.samples.truncate(rows);
    take.poses.truncate(rows);
    let (whole, window) = (smoothed(&take), lagged(&take, 10.0));
    assert_eq!(whole.len(), window.len());
    for (a, b) in whole.iter().zip(&window) {
        let turned = a.state.world_from_body.conjugate().product(b.state.world_from_body).angle();
        let apart = vector::norm(vector::sub(a.position_m, b.position_m));
        assert!(turned < 1e-7 && apart < 1e-8, "{turned} {apart}");
        assert!((a.sigma_position_m - b.sigma_position_m).abs() < 1e-7 * a.sigma_position_m);
    }
}

#[test]
fn gaps_shorter_than_half_the_lag_come_out_as_the_smoothers() {
    for (seed, length_s, lag_s) in [(1, 0.25, 0.5), (2, 0.5, 1.0), (3, 1.0, 2.0), (4, 1.5, 3.0)] {
        let take = take(seed, 60.0, 5.0, length_s);
        let (whole, late) = (gap_errors(&take, &smoothed(&take)), gap_errors(&take, &lagged(&take, lag_s)));
        let mut live = LiveBridge::new(&OPTICS, &Settings::default()).expect("settings");
        let causal: Vec<Bridged> =
            take.samples.iter().zip(&take.poses).map(|(s, pose)| live.update(s, pose.as_ref())).collect();
        let causal = gap_errors(&take, &causal);
        println!("gap {length_s} s, lag {lag_s} s: smoother {whole:.3?}, lag {late:.3?}, live {causal:.3?}");
        assert!(late.0 <= 1.5 * whole.0 && late.1 <= 1.5 * whole.1, "{late:?} {whole:?}");
        assert!(late.1 < 0.5 * causal.1, "{late:?} {causal:?}");
    }
}

/// The body is the sensor, the world z up.
fn fused(take: &Take, mut delayed: Delayed, from: usize) -> Vec<(f64, FusedFrame)> {
    let mut out = Vec::new();
    for k in from..take.samples.len() {
        let pose =
            take.poses[k].map(|p| Pose { position_m: p.position_m, world_from_body: p.world_from_body });
        delayed.update(k as f64 / RATE_HZ, &take.samples[k], pose.as_ref(), &mut out);
        let waits = k + 1 - from - out.len();
        assert!(waits as f64 <= 2.6 * RATE_HZ, "{waits} samples wait");
    }
    delayed.finish(&mut out);
    out
}

#[test]
fn every_sample_gets_a_pose_a_source_and_an_error_that_holds() {
    let take = take(7, 60.0, 5.0, 0.9);
    let settings = DelayedSettings { optics: OPTICS, ..DelayedSettings::default() };
    let alignment = Alignment::default();
    let rows = fused(&take, Delayed::new(&alignment, &settings).expect("settings"), 0);
    assert_eq!(rows.len(), take.samples.len());
    let (mut squares, mut said, mut count) = (0.0, 0.0, 0.0);
    for (k, (time_s, row)) in rows.iter().enumerate() {
        assert_eq!(*time_s, k as f64 / RATE_HZ);
        let pose = row.pose.expect("a pose");
        if let Some(seen) = take.poses[k] {
            assert_eq!((row.source, pose.position_m), (Source::Optical, seen.position_m));
            continue;
        }
        assert_eq!(row.source, Source::Bridged);
        assert!(row.gap_s > 0.0 && row.gap_s < 1.0);
        let off = vector::sub(pose.position_m, take.truth[k].position_m);
        squares += vector::dot(off, off);
        said += row.sigma_m * row.sigma_m;
        count += 1.0;
        let step = vector::norm(vector::sub(pose.position_m, rows[k - 1].1.pose.expect("a pose").position_m));
        let truly = vector::norm(vector::sub(take.truth[k].position_m, take.truth[k - 1].position_m));
        assert!((step - truly).abs() < 2e-3, "it jumps by {step} m at {time_s} s");
    }
    let (rms, said) = (f64::sqrt(squares / count) * 1e3, f64::sqrt(said / count) * 1e3);
    println!("gaps of 0.9 s: {rms:.2} mm, said {said:.2}");
    assert!(rms < 3.0 * said && said < 8.0 * rms, "{rms} mm, said {said}");
}

#[test]
fn it_goes_on_from_a_live_bridge() {
    let take = take(8, 30.0, 4.0, 0.8);
    let from = (10.0 * RATE_HZ) as usize;
    let mut live = LiveBridge::new(&OPTICS, &Settings::default()).expect("settings");
    for (sample, pose) in take.samples[..from].iter().zip(&take.poses) {
        live.update(sample, pose.as_ref());
    }
    let settings = DelayedSettings { optics: OPTICS, ..DelayedSettings::default() };
    let rows = fused(&take, Delayed::after(&live, &Alignment::default(), &settings).expect("settings"), from);
    let whole = smoothed(&take);
    let (mut ours, mut smoothers) = (0.0, 0.0);
    for ((k, (_, row)), whole) in (from..).zip(&rows).zip(&whole[from..]) {
        if take.poses[k].is_none() {
            let truth = take.truth[k].position_m;
            let apart2 = |p| vector::dot(vector::sub(p, truth), vector::sub(p, truth));
            ours += apart2(row.pose.expect("a pose").position_m);
            smoothers += apart2(whole.position_m);
        }
    }
    assert!(ours.sqrt() < 1.5 * smoothers.sqrt(), "{ours} {smoothers}");
}

#[test]
fn a_hole_in_the_samples_cuts_the_position_off() {
    let mut take = take(9, 30.0, 100.0, 0.0);
    let at = (20.0 * RATE_HZ) as usize;
    take.samples[at].dt_s = 3.0;
    take.poses[at - 60..].fill(None);
    let rows = lagged(&take, 1.0);
    assert_eq!(rows.len(), take.samples.len());
    assert!(rows[at - 1].sigma_position_m < 1.0 && rows[at - 61].sigma_position_m < 0.01);
    assert!(rows[at..].iter().all(|row| row.sigma_position_m == f64::INFINITY));
    // with sight after it, as long as from one update to the next, the position follows from that
    let seen = at + 88..at + 94;
    seen.for_each(|k| take.poses[k] = Some(take.truth[k]));
    let rows = lagged(&take, 1.0);
    assert!(rows[at + 10].sigma_position_m == f64::INFINITY, "the level is being found");
    assert!(rows[at + 80].sigma_position_m < 0.3 && rows[at + 100].sigma_position_m < 0.3);
    let off = vector::norm(vector::sub(rows[at + 90].position_m, take.truth[at + 90].position_m));
    assert!(off < 0.01, "{off}");
}

#[test]
fn nonsense_is_survived_and_memory_stays_bounded() {
    let take = take(2, 12.0, 1.5, 0.4);
    let mut delayed = Delayed::new(&Alignment::default(), &DelayedSettings::default()).expect("settings");
    let (mut out, mut given) = (Vec::new(), 0);
    for round in 0..40_000_usize {
        let k = round % take.samples.len();
        let mut sample = take.samples[k];
        match round % 7 {
            0 if round > 3000 => sample.dt_s = f64::NAN,
            1 if round > 6000 => sample.gyro_rad_s[2] = f64::INFINITY,
            2 if round > 9000 => sample.acc_m_s2 = [f64::NAN; 3],
            3 if round > 12_000 => sample.dt_s = -1.0,
            _ if round > 20_000 => sample.dt_s = 0.0,
            _ => {}
        }
        let mut pose =
            take.poses[k].map(|p| Pose { position_m: p.position_m, world_from_body: p.world_from_body });
        if round % 5 == 0 {
            pose = pose.map(|pose| Pose { position_m: [f64::NAN, 0.0, 1e300], ..pose });
        }
        delayed.update(round as f64, &sample, pose.as_ref(), &mut out);
        given += 1;
        assert!(given - out.len() <= 16_384, "{round}");
    }
    delayed.finish(&mut out);
    assert_eq!(out.len(), given);
    let sane = |row: &FusedFrame| row.pose.is_none_or(|pose| pose.world_from_body.is_finite());
    assert!(out.iter().all(|(_, row)| sane(row)));
}

#[test]
fn settings_out_of_range_are_refused() {
    for lag_s in [-0.1, 10.1, f64::NAN] {
        let settings = DelayedSettings { lag_s, ..DelayedSettings::default() };
        assert!(Delayed::new(&Alignment::default(), &settings).is_err(), "{lag_s}");
    }
}
