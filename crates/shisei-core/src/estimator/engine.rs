//! One filter: a sample moves its nominal state, the end of an interval moves its covariance and applies what is
//! known of the motion.

use super::calibration::Calibration;
use super::covariance::Covariance;
use super::guard::Reading;
use super::model::{
    BA, BG, Corrected, Interval, LEVER, MG, Nominal, PHI, POS, SA, STATES, STATES_WITH_LEVER, VEL,
};
use super::settings::Model;
use super::transition::Transition;
use crate::filter::exponential::{advance, exp_half};
use crate::quaternion::Quaternion;
use crate::vector::{self, Vec3};

/// An optical pose of a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OpticalPose {
    /// Attitude of the sensor, world from body.
    pub world_from_body: Quaternion,
    /// Position of the optical body's point, m, world.
    pub position_m: Vec3,
}

impl OpticalPose {
    /// The pose with its position counted from the first one, m; none where it is not finite.
    #[cfg(feature = "alloc")]
    pub(super) fn counted_from(&self, first_m: &mut Option<Vec3>) -> Option<OpticalPose> {
        let world_from_body = self.world_from_body.try_normalized().ok()?;
        if !vector::is_finite(self.position_m) {
            return None;
        }
        let origin_m = *first_m.get_or_insert(self.position_m);
        Some(OpticalPose { world_from_body, position_m: vector::sub(self.position_m, origin_m) })
    }
}

/// A marker of the optical body, seen at a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Point {
    /// From the body's point to the marker, m, sensor axes.
    pub arm_m: Vec3,
    /// Where it was seen, m, world.
    pub position_m: Vec3,
    /// Variance of that, the arm's doubt included, m².
    pub variance_m2: f64,
}

/// Most markers of a sample: so many beside a rest fit into an interval's measurements.
pub(crate) const POINTS: usize = 2;

/// The markers that are seen at a sample, the first ones first.
pub(crate) type Points = [Option<Point>; POINTS];

/// What the cameras saw at a sample.
#[derive(Clone, Copy, Debug)]
pub(super) enum Sight<'a> {
    Pose(&'a OpticalPose, OpticalNoise),
    Points(&'a Points),
    /// Nothing, but what they saw later tells where to start anew after a hole.
    Told(&'a Told),
}

impl<'a> Sight<'a> {
    /// The pose, if it is one.
    pub(super) fn pose(self) -> Option<&'a OpticalPose> {
        match self {
            Sight::Pose(pose, _) => Some(pose),
            Sight::Points(_) | Sight::Told(..) => None,
        }
    }

    /// True where it tells the attitude, so that no level need be found.
    pub(super) fn tells_attitude(self) -> bool {
        !matches!(self, Sight::Points(_))
    }
}

/// How well optical poses are known, and what the lever arm may be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct OpticalNoise {
    pub attitude_rad: f64,
    pub position_m: f64,
    pub lever_m: f64,
}

/// A sample's motion as later poses tell it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Told {
    pub sample: usize,
    /// Attitude of the sensor, and place of the optical body's point.
    pub pose: OpticalPose,
    /// m/s, world.
    pub velocity: Vec3,
    /// Standard deviations: rad, m/s, m.
    pub sigma_rad: f64,
    pub sigma_m_s: f64,
    pub sigma_m: f64,
    /// From this sample on poses are seen again: up to these two their positions are taken in coarsely.
    pub seen: usize,
    pub coarse_until: [usize; 2],
}

impl Told {
    /// The noise of the pose at a sample from [`Told::seen`] on. A state that is known a thousand times less well than a
    /// pose would lose all digits of what is left of its variance if it were corrected at once; a pose or two later
    /// nothing is lost by that.
    pub(super) fn noise(&self, sample: usize, noise: &OpticalNoise) -> OpticalNoise {
        let [first, second] = self.coarse_until;
        let position_m = if sample < first {
            noise.position_m.max(COARSE_M[0])
        } else if sample < second {
            noise.position_m.max(COARSE_M[1])
        } else {
            noise.position_m
        };
        OpticalNoise { position_m, ..*noise }
    }
}

/// How well positions are taken in after a start anew, one update and another, m.
const COARSE_M: [f64; 2] = [0.1, 0.005];

/// Most triples of measurements at the end of an interval.
pub(super) const TRIPLES: usize = 3;

/// What three measurements are of.
#[derive(Clone, Copy, Debug)]
pub(super) enum Rows {
    /// The error states from this index, a multiple of three, on.
    States(usize),
    /// The position, and these combinations of attitude and lever arm.
    Arm([Vec3; 3], [Vec3; 3]),
}

