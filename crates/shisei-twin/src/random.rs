//! Seeded random numbers, the same on every machine.

use rand_pcg::Pcg64;
use rand_pcg::rand_core::Rng;
use shisei_core::{Vec3, math};

/// A stream of random numbers: PCG XSL RR 128/64, normal deviates after Box and Muller (1958).
#[derive(Clone, Debug)]
pub struct Random {
    generator: Pcg64,
    spare: Option<f64>,
}

impl Random {
    /// A seed has many streams. Seed and stream are mixed (SplitMix64), so that neighbours share nothing.
    pub fn new(seed: u64, stream: u64) -> Self {
        let mut counter = split_mix(seed ^ split_mix(stream));
        let mut word = || {
            counter = counter.wrapping_add(0x9e37_79b9_7f4a_7c15);
            u128::from(split_mix(counter))
        };
        let (state, increment) = ((word() << 64) | word(), (word() << 64) | word());
        Random { generator: Pcg64::new(state, increment), spare: None }
    }

    /// Uniform in 0 ≤ x < 1, with 53 bits.
    pub fn uniform(&mut self) -> f64 {
        (self.generator.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Uniform in low ≤ x < high.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.uniform()
    }

    /// Normal with mean 0 and standard deviation 1.
    pub fn normal(&mut self) -> f64 {
        if let Some(spare) = self.spare.take() {
            return spare;
        }
        let radius = math::sqrt(-2.0 * math::ln(1.0 - self.uniform()));
        let (sin, cos) = math::sin_cos(2.0 * core::f64::consts::PI * self.uniform());
        self.spare = Some(radius * sin);
        radius * cos
    }

    /// Three independent normal deviates with this standard deviation.
    pub fn normal3(&mut self, sigma: f64) -> Vec3 {
        [(); 3].map(|()| sigma * self.normal())
    }

    /// A direction, uniform on the sphere.
    pub fn direction(&mut self) -> Vec3 {
        let z = self.between(-1.0, 1.0);
        let (sin, cos) = math::sin_cos(2.0 * core::f64::consts::PI * self.uniform());
        let r = math::sqrt(1.0 - z * z);
        [r * cos, r * sin, z]
    }
}

/// The finaliser of SplitMix64 (Steele, Lea, Flood 2014).
fn split_mix(x: u64) -> u64 {
    let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}
