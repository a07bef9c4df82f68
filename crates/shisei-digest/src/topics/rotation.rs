//! Mathematics, vectors, quaternions, angles.

use shisei_core::frames::{Axes, Pose};
use shisei_core::{Quaternion, Result, Ypr, heading, math, relative, vector};

use crate::hash::Digest;
use crate::input::Input;

/// Arguments where libraries differ: tiny, near multiples of π/2, huge.
const ARGUMENTS: [f64; 16] = [
    0.0,
    5e-324,
    2.2e-308,
    1e-20,
    1e-9,
    0.24999999999999997,
    core::f64::consts::FRAC_PI_4,
    1.0,
    core::f64::consts::FRAC_PI_2,
    core::f64::consts::PI,
    10.0,
    355.0,
    1e5,
    1.6e9,
    1e22,
    1e300,
];

pub fn math(digest: &mut Digest) {
    let mut input = Input::new(1);
    for round in 0..512 {
        let x = if round < ARGUMENTS.len() { ARGUMENTS[round] } else { 20.0 * input.signed() };
        for x in [x, -x] {
            let (sin, cos) = math::sin_cos(x);
            digest.push_all(&[sin, cos, math::sin(x), math::cos(x), math::tan(x)]);
            digest.push_all(&[math::sqrt(x), math::exp(x), math::ln(x), math::asin(x), math::acos(x)]);
            digest.push_all(&[math::asin(x / 20.0), math::acos(x / 20.0), math::exp(x / 20.0)]);
            digest.push_all(&[math::round(x), math::floor(x), math::abs(x)]);
            let y = input.signed();
            digest.push_all(&[math::atan2(y, x), math::atan2(x, y), math::hypot(x, y)]);
        }
    }
}

pub fn vector(digest: &mut Digest) {
    let mut input = Input::new(2);
    for _ in 0..256 {
        let (a, b, s) = (input.vec3(10.0), input.vec3(1.0), input.signed());
        digest.push_vec3(vector::add(a, b));
        digest.push_vec3(vector::sub(a, b));
        digest.push_vec3(vector::scale(a, s));
        digest.push_vec3(vector::cross(a, b));
        digest.push_all(&[vector::dot(a, b), vector::norm(a)]);
    }
}

pub fn quaternion(digest: &mut Digest) {
    let mut input = Input::new(3);
    for _ in 0..256 {
        let (a, b, v) = (input.quaternion(), input.quaternion(), input.vec3(10.0));
        let t = input.signed();
        digest.push_quaternion(a.product(b));
        digest.push_quaternion(a.product(b).normalized());
        digest.push_quaternion(a.conjugate());
        digest.push_vec3(a.rotate(v));
        digest.push_vec3(a.up_body());
        digest.push_vec3(a.to_rotation_vector());
        let (axis, angle_rad) = a.to_axis_angle();
        digest.push_vec3(axis);
        digest.push_all(&[angle_rad, a.angle(), a.norm_squared()]);
        digest.push_quaternion(Quaternion::from_rotation_vector(v));
        digest.push_quaternion(Quaternion::from_rotation_vector(vector::scale(v, 1e-9)));
        digest.push_quaternion(Quaternion::slerp(a, b, t));
        digest.push_quaternion(Quaternion::nlerp(a, b, 0.5 + 0.5 * t));
        digest.push_result(Quaternion::from_axis_angle(v, 7.0 * t), Digest::push_quaternion);
        let matrix = a.to_matrix();
        for row in matrix {
            digest.push_vec3(row);
        }
        digest.push_result(Quaternion::from_matrix(matrix), Digest::push_quaternion);
    }
    for q in [[0.0; 4], [1e200, 1e200, 0.0, 0.0], [1e-200, 0.0, 3e-200, 0.0], [f64::NAN, 0.0, 0.0, 1.0]] {
        digest.push_result(Quaternion::from_array(q).try_normalized(), Digest::push_quaternion);
    }
    digest.push_result(Quaternion::from_axis_angle([0.0; 3], 1.0), Digest::push_quaternion);
    digest.push_result(Quaternion::from_matrix([[1.0; 3]; 3]), Digest::push_quaternion);
}

pub fn euler(digest: &mut Digest) {
    let mut input = Input::new(4);
    for round in 0..256 {
        let [yaw_rad, pitch_rad, roll_rad] = input.vec3(3.0);
        // every eighth near gimbal lock, every sixteenth in it
        let pitch_rad = match round % 16 {
            0 => core::f64::consts::FRAC_PI_2,
            8 => -core::f64::consts::FRAC_PI_2 + 1e-9 * pitch_rad,
            _ => pitch_rad,
        };
        let q = Quaternion::from_ypr(Ypr { yaw_rad, pitch_rad, roll_rad });
        digest.push_quaternion(q);
        digest.push_ypr(q.to_ypr());
        digest.push_ypr(input.quaternion().to_ypr());
    }
}

pub fn relative(digest: &mut Digest) {
    let mut input = Input::new(5);
    let initial = input.quaternion();
    let rows: [Quaternion; 64] = core::array::from_fn(|_| input.quaternion());
    for q in rows {
        digest.push_result(relative::body(q, initial), Digest::push_quaternion);
        digest.push_result(relative::world(q, initial), Digest::push_quaternion);
    }
    series(digest, |out| relative::body_series(&rows, initial, out));
    series(digest, |out| relative::world_series(&rows, initial, out));
    series(digest, |out| relative::convert_series(&rows, out));
    let mut turned = [[0.0; 3]; 64];
    let done = relative::rotate_series(&rows, input.vec3(3.0), &mut turned);
    digest.push_result(done, |digest, ()| digest.push_all(turned.as_flattened()));
    let angles: [[f64; 3]; 64] = core::array::from_fn(|_| input.vec3(3.0));
    let mut back = [Quaternion::IDENTITY; 64];
    let done = relative::from_ypr_series(&angles, &mut back);
    digest.push_result(done, |digest, ()| back.into_iter().for_each(|q| digest.push_quaternion(q)));
}

/// Yaw, pitch and roll of what a series function writes.
fn series(digest: &mut Digest, write: impl FnOnce(&mut [Ypr; 64]) -> Result<()>) {
    let mut out = [Ypr::from_array([0.0; 3]); 64];
    let done = write(&mut out);
    digest.push_result(done, |digest, ()| out.into_iter().for_each(|ypr| digest.push_ypr(ypr)));
}

pub fn heading(digest: &mut Digest) {
    let mut input = Input::new(6);
    for _ in 0..128 {
        let (q, axis) = (input.quaternion(), input.vec3(1.0));
        digest.push_result(heading::from_forward_axis(q, axis), Digest::push_quaternion);
        digest.push_u64(u64::from(heading::is_near_gimbal_lock(q)));
    }
    digest.push_result(
        heading::from_forward_axis(Quaternion::IDENTITY, [0.0, 0.0, 1.0]),
        Digest::push_quaternion,
    );
}

pub fn frames(digest: &mut Digest) {
    let mut input = Input::new(7);
    for _ in 0..32 {
        let pose = Pose { position_m: input.vec3(10.0), world_from_body: input.quaternion() };
        for from in Axes::ALL {
            for to in Axes::ALL {
                let change = from.to(to);
                let moved = change.pose(pose);
                digest.push_vec3(moved.position_m);
                digest.push_quaternion(moved.world_from_body);
                digest.push_vec3(change.axial(pose.position_m));
                digest.push_result(change.world_of_pose(pose), |digest, pose| {
                    digest.push_quaternion(pose.world_from_body);
                });
            }
        }
    }
}
