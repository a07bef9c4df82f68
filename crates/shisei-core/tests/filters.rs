//! Each filter against its equations written out plainly, and against what is known of its behaviour.
#![cfg(feature = "alloc")]
#![allow(clippy::disallowed_methods)] // the plain forms use the platform's mathematics

use shisei_core::filter::{
    AdaptiveGain, Complementary, Dt, Filter, GyroIntegrator, GyroOnly, GyroRk4, Mahony, MahonyAdaptive, run,
    run_gyro,
};
use shisei_core::{Error, Quaternion, Vec3, Ypr, initial, vector};

fn error(a: Quaternion, b: Quaternion) -> f64 {
    a.conjugate().product(b).angle()
}

/// A tumbling sensor: rates up to 6 rad/s, accelerations between 0.3 and 2 g, every 50th zero.
fn tumbling(rows: usize) -> (Vec<Vec3>, Vec<Vec3>) {
    let acc = |k: usize| {
        let t = k as f64 * 0.01;
        if k % 50 == 49 {
            return [0.0; 3];
        }
        let size = 11.0 + 8.0 * (0.7 * t).sin();
        vector::scale([t.sin(), (1.3 * t).cos(), 1.0 + 0.5 * (2.1 * t).sin()], 0.5 * size)
    };
    let gyro = |k: usize| {
        let t = k as f64 * 0.01;
        [6.0 * (0.9 * t).sin(), 3.0 * (1.7 * t).cos(), 0.4]
    };
    ((0..rows).map(gyro).collect(), (0..rows).map(acc).collect())
}

fn start() -> Quaternion {
    Quaternion::new(0.5, -0.5, 0.1, 0.7).try_normalized().unwrap()
}

/// q ← normalise(q ⊗ exp(ω dt/2)) with sine and cosine.
fn plain_turn(q: Quaternion, rate: Vec3, dt_s: f64) -> Quaternion {
    let half = vector::scale(rate, 0.5 * dt_s);
    let angle = half.iter().map(|x| x * x).sum::<f64>().sqrt();
    let s = if angle == 0.0 { 1.0 } else { angle.sin() / angle };
    q.product(Quaternion::new(angle.cos(), s * half[0], s * half[1], s * half[2])).normalized()
}

struct PlainMahony {
    q: Quaternion,
    integral: Vec3,
}

impl PlainMahony {
    fn update(&mut self, gyro: Vec3, acc: Vec3, dt_s: f64, kp: f64, ki: f64) {
        let norm = vector::norm(acc);
        let mut rate = gyro;
        let mut e = [0.0; 3];
        if norm > 0.0 {
            let up = self.q.conjugate().rotate([0.0, 0.0, 1.0]);
            e = vector::cross(vector::scale(acc, 1.0 / norm), up);
        }
        for axis in 0..3 {
            self.integral[axis] += ki * e[axis] * dt_s;
            rate[axis] += kp * e[axis] + self.integral[axis];
        }
        self.q = plain_turn(self.q, rate, dt_s);
    }
}

#[test]
fn mahony_is_its_equations() {
    let (gyro, acc) = tumbling(3000);
    // 0.01 s and 0.3 s: on both sides of the polynomials' range
    for (dt_s, kp, ki) in [(0.01, 2.0, 0.0), (0.01, 0.2, 0.05), (0.3, 0.5, 0.01), (0.01, 0.0, 0.1)] {
        let mut plain = PlainMahony { q: start(), integral: [0.0; 3] };
        let mut ours = Mahony::new(start(), kp, ki).unwrap();
        for k in 0..gyro.len() {
            plain.update(gyro[k], acc[k], dt_s, kp, ki);
            let q = ours.update(gyro[k], acc[k], dt_s);
            assert!(error(q, plain.q) < 1e-12, "{dt_s} {kp} {ki}, row {k}: {}", error(q, plain.q));
        }
        assert!(vector::norm(vector::sub(ours.integral_rad_s(), plain.integral)) < 1e-12);
    }
}

