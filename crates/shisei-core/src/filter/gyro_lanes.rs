//! The gyroscope's turns of a series, several blocks side by side.

use super::exponential::{POLYNOMIAL_LIMIT, polynomials};
use super::gyro::{GyroIntegrator, GyroOnly, in_block};
use super::{Dt, check_rows};
use crate::error::Result;
use crate::euler::AttitudeRow;
use crate::lanes::Lanes;
use crate::quaternion::{Quaternion, product};
use crate::vector::{self, Vec3};

/// Samples whose turns are multiplied up by themselves.
pub(super) const BLOCK: usize = 16;

/// [`GyroOnly::run`] of the integrator.
#[inline(always)]
pub(super) fn run<const N: usize, L: Lanes<N>, O: AttitudeRow>(
    filter: &mut GyroIntegrator,
    gyro_rad_s: &[Vec3],
    dt: Dt<'_>,
    out: &mut [O],
) -> Result<()> {
    let mut done = filter.missing().min(out.len());
    one_by_one(filter, gyro_rad_s, dt, out, 0..done)?;
    let mut room = Room {
        in_blocks: [[L::of(0.0); 4]; BLOCK],
        _gap: [0.0; GAP],
        rows: [[O::from(Quaternion::IDENTITY); BLOCK]; N],
    };
    // Of every row four numbers are read, so that one must be left behind the last.
    while let Some(rows) = blocks(&mut out[done..])
        && gyro_rad_s.len() > done + N * BLOCK
    {
        let next = done + N * BLOCK;
        // This also brings the rates into the nearest cache, one after another.
        check_rows(&gyro_rad_s[done..next], done)?;
        let rates = &gyro_rad_s.as_flattened()[3 * done..];
        let start = filter.orientation();
        let end = match dt {
            Dt::Constant(dt_s) => together(start, rates, |_| dt_s, &mut room),
            Dt::PerSample(dt_s) => together(start, rates, |k| dt_s[done + k], &mut room),
        };
        match end {
            Some(end) => {
                *filter = GyroIntegrator::starting(end);
                // one after another: memory is slow where it is written here and there
                *rows = room.rows;
            }
            None => one_by_one(filter, gyro_rad_s, dt, out, done..next)?,
        }
        done = next;
    }
    let rows = out.len();
    one_by_one(filter, gyro_rad_s, dt, out, done..rows)
}

/// What is used again from chunk to chunk.
///
/// Processors let a read wait for a write before it whose address differs by a multiple of 4096 bytes. Large arrays begin
/// with a page, and four blocks are half a page: rows that are copied to them from three quarters on never wait.
#[cfg_attr(target_arch = "x86_64", repr(align(4096)))]
struct Room<const N: usize, L, O> {
    /// Products up to each sample of a block.
    in_blocks: [[L; 4]; BLOCK],
    _gap: [f64; GAP],
    rows: [[O; BLOCK]; N],
}

/// A quarter of a page, where processors have pages.
const GAP: usize = if cfg!(target_arch = "x86_64") { 128 } else { 0 };

fn blocks<const N: usize, O>(rows: &mut [O]) -> Option<&mut [[O; BLOCK]; N]> {
    rows.as_chunks_mut().0.first_chunk_mut()
}

#[inline(never)]
fn one_by_one<O: AttitudeRow>(
    filter: &mut GyroIntegrator,
    gyro_rad_s: &[Vec3],
    dt: Dt<'_>,
    out: &mut [O],
    rows: core::ops::Range<usize>,
) -> Result<()> {
    check_rows(&gyro_rad_s[rows.clone()], rows.start)?;
    for k in rows {
        out[k] = O::from(filter.update_gyro(gyro_rad_s[k], dt.at(k)));
    }
    Ok(())
}

/// `N` blocks from `start`; the attitude after them. None, and no row is of use, where a turn is beyond the polynomials'
/// range or not finite.
#[inline(always)]
fn together<const N: usize, L: Lanes<N>, O: AttitudeRow>(
    start: Quaternion,
    rates: &[f64],
    dt_s: impl Fn(usize) -> f64,
    room: &mut Room<N, L, O>,
) -> Option<Quaternion> {
    let one = L::of(1.0);
    let mut turned = [one, L::of(0.0), L::of(0.0), L::of(0.0)];
    let mut small = true;
    for step in 0..BLOCK {
        let gyro_rad_s = L::columns(core::array::from_fn(|lane| row(rates, lane * BLOCK + step)));
        let half_dt_s = L::from_array(core::array::from_fn(|lane| 0.5 * dt_s(lane * BLOCK + step)));
        let h = vector::scale(gyro_rad_s, half_dt_s);
        let x = vector::dot(h, h);
        small &= x.below(L::of(POLYNOMIAL_LIMIT));
        let (c, s) = polynomials(one, x);
        turned = product(turned, [c, s * h[0], s * h[1], s * h[2]]);
        room.in_blocks[step] = turned;
    }
    if !small {
        return None;
    }
    let turned = turned.map(L::to_array);
    let mut starts = [[0.0; N]; 4];
    let mut q = start.to_array();
    for lane in 0..N {
        for (starts, component) in starts.iter_mut().zip(q) {
            starts[lane] = component;
        }
        q = in_block(q, turned.map(|component| component[lane]));
    }
    let starts = starts.map(L::from_array);
    for (step, &turned) in room.in_blocks.iter().enumerate() {
        O::write(in_block(starts, turned), room.rows.each_mut().map(|block| &mut block[step]));
    }
    Some(Quaternion::from_array(q))
}

/// Row k and the number behind it.
#[inline(always)]
fn row(rates: &[f64], k: usize) -> &[f64; 4] {
    rates[3 * k..].first_chunk().unwrap_or(&[0.0; 4])
}
