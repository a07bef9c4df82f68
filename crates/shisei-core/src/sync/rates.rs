//! Clock offset, clock skew and mounting of a sensor from the rotation of the body it is fixed to.
//!
//! Sensor time = `offset + (1 + skew) · optical time`. What is compared are turns over a short interval (0.15 s):
//! those of the optical attitudes and those of the gyroscope between the same two moments, so that no rate is
//! differentiated and both sides see the same smoothing. First the sizes of the turns are correlated, which
//! needs no alignment; the best lags are then refined by least squares of
//!
//! `θ_optical = (1 + E) R (θ_gyro(offset, skew) − b Δt)`
//!
//! with the mounting R (`body_from_sensor`, first by [`super::wahba`]), the gyroscope's bias b and its scales and
//! misalignment E (2 % a priori). Residuals beyond three deviations count less (P. J. Huber 1964). Errors come from
//! the scatter of whole blocks of a second, so that they hold although neighbouring turns overlap.

use alloc::vec::Vec;

use super::correlate;
use super::gyro_path::{GyroPath, Stamp, median};
use super::wahba::{LEAST_RATIO, Pairs, nearest_rotation};
use crate::error::{Error, Result};
use crate::filter::same_length;
use crate::least_squares::inverse_spd;
use crate::math;
use crate::matrix::{Square, times_vector};
use crate::quaternion::Quaternion;
use crate::vector::{self, Vec3};

/// Rows of the correlation a second.
const GRID_HZ: f64 = 20.0;
/// Candidates of the correlation.
const CANDIDATES: usize = 6;
/// The first stretch that is fitted, s; it grows by this factor.
const FIRST_STRETCH_S: f64 = 20.0;
const GROWTH: f64 = 3.0;
/// Turns larger than this are too near a half turn, rad.
const LARGEST_TURN_RAD: f64 = 2.5;
/// Standard deviations a priori: of E, of the bias (rad/s) and of the skew.
const PRIOR_E: f64 = 0.02;
const PRIOR_BIAS: f64 = 0.3;
const PRIOR_SKEW: f64 = 0.02;
/// A block of residuals that is taken as one, s.
const BLOCK_S: f64 = 1.0;
/// Least share of the turns that a common motion explains.
pub const LEAST_EXPLAINED: f64 = 0.9;
/// Turns needed.
const LEAST_TURNS: usize = 60;

/// Unknowns: E row by row, b, offset at the middle, skew.
const UNKNOWNS: usize = 14;
const BIAS: usize = 9;
const OFFSET: usize = 12;
const SKEW: usize = 13;

/// Where to look.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Start {
    /// Anywhere.
    #[default]
    Search,
    /// Near this offset, s, from an earlier fit or a common trigger; within about 0.1 s.
    Near(f64),
}

/// How the recordings are compared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RatesSettings {
    /// Length of a turn, s: 0.15. Short ones drown in the cameras' noise, long ones come near half a turn.
    pub interval_s: f64,
    /// Where to look.
    pub start: Start,
    /// What the times of the gyroscope's readings mean.
    pub stamp: Stamp,
}

impl Default for RatesSettings {
    fn default() -> Self {
        RatesSettings { interval_s: 0.15, start: Start::Search, stamp: Stamp::End }
    }
}

