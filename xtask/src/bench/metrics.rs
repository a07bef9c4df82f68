//! How far estimated attitudes are from the optical ones.
//!
//! With the error e = q_estimate ⊗ q_optical* in world axes: inclination 2 acos √(e_w² + e_z²), heading
//! 2 atan2(e_z, e_w) (Laidig et al. 2021, eq. 9 and 10).

use shisei_core::{Quaternion, math, vector};

use super::trial::Trial;

const DEGREES: f64 = 180.0 / core::f64::consts::PI;

/// The IMU of BROAD is this much later than its optics, s.
pub const LAG_S: f64 = 0.0025;

/// The errors of one estimator on one trial.
#[derive(Clone, Copy, Debug)]
pub struct Errors {
    /// RMS inclination over the movement, as estimated, degrees.
    pub raw_deg: f64,
    /// The same after turning every estimate forward by [`LAG_S`], degrees.
    pub aligned_deg: f64,
    /// RMS heading over the movement against its first second, aligned, degrees.
    pub heading_deg: f64,
    /// Heading error of the movement's last second against its first, aligned, degrees a minute.
    pub drift_deg_min: f64,
}

/// Judges `world_from_body` of every sample.
pub fn judge(trial: &Trial, estimate: &[Quaternion]) -> Errors {
    let ahead = |(q, gyro): (&Quaternion, &_)| {
        q.product(Quaternion::from_rotation_vector(vector::scale(*gyro, LAG_S)))
    };
    let aligned: Vec<Quaternion> = estimate.iter().zip(&trial.gyro_rad_s).map(ahead).collect();
    let (heading_deg, drift_deg_min) = heading(trial, &aligned);
    Errors {
        raw_deg: inclination_rms_deg(trial, estimate),
        aligned_deg: inclination_rms_deg(trial, &aligned),
        heading_deg,
        drift_deg_min,
    }
}

fn inclination_rms_deg(trial: &Trial, estimate: &[Quaternion]) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for ((q, truth), moving) in estimate.iter().zip(&trial.truth).zip(&trial.movement) {
        if let (Some(truth), true) = (truth, moving) {
            let e = q.product(truth.conjugate());
            let angle = 2.0 * math::acos(math::hypot(e.w, e.z).min(1.0));
            sum += angle * angle;
            count += 1.0;
        }
    }
    math::sqrt(sum / count) * DEGREES
}

/// RMS (degrees) and end drift (degrees a minute).
fn heading(trial: &Trial, estimate: &[Quaternion]) -> (f64, f64) {
    let mut turned = 0.0;
    let mut before: Option<f64> = None;
    let mut counted: Vec<(usize, f64)> = Vec::new();
    for (k, (q, truth)) in estimate.iter().zip(&trial.truth).enumerate() {
        let Some(truth) = truth else { continue };
        let e = q.product(truth.conjugate());
        let angle = 2.0 * math::atan2(e.z, e.w);
        // unwrapped over everything the optics saw
        let full = 2.0 * core::f64::consts::PI;
        turned -= before.map_or(0.0, |before: f64| full * math::round((angle - before) / full));
        before = Some(angle);
        if trial.movement[k] {
            counted.push((k, (angle + turned) * DEGREES));
        }
    }
    let (Some(&(first, _)), Some(&(last, _))) = (counted.first(), counted.last()) else {
        return (f64::NAN, f64::NAN);
    };
    let second = (1.0 / trial.dt_s) as usize;
    let mean = |from: usize, to: usize| {
        let part = counted.iter().filter(|(k, _)| (from..to).contains(k)).map(|(_, heading)| *heading);
        let (sum, count) = part.fold((0.0, 0.0), |(sum, count), heading| (sum + heading, count + 1.0));
        sum / count
    };
    let start = mean(first, first + second);
    let squares = counted.iter().map(|(_, heading)| (heading - start) * (heading - start));
    let rms = math::sqrt(squares.sum::<f64>() / counted.len() as f64);
    let minutes = (last - first) as f64 * trial.dt_s / 60.0;
    (rms, (mean(last + 1 - second.min(last), last + 1) - start).abs() / minutes)
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::*;

    const RATE_HZ: f64 = 100.0;
    const ROWS: usize = 6001;

    /// Turns about z at 1 rad/s for a minute; an estimate that leans by `lean` and drifts by `drift` rad.
    fn errors(lean: f64, drift: f64) -> Errors {
        let about = |axis: [f64; 3]| Quaternion::from_rotation_vector(axis);
        let truth: Vec<Quaternion> = (0..ROWS).map(|k| about([0.0, 0.0, k as f64 / RATE_HZ])).collect();
        let estimate: Vec<Quaternion> = truth
            .iter()
            .enumerate()
            .map(|(k, q)| {
                let share = k as f64 / (ROWS - 1) as f64;
                // three whole turns of offset must not show
                let offset = about([0.0, 0.0, 1.0 + drift * share]);
                offset.product(about([lean, 0.0, 0.0])).product(*q)
            })
            .collect();
        let trial = Trial {
            name: "made".into(),
            dt_s: 1.0 / RATE_HZ,
            acc_m_s2: vec![[0.0, 0.0, 9.8]; ROWS],
            gyro_rad_s: vec![[0.0, 0.0, 0.0]; ROWS],
            truth: truth.iter().enumerate().map(|(k, q)| (k % 7 != 3).then_some(*q)).collect(),
            movement: vec![true; ROWS],
            file: PathBuf::new(),
        };
        judge(&trial, &estimate)
    }

    #[test]
    fn a_lean_is_inclination_and_no_heading() {
        let found = errors(0.1, 0.0);
        assert!((found.raw_deg - 0.1 * DEGREES).abs() < 1e-9, "{found:?}");
        assert!((found.aligned_deg - found.raw_deg).abs() < 1e-12, "{found:?}");
        assert!(found.heading_deg < 1e-6 && found.drift_deg_min < 1e-6, "{found:?}");
    }

    #[test]
    fn a_drift_is_heading_and_no_inclination() {
        // Straight from 0 to 10 rad over a minute: more than a turn. Means over a second take 1/60 off the end.
        let found = errors(0.0, 10.0);
        assert!(found.raw_deg < 1e-5, "{found:?}"); // acos near 1
        assert!((found.drift_deg_min - 10.0 * DEGREES * 59.0 / 60.0).abs() < 0.2, "{found:?}");
        // RMS of a ramp that starts at 0: end / √3, less the first second's mean
        assert!((found.heading_deg / (10.0 * DEGREES / 3.0_f64.sqrt()) - 1.0).abs() < 0.02, "{found:?}");
    }
}