impl Rows {
    /// Calls `take` with every error state that row j is of and its factor.
    #[inline(always)]
    pub(super) fn terms(&self, j: usize, mut take: impl FnMut(usize, f64)) {
        match self {
            Rows::States(first) => take(first + j, 1.0),
            Rows::Arm(attitude, lever) => {
                take(POS + j, 1.0);
                for l in 0..3 {
                    take(PHI + l, attitude[j][l]);
                    take(LEVER + l, lever[j][l]);
                }
            }
        }
    }
}

/// Measurements of a vector, kept for the backward pass.
#[derive(Clone, Copy, Debug)]
pub(super) struct Measured {
    pub rows: Rows,
    /// Their variance.
    pub variance: f64,
    /// What is left of them after all measurements of the interval.
    pub left: Vec3,
}

/// What the end of an interval did, kept for the backward pass.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step {
    pub transition: Transition,
    /// The state before the measurements.
    pub before: Nominal,
    count: usize,
    measured: [Measured; TRIPLES],
}

impl Step {
    pub(super) fn empty() -> Self {
        let none = Measured { rows: Rows::States(0), variance: 1.0, left: [0.0; 3] };
        Step {
            transition: Transition::none(),
            before: Nominal::new(Quaternion::IDENTITY),
            count: 0,
            measured: [none; TRIPLES],
        }
    }

    /// All measurements, in order.
    pub(super) fn measured(&self) -> &[Measured] {
        &self.measured[..self.count]
    }

    /// Measures z.
    fn take<const N: usize>(
        &mut self,
        covariance: &mut Covariance<N>,
        error: &mut [f64; N],
        rows: Rows,
        z: Vec3,
        variance: f64,
    ) {
        covariance.measure(error, &rows, z, variance);
        if let Some(slot) = self.measured.get_mut(self.count) {
            *slot = Measured { rows, variance, left: z };
            self.count += 1;
        }
    }

    /// All is measured: what is left of it.
    fn finish<const N: usize>(&mut self, error: &[f64; N]) {
        for measured in &mut self.measured[..self.count] {
            for (j, left) in measured.left.iter_mut().enumerate() {
                measured.rows.terms(j, |index, factor| *left -= factor * error[index]);
            }
        }
    }
}

/// Time over which the speed is averaged, s.
const SPEED_MEAN_S: f64 = 1.0;
/// What a rate may be that was not read, rad/s, and an acceleration, m/s².
const BLIND_RATE: f64 = 1.0;
const BLIND_FORCE: f64 = 5.0;
/// At rest a rate farther from the bias than this many standard deviations says that the bias jumped.
const JUMP_SIGMAS: f64 = 6.0;
/// How fast an acceleration leaves the course between the samples beside a hole, m/s³: what is off in the velocity is
/// this times the hole's length squared (bridging only).
const HOLE_JERK: f64 = 12.0;
/// Start of velocity and position: standard deviations, m/s and m.
const VELOCITY_START: f64 = 0.3;
const POSITION_START: f64 = 0.3;
/// Heading is zero at the start by definition; not quite, so that the covariance stays regular. rad.
const HEADING_START: f64 = 1e-3;

/// Nominal state, covariance, and the interval under way.
#[derive(Clone, Copy, Debug)]
pub(super) struct Engine<const N: usize> {
    pub model: Model,
    pub gravity: f64,
    pub nominal: Nominal,
    pub covariance: Covariance<N>,
    pub sums: Interval,
    /// Mean square of the speed, (m/s)².
    speed_squared: f64,
    /// The sample before: rate, acceleration, and acceleration without gravity in the world.
    last: Option<(Vec3, Vec3, Vec3)>,
    /// The change of rate over the last step, rad/s.
    gyro_change: Vec3,
    /// What the end of the last interval did.
    pub step: Step,
}

impl<const N: usize> Engine<N> {
    /// Starts level to `sigma_tilt`, rad, with what is known of the sensor.
    pub(super) fn new(
        model: &Model,
        gravity: f64,
        known: Option<&Calibration>,
        world_from_body: Quaternion,
        sigma_tilt: f64,
        lever_m: f64,
    ) -> Self {
        let mut covariance = Covariance::zero();
        if let Some(known) = known {
            known.start_covariance(model, &mut covariance);
        } else {
            covariance.set_diagonal(BG, 3, model.gyro_bias_start);
            covariance.set_diagonal(BA, 3, model.acc_bias_start);
            covariance.set_diagonal(MG, 9, model.gyro_matrix_start);
            covariance.set_diagonal(SA, 3, model.acc_scale_start);
        }
        covariance.set_diagonal(LEVER, N - LEVER, lever_m);
        let mut engine = Engine {
            model: *model,
            gravity,
            nominal: Nominal::new(world_from_body),
            covariance,
            sums: Interval::default(),
            speed_squared: 0.0,
            last: None,
            gyro_change: [0.0; 3],
            step: Step::empty(),
        };
        engine.covariance.restart_moving(moving_sigmas(sigma_tilt, HEADING_START));
        engine
    }

