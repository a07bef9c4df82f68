//! The gyroscope's turns of a series, several blocks side by side.

use super::exponential::{POLYNOMIAL_LIMIT, cos_sinc, exp_half};
use super::gyro::{GyroIntegrator, GyroOnly, half_turn, in_block};
use super::lanes::{LANES, Lanes};
use super::{Dt, check_rows};
use crate::error::Result;
use crate::euler::AttitudeRow;
use crate::quaternion::Quaternion;
use crate::vector::{self, Vec3};

/// Samples whose turns are multiplied up by themselves.
pub(super) const BLOCK: usize = 16;

/// Samples that are taken together.
const CHUNK: usize = BLOCK * LANES;

/// [`GyroOnly::run`] of the integrator.
#[inline(always)]
pub(super) fn run<O: AttitudeRow>(
    filter: &mut GyroIntegrator,
    gyro_rad_s: &[Vec3],
    dt: Dt<'_>,
    out: &mut [O],
) -> Result<()> {
    let mut done = filter.missing().min(out.len());
    one_by_one(filter, gyro_rad_s, dt, out, 0, done)?;
    let mut room = [Lanes::IDENTITY; BLOCK];
    while let (Some(rates), Some(rows)) = (chunk(&gyro_rad_s[done..]), out[done..].first_chunk_mut::<CHUNK>())
    {
        check_rows(rates, done)?;
        let start = filter.orientation();
        *filter = GyroIntegrator::starting(match dt {
            Dt::Constant(dt_s) => blocks(start, rates, |_| dt_s, &mut room, rows),
            Dt::PerSample(dt_s) => blocks(start, rates, |k| dt_s[done + k], &mut room, rows),
        });
        done += CHUNK;
    }
    let rows = out.len();
    one_by_one(filter, gyro_rad_s, dt, out, done, rows)
}

#[inline(always)]
fn chunk(rates: &[Vec3]) -> Option<&[Vec3; CHUNK]> {
    rates.first_chunk()
}

#[inline(never)]
fn one_by_one<O: AttitudeRow>(
    filter: &mut GyroIntegrator,
    gyro_rad_s: &[Vec3],
    dt: Dt<'_>,
    out: &mut [O],
    from: usize,
    to: usize,
) -> Result<()> {
    check_rows(&gyro_rad_s[from..to], from)?;
    for k in from..to {
        out[k] = O::from(filter.update_gyro(gyro_rad_s[k], dt.at(k)));
    }
    Ok(())
}

/// A chunk from `start`; the attitude after it. `in_blocks` is room for the products.
#[inline(always)]
fn blocks<O: AttitudeRow>(
    start: Quaternion,
    rates: &[Vec3; CHUNK],
    dt_s: impl Fn(usize) -> f64,
    in_blocks: &mut [Lanes; BLOCK],
    rows: &mut [O; CHUNK],
) -> Quaternion {
    let mut product = Lanes::IDENTITY;
    for step in 0..BLOCK {
        let turn = turns(rates, &dt_s, step);
        let before = product;
        for lane in 0..LANES {
            product.set(lane, before.at(lane).product(turn.at(lane)));
        }
        in_blocks[step] = product;
    }
    let mut starts = Lanes::IDENTITY;
    let mut q = start;
    for lane in 0..LANES {
        starts.set(lane, q);
        q = in_block(q, product.at(lane));
    }
    for step in 0..BLOCK {
        let mut attitudes = Lanes::IDENTITY;
        for lane in 0..LANES {
            attitudes.set(lane, in_block(starts.at(lane), in_blocks[step].at(lane)));
        }
        attitudes.write(|lane, row| rows[lane * BLOCK + step] = row);
    }
    q
}

/// exp(½ ω dt) of the same sample of all blocks.
#[inline(always)]
fn turns(rates: &[Vec3; CHUNK], dt_s: &impl Fn(usize) -> f64, step: usize) -> Lanes {
    let mut h = [[0.0; LANES]; 3];
    for lane in 0..LANES {
        let k = lane * BLOCK + step;
        [h[0][lane], h[1][lane], h[2][lane]] = half_turn(rates[k], dt_s(k));
    }
    let mut turns = Lanes::IDENTITY;
    let mut small = true;
    for lane in 0..LANES {
        let h = [h[0][lane], h[1][lane], h[2][lane]];
        let x = vector::dot(h, h);
        small &= x < POLYNOMIAL_LIMIT;
        let (c, s) = cos_sinc(x);
        turns.set(lane, Quaternion::new(c, s * h[0], s * h[1], s * h[2]));
    }
    if small { turns } else { all_turns(&h) }
}

#[cold]
fn all_turns(h: &[[f64; LANES]; 3]) -> Lanes {
    let mut turns = Lanes::IDENTITY;
    for lane in 0..LANES {
        turns.set(lane, exp_half([h[0][lane], h[1][lane], h[2][lane]]));
    }
    turns
}
