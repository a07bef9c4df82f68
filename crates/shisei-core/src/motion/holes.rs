//! What is missing from a recording: samples that were lost, and samples that no sensor gives.
//!
//! A step longer than 1.5 usual ones (the median) and than 20 ms is a hole. In it acceleration (without gravity) and rate are taken
//! for Ornstein-Uhlenbeck processes of mean zero, of which the two readings at the hole's ends are known: they go
//! back to zero within the correlation time τ from either end. With T the hole's length, their integral over it is
//! `(x₀ + x₁)/2 · T_k` with `T_k = 2 τ tanh(T / 2τ)`, and its variance `2 σ² τ (T − T_k)`: a short hole
//! (T ≪ τ) is a straight line between its readings with an error that grows as T³, of a long one only the ends are
//! known. (The integral of the process between two known values; D. T. Gillespie, Phys. Rev. E 54, 2084, 1996,
//! gives its moments.)

use alloc::vec::Vec;
use core::ops::Range;

use crate::error::{Error, Result};
use crate::filter::Dt;
use crate::math;
use crate::motion::navigation::{NavigationSettings, Phase, Track};
use crate::quaternion::Quaternion;
use crate::vector::{self, Vec3};
use crate::{LARGEST_ACC_M_S2, LARGEST_RATE_RAD_S};

/// Steps longer than this many median steps are holes.
const HOLE_STEPS: f64 = 1.5;
/// Steps no longer than this are none, s: it is the usual step of slow sensors, and stamps may jitter by as much.
const SHORTEST_HOLE_S: f64 = 0.02;
/// A hole is bridged in pieces of about this length, s.
const PIECE_S: f64 = 0.01;

/// A hole in the samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hole {
    /// The row after it.
    pub row: usize,
    /// Time from the sample before it to the one after it, s.
    pub length_s: f64,
}

/// How a body may move in a hole. The defaults are those of a hand: fast everyday movements have accelerations of some
/// m/s² and rates of some rad/s, and change within a tenth of a second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HoleMotion {
    /// Standard deviation of the acceleration along an axis, m/s²; default 4. Larger: the band grows more.
    pub acc_m_s2: f64,
    /// The same of the rate, rad/s; default 2.
    pub rate_rad_s: f64,
    /// Time over which both forget what they were, s; default 0.1. Larger: readings at the ends tell more of short
    /// holes, and long ones leave more open.
    pub correlation_s: f64,
    /// The band from the first hole on is widened by this, 1; default 1.
    pub band_factor: f64,
}

impl Default for HoleMotion {
    fn default() -> Self {
        HoleMotion { acc_m_s2: 4.0, rate_rad_s: 2.0, correlation_s: 0.1, band_factor: 1.0 }
    }
}

/// A hole as it is bridged.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bridge {
    /// The share of it for which the mean of the readings at its ends stands.
    pub share: f64,
    /// Density of what is not known of the acceleration, m/s²/√Hz.
    pub acc_density: f64,
    /// The same of the rate, rad/s/√Hz.
    pub gyro_density: f64,
    /// Into how many equal pieces it is cut.
    pub pieces: usize,
}

impl HoleMotion {
    /// Over a hole of `length_s` with these accelerations (without gravity) and rates at its ends. Where they are
    /// larger than was assumed, more is assumed.
    pub(super) fn bridge(&self, length_s: f64, linear: [Vec3; 2], rate: [Vec3; 2]) -> Bridge {
        let share = self.known_share(length_s);
        let square = |v: [Vec3; 2]| (vector::dot(v[0], v[0]) + vector::dot(v[1], v[1])) / 6.0;
        let unknown = 2.0 * self.correlation_s * (1.0 - share);
        let density = |usual: f64, ends: f64| math::sqrt(unknown * (usual * usual).max(ends));
        Bridge {
            share,
            acc_density: density(self.acc_m_s2, square(linear)),
            gyro_density: density(self.rate_rad_s, square(rate)),
            pieces: (length_s / PIECE_S).clamp(8.0, 200.0) as usize,
        }
    }

