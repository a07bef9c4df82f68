//! Allan deviation of a rate: how much averaging helps, and when it stops helping.
//!
//! With x the running integral of the rate and τ = m τ₀, the overlapping estimate is
//! σ²(τ) = Σᵢ (xᵢ₊₂ₘ − 2 xᵢ₊ₘ + xᵢ)² / (2 τ² (N − 2m)), N integrals (NIST SP 1065, eq. 11). Intervals come from
//! χ² with the equivalent degrees of freedom of SP 1065 table 5; the power law is found from the lag-1
//! autocorrelation (Riley & Greenhall 2004). The coefficients are those of IEEE Std 952: white noise (angle
//! random walk N), flicker (bias instability B), random walk (rate random walk K), quantisation Q:
//! σ²(τ) = 3 Q²/τ² + N²/τ + (2 ln 2/π) B² + K² τ/3.
//!
//! The rate may have any unit U (rad/s, m/s²); τ is in s.

use alloc::vec::Vec;

use crate::error::{Error, Result};
use crate::least_squares::{Normal, inverse_spd};
use crate::math;
use crate::matrix::{cholesky, cholesky_solve};
use crate::statistics::{ONE_SIGMA, deviation_interval};

/// 2 ln 2 / π: the flat part of the Allan variance is this times B².
pub const FLICKER_FACTOR: f64 = 0.441_271_200_305_303_2;

/// Allan deviation at one averaging time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Averaging factor m: samples in one average.
    pub averaging_factor: usize,
    /// Averaging time τ = m τ₀, s.
    pub tau_s: f64,
    /// Overlapping Allan deviation, U.
    pub deviation: f64,
    /// Lower end of the central 68.27 % interval, U.
    pub low: f64,
    /// Upper end of the central 68.27 % interval, U.
    pub high: f64,
    /// Equivalent degrees of freedom of the estimate.
    pub degrees_of_freedom: f64,
    /// Exponent α of the power law S(f) ∝ f^α at this τ: 0 white, −1 flicker, −2 random walk, 1 and 2 for
    /// quantised or differenced noise.
    pub noise_exponent: i32,
}

/// A coefficient with its standard error.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Coefficient {
    /// Value, 0 where the data show none.
    pub value: f64,
    /// Standard error; where the value is 0, the size that would just have been seen.
    pub sigma: f64,
}

/// The analysis of one axis.
#[derive(Clone, Debug)]
pub struct Analysis {
    /// The curve, shortest τ first.
    pub curve: Vec<Point>,
    /// Q, quantisation, U·s.
    pub quantisation: Coefficient,
    /// N, angle (or velocity) random walk, U·√s: rad/√s for a gyroscope.
    pub random_walk: Coefficient,
    /// B, bias instability from the fit, U.
    pub bias_instability: Coefficient,
    /// K, rate random walk, U/√s.
    pub rate_random_walk: Coefficient,
    /// The curve's smallest deviation divided by √(2 ln 2/π), U: the bias instability as data sheets read it.
    pub floor: f64,
    /// Where the curve is smallest, s.
    pub floor_tau_s: f64,
    /// True when the curve rises again after its minimum: then the floor was reached. Otherwise the recording
    /// is too short and `floor` is an upper limit.
    pub floor_reached: bool,
    /// Averaging longer than this gains nothing that these data can show, s.
    pub recommended_s: f64,
}

fn integral(rate: &[f64], tau0_s: f64) -> Result<Vec<f64>> {
    if rate.len() < 3 {
        return Err(Error::TooFewPoints { given: rate.len(), needed: 3 });
    }
    if !(tau0_s > 0.0 && tau0_s.is_finite()) {
        return Err(Error::NotPositive { name: "dt", value: tau0_s });
    }
    if let Some(row) = rate.iter().position(|v| !v.is_finite()) {
        return Err(Error::NotFinite { row });
    }
    // a constant rate does not change the result; taking the mean out first keeps the digits
    let mean = rate.iter().sum::<f64>() / rate.len() as f64;
    let mut x = Vec::with_capacity(rate.len() + 1);
    let mut sum = 0.0;
    x.push(0.0);
    for v in rate {
        sum += v - mean;
        x.push(sum * tau0_s);
    }
    Ok(x)
}