/// Clocks and mounting, with their errors (one standard deviation).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sync {
    /// Sensor time at optical time 0, s.
    pub offset_s: f64,
    /// Sensor seconds in an optical second, less 1.
    pub skew: f64,
    /// Optical time in the middle of what was compared, s.
    pub middle_s: f64,
    /// Error of the offset in the middle, s.
    pub sigma_offset_s: f64,
    /// Error of the skew.
    pub sigma_skew: f64,
    /// Turns sensor coordinates into body coordinates.
    pub body_from_sensor: Quaternion,
    /// Error of the mounting about each body axis, rad.
    pub sigma_mounting_rad: Vec3,
    /// The gyroscope's mean bias, sensor coordinates, rad/s.
    pub gyro_bias_rad_s: Vec3,
    /// 1 + E: body rates from turned gyroscope rates.
    pub gyro_matrix: [[f64; 3]; 3],
    /// Root mean square of the residual turn over the interval, rad/s.
    pub residual_rad_s: f64,
    /// Share of the optical turns' squares that is explained, 0 … 1.
    pub explained: f64,
    /// The same for the next best offset; near `explained` where the motion repeats itself.
    pub runner_up: f64,
    /// Spread of the turns across their main axis as a share of that along it.
    pub axis_ratio: f64,
    /// Turns compared.
    pub turns: usize,
}

impl Sync {
    /// Sensor time of an optical time, s.
    pub fn sensor_time_s(&self, optical_s: f64) -> f64 {
        self.offset_s + (1.0 + self.skew) * optical_s
    }

    /// Optical time of a sensor time, s.
    pub fn optical_time_s(&self, sensor_s: f64) -> f64 {
        (sensor_s - self.offset_s) / (1.0 + self.skew)
    }

    /// Error of the sensor time at an optical time, s.
    pub fn sigma_time_s(&self, optical_s: f64) -> f64 {
        math::hypot(self.sigma_offset_s, self.sigma_skew * (optical_s - self.middle_s))
    }
}

/// A turn that the cameras saw: from when to when, and its rotation vector in body coordinates.
#[derive(Clone, Copy, Debug)]
struct Turn {
    from_s: f64,
    to_s: f64,
    body_rad: Vec3,
}

impl Turn {
    fn middle_s(&self) -> f64 {
        0.5 * (self.from_s + self.to_s)
    }

    fn length_s(&self) -> f64 {
        self.to_s - self.from_s
    }
}

/// Finds clocks and mounting.
///
/// `optical_s` ascends; `world_from_body` holds one attitude a frame, none where the body was lost; `sensor_s`
/// ascends; `gyro_rad_s` are readings in sensor coordinates. Refused: unequal lengths, numbers that are not
/// finite, times that do not ascend, an interval that is not positive, fewer than 60 turns, no common motion
/// ([`Error::NoCommonMotion`]), rotation about one axis only ([`Error::OneAxisOnly`]).
pub fn synchronise(
    optical_s: &[f64],
    world_from_body: &[Option<Quaternion>],
    sensor_s: &[f64],
    gyro_rad_s: &[Vec3],
    settings: &RatesSettings,
) -> Result<Sync> {
    same_length(optical_s.len(), world_from_body.len())?;
    crate::filter::positive("interval_s", settings.interval_s)?;
    let path = GyroPath::new(sensor_s, gyro_rad_s, settings.stamp)?;
    let turns = turns(optical_s, world_from_body, settings.interval_s)?;
    if turns.len() < LEAST_TURNS {
        return Err(Error::TooFewPoints { given: turns.len(), needed: LEAST_TURNS });
    }
    let busiest_s = busiest(&turns, FIRST_STRETCH_S);
    let offsets = match settings.start {
        Start::Near(offset_s) => alloc::vec![offset_s],
        Start::Search => candidates(&turns, &path, settings.interval_s, busiest_s)?,
    };
    // every candidate on the busiest stretch, the two best on everything
    let first = stretch(&turns, busiest_s, FIRST_STRETCH_S);
    let mut fits: Vec<Fit> = offsets
        .iter()
        .filter_map(|&offset_s| Fit::start(busiest_s, offset_s).refine(first, &path, 6))
        .collect();
    fits.sort_by(|a, b| b.explained.total_cmp(&a.explained));
    let mut done: Vec<Fit> = fits.into_iter().take(2).filter_map(|fit| fit.grow(&turns, &path)).collect();
    done.sort_by(|a, b| b.explained.total_cmp(&a.explained));
    let best = done.first().copied().ok_or(Error::NoCommonMotion { explained: 0.0 })?;
    if best.explained < LEAST_EXPLAINED {
        return Err(Error::NoCommonMotion { explained: best.explained });
    }
    let other = done.get(1).filter(|fit| (fit.offset_s - best.offset_s).abs() > 0.05);
    let pairs = best.pairs(&turns, &path);
    let axis_ratio = pairs.ratio();
    if axis_ratio < LEAST_RATIO {
        return Err(Error::OneAxisOnly { ratio: axis_ratio });
    }
    best.sync(&turns, &path, axis_ratio, other.map_or(0.0, |fit| fit.explained))
}

