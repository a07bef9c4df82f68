//! The functions in the order doors list them. Never reorder: that order is published; add at the end.

mod calibration;
mod checks;
mod estimate;
mod extra;
mod measure;
mod motion;
mod quaternions;
mod readings;
mod relative;
mod update;

use crate::error::{Error, Result};
use crate::function::Function;
use shisei_core::Vec3;
use shisei_core::filter::{Dt, Filter};
use shisei_wide::Vectors;

/// Every function of the table: the 44, then those beyond.
pub static FUNCTIONS: [Function; 54] = [
    readings::VEC3_MEAN,
    readings::VEC3_VARIANCE,
    readings::MEAN_NORM,
    readings::GET_BIAS_CALIB,
    readings::GET_IMU_CALIB,
    readings::APPLY_IMU_CALIB,
    quaternions::IDENTITY_QUAT,
    quaternions::NORMALIZE_QUAT,
    quaternions::CONJUGATE_QUAT,
    quaternions::QUAT_ROTATE_VEC3,
    quaternions::QUATS_ROTATE_VEC3,
    quaternions::QUAT2YPR,
    quaternions::QUATS2YPRS,
    quaternions::YPR2QUAT,
    quaternions::YPRS2QUATS,
    quaternions::AXIS_ANGLE2QUAT,
    quaternions::GRAVITY_BODY,
    relative::ACCS2INITIAL_QUAT,
    relative::QUAT2BODY_QUAT,
    relative::QUAT2BODY_YPR,
    relative::QUAT2WORLD_QUAT,
    relative::QUAT2WORLD_YPR,
    relative::QUATS2BODY_QUATS,
    relative::QUATS2BODY_YPRS,
    relative::QUATS2WORLD_QUATS,
    relative::QUATS2WORLD_YPRS,
    update::UPDATE_QUAT_BY_GYRO,
    update::UPDATE_QUAT_BY_GYRO_RK4,
    update::UPDATE_QUATS_BY_GYRO,
    update::UPDATE_QUATS_BY_GYRO_RK4,
    update::UPDATE_YPRS_BY_GYRO,
    update::UPDATE_YPRS_BY_GYRO_RK4,
    update::UPDATE_QUAT_BY_MAHONY,
    update::UPDATE_QUAT_BY_MAHONY_ADAPTIVE,
    update::UPDATE_YPR_BY_MAHONY,
    update::UPDATE_YPR_BY_MAHONY_ADAPTIVE,
    update::UPDATE_QUATS_BY_MAHONY,
    update::UPDATE_QUATS_BY_MAHONY_ADAPTIVE,
    update::UPDATE_YPRS_BY_MAHONY,
    update::UPDATE_YPRS_BY_MAHONY_ADAPTIVE,
    update::ADAPTIVE_KP,
    checks::IS_ACC_STABLE,
    checks::IS_FINITE_QUAT,
    checks::IS_FINITE_VEC3,
    extra::CALIB_FACES,
    extra::SHISEI_LAST_ERROR,
    extra::SHISEI_VERSION,
    extra::UPDATE_QUATS_BY_COMPLEMENTARY,
    extra::DEAD_RECKON,
    extra::ESTIMATE_QUATS,
    extra::ESTIMATE_YPRS,
    extra::FIT_SPHERE,
    measure::ALLAN_DEV,
    measure::EARTH_RATE,
];

/// A new series of N columns, filled by the core; what the core refuses is said of `arg`.
fn series<const N: usize>(
    arg: &'static str,
    rows: usize,
    fill: impl FnOnce(&mut [[f64; N]]) -> shisei_core::Result<()>,
) -> Result<Vec<[f64; N]>> {
    let mut out = vec![[0.0; N]; rows];
    match fill(&mut out) {
        Ok(()) => Ok(out),
        Err(error @ shisei_core::Error::ZeroQuaternion { .. }) => Err(Error::InArgument { arg, error }),
        Err(error) => Err(Error::Core(error)),
    }
}

/// A filter run over a series.
fn filtered<const N: usize>(
    mut filter: impl Filter,
    gyro_rad_s: &[Vec3],
    acc_m_s2: &[Vec3],
    dt_s: f64,
) -> Result<Vec<[f64; N]>>
where
    [f64; N]: shisei_core::AttitudeRow,
{
    series("gyro", gyro_rad_s.len(), |out| {
        Vectors::widest().run_into(&mut filter, gyro_rad_s, acc_m_s2, Dt::Constant(dt_s), out)
    })
}
