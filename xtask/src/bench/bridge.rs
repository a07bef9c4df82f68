//! `cargo xtask bench bridge`: BROAD as takes of a lab, with holes cut into the optics and filled again.
//!
//! Gaps of 0.5 to 30 s follow each other over each trial's movement with max(3 s, half a gap) of sight between.
//! SLERP and straight lines, the gyroscope from both ends (bias from rest), and `shisei_core::fuse`, which is told
//! nothing of the recording: clock offset, mounting and lever arm are found from what is left of the optics; and the
//! same with one marker that is seen in the gaps too, placed by the poses that were cut.

use std::path::Path;

use shisei_core::frames::{Axes, Pose};
use shisei_core::fuse::{FuseSettings, FusedFrame, Inertial, Optical, fuse, fuse_with_markers};
use shisei_core::{Quaternion, Vec3, vector};
use shisei_record::{Input, Options, Recording, open};

use super::metrics::LAG_S;
use crate::project::Project;

const LENGTHS_S: [f64; 5] = [0.5, 1.0, 5.0, 10.0, 30.0];
const WAYS: [&str; 4] = ["SLERP / linear", "gyro from both ends", "shisei fuse", "the same, one marker"];
/// The marker that is still seen in the gaps, on the optical body, m.
const MARKER_M: Vec3 = [0.05, 0.03, 0.01];

/// What the even trials must not exceed at 1, 5 and 10 s: degrees, mm.
const LIMITS: [(usize, f64, f64); 3] = [(1, 0.25, 2.5), (2, 0.30, 28.0), (3, 0.35, f64::INFINITY)];
/// The same where one marker holds the position, in gaps of every length, mm.
const HELD_MM: f64 = 2.0;

/// A trial as a take and a recording of the same clock.
struct Trial {
    time_s: Vec<f64>,
    acc: Vec<Vec3>,
    gyro: Vec<Vec3>,
    poses: Vec<Option<Pose>>,
    movement: Vec<bool>,
}

/// Sums of squared errors, and how many.
#[derive(Clone, Copy, Default)]
struct Sum {
    deg2: f64,
    mm2: f64,
    /// Of the errors that were stated.
    said_deg2: f64,
    said_mm2: f64,
    count: f64,
}

impl Sum {
    fn add(&mut self, found: &Pose, truth: &Pose) {
        let angle = found.world_from_body.conjugate().product(truth.world_from_body).angle().to_degrees();
        let apart = vector::norm(vector::sub(found.position_m, truth.position_m)) * 1e3;
        self.deg2 += angle * angle;
        self.mm2 += apart * apart;
        self.count += 1.0;
    }

    fn add_said(&mut self, frame: &FusedFrame) {
        let (deg, mm) = (frame.sigma_rad.to_degrees(), frame.sigma_m * 1e3);
        self.said_deg2 += deg * deg;
        self.said_mm2 += mm * mm;
    }

    fn plus(self, other: Sum) -> Sum {
        Sum {
            deg2: self.deg2 + other.deg2,
            mm2: self.mm2 + other.mm2,
            said_deg2: self.said_deg2 + other.said_deg2,
            said_mm2: self.said_mm2 + other.said_mm2,
            count: self.count + other.count,
        }
    }

    fn said(self) -> (f64, f64) {
        ((self.said_deg2 / self.count).sqrt(), (self.said_mm2 / self.count).sqrt())
    }

    fn rms(self) -> (f64, f64) {
        ((self.deg2 / self.count).sqrt(), (self.mm2 / self.count).sqrt())
    }
}

/// By gap length and way.
type Sums = [[Sum; WAYS.len()]; LENGTHS_S.len()];

