//! A BROAD trial: an IMU and its optical truth.
//!
//! D. Laidig, M. Caruso, A. Cereatti, T. Seel, "BROAD – A Benchmark for Robust Inertial Orientation Estimation",
//! Data 6(7), 2021. The Parquet files are turned into plain numbers once, by xtask/py/broad.py, under target/broad.

use std::path::{Path, PathBuf};

use shisei_core::{Quaternion, Vec3};

use crate::project::Project;
use crate::run::must;

/// Columns of a row of the plain file; see xtask/py/broad.py.
const COLUMNS: usize = 12;

/// One recording with its truth.
#[derive(Debug)]
pub struct Trial {
    /// As the file is called: `02_undisturbed_slow_rotation_B`.
    pub name: String,
    /// From sample to sample, s: the same for all.
    pub dt_s: f64,
    pub acc_m_s2: Vec<Vec3>,
    pub gyro_rad_s: Vec<Vec3>,
    /// `world_from_body` of the optics; nothing where the body was lost.
    pub truth: Vec<Option<Quaternion>>,
    /// The samples that count.
    pub movement: Vec<bool>,
    /// The plain file.
    pub file: PathBuf,
}

/// Why there are no trials here.
#[derive(Debug)]
pub enum Absent {
    /// The recordings are not on this machine.
    Data,
    /// What reads them is not.
    Reader(String),
}

impl Trial {
    /// The first two digits of the name.
    pub fn number(&self) -> &str {
        self.name.get(..2).unwrap_or(&self.name)
    }

    /// The first sample that counts.
    pub fn movement_start(&self) -> usize {
        self.movement.iter().position(|moving| *moving).unwrap_or(0)
    }

    fn read(file: PathBuf) -> Result<Self, String> {
        let say = |what: &str| format!("{}: {what}", file.display());
        let bytes = std::fs::read(&file).map_err(|error| say(&error.to_string()))?;
        let numbers = numbers(&bytes);
        let rows: Vec<&[f64]> = numbers.chunks_exact(COLUMNS).collect();
        if rows.len() < 2 || rows.len() * COLUMNS * 8 != bytes.len() {
            return Err(say("not rows of 12 numbers; delete it and run again"));
        }
        let truth = |row: &&[f64]| {
            let q = Quaternion::new(row[7], row[8], row[9], row[10]);
            q.try_normalized().ok()
        };
        Ok(Trial {
            name: file.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
            dt_s: (rows[rows.len() - 1][0] - rows[0][0]) / (rows.len() - 1) as f64,
            acc_m_s2: rows.iter().map(|row| [row[1], row[2], row[3]]).collect(),
            gyro_rad_s: rows.iter().map(|row| [row[4], row[5], row[6]]).collect(),
            truth: rows.iter().map(truth).collect(),
            movement: rows.iter().map(|row| row[11] == 1.0).collect(),
            file,
        })
    }
}

/// Little-endian float64.
pub fn numbers(bytes: &[u8]) -> Vec<f64> {
    let eight = |chunk: &[u8]| f64::from_le_bytes(chunk.try_into().unwrap_or_default());
    bytes.chunks_exact(8).map(eight).collect()
}

/// All trials of `broad` in the shared recordings, by number.
pub fn all(project: &Project) -> Result<Vec<Trial>, Absent> {
    let Some(folder) = project.data().map(|data| data.join("broad")).filter(|folder| folder.is_dir()) else {
        return Err(Absent::Data);
    };
    let mut sources: Vec<PathBuf> = std::fs::read_dir(folder)
        .map_err(|error| Absent::Reader(error.to_string()))?
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.extension().is_some_and(|ending| ending == "parquet"))
        .collect();
    sources.sort();
    if sources.is_empty() {
        return Err(Absent::Data);
    }
    let plain = plain_files(project, &sources).map_err(Absent::Reader)?;
    plain.into_iter().map(Trial::read).collect::<Result<_, _>>().map_err(Absent::Reader)
}

/// Held while files are converted: tests run side by side and write the same ones.
static CONVERTING: std::sync::Mutex<()> = std::sync::Mutex::new(());

fn plain_files(project: &Project, sources: &[PathBuf]) -> Result<Vec<PathBuf>, String> {
    // A test that failed while it held this leaves no half of a file: conversion renames.
    let _alone = CONVERTING.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    let folder = project.target().join("broad");
    std::fs::create_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let plain = |source: &Path| folder.join(source.file_stem().unwrap_or_default()).with_extension("f64");
    let old: Vec<&PathBuf> = sources.iter().filter(|source| !plain(source).is_file()).collect();
    if !old.is_empty() {
        let python = project.venv_python();
        if !python.is_file() {
            return Err("target/venv is missing; `cargo xtask test --install core` makes it".into());
        }
        must(project.command(python).arg("xtask/py/broad.py").arg(&folder).args(old))?;
    }
    Ok(sources.iter().map(|source| plain(source)).collect())
}