/// Turns over `interval_s`, from every frame that was seen.
fn turns(time_s: &[f64], attitude: &[Option<Quaternion>], interval_s: f64) -> Result<Vec<Turn>> {
    for (row, pair) in time_s.windows(2).enumerate() {
        if pair[1].is_nan() || pair[1] <= pair[0] || !(pair[1] - pair[0]).is_finite() {
            return Err(Error::NotFinite { row: row + 1 });
        }
    }
    let mut steps: Vec<f64> = time_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let slack = 0.5 * median(&mut steps);
    let mut out = Vec::new();
    let mut to = 0;
    for (from, q) in attitude.iter().enumerate() {
        let Some(q) = q else { continue };
        if !q.is_finite() {
            return Err(Error::NotFinite { row: from });
        }
        to = to.max(from + 1);
        while to < time_s.len() && time_s[to] < time_s[from] + interval_s - slack {
            to += 1;
        }
        let mut late =
            (to..time_s.len()).take_while(|&k| time_s[k] <= time_s[from] + 1.5 * interval_s + slack);
        let Some((end, after)) = late.find_map(|k| Some((k, attitude[k]?))) else { continue };
        let body_rad = q.conjugate().product(after).to_rotation_vector();
        if vector::norm(body_rad) < LARGEST_TURN_RAD {
            out.push(Turn { from_s: time_s[from], to_s: time_s[end], body_rad });
        }
    }
    Ok(out)
}

/// Middle of the stretch of this length that holds most turning.
fn busiest(turns: &[Turn], length_s: f64) -> f64 {
    let (mut best, mut sum, mut first) = ((0.0, turns[0].middle_s()), 0.0, 0);
    for turn in turns {
        sum += vector::dot(turn.body_rad, turn.body_rad);
        while turn.middle_s() - turns[first].middle_s() > length_s {
            sum -= vector::dot(turns[first].body_rad, turns[first].body_rad);
            first += 1;
        }
        if sum > best.0 {
            best = (sum, 0.5 * (turn.middle_s() + turns[first].middle_s()));
        }
    }
    best.1
}

/// The turns within half a length of a time.
fn stretch(turns: &[Turn], middle_s: f64, length_s: f64) -> &[Turn] {
    let start = turns.partition_point(|turn| turn.middle_s() < middle_s - 0.5 * length_s);
    let end = turns.partition_point(|turn| turn.middle_s() <= middle_s + 0.5 * length_s);
    &turns[start..end]
}