/// Prints the table; `words` may name trials by number.
pub fn command(project: &Project, words: &[&str]) -> Result<(), String> {
    let Some(folder) = project.data().map(|data| data.join("broad")).filter(|folder| folder.is_dir()) else {
        return Err("the BROAD trials are absent; set SHISEI_DATA to the folder that holds `broad`".into());
    };
    let mut files: Vec<_> = std::fs::read_dir(&folder)
        .map_err(|error| format!("{}: {error}", folder.display()))?
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.extension().is_some_and(|ending| ending == "parquet"))
        .filter(|path| words.is_empty() || words.iter().any(|word| name(path).starts_with(word)))
        .collect();
    files.sort();
    if files.is_empty() {
        return Err(format!("{} holds no such trial", folder.display()));
    }
    let mut all: Vec<(u32, Sums)> = Vec::new();
    for file in &files {
        let trial = Trial::read(file)?;
        let sums = judge(&trial).map_err(|reason| format!("{}: {reason}", name(file)))?;
        let of_ours: Vec<String> = sums.iter().map(|ways| shown(ways[2])).collect();
        eprintln!("{:45} {}", name(file), of_ours.join("  "));
        all.push((name(file).get(..2).and_then(|number| number.parse().ok()).unwrap_or(0), sums));
    }
    let mut too_much = Vec::new();
    for (title, parity) in [("even trials", Some(0)), ("odd trials", Some(1)), ("all trials", None)] {
        let chosen = all.iter().filter(|(number, _)| parity.is_none_or(|parity| number % 2 == parity));
        let chosen: Vec<&Sums> = chosen.map(|(_, sums)| sums).collect();
        if chosen.is_empty() || (parity.is_none() && chosen.len() < all.len()) {
            continue;
        }
        let total = |length: usize, way: usize| {
            chosen.iter().map(|sums| sums[length][way]).fold(Sum::default(), Sum::plus)
        };
        println!("\n{title} ({}): RMS degrees / mm in gaps of", chosen.len());
        print!("{:22}", "");
        for length in LENGTHS_S {
            print!(" {length:>13} s");
        }
        println!();
        for (way, name) in WAYS.iter().enumerate() {
            print!("{name:22}");
            for length in 0..LENGTHS_S.len() {
                print!(" {:>15}", shown(total(length, way)));
            }
            println!();
        }
        for (way, name) in [(2, "said by shisei fuse"), (3, "said, one marker")] {
            print!("{name:22}");
            for length in 0..LENGTHS_S.len() {
                let (deg, mm) = total(length, way).said();
                print!(" {:>15}", format!("{deg:.2} / {mm:.1}"));
            }
            println!();
        }
        if parity == Some(0) && words.is_empty() {
            for (length, seconds) in LENGTHS_S.iter().enumerate() {
                let (_, mm) = total(length, 3).rms();
                if mm > HELD_MM {
                    too_much.push(format!("{seconds} s with one marker: {mm:.1} mm; at most {HELD_MM}"));
                }
            }
            for (length, most_deg, most_mm) in LIMITS {
                let (deg, mm) = total(length, 2).rms();
                if deg > most_deg || mm > most_mm {
                    let seconds = LENGTHS_S[length];
                    too_much.push(format!(
                        "{seconds} s: {deg:.3} degrees, {mm:.1} mm; at most {most_deg}, {most_mm}"
                    ));
                }
            }
        }
    }
    if too_much.is_empty() { Ok(()) } else { Err(too_much.join("\n")) }
}

