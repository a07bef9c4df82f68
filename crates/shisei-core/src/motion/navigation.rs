//! From readings and knowledge of when the sensor stood still to velocity and position with an error band.
//!
//! A strapdown navigator (trapezoid rule) with the 33 error states of [`super::error_state`], smoothed backwards.
//! While the sensor rests nothing is integrated: its velocity is zero, its mean rate is the bias, its mean
//! acceleration is gravity seen from its attitude. In a stance (a foot on the ground) integration goes on, and
//! the velocity is measured as zero with some tolerance.

use alloc::vec::Vec;
use core::ops::Range;

use crate::error::{Error, Result};
use crate::filter::Dt;
use crate::math;
use crate::motion::error_state::{
    ACC_BIAS, ACC_MATRIX, ATTITUDE, Adjoint, Covariance, GYRO_BIAS, GYRO_MATRIX, POSITION, ProcessNoise,
    STATES, State, Step, Update, VELOCITY, propagate, update,
};
use crate::motion::holes::{Hole, HoleMotion, hole_from_s, holes};
use crate::quaternion::Quaternion;
use crate::vector::{self, Vec3};

mod bridge;
mod given_end;

pub use given_end::GivenEnd;

/// What is known of the sensor at a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// It moves, or nothing is known.
    Moving,
    /// Its velocity is about zero (a foot on the ground); it may turn a little.
    Stance,
    /// It does not move at all.
    Rest,
}

/// How wrong a sensor may be before anything is measured: standard deviations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorErrors {
    /// Gyroscope bias, rad/s; default 0.05 (3 °/s). A rest measures it at once, so its size hardly matters.
    pub gyro_bias_rad_s: f64,
    /// Accelerometer bias, m/s²; default 0.05 (5 mg). Larger: the band widens with every turn.
    pub acc_bias_m_s2: f64,
    /// Gyroscope scale, 1; default 0.003.
    pub gyro_scale: f64,
    /// Gyroscope misalignment, rad; default 0.003.
    pub gyro_misalignment: f64,
    /// Accelerometer scale, 1; default 0.003.
    pub acc_scale: f64,
    /// Accelerometer misalignment, rad; default 0.003.
    pub acc_misalignment: f64,
    /// Random walk of the gyroscope's bias, rad/s/√s; default 1e-5.
    pub gyro_bias_walk: f64,
    /// Random walk of the accelerometer's bias, m/s²/√s; default 1e-4.
    pub acc_bias_walk: f64,
    /// Gyroscope noise beyond that seen at rest, rad/s/√Hz; default 0. For motion that shakes the sensor.
    pub gyro_motion_density: f64,
    /// Accelerometer noise beyond that seen at rest, m/s²/√Hz; default 0.
    pub acc_motion_density: f64,
    /// Error of a step as a share of the change of the reading over it, 1; default 0. For impacts, which sampling
    /// and the sensor's own filter do not follow.
    pub jerk_share: f64,
    /// How far the mean acceleration of 0.05 s may be off at a rest, beyond the noise, m/s²; default 0. A person
    /// who stands sways.
    pub acc_sway_m_s2: f64,
    /// The same for the rate, rad/s; default 0.
    pub gyro_sway_rad_s: f64,
}

impl Default for SensorErrors {
    fn default() -> Self {
        SensorErrors {
            gyro_bias_rad_s: 0.05,
            acc_bias_m_s2: 0.05,
            gyro_scale: 0.003,
            gyro_misalignment: 0.003,
            acc_scale: 0.003,
            acc_misalignment: 0.003,
            gyro_bias_walk: 1e-5,
            acc_bias_walk: 1e-4,
            gyro_motion_density: 0.0,
            acc_motion_density: 0.0,
            jerk_share: 0.0,
            acc_sway_m_s2: 0.0,
            gyro_sway_rad_s: 0.0,
        }
    }
}

