//! Calibrations of accelerometers and gyroscopes.

use alloc::vec::Vec;

use shisei_core::calibration::gyro_turns::{self, TurnSettings};
use shisei_core::calibration::known_turns::{self, TurnAngle};
use shisei_core::calibration::multi_pose::{self, Pose};
use shisei_core::calibration::recording::{calibrate_poses, find_parts};
use shisei_core::calibration::still::{StillSegment, StillSettings, still_segments};
use shisei_core::calibration::{self, Calibration, FaceWindow, SensorModel, SixFaceSettings};
use shisei_core::{Result, STANDARD_GRAVITY_M_S2};

use crate::hash::Digest;
use crate::input::{Input, POSED_DT_S, Recording, posed};

const SEED: u64 = 50;

fn segments(made: &Recording) -> Result<Vec<StillSegment>> {
    still_segments(&made.acc_m_s2, &made.gyro_rad_s, POSED_DT_S, &StillSettings::default())
}

fn push_affine(digest: &mut Digest, affine: &SensorModel) {
    digest.push_vec3(affine.bias);
    digest.push_all(affine.matrix.as_flattened());
}

fn push_window(digest: &mut Digest, window: &FaceWindow) {
    digest.push_u64(window.start_row as u64);
    for vector in [window.acc_mean, window.acc_variance, window.acc_mean_variance] {
        digest.push_vec3(vector);
    }
    for vector in [window.gyro_mean, window.gyro_mean_variance] {
        digest.push_vec3(vector);
    }
    digest.push_all(&[window.tilt_rad, window.worst_variance(), window.mean_norm()]);
}

pub fn apply(digest: &mut Digest) {
    let mut input = Input::new(51);
    for _ in 0..64 {
        let numbers: [f64; 12] = core::array::from_fn(|_| input.signed());
        let calibration = Calibration::from_twelve(numbers);
        digest.push_all(&calibration.to_twelve());
        digest.push_all(&calibration.to_nine());
        let matrix = [input.vec3(1.0), input.vec3(1.0), input.vec3(1.0)];
        let model = SensorModel { bias: input.vec3(1.0), matrix };
        digest.push_vec3(model.apply(input.vec3(10.0)));
        let raw: [[f64; 3]; 8] = core::array::from_fn(|_| input.vec3(10.0));
        let mut corrected = [[0.0; 3]; 8];
        let done = calibration.accelerometer.apply_series(&raw, &mut corrected);
        digest.push_result(done, |digest, ()| digest.push_all(corrected.as_flattened()));
    }
}

pub fn sensor_model(digest: &mut Digest) {
    let mut input = Input::new(52);
    for _ in 0..64 {
        let model = SensorModel {
            bias: input.vec3(1.0),
            matrix: [input.vec3(1.0), input.vec3(1.0), input.vec3(1.0)],
        };
        let raw = input.vec3(10.0);
        digest.push_vec3(model.apply(raw));
        digest.push_result(model.unapply(raw), Digest::push_vec3);
    }
}

pub fn search(digest: &mut Digest) {
    let made = posed(SEED);
    let settings = SixFaceSettings::default();
    let found = calibration::search_faces(&made.acc_m_s2, &made.gyro_rad_s, POSED_DT_S, &settings);
    digest.push_result(found, |digest, table| {
        digest.push_u64(table.missing().count() as u64);
        for window in table.faces.iter().filter_map(|row| row.window) {
            push_window(digest, &window);
        }
    });
}

pub fn six_face(digest: &mut Digest) {
    let made = posed(SEED);
    let settings = SixFaceSettings::default();
    // with all faces, and without those of the second half
    for rows in [made.acc_m_s2.len(), made.acc_m_s2.len() / 4] {
        let (acc, gyro) = (&made.acc_m_s2[..rows], &made.gyro_rad_s[..rows]);
        digest.push_result(calibration::six_face(acc, gyro, POSED_DT_S, &settings), |digest, found| {
            digest.push_all(&found.calibration.to_twelve());
            digest.push_all(found.acc_covariance.as_flattened());
            digest.push_vec3(found.gyro_bias_variance);
        });
    }
}

pub fn still(digest: &mut Digest) {
    digest.push_result(segments(&posed(SEED)), |digest, found| {
        for segment in found {
            digest.push_u64(segment.start as u64);
            digest.push_u64(segment.end as u64);
            for vector in [segment.acc_mean, segment.acc_variance, segment.gyro_mean, segment.gyro_variance] {
                digest.push_vec3(vector);
            }
        }
    });
}

pub fn multi_pose(digest: &mut Digest) {
    for direction in multi_pose::sphere_directions(50) {
        digest.push_vec3(direction);
    }
    let poses = segments(&posed(SEED)).map(|found| found.iter().map(Pose::from_segment).collect::<Vec<_>>());
    let found = poses.and_then(|poses| multi_pose::calibrate(&poses, STANDARD_GRAVITY_M_S2));
    digest.push_result(found, |digest, found| {
        push_affine(digest, &found.accelerometer);
        digest.push_all(&found.sigma);
        digest.push_all(found.covariance.as_flattened());
        digest.push_all(&found.residuals);
        digest.push_all(&found.held_out);
        digest.push_all(&[found.residual_rms, found.held_out_rms, found.pose_sigma]);
        for pose in found.suggest(2) {
            digest.push_vec3(pose.up_body);
            digest.push_all(&[pose.sigma_now, pose.worst_sigma_after]);
        }
    });
}

pub fn recording(digest: &mut Digest) {
    let made = posed(SEED);
    let (acc, gyro) = (&made.acc_m_s2, &made.gyro_rad_s);
    let found = calibrate_poses(acc, gyro, POSED_DT_S, STANDARD_GRAVITY_M_S2, None);
    digest.push_result(found, |digest, found| {
        digest.push_u64(found.segments.len() as u64);
        digest.push(found.settings.floor_multiple);
        push_affine(digest, &found.calibration.accelerometer);
    });
}

pub fn gyro_turns(digest: &mut Digest) {
    let made = posed(SEED);
    let accelerometer = SensorModel::IDENTITY;
    let found = segments(&made).and_then(|rests| {
        let settings = TurnSettings::default();
        gyro_turns::calibrate(&made.gyro_rad_s, POSED_DT_S, &rests, &accelerometer, &settings)
    });
    digest.push_result(found, |digest, found| {
        push_affine(digest, &found.gyroscope);
        digest.push_vec3(found.bias_sigma);
        digest.push_all(&found.sigma);
        digest.push_all(found.covariance.as_flattened());
        digest.push_all(&found.residuals_rad);
        digest.push_all(&found.held_out_rad);
    });
}

pub fn known_turns(digest: &mut Digest) {
    let made = posed(SEED);
    let rests = segments(&made);
    let parts = rests.and_then(|rests| find_parts(&made.acc_m_s2, &made.gyro_rad_s, &rests));
    let angle = TurnAngle::Size(core::f64::consts::TAU);
    let found =
        parts.and_then(|parts| known_turns::calibrate(&parts, POSED_DT_S, angle, STANDARD_GRAVITY_M_S2));
    digest.push_result(found, |digest, found| {
        push_affine(digest, &found.accelerometer);
        push_affine(digest, &found.gyroscope);
        digest.push_all(found.gyro_per_acceleration.as_flattened());
        digest.push_vec3(found.acc_bias_sigma);
        digest.push_vec3(found.gyro_bias_sigma);
        digest.push_all(found.acc_matrix_sigma.as_flattened());
        digest.push_all(found.gyro_matrix_sigma.as_flattened());
    });
}