fn overlapping_of(x: &[f64], m: usize, tau0_s: f64) -> f64 {
    let tau = m as f64 * tau0_s;
    let n = x.len() - 2 * m;
    let mut sum = 0.0;
    for i in 0..n {
        let d = x[i + 2 * m] - 2.0 * x[i + m] + x[i];
        sum += d * d;
    }
    math::sqrt(sum / (2.0 * tau * tau * n as f64))
}

fn check_factor(x: &[f64], m: usize) -> Result<()> {
    if m == 0 {
        return Err(Error::NotPositive { name: "averaging factor", value: 0.0 });
    }
    if 2 * m >= x.len() {
        return Err(Error::TooFewPoints { given: x.len() - 1, needed: 2 * m });
    }
    Ok(())
}

/// Overlapping Allan deviation of a rate at averaging factor m; rate N values, one every `tau0_s` s, m from 1
/// to N/2. The result has the rate's unit.
pub fn overlapping_deviation(rate: &[f64], tau0_s: f64, averaging_factor: usize) -> Result<f64> {
    let x = integral(rate, tau0_s)?;
    check_factor(&x, averaging_factor)?;
    Ok(overlapping_of(&x, averaging_factor, tau0_s))
}

/// The classical, non-overlapping Allan deviation: blocks of m samples beside each other.
pub fn classical_deviation(rate: &[f64], tau0_s: f64, averaging_factor: usize) -> Result<f64> {
    let x = integral(rate, tau0_s)?;
    let m = averaging_factor;
    check_factor(&x, m)?;
    let tau = m as f64 * tau0_s;
    let (mut sum, mut n, mut i) = (0.0, 0.0, 0);
    while i + 2 * m < x.len() {
        let d = x[i + 2 * m] - 2.0 * x[i + m] + x[i];
        sum += d * d;
        n += 1.0;
        i += m;
    }
    Ok(math::sqrt(sum / (2.0 * tau * tau * n)))
}

/// Equivalent degrees of freedom of the overlapping estimate (NIST SP 1065, table 5): `integrals` is the
/// number N of integrals (samples + 1), m the averaging factor, α the power law, −2 … 2.
pub fn equivalent_degrees_of_freedom(integrals: usize, averaging_factor: usize, noise_exponent: i32) -> f64 {
    let (n, m) = (integrals as f64, averaging_factor as f64);
    let edf = match noise_exponent {
        2.. => (n + 1.0) * (n - 2.0 * m) / (2.0 * (n - m)),
        1 => {
            let a = math::ln((n - 1.0) / (2.0 * m));
            let b = math::ln((2.0 * m + 1.0) * (n - 1.0) / 4.0);
            math::exp(math::sqrt((a * b).max(0.0)))
        }
        0 => (3.0 * (n - 1.0) / (2.0 * m) - 2.0 * (n - 2.0) / n) * (4.0 * m * m) / (4.0 * m * m + 5.0),
        -1 => {
            if averaging_factor == 1 {
                2.0 * (n - 2.0) * (n - 2.0) / (2.3 * n - 4.9)
            } else {
                5.0 * n * n / (4.0 * m * (n + 3.0 * m))
            }
        }
        _ => {
            (n - 2.0) / m * ((n - 1.0) * (n - 1.0) - 3.0 * m * (n - 1.0) + 4.0 * m * m)
                / ((n - 3.0) * (n - 3.0))
        }
    };
    edf.max(0.3)
}

