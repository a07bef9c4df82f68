//! Attitudes relative to an initial one, and other functions over series of quaternions.
//!
//! Seen from the body: `q0* ⊗ q`; seen from the world: `q ⊗ q0*`. Both are no rotation at q = q0.
//!
//! The series functions write into a slice and take and give any of the usual rows: input rows are
//! [`Quaternion`] or `[f64; 4]`, output rows [`Quaternion`], `[f64; 4]`, [`Ypr`] or `[f64; 3]` (yaw,
//! pitch, roll). Quaternions are normalised on entry; one that is zero or not finite is refused with its row.

use crate::error::Result;
use crate::euler::{self, AttitudeRow, BLOCK, Components, Ypr};
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
#[inline(always)]
pub fn body_series<Q: Into<Quaternion> + Copy, O: AttitudeRow>(
    current: &[Q],
    initial: Quaternion,
    out: &mut [O],
) -> Result<()> {
    let inverse = initial.try_normalized()?.conjugate();
    map_series(current, out, |q| inverse.product(q))
}

/// [`world`] of every row.
#[inline(always)]
pub fn world_series<Q: Into<Quaternion> + Copy, O: AttitudeRow>(
    current: &[Q],
    initial: Quaternion,
    out: &mut [O],
) -> Result<()> {
    let inverse = initial.try_normalized()?.conjugate();
    map_series(current, out, |q| q.product(inverse))
}

/// Every row itself: normalised, or as yaw, pitch, roll.
#[inline(always)]
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

/// Blocks before that of a refused row are written.
#[inline(always)]
fn map_series<Q: Into<Quaternion> + Copy, O: AttitudeRow>(
    quaternions: &[Q],
    out: &mut [O],
    f: impl Fn(Quaternion) -> Quaternion,
) -> Result<()> {
    same_length(quaternions.len(), out.len())?;
    let mut components = Components::IDENTITY;
    for (block, (rows, quaternions)) in out.chunks_mut(BLOCK).zip(quaternions.chunks(BLOCK)).enumerate() {
        match <&[Q; BLOCK]>::try_from(quaternions) {
            Ok(quaternions) if units(quaternions, &mut components) => {
                for i in 0..BLOCK {
                    components.set(i, f(components.at(i)));
                }
            }
            _ => one_by_one(quaternions, block * BLOCK, &mut components, &f)?,
        }
        euler::write(rows, &components);
    }
    Ok(())
}

/// Normalises a whole block; false where a row is zero, not finite, or so large or small that its square might be.
#[inline(always)]
fn units<Q: Into<Quaternion> + Copy>(quaternions: &[Q; BLOCK], components: &mut Components) -> bool {
    for i in 0..BLOCK {
        components.set(i, quaternions[i].into());
    }
    let mut ordinary = true;
    for i in 0..BLOCK {
        let square = components.at(i).norm_squared();
        ordinary &= square > 1e-180 && square < 1e180;
    }
    if ordinary {
        for i in 0..BLOCK {
            components.set(i, components.at(i).unit());
        }
    }
    ordinary
}

#[inline(never)]
fn one_by_one<Q: Into<Quaternion> + Copy>(
    quaternions: &[Q],
    first_row: usize,
    components: &mut Components,
    f: &impl Fn(Quaternion) -> Quaternion,
) -> Result<()> {
    for (i, &q) in quaternions.iter().enumerate().take(BLOCK) {
        components.set(i, f(unit(q, first_row + i)?));
    }
    Ok(())
}
