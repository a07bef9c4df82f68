//! Simulated takes in which inertial samples are missing where the cameras see nothing either, against the simulator's
//! truth: what is filled must be as good as it says, and nothing may be called what it is not.

use shisei_core::frames::{Axes, Pose};
use shisei_core::fuse::{FuseSettings, FusedFrame, Fusion, Inertial, Optical, Source, Unfilled, fuse};
use shisei_core::{Quaternion, vector};
use shisei_twin::optics::{Cameras, Frame, Rig, film};
use shisei_twin::simulate::{Errors, Settings, simulate};
use shisei_twin::{Random, Sensor, movements};

const OFFSET_S: f64 = 3.3;
const FRAMES_HZ: f64 = 120.0;

/// A take of `length_s` whose body is lost at these times; samples between these times of the cameras are missing.
fn fused(
    seed: u64,
    rate_hz: f64,
    length_s: f64,
    lost_s: &[(f64, f64)],
    holes_s: &[(f64, f64)],
) -> (Vec<Frame>, Fusion) {
    let mut random = Random::new(seed, 9);
    let rig = Rig {
        body_from_sensor: Quaternion::from_rotation_vector(vector::scale(random.direction(), 2.0)),
        sensor_m: [0.03, -0.02, 0.05],
        markers_m: Vec::new(),
    };
    let motion = movements::wander(seed, 4.0, length_s + 5.0);
    let settings = Settings { errors: Errors::DrawnAligned, ..Settings::new(rate_hz, seed) };
    let cameras =
        Cameras { offset_s: OFFSET_S, lost_s: lost_s.to_vec(), ..Cameras::new(FRAMES_HZ, length_s, seed) };
    let frames = film(&motion, &rig, &cameras);
    let mut simulation = simulate(&motion, &Sensor::lsm6ds3tr_c(), &settings);
    simulation.samples.retain(|sample| {
        let time_s = sample.time_s - OFFSET_S;
        !holes_s.iter().any(|(from_s, to_s)| time_s > *from_s && time_s < *to_s)
    });
    let time_s: Vec<f64> = frames.iter().map(|frame| frame.time_s).collect();
    let poses: Vec<Option<Pose>> = frames.iter().map(|frame| frame.pose).collect();
    let (sensor_s, acc, gyro) = (simulation.time_s(), simulation.acc_m_s2(), simulation.gyro_rad_s());
    let fusion = fuse(
        &Optical { time_s: &time_s, poses: &poses },
        &Inertial { time_s: &sensor_s, acc_m_s2: &acc, gyro_rad_s: &gyro },
        &FuseSettings { axes: Axes::ZUp, ..FuseSettings::default() },
    );
    (frames, fusion.expect("one object"))
}

/// What a frame is off by, as a multiple of what is said: attitude and position.
fn off(frame: &Frame, fused: &FusedFrame) -> Option<(f64, f64)> {
    let (found, truth) = (fused.pose?, frame.truth);
    let turned = found.world_from_body.conjugate().product(truth.world_from_body).angle();
    let moved = vector::norm(vector::sub(found.position_m, truth.position_m));
    Some((turned / fused.sigma_rad, moved / fused.sigma_m))
}