fn name(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

fn shown(sum: Sum) -> String {
    let (deg, mm) = sum.rms();
    format!("{deg:.2} / {mm:.1}")
}

impl Trial {
    fn read(file: &Path) -> Result<Trial, String> {
        let say = |reason: String| format!("{}: {reason}", file.display());
        let bytes = std::fs::read(file).map_err(|error| say(error.to_string()))?;
        let options = Options { keep: vec!["*".into()], ..Options::default() };
        let shown = file.display().to_string();
        let recording =
            open(&[Input { name: &shown, bytes: &bytes }], &options).map_err(|error| error.to_string())?;
        let column = |name: &str| column(&recording, name).ok_or_else(|| say(format!("no column {name}")));
        let q = [column("opt_q_w")?, column("opt_q_x")?, column("opt_q_y")?, column("opt_q_z")?];
        let p = [column("opt_p_x")?, column("opt_p_y")?, column("opt_p_z")?];
        let pose = |k: usize| {
            let position_m = [p[0][k], p[1][k], p[2][k]];
            let q = Quaternion::new(q[0][k], q[1][k], q[2][k], q[3][k]).try_normalized().ok()?;
            vector::is_finite(position_m).then_some(Pose { position_m, world_from_body: q })
        };
        Ok(Trial {
            poses: (0..recording.len()).map(pose).collect(),
            movement: column("movement")?.iter().map(|flag| *flag == 1.0).collect(),
            time_s: recording.time_s,
            acc: recording.acc_m_s2,
            gyro: recording.gyro_rad_s,
        })
    }

    fn dt_s(&self) -> f64 {
        (self.time_s[self.time_s.len() - 1] - self.time_s[0]) / (self.time_s.len() - 1) as f64
    }
}

fn column(recording: &Recording, name: &str) -> Option<Vec<f64>> {
    let extra = recording.extra.iter().find(|extra| extra.name == name)?;
    let number = |cell: &str| match cell {
        "true" | "True" => 1.0,
        text => text.parse().unwrap_or(f64::NAN),
    };
    Some(extra.cells.iter().map(|cell| number(cell)).collect())
}

/// Frames a and b that are seen, with everything between them cut out.
fn gaps(trial: &Trial, length_s: f64) -> Vec<(usize, usize)> {
    let dt = trial.dt_s();
    let rows = (length_s / dt).round() as usize;
    let sight = ((0.5 * length_s).max(3.0) / dt).round() as usize;
    let moving = |k: &usize| trial.movement[*k];
    let all = || 0..trial.movement.len();
    let (Some(first), Some(last)) = (all().find(moving), all().rev().find(moving)) else {
        return Vec::new();
    };
    let mut found = Vec::new();
    let mut start = first;
    while start + rows < last {
        let seen = |k: usize| trial.poses[k].is_some() && trial.poses[k + rows].is_some();
        let Some(a) = (start..last - rows).find(|&k| seen(k)) else { break };
        let moves = trial.movement[a..a + rows].iter().filter(|moving| **moving).count();
        if moves * 10 > rows * 9 {
            found.push((a, a + rows));
        }
        start = a + rows + sight;
    }
    found
}

fn judge(trial: &Trial) -> Result<Sums, String> {
    let mut sums = Sums::default();
    for (of_length, length_s) in sums.iter_mut().zip(LENGTHS_S) {
        let gaps = gaps(trial, length_s);
        let mut poses = trial.poses.clone();
        for (a, b) in &gaps {
            poses[a + 1..*b].fill(None);
        }
        let optical = Optical { time_s: &trial.time_s, poses: &poses };
        let inertial = Inertial { time_s: &trial.time_s, acc_m_s2: &trial.acc, gyro_rad_s: &trial.gyro };
        let settings = FuseSettings { axes: Axes::ZUp, ..FuseSettings::default() };
        let fusion = fuse(&optical, &inertial, &settings).map_err(|error| error.to_string())?;
        let marker = |pose: &Pose| vector::add(pose.position_m, pose.world_from_body.rotate(MARKER_M));
        let marker: Vec<Option<Vec3>> = trial.poses.iter().map(|pose| pose.as_ref().map(marker)).collect();
        let marked = fuse_with_markers(&optical, &[&marker], &inertial, &settings);
        let marked = marked.map_err(|error| error.to_string())?;
        let bias = rest_bias(trial);
        for (a, b) in gaps {
            let blend = from_both_ends(trial, a, b, bias);
            for k in a..=b {
                let Some(truth) = trial.poses[k] else { continue };
                let share = (k - a) as f64 / (b - a) as f64;
                let straight = straight(trial, a, b, share);
                let turned = Pose { world_from_body: blend[k - a], ..straight };
                let ours = fusion.frames[k].pose.ok_or("a frame was not filled")?;
                let held = marked.frames[k].pose.ok_or("a frame was not filled")?;
                for (sum, pose) in of_length.iter_mut().zip([straight, turned, ours, held]) {
                    sum.add(&pose, &truth);
                }
                of_length[2].add_said(&fusion.frames[k]);
                of_length[3].add_said(&marked.frames[k]);
            }
        }
    }
    Ok(sums)
}

fn end(trial: &Trial, row: usize) -> Pose {
    trial.poses[row].unwrap_or(Pose { position_m: [0.0; 3], world_from_body: Quaternion::IDENTITY })
}

fn straight(trial: &Trial, a: usize, b: usize, share: f64) -> Pose {
    let (first, last) = (end(trial, a), end(trial, b));
    let way = vector::sub(last.position_m, first.position_m);
    Pose {
        position_m: vector::add(first.position_m, vector::scale(way, share)),
        world_from_body: Quaternion::slerp(first.world_from_body, last.world_from_body, share),
    }
}

/// Mean rate of the stillness before the movement.
fn rest_bias(trial: &Trial) -> Vec3 {
    let start = trial.movement.iter().position(|moving| *moving).unwrap_or(0);
    let still = &trial.gyro[300.min(start)..start.saturating_sub(300).max(300.min(start))];
    let sum = still.iter().fold([0.0; 3], |sum, rate| vector::add(sum, *rate));
    vector::scale(sum, 1.0 / still.len().max(1) as f64)
}

/// The gyroscope forward from one end, with what it is off at the other end spread over the gap.
fn from_both_ends(trial: &Trial, a: usize, b: usize, bias: Vec3) -> Vec<Quaternion> {
    let dt = trial.dt_s();
    let rate = |k: usize| vector::sub(trial.gyro[k], bias);
    let turn = |rate: Vec3, seconds: f64| Quaternion::from_rotation_vector(vector::scale(rate, seconds));
    let mut q = end(trial, a).world_from_body.product(turn(rate(a), -LAG_S));
    let mut out = Vec::with_capacity(b - a + 1);
    for k in a..=b {
        if k > a {
            q = q.product(turn(rate(k), dt)).normalized();
        }
        out.push(q.product(turn(rate(k), LAG_S)));
    }
    let last = out[out.len() - 1];
    let off = end(trial, b).world_from_body.product(last.conjugate()).to_rotation_vector();
    for (k, q) in out.iter_mut().enumerate() {
        *q = turn(off, k as f64 / (b - a) as f64).product(*q);
    }
    out
}
