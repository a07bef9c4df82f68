//! Simulated takes in which a body is lost but one or two of its markers are seen, against the simulator's truth.

use shisei_core::frames::{Axes, Pose};
use shisei_core::fuse::{FuseSettings, Fusion, Inertial, Optical, Source, fuse, fuse_with_markers};
use shisei_core::{Error, Quaternion, Vec3, math, vector};
use shisei_twin::optics::{Cameras, Frame, Rig, film};
use shisei_twin::simulate::{Errors, Settings, simulate};
use shisei_twin::{Random, Sensor, Simulation, movements};

const RATE_HZ: f64 = 120.0;
const PLACES_M: [Vec3; 4] = [[0.05, 0.0, 0.01], [0.0, 0.06, 0.02], [-0.04, 0.0, 0.03], [0.0, -0.05, 0.0]];

struct Filmed {
    frames: Vec<Frame>,
    simulation: Simulation,
    time_s: Vec<f64>,
    poses: Vec<Option<Pose>>,
    /// One a marker.
    markers: Vec<Vec<Option<Vec3>>>,
}

/// A minute; `hidden_s`: stretches in which only the first so many markers are seen.
fn filmed(seed: u64, lost_s: Vec<(f64, f64)>, hidden_s: Vec<(f64, f64, usize)>) -> Filmed {
    let mut random = Random::new(seed, 9);
    let rig = Rig {
        body_from_sensor: Quaternion::from_rotation_vector(vector::scale(random.direction(), 2.0)),
        sensor_m: [0.03, -0.02, 0.05],
        markers_m: PLACES_M.to_vec(),
    };
    let motion = movements::wander(seed, 4.0, 62.0);
    let settings = Settings { errors: Errors::DrawnAligned, ..Settings::new(200.0, seed) };
    let cameras =
        Cameras { offset_s: 3.3, skew: 4e-5, lost_s, hidden_s, ..Cameras::new(RATE_HZ, 60.0, seed) };
    let frames = film(&motion, &rig, &cameras);
    let y_up = Axes::ZUp.to(Axes::YUp);
    let seen = |k: usize| frames.iter().map(|frame| frame.markers_m[k].map(|p| y_up.vector(p))).collect();
    Filmed {
        time_s: frames.iter().map(|frame| frame.time_s).collect(),
        poses: frames.iter().map(|frame| frame.pose.map(turned)).collect(),
        markers: (0..PLACES_M.len()).map(seen).collect(),
        simulation: simulate(&motion, &Sensor::lsm6ds3tr_c(), &settings),
        frames,
    }
}

/// Motive's world: y up.
fn turned(pose: Pose) -> Pose {
    Axes::ZUp.to(Axes::YUp).world_of_pose(pose).expect("right-handed")
}

fn at(time_s: f64) -> usize {
    (time_s * RATE_HZ) as usize
}

impl Filmed {
    fn fused(&self, with_markers: bool) -> Result<Fusion, Error> {
        let (sensor_s, acc, gyro) =
            (self.simulation.time_s(), self.simulation.acc_m_s2(), self.simulation.gyro_rad_s());
        let optical = Optical { time_s: &self.time_s, poses: &self.poses };
        let inertial = Inertial { time_s: &sensor_s, acc_m_s2: &acc, gyro_rad_s: &gyro };
        let markers: Vec<&[Option<Vec3>]> = self.markers.iter().map(Vec::as_slice).collect();
        if with_markers {
            fuse_with_markers(&optical, &markers, &inertial, &FuseSettings::default())
        } else {
            fuse(&optical, &inertial, &FuseSettings::default())
        }
    }

    /// RMS errors from one time to another, degrees and mm, and the largest distance, mm.
    fn errors(&self, fusion: &Fusion, from_s: f64, to_s: f64) -> (f64, f64, f64) {
        let (mut turn, mut shift, mut most) = (0.0, 0.0, 0.0_f64);
        let rows = at(from_s)..at(to_s);
        let count = rows.len() as f64;
        for row in rows {
            let (found, truth) = (fusion.frames[row].pose.expect("filled"), turned(self.frames[row].truth));
            let angle = found.world_from_body.conjugate().product(truth.world_from_body).angle().to_degrees();
            let apart = vector::norm(vector::sub(found.position_m, truth.position_m)) * 1e3;
            turn += angle * angle / count;
            shift += apart * apart / count;
            most = most.max(apart);
        }
        (turn.sqrt(), shift.sqrt(), most)
    }
}

