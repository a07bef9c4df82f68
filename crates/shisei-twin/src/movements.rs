//! Movements for tests, demonstrations and the recordings in `examples/`.

use core::f64::consts::{FRAC_PI_2, PI};

use shisei_core::vector::{cross, dot, norm, scale, sub};
use shisei_core::{Quaternion, Vec3};

use crate::curve::Curve;
use crate::motion::{Path, Turn};
use crate::random::Random;

const DEG: f64 = PI / 180.0;

/// When the pelvis begins to move, s.
pub const PELVIS_START_S: f64 = 3.2;
/// How long twisting, bending and leaning take each, s.
pub const PELVIS_PART_S: f64 = 3.8;
/// Stillness between two of them, s.
pub const PELVIS_PAUSE_S: f64 = 0.2;
/// Specific force of a sensor at rest on the pelvis, as in the add-in manual's first example, m/s².
pub const PELVIS_REST_M_S2: Vec3 = [9.74, 0.1, -0.9];

/// A standing person: still, then twisting left and right, bending forward and backward, leaning left and
/// right, still again.
///
/// World x is where the wearer faces at the start, y is left. The sensor sits on the sacrum, its x up along
/// the spine, its z forward and a little down, so z laid flat is the forward axis. Each part moves one of yaw,
/// pitch and roll of the pelvis only; the hips give way to keep the balance.
pub fn pelvis() -> Path {
    let part = |index: f64| PELVIS_START_S + index * (PELVIS_PART_S + PELVIS_PAUSE_S);
    // Out to one side within 1.1 s, to the other within 1.6 s, back within 1.1 s.
    let sway = |start_s: f64, first: f64, second: f64| {
        Curve::default().step(start_s, 1.1, first).step(start_s + 1.1, 1.6, second - first).step(
            start_s + 2.7,
            1.1,
            -second,
        )
    };
    let yaw = sway(part(0.0), 38.0 * DEG, -36.0 * DEG);
    let pitch = sway(part(1.0), 42.0 * DEG, -14.0 * DEG);
    let roll = sway(part(2.0), -19.0 * DEG, 21.0 * DEG);
    let mut path = Path::still(16.70).with_ypr(yaw, pitch, roll);
    path.position_m = [sway(part(1.0), -0.08, 0.05), sway(part(2.0), -0.05, 0.05), Curve::constant(0.95)];
    path.lever_arm_m = [-0.10, 0.0, 0.12];
    path.mounting = facing(PELVIS_REST_M_S2, [0.0, 0.0, 1.0]);
    path
}

/// The attitude of a sensor at rest that reads `up_body` and whose axis `forward_body`, laid flat, points
/// along world x. The two must not be parallel.
pub fn facing(up_body: Vec3, forward_body: Vec3) -> Quaternion {
    let up = scale(up_body, 1.0 / norm(up_body));
    let flat = sub(forward_body, scale(up, dot(forward_body, up)));
    let forward = scale(flat, 1.0 / norm(flat));
    // Rows orthonormal and right-handed by construction.
    Quaternion::from_matrix([forward, cross(up, forward), up]).unwrap_or(Quaternion::IDENTITY)
}

/// Six faces, each rested for `rest_s` with turns of `turn_s`, in the order +z, +y, −z, −y, −x, +x up.
/// Each face is off by its own tilt (a rotation vector in sensor coordinates, rad).
pub fn six_faces(rest_s: f64, turn_s: f64, tilts_rad: &[Vec3; 6]) -> Path {
    const X: Vec3 = [1.0, 0.0, 0.0];
    const Z: Vec3 = [0.0, 0.0, 1.0];
    let turns = [(X, 0.0), (X, FRAC_PI_2), (X, FRAC_PI_2), (X, FRAC_PI_2), (Z, FRAC_PI_2), (Z, PI)];
    let mut face = Quaternion::IDENTITY;
    let mut attitudes = Vec::with_capacity(6);
    for ((axis, angle), tilt) in turns.iter().zip(tilts_rad) {
        face = face.product(Quaternion::from_rotation_vector(scale(*axis, *angle)));
        attitudes.push(face.product(Quaternion::from_rotation_vector(*tilt)));
    }
    let mut path = Path::through(&attitudes, rest_s, turn_s);
    for turn in 0..5 {
        let start_s = rest_s + f64::from(turn) * (rest_s + turn_s);
        path.position_m[2] =
            std::mem::take(&mut path.position_m[2]).bump(start_s, 0.4 * turn_s, 0.2 * turn_s, 0.08);
    }
    path
}

