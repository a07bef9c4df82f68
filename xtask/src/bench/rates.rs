//! The trials at other sample rates, with jitter and lost samples.
//!
//! A resampled reading is the mean over one nominal step, as a sensor with a filter of its own gives it, up to the
//! time of the sample; between the recording's samples its integral runs straight. Below the recording's own rate there
//! are also readings of the moment (of the recording's step), as a sensor without such a filter gives them. The truth
//! is that of the same time. Clean is the same rate without jitter and loss: what a low rate costs by itself is seen by comparing rates.

use shisei_core::estimator::{Estimator, Sample, Settings, smooth};
use shisei_core::filter::Dt;
use shisei_core::{Quaternion, Result, Vec3};

use super::accuracy::quaternions;
use super::metrics::judge;
use super::trial::Trial;
use crate::project::Project;
use crate::run::must;

const RATES_HZ: [f64; 4] = [50.0, 100.0, 286.0, 1000.0];
const MOMENTS_HZ: [f64; 2] = [50.0, 100.0];
/// Largest share of a step by which a sample comes early or late, and share of the samples that are lost.
const JITTER: f64 = 0.2;
const LOST: f64 = 0.05;
/// The most that both may cost.
const COST: f64 = 1.15;

/// A trial at other times.
struct Resampled {
    trial: Trial,
    dt_s: Vec<f64>,
}

/// D. Knuth's MMIX generator, 0 … 1.
fn random(state: &mut u64) -> f64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 11) as f64 / (1_u64 << 53) as f64
}

/// Sum of the readings up to each sample.
fn integral(readings: &[Vec3]) -> Vec<Vec3> {
    let mut sum = [0.0; 3];
    let add = |reading: &Vec3| {
        (0..3).for_each(|j| sum[j] += reading[j]);
        sum
    };
    readings.iter().map(add).collect()
}

/// The integral at a real-valued row.
fn at(integral: &[Vec3], row: f64) -> Vec3 {
    let k = (row.max(0.0) as usize).min(integral.len() - 2);
    let share = row - k as f64;
    [0, 1, 2].map(|j| integral[k][j] + share * (integral[k + 1][j] - integral[k][j]))
}

/// The optical attitude at a real-valued row, where both neighbours were seen.
fn truth_at(trial: &Trial, row: f64) -> Option<Quaternion> {
    let k = row as usize;
    let (a, b) = (trial.truth[k]?, trial.truth[(k + 1).min(trial.truth.len() - 1)]?);
    let share = row - k as f64;
    let sign = if a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z < 0.0 { -share } else { share };
    let mixed = |a: f64, b: f64| (1.0 - share) * a + sign * b;
    Some(Quaternion::new(mixed(a.w, b.w), mixed(a.x, b.x), mixed(a.y, b.y), mixed(a.z, b.z)).normalized())
}

fn resample(trial: &Trial, rate_hz: f64, averaged: bool, [jitter, lost]: [f64; 2], seed: u64) -> Resampled {
    let rows = trial.truth.len() as f64;
    let (acc, gyro) = (integral(&trial.acc_m_s2), integral(&trial.gyro_rad_s));
    // one nominal step, in rows of the trial
    let step = 1.0 / (rate_hz * trial.dt_s);
    let window = if averaged { step } else { 1.0 };
    let mut state = seed;
    let mut out = Resampled {
        trial: Trial {
            name: trial.name.clone(),
            dt_s: 1.0 / rate_hz,
            acc_m_s2: Vec::new(),
            gyro_rad_s: Vec::new(),
            truth: Vec::new(),
            movement: Vec::new(),
            file: trial.file.clone(),
        },
        dt_s: Vec::new(),
    };
    let mut before: Option<f64> = None;
    for k in 2.. {
        let row = (f64::from(k) + jitter * (2.0 * random(&mut state) - 1.0)) * step;
        if row > rows - 2.0 {
            break;
        }
        if random(&mut state) < lost {
            continue;
        }
        let mean = |integral: &[Vec3]| {
            let (end, start) = (at(integral, row), at(integral, row - window));
            [0, 1, 2].map(|j| (end[j] - start[j]) / window)
        };
        out.trial.acc_m_s2.push(mean(&acc));
        out.trial.gyro_rad_s.push(mean(&gyro));
        out.trial.truth.push(truth_at(trial, row));
        out.trial.movement.push(trial.movement[row as usize]);
        out.dt_s.push(before.map_or(1.0 / rate_hz, |before| (row - before) * trial.dt_s));
        before = Some(row);
    }
    out
}