/// The power law of noise at averaging factor m from the lag-1 autocorrelation of the averages; `None` when
/// fewer than 30 averages are left.
fn noise_exponent(x: &[f64], m: usize, tau0_s: f64) -> Option<i32> {
    let tau = m as f64 * tau0_s;
    let mut y: Vec<f64> = Vec::with_capacity(x.len() / m);
    let mut i = 0;
    while i + m < x.len() {
        y.push((x[i + m] - x[i]) / tau);
        i += m;
    }
    if y.len() < 30 {
        return None;
    }
    let mut differences = 0;
    loop {
        let mean = y.iter().sum::<f64>() / y.len() as f64;
        let (mut lag0, mut lag1) = (0.0, 0.0);
        for (k, v) in y.iter().enumerate() {
            let d = v - mean;
            lag0 += d * d;
            if let Some(next) = y.get(k + 1) {
                lag1 += d * (next - mean);
            }
        }
        if lag0 == 0.0 {
            return None;
        }
        let r = lag1 / lag0;
        let delta = r / (1.0 + r);
        if delta < 0.25 || differences >= 2 {
            let alpha = -2.0 * delta - 2.0 * f64::from(differences);
            return Some((math::round(alpha) as i32).clamp(-2, 2));
        }
        for k in 0..y.len() - 1 {
            y[k] = y[k + 1] - y[k];
        }
        y.pop();
        differences += 1;
    }
}

/// Averaging factors 1 … N/3, `per_decade` a decade, no value twice.
pub fn averaging_factors(samples: usize, per_decade: usize) -> Vec<usize> {
    let ratio = math::exp(core::f64::consts::LN_10 / per_decade.max(1) as f64);
    let mut factors = Vec::new();
    let mut m = 1.0;
    while m <= samples as f64 / 3.0 {
        let rounded = math::round(m) as usize;
        if factors.last() != Some(&rounded) {
            factors.push(rounded);
        }
        m *= ratio;
    }
    factors
}

/// The curve at the given averaging factors; rate N values, one every `tau0_s` s.
pub fn curve(rate: &[f64], tau0_s: f64, averaging_factors: &[usize]) -> Result<Vec<Point>> {
    let x = integral(rate, tau0_s)?;
    let mut points = Vec::with_capacity(averaging_factors.len());
    let mut alpha = 0;
    for &m in averaging_factors {
        check_factor(&x, m)?;
        // with few averages left the power law of the τ before is kept
        alpha = noise_exponent(&x, m, tau0_s).unwrap_or(alpha);
        let deviation = overlapping_of(&x, m, tau0_s);
        let edf = equivalent_degrees_of_freedom(x.len(), m, alpha);
        let (below, above) = deviation_interval(edf, ONE_SIGMA);
        points.push(Point {
            averaging_factor: m,
            tau_s: m as f64 * tau0_s,
            deviation,
            low: deviation * below,
            high: deviation * above,
            degrees_of_freedom: edf,
            noise_exponent: alpha,
        });
    }
    Ok(points)
}

/// Curve, coefficients and recommended averaging time of one axis: rate N values (30 at least) without gaps,
/// one every `tau0_s` s.
pub fn analyse(rate: &[f64], tau0_s: f64) -> Result<Analysis> {
    if rate.len() < 30 {
        return Err(Error::TooFewPoints { given: rate.len(), needed: 30 });
    }
    let curve = curve(rate, tau0_s, &averaging_factors(rate.len(), 10))?;
    if curve.iter().all(|p| p.deviation == 0.0) {
        return Err(Error::Degenerate);
    }
    let [q, n, b, k] = fit_coefficients(&curve)?;
    // the minimum is looked for where the estimate has some certainty
    let certain = |p: &&Point| p.degrees_of_freedom >= 4.0 || p.averaging_factor == 1;
    let floor =
        curve.iter().filter(certain).fold(curve[0], |a, p| if p.deviation < a.deviation { *p } else { a });
    let floor_reached = curve
        .iter()
        .filter(certain)
        .any(|p| p.tau_s > floor.tau_s && p.low > floor.high.min(floor.deviation * 1.2));
    // shortest time whose deviation cannot be told from the smallest one
    let recommended = curve
        .iter()
        .find(|p| p.deviation <= floor.deviation.max(0.5 * (floor.deviation + floor.high)))
        .unwrap_or(&floor);
    Ok(Analysis {
        quantisation: scaled(q, 3.0),
        random_walk: scaled(n, 1.0),
        bias_instability: scaled(b, FLICKER_FACTOR),
        rate_random_walk: scaled(k, 1.0 / 3.0),
        floor: floor.deviation / math::sqrt(FLICKER_FACTOR),
        floor_tau_s: floor.tau_s,
        floor_reached,
        recommended_s: if floor_reached { recommended.tau_s } else { floor.tau_s },
        curve,
    })
}

