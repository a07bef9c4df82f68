//! What `cargo xtask bench speed` measures of our files: `kernels FOLDER`, then one name a line on standard input; it
//! is run once and answered by a line. Standing by between the runs, it takes turns with the programs it is measured
//! beside.
//!
//! FOLDER holds `gyr.f64` and `acc.f64` (three little-endian doubles a sample), `big.csv` and room for results.

use std::fs::File;
use std::io::{BufRead, Write};
use std::path::Path;

use shisei_core::Vec3;
use shisei_record::write::{Column, Decimals, csv};
use shisei_record::{Options, Stream, open_stream};

const DT_S: f64 = 0.01;

type Failure = Box<dyn std::error::Error>;

struct Bench<'a> {
    folder: &'a Path,
    rows: usize,
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
    let bench = Bench { folder, rows, table };
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
    fn run(&self, name: &str) -> Result<(), Failure> {
        match name {
            "csv-read" => self.read()?,
            "csv-write-6" => self.write(Decimals::Fixed(6))?,
            "csv-write-shortest" => self.write(Decimals::Shortest)?,
            other => return Err(format!("no kernel {other}").into()),
        }
        Ok(())
    }

    /// Opens the recording whole: numbers, clock, units, and what [`open_stream`] looks for.
    fn read(&self) -> Result<(), Failure> {
        let mut rest = File::open(self.folder.join("big.csv"))?;
        let length = rest.metadata()?.len();
        let stream = Stream { name: "big.csv", head: Vec::new(), rest: &mut rest, length };
        let recording = open_stream(stream, &Options::default())?;
        if recording.len() == self.rows { Ok(()) } else { Err("rows are missing".into()) }
    }

    fn write(&self, decimals: Decimals) -> Result<(), Failure> {
        let columns: Vec<Column<'_>> = self.table.iter().map(|c| Column::Numbers(c)).collect();
        let names = ["time_s", "acc_x", "acc_y", "acc_z", "gyr_x", "gyr_y", "gyr_z", "temp_c"];
        let mut file = File::create(self.folder.join("ours.csv"))?;
        csv(&mut file, &names, &columns, decimals)?;
        Ok(file.flush()?)
    }
}
