//! Samples as they come, and readings as the filters take them: nothing that is not a finite number of a
//! possible size gets past, and steps that are lost or irregular are known as such.

use super::between::Hole;
use super::calibration::Calibration;
use super::settings::Settings;
use crate::math;
use crate::vector::{self, Vec3};

/// A sample of an inertial sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Rate, rad/s, body axes.
    pub gyro_rad_s: Vec3,
    /// Specific force, m/s², body axes: (0, 0, +g) for a level sensor at rest.
    pub acc_m_s2: Vec3,
    /// Time since the sample before, s; of the first sample the usual step.
    pub dt_s: f64,
}

/// A sample fit for use.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Reading {
    pub gyro: Vec3,
    pub acc: Vec3,
    pub dt_s: f64,
    /// (dt − usual dt) / (2 dt): how much of the step the sample before stands for.
    pub irregular: f64,
    /// The mean rate over the part of the step for which the sample does not stand, where that is told, rad/s.
    pub between: Option<Vec3>,
    /// False where the rate could not be read and the last one is taken instead.
    pub gyro_known: bool,
    /// The same of the acceleration.
    pub acc_known: bool,
}

impl Reading {
    /// The part of the step for which the sample does not stand.
    pub(super) fn hole(&self) -> Option<Hole> {
        let missing_s = 2.0 * self.irregular * self.dt_s;
        (missing_s != 0.0).then_some(Hole { missing_s, usual_s: self.dt_s - missing_s })
    }
}

/// What a sample is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Checked {
    /// A reading like the one before it.
    Next(Reading),
    /// The first, or the first after a gap of this many seconds, of unknown motion.
    AfterGap(Reading, f64),
    /// No use at all: nothing is known and no time passed.
    Useless,
}

/// Readings of equal bits for longer than this are those of a stuck sensor, s.
const STUCK_S: f64 = 1.0;
/// Steps that differ by less than this part of them are equal.
const ROUNDING: f64 = 1e-6;
/// Weight of a new step in the usual step, at least.
const STEP_SHARE: f64 = 0.01;

/// Watches the samples.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Guard {
    last: Option<Reading>,
    raw: Option<(Vec3, Vec3)>,
    usual_dt_s: f64,
    steps: f64,
    blind_s: f64,
    stuck_s: f64,
}

fn readable(v: Vec3, limit: f64) -> bool {
    v.iter().all(|x| x.abs() <= limit)
}

impl Guard {
    /// The newest rate, rad/s.
    pub(super) fn last_rate(&self) -> Option<Vec3> {
        self.last.map(|last| last.gyro)
    }

    /// Whether a step is the usual one but for rounding, so that nothing lies between its sample and the one before.
    pub(super) fn is_usual(&self, dt_s: f64) -> bool {
        math::abs(dt_s - self.usual_dt_s) < ROUNDING * dt_s
    }

    pub(super) fn check(&mut self, sample: &Sample, settings: &Settings) -> Checked {
        let dt = sample.dt_s;
        if !(dt > 0.0 && dt < f64::INFINITY) {
            return Checked::Useless;
        }
        let known = |v: Vec3, correct: fn(&Calibration, Vec3) -> Vec3| match &settings.calibration {
            Some(calibration) => correct(calibration, v),
            None => v,
        };
        let stuck = self.raw == Some((sample.gyro_rad_s, sample.acc_m_s2));
        self.raw = Some((sample.gyro_rad_s, sample.acc_m_s2));
        self.stuck_s = if stuck { self.stuck_s + dt } else { 0.0 };
        let turning = vector::norm(sample.gyro_rad_s) > settings.rest.mean_rate_rad_s;
        let gyro_known =
            readable(sample.gyro_rad_s, settings.gyro_limit_rad_s) && !(turning && self.stuck_s > STUCK_S);
        // an accelerometer that reads nothing at all is not in free fall but off
        let acc_known = readable(sample.acc_m_s2, settings.acc_limit_m_s2) && sample.acc_m_s2 != [0.0; 3];
        let (gyro_before, acc_before) = match self.last {
            Some(last) => (last.gyro, last.acc),
            None if gyro_known && acc_known => ([0.0; 3], [0.0; 3]),
            None => return Checked::Useless,
        };
        let gyro = if gyro_known { known(sample.gyro_rad_s, Calibration::correct_gyro) } else { gyro_before };
        let acc = if acc_known { known(sample.acc_m_s2, Calibration::correct_acc) } else { acc_before };
        let gap = dt > settings.gap_s;
        let irregular = if gap { 0.0 } else { self.irregular(dt) };
        let reading = Reading {
            gyro,
            acc,
            dt_s: dt.min(settings.gap_s),
            irregular,
            between: None,
            gyro_known,
            acc_known,
        };
        let blind_before = self.blind_s;
        self.blind_s = if gyro_known && acc_known { 0.0 } else { self.blind_s + dt };
        let first = self.last.is_none();
        self.last = Some(reading);
        if gap || first {
            return Checked::AfterGap(reading, if first { 0.0 } else { dt });
        }
        if self.blind_s == 0.0 && blind_before > settings.gap_s {
            return Checked::AfterGap(reading, blind_before);
        }
        Checked::Next(reading)
    }

    /// How much of the step the sample before stands for: half of what it is longer than usual.
    fn irregular(&mut self, dt: f64) -> f64 {
        if self.steps == 0.0 {
            self.usual_dt_s = dt;
        }
        let off = dt - self.usual_dt_s;
        // lost samples and bunches say nothing of the usual step, unless there is nothing else
        if off.abs() < 0.5 * self.usual_dt_s || self.steps < 4.0 {
            self.steps += 1.0;
            self.usual_dt_s += off * (1.0 / self.steps).max(STEP_SHARE);
        } else {
            self.steps = (self.steps - 0.1).max(1.0);
        }
        let share = 0.5 * (dt - self.usual_dt_s) / dt;
        if share.abs() < ROUNDING { 0.0 } else { share.max(-0.5) }
    }
}
