//! The library's path from `examples/pelvis.csv` to yaw, pitch and roll, held against the truth.

use shisei_core::filter::{Dt, Mahony, run};
use shisei_core::rest::{RestSettings, first_rest, gyro_bias, mean};
use shisei_core::vector::sub;
use shisei_core::{Quaternion, Vec3, heading, initial, relative};
use shisei_twin::movements::{PELVIS_PART_S, PELVIS_PAUSE_S, PELVIS_START_S};
use shisei_twin::{Simulation, recordings};

const DT: Dt<'static> = Dt::Constant(0.01);

/// Mahony kp 0.2 from the first rest; heading from the sensor's z laid flat, or yaw 0 of the sensor.
fn orient(simulation: &Simulation, forward: Option<Vec3>) -> Vec<Quaternion> {
    let (acc, gyro) = (simulation.acc_m_s2(), simulation.gyro_rad_s());
    let rest = first_rest(&acc, &gyro, DT, &RestSettings::default()).unwrap();
    let bias = gyro_bias(&gyro[rest.clone()]).unwrap();
    let mut start = initial::from_mean_acceleration(mean(&acc[rest]).unwrap()).unwrap();
    if let Some(axis) = forward {
        start = heading::from_forward_axis(start, axis).unwrap().product(start);
    }
    let rates: Vec<Vec3> = gyro.iter().map(|&raw| sub(raw, bias)).collect();
    run(&mut Mahony::new(start, 0.2, 0.0).unwrap(), &rates, &acc, DT).unwrap()
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
    let simulation = recordings::pelvis();
    let (acc, gyro) = (simulation.acc_m_s2(), simulation.gyro_rad_s());
    let rest = first_rest(&acc, &gyro, DT, &RestSettings::default()).unwrap();
    assert!(rest.start <= 5 && rest.end >= 250 && rest.end <= 340, "{rest:?}");
}

#[test]
fn attitude_is_within_one_degree_of_the_truth() {
    let simulation = recordings::pelvis();
    let worst = worst_deg(&simulation, &orient(&simulation, Some([0.0, 0.0, 1.0])));
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
            .map(|simulation| worst_deg(&simulation, &orient(&simulation, Some([0.0, 0.0, 1.0]))))
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
    let attitudes = orient(&simulation, Some([0.0, 0.0, 1.0]));
    let mut ypr_rad = vec![[0.0; 3]; attitudes.len()];
    relative::world_series(&attitudes, attitudes[0], &mut ypr_rad).unwrap();
    for part in 0..3 {
        let start_s = PELVIS_START_S + part as f64 * (PELVIS_PART_S + PELVIS_PAUSE_S);
        let mut extent = [0.0_f64; 3];
        for (sample, ypr) in simulation.samples.iter().zip(&ypr_rad) {
            if sample.time_s < start_s || sample.time_s > start_s + PELVIS_PART_S {
                continue;
            }
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
    assert!(heading::is_near_gimbal_lock(orient(&simulation, None)[0]));
}
