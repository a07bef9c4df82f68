//! Every width of vectors, and one row at a time, give the same bits.

use shisei_core::filter::{
    Complementary, Dt, Filter, GyroIntegrator, GyroOnly, GyroRk4, Mahony, Readings, run_gyro_into, run_into,
};
use shisei_core::orient::{self, Method, Relative, RestChoice, Settings};
use shisei_core::{AttitudeRow, Error, Quaternion, Vec3, Ypr, relative};
use shisei_wide::Vectors;

/// Numbers below 1 by a linear congruential generator.
struct Input(u64);

impl Input {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    fn row<const N: usize>(&mut self, scale: f64) -> [f64; N] {
        std::array::from_fn(|_| scale * self.next())
    }
}

/// Lengths around those that are taken together.
const LENGTHS: [usize; 12] = [0, 1, 3, 15, 16, 63, 64, 127, 128, 129, 300, 1031];

fn bits(rows: &[[f64; 3]]) -> Vec<u64> {
    rows.as_flattened().iter().map(|v| v.to_bits()).collect()
}

fn bits4(rows: &[[f64; 4]]) -> Vec<u64> {
    rows.as_flattened().iter().map(|v| v.to_bits()).collect()
}

/// Ordinary ones, poles and what is close to them, axes, signs of zero, huge and tiny ones.
fn quaternions(rows: usize) -> Vec<[f64; 4]> {
    let mut input = Input(7);
    let special = [
        [1.0, 0.0, 0.0, 0.0],
        [-1.0, -0.0, 0.0, -0.0],
        [0.0, 1.0, 0.0, 0.0],
        [-0.0, 0.0, 0.0, -1.0],
        [0.5, 0.5, 0.5, -0.5],
        [1e150, 2e150, -1e150, 3e150],
        [1e-300, 2e-300, -0.0, 3e-301],
        [5e-324, 0.0, 0.0, 0.0],
        [f64::MAX, f64::MIN_POSITIVE, 0.0, f64::MAX],
    ];
    (0..rows)
        .map(|k| {
            let offset = [0.0, 1e-16, 1e-12, 1e-9, 1e-5][k % 5];
            match k % 7 {
                0 => special[(k / 7) % special.len()],
                1 | 2 => {
                    // nose up or down: pitch ±π/2 less the offset
                    let pitch_rad =
                        (std::f64::consts::FRAC_PI_2 - offset) * if k % 2 == 0 { 1.0 } else { -1.0 };
                    let [yaw_rad, roll_rad] = input.row(3.0);
                    Quaternion::from_ypr(Ypr { yaw_rad, pitch_rad, roll_rad }).to_array()
                }
                _ => input.row(1.0),
            }
        })
        .collect()
}

#[test]
fn angles_of_every_width_are_those_of_one_row() {
    let initial = Quaternion::from_array([0.9, 0.1, -0.3, 0.2]).try_normalized().unwrap();
    for rows in LENGTHS {
        let given = quaternions(rows);
        let each = |f: &dyn Fn(Quaternion) -> Quaternion| -> Vec<[f64; 3]> {
            given.iter().map(|&q| f(Quaternion::from_array(q)).to_ypr().to_array()).collect()
        };
        let unit = |q: Quaternion| q.try_normalized().unwrap();
        let expected = each(&unit);
        let body = each(&|q| initial.try_normalized().unwrap().conjugate().product(unit(q)));
        let world = each(&|q| unit(q).product(initial.try_normalized().unwrap().conjugate()));
        for vectors in Vectors::all() {
            let mut out = vec![[9.0; 3]; rows];
            vectors.convert_series(&given, &mut out).unwrap();
            assert_eq!(bits(&out), bits(&expected), "{vectors:?} {rows}");
            vectors.body_series(&given, initial, &mut out).unwrap();
            assert_eq!(bits(&out), bits(&body), "{vectors:?} {rows}");
            vectors.world_series(&given, initial, &mut out).unwrap();
            assert_eq!(bits(&out), bits(&world), "{vectors:?} {rows}");
        }
    }
}

