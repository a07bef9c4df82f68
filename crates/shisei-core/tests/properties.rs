//! Properties that hold for all inputs.
#![cfg(feature = "alloc")]

use proptest::prelude::*;
use shisei_core::calibration::{SixFaceSettings, six_face};
use shisei_core::filter::{
    AdaptiveGain, Complementary, Dt, Filter, GyroIntegrator, GyroOnly, GyroRk4, Mahony, MahonyAdaptive, run,
    run_gyro, run_into,
};
use shisei_core::motion::{DeadReckoning, Scheme};
use shisei_core::rest::{RestSettings, find_rests};
use shisei_core::{Error, Quaternion, Vec3, heading, initial, relative, vector};

fn vec3(size: f64) -> impl Strategy<Value = Vec3> {
    prop::array::uniform3(-size..size)
}

fn unit_quaternion() -> impl Strategy<Value = Quaternion> {
    prop::array::uniform4(-1.0..1.0_f64)
        .prop_filter("away from zero", |q| q.iter().map(|x| x * x).sum::<f64>() > 1e-2)
        .prop_map(|q| Quaternion::from_array(q).try_normalized().unwrap())
}

/// Any bits at all, with the awkward ones made common.
fn any_number() -> impl Strategy<Value = f64> {
    prop_oneof![
        any::<f64>(),
        -20.0..20.0_f64,
        Just(0.0),
        Just(f64::NAN),
        Just(f64::INFINITY),
        Just(f64::NEG_INFINITY),
        Just(f64::MAX),
        Just(-f64::MAX),
        Just(f64::MIN_POSITIVE),
        Just(5e-324),
    ]
}

fn finite_number() -> impl Strategy<Value = f64> {
    any_number().prop_map(|x| if x.is_finite() { x } else { 1e308 })
}

fn close(a: Quaternion, b: Quaternion, limit: f64) -> bool {
    let (a, b) = (a.to_array(), b.to_array());
    (0..4).all(|k| (a[k] - b[k]).abs() <= limit)
}

