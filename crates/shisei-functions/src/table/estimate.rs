//! The estimator over a whole column.

use crate::error::Result;
use shisei_core::estimator::{Settings, smooth};
use shisei_core::filter::Dt;
use shisei_core::{Quaternion, Vec3};

/// The smoother's attitudes with its usual settings.
pub(super) fn smoothed<const N: usize>(
    gyro_rad_s: &[Vec3],
    acc_m_s2: &[Vec3],
    dt_s: f64,
    gravity_m_s2: f64,
) -> Result<Vec<[f64; N]>>
where
    [f64; N]: From<Quaternion>,
{
    let dt = Dt::Constant(dt_s);
    dt.check(gyro_rad_s.len())?;
    let settings = Settings { gravity_m_s2, ..Settings::default() };
    let found = smooth(acc_m_s2, gyro_rad_s, dt, &settings)?;
    Ok(found.states.iter().map(|state| <[f64; N]>::from(state.world_from_body)).collect())
}