#[test]
fn holes_within_gaps_are_crossed_as_well_as_is_said() {
    // a gap of a second every two and a half, each with a hole of another length at another place
    let lengths_s = [0.05, 0.09, 0.15, 0.25, 0.45, 0.85];
    // where it begins in what the gap leaves free; the first and last reach into what the cameras saw
    let places = [-0.1, 0.05, 0.5, 0.95, 1.1];
    let cases: Vec<(f64, f64)> =
        lengths_s.iter().flat_map(|length_s| places.map(|place| (*length_s, place))).collect();
    let gap_s = |k: usize| 10.0 + 2.5 * k as f64;
    let lost_s: Vec<(f64, f64)> = (0..cases.len()).map(|k| (gap_s(k), gap_s(k) + 1.0)).collect();
    let begins = |k: usize, (length_s, place): (f64, f64)| gap_s(k) + place * (1.0 - length_s);
    let holes_s: Vec<(f64, f64)> =
        cases.iter().enumerate().map(|(k, case)| (begins(k, *case), begins(k, *case) + case.0)).collect();
    let (mut worst, mut squares, mut count) = ((0.0_f64, 0.0_f64), (0.0_f64, 0.0_f64), 0.0);
    for (seed, rate_hz) in [(1, 200.0), (2, 285.0), (3, 100.0), (4, 200.0)] {
        let (frames, fusion) = fused(seed, rate_hz, gap_s(cases.len()), &lost_s, &holes_s);
        assert_eq!(fusion.gaps.len(), cases.len());
        for ((gap, hole), case) in fusion.gaps.iter().zip(&holes_s).zip(&cases) {
            let mut largest = (0.0_f64, 0.0_f64);
            for row in gap.first..gap.end {
                let (frame, found) = (&frames[row], &fusion.frames[row]);
                let time_s = frame.time_s;
                // a sample's length or two beside a hole may go either way
                let near = |end_s: f64| (time_s - end_s).abs() < 3.0 / rate_hz;
                if !(near(hole.0) || near(hole.1)) {
                    // a hole that the cameras saw across takes neither end of the gap away
                    let beside = hole.1 < frames[gap.first - 1].time_s || hole.0 > frames[gap.end].time_s;
                    let expected = if case.0 < 0.1 || beside {
                        Source::Bridged
                    } else if time_s > hole.0 && time_s < hole.1 {
                        Source::None
                    } else {
                        Source::Inertial
                    };
                    assert_eq!(found.source, expected, "{case:?} at {time_s}");
                }
                let Some(off) = off(frame, found) else { continue };
                assert!(found.sigma_m > 1e-4 && found.sigma_m < 2.0, "{case:?}: said {} m", found.sigma_m);
                assert!(found.sigma_rad > 1e-4 && found.sigma_rad < 0.5, "{case:?}: {}", found.sigma_rad);
                largest = (largest.0.max(off.0), largest.1.max(off.1));
                squares.0 += off.0 * off.0;
                squares.1 += off.1 * off.1;
                count += 1.0;
            }
            println!("{seed} {case:?}: at most {:.2} and {:.2} of what is said", largest.0, largest.1);
            worst = (worst.0.max(largest.0), worst.1.max(largest.1));
            let none = (gap.first..gap.end).filter(|&row| fusion.frames[row].pose.is_none()).count();
            assert_eq!(gap.unfilled, Unfilled { silent: none, ..Unfilled::default() });
        }
    }
    let rms = ((squares.0 / count).sqrt(), (squares.1 / count).sqrt());
    println!("RMS {:.2} and {:.2} of what is said, at most {:.2} and {:.2}", rms.0, rms.1, worst.0, worst.1);
    assert!(rms.0 < 1.0 && rms.1 < 1.0 && worst.0 < 3.0 && worst.1 < 3.0, "{rms:?} {worst:?}");
}

#[test]
fn a_hole_in_a_long_gap_leaves_both_its_sides_as_good_as_is_said() {
    let lost_s = [(15.0, 18.0), (25.0, 33.0), (45.0, 65.0)];
    let holes_s = lost_s.map(|(from_s, to_s)| (0.5 * (from_s + to_s) - 0.15, 0.5 * (from_s + to_s) + 0.15));
    for seed in [6, 7] {
        let (frames, fusion) = fused(seed, 200.0, 80.0, &lost_s, &holes_s);
        for gap in &fusion.gaps {
            let mut worst = (0.0_f64, 0.0_f64);
            for row in gap.first..gap.end {
                let Some((turned, moved)) = off(&frames[row], &fusion.frames[row]) else { continue };
                worst = (worst.0.max(turned), worst.1.max(moved));
                assert_eq!(fusion.frames[row].source, Source::Inertial);
            }
            let sides = [gap.first, gap.end - 1].map(|row| fusion.frames[row].sigma_m * 1e3);
            let middle = usize::midpoint(gap.first, gap.end);
            let most = [middle - 30, middle + 30].map(|row| fusion.frames[row].sigma_m * 1e3);
            println!(
                "{seed}: {:.1} s: {worst:.2?} of what is said: {sides:.1?} to {most:.1?} mm",
                gap.length_s
            );
            assert!(worst.0 < 3.0 && worst.1 < 3.0, "{worst:?}");
            assert!(sides.iter().all(|side_mm| (0.3..10.0).contains(side_mm)), "{sides:?}");
            assert!(most[0].max(most[1]) < 3000.0, "{most:?}");
        }
    }
}

#[test]
fn between_two_holes_nothing_holds_the_sensor() {
    let (_, fusion) = fused(5, 200.0, 40.0, &[(20.0, 23.0)], &[(20.5, 20.8), (22.0, 22.4)]);
    let at = |time_s: f64| &fusion.frames[(time_s * FRAMES_HZ) as usize];
    for (time_s, source) in [
        (19.9, Source::Optical),
        (20.4, Source::Inertial),
        (20.6, Source::None),
        (21.5, Source::None),
        (22.2, Source::None),
        (22.7, Source::Inertial),
    ] {
        let found = at(time_s);
        assert_eq!((found.source, found.pose.is_some()), (source, source != Source::None), "{time_s}");
    }
    let gap = &fusion.gaps[0];
    assert_eq!((gap.source, gap.unfilled.holder), (Source::None, 0));
    // 1.2 s lie between the holes, 0.7 s in them
    assert!((140..=146).contains(&gap.unfilled.loose), "{:?}", gap.unfilled);
    assert!((82..=88).contains(&gap.unfilled.silent), "{:?}", gap.unfilled);
}
