//! The search for rests, indifferent to gyroscope bias.

use alloc::vec::Vec;
use core::ops::Range;

use crate::STANDARD_GRAVITY_M_S2;
use crate::error::{Error, Result};
use crate::filter::{Dt, check_rows, positive, same_length};
use crate::vector::{self, Vec3};

/// When a stretch of samples counts as a rest. The defaults hold for cheap sensors at 20 … 2000 Hz, on a
/// table or on a person who stands still.
///
/// Samples are averaged over blocks of `block_s`, which takes the white noise down alike at all rates; a
/// window of `window_s` slides over the blocks and is still when its blocks stray little from the window's
/// own mean. So a constant bias of the gyroscope does not matter, up to `bias_max_rad_s`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RestSettings {
    /// Shortest rest, s; default 1. Shorter finds more rests but also pauses of a slow movement.
    pub min_length_s: f64,
    /// Length of a block, s; default 0.05. Must be below half of `window_s`.
    pub block_s: f64,
    /// Length of the sliding window, s; default 0.5.
    pub window_s: f64,
    /// Largest standard deviation of the blocks' rates in a window (root of the three axes' sum), beyond
    /// what noise from block to block explains, rad/s; default 0.035 (2 °/s).
    pub gyro_deviation_rad_s: f64,
    /// The same for the accelerations, m/s²; default 0.2.
    pub acc_deviation_m_s2: f64,
    /// Largest standard deviation of single samples inside the blocks (root of the three axes' sum), rad/s;
    /// default 0.3. Keeps vibration from passing as noise.
    pub gyro_noise_rad_s: f64,
    /// The same for the accelerations, m/s²; default 1.5.
    pub acc_noise_m_s2: f64,
    /// How far a window's mean rate may be from the rest's mean so far, rad/s; default 0.05. Beyond, the rest
    /// ends there.
    pub gyro_drift_rad_s: f64,
    /// The same for the acceleration, m/s²; default 0.4 (2.3° of tilt).
    pub acc_drift_m_s2: f64,
    /// Largest mean rate that can be a bias, rad/s; default 0.5 (29 °/s). A slower constant turn about the
    /// vertical cannot be told from a bias by these sensors.
    pub bias_max_rad_s: f64,
    /// What |a| is at rest, m/s²; default 9.80665.
    pub gravity_m_s2: f64,
    /// How far the mean |a| may be from it, as a share; default 0.15.
    pub gravity_tolerance: f64,
    /// A step longer than this ends a rest, s; default 0.5: what happened meanwhile is not known.
    pub max_gap_s: f64,
}

impl Default for RestSettings {
    fn default() -> Self {
        RestSettings {
            min_length_s: 1.0,
            block_s: 0.05,
            window_s: 0.5,
            gyro_deviation_rad_s: 0.035,
            acc_deviation_m_s2: 0.2,
            gyro_noise_rad_s: 0.3,
            acc_noise_m_s2: 1.5,
            gyro_drift_rad_s: 0.05,
            acc_drift_m_s2: 0.4,
            bias_max_rad_s: 0.5,
            gravity_m_s2: STANDARD_GRAVITY_M_S2,
            gravity_tolerance: 0.15,
            max_gap_s: 0.5,
        }
    }
}

impl RestSettings {
    /// Refused unless all are finite and greater than zero and 2 · blockSec < windowSec ≤ minLengthSec.
    pub fn check(&self) -> Result<()> {
        for (name, value) in [
            ("minLengthSec", self.min_length_s),
            ("blockSec", self.block_s),
            ("windowSec", self.window_s),
            ("gyroDeviation", self.gyro_deviation_rad_s),
            ("accDeviation", self.acc_deviation_m_s2),
            ("gyroNoise", self.gyro_noise_rad_s),
            ("accNoise", self.acc_noise_m_s2),
            ("gyroDrift", self.gyro_drift_rad_s),
            ("accDrift", self.acc_drift_m_s2),
            ("biasMax", self.bias_max_rad_s),
            ("gravity", self.gravity_m_s2),
            ("gravityTolerance", self.gravity_tolerance),
            ("maxGapSec", self.max_gap_s),
        ] {
            positive(name, value)?;
        }
        if !(2.0 * self.block_s < self.window_s && self.window_s <= self.min_length_s) {
            return Err(Error::OutOfOrder { rule: "2 blockSec < windowSec <= minLengthSec" });
        }
        Ok(())
    }
}

