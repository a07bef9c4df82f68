//! The ideal sensor: its readings integrate back to the truth; gravity and the Earth's rotation are right.

use shisei_core::vector::{add, cross, norm, scale, sub};
use shisei_core::{Quaternion, Vec3};
use shisei_twin::{Motion, Path, World, ideal_imu, movements};

fn angle_between(a: Quaternion, b: Quaternion) -> f64 {
    a.conjugate().product(b).angle()
}

/// One step of the fourth-order Magnus method from the rates at the two Gauss points.
fn magnus_step(rate: impl Fn(f64) -> Vec3, t: f64, h: f64) -> Quaternion {
    let offset = h * shisei_core::math::sqrt(3.0) / 6.0;
    let (first, second) = (rate(t + 0.5 * h - offset), rate(t + 0.5 * h + offset));
    let commutator = scale(cross(first, second), shisei_core::math::sqrt(3.0) / 12.0 * h * h);
    Quaternion::from_rotation_vector(add(scale(add(first, second), 0.5 * h), commutator))
}

fn integrates_back(path: &Path) {
    let world = World::default();
    let (h, start) = (1e-3, path.state(0.0));
    let mut q = start.world_from_body;
    let (mut velocity, mut position) = (start.velocity_m_s, start.position_m);
    let steps = (path.duration_s / h).round() as usize;
    for k in 0..steps {
        let t = k as f64 * h;
        let imu = |t: f64| ideal_imu(&path.state(t), &world);
        // Acceleration at both ends and in the middle from the attitude integrated so far: Simpson's rule.
        let acceleration = |q: Quaternion, t: f64| sub(q.rotate(imu(t).0), [0.0, 0.0, world.gravity_m_s2]);
        let middle = q.product(magnus_step(|t| imu(t).1, t, 0.5 * h));
        let end = middle.product(magnus_step(|t| imu(t).1, t + 0.5 * h, 0.5 * h));
        let (a0, a1, a2) = (acceleration(q, t), acceleration(middle, t + 0.5 * h), acceleration(end, t + h));
        let average = scale(add(add(a0, scale(a1, 4.0)), a2), 1.0 / 6.0);
        position = add(position, add(scale(velocity, h), scale(add(a0, scale(a1, 2.0)), h * h / 6.0)));
        velocity = add(velocity, scale(average, h));
        q = end.normalized();
    }
    let truth = path.state(steps as f64 * h);
    assert!(angle_between(q, truth.world_from_body) < 1e-9, "attitude");
    assert!(norm(sub(velocity, truth.velocity_m_s)) < 1e-7, "velocity {velocity:?} {truth:?}");
    assert!(norm(sub(position, truth.position_m)) < 1e-7, "position {position:?} {truth:?}");
}

#[test]
fn readings_integrate_back_to_the_truth() {
    integrates_back(&movements::pelvis());
    for seed in 0..3 {
        let mut path = movements::wander(seed, 0.5, 6.0);
        path.lever_arm_m = [-0.1, 0.25, 0.05];
        integrates_back(&path);
    }
}

#[test]
fn a_resting_sensor_reads_gravity_up() {
    let (acc, gyro) = ideal_imu(&Path::still(1.0).state(0.3), &World::default());
    assert_eq!((acc, gyro), ([0.0, 0.0, 9.80665], [0.0; 3]));
    // Rolled to the left: y up.
    let mut path = Path::still(1.0);
    path.mounting = Quaternion::from_rotation_vector([core::f64::consts::FRAC_PI_2, 0.0, 0.0]);
    let (acc, _) = ideal_imu(&path.state(0.0), &World::default());
    assert!(norm(sub(acc, [0.0, 9.80665, 0.0])) < 1e-14, "{acc:?}");
}

#[test]
fn the_earth_turns_at_rest() {
    let latitude = 35.0_f64.to_radians();
    let rest = Path::still(1.0).state(0.0);
    // Facing north: the rotation points north and up; facing east, north is to the left.
    for (heading, expected) in [(0.0, [0.819_152_044, 0.0]), (90.0_f64.to_radians(), [0.0, 0.819_152_044])] {
        let (_, gyro) = ideal_imu(&rest, &World::on_earth(latitude, heading));
        let unit = scale(gyro, 1.0 / 7.292115e-5);
        assert!(norm(sub(unit, [expected[0], expected[1], 0.573_576_436])) < 1e-9, "{unit:?}");
    }
}

/// In a turning world the gyroscope integrates to the attitude relative to the stars, and specific force is
/// the second derivative of the position relative to the stars, less the centrifugal part.
#[test]
fn a_turning_world_agrees_with_the_stars() {
    let rotation = [0.2, -0.3, 0.5];
    let world = World { rotation_rad_s: rotation, ..World::default() };
    let path = movements::wander(11, 0.5, 4.0);
    let stars_from_world = |t: f64| Quaternion::from_rotation_vector(scale(rotation, t));
    let position = |t: f64| stars_from_world(t).rotate(path.state(t).position_m);

    let mut q = path.state(0.0).world_from_body;
    let h = 1e-3;
    for k in 0..5000 {
        q = q.product(magnus_step(|t| ideal_imu(&path.state(t), &world).1, f64::from(k) * h, h)).normalized();
        let t = f64::from(k + 1) * h;
        if k % 100 != 50 {
            continue;
        }
        let state = path.state(t);
        assert!(angle_between(q, stars_from_world(t).product(state.world_from_body)) < 1e-9);
        let d = 2e-3;
        let second = [0, 1, 2].map(|i| {
            let p = |k: f64| position(t + k * d)[i];
            (-p(2.0) + 16.0 * p(1.0) - 30.0 * p(0.0) + 16.0 * p(-1.0) - p(-2.0)) / (12.0 * d * d)
        });
        let centrifugal = cross(rotation, cross(rotation, state.position_m));
        let force_world = add(
            sub(stars_from_world(t).conjugate().rotate(second), centrifugal),
            [0.0, 0.0, world.gravity_m_s2],
        );
        let (acc, _) = ideal_imu(&state, &world);
        let difference = norm(sub(state.world_from_body.rotate(acc), force_world));
        assert!(difference < 1e-4, "at {t}: {difference}");
    }
}