/// From a coefficient c of the variance with its error to √(c/factor) with its own.
fn scaled((value, sigma): (f64, f64), factor: f64) -> Coefficient {
    if value > 0.0 {
        let root = math::sqrt(value / factor);
        Coefficient { value: root, sigma: 0.5 * root * sigma / value }
    } else {
        Coefficient { value: 0.0, sigma: math::sqrt(sigma / factor) }
    }
}

/// Non-negative least squares of the variances on τ⁻², τ⁻¹, 1, τ: every subset of the four terms is solved,
/// the best one without a negative coefficient is kept.
fn fit_coefficients(curve: &[Point]) -> Result<[(f64, f64); 4]> {
    let mut normal = Normal::<4>::default();
    for p in curve {
        let variance = p.deviation * p.deviation;
        if variance > 0.0 {
            let tau = p.tau_s;
            // neighbours on a logarithmic grid share data: ten a decade count as about three
            let weight = 0.3 * p.degrees_of_freedom / (2.0 * variance * variance);
            normal.add(&[1.0 / (tau * tau), 1.0 / tau, 1.0, tau], variance, weight);
        }
    }
    let mut best = ([(0.0, 0.0); 4], f64::INFINITY);
    for subset in 1..16_u32 {
        let active = |i: usize| subset >> i & 1 == 1;
        let mut matrix = normal.matrix;
        let mut right = normal.gradient;
        let mut size = [1.0; 4];
        for i in 0..4 {
            size[i] = if active(i) { math::sqrt(matrix[i][i]) } else { 1.0 };
        }
        for i in 0..4 {
            for j in 0..4 {
                matrix[i][j] = match (active(i) && active(j), i == j) {
                    (true, _) => matrix[i][j] / (size[i] * size[j]),
                    (false, true) => 1.0,
                    (false, false) => 0.0,
                };
            }
            right[i] = if active(i) { right[i] / size[i] } else { 0.0 };
        }
        let Ok(factor) = cholesky(&matrix) else { continue };
        let solution = cholesky_solve(&factor, &right);
        if (0..4).any(|i| active(i) && solution[i] < 0.0) {
            continue;
        }
        let cost = normal.cost - (0..4).map(|i| solution[i] * right[i]).sum::<f64>();
        if cost < best.1 {
            let inverse = inverse_spd(&matrix)?;
            let mut found = [(0.0, 0.0); 4];
            for i in 0..4 {
                found[i] = if active(i) {
                    (solution[i] / size[i], math::sqrt(inverse[i][i]) / size[i])
                } else {
                    (0.0, 1.0 / math::sqrt(normal.matrix[i][i]))
                };
            }
            best = (found, cost);
        }
    }
    if best.1.is_finite() { Ok(best.0) } else { Err(Error::Degenerate) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The test suite of NIST SP 1065, section 12.4: n ← 16807 n mod 2147483647, from 1234567890.
    fn nist_series(count: usize) -> Vec<f64> {
        let mut n: u64 = 1_234_567_890;
        (0..count)
            .map(|_| {
                let value = n as f64 / 2_147_483_647.0;
                n = n * 16_807 % 2_147_483_647;
                value
            })
            .collect()
    }

    fn printed(value: f64, expected: f64) {
        // seven printed digits, the first of them 2 or more
        assert!((value / expected - 1.0).abs() < 2.5e-7, "{value} {expected}");
    }

    #[test]
    fn nist_thousand_points() {
        let y = nist_series(1000);
        printed(classical_deviation(&y, 1.0, 1).unwrap(), 2.922319e-01);
        printed(classical_deviation(&y, 1.0, 10).unwrap(), 9.965736e-02);
        printed(classical_deviation(&y, 1.0, 100).unwrap(), 3.897804e-02);
        printed(overlapping_deviation(&y, 1.0, 1).unwrap(), 2.922319e-01);
        printed(overlapping_deviation(&y, 1.0, 10).unwrap(), 9.159953e-02);
        printed(overlapping_deviation(&y, 1.0, 100).unwrap(), 3.241343e-02);
    }

    #[test]
    fn agrees_with_allantools() {
        let white = nist_series(5000);
        let mut sum = 0.0;
        let walk: Vec<f64> = white
            .iter()
            .map(|v| {
                sum += v - 0.5;
                sum
            })
            .collect();
        let table = include_str!("../../../fixtures/allan/allantools.csv");
        let mut rows = 0;
        for line in table.lines().filter(|l| !l.starts_with('#') && !l.starts_with("series")) {
            let f: Vec<&str> = line.split(',').collect();
            let y = if f[0] == "white" { &white } else { &walk };
            let number = |i: usize| f[i].parse::<f64>().unwrap();
            let m = f[1].parse::<usize>().unwrap();
            let near =
                |a: f64, b: f64, tolerance: f64| assert!((a / b - 1.0).abs() < tolerance, "{line}: {a}");
            near(classical_deviation(y, 0.01, m).unwrap(), number(2), 1e-9);
            near(overlapping_deviation(y, 0.01, m).unwrap(), number(3), 1e-9);
            let point = curve(y, 0.01, &[m]).unwrap()[0];
            if !f[4].is_empty() {
                assert_eq!(f64::from(point.noise_exponent), number(4), "{line}");
            }
            for (k, alpha) in (-2..=2).enumerate() {
                if m == 1 && alpha == -1 {
                    continue; // allantools 2024.06 leaves out the square of table 5's (N − 2)²
                }
                near(equivalent_degrees_of_freedom(5001, m, alpha), number(5 + k), 1e-9);
            }
            rows += 1;
        }
        assert!(rows >= 10);
    }

    #[test]
    fn finds_white_noise_and_random_walk() {
        // uniform numbers of variance 1/12 at 100 Hz: N = √(τ₀/12); their sum scaled by c walks with K = c √(1/(12 τ₀))
        let u = nist_series(200_000);
        let (c, tau0) = (0.002, 0.01);
        let mut walk = 0.0;
        let rate: Vec<f64> = u
            .chunks(2)
            .map(|v| {
                walk += c * (v[1] - 0.5);
                v[0] + walk
            })
            .collect();
        let a = analyse(&rate, tau0).unwrap();
        let (n, k) = (math::sqrt(tau0 / 12.0), c * math::sqrt(1.0 / (12.0 * tau0)));
        assert!((a.random_walk.value - n).abs() < 4.0 * a.random_walk.sigma, "{a:?}");
        assert!(a.random_walk.sigma < 0.05 * n);
        assert!((a.rate_random_walk.value - k).abs() < 4.0 * a.rate_random_walk.sigma + 0.1 * k, "{a:?}");
        assert!(a.floor_reached);
        // the minimum of N²/τ + K²τ/3 lies at √3 N/K
        let best = 1.7320508 * n / k;
        assert!((0.4..2.5).contains(&(a.recommended_s / best)), "{} {best}", a.recommended_s);
    }

    #[test]
    fn refuses_what_it_cannot_use() {
        assert!(matches!(analyse(&[1.0; 10], 0.01), Err(Error::TooFewPoints { .. })));
        assert_eq!(analyse(&[1.0; 100], 0.01).unwrap_err(), Error::Degenerate);
        assert!(matches!(analyse(&[f64::NAN; 100], 0.01), Err(Error::NotFinite { row: 0 })));
        assert!(matches!(overlapping_deviation(&[1.0, 2.0, 3.0], 0.01, 2), Err(Error::TooFewPoints { .. })));
    }
}
