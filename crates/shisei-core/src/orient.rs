//! A whole recording to orientation: rest, bias, start, filter, and what the angles are relative to.
//!
//! The first rest gives the gyroscope bias (mean rate) and the start (mean acceleration, yaw 0). From there the
//! filter runs forward to the end, and backward in time to the first row, so that every row has an attitude and
//! the rest is the reference wherever it lies. Across a gap the rate is unknown: the filter starts anew there,
//! levelled by the first half second of acceleration, with the yaw it had.
//!
//! The estimator's online form knows of a sample only what came before it, also here: it is given the rates as they
//! are, its attitudes are those of a live run to the bit, and the rest, found or given, is only what angles and the
//! forward axis are relative to (at the rest's last row, where it has learnt the bias).

mod estimated;
mod stretches;

use alloc::boxed::Box;
use alloc::vec::Vec;
use core::ops::Range;

use crate::error::{Error, Result};
use crate::estimator::{Calibration, InTurn, Pair};
use crate::euler;
use crate::filter::{
    self, AdaptiveGain, Complementary, Dt, Filter, GyroIntegrator, GyroRk4, Mahony, MahonyAdaptive,
};
use crate::quaternion::Quaternion;
use crate::rest::{self, RestSettings};
use crate::vector::{self, Vec3};
use crate::{Ypr, heading, initial};
use stretches::{Series, Stretches};

/// A step longer than this is a gap, s.
pub const GAP_S: f64 = 0.5;

/// How much acceleration levels the start where there is no rest, and after a gap, s.
const LEVEL_S: f64 = 0.5;

/// The filter and its settings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// The estimator's smoother, [`crate::estimator::smooth`]: every attitude from the whole recording.
    Estimate,
    /// The estimator as it runs live, [`crate::estimator::Estimator`]: every attitude from the samples before it.
    EstimateOnline,
    /// The gyroscope alone, exact steps.
    Gyro,
    /// The gyroscope alone, Runge–Kutta steps.
    GyroRk4,
    /// [`Mahony`].
    Mahony {
        /// Proportional gain, 1/s.
        kp: f64,
        /// Integral gain, 1/s².
        ki: f64,
    },
    /// [`MahonyAdaptive`].
    MahonyAdaptive {
        /// Proportional gain as a function of |a|.
        gain: AdaptiveGain,
        /// Integral gain, 1/s².
        ki: f64,
    },
    /// [`Complementary`].
    Complementary {
        /// Share of the gyroscope, 0 … 1.
        alpha: f64,
    },
}

/// Where the bias and the start come from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RestChoice {
    /// The first rest of at least 1 s. Where there is none the estimator goes without; the classic filters refuse.
    /// To [`Method::EstimateOnline`] a rest, found or given, is only what angles are relative to.
    Auto,
    /// Given by its rows; [`rows_between`] finds them by time.
    Rows {
        /// The first row.
        start: usize,
        /// The row after the last.
        end: usize,
    },
    /// No rest: no bias is removed and the first half second of acceleration gives the start.
    None,
}

/// What yaw, pitch and roll are relative to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Relative {
    /// `q q0*`: the change since the start in world axes.
    #[default]
    World,
    /// `q0* q`: the change since the start in the sensor's axes at the start.
    Body,
    /// `q` itself.
    None,
}

/// All that [`orient`] can be told.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// The filter; default [`Method::Estimate`].
    pub method: Method,
    /// The rest; default [`RestChoice::Auto`].
    pub rest: RestChoice,
    /// What angles are relative to; default [`Relative::World`].
    pub relative: Relative,
    /// Sensor axis that, laid flat at the start, points along world x; default none (yaw 0 at the start).
    pub forward_axis_body: Option<Vec3>,
    /// Gravity where the recording was made, m/s²; default 9.80665.
    pub gravity_m_s2: f64,
    /// What is known of the sensor, for the estimator only: it corrects the readings itself. Default none.
    pub sensor: Option<Calibration>,
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            method: Method::Estimate,
            rest: RestChoice::Auto,
            relative: Relative::World,
            forward_axis_body: None,
            gravity_m_s2: crate::STANDARD_GRAVITY_M_S2,
            sensor: None,
        }
    }
}