/// Settings of [`navigate`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NavigationSettings {
    /// Local gravity, m/s².
    pub gravity_m_s2: f64,
    /// What the sensor may be wrong by.
    pub errors: SensorErrors,
    /// Standard deviation of the velocity in a stance, m/s; default 0.02.
    pub stance_velocity_m_s: f64,
    /// Distance of the sensor from the point on which a foot rolls, m; default 0.1: a rate ω in a stance adds
    /// lever · |ω| to the velocity's standard deviation.
    pub stance_lever_m: f64,
    /// Standard deviation of the velocity at rest, m/s; default 0.00045.
    pub rest_velocity_m_s: f64,
    /// A rest at which the predicted velocity is further from zero than this squared Mahalanobis distance, and
    /// which is shorter than `doubtful_rest_s`, is taken for steady motion, not for a rest; default 30.
    pub doubtful_distance: f64,
    /// A rest of at least this length is always believed, s; default 2. So is one that ends the recording.
    pub doubtful_rest_s: f64,
    /// Where the last row is, world, m, and how well that is known, m.
    pub end: Option<(Vec3, f64)>,
    /// An end further from where the readings lead than this many standard deviations (its Mahalanobis distance) is
    /// refused, 1; default 10. `f64::INFINITY` insists.
    pub max_end_distance: f64,
    /// How the body may move where samples are missing.
    pub hole_motion: HoleMotion,
    /// Longest hole in the samples that is bridged, s; default 0.5, as for rests
    /// ([`crate::rest::RestSettings::max_gap_s`]): in half a second a hand or a foot has gone somewhere else.
    /// `f64::INFINITY` insists.
    pub max_hole_s: f64,
    /// The band that is stated is the navigator's own times this, 1; default 1.
    pub band_factor: f64,
}

impl Default for NavigationSettings {
    fn default() -> Self {
        NavigationSettings {
            gravity_m_s2: crate::STANDARD_GRAVITY_M_S2,
            errors: SensorErrors::default(),
            stance_velocity_m_s: 0.02,
            stance_lever_m: 0.1,
            rest_velocity_m_s: 0.00045,
            doubtful_distance: 30.0,
            doubtful_rest_s: 2.0,
            end: None,
            max_end_distance: 10.0,
            hole_motion: HoleMotion::default(),
            max_hole_s: 0.5,
            band_factor: 1.0,
        }
    }
}

/// Velocity and position of every row, with their errors. World frame: z up, yaw 0 and position 0 at the first
/// rest.
#[derive(Clone, Debug, Default)]
pub struct Track {
    /// Attitude, world from body.
    pub world_from_body: Vec<Quaternion>,
    /// Velocity, world, m/s.
    pub velocity_m_s: Vec<Vec3>,
    /// Position, world, m.
    pub position_m: Vec<Vec3>,
    /// Standard deviation of the position along each axis, m.
    pub sigma_position_m: Vec<Vec3>,
    /// What was known at each row.
    pub phases: Vec<Phase>,
    /// Longest time between two rests or stances (or from the last one to the end), s.
    pub longest_without_rest_s: f64,
    /// Gyroscope bias at the end, rad/s.
    pub gyro_bias_rad_s: Vec3,
    /// Accelerometer bias at the end, m/s².
    pub acc_bias_m_s2: Vec3,
    /// Holes in the samples over which it was bridged: the steps into rows not at rest.
    pub holes: Vec<Hole>,
    /// Samples that are no readings and were passed over.
    pub passed_over: usize,
    /// How the end that was given agrees with the readings.
    pub given_end: Option<GivenEnd>,
}

impl Track {
    /// The one number of the position's error: the root of the three variances' sum, m.
    pub fn sigma_total_m(&self, row: usize) -> f64 {
        self.sigma_position_m.get(row).map_or(f64::NAN, |s| vector::norm(*s))
    }
}

const REST_BLOCK_S: f64 = 0.05;
const STANCE_INTERVAL_S: f64 = 0.01;
const STORE_INTERVAL_S: f64 = 0.02;
/// A longer hole in a rest is two rests: what happened meanwhile is not known.
const REST_HOLE_S: f64 = 0.5;
/// Kept rows after which the smoother is run at the next rest or stance: bounds the memory to about 200 MB.
const CHUNK: usize = 60_000;
/// The same where the end is known, which is to reach back to the start: about 1 GB.
const CHUNK_WITH_END: usize = 300_000;

