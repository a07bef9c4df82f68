//! `cargo xtask bench sync`: clocks and mounting of simulated takes from the rotation, ours beside qmt's.
//!
//! Half a minute at 120 Hz with two holes and noise, a sensor at 100 Hz with bias, scales and noise whose clock is off
//! and runs up to 100 ppm fast or slow, mounted any way round. qmt is given even steps, so no sample is lost.

use std::fmt::Write as _;
use std::path::Path;
use std::time::Instant;

use shisei_core::sync::gyro_path::Stamp;
use shisei_core::sync::rates::{RatesSettings, synchronise};
use shisei_core::{Quaternion, vector};
use shisei_twin::optics::{Cameras, Frame, Rig, film};
use shisei_twin::simulate::{Errors, Settings, simulate};
use shisei_twin::{Random, Sensor, Simulation, movements};

use crate::needs::Needs;
use crate::project::Project;
use crate::run::output_of;

/// qmt takes more than a minute for each.
const TAKES: u64 = 3;

/// What was found: sensor time at the middle of the take, s, sensor seconds in an optical second less 1, mounting.
struct Found {
    at_s: f64,
    skew: f64,
    body_from_sensor: Quaternion,
    took_s: f64,
}

/// Prints the table; `words` may have `--install`.
pub fn command(project: &Project, words: &[&str]) -> Result<(), String> {
    let install = words.contains(&"--install");
    if let Some(unknown) = words.iter().find(|word| **word != "--install") {
        return Err(format!("`{unknown}` is not known; there is --install"));
    }
    let needs = Needs { pip: vec!["numpy", "scipy", "qmt"], ..Needs::default() };
    needs
        .ensure(project, "core", install)
        .map_err(|reason| reason.replace("test --install core", "bench sync --install"))?;
    let folder = project.target().join("sync");
    std::fs::create_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    println!("take     offset, ms    skew, ppm   mounting, °   seconds   (errors; ours | qmt)");
    for seed in 1..=TAKES {
        let mut random = Random::new(seed, 11);
        let rig = Rig {
            body_from_sensor: Quaternion::from_rotation_vector(vector::scale(
                random.direction(),
                random.between(0.0, 3.1),
            )),
            sensor_m: [0.03, -0.02, 0.05],
            markers_m: Vec::new(),
        };
        let cameras = Cameras {
            offset_s: random.between(1.0, 8.0),
            skew: random.between(-1e-4, 1e-4),
            lost_s: vec![(8.0, 9.5), (20.0, 20.4)],
            ..Cameras::new(120.0, 30.0, seed)
        };
        let motion = movements::wander(seed, 4.0, 42.0);
        let settings = Settings { errors: Errors::DrawnAligned, ..Settings::new(100.0, seed) };
        let simulation = simulate(&motion, &Sensor::lsm6ds3tr_c(), &settings);
        let frames = film(&motion, &rig, &cameras);
        let middle_s = 15.0;
        let mut cells = [String::new(), String::new(), String::new(), String::new()];
        for (way, found) in
            [ours(&frames, &simulation, middle_s)?, peer(project, &folder, &frames, &simulation, middle_s)?]
                .iter()
                .enumerate()
        {
            let turned = found.body_from_sensor.conjugate().product(rig.body_from_sensor).angle();
            let off_ms = 1e3 * (found.at_s - cameras.motion_time_s(middle_s));
            let between = if way == 0 { "" } else { " | " };
            let _ = write!(cells[0], "{between}{off_ms:.3}");
            let _ = write!(cells[1], "{between}{:.1}", 1e6 * (found.skew - cameras.skew));
            let _ = write!(cells[2], "{between}{:.3}", turned.to_degrees());
            let _ = write!(cells[3], "{between}{:.1}", found.took_s);
        }
        println!("{seed:4}  {:>16} {:>14} {:>15} {:>12}", cells[0], cells[1], cells[2], cells[3]);
    }
    Ok(())
}

fn ours(frames: &[Frame], simulation: &Simulation, at_s: f64) -> Result<Found, String> {
    let time_s: Vec<f64> = frames.iter().map(|frame| frame.time_s).collect();
    let attitude: Vec<Option<Quaternion>> =
        frames.iter().map(|frame| frame.pose.map(|pose| pose.world_from_body)).collect();
    // the simulator reads rates at an instant
    let settings = RatesSettings { stamp: Stamp::Instant, ..RatesSettings::default() };
    let start = Instant::now();
    let sync = synchronise(&time_s, &attitude, &simulation.time_s(), &simulation.gyro_rad_s(), &settings)
        .map_err(|error| error.to_string())?;
    Ok(Found {
        at_s: sync.sensor_time_s(at_s),
        skew: sync.skew,
        body_from_sensor: sync.body_from_sensor,
        took_s: start.elapsed().as_secs_f64(),
    })
}

fn peer(
    project: &Project,
    folder: &Path,
    frames: &[Frame],
    simulation: &Simulation,
    at_s: f64,
) -> Result<Found, String> {
    let take = frames.iter().flat_map(|frame| {
        let lost = ([f64::NAN; 4], [f64::NAN; 3]);
        let (q, p) = frame.pose.map_or(lost, |pose| (pose.world_from_body.to_array(), pose.position_m));
        std::iter::once(frame.time_s).chain(q).chain(p)
    });
    let recording = simulation
        .samples
        .iter()
        .flat_map(|sample| std::iter::once(sample.time_s).chain(sample.acc_m_s2).chain(sample.gyro_rad_s));
    let (take, recording) = (
        write(folder.join("take.f64"), take.collect())?,
        write(folder.join("recording.f64"), recording.collect())?,
    );
    let mut python = project.command(project.venv_python());
    let start = Instant::now();
    let text = output_of(python.arg("xtask/py/sync_peer.py").arg(take).arg(recording).arg(at_s.to_string()))?;
    let took_s = start.elapsed().as_secs_f64();
    let last = text.lines().last().unwrap_or_default();
    let numbers: Vec<f64> = last.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    let [at_s, rate, w, x, y, z] = numbers[..] else {
        return Err(format!("sync_peer.py printed `{last}`"));
    };
    Ok(Found { at_s, skew: rate - 1.0, body_from_sensor: Quaternion::new(w, x, y, z), took_s })
}

fn write(file: std::path::PathBuf, numbers: Vec<f64>) -> Result<std::path::PathBuf, String> {
    let bytes: Vec<u8> = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
    std::fs::write(&file, bytes).map_err(|error| format!("{}: {error}", file.display()))?;
    Ok(file)
}