    /// T_k / T.
    fn known_share(&self, length_s: f64) -> f64 {
        let faded = math::exp(-length_s / self.correlation_s);
        2.0 * self.correlation_s * (1.0 - faded) / ((1.0 + faded) * length_s)
    }
}

/// The step from which on one is a hole, s: infinite for equal steps.
pub(super) fn hole_from_s(dt: Dt<'_>) -> f64 {
    let Dt::PerSample(steps) = dt else { return f64::INFINITY };
    let mut steps = steps.to_vec();
    if steps.is_empty() {
        return f64::INFINITY;
    }
    let middle = steps.len() / 2;
    (HOLE_STEPS * *steps.select_nth_unstable_by(middle, f64::total_cmp).1).max(SHORTEST_HOLE_S)
}

/// The time that rows stand for, s: their steps without the holes.
pub(super) fn sampled_s(dt: Dt<'_>, rows: Range<usize>) -> f64 {
    let limit = hole_from_s(dt);
    rows.map(|k| dt.at(k)).filter(|step| *step <= limit).sum()
}

/// The holes after row `first`. Refuses ([`Error::HoleTooLong`]) one that is longer than `max_s`.
pub(super) fn holes(dt: Dt<'_>, rows: Range<usize>, max_s: f64) -> Result<Vec<Hole>> {
    let limit = hole_from_s(dt);
    let mut found = Vec::new();
    let mut at_s: f64 = (1..rows.start).map(|k| dt.at(k)).sum();
    for row in rows {
        let length_s = dt.at(row);
        if length_s > limit {
            if length_s > max_s {
                return Err(Error::HoleTooLong { at_s, seconds: length_s, limit_s: max_s });
            }
            found.push(Hole { row, length_s });
        }
        at_s += length_s;
    }
    Ok(found)
}

/// Whether a sample is a reading: what a sensor can give ([`LARGEST_ACC_M_S2`], [`LARGEST_RATE_RAD_S`]), and not an
/// accelerometer that is off. The estimator passes over the same.
fn is_reading(acc_m_s2: Vec3, gyro_rad_s: Vec3) -> bool {
    let within = |v: Vec3, limit: f64| v.iter().all(|x| x.abs() <= limit);
    within(acc_m_s2, LARGEST_ACC_M_S2) && within(gyro_rad_s, LARGEST_RATE_RAD_S) && acc_m_s2 != [0.0; 3]
}

/// The samples of a recording that are readings, where some are not.
#[derive(Debug)]
pub(super) struct Readings {
    pub acc: Vec<Vec3>,
    pub gyro: Vec<Vec3>,
    /// Steps from one reading to the next, s.
    pub dt_s: Vec<f64>,
    rows: Vec<usize>,
    all_dt_s: Vec<f64>,
}

impl Readings {
    /// None where all samples are readings, or the series are not in order, which whoever takes them refuses.
    pub fn of(acc: &[Vec3], gyro: &[Vec3], dt: Dt<'_>) -> Option<Self> {
        let ordered = acc.len() == gyro.len()
            && dt.check(acc.len()).is_ok()
            && acc.iter().chain(gyro).all(|v| vector::is_finite(*v));
        if !ordered || acc.iter().zip(gyro).all(|(a, g)| is_reading(*a, *g)) {
            return None;
        }
        let all_dt_s: Vec<f64> = (0..acc.len()).map(|k| dt.at(k)).collect();
        let mut kept =
            Readings { acc: Vec::new(), gyro: Vec::new(), dt_s: Vec::new(), rows: Vec::new(), all_dt_s };
        let mut passed_s = 0.0;
        for row in 0..acc.len() {
            passed_s += kept.all_dt_s[row];
            if is_reading(acc[row], gyro[row]) {
                let first = kept.rows.is_empty();
                kept.dt_s.push(if first { kept.all_dt_s[row] } else { passed_s });
                kept.acc.push(acc[row]);
                kept.gyro.push(gyro[row]);
                kept.rows.push(row);
                passed_s = 0.0;
            }
        }
        Some(kept)
    }

