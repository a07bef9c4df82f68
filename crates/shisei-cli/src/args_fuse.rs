//! What `shisei fuse` can be asked. The Japanese texts are in `args_ja.rs`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

/// How the two clocks are brought together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum SyncName {
    Rates,
    Sequence,
}

#[derive(Args, Debug)]
pub struct Fuse {
    /// The take: Motive's tracking CSV
    #[arg(value_name = "OPTICAL.csv")]
    pub optical: PathBuf,
    /// The inertial recording of the same object (two files where accelerometer and gyroscope are apart)
    #[arg(required = true, value_name = "IMU.csv")]
    pub imu: Vec<PathBuf>,
    /// Where the fused take goes, by its ending: .csv, .parquet, .sto, .mot, .glb; may be given several times (default: NAME.fused.csv here)
    #[arg(short, long = "output", value_name = "OUT", id = "fused")]
    pub outputs: Vec<PathBuf>,
    /// Write the take with its gaps filled as Motive's CSV too
    #[arg(long, value_name = "OUT.csv")]
    pub motive: Option<PathBuf>,
    /// Which rigid body, or SKELETON:BONE, the sensor is fixed to, where the take has several
    #[arg(long, value_name = "NAME")]
    pub body: Option<String>,
    /// How the clocks are brought together: by the rotation rates, or by the receiver's frame sequence (column frame)
    #[arg(long, value_enum, default_value = "rates")]
    pub sync: SyncName,
    /// World of the results: z-up, y-up or unity (default: the take's)
    #[arg(long = "axes", id = "world", value_name = "WORLD", value_parser = ["z-up", "y-up", "unity"])]
    pub axes: Option<String>,
    /// A pose repeated bit for bit so often counts as lost; 0 leaves such poses alone
    #[arg(long, value_name = "N", default_value_t = 3)]
    pub frozen: usize,
    /// Gravity where the recording was made, m/s²
    #[arg(long, value_name = "M/S2", default_value_t = shisei_core::STANDARD_GRAVITY_M_S2)]
    pub gravity: f64,
    /// Which column of the inertial recording is what: time,acc_x,acc_y,acc_z,gyr_x,gyr_y,gyr_z in the file's order ('-' for others), or acc_x=NAME,…
    #[arg(long, value_name = "LIST")]
    pub columns: Option<String>,
    /// Its units, where the file does not say them: e.g. acc=g,gyr=deg/s,time=ms
    #[arg(long, value_name = "UNITS")]
    pub units: Option<String>,
    /// Its sampling rate in Hz, instead of the time stamps
    #[arg(long, value_name = "HZ")]
    pub rate: Option<f64>,
    /// Which sensor, where the file holds several
    #[arg(long, value_name = "NAME")]
    pub sensor: Option<String>,
    /// Where the report goes (default: NAME.fused.html here)
    #[arg(long, value_name = "OUT.html")]
    pub report: Option<PathBuf>,
    /// Write no report
    #[arg(long, conflicts_with = "report")]
    pub no_report: bool,
    /// Overwrite files that shisei did not write
    #[arg(long)]
    pub force: bool,
    /// One JSON object on standard output: what was done and found
    #[arg(long)]
    pub json: bool,
}
