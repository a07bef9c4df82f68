//! What `cargo xtask bench speed` measures of ours: `kernels FOLDER`, then one name a line on standard input; it is
//! run once and answered by a line. Standing by between the runs, it takes turns with the programs it is measured
//! beside.
//!
//! FOLDER holds `gyr.f64` and `acc.f64` (three little-endian doubles a sample), `big.csv` and room for results.

use std::fs::File;
use std::hint::black_box;
use std::io::{BufRead, Write};
use std::path::Path;

use shisei_core::filter::exponential::cos_sinc;
use shisei_core::filter::{Dt, GyroIntegrator, Mahony, run_gyro_into, run_into};
use shisei_core::{AttitudeRow, Quaternion, Vec3, relative, vector};
use shisei_record::write::{Column, Decimals, csv};
use shisei_record::{Options, Stream, open_stream};

const KP: f64 = 0.2;
const DT_S: f64 = 0.01;

type Failure = Box<dyn std::error::Error>;

struct Bench<'a> {
    folder: &'a Path,
    gyro: Vec<Vec3>,
    acc: Vec<Vec3>,
    quaternions: Vec<[f64; 4]>,
    ypr_rad: Vec<[f64; 3]>,
    table: Vec<Vec<f64>>,
}

fn main() -> Result<(), Failure> {
    let folder = std::env::args().nth(1).ok_or("kernels FOLDER")?;
    let folder = Path::new(&folder);
    let gyro = vectors(&folder.join("gyr.f64"))?;
    let acc = vectors(&folder.join("acc.f64"))?;
    let rows = gyro.len();
    let table = (0..8)
        .map(|c| {
            let value = |k: usize| match c {
                0 => k as f64 * DT_S,
                1..=3 => acc[k][c - 1],
                4..=6 => gyro[k][c - 4],
                _ => 25.0 + gyro[k][0],
            };
            (0..rows).map(value).collect()
        })
        .collect();
    let (quaternions, ypr_rad) = (vec![[0.0; 4]; rows], vec![[0.0; 3]; rows]);
    let mut bench = Bench { folder, gyro, acc, quaternions, ypr_rad, table };
    bench.run("mahony")?; // attitudes to convert, and pages of memory that are ours
    bench.run("ypr")?;
    for name in std::io::stdin().lock().lines() {
        bench.run(name?.trim())?;
        println!("done");
    }
    Ok(())
}

fn vectors(path: &Path) -> Result<Vec<Vec3>, Failure> {
    let bytes = std::fs::read(path)?;
    let (values, _) = bytes.as_chunks::<8>();
    let values: Vec<f64> = values.iter().map(|v| f64::from_le_bytes(*v)).collect();
    Ok(values.as_chunks::<3>().0.to_vec())
}

impl Bench<'_> {
    fn run(&mut self, name: &str) -> Result<(), Failure> {
        let dt = Dt::Constant(DT_S);
        let start = Quaternion::IDENTITY;
        let refused = |error: shisei_core::Error| error.to_string();
        match name {
            // Read six doubles and write four.
            "floor" => {
                for ((row, g), a) in self.quaternions.iter_mut().zip(&self.gyro).zip(&self.acc) {
                    *row = [g[0] + a[0], g[1] + a[1], g[2] + a[2], g[0]];
                }
            }
            "mahony" => {
                let mut filter = Mahony::new(start, KP, 0.0).map_err(refused)?;
                run_into(&mut filter, &self.gyro, &self.acc, dt, &mut self.quaternions).map_err(refused)?;
            }
            "mahony-plain" => plain(&self.gyro, &self.acc, &mut self.quaternions),
            "gyro" => {
                let mut filter = GyroIntegrator::new(start).map_err(refused)?;
                run_gyro_into(&mut filter, &self.gyro, dt, &mut self.quaternions).map_err(refused)?;
            }
            "ypr" => relative::convert_series(&self.quaternions, &mut self.ypr_rad).map_err(refused)?,
            "ypr-unit" => self.unit_ypr(),
            "csv-read" => self.read()?,
            "csv-write-6" => self.write(Decimals::Fixed(6))?,
            "csv-write-shortest" => self.write(Decimals::Shortest)?,
            other => return Err(format!("no kernel {other}").into()),
        }
        black_box((&self.quaternions, &self.ypr_rad));
        Ok(())
    }

    /// Attitudes that are known to be of unit norm.
    fn unit_ypr(&mut self) {
        let (rows, _) = self.ypr_rad.as_chunks_mut::<4>();
        for (rows, four) in rows.iter_mut().zip(self.quaternions.as_chunks::<4>().0) {
            *rows = AttitudeRow::from_lanes(&four.map(Quaternion::from_array));
        }
    }

    /// Opens the recording whole: numbers, clock, units, and what [`open_stream`] looks for.
    fn read(&self) -> Result<(), Failure> {
        let mut rest = File::open(self.folder.join("big.csv"))?;
        let length = rest.metadata()?.len();
        let stream = Stream { name: "big.csv", head: Vec::new(), rest: &mut rest, length };
        let recording = open_stream(stream, &Options::default())?;
        if recording.len() == self.gyro.len() { Ok(()) } else { Err("rows are missing".into()) }
    }

    fn write(&self, decimals: Decimals) -> Result<(), Failure> {
        let columns: Vec<Column<'_>> = self.table.iter().map(|c| Column::Numbers(c)).collect();
        let names = ["time_s", "acc_x", "acc_y", "acc_z", "gyr_x", "gyr_y", "gyr_z", "temp_c"];
        let mut file = File::create(self.folder.join("ours.csv"))?;
        csv(&mut file, &names, &columns, decimals)?;
        Ok(file.flush()?)
    }
}

/// Mahony's equations as they stand: a/|a|, the angle's root, and q/|q|, one after another.
fn plain(gyro: &[Vec3], acc: &[Vec3], out: &mut [[f64; 4]]) {
    let mut q = Quaternion::IDENTITY;
    for ((&gyro, &acc), row) in gyro.iter().zip(acc).zip(out) {
        let norm = vector::norm(acc);
        let mut rate = gyro;
        if norm > 0.0 {
            let unit = [acc[0] / norm, acc[1] / norm, acc[2] / norm];
            rate = vector::add(rate, vector::scale(vector::cross(unit, q.up_body()), KP));
        }
        let half = vector::scale(rate, 0.5 * DT_S);
        let angle = vector::norm(half);
        let (c, s) = cos_sinc(angle * angle);
        q = q.product(Quaternion::new(c, s * half[0], s * half[1], s * half[2])).normalized();
        *row = q.to_array();
    }
}
