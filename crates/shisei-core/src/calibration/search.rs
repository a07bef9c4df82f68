//! The search for the steadiest window of every face.
//!
//! The windows' means and variances come from sums that are only ever joined, never subtracted: every window
//! spans at most two stretches of the window's length; of the first the sums from each row to its end are
//! kept, of the second those from its start on. So the work is two updates a row whatever the window's
//! length, and no digits are lost as with running sums.

use alloc::vec::Vec;

use super::six_face::{FaceRow, FaceState, FaceTable, FaceWindow, SixFaceSettings};
use crate::error::{Error, Face, Result};
use crate::filter::{check_rows, positive, same_length};
use crate::math;
use crate::rest;
use crate::vector::{self, Vec3};

/// Parts of a window whose scatter gives the variance of its mean.
const PARTS: usize = 30;

/// Slides a window over a recording and keeps the best of every face. Refused: unequal lengths, numbers that
/// are not finite, dt or settings out of their range. A recording shorter than the window has no face.
pub fn search_faces(
    acc_m_s2: &[Vec3],
    gyro_rad_s: &[Vec3],
    dt_s: f64,
    settings: &SixFaceSettings,
) -> Result<FaceTable> {
    settings.check()?;
    positive("dt", dt_s)?;
    if acc_m_s2.is_empty() {
        return Err(Error::Empty);
    }
    same_length(acc_m_s2.len(), gyro_rad_s.len())?;
    check_rows(acc_m_s2, 0)?;
    check_rows(gyro_rad_s, 0)?;
    let mut best = [Best::default(); 6];
    let rows = math::round(settings.window_s / dt_s).max(1.0);
    // a float comparison first: the quotient may be beyond any integer
    if rows <= acc_m_s2.len() as f64 {
        let step = math::round(settings.step_s / dt_s).max(1.0).min(acc_m_s2.len() as f64);
        slide(acc_m_s2, rows as usize, step as usize, |start, moments| {
            consider(&mut best, start, moments, settings);
        });
    }
    let mut faces = [FaceRow { face: Face::ALL[0], state: FaceState::NeverUp, window: None }; 6];
    for (k, row) in faces.iter_mut().enumerate() {
        let (state, start) = best[k].choice();
        row.face = Face::ALL[k];
        row.state = state;
        row.window = start.map(|start| {
            let range = start..start + rows as usize;
            describe(&acc_m_s2[range.clone()], &gyro_rad_s[range], start, Face::ALL[k])
        });
    }
    Ok(FaceTable { faces })
}

/// The best windows of one face so far: (what is smallest, start row).
#[derive(Clone, Copy, Default)]
struct Best {
    stable: Option<(f64, usize)>,
    unsteady: Option<(f64, usize)>,
    tilted: Option<(f64, usize)>,
}

impl Best {
    fn choice(&self) -> (FaceState, Option<usize>) {
        let candidates = [
            (FaceState::Found, self.stable),
            (FaceState::Unsteady, self.unsteady),
            (FaceState::Tilted, self.tilted),
        ];
        for (state, best) in candidates {
            if let Some((_, start)) = best {
                return (state, Some(start));
            }
        }
        (FaceState::NeverUp, None)
    }
}

/// Keeps the smaller; the first of equals.
fn keep(best: &mut Option<(f64, usize)>, value: f64, start: usize) {
    if value.is_finite() && best.is_none_or(|(smallest, _)| value < smallest) {
        *best = Some((value, start));
    }
}

fn consider(best: &mut [Best; 6], start: usize, moments: &Moments, settings: &SixFaceSettings) {
    let mean = moments.mean;
    let mut axis = 0;
    for other in 1..3 {
        if mean[other].abs() > mean[axis].abs() {
            axis = other;
        }
    }
    if mean[axis] == 0.0 || !vector::is_finite(mean) {
        return;
    }
    let slot = &mut best[2 * axis + usize::from(mean[axis] < 0.0)];
    let tilt_rad = tilt(mean, axis);
    let variance = vector::scale(moments.squares, 1.0 / moments.rows);
    let stable = variance.iter().all(|&v| v <= settings.variance_max);
    match (stable, tilt_rad <= settings.max_tilt_rad) {
        (true, true) => keep(&mut slot.stable, variance[0] + variance[1] + variance[2], start),
        (true, false) => keep(&mut slot.tilted, tilt_rad, start),
        (false, true) => keep(&mut slot.unsteady, variance[0].max(variance[1]).max(variance[2]), start),
        (false, false) => {}
    }
}