/// Inclination with the optics' lag, degrees: live and smoothed.
fn ours(of: &Resampled) -> Result<[f64; 2]> {
    let settings = Settings::default();
    let mut estimator = Estimator::new(&settings)?;
    let (acc, gyro) = (&of.trial.acc_m_s2, &of.trial.gyro_rad_s);
    let live: Vec<Quaternion> = (0..acc.len())
        .map(|k| Sample { gyro_rad_s: gyro[k], acc_m_s2: acc[k], dt_s: of.dt_s[k] })
        .map(|sample| estimator.update(&sample).world_from_body)
        .collect();
    let smoothed = smooth(acc, gyro, Dt::PerSample(&of.dt_s), &settings)?.states;
    let smoothed: Vec<Quaternion> = smoothed.iter().map(|state| state.world_from_body).collect();
    Ok([live, smoothed].map(|attitudes| judge(&of.trial, &attitudes).aligned_deg))
}

/// The same of VQF, which is told the mean rate.
fn vqf(project: &Project, of: &Resampled) -> std::result::Result<[f64; 2], String> {
    let folder = project.target().join("broad").join("resampled");
    std::fs::create_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let file = folder.join("trial.f64");
    let mut bytes = Vec::with_capacity(of.dt_s.len() * 96);
    let mut time_s = 0.0;
    for (k, dt_s) in of.dt_s.iter().enumerate() {
        time_s += dt_s;
        let mut row = [0.0; 12];
        row[0] = time_s;
        row[1..4].copy_from_slice(&of.trial.acc_m_s2[k]);
        row[4..7].copy_from_slice(&of.trial.gyro_rad_s[k]);
        row.iter().for_each(|number: &f64| bytes.extend_from_slice(&number.to_le_bytes()));
    }
    std::fs::write(&file, bytes).map_err(|error| format!("{}: {error}", file.display()))?;
    let names = ["vqf", "vqf-offline"];
    let mut python = project.command(project.venv_python());
    must(python.arg("xtask/py/peers.py").arg(&file).arg(&folder).args(names))?;
    let [live, offline] = names.map(|name| quaternions(&folder.join(name).with_extension("q64")));
    Ok([judge(&of.trial, &live?).aligned_deg, judge(&of.trial, &offline?).aligned_deg])
}

/// Prints the table; a line for each rate at which jitter and loss cost ours too much.
pub fn compare(project: &Project, trials: &[Trial], peers: bool) -> std::result::Result<Vec<String>, String> {
    println!(
        "\ninclination RMSE, degrees, with the optics' 2.5 ms, at other rates: clean -> ±20 % jitter and 5 % lost"
    );
    let mut lines = Vec::new();
    let averages = RATES_HZ.map(|rate_hz| (rate_hz, true));
    for (rate_hz, averaged) in averages.into_iter().chain(MOMENTS_HZ.map(|rate_hz| (rate_hz, false))) {
        eprintln!("{rate_hz} Hz");
        // ours and VQF, live and offline; clean and rough
        let mut means = [[0.0; 2]; 4];
        for (seed, trial) in trials.iter().enumerate() {
            for (place, rough) in [[0.0, 0.0], [JITTER, LOST]].into_iter().enumerate() {
                let resampled = resample(trial, rate_hz, averaged, rough, seed as u64 + 1);
                let own = ours(&resampled).map_err(|error| format!("{}: {error}", trial.name))?;
                let other = if peers { vqf(project, &resampled)? } else { [f64::NAN; 2] };
                for (mean, value) in means.iter_mut().zip(own.into_iter().chain(other)) {
                    mean[place] += value / trials.len() as f64;
                }
            }
        }
        let readings = if averaged { "" } else { ", moments" };
        print!("{rate_hz:5} Hz{readings}");
        let names = ["shisei-online", "shisei", "vqf", "vqf-offline"];
        for (place, (name, [clean, rough])) in names.into_iter().zip(means).enumerate() {
            if clean.is_finite() {
                print!("   {name} {clean:.3} -> {rough:.3}");
            }
            if place < 2 && rough > COST * clean {
                lines.push(format!(
                    "{name} at {rate_hz} Hz{readings}: {clean:.3} clean, {rough:.3} with jitter and loss"
                ));
            }
        }
        println!();
    }
    Ok(lines)
}