/// Random tilts of at most `limit_rad` for [`six_faces`].
pub fn random_tilts(random: &mut Random, limit_rad: f64) -> [Vec3; 6] {
    [(); 6].map(|()| scale(random.direction(), random.between(0.0, limit_rad)))
}

/// Rests in `count` random attitudes, uniform over all, with turns between.
pub fn random_poses(random: &mut Random, count: usize, rest_s: f64, turn_s: f64) -> Path {
    let attitudes: Vec<Quaternion> = (0..count)
        .map(|_| {
            let [w, x, y, z] = [(); 4].map(|()| random.normal());
            Quaternion::new(w, x, y, z).normalized()
        })
        .collect();
    Path::through(&attitudes, rest_s, turn_s)
}

/// Rest of [`calibration_poses`], s.
const POSE_REST_S: f64 = 4.0;
/// Turn of [`calibration_poses`], s.
const POSE_TURN_S: f64 = 2.0;

/// What somebody does who calibrates a sensor: six faces, each up to 3° off, then twelve poses every which way, each
/// rested for 4 s with turns of 2 s between, and back to where it began: 112 s.
pub fn calibration_poses(seed: u64) -> Path {
    let mut random = Random::new(seed, 0x706f_7365);
    let faces = [
        [0.0, 0.0, 1.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, -1.0],
        [0.0, -1.0, 0.0],
        [-1.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
    ];
    let tilts_rad = random_tilts(&mut random, 3.0 * DEG);
    let mut attitudes: Vec<Quaternion> = faces
        .iter()
        .zip(tilts_rad)
        .map(|(up, tilt_rad)| {
            // another axis, in the same order: never parallel
            let forward = [up[1], up[2], up[0]];
            facing(*up, forward).product(Quaternion::from_rotation_vector(tilt_rad))
        })
        .collect();
    attitudes.extend((0..12).map(|_| {
        let [w, x, y, z] = [(); 4].map(|()| random.normal());
        Quaternion::new(w, x, y, z).normalized()
    }));
    attitudes.extend(attitudes.first().copied());
    Path::through(&attitudes, POSE_REST_S, POSE_TURN_S)
}

/// Still for `rest_s`, then moving freely in all directions for `move_s`, then still for `rest_s`: turns of up
/// to about ±1.5 rad and translations of a few decimetres, sums of sinusoids of 0.1 to 1 Hz that fade in and
/// out within 1 s.
pub fn wander(seed: u64, rest_s: f64, move_s: f64) -> Path {
    let mut random = Random::new(seed, 0x776e_6472);
    let mut faded = |amplitude: f64| {
        let mut sum = Curve::default();
        for _ in 0..3 {
            let frequency_hz = random.between(0.1, 1.0);
            let phase_rad = random.between(-PI, PI);
            sum = sum.sine(amplitude * random.between(0.3, 1.0) / 3.0, frequency_hz, phase_rad);
        }
        sum.times(Curve::default().bump(rest_s, 1.0, move_s - 2.0, 1.0))
    };
    let mut path = Path::still(2.0 * rest_s + move_s);
    path.turns = [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
        .map(|axis| Turn { axis, angle_rad: faded(1.5) })
        .to_vec();
    path.position_m = [faded(0.3), faded(0.3), faded(0.2)];
    path.mounting = Quaternion::from_rotation_vector(scale(random.direction(), random.between(0.0, PI)));
    path
}