    /// Doubts the accelerometer more: what is known of bias and scale may be off by `off`, m/s².
    pub(super) fn doubt_accelerometer(&mut self, off: f64) {
        let share = off / self.gravity;
        for j in 0..3 {
            let p = &mut self.covariance.0;
            p[BA + j][BA + j] = p[BA + j][BA + j].max(off * off);
            p[SA + j][SA + j] = p[SA + j][SA + j].max(0.25 * share * share);
        }
    }

    /// Starts level anew, as after a gap; what was learnt of the sensor stays, and so does the heading's variance:
    /// what a gap adds to it is no concern of the filter, to which all headings are alike, and is kept beside it.
    pub(super) fn restart(&mut self, world_from_body: Quaternion, sigma_tilt: f64) {
        let heading = crate::math::sqrt(self.covariance.0[PHI + 2][PHI + 2].max(0.0));
        self.covariance.restart_moving(moving_sigmas(sigma_tilt, heading));
        self.nominal.world_from_body = world_from_body;
        self.nominal.velocity = [0.0; 3];
        self.nominal.position = [0.0; 3];
        self.sums = Interval::default();
        self.speed_squared = 0.0;
        self.last = None;
        self.gyro_change = [0.0; 3];
    }

    /// Starts anew from a motion that later poses tell, heading and all.
    pub(super) fn restart_told(&mut self, told: &Told) {
        let q = told.pose.world_from_body;
        self.restart(q, told.sigma_rad);
        let (a, v, p) = (told.sigma_rad, told.sigma_m_s, told.sigma_m);
        self.covariance.restart_moving([a, a, a, v, v, v, p, p, p]);
        self.nominal.velocity = told.velocity;
        self.nominal.position = vector::sub(told.pose.position_m, q.rotate(self.nominal.lever));
    }

    /// Moves the nominal state by a reading.
    #[inline]
    pub(super) fn add(&mut self, reading: &Reading) {
        let dt = reading.dt_s;
        let now = (reading.gyro, reading.acc);
        let (gyro_before, acc_before, linear_before) = self.last.unwrap_or((now.0, now.1, [0.0; 3]));
        let first = self.last.is_none();
        // What of the step lies outside the time for which the sample stands, the sample before stands for.
        let share = if first { 0.0 } else { reading.irregular };
        let gyro_change = vector::sub(now.0, gyro_before);
        let acc_change = vector::sub(now.1, acc_before);
        let gyro = match &reading.between {
            Some(between) => {
                let mean = vector::scale(vector::sub(*between, now.0), 2.0 * share);
                vector::add(now.0, mean)
            }
            None => now.0,
        };
        let coning =
            if first { [0.0; 3] } else { vector::scale(vector::cross(gyro_before, now.0), dt / 12.0) };

        let mut rate = self.nominal.rate(gyro);
        rate = vector::add(rate, coning);
        let quarter = vector::scale(rate, 0.25 * dt);
        let middle = advance(self.nominal.world_from_body, quarter);
        let q = advance(middle, quarter);
        // A sample stands for the usual step before it, so the acceleration belongs to the middle of that.
        let middle_matrix = middle.to_matrix();
        let delay = self.model.acc_delay_s + share * dt;
        let at_force = if delay == 0.0 {
            middle_matrix
        } else {
            middle.product(exp_half(vector::scale(rate, 0.5 * delay))).to_matrix()
        };
        let f = self.nominal.force(now.1);
        let force_world =
            [vector::dot(at_force[0], f), vector::dot(at_force[1], f), vector::dot(at_force[2], f)];
        let corrected = Corrected { gyro, acc: now.1, rate, force_world, middle: middle_matrix, at_force };
        let mut linear = [force_world[0], force_world[1], force_world[2] - self.gravity];
        if !reading.acc_known {
            linear = [0.0; 3];
            self.sums.blind_force_s += dt;
        }
        if !reading.gyro_known {
            self.sums.blind_rate_s += dt;
        }
        self.last = Some((now.0, now.1, linear));
        if !first && share != 0.0 {
            linear = vector::sub(linear, vector::scale(vector::sub(linear, linear_before), share));
        }
        self.sums.add(&corrected, dt);
        self.sums.acc_change_squared += vector::dot(acc_change, acc_change) * dt * dt;
        let bend = vector::sub(gyro_change, self.gyro_change);
        self.gyro_change = gyro_change;
        self.sums.rate_bend_squared += vector::dot(bend, bend) * dt * dt;

        let n = &mut self.nominal;
        n.world_from_body = q;
        let change = vector::scale(linear, dt);
        // accelerations that are delayed are ahead of the rates' steps, and so is the velocity
        let late = 0.5 * dt - self.model.acc_delay_s;
        let mean = vector::add(n.velocity, vector::scale(linear, late));
        n.position = vector::add(n.position, vector::scale(mean, dt));
        n.velocity = vector::add(n.velocity, change);
        if self.model.position_forget_s > 0.0 {
            let keep = 1.0 - (dt / self.model.position_forget_s).min(1.0);
            n.position = vector::scale(n.position, keep);
        }
    }

