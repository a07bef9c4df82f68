//! What an ideal sensor reads.
//!
//! Gyroscope: the rate of the body plus the world's own rotation, in body coordinates:
//! `ω + q* Ω q`. Accelerometer: specific force `q* (a + 2 Ω × v + g ẑ) q`; the centrifugal part of the
//! Earth's rotation belongs to gravity.

use shisei_core::vector::{add, cross, scale};
use shisei_core::{STANDARD_GRAVITY_M_S2, Vec3, math};

use crate::motion::State;

/// The Earth's rotation relative to the stars, rad/s (IERS Conventions 2010, table 1.1).
pub const EARTH_RATE_RAD_S: f64 = 7.292115e-5;

/// Where the movement takes place: gravity along −z, and the rotation of the world itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct World {
    /// Gravity, m/s².
    pub gravity_m_s2: f64,
    /// Rotation of the world frame relative to the stars, world coordinates, rad/s; 0 by default.
    pub rotation_rad_s: Vec3,
}

impl Default for World {
    fn default() -> Self {
        World { gravity_m_s2: STANDARD_GRAVITY_M_S2, rotation_rad_s: [0.0; 3] }
    }
}

impl World {
    /// On the turning Earth at a latitude, with world x at `heading_rad` east of north (clockwise from above).
    pub fn on_earth(latitude_rad: f64, heading_rad: f64) -> Self {
        let (sin_latitude, cos_latitude) = math::sin_cos(latitude_rad);
        let (sin_heading, cos_heading) = math::sin_cos(heading_rad);
        let north = EARTH_RATE_RAD_S * cos_latitude;
        World {
            rotation_rad_s: [north * cos_heading, north * sin_heading, EARTH_RATE_RAD_S * sin_latitude],
            ..World::default()
        }
    }
}

/// Specific force, m/s², and angular rate, rad/s, both in body coordinates.
pub fn ideal_imu(state: &State, world: &World) -> (Vec3, Vec3) {
    let body_from_world = state.world_from_body.conjugate();
    let coriolis = scale(cross(world.rotation_rad_s, state.velocity_m_s), 2.0);
    let force = add(add(state.acceleration_m_s2, coriolis), [0.0, 0.0, world.gravity_m_s2]);
    (body_from_world.rotate(force), add(state.rate_body_rad_s, body_from_world.rotate(world.rotation_rad_s)))
}