    /// The error of the readings, as one of the recording.
    pub fn refusal(&self, error: Error) -> Error {
        let Error::HoleTooLong { at_s, seconds, limit_s } = error else { return error };
        let first = self.rows.first().copied().unwrap_or(0);
        let before_s: f64 = (1..=first).map(|k| self.all_dt_s[k]).sum();
        Error::HoleTooLong { at_s: at_s + before_s, seconds, limit_s }
    }

    /// The track of the readings as one of all samples: what was passed over lies between its neighbours, its band
    /// widened by the acceleration it may have had; after the last reading the body goes on. Refuses
    /// ([`Error::HoleTooLong`]) where it would do so for longer than is bridged.
    pub fn spread(&self, track: Track, settings: &NavigationSettings) -> Result<Track> {
        let n = self.all_dt_s.len();
        let last = *self.rows.last().ok_or(Error::Empty)?;
        let left_s: f64 = (last + 1..n).map(|k| self.all_dt_s[k]).sum();
        if left_s > settings.max_hole_s {
            let at_s = (1..=last).map(|k| self.all_dt_s[k]).sum();
            return Err(Error::HoleTooLong { at_s, seconds: left_s, limit_s: settings.max_hole_s });
        }
        let mut all = Track {
            world_from_body: Vec::with_capacity(n),
            velocity_m_s: Vec::with_capacity(n),
            position_m: Vec::with_capacity(n),
            sigma_position_m: Vec::with_capacity(n),
            phases: Vec::with_capacity(n),
            holes: track.holes.iter().map(|h| Hole { row: self.rows[h.row], ..*h }).collect(),
            passed_over: n - self.rows.len(),
            ..track
        };
        let acc = settings.hole_motion.acc_m_s2 * settings.band_factor;
        // the reading before a row, and the time since it
        let (mut before, mut since_s) = (0, 0.0);
        for row in 0..n {
            since_s += self.all_dt_s[row];
            let next = self.rows.partition_point(|r| *r < row);
            if self.rows.get(next) == Some(&row) || row < self.rows[0] {
                (before, since_s) = (next, 0.0);
            }
            let after = if since_s == 0.0 { before } else { next.min(self.rows.len() - 1) };
            let (f, unknown_m) = if after > before {
                let length_s = self.dt_s[after];
                (since_s / length_s, 0.5 * acc * since_s * (length_s - since_s))
            } else {
                (0.0, 0.5 * acc * since_s * since_s)
            };
            let between = |series: &[Vec3]| {
                let (a, b) = (series[before], series[after]);
                vector::add(a, vector::scale(vector::sub(b, a), f))
            };
            let (velocity, mut position) = (between(&track.velocity_m_s), between(&track.position_m));
            if after == before {
                position = vector::add(position, vector::scale(velocity, since_s));
            }
            let q = (track.world_from_body[before], track.world_from_body[after]);
            let turn = q.0.conjugate().product(q.1).to_rotation_vector();
            let on_the_way =
                q.0.product(Quaternion::from_rotation_vector(vector::scale(turn, f))).normalized();
            all.world_from_body.push(if f == 0.0 { q.0 } else { on_the_way });
            all.velocity_m_s.push(velocity);
            all.position_m.push(position);
            all.sigma_position_m
                .push(between(&track.sigma_position_m).map(|sigma| math::hypot(sigma, unknown_m)));
            let same = track.phases[before] == track.phases[after];
            all.phases.push(if same { track.phases[before] } else { Phase::Moving });
        }
        Ok(all)
    }
}
