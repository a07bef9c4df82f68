//! Arithmetic kernels for `cargo xtask bench speed`: `arithmetic FOLDER`, then one name a line on standard input; it is
//! run once and answered by a line. Standing by between the runs, it takes turns with the programs it is measured
//! beside.
//!
//! FOLDER holds `gyr.f64` and `acc.f64` (three little-endian doubles a sample).

use std::hint::black_box;
use std::io::BufRead;
use std::path::Path;

use shisei_core::filter::exponential::cos_sinc;
use shisei_core::filter::{Dt, GyroIntegrator, Mahony, Readings, run_into};
use shisei_core::{Quaternion, Vec3, vector};
use shisei_wide::Vectors;

const KP: f64 = 0.2;
const DT_S: f64 = 0.01;

type Failure = Box<dyn std::error::Error>;

struct Bench {
    gyro: Vec<Vec3>,
    acc: Vec<Vec3>,
    quaternions: Vec<[f64; 4]>,
    ypr_rad: Vec<[f64; 3]>,
}

fn main() -> Result<(), Failure> {
    let folder = std::env::args().nth(1).ok_or("arithmetic FOLDER")?;
    let gyro = vectors(&Path::new(&folder).join("gyr.f64"))?;
    let acc = vectors(&Path::new(&folder).join("acc.f64"))?;
    let rows = gyro.len();
    let mut bench = Bench { gyro, acc, quaternions: vec![[0.0; 4]; rows], ypr_rad: vec![[0.0; 3]; rows] };
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

impl Bench {
    /// A name may end in `-plain-vectors`: without what only this processor has.
    fn run(&mut self, name: &str) -> Result<(), Failure> {
        let (name, vectors) = match name.strip_suffix("-plain-vectors") {
            Some(name) => (name, Vectors::PLAIN),
            None => (name, Vectors::widest()),
        };
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
            "mahony-many" => self.many(vectors).map_err(refused)?,
            "mahony-plain" => plain(&self.gyro, &self.acc, &mut self.quaternions),
            "gyro" => {
                let mut filter = GyroIntegrator::new(start).map_err(refused)?;
                vectors.run_gyro_into(&mut filter, &self.gyro, dt, &mut self.quaternions).map_err(refused)?;
            }
            "ypr" => vectors.convert_series(&self.quaternions, &mut self.ypr_rad).map_err(refused)?,
            other => return Err(format!("no kernel {other}").into()),
        }
        black_box((&self.quaternions, &self.ypr_rad));
        Ok(())
    }
}

impl Bench {
    /// The samples as recordings of a hundredth each.
    fn many(&mut self, vectors: Vectors) -> shisei_core::Result<()> {
        let rows = self.gyro.len() / 100;
        let filter = Mahony::new(Quaternion::IDENTITY, KP, 0.0)?;
        let readings =
            self.gyro.chunks(rows).zip(self.acc.chunks(rows)).zip(self.quaternions.chunks_mut(rows));
        let recording = |((gyro_rad_s, acc_m_s2), out)| Readings {
            filter,
            gyro_rad_s,
            acc_m_s2,
            dt: Dt::Constant(DT_S),
            out,
        };
        let mut recordings: Vec<_> = readings.map(recording).collect();
        vectors.run_many_into(&mut recordings).map_err(|(_, error)| error)
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
