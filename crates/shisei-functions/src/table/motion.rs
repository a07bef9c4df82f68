//! Dead reckoning in the worksheet's columns.

use crate::error::{Error, Result};
use shisei_core::filter::Dt;
use shisei_core::motion::{DeadReckoning, MotionState, Scheme};
use shisei_core::{Quaternion, Vec3};

/// Velocity and position after each sample; `scheme` is 0, 1 or 2.
pub(super) fn dead_reckon(
    world_from_body: Quaternion,
    gyro_rad_s: &[Vec3],
    acc_m_s2: &[Vec3],
    dt_s: f64,
    gravity_m_s2: f64,
    scheme: f64,
) -> Result<Vec<[f64; 6]>> {
    let scheme = if scheme == 0.0 {
        Scheme::SemiImplicit
    } else if scheme == 1.0 {
        Scheme::Euler
    } else if scheme == 2.0 {
        Scheme::Trapezoid
    } else {
        let error = shisei_core::Error::OutOfRange { rule: "scheme = 0, 1, 2", value: scheme };
        return Err(Error::InArgument { arg: "scheme", error });
    };
    let mut reckoning = DeadReckoning::new(world_from_body, [0.0; 3], gravity_m_s2, scheme)?;
    let mut states: Vec<MotionState> = vec![reckoning.state(); gyro_rad_s.len()];
    reckoning.run_into(gyro_rad_s, acc_m_s2, Dt::Constant(dt_s), &mut states)?;
    let row = |s: &MotionState| {
        let (v, p) = (s.velocity_m_s, s.position_m);
        [v[0], v[1], v[2], p[0], p[1], p[2]]
    };
    Ok(states.iter().map(row).collect())
}
