//! The estimator in all its forms, over a recording with gaps and unreadable samples.

use alloc::vec::Vec;

use shisei_core::estimator::{
    BridgeSettings, Bridged, Calibration, Estimator, FixedLag, FixedLagBridge, LightEstimator, LiveBridge,
    OpticalPose, Sample, Settings, State, bridge, smooth,
};
use shisei_core::filter::Dt;

use crate::hash::Digest;
use crate::input::{Input, Recording, recording};

const ROWS: usize = 1024;

fn samples(rows: usize) -> Vec<Sample> {
    let Recording { gyro_rad_s, acc_m_s2, dt_s } = recording(70, rows);
    let mut samples: Vec<Sample> = gyro_rad_s
        .iter()
        .zip(acc_m_s2.iter().zip(&dt_s))
        .map(|(&gyro_rad_s, (&acc_m_s2, &dt_s))| Sample { gyro_rad_s, acc_m_s2, dt_s })
        .collect();
    for (row, sample) in samples.iter_mut().enumerate() {
        match row % 400 {
            250 => sample.dt_s = 0.9,
            300 => sample.gyro_rad_s[1] = f64::NAN,
            310 => sample.acc_m_s2 = [0.0; 3],
            320 => sample.dt_s = f64::INFINITY,
            _ => {}
        }
    }
    samples
}

fn push_state(digest: &mut Digest, state: &State) {
    digest.push_quaternion(state.world_from_body);
    digest.push_all(&state.rate_rad_s);
    digest.push_all(&state.gyro_bias_rad_s);
    digest.push_all(&[state.sigma_tilt_rad, state.sigma_heading_rad]);
}

fn push_calibration(digest: &mut Digest, calibration: &Calibration) {
    digest.push_all(&calibration.gyro_bias_rad_s);
    digest.push_all(&calibration.acc_bias_m_s2);
    for row in calibration.gyro_matrix.iter().chain(&calibration.acc_matrix) {
        digest.push_all(row);
    }
    for row in &calibration.covariance {
        digest.push_all(row);
    }
}

pub fn online(digest: &mut Digest) {
    digest.push_result(Estimator::new(&Settings::default()), |digest, mut estimator| {
        for sample in &samples(ROWS) {
            push_state(digest, &estimator.update(sample));
        }
    });
}

pub fn light(digest: &mut Digest) {
    digest.push_result(LightEstimator::new(&Settings::default()), |digest, mut estimator| {
        for sample in &samples(ROWS) {
            push_state(digest, &estimator.update(sample));
        }
    });
}

pub fn lag(digest: &mut Digest) {
    digest.push_result(FixedLag::new(&Settings::default(), 0.5), |digest, mut estimator| {
        let mut states = Vec::new();
        for sample in &samples(300) {
            estimator.update(sample, &mut states);
        }
        estimator.finish(&mut states);
        for state in &states {
            push_state(digest, state);
        }
    });
}

pub fn calibration(digest: &mut Digest) {
    digest.push_result(Estimator::new(&Settings::default()), |digest, mut estimator| {
        for sample in &samples(ROWS) {
            estimator.update(sample);
        }
        let learnt = estimator.calibration();
        push_calibration(digest, &learnt);
        digest.push_all(&learnt.correct_gyro([0.1, -0.2, 0.3]));
        digest.push_all(&learnt.correct_acc([1.0, 2.0, 9.0]));
        let again = Settings { calibration: Some(learnt), ..Settings::default() };
        digest.push_result(Estimator::new(&again), |digest, mut estimator| {
            for sample in &samples(200) {
                push_state(digest, &estimator.update(sample));
            }
            push_calibration(digest, &estimator.calibration());
        });
    });
    let sigmas = ([0.0; 3], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    let wrong = Calibration::with_sigmas(([f64::NAN; 3], sigmas.1), sigmas, 0.1, 0.1, 0.1, 0.1);
    digest.push_result(wrong.check(), |_, ()| ());
}

pub fn smoother(digest: &mut Digest) {
    let Recording { gyro_rad_s, acc_m_s2, dt_s } = recording(71, 300);
    digest.push_result(
        smooth(&acc_m_s2, &gyro_rad_s, Dt::PerSample(&dt_s), &Settings::default()),
        |digest, smoothed| {
            for state in &smoothed.states {
                push_state(digest, state);
            }
            push_calibration(digest, &smoothed.calibration);
        },
    );
}

/// Poses in four of ten samples.
fn poses(input: &mut Input, rows: usize) -> Vec<Option<OpticalPose>> {
    (0..rows)
        .map(|row| {
            let pose = OpticalPose { world_from_body: input.quaternion(), position_m: input.vec3(0.1) };
            (row % 100 < 40).then_some(pose)
        })
        .collect()
}

fn push_bridged(digest: &mut Digest, row: &Bridged) {
    push_state(digest, &row.state);
    digest.push_all(&row.velocity_m_s);
    digest.push_all(&row.position_m);
    digest.push(row.sigma_position_m);
}

pub fn bridged(digest: &mut Digest) {
    let Recording { gyro_rad_s, acc_m_s2, dt_s } = recording(72, 300);
    let poses = poses(&mut Input::new(73), 300);
    let (optics, settings) = (BridgeSettings::default(), Settings::default());
    digest.push_result(
        bridge(&acc_m_s2, &gyro_rad_s, Dt::PerSample(&dt_s), &poses, &optics, &settings),
        |digest, (rows, _)| {
            for row in &rows {
                push_bridged(digest, row);
            }
        },
    );
}

pub fn live_bridge(digest: &mut Digest) {
    let poses = poses(&mut Input::new(74), 300);
    digest.push_result(
        LiveBridge::new(&BridgeSettings::default(), &Settings::default()),
        |digest, mut bridge| {
            for (sample, pose) in samples(300).iter().zip(&poses) {
                push_bridged(digest, &bridge.update(sample, pose.as_ref()));
            }
        },
    );
}

pub fn lag_bridge(digest: &mut Digest) {
    let poses = poses(&mut Input::new(75), 300);
    digest.push_result(
        FixedLagBridge::new(&BridgeSettings::default(), &Settings::default(), 0.3),
        |digest, mut bridge| {
            let mut rows = Vec::new();
            for (sample, pose) in samples(300).iter().zip(&poses) {
                bridge.update(sample, pose.as_ref(), &mut rows);
            }
            bridge.finish(&mut rows);
            for row in &rows {
                push_bridged(digest, row);
            }
        },
    );
}
