//! Attitude and position as functions of time, with exact derivatives.
//!
//! The attitude of a [`Path`] is a chain of turns about fixed axes, each by a curve, then a fixed mounting:
//! `world_from_body = turn₁ ⊗ turn₂ ⊗ … ⊗ mounting`. For q = q₁ ⊗ q₂ the body rate and its derivative are
//! `ω = q₂* ω₁ q₂ + ω₂` and `α = q₂* α₁ q₂ + ω × ω₂ + α₂`, so no number is differentiated numerically.
//! Yaw, pitch and roll are the chain of turns about z, y and x.

use shisei_core::vector::{add, cross, scale};
use shisei_core::{Quaternion, Vec3};

use crate::curve::Curve;

/// Where a sensor is and how it moves, at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State {
    /// Turns body (sensor) coordinates into world coordinates; unit norm to rounding.
    pub world_from_body: Quaternion,
    /// Angular rate relative to the world, body coordinates, rad/s.
    pub rate_body_rad_s: Vec3,
    /// Derivative of `rate_body_rad_s`, rad/s².
    pub angular_acceleration_body_rad_s2: Vec3,
    /// Position of the sensor, world, m.
    pub position_m: Vec3,
    /// Its derivative, m/s.
    pub velocity_m_s: Vec3,
    /// Its second derivative, m/s²; gravity is not part of it.
    pub acceleration_m_s2: Vec3,
}

impl State {
    /// The state of a point fixed to the same rigid body, at a lever arm given in body coordinates, m.
    pub fn at_lever_arm(self, lever_arm_body_m: Vec3) -> State {
        let (q, w) = (self.world_from_body, self.rate_body_rad_s);
        let speed = cross(w, lever_arm_body_m);
        let acceleration =
            add(cross(self.angular_acceleration_body_rad_s2, lever_arm_body_m), cross(w, speed));
        State {
            position_m: add(self.position_m, q.rotate(lever_arm_body_m)),
            velocity_m_s: add(self.velocity_m_s, q.rotate(speed)),
            acceleration_m_s2: add(self.acceleration_m_s2, q.rotate(acceleration)),
            ..self
        }
    }
}

/// A movement with known truth.
pub trait Motion {
    /// The state at a time; any finite time may be asked for.
    fn state(&self, time_s: f64) -> State;

    /// How long the movement is, from time 0, s.
    fn duration_s(&self) -> f64;
}

/// One turn of a chain: about an axis fixed in the frame to its left, by a curve.
#[derive(Clone, Debug, PartialEq)]
pub struct Turn {
    /// Unit axis.
    pub axis: Vec3,
    /// Angle, rad.
    pub angle_rad: Curve,
}

/// A movement made of turns and curves.
#[derive(Clone, Debug, PartialEq)]
pub struct Path {
    /// The attitude's chain, from the world inwards.
    pub turns: Vec<Turn>,
    /// The chain's innermost, fixed rotation: segment coordinates from sensor coordinates.
    pub mounting: Quaternion,
    /// Position of the segment's origin in the world, m.
    pub position_m: [Curve; 3],
    /// From the segment's origin to the sensor, in segment coordinates (before the mounting), m.
    pub lever_arm_m: Vec3,
    /// Length of the movement, s.
    pub duration_s: f64,
}

impl Path {
    /// At rest in the identity attitude at the origin.
    pub fn still(duration_s: f64) -> Self {
        Path {
            turns: Vec::new(),
            mounting: Quaternion::IDENTITY,
            position_m: [Curve::default(), Curve::default(), Curve::default()],
            lever_arm_m: [0.0; 3],
            duration_s,
        }
    }

    /// With this yaw, pitch and roll (Z-Y-X intrinsic), rad.
    pub fn with_ypr(mut self, yaw_rad: Curve, pitch_rad: Curve, roll_rad: Curve) -> Self {
        self.turns = vec![
            Turn { axis: [0.0, 0.0, 1.0], angle_rad: yaw_rad },
            Turn { axis: [0.0, 1.0, 0.0], angle_rad: pitch_rad },
            Turn { axis: [1.0, 0.0, 0.0], angle_rad: roll_rad },
        ];
        self
    }

    /// At rest in each attitude for `rest_s`, with a turn of `turn_s` on the shortest arc to the next.
    pub fn through(attitudes: &[Quaternion], rest_s: f64, turn_s: f64) -> Self {
        let mut path = Path::still(rest_s);
        let Some(&first) = attitudes.first() else { return path };
        path.turns.push(fixed_turn(first));
        for pair in attitudes.windows(2) {
            let mut turn = fixed_turn(pair[0].conjugate().product(pair[1]));
            let angle_rad = turn.angle_rad.at(0.0).value;
            turn.angle_rad = Curve::default().step(path.duration_s, turn_s, angle_rad);
            path.turns.push(turn);
            path.duration_s += turn_s + rest_s;
        }
        path
    }
}

fn fixed_turn(rotation: Quaternion) -> Turn {
    let (axis, angle_rad) = rotation.to_axis_angle();
    Turn { axis, angle_rad: Curve::constant(angle_rad) }
}

impl Motion for Path {
    fn state(&self, time_s: f64) -> State {
        let mut q = Quaternion::IDENTITY;
        let (mut rate, mut angular_acceleration) = ([0.0; 3], [0.0; 3]);
        for turn in &self.turns {
            let angle = turn.angle_rad.at(time_s);
            let inner = Quaternion::from_rotation_vector(scale(turn.axis, angle.value));
            let inner_rate = scale(turn.axis, angle.rate);
            q = q.product(inner);
            rate = add(inner.conjugate().rotate(rate), inner_rate);
            angular_acceleration = add(
                add(inner.conjugate().rotate(angular_acceleration), cross(rate, inner_rate)),
                scale(turn.axis, angle.acceleration),
            );
        }
        let jets = [0, 1, 2].map(|axis| self.position_m[axis].at(time_s));
        let segment = State {
            world_from_body: q,
            rate_body_rad_s: rate,
            angular_acceleration_body_rad_s2: angular_acceleration,
            position_m: jets.map(|jet| jet.value),
            velocity_m_s: jets.map(|jet| jet.rate),
            acceleration_m_s2: jets.map(|jet| jet.acceleration),
        };
        let sensor_from_segment = self.mounting.conjugate();
        State {
            world_from_body: q.product(self.mounting).normalized(),
            rate_body_rad_s: sensor_from_segment.rotate(rate),
            angular_acceleration_body_rad_s2: sensor_from_segment.rotate(angular_acceleration),
            ..segment.at_lever_arm(self.lever_arm_m)
        }
    }

    fn duration_s(&self) -> f64 {
        self.duration_s
    }
}
