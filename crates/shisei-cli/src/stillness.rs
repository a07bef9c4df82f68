//! Whether a sensor lay still throughout, as noise and the Earth's rotation need it.

use shisei_core::Vec3;
use shisei_core::filter::Dt;
use shisei_core::rest::{self, RestSettings};

/// Time outside of the longest rest from which a sensor clearly moved, s; the ends of a rest are found to about a block.
const MOVED_S: f64 = 0.3;

/// A sensor that moved, or was put another way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moved {
    /// The longest rest, s.
    pub still_s: f64,
    /// The whole recording without its gaps, s.
    pub whole_s: f64,
}

/// Whether the sensor moved: accelerations m/s², rates rad/s, steps s. None where it lay still throughout. What happened
/// in a gap shows in the readings after it.
pub fn moved(acc_m_s2: &[Vec3], gyro_rad_s: &[Vec3], dt_s: &[f64]) -> Option<Moved> {
    let mut steps = dt_s.to_vec();
    steps.sort_by(f64::total_cmp);
    let step_s = steps.get(steps.len() / 2).copied().unwrap_or(1.0);
    let usual = RestSettings::default();
    // At low rates a block has one sample. The scale of an uncalibrated sensor may be far off.
    let block_s = usual.block_s.max(step_s);
    let window_s = usual.window_s.max(5.0 * block_s);
    let min_length_s = usual.min_length_s.max(window_s);
    let settings =
        RestSettings { block_s, window_s, min_length_s, max_gap_s: 1e9, gravity_tolerance: 0.5, ..usual };
    // Steps after gaps count as usual ones: of the time in them nothing is known.
    let capped: Vec<f64> = dt_s.iter().map(|dt| dt.min(1.5 * step_s)).collect();
    let rests = rest::find_rests(acc_m_s2, gyro_rad_s, Dt::PerSample(&capped), &settings).unwrap_or_default();
    let length =
        |rows: std::ops::Range<usize>| capped.get(rows).map_or(0.0, |steps| steps.iter().sum::<f64>());
    let whole_s = length(0..capped.len());
    let still_s = rests.into_iter().map(length).fold(0.0, f64::max);
    (whole_s - still_s > MOVED_S.max(2.0 * block_s)).then_some(Moved { still_s, whole_s })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ten minutes at a rate, with noise; turned from a time on, for a second.
    fn check(rate_hz: f64, turned_s: Option<f64>, scale: f64) -> bool {
        let rows = (600.0 * rate_hz) as usize;
        let mut seed = 1_u64;
        let mut noise = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 40) as f64 / 16_777_216.0 - 0.5
        };
        let (mut acc, mut gyro) = (Vec::new(), Vec::new());
        for row in 0..rows {
            let t = row as f64 / rate_hz;
            let turning = turned_s.is_some_and(|from| (from..from + 1.0).contains(&t));
            acc.push([0.1 * noise(), 0.1 * noise(), scale * 9.8 + 0.1 * noise()]);
            gyro.push([0.01 * noise(), 0.2 + 0.01 * noise(), if turning { 0.5 } else { 0.0 }]);
        }
        moved(&acc, &gyro, &vec![1.0 / rate_hz; rows]).is_some()
    }

    #[test]
    fn movement_is_told_from_noise_and_bias_at_every_rate() {
        for rate_hz in [1.0, 5.0, 10.0, 33.3, 100.0, 400.0] {
            assert!(!check(rate_hz, None, 1.0), "{rate_hz}");
            assert!(!check(rate_hz, None, 1.2), "{rate_hz}");
            assert!(rate_hz < 5.0 || check(rate_hz, Some(300.0), 1.0), "{rate_hz}");
            assert!(rate_hz < 5.0 || check(rate_hz, Some(598.0), 1.0), "{rate_hz}");
        }
    }
}