/// Navigates through N rows of corrected or raw readings; `phases` says what is known of each row and must hold
/// a rest. Rows before the first rest stay at the origin.
///
/// Refuses with [`Error::LengthMismatch`], [`Error::NotFinite`], [`Error::NoRest`], [`Error::HoleTooLong`],
/// [`Error::EndContradicted`], [`Error::NoConvergence`] (numbers that are no longer finite) and the errors of
/// [`Dt::check`].
pub fn navigate(
    acc_m_s2: &[Vec3],
    gyro_rad_s: &[Vec3],
    dt: Dt<'_>,
    phases: &[Phase],
    settings: &NavigationSettings,
) -> Result<Track> {
    let n = acc_m_s2.len();
    for other in [gyro_rad_s.len(), phases.len()] {
        if n != other {
            return Err(Error::LengthMismatch { first: n, second: other });
        }
    }
    dt.check(n)?;
    for row in 0..n {
        if !(vector::is_finite(acc_m_s2[row]) && vector::is_finite(gyro_rad_s[row])) {
            return Err(Error::NotFinite { row });
        }
    }
    if !(settings.gravity_m_s2 > 0.0 && settings.gravity_m_s2.is_finite()) {
        return Err(Error::NotPositive { name: "gravity", value: settings.gravity_m_s2 });
    }
    let Some(first) = phases.iter().position(|p| *p == Phase::Rest) else {
        return Err(Error::NoRest { needed_s: REST_BLOCK_S });
    };
    let mut phases = phases.to_vec();
    let mut holes = holes(dt, first + 1..n, settings.max_hole_s)?;
    for hole in &holes {
        if hole.length_s > REST_HOLE_S {
            phases[hole.row] = Phase::Moving;
        }
    }
    // each turn of the loop takes one rest away, or is the last
    loop {
        let mut run = Run::new(acc_m_s2, gyro_rad_s, dt, &phases, first, settings);
        for row in first..n {
            run.row(row);
            if run.contradicted.is_some() {
                break;
            }
        }
        if let Some(rest) = run.contradicted {
            phases = run.phases;
            phases.get_mut(rest).unwrap_or(&mut []).fill(Phase::Moving);
            continue;
        }
        run.finish()?;
        holes.retain(|h| run.track.phases[h.row - 1..=h.row] != [Phase::Rest; 2]);
        run.track.holes = holes;
        return Ok(run.track);
    }
}

/// The longest stretch of [`Phase::Moving`], s, counted from the first rest.
pub fn longest_without_rest_s(phases: &[Phase], dt: Dt<'_>) -> f64 {
    let (mut longest, mut length) = (0.0_f64, 0.0);
    let first = phases.iter().position(|p| *p != Phase::Moving).unwrap_or(0);
    for (row, phase) in phases.iter().enumerate().skip(first) {
        length = if *phase == Phase::Moving { length + dt.at(row) } else { 0.0 };
        longest = longest.max(length);
    }
    longest
}

/// Events in the order they happened, for the way back.
enum Event {
    Step(Step),
    Update(alloc::boxed::Box<Update>),
    Store { row: usize, rows: alloc::boxed::Box<[State; 9]> },
}