#[test]
fn a_row_that_is_no_attitude_is_refused_by_every_width() {
    for (bad, error) in [
        ([f64::NAN, 0.0, 0.0, 1.0], Error::NotFinite { row: 0 }),
        ([0.0, f64::INFINITY, 0.0, 1.0], Error::NotFinite { row: 0 }),
        ([0.0, -0.0, 0.0, 0.0], Error::ZeroQuaternion { row: 0 }),
    ] {
        for row in [0, 5, 63, 64, 130, 199] {
            let mut given = quaternions(200);
            given[row] = bad;
            for vectors in Vectors::all() {
                let refused = vectors.convert_series(&given, &mut vec![[0.0; 3]; 200]);
                assert_eq!(refused, Err(error.at_row(row)), "{vectors:?}");
            }
        }
    }
}

/// Slow, fast beyond the polynomial's range, none at all.
fn rates(rows: usize) -> Vec<Vec3> {
    let mut input = Input(11);
    let scale = |k: usize| match k % 97 {
        0 => 0.0,
        1 => 1e5,
        2 => 1e300,
        3 => 1e-300,
        _ => 3.0,
    };
    (0..rows).map(|k| input.row(scale(k))).collect()
}

fn series<F: GyroOnly + Copy, O: AttitudeRow + Copy>(filter: F, identity: O) -> Vec<Vec<O>> {
    let mut all = Vec::new();
    for rows in LENGTHS {
        let gyro = rates(rows);
        let steps: Vec<f64> = (0..rows).map(|k| 0.01 + 0.001 * (k % 3) as f64).collect();
        for dt in [Dt::Constant(0.01), Dt::PerSample(&steps)] {
            let mut live = filter;
            let one_by_one: Vec<O> =
                (0..rows).map(|k| O::from(live.update_gyro(gyro[k], dt.at(k)))).collect();
            all.push(one_by_one);
            for vectors in Vectors::all() {
                let mut out = vec![identity; rows];
                vectors.run_gyro_into(&mut { filter }, &gyro, dt, &mut out).unwrap();
                all.push(out);
            }
            let mut out = vec![identity; rows];
            run_gyro_into(&mut { filter }, &gyro, dt, &mut out).unwrap();
            all.push(out);
        }
    }
    all
}

#[test]
fn rates_give_the_bits_of_one_sample_after_another() {
    let start = Quaternion::from_array([0.3, -0.5, 0.1, 0.8]);
    let copies = Vectors::all().count() + 2;
    for same in series(GyroIntegrator::new(start).unwrap(), [0.0; 4]).chunks(copies) {
        assert!(same.iter().all(|rows| bits4(rows) == bits4(&same[0])));
    }
    for same in series(GyroIntegrator::new(start).unwrap(), [0.0; 3]).chunks(copies) {
        assert!(same.iter().all(|rows| bits(rows) == bits(&same[0])));
    }
    for same in series(GyroRk4::new(start).unwrap(), [0.0; 4]).chunks(copies) {
        assert!(same.iter().all(|rows| bits4(rows) == bits4(&same[0])));
    }
}

/// However a recording is cut into calls, and whatever state the integrator is in.
#[test]
fn rates_in_parts_give_the_bits_of_the_whole() {
    let gyro = rates(1500);
    let start = GyroIntegrator::new(Quaternion::IDENTITY).unwrap();
    let mut whole = vec![[0.0; 4]; gyro.len()];
    let mut whole_filter = start;
    run_gyro_into(&mut whole_filter, &gyro, Dt::Constant(0.01), &mut whole).unwrap();
    for parts in [1, 7, 16, 100, 128, 129, 700] {
        for vectors in Vectors::all() {
            let mut filter = start;
            let mut out = vec![[0.0; 4]; gyro.len()];
            for (gyro, out) in gyro.chunks(parts).zip(out.chunks_mut(parts)) {
                vectors.run_gyro_into(&mut filter, gyro, Dt::Constant(0.01), out).unwrap();
            }
            assert_eq!(bits4(&out), bits4(&whole), "{parts} {vectors:?}");
            assert_eq!(filter, whole_filter);
        }
    }
}