/// What [`orient`] found.
#[derive(Clone, Debug, PartialEq)]
pub struct Orientation {
    /// Attitude after each sample.
    pub world_from_body: Vec<Quaternion>,
    /// Attitude at the start: at the rest, or at the first sample where there is none.
    pub start: Quaternion,
    /// The samples of the rest.
    pub rest: Option<Range<usize>>,
    /// The bias that was removed beforehand, rad/s in body axes; none for [`Method::EstimateOnline`].
    pub gyro_bias_rad_s: Vec3,
    /// What angles are relative to.
    pub relative: Relative,
    /// How sure the estimator is; none for the classic filters.
    pub certainty: Option<Certainty>,
    /// What the estimator learnt of the sensor; none for the classic filters.
    pub learnt: Option<Calibration>,
}

/// How sure the estimator is of each attitude.
#[derive(Clone, Debug, PartialEq)]
pub struct Certainty {
    /// Standard deviation of the tilt, rad.
    pub sigma_tilt_rad: Vec<f64>,
    /// Standard deviation of the heading since the start, rad.
    pub sigma_heading_rad: Vec<f64>,
    /// Whether the sensor is at rest.
    pub rest: Vec<bool>,
}

impl Orientation {
    /// Yaw, pitch and roll of row k, relative as asked.
    pub fn ypr(&self, k: usize) -> Ypr {
        relative_to(self.world_from_body[k], self.start, self.relative).to_ypr()
    }

    /// Yaw, pitch and roll of every row, rad: the same bits as [`ypr`](Orientation::ypr) of each.
    pub fn ypr_rad(&self) -> Vec<[f64; 3]> {
        ypr_rad(&self.world_from_body, self.start, self.relative)
    }
}

/// Yaw, pitch and roll, rad, of every attitude, relative to a start as asked; all of unit norm.
#[inline(always)]
pub fn ypr_rad(world_from_body: &[Quaternion], start: Quaternion, relative: Relative) -> Vec<[f64; 3]> {
    let mut out = alloc::vec![[0.0; 3]; world_from_body.len()];
    euler::fill(&mut out, |k| relative_to(world_from_body[k], start, relative));
    out
}

/// An attitude relative to a start, both of unit norm.
pub fn relative_to(world_from_body: Quaternion, start: Quaternion, relative: Relative) -> Quaternion {
    match relative {
        Relative::World => world_from_body.product(start.conjugate()),
        Relative::Body => start.conjugate().product(world_from_body),
        Relative::None => world_from_body,
    }
}

/// Orientation of a recording. `dt_s[k]` is the time from sample k − 1 to sample k (the first: the nominal
/// step); rates rad/s and specific forces m/s² in body axes.
///
/// Refused: unequal lengths, numbers that are not finite, settings out of range; [`Error::NoRest`] where no rest
/// is found, [`Error::TooFewPoints`] where the given rest has fewer than 10 samples, [`Error::AxisNearVertical`]
/// where the forward axis has no heading.
pub fn orient(
    acc_m_s2: &[Vec3],
    gyro_rad_s: &[Vec3],
    dt_s: &[f64],
    settings: &Settings,
) -> Result<Orientation> {
    orient_with(acc_m_s2, gyro_rad_s, dt_s, settings, &InTurn)
}

/// As [`orient`]; `pair` says how the smoother's two passes are done, to the same result.
pub fn orient_with(
    acc_m_s2: &[Vec3],
    gyro_rad_s: &[Vec3],
    dt_s: &[f64],
    settings: &Settings,
    pair: &impl Pair,
) -> Result<Orientation> {
    let (mut found, mut later) = begin(acc_m_s2, gyro_rad_s, dt_s, settings, pair)?;
    later.complete(&mut found)?;
    Ok(found)
}

/// The attitudes of a recording from the first row to the last: those that are known already, and then those that are
/// made when they are asked for.
pub struct Later<'a> {
    series: Option<Box<dyn Series + 'a>>,
    rows: usize,
    /// The row that is next.
    row: usize,
}

impl core::fmt::Debug for Later<'_> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "Later {} of {}", self.row, self.rows)
    }
}

