//! Attitudes relative to an initial one, and other functions over series of quaternions.
//!
//! Seen from the body: `q0* ⊗ q`; seen from the world: `q ⊗ q0*`. Both are no rotation at q = q0.
//!
//! The series functions write into a slice and take and give any of the usual rows: input rows are
//! [`Quaternion`] or `[f64; 4]`, output rows [`Quaternion`], `[f64; 4]`, [`Ypr`] or `[f64; 3]` (yaw,
//! pitch, roll). Quaternions are normalised on entry; one that is zero or not finite is refused with its row.

use crate::error::Result;
use crate::euler::{self, AttitudeRow, LANES, Ypr};
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
pub fn body_series<Q: Into<Quaternion> + Copy, O: AttitudeRow>(
    current: &[Q],
    initial: Quaternion,
    out: &mut [O],
) -> Result<()> {
    let inverse = initial.try_normalized()?.conjugate();
    map_series(current, out, |q| inverse.product(q))
}

/// [`world`] of every row.
pub fn world_series<Q: Into<Quaternion> + Copy, O: AttitudeRow>(
    current: &[Q],
    initial: Quaternion,
    out: &mut [O],
) -> Result<()> {
    let inverse = initial.try_normalized()?.conjugate();
    map_series(current, out, |q| q.product(inverse))
}

/// Every row itself: normalised, or as yaw, pitch, roll.
pub fn convert_series<Q: Into<Quaternion> + Copy, O: AttitudeRow>(
    quaternions: &[Q],
    out: &mut [O],
) -> Result<()> {
    map_series(quaternions, out, |q| q)
}

/// One vector, turned by every row.
pub fn rotate_series<Q: Into<Quaternion> + Copy>(
    quaternions: &[Q],
    vector: Vec3,
    out: &mut [Vec3],
) -> Result<()> {
    check_rows(&[vector], 0)?;
    same_length(quaternions.len(), out.len())?;
    for (k, (row, &q)) in out.iter_mut().zip(quaternions).enumerate() {
        *row = unit(q, k)?.rotate(vector);
    }
    Ok(())
}

/// Yaw, pitch, roll (rad) to quaternions; refused at a row that is not finite.
pub fn from_ypr_series<O: AttitudeRow>(ypr_rad: &[Vec3], out: &mut [O]) -> Result<()> {
    same_length(ypr_rad.len(), out.len())?;
    check_rows(ypr_rad, 0)?;
    for (row, &ypr) in out.iter_mut().zip(ypr_rad) {
        *row = O::from(Quaternion::from_ypr(Ypr::from_array(ypr)));
    }
    Ok(())
}

fn unit<Q: Into<Quaternion>>(q: Q, row: usize) -> Result<Quaternion> {
    let q: Quaternion = q.into();
    q.try_normalized().map_err(|error| error.at_row(row))
}

/// Rows before a refused one are written.
fn map_series<Q: Into<Quaternion> + Copy, O: AttitudeRow>(
    quaternions: &[Q],
    out: &mut [O],
    f: impl Fn(Quaternion) -> Quaternion,
) -> Result<()> {
    same_length(quaternions.len(), out.len())?;
    for (block, (rows, quaternions)) in out.chunks_mut(LANES).zip(quaternions.chunks(LANES)).enumerate() {
        let mut q = [Quaternion::IDENTITY; LANES];
        for (i, &given) in quaternions.iter().enumerate() {
            q[i] = f(unit(given, block * LANES + i)?);
        }
        euler::fill(rows, |i| q[i]);
    }
    Ok(())
}
