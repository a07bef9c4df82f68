//! Simulated takes with holes, filled from the sensor, against the simulator's truth.

use shisei_core::frames::{Axes, Pose};
use shisei_core::fuse::{FuseSettings, Fusion, Inertial, Optical, Source, fuse};
use shisei_core::{Error, Quaternion, vector};
use shisei_twin::optics::{Cameras, Frame, Rig, film};
use shisei_twin::simulate::{Errors, Settings, simulate};
use shisei_twin::{Random, Sensor, Simulation, movements};

fn take(seed: u64, lost_s: Vec<(f64, f64)>) -> (Vec<Frame>, Simulation) {
    let mut random = Random::new(seed, 9);
    let rig = Rig {
        body_from_sensor: Quaternion::from_rotation_vector(vector::scale(random.direction(), 2.0)),
        sensor_m: [0.03, -0.02, 0.05],
        markers_m: Vec::new(),
    };
    let motion = movements::wander(seed, 4.0, 52.0);
    let settings = Settings { errors: Errors::DrawnAligned, ..Settings::new(200.0, seed) };
    let cameras = Cameras { offset_s: 3.3, skew: 4e-5, lost_s, ..Cameras::new(120.0, 50.0, seed) };
    (film(&motion, &rig, &cameras), simulate(&motion, &Sensor::lsm6ds3tr_c(), &settings))
}

/// Motive's world: y up.
fn y_up(pose: Pose) -> Pose {
    Axes::ZUp.to(Axes::YUp).world_of_pose(pose).expect("right-handed")
}

fn fused(frames: &[Frame], simulation: &Simulation) -> Result<Fusion, Error> {
    let time_s: Vec<f64> = frames.iter().map(|frame| frame.time_s).collect();
    let poses: Vec<Option<Pose>> = frames.iter().map(|frame| frame.pose.map(y_up)).collect();
    let (sensor_s, acc, gyro) = (simulation.time_s(), simulation.acc_m_s2(), simulation.gyro_rad_s());
    fuse(
        &Optical { time_s: &time_s, poses: &poses },
        &Inertial { time_s: &sensor_s, acc_m_s2: &acc, gyro_rad_s: &gyro },
        &FuseSettings::default(),
    )
}

/// RMS errors of some frames: degrees and mm.
fn errors(fusion: &Fusion, frames: &[Frame], rows: core::ops::Range<usize>) -> (f64, f64) {
    let (mut turned, mut moved, count) = (0.0, 0.0, rows.len() as f64);
    for row in rows {
        let (found, truth) = (fusion.frames[row].pose.expect("filled"), y_up(frames[row].truth));
        let angle = found.world_from_body.conjugate().product(truth.world_from_body).angle().to_degrees();
        let apart = vector::norm(vector::sub(found.position_m, truth.position_m)) * 1e3;
        turned += angle * angle / count;
        moved += apart * apart / count;
    }
    (turned.sqrt(), moved.sqrt())
}

#[test]
fn gaps_of_one_and_five_seconds_are_filled() {
    for seed in [1, 2, 3] {
        let lost = vec![(12.0, 13.0), (20.0, 25.0), (33.0, 34.0)];
        let (frames, simulation) = take(seed, lost);
        let fusion = fused(&frames, &simulation).expect("one object");
        assert_eq!(fusion.gaps.len(), 3);
        for gap in &fusion.gaps {
            let (turned, moved) = errors(&fusion, &frames, gap.first..gap.end);
            println!(
                "{seed}: {:.2} s: {turned:.3}° (said {:.3}), {moved:.1} mm (said {:.1})",
                gap.length_s,
                gap.sigma_rad.to_degrees(),
                gap.sigma_m * 1e3
            );
            assert_eq!(gap.source, Source::Bridged);
            let said = (gap.sigma_rad.to_degrees(), gap.sigma_m * 1e3);
            assert!(turned < 3.0 * said.0 && moved < 3.0 * said.1, "{turned} {moved}: said {said:?}");
            let (most_deg, most_mm) = if gap.length_s > 2.0 { (0.3, 40.0) } else { (0.2, 6.0) };
            assert!(turned < most_deg && moved < most_mm, "{turned}° {moved} mm in {:.2} s", gap.length_s);
        }
        for (frame, fused) in frames.iter().zip(&fusion.frames) {
            if let Some(pose) = frame.pose {
                assert_eq!((fused.pose, fused.source), (Some(y_up(pose)), Source::Optical));
            }
        }
        // nothing jumps at the ends of a gap: a step is at most what the motion makes of it
        let step = |a: usize| {
            let p = |row: usize| fusion.frames[row].pose.expect("filled").position_m;
            vector::norm(vector::sub(p(a + 1), p(a)))
        };
        for gap in &fusion.gaps {
            assert!((step(gap.first - 1) - step(gap.first)).abs() < 1e-3);
            assert!((step(gap.end - 1) - step(gap.end - 2)).abs() < 1e-3);
        }
        assert!((fusion.up[1] - 1.0).abs() < 1e-3 && fusion.lever.is_some(), "{:?}", fusion.lever);
    }
}

#[test]
fn open_ends_and_what_nobody_saw_are_marked() {
    let (frames, mut simulation) = take(4, vec![(0.0, 1.0), (45.0, 60.0)]);
    // the sensor stops at 50 s of its clock: 46.7 s of the cameras'
    let kept = simulation.samples.iter().take_while(|sample| sample.time_s < 50.0).count();
    simulation.samples.truncate(kept);
    let fusion = fused(&frames, &simulation).expect("one object");
    assert_eq!(fusion.gaps.len(), 2);
    assert_eq!(fusion.gaps[0].source, Source::Inertial);
    assert_eq!(fusion.gaps[1].source, Source::None);
    let at = |time_s: f64| fusion.frames[(time_s * 120.0) as usize];
    assert_eq!((at(46.0).source, at(48.0).source, at(48.0).pose), (Source::Inertial, Source::None, None));
    assert!(at(46.0).pose.is_some() && (at(46.0).gap_s - 1.0).abs() < 0.02 && at(48.0).sigma_m.is_nan());
    let (turned, _) = errors(&fusion, &frames, 5400..5500);
    assert!(turned < 0.5, "{turned}");
}

#[test]
fn two_objects_are_refused() {
    let (frames, _) = take(1, Vec::new());
    let (_, simulation) = take(2, Vec::new());
    let error = fused(&frames, &simulation).expect_err("two objects");
    assert!(matches!(error, Error::NoCommonMotion { .. }), "{error}");
}