#[test]
fn a_rate_that_is_not_finite_is_refused_with_its_row() {
    for row in [0, 100, 127, 128, 255, 260, 399] {
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let mut gyro = rates(400);
            gyro[row][row % 3] = bad;
            for vectors in Vectors::all() {
                let mut filter = GyroIntegrator::new(Quaternion::IDENTITY).unwrap();
                let done =
                    vectors.run_gyro_into(&mut filter, &gyro, Dt::Constant(0.01), &mut vec![[0.0; 4]; 400]);
                assert_eq!(done, Err(Error::NotFinite { row }));
            }
        }
    }
}

#[test]
fn filters_of_every_width_give_the_bits_of_one_sample_after_another() {
    fn check<F: Filter + Copy>(filter: F) {
        let mut input = Input(3);
        let gyro: Vec<Vec3> = (0..333).map(|_| input.row(2.0)).collect();
        let acc: Vec<Vec3> = (0..333).map(|k| input.row(if k % 50 == 0 { 0.0 } else { 10.0 })).collect();
        let mut live = filter;
        let expected: Vec<[f64; 3]> =
            (0..333).map(|k| live.update(gyro[k], acc[k], 0.01).to_ypr().to_array()).collect();
        for vectors in Vectors::all() {
            let mut out = vec![[0.0; 3]; 333];
            vectors.run_into(&mut { filter }, &gyro, &acc, Dt::Constant(0.01), &mut out).unwrap();
            assert_eq!(bits(&out), bits(&expected), "{vectors:?}");
        }
        let mut out = vec![[0.0; 3]; 333];
        run_into(&mut { filter }, &gyro, &acc, Dt::Constant(0.01), &mut out).unwrap();
        assert_eq!(bits(&out), bits(&expected));
    }
    let start = Quaternion::IDENTITY;
    check(Mahony::new(start, 0.5, 0.0).unwrap());
    check(Mahony::new(start, 0.5, 0.1).unwrap());
    check(Complementary::new(start, 0.98, 9.80665).unwrap());
}

#[test]
fn angles_of_an_orientation_are_those_of_its_rows() {
    let gyro = rates(3).into_iter().cycle().take(300).map(|_| [0.1, -0.2, 0.3]).collect::<Vec<Vec3>>();
    let acc = vec![[0.1, 0.2, 9.8]; 300];
    let steps = vec![0.01; 300];
    for relative in [Relative::None, Relative::World, Relative::Body] {
        let method = Method::Mahony { kp: 0.2, ki: 0.0 };
        let settings = Settings { method, rest: RestChoice::None, relative, ..Settings::default() };
        let found = orient::orient(&acc, &gyro, &steps, &settings).unwrap();
        let expected: Vec<[f64; 3]> = (0..300).map(|k| found.ypr(k).to_array()).collect();
        for vectors in Vectors::all() {
            assert_eq!(
                bits(&vectors.ypr_rad(&found.world_from_body, found.start, found.relative)),
                bits(&expected)
            );
        }
    }
}

/// A filter, rates, accelerations and steps.
type Given = (Mahony, Vec<Vec3>, Vec<Vec3>, Vec<f64>);

/// Recordings of all kinds, more of them than go side by side: with gaps in the acceleration, turns beyond the
/// polynomial's range, huge numbers (where `special`); a bias that is learnt (by every third, where `learns`); steps of
/// their own.
fn recordings(special: bool, learns: bool) -> Vec<Given> {
    let start = Quaternion::from_array([0.9, 0.1, -0.3, 0.2]);
    let lengths =
        [0, 1, 31, 63, 64, 65, 100, 500, 257, 7, 320, 129, 128, 97, 1000, 40, 41, 700, 128, 300, 500, 2000];
    let all = lengths.iter().enumerate().map(|(i, &rows)| {
        let mut input = Input(i as u64);
        let special = |k: usize| special && k % 256 < 100;
        let gyro =
            (0..rows).map(|k| input.row(if special(k) && (k + i) % 61 == 0 { 1e4 } else { 2.0 })).collect();
        let scale = |k: usize| match (k + i) % 53 {
            0 if special(k) => 0.0,
            1 if special(k) => 1e200,
            2 if special(k) => 1e-200,
            _ => 10.0,
        };
        let acc = (0..rows).map(|k| input.row(scale(k))).collect();
        let filter =
            Mahony::new(start, 0.1 * i as f64, if learns && i % 3 == 0 { 0.05 } else { 0.0 }).unwrap();
        (filter, gyro, acc, (0..rows).map(|k| 0.01 + 0.001 * (k % 4) as f64).collect())
    });
    all.collect()
}

