//! Attitudes relative to an initial one, and other functions over series of quaternions.
//!
//! Seen from the body: `q0* ⊗ q`; seen from the world: `q ⊗ q0*`. Both are no rotation at q = q0.
//!
//! The series functions write into a slice and take and give any of the usual rows: input rows are
//! [`Quaternion`] or `[f64; 4]`, output rows [`Quaternion`], `[f64; 4]`, [`Ypr`] or `[f64; 3]` (yaw,
//! pitch, roll). Quaternions are normalised on entry; one that is zero or not finite is refused with its row.

use crate::error::Result;
use crate::euler::Ypr;
use crate::filter::{check_rows, same_length};
use crate::quaternion::Quaternion;
use crate::vector::Vec3;

/// `q_initial* ⊗ q_current`: the rotation since the start in the axes of the body at the start.
pub fn body(current: Quaternion, initial: Quaternion) -> Result<Quaternion> {
    Ok(initial.try_normalized()?.conjugate().product(current.try_normalized()?))
}

/// `q_current ⊗ q_initial*`: the rotation since the start in world axes.
pub fn world(current: Quaternion, initial: Quaternion) -> Result<Quaternion> {
    Ok(current.try_normalized()?.product(initial.try_normalized()?.conjugate()))
}

/// [`body`] of every row.
pub fn body_series<Q: Into<Quaternion> + Copy, O: From<Quaternion>>(
    current: &[Q],
    initial: Quaternion,
    out: &mut [O],
) -> Result<()> {
    let inverse = initial.try_normalized()?.conjugate();
    map_series(current, out, |q| O::from(inverse.product(q)))
}

/// [`world`] of every row.
pub fn world_series<Q: Into<Quaternion> + Copy, O: From<Quaternion>>(
    current: &[Q],
    initial: Quaternion,
    out: &mut [O],
) -> Result<()> {
    let inverse = initial.try_normalized()?.conjugate();
    map_series(current, out, |q| O::from(q.product(inverse)))
}

/// Every row itself: normalised, or as yaw, pitch, roll.
pub fn convert_series<Q: Into<Quaternion> + Copy, O: From<Quaternion>>(
    quaternions: &[Q],
    out: &mut [O],
) -> Result<()> {
    map_series(quaternions, out, O::from)
}

/// One vector, turned by every row.
pub fn rotate_series<Q: Into<Quaternion> + Copy>(
    quaternions: &[Q],
    vector: Vec3,
    out: &mut [Vec3],
) -> Result<()> {
    check_rows(&[vector], 0)?;
    map_series(quaternions, out, |q| q.rotate(vector))
}

/// Yaw, pitch, roll (rad) to quaternions; refused at a row that is not finite.
pub fn from_ypr_series<O: From<Quaternion>>(ypr_rad: &[Vec3], out: &mut [O]) -> Result<()> {
    same_length(ypr_rad.len(), out.len())?;
    check_rows(ypr_rad, 0)?;
    for (row, &ypr) in out.iter_mut().zip(ypr_rad) {
        *row = O::from(Quaternion::from_ypr(Ypr::from_array(ypr)));
    }
    Ok(())
}

fn map_series<Q: Into<Quaternion> + Copy, O>(
    quaternions: &[Q],
    out: &mut [O],
    f: impl Fn(Quaternion) -> O,
) -> Result<()> {
    same_length(quaternions.len(), out.len())?;
    for (k, (row, &q)) in out.iter_mut().zip(quaternions).enumerate() {
        let q: Quaternion = q.into();
        *row = f(q.try_normalized().map_err(|error| error.at_row(k))?);
    }
    Ok(())
}