/// Angle between a vector and the nearer direction of an axis, rad.
fn tilt(v: Vec3, axis: usize) -> f64 {
    let (a, b) = (v[(axis + 1) % 3], v[(axis + 2) % 3]);
    math::atan2(math::hypot(a, b), v[axis].abs())
}

/// A window's figures, by two passes over its rows.
fn describe(acc: &[Vec3], gyro: &[Vec3], start_row: usize, face: Face) -> FaceWindow {
    let acc_mean = rest::mean_of(acc);
    let gyro_mean = rest::mean_of(gyro);
    FaceWindow {
        start_row,
        rows: acc.len(),
        acc_mean,
        acc_variance: vector::scale(squares_about(acc, acc_mean), 1.0 / acc.len() as f64),
        acc_mean_variance: mean_variance(acc),
        gyro_mean,
        gyro_mean_variance: mean_variance(gyro),
        tilt_rad: tilt(acc_mean, usize::from(face.axis)),
    }
}

fn squares_about(rows: &[Vec3], mean: Vec3) -> Vec3 {
    let mut squares = [0.0; 3];
    for &row in rows {
        let d = vector::sub(row, mean);
        for axis in 0..3 {
            squares[axis] += d[axis] * d[axis];
        }
    }
    squares
}

/// Variance of the mean of a window, from the means of up to [`PARTS`] equal parts: noise that hangs together
/// over less than a part (a sensor's own filter) is counted rightly. Rows that do not fill a part are left out.
fn mean_variance(rows: &[Vec3]) -> Vec3 {
    let part = (rows.len() / PARTS).max(1);
    let parts = rows.len() / part;
    if parts < 2 {
        return [0.0; 3];
    }
    let means: Vec<Vec3> = rows.chunks_exact(part).map(rest::mean_of).collect();
    let n = parts as f64;
    vector::scale(squares_about(&means, rest::mean_of(&means)), 1.0 / (n * (n - 1.0)))
}

/// Count, mean and summed squared deviations of some rows.
#[derive(Clone, Copy, Default)]
struct Moments {
    rows: f64,
    mean: Vec3,
    squares: Vec3,
}

impl Moments {
    /// With one row more (Welford 1962).
    fn with(&self, row: Vec3) -> Moments {
        let rows = self.rows + 1.0;
        let mut out = Moments { rows, ..*self };
        for axis in 0..3 {
            let d = row[axis] - self.mean[axis];
            out.mean[axis] = self.mean[axis] + d / rows;
            out.squares[axis] = self.squares[axis] + d * (row[axis] - out.mean[axis]);
        }
        out
    }

    /// Of both (Chan, Golub, LeVeque 1979).
    fn join(&self, other: &Moments) -> Moments {
        if other.rows == 0.0 {
            return *self;
        }
        let rows = self.rows + other.rows;
        let share = other.rows / rows;
        let mut out = Moments { rows, ..Moments::default() };
        for axis in 0..3 {
            let d = other.mean[axis] - self.mean[axis];
            out.mean[axis] = self.mean[axis] + d * share;
            out.squares[axis] = (self.squares[axis] + other.squares[axis]) + d * d * (self.rows * share);
        }
        out
    }
}

/// Calls `visit(start, moments)` for every window of `rows` rows that starts at a multiple of `step`.
fn slide(acc: &[Vec3], rows: usize, step: usize, mut visit: impl FnMut(usize, &Moments)) {
    let mut suffix: Vec<Moments> = Vec::with_capacity(rows);
    let mut next = 0;
    let mut stretch = 0;
    while stretch + rows <= acc.len() && next + rows <= acc.len() {
        // sums from each row of the stretch to its end, in reverse
        suffix.clear();
        let mut moments = Moments::default();
        for k in (stretch..stretch + rows).rev() {
            moments = moments.with(acc[k]);
            suffix.push(moments);
        }
        let end = stretch + rows;
        let mut prefix = Moments::default();
        let mut filled = end;
        while next < end && next + rows <= acc.len() {
            while filled < next + rows {
                prefix = prefix.with(acc[filled]);
                filled += 1;
            }
            visit(next, &suffix[end - 1 - next].join(&prefix));
            next += step;
        }
        stretch = end;
    }
}
