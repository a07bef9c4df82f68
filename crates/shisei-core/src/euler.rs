//! Yaw, pitch and roll: Z-Y-X intrinsic, `R = Rz(yaw) Ry(pitch) Rx(roll)`.

mod lanes;

use crate::lanes::Lanes;
use crate::math;
use crate::quaternion::Quaternion;
pub(crate) use lanes::{BLOCK, Components, ypr_lanes};

/// Below this cos(pitch) roll is 0 and yaw carries the rest (gimbal lock).
const GIMBAL_LOCK_COS: f64 = 1e-12;

/// Yaw about z, then pitch about y, then roll about x; rad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ypr {
    /// About z, −π … π.
    pub yaw_rad: f64,
    /// About the turned y, −π/2 … π/2.
    pub pitch_rad: f64,
    /// About the turned x, −π … π.
    pub roll_rad: f64,
}

impl Ypr {
    /// `[yaw, pitch, roll]`, rad.
    pub const fn to_array(self) -> [f64; 3] {
        [self.yaw_rad, self.pitch_rad, self.roll_rad]
    }

    /// From `[yaw, pitch, roll]`, rad.
    pub const fn from_array(ypr_rad: [f64; 3]) -> Self {
        Ypr { yaw_rad: ypr_rad[0], pitch_rad: ypr_rad[1], roll_rad: ypr_rad[2] }
    }
}

impl From<Quaternion> for Ypr {
    fn from(q: Quaternion) -> Self {
        q.to_ypr()
    }
}

impl From<Quaternion> for [f64; 3] {
    /// `[yaw, pitch, roll]`, rad.
    fn from(q: Quaternion) -> Self {
        q.to_ypr().to_array()
    }
}

impl Quaternion {
    /// From yaw, pitch, roll; of unit norm to rounding.
    pub fn from_ypr(ypr: Ypr) -> Self {
        let (sy, cy) = math::sin_cos(0.5 * ypr.yaw_rad);
        let (sp, cp) = math::sin_cos(0.5 * ypr.pitch_rad);
        let (sr, cr) = math::sin_cos(0.5 * ypr.roll_rad);
        Quaternion::new(
            cy * cp * cr + sy * sp * sr,
            cy * cp * sr - sy * sp * cr,
            cy * sp * cr + sy * cp * sr,
            sy * cp * cr - cy * sp * sr,
        )
    }

    /// To yaw, pitch, roll. Pitch is `atan2(−R20, cos(pitch))`, so it keeps its digits near ±π/2.
    ///
    /// Yaw and roll come from their half sum and half difference,
    /// `½(yaw + roll) = atan2(z + x, w − y)` and `½(yaw − roll) = atan2(z − x, w + y)`: near pitch ±π/2 one of the
    /// two is lost in rounding, but it is the one that hardly matters there, so that the three angles
    /// together stay the same rotation (E. Bernardes, S. Viollet, PLoS ONE 17(11), 2022).
    ///
    /// cos(pitch) is the root of the product of those two points' squared lengths, 1 ∓ sin(pitch).
    pub fn to_ypr(self) -> Ypr {
        Ypr::from_array(lanes::ypr(self))
    }
}

/// What an attitude may be written as: [`Quaternion`], `[w, x, y, z]`, [`Ypr`] or `[yaw, pitch, roll]`.
pub trait AttitudeRow: From<Quaternion> + Copy {
    /// Whether it is made of angles: several of them at once are faster than one by one, with the same bits.
    const ANGLES: bool = false;

    /// From yaw, pitch, roll, rad; asked for only of [`ANGLES`](AttitudeRow::ANGLES).
    fn from_angles(ypr_rad: [f64; 3]) -> Self;

    /// Writes attitudes of unit norm that stand side by side.
    #[inline(always)]
    fn write<const N: usize, L: Lanes<N>>(attitudes: [L; 4], rows: [&mut Self; N]) {
        if Self::ANGLES {
            let [w, x, y, z] = attitudes.map(L::to_array);
            for (row, ypr_rad) in rows.into_iter().zip(ypr_lanes(&w, &x, &y, &z)) {
                *row = Self::from_angles(ypr_rad);
            }
        } else {
            let mut components = [[0.0; 4]; N];
            L::write_rows(attitudes, components.each_mut());
            for (row, q) in rows.into_iter().zip(components) {
                *row = Self::from(Quaternion::from_array(q));
            }
        }
    }
}

impl AttitudeRow for Quaternion {
    fn from_angles(ypr_rad: [f64; 3]) -> Self {
        Quaternion::from_ypr(Ypr::from_array(ypr_rad))
    }
}

impl AttitudeRow for [f64; 4] {
    fn from_angles(ypr_rad: [f64; 3]) -> Self {
        Quaternion::from_angles(ypr_rad).to_array()
    }

    #[inline(always)]
    fn write<const N: usize, L: Lanes<N>>(attitudes: [L; 4], rows: [&mut Self; N]) {
        L::write_rows(attitudes, rows);
    }
}

impl AttitudeRow for Ypr {
    const ANGLES: bool = true;

    #[inline(always)]
    fn from_angles(ypr_rad: [f64; 3]) -> Self {
        Ypr::from_array(ypr_rad)
    }
}

impl AttitudeRow for [f64; 3] {
    const ANGLES: bool = true;

    #[inline(always)]
    fn from_angles(ypr_rad: [f64; 3]) -> Self {
        ypr_rad
    }
}

/// Writes attitudes: `attitude(k)`, of unit norm, is asked for in ascending order, once a row.
#[inline(always)]
pub(crate) fn fill<O: AttitudeRow>(out: &mut [O], mut attitude: impl FnMut(usize) -> Quaternion) {
    if !O::ANGLES {
        for (k, row) in out.iter_mut().enumerate() {
            *row = O::from(attitude(k));
        }
        return;
    }
    let mut components = Components::IDENTITY;
    for (block, rows) in out.chunks_mut(BLOCK).enumerate() {
        for i in 0..rows.len() {
            components.set(i, attitude(block * BLOCK + i));
        }
        write(rows, &components);
    }
}

/// Writes a block's first attitudes.
#[inline(always)]
pub(crate) fn write<O: AttitudeRow>(rows: &mut [O], components: &Components) {
    if O::ANGLES {
        let [yaw, pitch, roll] = components.ypr();
        if let Ok(rows) = <&mut [O; BLOCK]>::try_from(&mut *rows) {
            for i in 0..BLOCK {
                rows[i] = O::from_angles([yaw[i], pitch[i], roll[i]]);
            }
        } else {
            for (i, row) in rows.iter_mut().enumerate().take(BLOCK) {
                *row = O::from_angles([yaw[i], pitch[i], roll[i]]);
            }
        }
    } else {
        for (i, row) in rows.iter_mut().enumerate().take(BLOCK) {
            *row = O::from(components.at(i));
        }
    }
}