struct Run<'a> {
    acc: &'a [Vec3],
    gyro: &'a [Vec3],
    dt: Dt<'a>,
    phases: Vec<Phase>,
    updates_at: Vec<bool>,
    settings: &'a NavigationSettings,
    noise: ProcessNoise,
    /// Longer steps are holes, s.
    hole_from_s: f64,
    /// Variance that holes left on the heading, rad², and the stances or rests until it is put back.
    heading_doubt: (f64, u8),
    /// The row after the first hole that was bridged.
    bridged: Option<usize>,
    rest_gyro_variance: f64,
    rest_acc_variance: f64,
    p: Covariance,
    q: Quaternion,
    velocity: Vec3,
    position: Vec3,
    gyro_bias: Vec3,
    acc_bias: Vec3,
    gyro_matrix: [[f64; 3]; 3],
    acc_matrix: [[f64; 3]; 3],
    block: Block,
    since_store_s: f64,
    events: Vec<Event>,
    stores: usize,
    /// First row of the first rest.
    first: usize,
    /// The last rest, where it was too short to be believed against a later one.
    short_rest: Option<Range<usize>>,
    /// A short rest that a later, sure one contradicts.
    contradicted: Option<Range<usize>>,
    /// First row not yet smoothed.
    chunk_start: usize,
    track: Track,
}

#[derive(Default)]
struct Block {
    acc: Vec3,
    gyro: Vec3,
    rows: usize,
    length_s: f64,
}

impl<'a> Run<'a> {
    fn new(
        acc: &'a [Vec3],
        gyro: &'a [Vec3],
        dt: Dt<'a>,
        phases: &'a [Phase],
        first: usize,
        settings: &'a NavigationSettings,
    ) -> Self {
        let n = acc.len();
        let end = (first..n).find(|k| phases[*k] != Phase::Rest).unwrap_or(n);
        let mean = |s: &[Vec3]| {
            let sum = s.iter().fold([0.0; 3], |a, b| vector::add(a, *b));
            vector::scale(sum, 1.0 / s.len().max(1) as f64)
        };
        // noise from the differences of neighbours: slow tilts and drifts do not count
        let variance = |s: &[Vec3]| {
            let sum: f64 = s
                .windows(2)
                .map(|w| {
                    let d = vector::sub(w[1], w[0]);
                    vector::dot(d, d)
                })
                .sum();
            sum / (6.0 * (s.len().max(2) - 1) as f64)
        };
        let (rest_acc, rest_gyro) = (&acc[first..end], &gyro[first..end]);
        let step = (first..end).map(|k| dt.at(k)).sum::<f64>() / (end - first) as f64;
        let e = &settings.errors;
        // a floor, for recordings whose rest shows the same count again and again
        let (acc_variance, gyro_variance) = (variance(rest_acc).max(1e-8), variance(rest_gyro).max(1e-12));
        let noise = ProcessNoise {
            acc_density: math::sqrt(acc_variance * step + e.acc_motion_density * e.acc_motion_density),
            gyro_density: math::sqrt(gyro_variance * step + e.gyro_motion_density * e.gyro_motion_density),
            acc_bias_walk: e.acc_bias_walk,
            gyro_bias_walk: e.gyro_bias_walk,
        };
        let mut p = [[0.0; STATES]; STATES];
        let mut set = |at: usize, count: usize, sigma: f64| {
            for i in at..at + count {
                p[i][i] = sigma * sigma;
            }
        };
        set(POSITION, 3, 1e-9);
        set(VELOCITY, 3, settings.rest_velocity_m_s);
        // the tilt is measured by the rest itself; the heading defines the frame
        set(ATTITUDE, 2, 0.1);
        set(ATTITUDE + 2, 1, 1e-9);
        set(GYRO_BIAS, 3, e.gyro_bias_rad_s);
        set(ACC_BIAS, 3, e.acc_bias_m_s2);
        for i in 0..3 {
            for j in 0..3 {
                let at = 3 * i + j;
                set(GYRO_MATRIX + at, 1, if i == j { e.gyro_scale } else { e.gyro_misalignment });
                set(ACC_MATRIX + at, 1, if i == j { e.acc_scale } else { e.acc_misalignment });
            }
        }
        let unit = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let q = levelled(mean(rest_acc));
        let track = Track {
            world_from_body: alloc::vec![q; n],
            velocity_m_s: alloc::vec![[0.0; 3]; n],
            position_m: alloc::vec![[0.0; 3]; n],
            sigma_position_m: alloc::vec![[0.0; 3]; n],
            phases: Vec::new(),
            longest_without_rest_s: 0.0,
            gyro_bias_rad_s: [0.0; 3],
            acc_bias_m_s2: [0.0; 3],
            holes: Vec::new(),
            passed_over: 0,
            given_end: None,
        };
        Run {
            acc,
            gyro,
            dt,
            phases: phases.to_vec(),
            updates_at: update_rows(phases, dt, first),
            settings,
            noise,
            hole_from_s: hole_from_s(dt),
            heading_doubt: (0.0, 0),
            bridged: None,
            rest_gyro_variance: gyro_variance,
            rest_acc_variance: acc_variance,
            p,
            q,
            velocity: [0.0; 3],
            position: [0.0; 3],
            gyro_bias: mean(rest_gyro),
            acc_bias: [0.0; 3],
            gyro_matrix: unit,
            acc_matrix: unit,
            block: Block::default(),
            since_store_s: 0.0,
            events: Vec::new(),
            stores: 0,
            first,
            short_rest: None,
            contradicted: None,
            chunk_start: first,
            track,
        }
    }