/// Samples averaged.
#[derive(Clone, Copy)]
struct Block {
    rows: (usize, usize),
    length_s: f64,
    gyro: Vec3,
    acc: Vec3,
    /// Sum over axes of the samples' variance inside the block.
    gyro_noise: f64,
    acc_noise: f64,
    /// True where a gap lies before the block.
    after_gap: bool,
}

/// The rests of a recording, in order: ranges of rows. Refused: unequal lengths, numbers that are not finite,
/// steps that are not greater than zero, settings that do not pass [`RestSettings::check`]. A recording
/// without rest gives no range.
pub fn find_rests(
    acc_m_s2: &[Vec3],
    gyro_rad_s: &[Vec3],
    dt: Dt<'_>,
    settings: &RestSettings,
) -> Result<Vec<Range<usize>>> {
    check_all(acc_m_s2, gyro_rad_s, dt, settings)?;
    let blocks = make_blocks(acc_m_s2, gyro_rad_s, dt, settings);
    let mut rests = Vec::new();
    search_stretches(&blocks, settings, true, &mut rests, false);
    Ok(rests)
}

fn check_all(acc: &[Vec3], gyro: &[Vec3], dt: Dt<'_>, settings: &RestSettings) -> Result<()> {
    settings.check()?;
    same_length(acc.len(), gyro.len())?;
    dt.check(acc.len())?;
    check_rows(acc, 0)?;
    check_rows(gyro, 0)
}

/// The first of [`find_rests`]; refused ([`Error::NoRest`]) when there is none. What follows that rest is hardly
/// looked at.
pub fn first_rest(
    acc_m_s2: &[Vec3],
    gyro_rad_s: &[Vec3],
    dt: Dt<'_>,
    settings: &RestSettings,
) -> Result<Range<usize>> {
    check_all(acc_m_s2, gyro_rad_s, dt, settings)?;
    first_of_checked(acc_m_s2, gyro_rad_s, dt, settings)
}

/// [`first_rest`] of rows and steps that were looked at already.
pub(crate) fn first_of_checked(
    acc: &[Vec3],
    gyro: &[Vec3],
    dt: Dt<'_>,
    settings: &RestSettings,
) -> Result<Range<usize>> {
    settings.check()?;
    first_from(acc, gyro, dt, settings, 1 << 14)
}

/// Searches the first `rows` rows, then more and more.
fn first_from(
    acc: &[Vec3],
    gyro: &[Vec3],
    dt: Dt<'_>,
    settings: &RestSettings,
    mut rows: usize,
) -> Result<Range<usize>> {
    loop {
        let whole = rows >= acc.len();
        let part = rows.min(acc.len());
        let mut blocks = make_blocks(&acc[..part], &gyro[..part], dt, settings);
        if !whole {
            blocks.pop(); // it may go on
        }
        let mut rests = Vec::new();
        search_stretches(&blocks, settings, whole, &mut rests, true);
        match rests.into_iter().next() {
            Some(first) => return Ok(first),
            None if whole => return Err(Error::NoRest { needed_s: settings.min_length_s }),
            None => rows = rows.saturating_mul(8),
        }
    }
}

/// Searches what lies between gaps. Unless the blocks are the `whole` recording a run at their end is not known yet;
/// where only the `first` rest is wanted the search ends with it.
fn search_stretches(
    blocks: &[Block],
    settings: &RestSettings,
    whole: bool,
    rests: &mut Vec<Range<usize>>,
    first: bool,
) {
    let mut start = 0;
    while start < blocks.len() && (!first || rests.is_empty()) {
        let mut end = start + 1;
        while end < blocks.len() && !blocks[end].after_gap {
            end += 1;
        }
        search_stretch(&blocks[start..end], settings, whole || end < blocks.len(), rests, first);
        start = end;
    }
}

