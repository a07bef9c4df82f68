//! Inputs that are the same everywhere: integers turned into numbers exactly.

use alloc::vec::Vec;

use shisei_core::{Quaternion, Vec3};

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