    fn corrected_rate(&self, row: usize) -> Vec3 {
        apply(&self.gyro_matrix, vector::sub(self.gyro[row], self.gyro_bias))
    }

    fn corrected_acc(&self, row: usize) -> Vec3 {
        apply(&self.acc_matrix, vector::sub(self.acc[row], self.acc_bias))
    }

    fn row(&mut self, row: usize) {
        let mut resting = self.phases[row] == Phase::Rest;
        let came_from_rest = row > self.first && self.phases[row - 1] == Phase::Rest;
        if row > self.first && self.phases[row] == Phase::Moving && self.phases[row - 1] != Phase::Moving {
            self.leave_stance();
        }
        if row > self.first && !(resting && came_from_rest) {
            self.step(row);
        }
        if resting && !came_from_rest && row > self.first {
            let end = (row..self.phases.len()).find(|k| self.phases[*k] != Phase::Rest);
            let rest = row..end.unwrap_or(self.phases.len());
            let length: f64 = rest.clone().map(|k| self.dt.at(k)).sum();
            let sure = end.is_none() || length >= self.settings.doubtful_rest_s;
            let doubtful = self.velocity_distance() > self.settings.doubtful_distance;
            if doubtful && !sure {
                resting = false;
                self.phases[rest.clone()].fill(Phase::Moving);
                self.updates_at[rest].fill(false);
            } else {
                if doubtful && self.short_rest.is_some() {
                    self.contradicted = self.short_rest.take();
                    return;
                }
                self.short_rest = (!sure).then_some(rest);
            }
        }
        if resting {
            if !came_from_rest {
                self.zero_velocity(self.settings.rest_velocity_m_s);
            }
            self.velocity = [0.0; 3];
            self.block.acc = vector::add(self.block.acc, self.acc[row]);
            self.block.gyro = vector::add(self.block.gyro, self.gyro[row]);
            self.block.rows += 1;
            self.block.length_s += self.dt.at(row);
        }
        if self.updates_at[row] {
            match self.phases[row] {
                Phase::Rest => self.rest_block(),
                Phase::Stance => {
                    let roll = self.settings.stance_lever_m * vector::norm(self.corrected_rate(row));
                    self.zero_velocity(math::hypot(self.settings.stance_velocity_m_s, roll));
                }
                Phase::Moving => {}
            }
        }
        let last = row + 1 == self.acc.len();
        if last && let Some((end, sigma)) = self.settings.end {
            self.track.given_end = Some(self.compare(end, sigma));
            for i in 0..3 {
                let mut h = [0.0; STATES];
                h[POSITION + i] = 1.0;
                self.measure(&h, end[i] - self.position[i], sigma * sigma);
            }
        }
        self.track.world_from_body[row] = self.q;
        self.track.velocity_m_s[row] = self.velocity;
        self.track.position_m[row] = self.position;
        self.since_store_s += self.dt.at(row);
        // both sides of every measurement, the chunk's first row, and now and then between
        let next_is_measured = self.updates_at.get(row + 1).is_none_or(|u| *u);
        let phase_changes = self.phases.get(row + 1).is_some_and(|p| (*p == Phase::Rest) != resting);
        let enters_rest = resting && !came_from_rest;
        let hole_follows = row + 1 < self.acc.len() && self.dt.at(row + 1) > self.hole_from_s;
        if self.updates_at[row]
            || next_is_measured
            || phase_changes
            || enters_rest
            || hole_follows
            || row == self.chunk_start
            || self.since_store_s >= STORE_INTERVAL_S
        {
            self.store(row);
        }
        let chunk = if self.settings.end.is_some() { CHUNK_WITH_END } else { CHUNK };
        if self.stores > chunk && self.phases[row] != Phase::Moving {
            self.smooth_back(row);
        }
    }