/// Offsets at which the sizes of the turns are alike: over everything, and for the busiest stretch alone, which
/// a wrong clock rate spoils less.
fn candidates(turns: &[Turn], path: &GyroPath<'_>, interval_s: f64, busiest_s: f64) -> Result<Vec<f64>> {
    let (start_s, end_s) = path.span_s();
    let rows = math::floor((end_s - start_s) * GRID_HZ);
    if rows > 1e8 {
        return Err(Error::OutOfRange { rule: "recording shorter than 57 days", value: end_s - start_s });
    }
    let half = 0.5 * interval_s;
    let sensor: Vec<f64> = (0..rows as usize)
        .map(|row| {
            let middle = start_s + (row as f64 + 0.5) / GRID_HZ;
            let turn = path.turn(middle - half, middle + half);
            turn.map_or(f64::NAN, |turn| vector::norm(turn) / interval_s)
        })
        .collect();
    let mut offsets: Vec<f64> = Vec::new();
    for part in [turns, stretch(turns, busiest_s, FIRST_STRETCH_S)] {
        let (first_s, speeds) = speeds(part)?;
        let there = speeds.iter().filter(|speed| speed.is_finite()).count();
        let overlap = (there / 3).min((5.0 * GRID_HZ) as usize).max(there / 8);
        let apart = (0.4 * GRID_HZ) as usize;
        for peak in correlate::peaks(&speeds, &sensor, overlap, apart, CANDIDATES)? {
            let offset_s = start_s - first_s + peak.lag as f64 / GRID_HZ;
            if offsets.iter().all(|other| (other - offset_s).abs() > 0.5 / GRID_HZ) {
                offsets.push(offset_s);
            }
        }
    }
    Ok(offsets)
}

/// Mean speed of the turns in each row of the grid, and the time of its start.
fn speeds(turns: &[Turn]) -> Result<(f64, Vec<f64>)> {
    let (Some(first), Some(last)) = (turns.first(), turns.last()) else { return Err(Error::Empty) };
    let first_s = first.middle_s();
    let rows = math::floor((last.middle_s() - first_s) * GRID_HZ);
    if rows > 1e8 {
        return Err(Error::OutOfRange { rule: "take shorter than 57 days", value: last.to_s - first.from_s });
    }
    let mut sums = alloc::vec![(0.0, 0.0); rows as usize + 1];
    for turn in turns {
        let row = math::floor((turn.middle_s() - first_s) * GRID_HZ) as usize;
        if let Some(sum) = sums.get_mut(row) {
            *sum = (sum.0 + vector::norm(turn.body_rad) / turn.length_s(), sum.1 + 1.0);
        }
    }
    Ok((
        first_s,
        sums.into_iter().map(|(sum, count)| if count > 0.0 { sum / count } else { f64::NAN }).collect(),
    ))
}

/// A state of the least squares.
#[derive(Clone, Copy, Debug)]
struct Fit {
    /// Optical time to which the offset belongs, s.
    middle_s: f64,
    /// Sensor time less optical time there, s.
    offset_s: f64,
    skew: f64,
    body_from_sensor: Quaternion,
    e: [[f64; 3]; 3],
    bias: Vec3,
    /// Deviation of a component of the residual, rad.
    sigma_rad: f64,
    explained: f64,
}

/// One turn beside the gyroscope's.
struct Row {
    /// Optical less turned gyroscope turn without E, rad.
    residual: Vec3,
    /// Derivatives of the three components.
    jacobian: [[f64; UNKNOWNS]; 3],
}

/// Normal equations over some turns.
struct System {
    matrix: Square<UNKNOWNS>,
    gradient: [f64; UNKNOWNS],
    rows: usize,
}

impl Fit {
    fn start(middle_s: f64, offset_s: f64) -> Self {
        Fit {
            middle_s,
            offset_s,
            skew: 0.0,
            body_from_sensor: Quaternion::IDENTITY,
            e: [[0.0; 3]; 3],
            bias: [0.0; 3],
            sigma_rad: 0.0,
            explained: 0.0,
        }
    }

    fn sensor_s(&self, optical_s: f64) -> f64 {
        optical_s + self.offset_s + self.skew * (optical_s - self.middle_s)
    }

    /// The gyroscope's turn without bias, sensor coordinates.
    fn gyro_turn(&self, turn: &Turn, path: &GyroPath<'_>, later_s: f64) -> Option<Vec3> {
        let (from, to) = (self.sensor_s(turn.from_s) + later_s, self.sensor_s(turn.to_s) + later_s);
        Some(vector::sub(path.turn(from, to)?, vector::scale(self.bias, to - from)))
    }

