//! A filter from gap to gap, as many rows at a time as are asked for.

use super::{GAP_S, LEVEL_S, after};
use crate::error::Result;
use crate::filter::{self, Dt, Filter};
use crate::quaternion::Quaternion;
use crate::vector::Vec3;
use crate::{initial, rest};

/// Attitudes that are made in order.
pub(super) trait Series {
    /// The attitudes of the next rows.
    fn next(&mut self, out: &mut [Quaternion]) -> Result<()>;
}

/// Rates, accelerations and steps.
pub(super) type Rows<'a> = (&'a [Vec3], &'a [Vec3], &'a [f64]);

/// Starts the filter anew at every gap.
pub(super) struct Stretches<'a, F, M> {
    make: M,
    filter: F,
    rates: &'a [Vec3],
    acc: &'a [Vec3],
    dt_s: &'a [f64],
    row: usize,
    /// Whether the start lies before row 0, and row 0's step leads from it; else row 0 is the start itself.
    leads: bool,
    /// The attitude of the row before, or at the start.
    last: Quaternion,
}

impl<'a, F: Filter + Copy, M: Fn(Quaternion) -> Result<F>> Stretches<'a, F, M> {
    /// Rates, accelerations and steps, one a row; row 0 is where the attitude is `start`.
    pub(super) fn from_start(make: M, start: Quaternion, rows: Rows<'a>) -> Result<Self> {
        Self::new(make, start, rows, false)
    }

    /// The same, but row 0's step leads from where the attitude is `start`, and may be a gap.
    pub(super) fn after_start(make: M, start: Quaternion, rows: Rows<'a>) -> Result<Self> {
        Self::new(make, start, rows, true)
    }

    fn new(make: M, start: Quaternion, (rates, acc, dt_s): Rows<'a>, leads: bool) -> Result<Self> {
        let filter = make(start)?;
        Ok(Stretches { make, filter, rates, acc, dt_s, row: 0, leads, last: start })
    }
}

impl<F: Filter + Copy, M: Fn(Quaternion) -> Result<F>> Series for Stretches<'_, F, M> {
    fn next(&mut self, out: &mut [Quaternion]) -> Result<()> {
        filter::same_length(out.len(), out.len().min(self.rates.len() - self.row))?;
        let mut done = 0;
        while done < out.len() {
            let row = self.row;
            let mut first = done;
            if self.dt_s[row] > GAP_S {
                // What happened in the gap is unknown: its step is not integrated.
                if row > 0 || self.leads {
                    let level = rest::mean(&self.acc[row..after(self.dt_s, row, LEVEL_S)])?;
                    self.last = initial::level(self.last, level);
                    self.filter = (self.make)(self.last)?;
                }
                out[done] = self.last;
                first += 1;
            }
            let most = row + (out.len() - done);
            let end = (row + 1..most).find(|&k| self.dt_s[k] > GAP_S).unwrap_or(most);
            let stretch = row + (first - done)..end;
            done += end - row;
            let dt = Dt::PerSample(&self.dt_s[stretch.clone()]);
            let (rates, acc) = (&self.rates[stretch.clone()], &self.acc[stretch]);
            self.filter = run(self.filter, rates, acc, dt, &mut out[first..done])?;
            self.last = out[done - 1];
            self.row = end;
        }
        Ok(())
    }
}

/// The filter after some rows. A function of its own, so that the filter stays in the processor's registers.
#[inline(never)]
fn run<F: Filter + Copy>(
    mut filter: F,
    rates: &[Vec3],
    acc: &[Vec3],
    dt: Dt<'_>,
    out: &mut [Quaternion],
) -> Result<F> {
    filter::run_into(&mut filter, rates, acc, dt, out)?;
    Ok(filter)
}