    /// Moves the nominal state at a mean rate over a time, s, before a reading for which no sample stands.
    pub(super) fn fill(&mut self, reading: &Reading, rate: Vec3, missing_s: f64) {
        let acc_before = self.last.map_or(reading.acc, |(_, acc, _)| acc);
        let acc = vector::scale(vector::add(acc_before, reading.acc), 0.5);
        let filled = Reading { gyro: rate, acc, dt_s: missing_s, irregular: 0.0, between: None, ..*reading };
        self.add(&filled);
        if N > STATES {
            let off = HOLE_JERK * missing_s * missing_s;
            self.sums.unseen_velocity += off * off;
        }
    }

    /// Ends the interval: covariance, measurements, nominal state.
    pub(super) fn close(&mut self, rest: bool, optical: Option<Sight<'_>>) {
        let sums = core::mem::take(&mut self.sums);
        let t = sums.time_s;
        if t <= 0.0 {
            return;
        }
        let keep = match self.model.position_forget_s {
            forget if forget > 0.0 => 1.0 - (t / forget).min(1.0),
            _ => 1.0,
        };
        self.step.transition = Transition::new(&sums, keep);
        self.step.before = self.nominal;
        self.step.count = 0;
        self.covariance.propagate(&self.step.transition);
        self.add_noise(&sums);
        let v = self.nominal.velocity;
        self.speed_squared += (t / SPEED_MEAN_S).min(1.0) * (vector::dot(v, v) - self.speed_squared);

        let at_rest = (rest && sums.blind_rate_s == 0.0).then(|| self.rate_at_rest(&sums));
        let mut error = [0.0; N];
        match optical {
            Some(Sight::Pose(pose, noise)) => self.measure_pose(pose, &noise, &mut error),
            Some(Sight::Points(points)) => self.measure_points(points, &mut error),
            Some(Sight::Told(..)) | None => self.measure_bounds(rest, t, &mut error),
        }
        if let Some((off, variance)) = at_rest {
            self.step.take(&mut self.covariance, &mut error, Rows::States(BG), off, variance);
        }
        self.covariance.settle();
        self.step.finish(&error);
        self.nominal = self.nominal.moved(&error);
    }

    /// Bounded motion: velocity and position are zero, more or less.
    fn measure_bounds(&mut self, rest: bool, t: f64, error: &mut [f64; N]) {
        let m = &self.model;
        let sq = |x: f64| x * x;
        let speed = if rest {
            sq(m.rest_speed)
        } else {
            (sq(m.speed_share) * self.speed_squared).max(sq(m.speed_floor))
        };
        let place = sq(m.position_spread);
        for (density, first, value) in
            [(speed, VEL, self.nominal.velocity), (place, POS, self.nominal.position)]
        {
            if density > 0.0 {
                let off = vector::scale(value, -1.0);
                self.step.take(&mut self.covariance, error, Rows::States(first), off, density / t);
            }
        }
    }

    /// At rest the mean rate is the bias: how far it is from it, and with what variance. A bias that jumped is
    /// doubted first.
    fn rate_at_rest(&mut self, sums: &Interval) -> (Vec3, f64) {
        let mean = vector::scale(sums.gyro, 1.0 / sums.time_s);
        let variance = self.model.rest_rate * self.model.rest_rate / sums.time_s;
        let off = vector::sub(mean, self.nominal.gyro_bias);
        for j in 0..3 {
            let known = &mut self.covariance.0[BG + j][BG + j];
            if off[j] * off[j] > JUMP_SIGMAS * JUMP_SIGMAS * (*known + variance) {
                *known += off[j] * off[j];
            }
        }
        (off, variance)
    }