impl Later<'_> {
    /// The attitudes of the next rows, `world_from_body`, where `found` is what [`begin`] found; refused beyond the
    /// last row.
    pub fn next(&mut self, found: &Orientation, out: &mut [Quaternion]) -> Result<()> {
        let known = found.world_from_body.get(self.row..).unwrap_or_default();
        self.row += out.len();
        let (first, others) = out.split_at_mut(known.len().min(out.len()));
        first.copy_from_slice(&known[..first.len()]);
        match &mut self.series {
            Some(series) => series.next(others),
            None => filter::same_length(others.len(), 0),
        }
    }

    /// Makes all attitudes known at once; refused after [`next`](Later::next).
    pub fn complete(&mut self, found: &mut Orientation) -> Result<()> {
        filter::same_length(self.rows, self.rows - self.row)?;
        if let Some(mut series) = self.series.take() {
            let known = found.world_from_body.len();
            found.world_from_body.resize(self.rows, Quaternion::IDENTITY);
            series.next(&mut found.world_from_body[known..])?;
        }
        Ok(())
    }
}

/// As [`orient_with`], but of the classic filters' attitudes only some of the first are found, and the others are made
/// when they are asked for.
pub fn begin<'a>(
    acc_m_s2: &'a [Vec3],
    gyro_rad_s: &'a [Vec3],
    dt_s: &'a [f64],
    settings: &Settings,
    pair: &impl Pair,
) -> Result<(Orientation, Later<'a>)> {
    filter::same_length(acc_m_s2.len(), gyro_rad_s.len())?;
    if acc_m_s2.is_empty() {
        return Err(Error::Empty);
    }
    Dt::PerSample(dt_s).check(acc_m_s2.len())?;
    filter::check_rows(acc_m_s2, 0)?;
    filter::check_rows(gyro_rad_s, 0)?;
    let gravity = filter::positive("gravity", settings.gravity_m_s2)?;

    let rest = match find_rest(acc_m_s2, gyro_rad_s, dt_s, settings) {
        Err(Error::NoRest { .. }) if settings.method.starts_in_motion() => None,
        found => found?,
    };
    let (origin, gyro_bias_rad_s, level) = match &rest {
        Some(rest) => (rest.start, rest::gyro_bias(&gyro_rad_s[rest.clone()])?, rest.clone()),
        None => (0, [0.0; 3], 0..after(dt_s, 0, LEVEL_S)),
    };
    let level = initial::from_mean_acceleration(rest::mean(&acc_m_s2[level])?)?;
    let mut found = Orientation {
        world_from_body: Vec::new(),
        start: level,
        rest,
        gyro_bias_rad_s,
        relative: settings.relative,
        certainty: None,
        learnt: None,
    };
    if settings.method.starts_in_motion() {
        if settings.sensor.is_some() || settings.method == Method::EstimateOnline {
            found.gyro_bias_rad_s = [0.0; 3];
        }
        let rest = found.rest.as_ref().map(|rest| (rest, level));
        let bias = found.gyro_bias_rad_s;
        let estimate = estimated::run((acc_m_s2, gyro_rad_s, dt_s), settings, bias, rest, pair)?;
        found.start = estimate.start;
        found.world_from_body = estimate.world_from_body;
        found.certainty = Some(estimate.certainty);
        found.learnt = Some(estimate.learnt);
        if let Some(axis) = settings.forward_axis_body {
            let turn = heading::from_forward_axis(found.start, axis)?;
            found.start = turn.product(found.start);
            found.world_from_body.iter_mut().for_each(|q| *q = turn.product(*q));
        }
        return Ok((found, Later { series: None, rows: acc_m_s2.len(), row: 0 }));
    }
    if let Some(axis) = settings.forward_axis_body {
        found.start = heading::from_forward_axis(level, axis)?.product(level);
    }
    let start = found.start;
    let data = Data { acc: acc_m_s2, gyro: gyro_rad_s, dt: dt_s, bias: gyro_bias_rad_s };
    let (earlier, series) = match settings.method {
        Method::Gyro => data.run(origin, start, GyroIntegrator::new),
        Method::GyroRk4 => data.run(origin, start, GyroRk4::new),
        Method::Mahony { kp, ki } => data.run(origin, start, move |q| Mahony::new(q, kp, ki)),
        Method::MahonyAdaptive { gain, ki } => {
            data.run(origin, start, move |q| MahonyAdaptive::new(q, gain, ki, gravity))
        }
        Method::Complementary { alpha } => {
            data.run(origin, start, move |q| Complementary::new(q, alpha, gravity))
        }
        Method::Estimate | Method::EstimateOnline => return Err(Error::Empty), // done above
    }?;
    found.world_from_body = earlier;
    Ok((found, Later { series: Some(series), rows: acc_m_s2.len(), row: 0 }))
}