fn make_blocks(acc: &[Vec3], gyro: &[Vec3], dt: Dt<'_>, settings: &RestSettings) -> Vec<Block> {
    let mut blocks = Vec::new();
    let mut start = 0;
    let mut length_s = 0.0;
    let mut gap_before = false;
    for row in 0..acc.len() {
        let step_s = dt.at(row);
        if row > 0 && step_s > settings.max_gap_s {
            if start < row {
                blocks.push(block(acc, gyro, (start, row), length_s, gap_before));
            }
            (start, length_s, gap_before) = (row, 0.0, true);
        }
        // a sample stands for the time since the one before, the first of a stretch for no more than a block
        length_s += step_s.min(if start == row { settings.block_s } else { settings.max_gap_s });
        // half a sample of grace, so that rounding does not change the number of samples in a block
        if length_s + 0.5 * step_s.min(settings.block_s) > settings.block_s {
            blocks.push(block(acc, gyro, (start, row + 1), length_s, gap_before));
            (start, length_s, gap_before) = (row + 1, 0.0, false);
        }
    }
    if start < acc.len() {
        blocks.push(block(acc, gyro, (start, acc.len()), length_s, gap_before));
    }
    blocks
}

fn block(acc: &[Vec3], gyro: &[Vec3], rows: (usize, usize), length_s: f64, after_gap: bool) -> Block {
    let average = |series: &[Vec3]| {
        let part = &series[rows.0..rows.1];
        let mean = super::mean_of(part);
        let n = part.len() as f64;
        let squares = part.iter().fold(0.0, |sum, &row| {
            let d = vector::sub(row, mean);
            sum + vector::dot(d, d)
        });
        (mean, if part.len() > 1 { squares / (n - 1.0) } else { 0.0 })
    };
    let ((gyro, gyro_noise), (acc, acc_noise)) = (average(gyro), average(acc));
    Block { rows, length_s, gyro, acc, gyro_noise, acc_noise, after_gap }
}

/// What a window says of its blocks.
struct Window {
    gyro: Vec3,
    acc: Vec3,
    still: bool,
}

fn judge(blocks: &[Block], settings: &RestSettings) -> Window {
    let n = blocks.len() as f64;
    let mut gyro = [0.0; 3];
    let mut acc = [0.0; 3];
    let (mut gyro_noise, mut acc_noise) = (0.0, 0.0);
    for b in blocks {
        gyro = vector::add(gyro, vector::scale(b.gyro, 1.0 / n));
        acc = vector::add(acc, vector::scale(b.acc, 1.0 / n));
        gyro_noise += b.gyro_noise / n;
        acc_noise += b.acc_noise / n;
    }
    let gyro_variance = spread(blocks, settings.gyro_deviation_rad_s, |b| vector::sub(b.gyro, gyro));
    let acc_variance = spread(blocks, settings.acc_deviation_m_s2, |b| vector::sub(b.acc, acc));
    let square = |x: f64| x * x;
    let norm = vector::norm(acc);
    let still = gyro_variance <= square(settings.gyro_deviation_rad_s)
        && acc_variance <= square(settings.acc_deviation_m_s2)
        && gyro_noise <= square(settings.gyro_noise_rad_s)
        && acc_noise <= square(settings.acc_noise_m_s2)
        && vector::norm(gyro) <= settings.bias_max_rad_s
        && (norm - settings.gravity_m_s2).abs() <= settings.gravity_tolerance * settings.gravity_m_s2;
    Window { gyro, acc, still }
}

/// Variance of the blocks' means, summed over axes, less what their own noise explains: half the mean squared
/// difference of neighbours, which smooth movement hardly adds to. Fast movement does; so no more than the
/// limit's own square is taken off.
fn spread(blocks: &[Block], limit: f64, deviation: impl Fn(&Block) -> Vec3) -> f64 {
    let n = blocks.len() as f64;
    let (mut variance, mut noise) = (0.0, 0.0);
    let mut before: Option<Vec3> = None;
    for b in blocks {
        let d = deviation(b);
        variance += vector::dot(d, d) / (n - 1.0);
        if let Some(before) = before {
            let step = vector::sub(d, before);
            noise += 0.5 * vector::dot(step, step) / (n - 1.0);
        }
        before = Some(d);
    }
    variance - noise.min(limit * limit)
}