    /// The pose is the optical one: `φ = log(q_opt q*)`, `p_opt = p + R l`.
    fn measure_pose(&mut self, pose: &OpticalPose, noise: &OpticalNoise, error: &mut [f64; N]) {
        let q = self.nominal.world_from_body;
        let turn = pose.world_from_body.product(q.conjugate()).to_rotation_vector();
        let variance = noise.attitude_rad * noise.attitude_rad;
        self.step.take(&mut self.covariance, error, Rows::States(PHI), turn, variance);
        if N < STATES_WITH_LEVER {
            return;
        }
        self.measure_place(self.nominal.lever, pose.position_m, noise.position_m * noise.position_m, error);
    }

    /// Markers are where the pose puts them: `m = p + R (l + a)`.
    fn measure_points(&mut self, points: &Points, error: &mut [f64; N]) {
        if N < STATES_WITH_LEVER {
            return;
        }
        for point in points.iter().flatten() {
            let lever = vector::add(self.nominal.lever, point.arm_m);
            self.measure_place(lever, point.position_m, point.variance_m2, error);
        }
    }

    /// What lies at a lever arm from the sensor is at a place.
    fn measure_place(&mut self, lever: Vec3, place: Vec3, variance: f64, error: &mut [f64; N]) {
        let matrix = self.nominal.world_from_body.to_matrix();
        let arm = self.nominal.world_from_body.rotate(lever);
        let off = vector::sub(vector::sub(place, self.nominal.position), arm);
        // d(Exp(φ) R l) = φ × R l
        let cross = [[0.0, arm[2], -arm[1]], [-arm[2], 0.0, arm[0]], [arm[1], -arm[0], 0.0]];
        self.step.take(&mut self.covariance, error, Rows::Arm(cross, matrix), off, variance);
    }

    fn add_noise(&mut self, sums: &Interval) {
        let m = &self.model;
        let t = sums.time_s;
        let sq = |x: f64| x * x;
        let turning = sq(m.noise_per_rate) * sums.rate_squared
            + sq(m.noise_per_rate_bend) * sums.rate_bend_squared
            + sq(BLIND_RATE * sums.blind_rate_s);
        let acc = sq(m.velocity_noise) * t
            + sq(m.velocity_noise_per_change) * sums.acc_change_squared
            + sq(BLIND_FORCE * sums.blind_force_s)
            + sums.unseen_velocity;
        let p = &mut self.covariance.0;
        for j in 0..3 {
            let own = if j < 2 { m.tilt_noise } else { m.heading_noise };
            p[PHI + j][PHI + j] += sq(own) * t + turning;
            for l in 0..3 {
                p[PHI + j][PHI + l] += sums.unseen[j][l];
            }
            p[VEL + j][VEL + j] += acc;
            p[POS + j][POS + j] += acc * t * t / 3.0 + 1e-10;
            p[BG + j][BG + j] += sq(m.gyro_bias_walk) * t;
            p[BA + j][BA + j] += sq(m.acc_bias_walk) * t;
        }
        for k in MG..SA {
            p[k][k] += sq(m.gyro_matrix_walk) * t;
        }
    }

    /// Covariance of the attitude's error, rad², world axes.
    pub(super) fn attitude_covariance(&self) -> [Vec3; 3] {
        let p = &self.covariance.0;
        [[p[0][0], p[0][1], p[0][2]], [p[1][0], p[1][1], p[1][2]], [p[2][0], p[2][1], p[2][2]]]
    }

    /// False where the numbers no longer describe a sensor that is held by somebody.
    pub(super) fn is_sound(&self) -> bool {
        let n = &self.nominal;
        let within = |v: Vec3, limit: f64| v.iter().all(|x| x.abs() <= limit);
        n.is_finite()
            && self.covariance.is_sound()
            && within(n.velocity, 100.0)
            && within(n.position, 1000.0)
            && within(n.gyro_bias, 0.5)
            && within(n.acc_bias, 3.0)
            && n.gyro_matrix.iter().all(|&row| within(row, 0.2))
            && within(n.acc_scale, 0.2)
    }
}

fn moving_sigmas(tilt: f64, heading: f64) -> [f64; 9] {
    let (v, p) = (VELOCITY_START, POSITION_START);
    [tilt, tilt, heading, v, v, v, p, p, p]
}