    /// How far the velocity is from zero: its squared Mahalanobis distance.
    fn velocity_distance(&self) -> f64 {
        // a rest may begin a little before the last sway is over: 2 mm/s
        let mut s = [[0.0; 3]; 3];
        for i in 0..3 {
            for j in 0..3 {
                s[i][j] = self.p[VELOCITY + i][VELOCITY + j];
            }
            s[i][i] += 4e-6;
        }
        let Ok(inverse) = crate::matrix::inverse(&s) else { return 0.0 };
        vector::dot(self.velocity, crate::matrix::times_vector(&inverse, &self.velocity))
    }

    /// From row − 1 to row.
    fn step(&mut self, row: usize) {
        let dt_s = self.dt.at(row);
        if dt_s > self.hole_from_s {
            return self.bridge(row);
        }
        let before = row.saturating_sub(1);
        let rate = vector::scale(vector::add(self.corrected_rate(before), self.corrected_rate(row)), 0.5);
        let (acc_before, acc_after) = (self.corrected_acc(before), self.corrected_acc(row));
        let world_before = self.q.rotate(acc_before);
        let middle = self.q.product(Quaternion::from_rotation_vector(vector::scale(rate, 0.5 * dt_s)));
        self.q = self.q.product(Quaternion::from_rotation_vector(vector::scale(rate, dt_s))).normalized();
        let mut acc_world = vector::scale(vector::add(world_before, self.q.rotate(acc_after)), 0.5);
        acc_world[2] -= self.settings.gravity_m_s2;
        let velocity = vector::add(self.velocity, vector::scale(acc_world, dt_s));
        let mean = vector::scale(vector::add(self.velocity, velocity), 0.5);
        self.position = vector::add(self.position, vector::scale(mean, dt_s));
        self.velocity = velocity;
        let step = Step {
            rotation: middle.to_matrix(),
            acc_body: vector::scale(vector::add(acc_before, acc_after), 0.5),
            rate_body: rate,
            dt_s,
        };
        let mut noise = self.noise;
        let share = self.settings.errors.jerk_share;
        if share > 0.0 {
            let change = |a: Vec3, b: Vec3| {
                let d = vector::sub(a, b);
                share * share * vector::dot(d, d) * dt_s
            };
            let (acc, gyro) = (change(acc_after, acc_before), change(self.gyro[row], self.gyro[before]));
            noise.acc_density = math::sqrt(noise.acc_density * noise.acc_density + acc);
            noise.gyro_density = math::sqrt(noise.gyro_density * noise.gyro_density + gyro);
        }
        propagate(&mut self.p, &step, &noise);
        self.events.push(Event::Step(step));
    }

    fn measure(&mut self, h: &State, innovation: f64, variance: f64) {
        let u = update(&mut self.p, h, innovation, variance);
        let x = |i: usize| u.gain[i] * innovation;
        let triple = |at: usize| [x(at), x(at + 1), x(at + 2)];
        self.position = vector::add(self.position, triple(POSITION));
        self.velocity = vector::add(self.velocity, triple(VELOCITY));
        self.q = Quaternion::from_rotation_vector(triple(ATTITUDE)).product(self.q).normalized();
        self.gyro_bias = vector::add(self.gyro_bias, triple(GYRO_BIAS));
        self.acc_bias = vector::add(self.acc_bias, triple(ACC_BIAS));
        for i in 0..3 {
            for j in 0..3 {
                self.gyro_matrix[i][j] += x(GYRO_MATRIX + 3 * i + j);
                self.acc_matrix[i][j] += x(ACC_MATRIX + 3 * i + j);
            }
        }
        self.events.push(Event::Update(alloc::boxed::Box::new(u)));
    }

