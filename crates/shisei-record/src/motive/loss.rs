//! When a body or a marker was not tracked: blank cells, or a pose that stands still to the last bit.

use super::body::{Body, Marker};
use super::take::Take;
use shisei_core::Vec3;

/// What counts as lost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LossRule {
    /// A pose that is repeated bit for bit so often, the first included, was not measured: all but the first
    /// are lost. Real cameras scatter, so that a measured pose is never the same three times. None: only blank
    /// cells count. Default 3.
    pub frozen_run: Option<usize>,
}

impl Default for LossRule {
    fn default() -> Self {
        LossRule { frozen_run: Some(3) }
    }
}

impl Take {
    /// One flag a frame: true where the body's pose was measured.
    pub fn tracked(&self, body: &Body, rule: LossRule) -> Vec<bool> {
        let columns = body.columns();
        let cell = |column: usize, row: usize| {
            self.columns.get(column).and_then(|c| c.cells.get(row)).copied().unwrap_or(f64::NAN)
        };
        let mut tracked: Vec<bool> = (0..self.len()).map(|row| self.pose(body, row).is_some()).collect();
        let Some(needed) = rule.frozen_run else { return tracked };
        let same = |a: usize, b: usize| columns.iter().all(|&c| cell(c, a).to_bits() == cell(c, b).to_bits());
        thaw(&mut tracked, needed, same);
        tracked
    }

    /// A marker's position in each frame, m, in the take's axes; none where it was not measured.
    pub fn sightings(&self, marker: &Marker, rule: LossRule) -> Vec<Option<Vec3>> {
        let all: Vec<Option<Vec3>> = (0..self.len()).map(|row| self.marker_m(marker, row)).collect();
        let mut seen: Vec<bool> = all.iter().map(Option::is_some).collect();
        if let Some(needed) = rule.frozen_run {
            let bits = |row: usize| all.get(row).copied().flatten().map(|place| place.map(f64::to_bits));
            thaw(&mut seen, needed, |a, b| bits(a) == bits(b));
        }
        all.into_iter().zip(seen).map(|(place, seen)| place.filter(|_| seen)).collect()
    }
}

/// Takes the flag off all but the first of so many measured frames, or more, that are the same.
fn thaw(tracked: &mut [bool], needed: usize, same: impl Fn(usize, usize) -> bool) {
    let mut start = 0;
    while start < tracked.len() {
        let mut end = start + 1;
        while end < tracked.len() && tracked.get(start) == Some(&true) && same(start, end) {
            end += 1;
        }
        if end - start >= needed.max(2) {
            for flag in tracked.iter_mut().take(end).skip(start + 1) {
                *flag = false;
            }
        }
        start = end;
    }
}