fn dt(index: usize, steps: &[f64]) -> Dt<'_> {
    if index.is_multiple_of(2) { Dt::Constant(0.01) } else { Dt::PerSample(steps) }
}

/// One recording with room for its rows each.
fn readings<'a, O>(given: &'a [Given], out: &'a mut [Vec<O>]) -> Vec<Readings<'a, O>> {
    let all = given.iter().zip(out).enumerate();
    all.map(|(i, ((filter, gyro_rad_s, acc_m_s2, steps), out))| Readings {
        filter: *filter,
        gyro_rad_s,
        acc_m_s2,
        dt: dt(i, steps),
        out,
    })
    .collect()
}

/// Attitudes of every recording, and the filters after them.
fn side_by_side<O: AttitudeRow>(given: &[Given], vectors: Vectors, empty: O) -> (Vec<Vec<O>>, Vec<Mahony>) {
    let mut out: Vec<Vec<O>> = given.iter().map(|g| vec![empty; g.1.len()]).collect();
    let mut readings = readings(given, &mut out);
    vectors.run_many_into(&mut readings).unwrap();
    let ends = readings.iter().map(|r| r.filter).collect();
    (out, ends)
}

#[test]
fn recordings_side_by_side_get_the_bits_that_they_get_alone() {
    for (special, learns) in [(false, false), (false, true), (true, false), (true, true)] {
        check_side_by_side(&recordings(special, learns));
    }
}

fn check_side_by_side(given: &[Given]) {
    for count in [0, 1, 2, 3, 5, 8, 9, given.len()] {
        for vectors in Vectors::all() {
            let (quaternions, ends) = side_by_side(&given[..count], vectors, [0.0; 4]);
            let (angles, _) = side_by_side(&given[..count], vectors, [0.0; 3]);
            for (i, (filter, gyro, acc, steps)) in given.iter().enumerate().take(count) {
                let mut live = *filter;
                for k in 0..gyro.len() {
                    let q = live.update(gyro[k], acc[k], dt(i, steps).at(k));
                    assert_eq!(
                        bits4(&[quaternions[i][k]]),
                        bits4(&[q.to_array()]),
                        "{vectors:?} {count} {i} {k}"
                    );
                    assert_eq!(bits(&[angles[i][k]]), bits(&[q.to_ypr().to_array()]));
                }
                assert_eq!(ends[i], live, "{vectors:?} {count} {i}");
            }
        }
    }
}

#[test]
fn a_recording_that_is_refused_leaves_the_others() {
    let mut given = recordings(false, true);
    given[7].1[300][1] = f64::NAN;
    given[10].2[319][2] = f64::INFINITY;
    given[14].3[999] = 0.0; // its step is constant
    given[17].3[3] = 0.0;
    let mut out: Vec<Vec<[f64; 4]>> = given.iter().map(|g| vec![[0.0; 4]; g.1.len()]).collect();
    let mut readings = readings(&given, &mut out);
    let refused = Vectors::widest().run_many_into(&mut readings);
    assert_eq!(refused, Err((7, Error::NotFinite { row: 300 })));
    for (i, (mut filter, gyro, acc, steps)) in given.into_iter().enumerate() {
        let mut alone = vec![[0.0; 4]; gyro.len()];
        match run_into(&mut filter, &gyro, &acc, dt(i, &steps), &mut alone) {
            Ok(()) => assert_eq!(bits4(&out[i]), bits4(&alone), "{i}"),
            Err(error) => assert!([7, 10, 17].contains(&i), "{i} {error}"),
        }
    }
}

/// The plain series are what the widths are copies of.
#[test]
fn the_core_alone_gives_the_same() {
    let given = quaternions(1031);
    let (mut wide, mut plain) = (vec![[0.0; 3]; 1031], vec![[0.0; 3]; 1031]);
    Vectors::widest().convert_series(&given, &mut wide).unwrap();
    relative::convert_series(&given, &mut plain).unwrap();
    assert_eq!(bits(&wide), bits(&plain));
}
