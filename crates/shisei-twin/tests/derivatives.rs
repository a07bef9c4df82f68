//! Exact derivatives against finite differences of eighth order.

use shisei_core::vector::{norm, scale, sub};
use shisei_core::{Quaternion, Vec3};
use shisei_twin::{Curve, Motion, Path, Random, movements};

/// f′ by central differences of eighth order.
fn derivative<const N: usize>(f: impl Fn(f64) -> [f64; N], t: f64, h: f64) -> [f64; N] {
    let weights = [4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0];
    let mut sum = [0.0; N];
    for (k, weight) in weights.iter().enumerate() {
        let step = (k + 1) as f64 * h;
        let (after, before) = (f(t + step), f(t - step));
        for i in 0..N {
            sum[i] += weight * (after[i] - before[i]) / h;
        }
    }
    sum
}

fn assert_near(what: &str, t: f64, exact: Vec3, differences: Vec3, tolerance: f64) {
    let error = norm(sub(exact, differences));
    assert!(
        error < tolerance,
        "{what} at {t} s: {exact:?}, by differences {differences:?}, off by {error:e}"
    );
}

#[test]
fn curves() {
    let curve = Curve::constant(0.3).step(0.5, 1.5, -2.0).sine(0.7, 0.8, 0.2).step(1.0, 2.0, 0.9);
    let product = curve.clone().times(Curve::default().bump(0.2, 1.0, 0.6, 1.3));
    for f in [curve, product] {
        for k in 0..300 {
            let t = 0.0101 * f64::from(k);
            let jet = f.at(t);
            let [rate] = derivative(|t| [f.at(t).value], t, 1e-3);
            let [acceleration] = derivative(|t| [f.at(t).rate], t, 1e-3);
            // 1e-7: only where the stencil straddles a knot, whose fourth derivative jumps.
            assert!((jet.rate - rate).abs() < 1e-7, "rate at {t}: {} and {rate}", jet.rate);
            assert!((jet.acceleration - acceleration).abs() < 1e-4, "acceleration at {t}");
        }
    }
}

#[test]
fn a_transition_begins_and_ends_where_it_says() {
    let f = Curve::constant(1.0).step(2.0, 0.5, 3.0);
    for (t, value) in [(0.0, 1.0), (2.0, 1.0), (2.25, 2.5), (2.5, 4.0), (9.0, 4.0)] {
        assert!((f.at(t).value - value).abs() < 1e-14, "at {t}");
    }
    for t in [2.0, 2.5] {
        assert_eq!((f.at(t).rate, f.at(t).acceleration), (0.0, 0.0));
    }
}

fn check_path(name: &str, path: &Path) {
    let mut random = Random::new(7, 0);
    for _ in 0..400 {
        let t = random.between(0.0, path.duration_s);
        let state = path.state(t);
        let h = 1e-3;
        let q = state.world_from_body;
        assert!((q.norm_squared() - 1.0).abs() < 1e-14);

        // ω = 2 q* q̇
        let q_dot = derivative(|t| path.state(t).world_from_body.to_array(), t, h);
        let rate = q.conjugate().product(Quaternion::from_array(q_dot));
        let rate = scale([rate.x, rate.y, rate.z], 2.0);
        assert_near(&format!("{name}: rate"), t, state.rate_body_rad_s, rate, 2e-6);

        let angular = derivative(|t| path.state(t).rate_body_rad_s, t, h);
        assert_near(
            &format!("{name}: angular acceleration"),
            t,
            state.angular_acceleration_body_rad_s2,
            angular,
            2e-3,
        );
        let velocity = derivative(|t| path.state(t).position_m, t, h);
        assert_near(&format!("{name}: velocity"), t, state.velocity_m_s, velocity, 1e-6);
        let acceleration = derivative(|t| path.state(t).velocity_m_s, t, h);
        assert_near(&format!("{name}: acceleration"), t, state.acceleration_m_s2, acceleration, 1e-3);
    }
}

#[test]
fn paths() {
    check_path("pelvis", &movements::pelvis());
    let tilts = movements::random_tilts(&mut Random::new(3, 0), 0.08);
    check_path("six faces", &movements::six_faces(1.0, 1.5, &tilts));
    check_path("poses", &movements::random_poses(&mut Random::new(4, 0), 6, 0.5, 1.0));
    for seed in 0..4 {
        let mut path = movements::wander(seed, 1.0, 8.0);
        path.lever_arm_m = [0.1, -0.2, 0.3];
        check_path("wander", &path);
    }
}

/// Away from the knots of its transitions a movement is analytic and the differences agree to rounding.
#[test]
fn analytic_movements_agree_to_rounding() {
    let curve = |a: f64, f: f64| Curve::constant(0.2).sine(a, f, 0.4 * a);
    let mut path = Path::still(10.0).with_ypr(curve(2.0, 0.31), curve(1.1, 0.47), curve(2.5, 0.23));
    path.position_m = [curve(0.4, 0.5), curve(0.3, 0.7), curve(0.1, 0.9)];
    path.lever_arm_m = [0.2, 0.1, -0.3];
    path.mounting = Quaternion::from_rotation_vector([0.3, -1.0, 0.7]);
    for k in 0..200 {
        let t = 0.05 * f64::from(k);
        let state = path.state(t);
        let q_dot = derivative(|t| path.state(t).world_from_body.to_array(), t, 2e-3);
        let rate = state.world_from_body.conjugate().product(Quaternion::from_array(q_dot));
        assert_near("rate", t, state.rate_body_rad_s, scale([rate.x, rate.y, rate.z], 2.0), 1e-11);
        let angular = derivative(|t| path.state(t).rate_body_rad_s, t, 2e-3);
        assert_near("angular acceleration", t, state.angular_acceleration_body_rad_s2, angular, 1e-10);
        let acceleration = derivative(|t| path.state(t).velocity_m_s, t, 2e-3);
        assert_near("acceleration", t, state.acceleration_m_s2, acceleration, 1e-10);
    }
}

#[test]
fn yaw_pitch_roll_are_those_of_the_core() {
    let ypr = [0.7, -0.4, 1.9];
    let path =
        Path::still(1.0).with_ypr(Curve::constant(ypr[0]), Curve::constant(ypr[1]), Curve::constant(ypr[2]));
    let back = path.state(0.5).world_from_body.to_ypr().to_array();
    for i in 0..3 {
        assert!((back[i] - ypr[i]).abs() < 1e-14, "{back:?}");
    }
}