/// Blocks without a gap between them; `ends` where no more of them follow.
fn search_stretch(
    blocks: &[Block],
    settings: &RestSettings,
    ends: bool,
    rests: &mut Vec<Range<usize>>,
    first: bool,
) {
    let mut run: Option<Run> = None;
    let mut window_start = 0;
    let mut length_s = 0.0;
    for end in 0..blocks.len() {
        length_s += blocks[end].length_s;
        // the shortest window that is long enough, of three blocks or more
        while end - window_start >= 3 && length_s - blocks[window_start].length_s >= settings.window_s {
            length_s -= blocks[window_start].length_s;
            window_start += 1;
        }
        // windows that are not still between two that overlap do not part them
        if let Some(over) = run.take_if(|run| window_start > run.last) {
            over.finish(blocks, settings, rests);
            if first && !rests.is_empty() {
                return;
            }
        }
        if end - window_start < 2 || length_s < 0.99 * settings.window_s {
            continue;
        }
        let window = judge(&blocks[window_start..=end], settings);
        if !window.still {
            continue;
        }
        if let Some(over) = run.take_if(|run| !run.fits(&window, settings)) {
            over.finish(blocks, settings, rests);
            if first && !rests.is_empty() {
                return;
            }
        }
        run.get_or_insert_with(|| Run::new(window_start)).extend(end, &window);
    }
    if let Some(run) = run.take().filter(|_| ends) {
        run.finish(blocks, settings, rests);
    }
}

/// Still windows in a row.
struct Run {
    first: usize,
    last: usize,
    windows: f64,
    gyro: Vec3,
    acc: Vec3,
}

impl Run {
    fn new(first: usize) -> Self {
        Run { first, last: first, windows: 0.0, gyro: [0.0; 3], acc: [0.0; 3] }
    }

    fn fits(&self, window: &Window, settings: &RestSettings) -> bool {
        vector::norm(vector::sub(window.gyro, self.gyro)) <= settings.gyro_drift_rad_s
            && vector::norm(vector::sub(window.acc, self.acc)) <= settings.acc_drift_m_s2
    }

    fn extend(&mut self, last: usize, window: &Window) {
        self.last = last;
        self.windows += 1.0;
        let share = 1.0 / self.windows;
        self.gyro = vector::add(self.gyro, vector::scale(vector::sub(window.gyro, self.gyro), share));
        self.acc = vector::add(self.acc, vector::scale(vector::sub(window.acc, self.acc), share));
    }

    /// Without the block at either end that borders on movement, if what is left is long enough.
    fn finish(self, blocks: &[Block], settings: &RestSettings, rests: &mut Vec<Range<usize>>) {
        let mut first = if self.first == 0 { 0 } else { self.first + 1 };
        let last = if self.last + 1 == blocks.len() { self.last } else { self.last - 1 };
        if let Some(before) = rests.last() {
            while first < last && blocks[first].rows.0 < before.end {
                first += 1;
            }
        }
        if first > last {
            return;
        }
        let length_s = blocks[first..=last].iter().fold(0.0, |sum, b| sum + b.length_s);
        // a thousandth of grace for rounding
        if length_s >= 0.999 * settings.min_length_s {
            rests.push(blocks[first].rows.0..blocks[last].rows.1);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Movement with pauses of several lengths and a gap: the first rest is the same however little is looked at at
    /// once, and from wherever the recording starts and ends.
    #[test]
    fn the_first_of_all() {
        let mut seed = 1u32;
        let mut noise = || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(seed >> 8) / 16_777_216.0 - 0.5
        };
        let (mut acc, mut gyro, mut dt_s) = (Vec::new(), Vec::new(), Vec::new());
        for row in 0..6_000usize {
            let still = row % 1_000 < [0, 60, 130, 400, 90, 300][row / 1_000];
            let size = if still { 0.01 } else { 2.0 };
            gyro.push([size * noise(), size * noise(), size * noise()]);
            acc.push([size * noise(), size * noise(), 9.8 + size * noise()]);
            dt_s.push(if row == 3_100 { 2.0 } else { 0.01 });
        }
        let settings = RestSettings::default();
        let mut found = 0;
        for (from, to) in [(0, 6_000), (0, 3_150), (0, 2_120), (2_050, 2_400), (3_090, 6_000), (3_500, 4_500)]
        {
            let (acc, gyro) = (&acc[from..to], &gyro[from..to]);
            let dt = Dt::PerSample(&dt_s[from..to]);
            let all = find_rests(acc, gyro, dt, &settings).unwrap();
            let expected = all.first().cloned().ok_or(Error::NoRest { needed_s: settings.min_length_s });
            found += usize::from(expected.is_ok());
            for rows in [1, 2, 7, 40, 200, 201, 777, 2_300, 10_000] {
                assert_eq!(first_from(acc, gyro, dt, &settings, rows), expected, "{from} to {to}, {rows}");
            }
        }
        assert!(found >= 4);
    }
}
