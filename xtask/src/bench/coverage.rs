//! How often the stated uncertainty covers the error: about 63 % of tilt errors are below one root mean square
//! standard deviation of two equal axes, 68 % of heading errors below one of theirs. The optics' own errors count too.

use shisei_core::estimator::State;
use shisei_core::{Quaternion, Result, math, vector};

use super::estimators::{online, smoothed};
use super::metrics::LAG_S;
use super::trial::Trial;

/// A name, and the mean over the trials of the shares of tilt and heading errors that are covered.
pub type Coverage = (&'static str, [f64; 2]);

type Run = fn(&Trial) -> Result<Vec<State>>;

/// The coverage of our estimators.
pub fn of(trials: &[Trial]) -> std::result::Result<Vec<Coverage>, String> {
    let runs: [(&'static str, Run); 2] = [("shisei-online", online), ("shisei", smoothed)];
    runs.into_iter()
        .map(|(name, run)| {
            let mut sums = [0.0; 2];
            for trial in trials {
                let states = run(trial).map_err(|error| format!("{name} on {}: {error}", trial.name))?;
                let shares = shares(trial, &states);
                sums = [sums[0] + shares[0], sums[1] + shares[1]];
            }
            Ok((name, sums.map(|sum| sum / trials.len() as f64)))
        })
        .collect()
}

pub fn print(trials: &[Trial]) -> std::result::Result<(), String> {
    println!("\nshare of the errors that one stated standard deviation covers, tilt and heading");
    for (name, [tilt, heading]) in of(trials)? {
        println!("{name:18} {tilt:.2} {heading:.2}");
    }
    Ok(())
}

/// Tilt and heading; heading against the mean of the movement's first second.
fn shares(trial: &Trial, states: &[State]) -> [f64; 2] {
    let second = (1.0 / trial.dt_s) as usize;
    let first = trial.movement_start();
    let mut start = Quaternion::new(0.0, 0.0, 0.0, 0.0);
    let (mut tilt, mut heading, mut count) = (0.0, 0.0, 0.0);
    for (k, (state, truth)) in states.iter().zip(&trial.truth).enumerate() {
        let (Some(truth), true) = (truth, trial.movement[k]) else { continue };
        let ahead = Quaternion::from_rotation_vector(vector::scale(trial.gyro_rad_s[k], LAG_S));
        let e = state.world_from_body.product(ahead).product(truth.conjugate());
        let sign = if e.w * start.w + e.z * start.z < 0.0 { -1.0 } else { 1.0 };
        if k < first + second {
            (start.w, start.z) = (start.w + sign * e.w, start.z + sign * e.z);
        }
        let angle = 2.0 * math::acos(math::hypot(e.w, e.z).min(1.0));
        tilt += f64::from(angle < state.sigma_tilt_rad);
        let off = Quaternion::new(start.w, 0.0, 0.0, -start.z).product(Quaternion::new(e.w, 0.0, 0.0, e.z));
        heading += f64::from(2.0 * math::atan2(off.z.abs(), off.w.abs()) < state.sigma_heading_rad);
        count += 1.0;
    }
    [tilt / count, heading / count]
}
