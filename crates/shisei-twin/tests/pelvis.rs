//! The library's path from `examples/pelvis.csv` to yaw, pitch and roll, held against the truth.

use shisei_core::orient::{Orientation, Settings, orient};
use shisei_core::{Quaternion, Vec3, heading};
use shisei_twin::movements::{PELVIS_PART_S, PELVIS_PAUSE_S, PELVIS_START_S};
use shisei_twin::{Simulation, recordings};

const FORWARD: Option<Vec3> = Some([0.0, 0.0, 1.0]);

/// The defaults: bias and start from the first rest, Mahony kp 0.2, relative to the start in world axes.
fn oriented(simulation: &Simulation, forward_axis_body: Option<Vec3>) -> Orientation {
    let time_s = simulation.time_s();
    let mut dt_s: Vec<f64> = time_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
    dt_s.insert(0, 0.01);
    let settings = Settings { forward_axis_body, ..Settings::default() };
    orient(&simulation.acc_m_s2(), &simulation.gyro_rad_s(), &dt_s, &settings).unwrap()
}

/// Largest angle to the truth, degrees.
fn worst_deg(simulation: &Simulation, attitudes: &[Quaternion]) -> f64 {
    let pairs = attitudes.iter().zip(&simulation.truth);
    pairs
        .map(|(q, truth)| q.conjugate().product(truth.world_from_body).angle().to_degrees())
        .fold(0.0, f64::max)
}

#[test]
fn the_first_rest_ends_before_the_movement() {
    let rest = oriented(&recordings::pelvis(), FORWARD).rest.unwrap();
    assert!(rest.start <= 5 && rest.end >= 250 && rest.end <= 340, "{rest:?}");
}

#[test]
fn attitude_is_within_one_degree_of_the_truth() {
    let simulation = recordings::pelvis();
    let worst = worst_deg(&simulation, &oriented(&simulation, FORWARD).world_from_body);
    println!("largest error {worst:.3} deg");
    assert!(worst < 1.0, "{worst} deg");
}

/// Not by the luck of one seed. With the noise of the printed rows the heading wanders further; those
/// figures are printed only.
#[test]
fn attitude_stays_within_one_degree_for_other_seeds() {
    for noise in [0.1, 1.0] {
        let mut worst: Vec<f64> = (0..100)
            .map(|seed| recordings::pelvis_with_noise(noise, seed))
            .map(|simulation| worst_deg(&simulation, &oriented(&simulation, FORWARD).world_from_body))
            .collect();
        worst.sort_by(f64::total_cmp);
        println!("noise {noise}: median {:.2} deg, largest {:.2} deg", worst[50], worst[99]);
        assert!(noise > 0.5 || worst[99] < 1.0, "{worst:?}");
    }
}

/// With the wearer's forward axis each movement shows in its own angle and stays under 2° in the others.
#[test]
fn with_a_forward_axis_twist_bend_and_lean_do_not_mix() {
    let simulation = recordings::pelvis();
    let orientation = oriented(&simulation, FORWARD);
    for part in 0..3 {
        let start_s = PELVIS_START_S + part as f64 * (PELVIS_PART_S + PELVIS_PAUSE_S);
        let mut extent = [0.0_f64; 3];
        for (k, sample) in simulation.samples.iter().enumerate() {
            if sample.time_s < start_s || sample.time_s > start_s + PELVIS_PART_S {
                continue;
            }
            let ypr = orientation.ypr(k).to_array();
            for angle in 0..3 {
                extent[angle] = extent[angle].max(ypr[angle].to_degrees().abs());
            }
        }
        println!("part {part}: yaw, pitch, roll up to {extent:.2?} deg");
        for angle in 0..3 {
            let moves = angle == part;
            assert!(moves == (extent[angle] > 15.0) && (moves || extent[angle] < 2.0), "{part}: {extent:?}");
        }
    }
}

/// Without it the sensor's x stands near the vertical and the directions of bend and lean are accidental.
#[test]
fn without_a_forward_axis_the_start_is_near_gimbal_lock() {
    let simulation = recordings::pelvis();
    assert!(heading::is_near_gimbal_lock(oriented(&simulation, None).start));
}