    fn zero_velocity(&mut self, sigma: f64) {
        for i in 0..3 {
            let mut h = [0.0; STATES];
            h[VELOCITY + i] = 1.0;
            self.measure(&h, -self.velocity[i], sigma * sigma);
        }
    }

    /// The mean rate of a block at rest is the bias; its mean acceleration is gravity in the body's axes.
    fn rest_block(&mut self) {
        let block = core::mem::take(&mut self.block);
        if block.rows == 0 {
            return;
        }
        let n = block.rows as f64;
        let walk = |density: f64| density * density * block.length_s;
        for i in 0..3 {
            self.p[GYRO_BIAS + i][GYRO_BIAS + i] += walk(self.noise.gyro_bias_walk);
            self.p[ACC_BIAS + i][ACC_BIAS + i] += walk(self.noise.acc_bias_walk);
        }
        let SensorErrors { acc_sway_m_s2: acc_sway, gyro_sway_rad_s: gyro_sway, .. } = self.settings.errors;
        let gyro = vector::scale(block.gyro, 1.0 / n);
        let acc = vector::scale(block.acc, 1.0 / n);
        for i in 0..3 {
            let mut h = [0.0; STATES];
            h[GYRO_BIAS + i] = 1.0;
            self.measure(
                &h,
                gyro[i] - self.gyro_bias[i],
                self.rest_gyro_variance / n + gyro_sway * gyro_sway,
            );
        }
        for i in 0..3 {
            let r = self.q.to_matrix();
            let g = self.settings.gravity_m_s2;
            let corrected = apply(&self.acc_matrix, vector::sub(acc, self.acc_bias));
            // a_measured − Rᵀ g = Rᵀ (g × δθ) + δb − δM a
            let mut h = [0.0; STATES];
            h[ATTITUDE] = r[1][i] * g;
            h[ATTITUDE + 1] = -r[0][i] * g;
            h[ACC_BIAS + i] = 1.0;
            for j in 0..3 {
                h[ACC_MATRIX + 3 * i + j] = -corrected[j];
            }
            self.measure(&h, corrected[i] - r[2][i] * g, self.rest_acc_variance / n + acc_sway * acc_sway);
        }
    }

    fn store(&mut self, row: usize) {
        let mut rows = alloc::boxed::Box::new([[0.0; STATES]; 9]);
        rows.copy_from_slice(&self.p[..9]);
        self.events.push(Event::Store { row, rows });
        self.stores += 1;
        self.since_store_s = 0.0;
    }

    /// Smooths the rows since the last call, `last` included.
    fn smooth_back(&mut self, last: usize) {
        let mut adjoint = Adjoint::default();
        let mut right: Option<(usize, [f64; 9], Vec3)> = None;
        let events = core::mem::take(&mut self.events);
        for event in events.iter().rev() {
            match event {
                Event::Step(step) => adjoint.back_over_step(step),
                Event::Update(u) => adjoint.back_over_update(u),
                Event::Store { row, rows } => {
                    let mut correction = [0.0; 9];
                    let mut sigma = [0.0; 3];
                    for i in 0..9 {
                        for j in 0..STATES {
                            correction[i] -= rows[i][j] * adjoint.vector[j];
                        }
                    }
                    for i in 0..3 {
                        let mut variance = rows[POSITION + i][POSITION + i];
                        for j in 0..STATES {
                            let mut sum = 0.0;
                            for k in 0..STATES {
                                sum += adjoint.matrix[j][k] * rows[POSITION + i][k];
                            }
                            variance -= rows[POSITION + i][j] * sum;
                        }
                        sigma[i] = math::sqrt(variance.max(0.0));
                    }
                    let until = right.map_or(last + 1, |r| r.0);
                    for k in *row..until {
                        let (mut c, mut s) = (correction, sigma);
                        if let Some((end, next, next_sigma)) = right {
                            let f = (k - row) as f64 / (end - row) as f64;
                            for i in 0..9 {
                                c[i] += (next[i] - correction[i]) * f;
                            }
                            for i in 0..3 {
                                s[i] += (next_sigma[i] - sigma[i]) * f;
                            }
                        }
                        self.correct(k, &c, s);
                    }
                    right = Some((*row, correction, sigma));
                }
            }
        }
        self.stores = 0;
        self.chunk_start = last + 1;
    }