    fn pairs(&self, turns: &[Turn], path: &GyroPath<'_>) -> Pairs {
        let mut pairs = Pairs::default();
        for turn in turns {
            if let Some(gyro) = self.gyro_turn(turn, path, 0.0) {
                pairs.add(gyro, turn.body_rad, 1.0);
            }
        }
        pairs
    }

    fn row(&self, turn: &Turn, path: &GyroPath<'_>) -> Option<Row> {
        let step = path.step_s().min(0.25 * turn.length_s());
        let gyro = self.gyro_turn(turn, path, 0.0)?;
        let (before, after) = (self.gyro_turn(turn, path, -step)?, self.gyro_turn(turn, path, step)?);
        let r = self.body_from_sensor.to_matrix();
        let turned = times_vector(&r, &gyro);
        let later = times_vector(&r, &vector::scale(vector::sub(after, before), 0.5 / step));
        let mut jacobian = [[0.0; UNKNOWNS]; 3];
        for (axis, row) in jacobian.iter_mut().enumerate() {
            row[3 * axis..3 * axis + 3].copy_from_slice(&turned);
            for k in 0..3 {
                row[BIAS + k] = -turn.length_s() * r[axis][k];
            }
            row[OFFSET] = later[axis];
            row[SKEW] = later[axis] * (turn.middle_s() - self.middle_s);
        }
        Some(Row { residual: vector::sub(turn.body_rad, turned), jacobian })
    }

    /// Residual of a row with the present E.
    fn left(&self, row: &Row) -> Vec3 {
        let turned = [row.jacobian[0][0], row.jacobian[0][1], row.jacobian[0][2]];
        vector::sub(row.residual, times_vector(&self.e, &turned))
    }

    /// Huber's weight.
    fn weight(&self, left: Vec3) -> f64 {
        let size = vector::norm(left);
        // three components: √3 deviations are usual
        let limit = 3.0 * 1.7 * self.sigma_rad;
        if size <= limit || size == 0.0 { 1.0 } else { limit / size }
    }

    /// One round: deviation and share explained from the residuals, then the least-squares step.
    fn step(&mut self, turns: &[Turn], path: &GyroPath<'_>) -> Option<f64> {
        let rows: Vec<(&Turn, Row)> =
            turns.iter().filter_map(|turn| Some((turn, self.row(turn, path)?))).collect();
        // an offset at which most of the take lies outside the recording is none
        if rows.len() < LEAST_TURNS.max(turns.len() / 4) {
            return None;
        }
        let mut sizes: Vec<f64> = rows.iter().map(|(_, row)| vector::norm(self.left(row))).collect();
        // the median length of a normal 3-vector is 1.538 deviations
        self.sigma_rad = (median(&mut sizes) / 1.538).max(1e-9);
        let (mut left_sum, mut all_sum) = (0.0, 0.0);
        for (turn, row) in &rows {
            let left = self.left(row);
            let weight = self.weight(left);
            left_sum += weight * vector::dot(left, left);
            all_sum += weight * vector::dot(turn.body_rad, turn.body_rad);
        }
        self.explained = if all_sum > 0.0 { 1.0 - left_sum / all_sum } else { 0.0 };
        let system = self.system(rows.iter().map(|(_, row)| row));
        let inverse = inverse_spd(&system.matrix).ok()?;
        let mut x = times_vector(&inverse, &system.gradient);
        // a step stays within what the linearisation holds for
        let most = 0.1 / x[OFFSET].abs().max(0.1);
        x[OFFSET] *= most;
        for axis in 0..3 {
            for k in 0..3 {
                self.e[axis][k] = x[3 * axis + k];
            }
            self.bias[axis] += x[BIAS + axis];
        }
        self.offset_s += x[OFFSET];
        self.skew = (self.skew + x[SKEW]).clamp(-0.05, 0.05);
        self.settle_rotation();
        Some(x[OFFSET].abs().max(x[SKEW].abs()))
    }