#[test]
fn one_or_two_markers_hold_the_position_for_half_a_minute() {
    for (seed, count) in [(1, 1), (2, 1), (3, 2), (4, 2)] {
        let take = filmed(seed, Vec::new(), vec![(20.0, 51.0, count)]);
        let (without, with) = (take.fused(false).expect("a take"), take.fused(true).expect("a take"));
        let (bare, held) = (take.errors(&without, 20.0, 51.0), take.errors(&with, 20.0, 51.0));
        let said = with.gaps[0].sigma_m * 1e3;
        println!(
            "{seed}, {count} of 4: {bare:.3?} without, {held:.3?} with, said {said:.2} mm, {:?}",
            with.held.places
        );
        // most of what is left is the turn of a marker's arm of 5 cm
        assert!(held.1 < 1.0 && held.2 < 3.0 && 20.0 * held.1 < bare.1, "{held:?} {bare:?}");
        assert!(held.0 < bare.0.max(0.3), "{held:?} {bare:?}");
        assert!(held.1 < 3.0 * said && said < 5.0 && 10.0 * said < without.gaps[0].sigma_m * 1e3, "{said}");
        for (place, truth) in with.held.places.iter().zip(PLACES_M) {
            let place = place.expect("seen with the body");
            let off = vector::norm(vector::sub(place.at_m, truth));
            assert!(off < 1e-4 && off < 4.0 * place.sigma_m, "{off} {place:?}");
        }
        // more than 30 s without the body: not held without markers
        assert_eq!((without.gaps[0].source, with.gaps[0].source), (Source::Inertial, Source::Bridged));
        let row = at(40.0);
        assert!((without.frames[row].gap_s - 20.0).abs() < 0.02 && with.frames[row].gap_s == 0.0);
        assert!(with.held.frames[row] && !with.held.frames[at(10.0)]);
        // what the cameras saw of the body stays
        for (seen, fused) in take.poses.iter().zip(&with.frames) {
            assert!(seen.is_none() || (*seen == fused.pose && fused.source == Source::Optical));
        }
    }
}

#[test]
fn without_a_marker_in_a_gap_no_bit_changes() {
    let take = filmed(5, vec![(12.0, 14.0), (30.0, 36.0)], Vec::new());
    let (without, with) = (take.fused(false).expect("a take"), take.fused(true).expect("a take"));
    assert_eq!(without.frames, with.frames);
    assert_eq!((without.gaps, without.calibration), (with.gaps, with.calibration));
}

#[test]
fn a_marker_that_comes_back_in_the_middle_holds_it_from_there() {
    // nothing from 20 to 24 s and from 36 to 40 s, one marker in between; the body is not seen again
    let take = filmed(6, vec![(20.0, 24.0), (36.0, 40.0)], vec![(24.0, 36.0, 1), (40.0, 61.0, 1)]);
    let with = take.fused(true).expect("a take");
    let (middle, end) = (take.errors(&with, 25.0, 35.0), take.errors(&with, 41.0, 60.0));
    println!("{middle:.3?} {end:.3?}");
    assert!(middle.1 < 2.0 && end.1 < 2.0, "{middle:?} {end:?}");
    assert!(take.errors(&with, 20.0, 24.0).1 < 60.0);
    // held to the very end
    assert_eq!(with.gaps[0].source, Source::Bridged);
    assert!((with.frames[at(22.0)].gap_s - 2.0).abs() < 0.02);
}

/// Somebody else's place in a marker's column, from one time to another.
fn mistaken(take: &mut Filmed, marker: usize, from_s: f64, to_s: f64, seen: impl Fn(usize, &Filmed) -> Vec3) {
    let places: Vec<Vec3> = (at(from_s)..at(to_s)).map(|row| seen(row, take)).collect();
    for (row, place) in (at(from_s)..at(to_s)).zip(places) {
        take.markers[marker][row] = Some(place);
    }
}

