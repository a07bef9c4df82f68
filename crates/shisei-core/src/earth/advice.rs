//! Which directions to add to an Earth-rate measurement.
//!
//! The candidates are the six faces of the sensor up, each turned to eight headings. Each is counted as measured
//! with the noise of the others, in the levelled model (bias, Ω sin φ, Ω cos φ); the one that lowers the error of
//! Ω most is kept, and the next is looked for.

use alloc::vec::Vec;

use super::analysis::{Analysis, EARTH_RATE_RAD_S};
use super::direction::Direction;
use super::fits::level_axes;
use crate::error::Face;
use crate::least_squares::{Normal, inverse_spd};
use crate::math;
use crate::vector::{self, Vec3};

/// A direction to add.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Suggestion {
    /// The face up.
    pub face: Face,
    /// Heading of the body's x axis (y where x stands upright), clockwise from true north, rad.
    pub heading_rad: f64,
    /// Expected standard error of Ω once it (and the suggestions before it) is measured, rad/s.
    pub expected_sigma_rad_s: f64,
}

fn add(normal: &mut Normal<5>, up: Vec3, north: Vec3, variance: f64) {
    let w = 1.0 / variance;
    normal.add(&[up[0], up[1], up[2], 1.0, 0.0], 0.0, w);
    normal.add(&[north[0], north[1], north[2], 0.0, 1.0], 0.0, w);
}

/// Standard error of Ω = √(S² + C²) with a weak prior (bias within 0.01 rad/s, S and C within the Earth's rate).
fn sigma_of_rate(normal: &Normal<5>, latitude: f64, latitude_known: bool) -> f64 {
    let mut m = normal.matrix;
    for (i, row) in m.iter_mut().enumerate() {
        let s = if i < 3 { 1e-2 } else { EARTH_RATE_RAD_S };
        row[i] += 1.0 / (s * s);
    }
    let (s, c) = math::sin_cos(latitude);
    if latitude_known {
        // (−sin, cos) across the known ratio: held tightly
        let w = 1e24;
        m[3][3] += w * c * c;
        m[4][4] += w * s * s;
        m[3][4] -= w * s * c;
        m[4][3] -= w * s * c;
    }
    inverse_spd(&m).map_or(f64::INFINITY, |v| {
        math::sqrt((s * s * v[3][3] + c * c * v[4][4] + 2.0 * s * c * v[3][4]).max(0.0))
    })
}

/// The `count` directions (12 at most) that help most, best first. `latitude_rad` where known; else the one that
/// was found, or 40°, stands in.
pub fn suggest(
    directions: &[Direction],
    analysis: &Analysis,
    latitude_rad: Option<f64>,
    count: usize,
) -> Vec<Suggestion> {
    let latitude = latitude_rad.or_else(|| analysis.latitude.map(|l| l.value)).unwrap_or(0.7);
    let typical = analysis.level_circle.residual_rms.max(1e-8);
    let mut variance = typical * typical;
    let known: Vec<f64> =
        directions.iter().filter_map(|d| d.sigma_rad_s).map(|s| vector::dot(s, s) / 3.0).collect();
    if !known.is_empty() {
        variance = variance.max(known.iter().sum::<f64>() / known.len() as f64);
    }
    let north_at = |up: Vec3, heading: f64| {
        let (e1, e2) = level_axes(up);
        let (s, c) = math::sin_cos(heading);
        vector::add(vector::scale(e1, c), vector::scale(e2, s))
    };
    let mut normal = Normal::<5>::default();
    for (up, heading) in analysis.up_body.iter().zip(&analysis.headings) {
        add(&mut normal, *up, north_at(*up, heading.heading_rad.value), variance);
    }
    let mut suggestions = Vec::new();
    for _ in 0..count.min(12) {
        let mut best: Option<(f64, Suggestion, Normal<5>)> = None;
        for axis in 0..3_u8 {
            for positive in [true, false] {
                let mut up = [0.0; 3];
                up[usize::from(axis)] = if positive { 1.0 } else { -1.0 };
                for step in 0..8 {
                    let heading = f64::from(step) * core::f64::consts::FRAC_PI_4;
                    let mut trial = normal;
                    add(&mut trial, up, north_at(up, heading), variance);
                    let sigma = sigma_of_rate(&trial, latitude, latitude_rad.is_some());
                    if best.as_ref().is_none_or(|b| sigma < b.0 * (1.0 - 1e-9)) {
                        let face = Face { axis, positive };
                        let s = Suggestion { face, heading_rad: heading, expected_sigma_rad_s: sigma };
                        best = Some((sigma, s, trial));
                    }
                }
            }
        }
        let Some((_, suggestion, next)) = best else { break };
        normal = next;
        suggestions.push(suggestion);
    }
    suggestions
}