    /// The rotation nearest to (1 + E) R becomes R; E keeps what is left.
    fn settle_rotation(&mut self) {
        let r = self.body_from_sensor.to_matrix();
        let mut whole = r;
        for i in 0..3 {
            for j in 0..3 {
                for k in 0..3 {
                    whole[i][j] += self.e[i][k] * r[k][j];
                }
            }
        }
        self.body_from_sensor = nearest_rotation(&whole);
        let r = self.body_from_sensor.to_matrix();
        for i in 0..3 {
            for j in 0..3 {
                self.e[i][j] = vector::dot(whole[i], r[j]) - if i == j { 1.0 } else { 0.0 };
            }
        }
    }

    fn system<'r>(&self, rows: impl Iterator<Item = &'r Row>) -> System {
        let mut system = System { matrix: [[0.0; UNKNOWNS]; UNKNOWNS], gradient: [0.0; UNKNOWNS], rows: 0 };
        for row in rows {
            let weight = self.weight(self.left(row)) / (self.sigma_rad * self.sigma_rad);
            system.add(row, row.residual, weight);
            system.rows += 1;
        }
        for k in 0..BIAS {
            system.matrix[k][k] += 1.0 / (PRIOR_E * PRIOR_E);
        }
        for k in 0..3 {
            system.matrix[BIAS + k][BIAS + k] += 1.0 / (PRIOR_BIAS * PRIOR_BIAS);
            system.gradient[BIAS + k] -= self.bias[k] / (PRIOR_BIAS * PRIOR_BIAS);
        }
        system.matrix[SKEW][SKEW] += 1.0 / (PRIOR_SKEW * PRIOR_SKEW);
        system.gradient[SKEW] -= self.skew / (PRIOR_SKEW * PRIOR_SKEW);
        system
    }

    /// Aligned anew, then some rounds.
    fn refine(mut self, turns: &[Turn], path: &GyroPath<'_>, rounds: usize) -> Option<Fit> {
        self.body_from_sensor = nearest_rotation(&self.pairs(turns, path).b_a);
        self.e = [[0.0; 3]; 3];
        for _ in 0..rounds {
            if self.step(turns, path)? < 1e-8 {
                break;
            }
        }
        Some(self)
    }

    /// On longer and longer stretches until all turns are in.
    fn grow(self, turns: &[Turn], path: &GyroPath<'_>) -> Option<Fit> {
        let (mut fit, mut length_s) = (self, FIRST_STRETCH_S);
        loop {
            length_s *= GROWTH;
            let part = stretch(turns, fit.middle_s, length_s);
            let all = part.len() == turns.len();
            fit = fit.refine(part, path, if all { 15 } else { 4 })?;
            if all {
                return Some(fit);
            }
        }
    }

    /// The result, with errors from blocks of residuals.
    fn sync(&self, turns: &[Turn], path: &GyroPath<'_>, axis_ratio: f64, runner_up: f64) -> Result<Sync> {
        let mut all = Vec::new();
        for turn in turns {
            if let Some(row) = self.row(turn, path) {
                all.push((turn.middle_s(), row));
            }
        }
        let system = self.system(all.iter().map(|(_, row)| row));
        let inverse = inverse_spd(&system.matrix)?;
        let mut blocks = Blocks::default();
        let (mut squares, mut weights, mut middle) = (0.0, 0.0, 0.0);
        for (time_s, row) in &all {
            let left = self.left(row);
            let weight = self.weight(left);
            squares += weight * vector::dot(left, left);
            weights += weight;
            middle += time_s;
            blocks.add(*time_s, row, left, weight / (self.sigma_rad * self.sigma_rad));
        }
        let covariance = blocks.covariance(&inverse);
        let sigma = |h: &[f64; UNKNOWNS]| math::sqrt(vector_form(&covariance, h).max(0.0));
        let of = |entries: &[(usize, f64)]| {
            let mut h = [0.0; UNKNOWNS];
            for (k, value) in entries {
                h[*k] = *value;
            }
            h
        };
        // the time at which offset and skew are independent of each other
        let spread = covariance[SKEW][SKEW];
        let shift = if spread > 0.0 { -covariance[OFFSET][SKEW] / spread } else { 0.0 };
        let reach = all.last().map_or(0.0, |last| last.0 - all[0].0);
        let mean_s = middle / all.len() as f64;
        let middle_s = (self.middle_s + shift).clamp(mean_s - 0.5 * reach, mean_s + 0.5 * reach);
        let antisymmetric = |i: usize, j: usize| sigma(&of(&[(3 * i + j, 0.5), (3 * j + i, -0.5)]));
        let mut gyro_matrix = self.e;
        for (k, row) in gyro_matrix.iter_mut().enumerate() {
            row[k] += 1.0;
        }
        let interval_s = all.first().map_or(1.0, |_| turns[turns.len() / 2].length_s());
        Ok(Sync {
            offset_s: self.offset_s - self.skew * self.middle_s,
            skew: self.skew,
            middle_s,
            sigma_offset_s: sigma(&of(&[(OFFSET, 1.0), (SKEW, middle_s - self.middle_s)])),
            sigma_skew: sigma(&of(&[(SKEW, 1.0)])),
            body_from_sensor: self.body_from_sensor,
            sigma_mounting_rad: [antisymmetric(2, 1), antisymmetric(0, 2), antisymmetric(1, 0)],
            gyro_bias_rad_s: self.bias,
            gyro_matrix,
            residual_rad_s: math::sqrt(squares / weights.max(1.0)) / interval_s,
            explained: self.explained,
            runner_up,
            axis_ratio,
            turns: all.len(),
        })
    }
}

