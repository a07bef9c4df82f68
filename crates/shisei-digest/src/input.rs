//! Inputs that are the same everywhere: integers turned into numbers exactly.

use alloc::vec::Vec;

use shisei_core::{Quaternion, Vec3, vector};

/// A linear congruential generator (D. Knuth's MMIX constants); its upper 53 bits become numbers without rounding.
#[derive(Clone, Debug)]
pub struct Input(u64);

impl Input {
    /// One stream a topic.
    pub const fn new(seed: u64) -> Self {
        Input(seed)
    }

    /// The next number in −1 … 1, a multiple of 2⁻⁵².
    pub fn signed(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        // 53 bits minus 2^52 is exact in f64
        ((self.0 >> 11) as f64 - 4_503_599_627_370_496.0) / 4_503_599_627_370_496.0
    }

    /// Three numbers in −`largest` … `largest`.
    pub fn vec3(&mut self, largest: f64) -> Vec3 {
        [largest * self.signed(), largest * self.signed(), largest * self.signed()]
    }

    /// A unit quaternion, not uniformly distributed.
    pub fn quaternion(&mut self) -> Quaternion {
        let q = Quaternion::new(self.signed(), self.signed(), self.signed(), self.signed());
        q.try_normalized().unwrap_or(Quaternion::IDENTITY)
    }
}

/// A recording of a sensor that rests, turns and is shaken in turn.
#[derive(Debug)]
pub struct Recording {
    /// rad/s
    pub gyro_rad_s: Vec<Vec3>,
    /// m/s²
    pub acc_m_s2: Vec<Vec3>,
    /// From the sample before, s: about 10 ms, now and then none that counts as regular.
    pub dt_s: Vec<f64>,
}

/// `rows` samples: of every 512 the first 192 rest.
pub fn recording(seed: u64, rows: usize) -> Recording {
    let mut input = Input::new(seed);
    let mut made = Recording { gyro_rad_s: Vec::new(), acc_m_s2: Vec::new(), dt_s: Vec::new() };
    for row in 0..rows {
        let (turn, shake) = if row % 512 < 192 { (0.002, 0.02) } else { (4.0, 5.0) };
        made.gyro_rad_s.push(input.vec3(turn));
        let [x, y, z] = input.vec3(shake);
        made.acc_m_s2.push([x, y, 9.8 + z]);
        made.dt_s.push(0.01 + 0.001 * input.signed());
    }
    made
}

/// Time from sample to sample of [`posed`], s.
pub const POSED_DT_S: f64 = 0.02;

/// A recording for calibration: 3.5 s of rest on each of the six faces and on twelve sides between, a turn of a
/// second from one to the next, and a whole turn about each axis while it points up or down.
pub fn posed(seed: u64) -> Recording {
    let mut input = Input::new(seed);
    let mut made = Recording { gyro_rad_s: Vec::new(), acc_m_s2: Vec::new(), dt_s: Vec::new() };
    let mut q = Quaternion::IDENTITY;
    hold(&mut made, &mut input, q, [0.0; 3], 175);
    let (quarter, eighth, whole) =
        (core::f64::consts::FRAC_PI_2, core::f64::consts::FRAC_PI_4, core::f64::consts::TAU);
    // a whole turn about z while it stands upright, then about y, then about x: all six faces come up
    let mut turns = Vec::from([[0.0, 0.0, whole], [quarter, 0.0, 0.0], [0.0, whole, 0.0]]);
    turns.extend([[quarter, 0.0, 0.0]; 3]);
    turns.extend([[0.0, quarter, 0.0], [whole, 0.0, 0.0]]);
    turns.extend([[0.0, quarter, 0.0]; 3]);
    // sides between
    turns.extend((0..12).map(|i| if i % 2 == 0 { [eighth, 0.3, 0.0] } else { [0.0, eighth, 0.5] }));
    for turn_rad in turns {
        // 50 samples of 0.02 s: the angle is the rate's number
        q = hold(&mut made, &mut input, q, turn_rad, 50);
        q = hold(&mut made, &mut input, q, [0.0; 3], 175);
    }
    made
}

/// Adds samples of a steady turn, as a sensor with bias, wrong scales and noise reads them.
fn hold(
    made: &mut Recording,
    input: &mut Input,
    start: Quaternion,
    rate_rad_s: Vec3,
    rows: usize,
) -> Quaternion {
    let mut q = start;
    for _ in 0..rows {
        q = q.product(Quaternion::from_rotation_vector(vector::scale(rate_rad_s, POSED_DT_S))).normalized();
        let [x, y, z] = vector::scale(q.up_body(), 9.80665);
        let (noise, gyro_noise) = (input.vec3(0.02), input.vec3(0.002));
        made.acc_m_s2.push(vector::add([1.01 * x + 0.05, 0.99 * y - 0.03, 1.02 * z + 0.02], noise));
        made.gyro_rad_s.push(vector::add(
            vector::add(vector::scale(rate_rad_s, 1.01), [0.01, -0.02, 0.005]),
            gyro_noise,
        ));
        made.dt_s.push(POSED_DT_S);
    }
    q
}