impl Method {
    /// True for the estimator, which needs no rest.
    pub fn starts_in_motion(self) -> bool {
        matches!(self, Method::Estimate | Method::EstimateOnline)
    }
}

fn find_rest(acc: &[Vec3], gyro: &[Vec3], dt_s: &[f64], settings: &Settings) -> Result<Option<Range<usize>>> {
    match settings.rest {
        RestChoice::None => Ok(None),
        RestChoice::Auto => {
            let search = RestSettings { gravity_m_s2: settings.gravity_m_s2, ..RestSettings::default() };
            rest::first_of_checked(acc, gyro, Dt::PerSample(dt_s), &search).map(Some)
        }
        RestChoice::Rows { start, end } => {
            let end = end.min(acc.len());
            let given = end.saturating_sub(start);
            if given < rest::MIN_BIAS_SAMPLES {
                return Err(Error::TooFewPoints { given, needed: rest::MIN_BIAS_SAMPLES });
            }
            Ok(Some(start..end))
        }
    }
}

/// The rows from `start_s` to `end_s`, both included, of ascending times.
pub fn rows_between(time_s: &[f64], start_s: f64, end_s: f64) -> Range<usize> {
    let start = time_s.partition_point(|&t| t < start_s);
    start..time_s.partition_point(|&t| t <= end_s).max(start)
}

/// The first row at least `span_s` after row `from`, or the end, or the next gap.
fn after(dt_s: &[f64], from: usize, span_s: f64) -> usize {
    let mut passed_s = 0.0;
    for k in from + 1..dt_s.len() {
        passed_s += dt_s[k];
        if dt_s[k] > GAP_S || passed_s >= span_s {
            return k;
        }
    }
    dt_s.len()
}

/// The recording and the bias, for runs in both directions of time.
struct Data<'a> {
    acc: &'a [Vec3],
    gyro: &'a [Vec3],
    dt: &'a [f64],
    bias: Vec3,
}

impl<'a> Data<'a> {
    /// Attitudes of the rows before `origin`, where the attitude is `start`, and what makes the others.
    fn run<F: Filter + Copy + 'a>(
        &self,
        origin: usize,
        start: Quaternion,
        make: impl Fn(Quaternion) -> Result<F> + Copy + 'a,
    ) -> Result<(Vec<Quaternion>, Box<dyn Series + 'a>)> {
        let with_bias = |bias| move |q| make(q).map(|filter| Unbiased { filter, bias });
        let mut earlier = alloc::vec![Quaternion::IDENTITY; origin];
        if origin > 0 {
            // Backward: the step from row k + 1 to row k undoes the turn of sample k + 1, so that the rate and the
            // bias change sign.
            let turns: Vec<Vec3> = (0..origin).rev().map(|k| vector::scale(self.gyro[k + 1], -1.0)).collect();
            let acc: Vec<Vec3> = self.acc[..origin].iter().rev().copied().collect();
            let steps: Vec<f64> = (0..origin).rev().map(|k| self.dt[k + 1]).collect();
            let make = with_bias(vector::scale(self.bias, -1.0));
            Stretches::after_start(make, start, (&turns, &acc, &steps))?.next(&mut earlier)?;
            earlier.reverse();
        }
        let later = (&self.gyro[origin..], &self.acc[origin..], &self.dt[origin..]);
        let later = Stretches::from_start(with_bias(self.bias), start, later)?;
        Ok((earlier, Box::new(later)))
    }
}

/// A filter that is given rates with a bias.
#[derive(Clone, Copy)]
pub(super) struct Unbiased<F> {
    filter: F,
    bias: Vec3,
}

impl<F: Filter> Filter for Unbiased<F> {
    #[inline]
    fn update(&mut self, gyro_rad_s: Vec3, acc_m_s2: Vec3, dt_s: f64) -> Quaternion {
        self.filter.update(vector::sub(gyro_rad_s, self.bias), acc_m_s2, dt_s)
    }