impl System {
    fn add(&mut self, row: &Row, residual: Vec3, weight: f64) {
        for (j, r) in row.jacobian.iter().zip(residual) {
            for a in 0..UNKNOWNS {
                let wj = weight * j[a];
                for b in 0..UNKNOWNS {
                    self.matrix[a][b] += wj * j[b];
                }
                self.gradient[a] += wj * r;
            }
        }
    }
}

/// hᵀ C h.
fn vector_form(c: &Square<UNKNOWNS>, h: &[f64; UNKNOWNS]) -> f64 {
    times_vector(c, h).iter().zip(h).map(|(a, b)| a * b).sum()
}

/// Scores of blocks of residuals: their scatter is what the estimate's errors come from (a clustered sandwich;
/// K.-Y. Liang, S. L. Zeger, Biometrika 73(1), 13, 1986).
#[derive(Default)]
struct Blocks {
    scores: Vec<[f64; UNKNOWNS]>,
    current: Option<i64>,
}

impl Blocks {
    fn add(&mut self, time_s: f64, row: &Row, left: Vec3, weight: f64) {
        let block = math::floor(time_s / BLOCK_S) as i64;
        if self.current != Some(block) {
            self.current = Some(block);
            self.scores.push([0.0; UNKNOWNS]);
        }
        if let Some(score) = self.scores.last_mut() {
            for (j, r) in row.jacobian.iter().zip(left) {
                for a in 0..UNKNOWNS {
                    score[a] += weight * j[a] * r;
                }
            }
        }
    }

    fn covariance(&self, inverse: &Square<UNKNOWNS>) -> Square<UNKNOWNS> {
        let count = self.scores.len() as f64;
        let factor = count / (count - 1.0).max(1.0);
        let mut out = [[0.0; UNKNOWNS]; UNKNOWNS];
        for score in &self.scores {
            let moved = times_vector(inverse, score);
            for a in 0..UNKNOWNS {
                for b in 0..UNKNOWNS {
                    out[a][b] += factor * moved[a] * moved[b];
                }
            }
        }
        out
    }
}
