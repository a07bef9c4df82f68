//! Our estimators, by the name they have in the table. To add one: a line in `OURS`.

use shisei_core::estimator::{self, FixedLag, LightEstimator, Sample, Settings, State};
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
    Estimator { name: "shisei-light", run: light, expected_deg: None },
    Estimator { name: "shisei-online", run: |t| online(t).map(attitudes), expected_deg: None },
    Estimator { name: "shisei lag 1 s", run: |t| lagged(t, 1.0).map(attitudes), expected_deg: None },
    Estimator { name: "shisei", run: |t| smoothed(t).map(attitudes), expected_deg: None },
];

fn attitudes(states: Vec<State>) -> Vec<Quaternion> {
    states.into_iter().map(|state| state.world_from_body).collect()
}

fn samples(trial: &Trial) -> impl Iterator<Item = Sample> + '_ {
    let dt_s = trial.dt_s;
    let rows = trial.gyro_rad_s.iter().zip(&trial.acc_m_s2);
    rows.map(move |(&gyro_rad_s, &acc_m_s2)| Sample { gyro_rad_s, acc_m_s2, dt_s })
}

fn light(trial: &Trial) -> Result<Vec<Quaternion>> {
    let mut estimator = LightEstimator::new(&Settings::default())?;
    Ok(samples(trial).map(|sample| estimator.update(&sample).world_from_body).collect())
}

/// The estimator as it runs live.
pub fn online(trial: &Trial) -> Result<Vec<State>> {
    let mut estimator = estimator::Estimator::new(&Settings::default())?;
    Ok(samples(trial).map(|sample| estimator.update(&sample)).collect())
}

fn lagged(trial: &Trial, lag_s: f64) -> Result<Vec<State>> {
    let mut estimator = FixedLag::new(&Settings::default(), lag_s)?;
    let mut states = Vec::with_capacity(trial.gyro_rad_s.len());
    for sample in samples(trial) {
        estimator.update(&sample, &mut states);
    }
    estimator.finish(&mut states);
    Ok(states)
}

/// The smoother.
pub fn smoothed(trial: &Trial) -> Result<Vec<State>> {
    let dt = Dt::Constant(trial.dt_s);
    let found = estimator::smooth(&trial.acc_m_s2, &trial.gyro_rad_s, dt, &Settings::default())?;
    Ok(found.states)
}

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