    fn correct(&mut self, row: usize, c: &[f64; 9], sigma: Vec3) {
        let resting = self.phases[row] == Phase::Rest;
        let t = &mut self.track;
        t.position_m[row] = vector::add(t.position_m[row], [c[0], c[1], c[2]]);
        if !resting {
            t.velocity_m_s[row] = vector::add(t.velocity_m_s[row], [c[3], c[4], c[5]]);
        }
        let turn = Quaternion::from_rotation_vector([c[6], c[7], c[8]]);
        t.world_from_body[row] = turn.product(t.world_from_body[row]).normalized();
        t.sigma_position_m[row] = sigma;
    }

    fn finish(&mut self) -> Result<()> {
        if let Some(end) = self.track.given_end
            && end.distance > self.settings.max_end_distance
        {
            let GivenEnd { off_m, sigma_m, distance } = end;
            return Err(Error::EndContradicted { distance, off_m, sigma_m });
        }
        let last = self.acc.len() - 1;
        if self.chunk_start <= last {
            self.smooth_back(last);
        }
        self.track.longest_without_rest_s = longest_without_rest_s(&self.phases, self.dt);
        self.track.phases = core::mem::take(&mut self.phases);
        self.track.gyro_bias_rad_s = self.gyro_bias;
        self.track.acc_bias_m_s2 = self.acc_bias;
        for row in 0..=last {
            let sigma = self.track.sigma_position_m[row];
            self.track.sigma_position_m[row] = vector::scale(sigma, self.band_factor(row));
        }
        let t = &self.track;
        let mut numbers = t.position_m.iter().chain(&t.velocity_m_s).chain(&t.sigma_position_m);
        if numbers.all(|v| vector::is_finite(*v)) { Ok(()) } else { Err(Error::NoConvergence) }
    }
}

fn apply(m: &[[f64; 3]; 3], v: Vec3) -> Vec3 {
    [vector::dot(m[0], v), vector::dot(m[1], v), vector::dot(m[2], v)]
}

/// Attitude with yaw 0 from the acceleration at rest.
fn levelled(acc: Vec3) -> Quaternion {
    let roll = math::atan2(acc[1], acc[2]);
    let pitch = math::atan2(-acc[0], math::hypot(acc[1], acc[2]));
    Quaternion::from_ypr(crate::Ypr { yaw_rad: 0.0, pitch_rad: pitch, roll_rad: roll })
}

/// Rows at which a block of rest ends or a stance is measured.
fn update_rows(phases: &[Phase], dt: Dt<'_>, first: usize) -> Vec<bool> {
    let mut at = alloc::vec![false; phases.len()];
    let mut length_s = 0.0;
    for row in first..phases.len() {
        length_s += dt.at(row);
        let ends = phases.get(row + 1) != Some(&phases[row]);
        let begins = row == first || phases[row - 1] != phases[row];
        let due = match phases[row] {
            Phase::Rest => ends || length_s >= REST_BLOCK_S,
            Phase::Stance => begins || ends || length_s >= STANCE_INTERVAL_S,
            Phase::Moving => false,
        };
        if due {
            at[row] = true;
            length_s = 0.0;
        }
    }
    at
}
