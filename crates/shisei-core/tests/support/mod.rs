//! Real recordings beside the repository, and a seeded generator for simulated ones.
#![allow(dead_code, clippy::disallowed_methods)] // each test uses its part; reference mathematics may use std's

use std::path::PathBuf;

/// A real recording's text; `None`, said aloud, where it is absent. `SHISEI_DATA` overrides the folder.
pub fn recording(path: &str) -> Option<String> {
    let root = std::env::var_os("SHISEI_DATA").map_or_else(
        || PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data"),
        PathBuf::from,
    );
    if let Ok(text) = std::fs::read_to_string(root.join(path)) {
        Some(text)
    } else {
        eprintln!("skipped: {path} is not in {}", root.display());
        None
    }
}

/// Rows of numbers separated by `separator` (or blanks for ' '), lines that do not parse are left out.
pub fn table(text: &str, separator: char) -> Vec<Vec<f64>> {
    text.lines()
        .filter_map(|line| {
            let cells: Option<Vec<f64>> = if separator == ' ' {
                line.split_whitespace().map(|c| c.parse().ok()).collect()
            } else {
                line.split(separator).map(|c| c.trim().parse().ok()).collect()
            };
            cells.filter(|c| !c.is_empty())
        })
        .collect()
}

/// SplitMix64 with a normal deviate by Box and Muller.
pub struct Random(pub u64);

impl Random {
    pub fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / 9_007_199_254_740_992.0
    }

    pub fn normal(&mut self) -> f64 {
        let (u, v) = (self.uniform().max(1e-300), self.uniform());
        (-2.0 * u.ln()).sqrt() * (core::f64::consts::TAU * v).cos()
    }

    pub fn normal3(&mut self, sigma: f64) -> [f64; 3] {
        [sigma * self.normal(), sigma * self.normal(), sigma * self.normal()]
    }

    /// A direction spread evenly over the sphere.
    pub fn direction(&mut self) -> [f64; 3] {
        let v = self.normal3(1.0);
        let n = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
        [v[0] / n, v[1] / n, v[2] / n]
    }
}