/// Where a place on the body truly is.
fn true_place(take: &Filmed, row: usize, place: Vec3) -> Vec3 {
    let truth = turned(take.frames[row].truth);
    vector::add(truth.position_m, truth.world_from_body.rotate(place))
}

#[test]
fn a_mistaken_marker_does_no_harm() {
    let one = || filmed(7, Vec::new(), vec![(20.0, 45.0, 1)]);
    let without = one().fused(false).expect("a take");
    let bare = one().errors(&without, 20.0, 45.0);
    let check = |what: &str, take: &Filmed, most_mm: f64| {
        let with = take.fused(true).expect("a take");
        let found = take.errors(&with, 20.0, 45.0);
        println!("{what}: {found:.3?}, without markers {bare:.3?}");
        assert!(found.2 < most_mm, "{what}: {found:?}");
        assert!(found.0 < 0.1, "{what}: {found:?} degrees and mm, {bare:?} without");
        with
    };
    // the first is mistaken for the second for 3 s, for the rest of the gap, and in single frames
    let mut take = one();
    mistaken(&mut take, 0, 30.0, 33.0, |row, take| true_place(take, row, PLACES_M[1]));
    let with = check("swapped for 3 s", &take, 25.0);
    assert!(!with.held.frames[at(31.0)] && with.held.frames[at(34.0)]);
    let mut take = one();
    mistaken(&mut take, 0, 42.0, 45.0, |row, take| true_place(take, row, PLACES_M[1]));
    let with = check("swapped to the end", &take, 25.0);
    assert!(!with.held.frames[at(43.0)]);
    let mut take = one();
    for k in 0..20 {
        let from_s = 25.0 + 0.7 * f64::from(k);
        mistaken(&mut take, 0, from_s, from_s + 0.01, |_, _| [0.5, 0.25, 1.5]);
    }
    check("single frames", &take, 4.0);
    // stands still while the body moves on, to the bit or with noise
    for noise_m in [0.0, 1e-4] {
        let mut take = one();
        let frozen = take.markers[0][at(30.0)].expect("seen");
        let mut random = Random::new(1, 2);
        let still: Vec<Vec3> = (0..at(3.0)).map(|_| vector::add(frozen, random.normal3(noise_m))).collect();
        mistaken(&mut take, 0, 30.0, 33.0, |row, _| still[row - at(30.0)]);
        check("frozen", &take, 40.0);
    }
    // both of two, each in the other's place
    let mut take = filmed(7, Vec::new(), vec![(20.0, 45.0, 2)]);
    mistaken(&mut take, 0, 30.0, 40.0, |row, take| true_place(take, row, PLACES_M[1]));
    mistaken(&mut take, 1, 30.0, 40.0, |row, take| true_place(take, row, PLACES_M[0]));
    let with = check("both swapped", &take, 300.0);
    assert!(!with.held.frames[at(35.0)]);
}

#[test]
fn a_marker_that_moves_on_the_body_is_not_used() {
    let mut take = filmed(8, Vec::new(), vec![(20.0, 30.0, 1)]);
    for row in 0..take.time_s.len() {
        let sway = 0.02 * math::sin(2.0 * take.time_s[row]);
        let place = true_place(&take, row, vector::add(PLACES_M[0], [sway, 0.0, 0.0]));
        take.markers[0][row] = take.markers[0][row].map(|_| place);
    }
    let (without, with) = (take.fused(false).expect("a take"), take.fused(true).expect("a take"));
    assert_eq!((with.held.places[0], with.held.places[1].is_some()), (None, true));
    assert_eq!(without.frames, with.frames);
}

#[test]
fn other_lengths_and_numbers_that_are_none_are_refused() {
    let mut take = filmed(9, Vec::new(), Vec::new());
    take.markers[1][7] = Some([0.0, f64::NAN, 0.0]);
    assert_eq!(take.fused(true).expect_err("not a number"), Error::NotFinite { row: 7 });
    take.markers[1].pop();
    assert!(matches!(take.fused(true).expect_err("too short"), Error::LengthMismatch { .. }));
}