    fn orientation(&self) -> Quaternion {
        self.filter.orientation()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimator::{self, Estimator, Sample};
    use crate::math;

    const RATE_HZ: f64 = 100.0;
    const G: f64 = crate::STANDARD_GRAVITY_M_S2;

    /// A level sensor: rests for `rest_s`, and otherwise turns about z at `yaw_rate`, with a bias on all axes.
    fn turntable(
        seconds: f64,
        rest_s: Range<f64>,
        yaw_rate: f64,
        bias: f64,
    ) -> (Vec<Vec3>, Vec<Vec3>, Vec<f64>) {
        let rows = (seconds * RATE_HZ) as usize;
        let gyro = (0..rows)
            .map(|k| {
                let still = rest_s.contains(&(k as f64 / RATE_HZ));
                [bias, bias, bias + if still { 0.0 } else { yaw_rate }]
            })
            .collect();
        (alloc::vec![[0.0, 0.0, G]; rows], gyro, alloc::vec![1.0 / RATE_HZ; rows])
    }

    /// The classic default.
    fn mahony() -> Settings {
        Settings { method: Method::Mahony { kp: 0.2, ki: 0.0 }, ..Settings::default() }
    }

    #[test]
    fn bias_of_the_rest_is_removed_and_the_turn_remains() {
        for method in [Method::Estimate, Method::EstimateOnline, Method::Mahony { kp: 0.2, ki: 0.0 }] {
            check_turn(method);
        }
    }

    fn check_turn(method: Method) {
        let (acc, gyro, dt) = turntable(6.0, 0.0..3.0, 0.5, 0.02);
        let found = orient(&acc, &gyro, &dt, &Settings { method, ..Settings::default() }).unwrap();
        let removed = if method == Method::EstimateOnline { 0.0 } else { 0.02 };
        assert!(found.gyro_bias_rad_s.iter().all(|b| (b - removed).abs() < 1e-3), "{found:?}");
        let yaw = found.ypr(599).yaw_rad;
        assert!((yaw - 1.5).abs() < 0.01, "{yaw}");
    }

    /// Turns with a bias, rests from 24 s on: a rest that is found, given or not sought changes no attitude, and
    /// neither does what comes after.
    #[test]
    fn the_online_form_knows_nothing_of_later_samples() {
        let (acc, gyro, dt) = turntable(30.0, 24.0..30.0, 0.6, 0.03);
        let with = |rows: usize, rest| {
            let settings = Settings { method: Method::EstimateOnline, rest, ..Settings::default() };
            orient(&acc[..rows], &gyro[..rows], &dt[..rows], &settings).unwrap()
        };
        let found = with(3000, RestChoice::Auto);
        assert!(found.rest.as_ref().is_some_and(|rest| rest.start > 2300), "{:?}", found.rest);
        assert_eq!(found.gyro_bias_rad_s, [0.0; 3]);
        let mut live = Estimator::new(&estimator::Settings::default()).unwrap();
        for (k, q) in found.world_from_body.iter().enumerate() {
            let sample = Sample { gyro_rad_s: gyro[k], acc_m_s2: acc[k], dt_s: dt[k] };
            assert_eq!(*q, live.update(&sample).world_from_body, "row {k}");
        }
        for other in [with(2000, RestChoice::Auto), with(3000, RestChoice::Rows { start: 2500, end: 2700 })] {
            let rows = other.world_from_body.len();
            assert_eq!(other.world_from_body, found.world_from_body[..rows]);
        }
        // relative to the rest, where the bias has been learnt
        let yaw = found.ypr(2999).yaw_rad;
        assert!(yaw.abs() < 1e-3, "{yaw}");
    }

    #[test]
    fn rows_before_a_late_rest_are_reached_backward() {
        // Turns for 2 s, rests 3 s, turns 1 s: yaw must run from −2 through 0 to +1.
        let (acc, gyro, dt) = turntable(6.0, 2.0..5.0, 1.0, -0.01);
        let found = orient(&acc, &gyro, &dt, &mahony()).unwrap();
        assert!(found.rest.as_ref().is_some_and(|rest| rest.start > 150), "{:?}", found.rest);
        assert!((found.ypr(0).yaw_rad + 2.0).abs() < 0.04, "{:?}", found.ypr(0));
        assert!((found.ypr(599).yaw_rad - 1.0).abs() < 0.02, "{:?}", found.ypr(599));
    }

    #[test]
    fn a_gap_is_not_integrated_and_tilt_is_found_again() {
        // Level for 4 s; in a gap of 10 s the sensor is put on its side (30° about x).
        let (sin, cos) = math::sin_cos(0.5235987755982988);
        let mut acc = alloc::vec![[0.0, 0.0, G]; 800];
        acc[400..].fill([0.0, G * sin, G * cos]);
        let mut dt = alloc::vec![0.01; 800];
        dt[400] = 10.0;
        let mut gyro = alloc::vec![[0.0; 3]; 800];
        gyro[400] = [1.0, 1.0, 1.0];
        let found = orient(&acc, &gyro, &dt, &mahony()).unwrap();
        let ypr = found.ypr(401);
        assert!((ypr.roll_rad - 0.5235987755982988).abs() < 1e-9 && ypr.yaw_rad.abs() < 1e-9, "{ypr:?}");
    }

    /// Shaking on its side (40° about x) for 4 s, a gap of 10 s, and then a level rest: the rows before the gap are
    /// reached backward through it, and start anew there.
    #[test]
    fn rows_before_a_gap_at_the_rest_are_levelled() {
        let tilt = 0.6981317007977318;
        let (sin, cos) = math::sin_cos(tilt);
        let mut acc = alloc::vec![[0.0, 0.0, G]; 800];
        for (k, row) in acc[..400].iter_mut().enumerate() {
            let shake = 2.0 * math::sin(20.0 * k as f64 / RATE_HZ);
            *row = [shake, G * sin - shake * cos, G * cos + shake * sin];
        }
        let mut dt = alloc::vec![0.01; 800];
        dt[400] = 10.0;
        let gyro = alloc::vec![[0.0; 3]; 800];
        for method in [Method::Gyro, Method::Mahony { kp: 0.2, ki: 0.0 }] {
            let settings = Settings { method, relative: Relative::None, ..Settings::default() };
            let found = orient(&acc, &gyro, &dt, &settings).unwrap();
            assert!(found.rest.as_ref().is_some_and(|rest| rest.start == 400), "{:?}", found.rest);
            for (row, roll) in [(0, tilt), (200, tilt), (399, tilt), (400, 0.0), (799, 0.0)] {
                let ypr = found.ypr(row);
                assert!((ypr.roll_rad - roll).abs() < 0.05, "{method:?}, row {row}: {ypr:?}");
                assert!(ypr.yaw_rad.abs() < 0.05 && ypr.pitch_rad.abs() < 0.05, "{method:?}, {row}: {ypr:?}");
            }
        }
    }

    #[test]
    fn given_rest_and_refusals() {
        let (acc, gyro, dt) = turntable(6.0, 0.0..3.0, 0.5, 0.02);
        let with = |rest| orient(&acc, &gyro, &dt, &Settings { rest, ..mahony() });
        let time: Vec<f64> = (0..600).map(|k| f64::from(k) / RATE_HZ).collect();
        let rows = rows_between(&time, 1.0, 2.0);
        let found = with(RestChoice::Rows { start: rows.start, end: rows.end }).unwrap();
        assert_eq!(found.rest, Some(100..201));
        assert!(matches!(
            with(RestChoice::Rows { start: 700, end: 800 }),
            Err(Error::TooFewPoints { given: 0, needed: 10 })
        ));
        let moving = turntable(6.0, 9.0..10.0, 0.9, 0.02);
        let none = orient(&moving.0, &moving.1, &moving.2, &mahony());
        assert!(matches!(none, Err(Error::NoRest { .. })), "{none:?}");
        let (acc, gyro, dt) = &moving;
        assert!(orient(acc, gyro, dt, &Settings::default()).is_ok_and(|found| found.rest.is_none()));
        let forward = Settings { forward_axis_body: Some([0.0, 0.0, 1.0]), ..Settings::default() };
        assert!(matches!(orient(acc, gyro, dt, &forward), Err(Error::AxisNearVertical { .. })));
    }
}