#[test]
fn adaptive_mahony_is_its_equations() {
    let (gyro, acc) = tumbling(3000);
    let gain = AdaptiveGain::default();
    let mut plain = PlainMahony { q: start(), integral: [0.0; 3] };
    let mut ours = MahonyAdaptive::new(start(), gain, 0.02, 9.80665).unwrap();
    let in_g: Vec<Vec3> = acc.iter().map(|&a| vector::scale(a, 1.0 / 9.80665)).collect();
    let mut ours_in_g = MahonyAdaptive::new(start(), gain, 0.02, 1.0).unwrap();
    for k in 0..gyro.len() {
        let n = vector::norm(acc[k]);
        let kp = if n > 10.3 {
            (2.0 - 1.95 * (n - 10.3) / (14.7 - 10.3)).max(0.05)
        } else if n < 9.3 {
            (2.0 - 1.95 * (9.3 - n) / (9.3 - 4.9)).max(0.05)
        } else {
            2.0
        };
        plain.update(gyro[k], acc[k], 0.01, kp, 0.02);
        assert!(error(ours.update(gyro[k], acc[k], 0.01), plain.q) < 1e-12);
        assert!(error(ours_in_g.update(gyro[k], in_g[k], 0.01), plain.q) < 1e-11);
    }
}

#[test]
fn adaptive_gain_by_hand() {
    let gain = AdaptiveGain::default();
    let check = |norm: f64, expected: f64| {
        let kp = gain.kp(norm, 9.80665).unwrap();
        assert!((kp - expected).abs() < 1e-12, "{norm}: {kp}");
        assert!((gain.kp(norm / 9.80665, 1.0).unwrap() - expected).abs() < 1e-12);
    };
    check(9.80665, 2.0);
    check(12.5, 1.025); // half way up
    check(7.1, 1.025); // half way down
    check(14.7, 0.05);
    check(4.9, 0.05);
    check(100.0, 0.05);
    check(0.0, 0.05);
    let wrong = AdaptiveGain { lower_start: 11.0, ..gain };
    assert!(matches!(wrong.kp(9.8, 9.8), Err(Error::OutOfOrder { .. })));
    assert!(matches!(AdaptiveGain { kp_min: 3.0, ..gain }.kp(9.8, 9.8), Err(Error::OutOfOrder { .. })));
    assert!(matches!(AdaptiveGain { kp_min: -0.1, ..gain }.kp(9.8, 9.8), Err(Error::Negative { .. })));
    assert!(matches!(gain.kp(9.8, 0.0), Err(Error::NotPositive { .. })));
    assert!(matches!(gain.kp(9.8, f64::NAN), Err(Error::NotPositive { name: "gravity", .. })));
}

/// The classical four stages, one after another.
fn four_stages(q: Quaternion, rate: Vec3, dt_s: f64) -> Quaternion {
    let slope = |q: Quaternion| {
        let p = q.product(Quaternion::new(0.0, rate[0], rate[1], rate[2]));
        [0.5 * p.w, 0.5 * p.x, 0.5 * p.y, 0.5 * p.z]
    };
    let moved = |k: [f64; 4], by: f64| {
        Quaternion::new(q.w + by * k[0], q.x + by * k[1], q.y + by * k[2], q.z + by * k[3])
    };
    let k1 = slope(q);
    let k2 = slope(moved(k1, 0.5 * dt_s));
    let k3 = slope(moved(k2, 0.5 * dt_s));
    let k4 = slope(moved(k3, dt_s));
    let sum: Vec<f64> = (0..4).map(|i| (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]) / 6.0).collect();
    moved([sum[0], sum[1], sum[2], sum[3]], dt_s).normalized()
}

#[test]
fn gyroscope_steps_are_their_equations() {
    let (gyro, _) = tumbling(3000);
    for dt_s in [0.001, 0.01, 0.3] {
        let mut exact = GyroIntegrator::new(start()).unwrap();
        let mut rk4 = GyroRk4::new(start()).unwrap();
        let (mut plain_exact, mut plain_rk4) = (start(), start());
        for &rate in &gyro {
            plain_exact = plain_turn(plain_exact, rate, dt_s);
            plain_rk4 = four_stages(plain_rk4, rate, dt_s);
            assert!(error(exact.update_gyro(rate, dt_s), plain_exact) < 2e-12);
            assert!(error(rk4.update_gyro(rate, dt_s), plain_rk4) < 2e-12);
        }
    }
}

/// One whole turn in 1000 steps ends where it began, up to the sign.
#[test]
fn a_whole_turn() {
    let rate = vector::scale([2.0 / 3.0, -1.0 / 3.0, 2.0 / 3.0], std::f64::consts::TAU);
    let mut filter = GyroIntegrator::new(start()).unwrap();
    for _ in 0..1000 {
        filter.update_gyro(rate, 1e-3);
    }
    assert!(error(filter.orientation(), start()) < 1e-12);
}