fn filters(start: Quaternion, kp: f64, ki: f64) -> Vec<(&'static str, Box<dyn Filter>)> {
    let gain = AdaptiveGain { kp_max: kp + 0.1, ..AdaptiveGain::default() };
    vec![
        ("gyro", Box::new(GyroIntegrator::new(start).unwrap())),
        ("gyro-rk4", Box::new(GyroRk4::new(start).unwrap())),
        ("mahony", Box::new(Mahony::new(start, kp, ki).unwrap())),
        ("mahony-adaptive", Box::new(MahonyAdaptive::new(start, gain, ki, 9.80665).unwrap())),
        ("complementary", Box::new(Complementary::new(start, 0.98, 9.80665).unwrap())),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn inverse_and_composition(a in unit_quaternion(), b in unit_quaternion(), c in unit_quaternion(), v in vec3(10.0)) {
        prop_assert!(close(a.product(a.conjugate()), Quaternion::IDENTITY, 1e-15));
        let (left, right) = (a.product(b).product(c), a.product(b.product(c)));
        prop_assert!(close(left, right, 4e-15));
        let (once, twice) = (a.product(b).rotate(v), a.rotate(b.rotate(v)));
        prop_assert!(vector::norm(vector::sub(once, twice)) <= 5e-14);
        prop_assert!((a.product(b).norm_squared() - 1.0).abs() <= 2e-15);
    }

    #[test]
    fn frames_go_there_and_back(q in unit_quaternion(), v in vec3(10.0)) {
        let back = q.conjugate().rotate(q.rotate(v));
        prop_assert!(vector::norm(vector::sub(back, v)) <= 5e-14);
        let again = Quaternion::from_matrix(q.to_matrix()).unwrap();
        prop_assert!(close(again, q, 2e-15) || close(again, q.negated(), 4e-15));
        let again = Quaternion::from_rotation_vector(q.to_rotation_vector());
        prop_assert!(close(again, q, 2e-15) || close(again, q.negated(), 4e-15));
        let again = Quaternion::from_ypr(q.to_ypr());
        prop_assert!(close(again, q, 4e-15) || close(again, q.negated(), 4e-15));
    }

    #[test]
    fn relative_attitudes(q in unit_quaternion(), start in unit_quaternion(), turn in unit_quaternion()) {
        let world = relative::world(q, start).unwrap();
        let body = relative::body(q, start).unwrap();
        prop_assert!(close(world.product(start), q, 4e-15));
        prop_assert!(close(start.product(body), q, 4e-15));
        // the body's view does not depend on the world's choice of axes, the world's not on the mounting
        prop_assert!(close(relative::body(turn.product(q), turn.product(start)).unwrap(), body, 4e-15));
        prop_assert!(close(relative::world(q.product(turn), start.product(turn)).unwrap(), world, 4e-15));
        let mut rows = [[0.0; 4]; 2];
        relative::world_series(&[start, q], start, &mut rows).unwrap();
        prop_assert!(close(Quaternion::from_array(rows[0]), Quaternion::IDENTITY, 1e-15));
        prop_assert_eq!(rows[1], world.to_array());
    }

    #[test]
    fn initial_attitude_points_up(acc in vec3(20.0)) {
        prop_assume!(vector::norm(acc) > 1e-3);
        let q = initial::from_mean_acceleration(acc).unwrap();
        let up = q.rotate(acc);
        prop_assert!(up[0].abs() < 1e-13 && up[1].abs() < 1e-13 && up[2] > 0.0);
    }

    #[test]
    fn forward_axis_points_along_x(q in unit_quaternion(), axis in vec3(3.0)) {
        match heading::from_forward_axis(q, axis) {
            Ok(turn) => {
                let forward = turn.product(q).rotate(axis);
                prop_assert!(forward[0] > 0.0 && forward[1].abs() < 1e-14);
                prop_assert!((forward[2] - q.rotate(axis)[2]).abs() < 1e-14);
            }
            Err(error) => {
                let near = matches!(error, Error::AxisNearVertical { angle_rad } if angle_rad < 0.1746);
                prop_assert!(near, "{error}");
            }
        }
    }

    #[test]
    fn unit_norm_after_many_steps(
        start in unit_quaternion(), kp in 0.0..5.0, ki in 0.0..1.0, rate in 0.0..40.0,
        rows in prop::collection::vec((vec3(1.0), vec3(20.0), 1e-4..0.05), 1..200),
    ) {
        for (name, mut filter) in filters(start, kp, ki) {
            for &(gyro, acc, dt_s) in &rows {
                let q = filter.update(vector::scale(gyro, rate), acc, dt_s);
                prop_assert!((q.norm_squared() - 1.0).abs() <= 4e-15, "{name} {q:?}");
            }
        }
    }

    #[test]
    fn series_are_streaming_bit_for_bit(
        start in unit_quaternion(), kp in 0.0..5.0, ki in prop_oneof![Just(0.0), 0.0..1.0],
        rows in prop::collection::vec((vec3(30.0), vec3(20.0), 1e-4..0.05), 1..300),
    ) {
        let gyro: Vec<Vec3> = rows.iter().map(|row| row.0).collect();
        let acc: Vec<Vec3> = rows.iter().map(|row| row.1).collect();
        let dt_s: Vec<f64> = rows.iter().map(|row| row.2).collect();
        for dt in [Dt::Constant(0.01), Dt::PerSample(&dt_s)] {
            for ((name, mut series), (_, mut stream)) in filters(start, kp, ki).into_iter().zip(filters(start, kp, ki)) {
                let all: Vec<Quaternion> = run(&mut *series, &gyro, &acc, dt).unwrap();
                let mut angles = vec![[0.0; 3]; gyro.len()];
                run_into(&mut *filters(start, kp, ki).into_iter().find(|f| f.0 == name).unwrap().1, &gyro, &acc, dt, &mut angles).unwrap();
                for (k, q) in all.iter().enumerate() {
                    prop_assert_eq!(*q, stream.update(gyro[k], acc[k], dt.at(k)), "{} {}", name, k);
                    prop_assert_eq!(angles[k], q.to_ypr().to_array());
                }
                prop_assert_eq!(series.orientation(), stream.orientation());
            }
            let mut mahony = Mahony::new(start, kp, ki).unwrap();
            let direct: Vec<[f64; 4]> = run(&mut mahony, &gyro, &acc, dt).unwrap();
            let mut boxed = filters(start, kp, ki).remove(2).1;
            let through_a_box: Vec<[f64; 4]> = run(&mut boxed, &gyro, &acc, dt).unwrap();
            prop_assert_eq!(direct, through_a_box);
            let mut integrator = GyroIntegrator::new(start).unwrap();
            let out: Vec<Quaternion> = run_gyro(&mut integrator, &gyro, dt).unwrap();
            let mut stream = GyroIntegrator::new(start).unwrap();
            for (k, q) in out.iter().enumerate() {
                prop_assert_eq!(*q, stream.update_gyro(gyro[k], dt.at(k)));
            }
        }
    }

    /// Whatever comes, the state stays a rotation, and good samples afterwards are used.
    #[test]
    fn hostile_samples_never_poison(
        start in unit_quaternion(), kp in 0.0..5.0, ki in prop_oneof![Just(0.0), 0.0..1e308],
        rows in prop::collection::vec(prop::array::uniform7(any_number()), 1..40),
    ) {
        for (name, mut filter) in filters(start, kp, ki) {
            for row in &rows {
                let (gyro, acc) = ([row[0], row[1], row[2]], [row[3], row[4], row[5]]);
                let before = filter.orientation();
                let q = filter.update(gyro, acc, row[6]);
                prop_assert!(q.is_finite() && (q.norm_squared() - 1.0).abs() < 1e-14, "{name} {row:?} {q:?}");
                if !vector::is_finite(gyro) || !row[6].is_finite() || row[6] <= 0.0 {
                    prop_assert!(close(q, before, 1e-15), "{name} {row:?}");
                }
            }
            if ki == 0.0 {
                let before = filter.orientation();
                let turned = filter.update([0.0, 0.0, 1.0], [0.0; 3], 0.1);
                let turn = before.conjugate().product(turned).angle();
                prop_assert!((turn - 0.1).abs() < 1e-8, "{name} {turn}");
            }
        }
        for scheme in [Scheme::SemiImplicit, Scheme::Euler, Scheme::Trapezoid] {
            let mut dead = DeadReckoning::new(start, [0.0; 3], 9.8, scheme).unwrap();
            for row in &rows {
                let state = dead.update([row[0], row[1], row[2]], [row[3], row[4], row[5]], row[6]);
                prop_assert!(vector::is_finite(state.velocity_m_s) && vector::is_finite(state.position_m));
                prop_assert!(state.world_from_body.is_finite());
            }
        }
    }

    /// The series functions take any finite numbers, or refuse; no NaN comes out.
    #[test]
    fn validated_calls_never_give_nan(
        start in prop::array::uniform4(any_number()), settings in prop::array::uniform8(any_number()),
        rows in prop::collection::vec(prop::array::uniform6(finite_number()), 0..40), dt_s in any_number(),
    ) {
        let start = Quaternion::from_array(start);
        let gyro: Vec<Vec3> = rows.iter().map(|row| [row[0], row[1], row[2]]).collect();
        let acc: Vec<Vec3> = rows.iter().map(|row| [row[3], row[4], row[5]]).collect();
        let gain = AdaptiveGain {
            kp_max: settings[0], kp_min: settings[1], upper_start: settings[2], upper_end: settings[3],
            lower_start: settings[4], lower_end: settings[5],
        };
        let mut made: Vec<Box<dyn Filter>> = Vec::new();
        if let Ok(filter) = Mahony::new(start, settings[0], settings[6]) { made.push(Box::new(filter)); }
        if let Ok(filter) = MahonyAdaptive::new(start, gain, settings[6], settings[7]) { made.push(Box::new(filter)); }
        if let Ok(filter) = Complementary::new(start, settings[0], settings[7]) { made.push(Box::new(filter)); }
        if let Ok(filter) = GyroIntegrator::new(start) { made.push(Box::new(filter)); }
        if let Ok(filter) = GyroRk4::new(start) { made.push(Box::new(filter)); }
        for mut filter in made {
            if let Ok(out) = run::<_, Quaternion>(&mut *filter, &gyro, &acc, Dt::Constant(dt_s)) {
                prop_assert!(out.iter().all(|q| q.is_finite() && (q.norm_squared() - 1.0).abs() < 1e-14));
            }
        }
        if let Ok(kp) = gain.kp(settings[6], settings[7]) {
            prop_assert!(kp >= gain.kp_min && kp <= gain.kp_max, "{kp}");
        }
        if let Ok(rests) = find_rests(&acc, &gyro, Dt::Constant(dt_s), &RestSettings::default()) {
            prop_assert!(rests.iter().all(|rest| rest.start < rest.end && rest.end <= acc.len()));
        }
        if let Ok(found) = six_face(&acc, &gyro, dt_s, &SixFaceSettings::default()) {
            prop_assert!(found.calibration.to_twelve().iter().all(|x| x.is_finite()));
        }
        for points in [&gyro, &acc] {
            if let Ok(fit) = shisei_core::sphere::fit_sphere(points) {
                prop_assert!(fit.radius.is_finite() && vector::is_finite(fit.center), "{fit:?}");
            }
            if let Ok(fit) = shisei_core::sphere::fit_circle(points) {
                prop_assert!(fit.radius.is_finite() && vector::is_finite(fit.center), "{fit:?}");
            }
        }
    }
}

/// The row of the first bad number is named.
#[test]
fn refusals_name_the_row() {
    let mut gyro = vec![[0.0; 3]; 300];
    let mut acc = vec![[0.0, 0.0, 9.8]; 300];
    let mut filter = Mahony::new(Quaternion::IDENTITY, 1.0, 0.0).unwrap();
    acc[257][2] = f64::INFINITY;
    let out = run::<_, Quaternion>(&mut filter, &gyro, &acc, Dt::Constant(0.01));
    assert_eq!(out, Err(Error::NotFinite { row: 257 }));
    gyro[3][0] = f64::NAN;
    assert_eq!(
        run::<_, Quaternion>(&mut filter, &gyro, &acc, Dt::Constant(0.01)),
        Err(Error::NotFinite { row: 3 })
    );
    let out = run::<_, Quaternion>(&mut filter, &gyro[..2], &acc[..2], Dt::PerSample(&[0.01, f64::NAN]));
    assert_eq!(out, Err(Error::NotFinite { row: 1 }));
    let out = run::<_, Quaternion>(&mut filter, &gyro[..2], &acc[..2], Dt::Constant(0.0));
    assert!(matches!(out, Err(Error::NotPositive { name: "dt", .. })));
}
