//! How a sensor sits on a body that cameras see, and which way is up there: what carries poses of the body over to
//! the sensor in a level world and back, and readings over to what a filter without priors may take.

use crate::estimator::OpticalPose;
use crate::frames::Pose;
use crate::matrix::times_vector;
use crate::quaternion::Quaternion;
use crate::sync::lever::Lever;
use crate::sync::rates::Sync;
use crate::vector::{self, Vec3};

/// A vertical that is known less well than this is not used, rad (1°).
const UP_SIGMA_RAD: f64 = 0.0175;

/// Mounting, lever arm, sensor errors and vertical.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Alignment {
    /// Turns sensor coordinates into body coordinates.
    pub body_from_sensor: Quaternion,
    /// The sensor in body coordinates, m.
    pub sensor_m: Vec3,
    /// The gyroscope's bias, sensor coordinates, rad/s.
    pub gyro_bias_rad_s: Vec3,
    /// 1 + E: body rates from turned gyroscope rates.
    pub gyro_matrix: [Vec3; 3],
    /// The accelerometer's bias, sensor coordinates, m/s².
    pub acc_bias_m_s2: Vec3,
    /// Up in the optical world, unit length.
    pub up: Vec3,
    /// Gravity's size, m/s².
    pub gravity_m_s2: f64,
}

impl Default for Alignment {
    /// The sensor's axes are the body's, nothing is known of its errors, z is up.
    fn default() -> Self {
        Alignment {
            body_from_sensor: Quaternion::IDENTITY,
            sensor_m: [0.0; 3],
            gyro_bias_rad_s: [0.0; 3],
            gyro_matrix: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            acc_bias_m_s2: [0.0; 3],
            up: [0.0, 0.0, 1.0],
            gravity_m_s2: crate::STANDARD_GRAVITY_M_S2,
        }
    }
}

impl Alignment {
    /// From what synchronisation and the lever arm's search found; `up` and gravity where the latter did not.
    pub fn found(sync: &Sync, lever: Option<&Lever>, up: Vec3, gravity_m_s2: f64) -> Self {
        let known = lever.filter(|lever| lever.sigma_up_rad < UP_SIGMA_RAD);
        Alignment {
            body_from_sensor: sync.body_from_sensor,
            sensor_m: lever.map_or([0.0; 3], |lever| lever.sensor_m),
            gyro_bias_rad_s: sync.gyro_bias_rad_s,
            gyro_matrix: sync.gyro_matrix,
            acc_bias_m_s2: known.map_or([0.0; 3], |lever| lever.acc_bias_m_s2),
            up: known.map_or(up, |lever| lever.up),
            gravity_m_s2: known.map_or(gravity_m_s2, |lever| lever.gravity_m_s2),
        }
    }

    /// The sensor of a body, in the level world.
    pub fn sensor(&self, pose: &Pose) -> OpticalPose {
        let (level, q) = (self.level(), pose.world_from_body);
        OpticalPose {
            world_from_body: level.product(q).product(self.body_from_sensor).normalized(),
            position_m: level.rotate(vector::add(pose.position_m, q.rotate(self.sensor_m))),
        }
    }

    /// The body of a sensor in the level world.
    pub fn body(&self, sensor: &OpticalPose) -> Pose {
        let back = self.level().conjugate();
        let q = back.product(sensor.world_from_body).product(self.body_from_sensor.conjugate()).normalized();
        let origin = vector::sub(back.rotate(sensor.position_m), q.rotate(self.sensor_m));
        Pose { position_m: origin, world_from_body: q }
    }

    /// A marker at a place on the body, m, body axes, seen somewhere, m, optical world: its arm from the sensor,
    /// sensor axes, and where it is in the level world.
    pub(crate) fn marker(&self, at_m: Vec3, seen_m: Vec3) -> (Vec3, Vec3) {
        let arm_m = self.body_from_sensor.conjugate().rotate(vector::sub(at_m, self.sensor_m));
        (arm_m, self.level().rotate(seen_m))
    }

    /// A rate without what is known of the gyroscope's errors, sensor coordinates, rad/s.
    pub fn rate(&self, gyro_rad_s: Vec3) -> Vec3 {
        let body = self.body_from_sensor.rotate(vector::sub(gyro_rad_s, self.gyro_bias_rad_s));
        self.body_from_sensor.conjugate().rotate(times_vector(&self.gyro_matrix, &body))
    }

    /// A specific force without the accelerometer's bias, sensor coordinates, m/s².
    pub fn force(&self, acc_m_s2: Vec3) -> Vec3 {
        vector::sub(acc_m_s2, self.acc_bias_m_s2)
    }

    /// Turns the optical world level.
    fn level(&self) -> Quaternion {
        level(self.up)
    }
}

/// The shortest turn that brings up, a unit vector, to z.
pub(crate) fn level(up: Vec3) -> Quaternion {
    let axis = vector::cross(up, [0.0, 0.0, 1.0]);
    if up[2] < -0.999_999 {
        return Quaternion::new(0.0, 1.0, 0.0, 0.0);
    }
    Quaternion::new(1.0 + up[2], axis[0], axis[1], axis[2]).normalized()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_and_back() {
        let alignment = Alignment {
            body_from_sensor: Quaternion::new(0.5, -0.1, 0.7, 0.2).normalized(),
            sensor_m: [0.03, -0.02, 0.01],
            up: [0.0, 1.0, 0.0],
            ..Alignment::default()
        };
        let pose = Pose {
            position_m: [0.1, 1.2, -0.4],
            world_from_body: Quaternion::new(0.2, 0.4, -0.3, 0.8).normalized(),
        };
        let sensor = alignment.sensor(&pose);
        // y up: what is 1.2 m high in the optical world is so in the level one, but for the arm
        assert!((sensor.position_m[2] - 1.2).abs() < 0.04);
        let back = alignment.body(&sensor);
        assert!(vector::norm(vector::sub(back.position_m, pose.position_m)) < 1e-15);
        assert!(back.world_from_body.conjugate().product(pose.world_from_body).angle() < 1e-15);
    }

    #[test]
    fn readings_lose_their_errors() {
        let mut alignment = Alignment { gyro_bias_rad_s: [0.1, 0.0, 0.0], ..Alignment::default() };
        alignment.gyro_matrix[2][2] = 2.0;
        alignment.body_from_sensor = Quaternion::from_rotation_vector([core::f64::consts::PI, 0.0, 0.0]);
        let rate = alignment.rate([0.3, 0.0, 1.0]);
        assert!(vector::norm(vector::sub(rate, [0.2, 0.0, 2.0])) < 1e-15, "{rate:?}");
    }
}
