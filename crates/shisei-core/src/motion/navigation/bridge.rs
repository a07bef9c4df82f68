//! The navigator over a hole in the samples ([`crate::motion::holes`]).

use super::{Event, Run};
use crate::math;
use crate::motion::error_state::{ATTITUDE, ProcessNoise, Step, propagate};
use crate::quaternion::Quaternion;
use crate::vector::{self, Vec3};

/// Stances or rests after a hole until the tilt is known again.
const HEADING_DOUBT_STANCES: u8 = 2;

impl Run<'_> {
    /// From row − 1 to row over a hole .
    pub(super) fn bridge(&mut self, row: usize) {
        let (before, dt_s) = (row.saturating_sub(1), self.dt.at(row));
        let up = [0.0, 0.0, self.settings.gravity_m_s2];
        let rates = [self.corrected_rate(before), self.corrected_rate(row)];
        let middle = |x: [Vec3; 2], f: f64| vector::add(x[0], vector::scale(vector::sub(x[1], x[0]), f));
        let motion = &self.settings.hole_motion;
        let share = motion.bridge(dt_s, [[0.0; 3]; 2], rates).share;
        let turn = vector::scale(middle(rates, 0.5), share * dt_s);
        let turned = |f: f64| self.q.product(Quaternion::from_rotation_vector(vector::scale(turn, f)));
        let after = turned(1.0).normalized();
        let linear = [(self.q, self.corrected_acc(before)), (after, self.corrected_acc(row))]
            .map(|(q, acc)| vector::sub(q.rotate(acc), up));
        let bridge = motion.bridge(dt_s, linear, rates);
        let dt_s = dt_s / bridge.pieces as f64;
        let noise = ProcessNoise {
            acc_density: math::hypot(self.noise.acc_density, bridge.acc_density),
            gyro_density: math::hypot(self.noise.gyro_density, bridge.gyro_density),
            ..self.noise
        };
        for piece in 0..bridge.pieces {
            let f = (piece as f64 + 0.5) / bridge.pieces as f64;
            let acc = vector::scale(middle(linear, f), share);
            let q = turned(f);
            let mean = vector::add(self.velocity, vector::scale(acc, 0.5 * dt_s));
            self.position = vector::add(self.position, vector::scale(mean, dt_s));
            self.velocity = vector::add(self.velocity, vector::scale(acc, dt_s));
            // only what is read feels the attitude's error
            let read = vector::add(acc, vector::scale(up, share));
            let step = Step {
                rotation: q.to_matrix(),
                acc_body: q.conjugate().rotate(read),
                rate_body: vector::scale(middle(rates, f), share),
                dt_s,
            };
            propagate(&mut self.p, &step, &noise);
            self.events.push(Event::Step(step));
        }
        self.q = after;
        self.heading_doubt.0 += bridge.gyro_density * bridge.gyro_density * self.dt.at(row);
        self.heading_doubt.1 = HEADING_DOUBT_STANCES;
        self.bridged.get_or_insert(row);
    }

    /// A stance or a rest is over. After a hole tilt and velocity are far off, and by their products, which the
    /// linear model leaves out, the zero velocities seem to tell the heading too. They do not: once the tilt is known
    /// again, the heading gets back the variance that the hole gave it.
    pub(super) fn leave_stance(&mut self) {
        let (variance, left) = self.heading_doubt;
        if left > 1 {
            self.heading_doubt.1 = left - 1;
        } else if left == 1 {
            self.p[ATTITUDE + 2][ATTITUDE + 2] += variance;
            self.heading_doubt = (0.0, 0);
        }
    }
}
