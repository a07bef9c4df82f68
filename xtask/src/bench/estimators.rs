//! Our estimators, by the name they have in the table. To add one: a line in `OURS`.

use shisei_core::filter::{
    AdaptiveGain, Complementary, DEFAULT_ALPHA, Dt, Filter, GyroIntegrator, Mahony, MahonyAdaptive, run,
};
use shisei_core::{Quaternion, Result, STANDARD_GRAVITY_M_S2, Vec3, initial, rest, vector};

use super::trial::Trial;

/// A named way from readings to `world_from_body` of every sample.
#[derive(Debug)]
pub struct Estimator {
    pub name: &'static str,
    pub run: fn(&Trial) -> Result<Vec<Quaternion>>,
    /// The inclination, raw, on the even trials that other people's code gives, degrees; held to 3 %.
    pub expected_deg: Option<f64>,
}

/// The expected figures come from a NumPy/Numba implementation of the same filters on the same trials.
pub const OURS: &[Estimator] = &[
    Estimator { name: "gyro", run: |t| classic(t, &t.gyro_rad_s, GyroIntegrator::new), expected_deg: None },
    Estimator { name: "gyro, rest bias", run: gyro_without_bias, expected_deg: None },
    Estimator { name: "mahony kp 2", run: |t| mahony(t, 2.0), expected_deg: Some(6.91) },
    Estimator { name: "mahony kp 0.2", run: |t| mahony(t, 0.2), expected_deg: Some(3.03) },
    Estimator { name: "mahony adaptive", run: adaptive, expected_deg: Some(8.96) },
    Estimator { name: "complementary", run: complementary, expected_deg: Some(19.7) },
];

fn mahony(trial: &Trial, kp: f64) -> Result<Vec<Quaternion>> {
    classic(trial, &trial.gyro_rad_s, |start| Mahony::new(start, kp, 0.0))
}

fn adaptive(trial: &Trial) -> Result<Vec<Quaternion>> {
    let make = |start| MahonyAdaptive::new(start, AdaptiveGain::default(), 0.0, STANDARD_GRAVITY_M_S2);
    classic(trial, &trial.gyro_rad_s, make)
}

fn complementary(trial: &Trial) -> Result<Vec<Quaternion>> {
    let make = |start| Complementary::new(start, DEFAULT_ALPHA, STANDARD_GRAVITY_M_S2);
    classic(trial, &trial.gyro_rad_s, make)
}

/// The mean rate before the movement, up to a second before it, is taken for the bias.
fn gyro_without_bias(trial: &Trial) -> Result<Vec<Quaternion>> {
    let second = (1.0 / trial.dt_s) as usize;
    let still = trial.movement_start().saturating_sub(second);
    let bias = rest::gyro_bias(&trial.gyro_rad_s[..still])?;
    let gyro: Vec<Vec3> = trial.gyro_rad_s.iter().map(|&gyro| vector::sub(gyro, bias)).collect();
    classic(trial, &gyro, GyroIntegrator::new)
}

/// A filter that starts from the first 0.5 s of acceleration.
fn classic<F: Filter>(
    trial: &Trial,
    gyro_rad_s: &[Vec3],
    make: impl Fn(Quaternion) -> Result<F>,
) -> Result<Vec<Quaternion>> {
    let half_second = ((0.5 / trial.dt_s) as usize).min(trial.acc_m_s2.len());
    let start = initial::from_mean_acceleration(rest::mean(&trial.acc_m_s2[..half_second])?)?;
    run(&mut make(start)?, gyro_rad_s, &trial.acc_m_s2, Dt::Constant(trial.dt_s))
}