/// A thousand whole turns, as a series: what rounding adds up to, and the norm on the way.
#[test]
fn a_thousand_turns_in_a_series() {
    let rate = vector::scale([2.0 / 3.0, -1.0 / 3.0, 2.0 / 3.0], std::f64::consts::TAU);
    let mut filter = GyroIntegrator::new(start()).unwrap();
    let rows: Vec<Quaternion> = run_gyro(&mut filter, &vec![rate; 100_000], Dt::Constant(0.01)).unwrap();
    for (turn, rows) in rows.chunks(100).enumerate() {
        let after = rows[99];
        assert!(error(after, start()) < 1e-11, "{turn}: {}", error(after, start()));
        assert!(rows.iter().all(|q| (q.norm_squared() - 1.0).abs() < 4e-15));
    }
}

#[test]
fn complementary_is_its_equations() {
    let (gyro, acc) = tumbling(3000);
    let mut q = start();
    let mut filter = Complementary::new(start(), 0.98, 9.80665).unwrap();
    let (mut pulled, mut free) = (0, 0);
    for k in 0..gyro.len() {
        q = plain_turn(q, gyro[k], 0.01);
        let [ax, ay, az] = acc[k];
        let share = vector::norm(acc[k]) / 9.80665;
        if share > 0.5 && share < 1.5 {
            pulled += 1;
            let target = Quaternion::from_ypr(Ypr {
                yaw_rad: q.to_ypr().yaw_rad,
                pitch_rad: (-ax).atan2(ay.hypot(az)),
                roll_rad: ay.atan2(az),
            });
            q = Quaternion::nlerp(q, target, 1.0 - 0.98);
        } else {
            free += 1;
        }
        let ours = filter.update(gyro[k], acc[k], 0.01);
        assert!(error(ours, q) < 1e-10, "row {k}: {}", error(ours, q));
    }
    assert!(pulled > 500 && free > 500);
    assert!(matches!(
        Complementary::new(start(), 1.1, 9.8),
        Err(Error::OutOfRange { rule: "0 <= alpha <= 1", .. })
    ));
}

/// The tilt error of a still sensor falls as exp(−kp t) while it is small.
#[test]
fn tilt_error_falls_with_the_time_constant() {
    let acc = [0.0, 0.0, 9.80665];
    let tilted = Quaternion::from_axis_angle([1.0, 0.0, 0.0], 1e-3).unwrap();
    let mut filter = Mahony::new(tilted, 0.5, 0.0).unwrap();
    let rows = 2000;
    let out: Vec<Quaternion> =
        run(&mut filter, &vec![[0.0; 3]; rows], &vec![acc; rows], Dt::Constant(0.001)).unwrap();
    let expected = 1e-3 * (-0.5 * 2.0_f64).exp();
    assert!((out[rows - 1].angle() / expected - 1.0).abs() < 1e-3, "{}", out[rows - 1].angle());
}

/// With ki the integral becomes minus the bias, about the axes that gravity shows.
#[test]
fn the_integral_learns_the_bias() {
    let acc = [0.0, 0.0, 9.80665];
    let mut filter = Mahony::new(initial::from_mean_acceleration(acc).unwrap(), 1.0, 0.25).unwrap();
    for _ in 0..10_000 {
        filter.update([0.02, -0.01, 0.0], acc, 0.01);
    }
    let learnt = filter.integral_rad_s();
    assert!(vector::norm(vector::sub(learnt, [-0.02, 0.01, 0.0])) < 1e-9, "{learnt:?}");
}

#[test]
fn settings_are_checked() {
    assert!(matches!(Mahony::new(start(), -1.0, 0.0), Err(Error::Negative { name: "kp", .. })));
    assert!(matches!(Mahony::new(start(), 1.0, -1.0), Err(Error::Negative { name: "ki", .. })));
    let of_nan = Mahony::new(start(), f64::NAN, 0.0).unwrap_err();
    assert_eq!(of_nan.sentence(shisei_core::Lang::En).to_string(), "kp is NaN; it must be a finite number");
    assert_eq!(
        Mahony::new(Quaternion::new(0.0, 0.0, 0.0, 0.0), 1.0, 0.0),
        Err(Error::ZeroQuaternion { row: 0 })
    );
    assert!(MahonyAdaptive::new(start(), AdaptiveGain::default(), 0.0, 0.0).is_err());
}
